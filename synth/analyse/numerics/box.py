"""Box of a model's signals, low <= x <= high: random points in it, grids, and points as text.

Points are columns (d, k), in the order of the signals and in their units. They are the same on every machine.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field

import casadi as ca
import numpy as np

from synth.errors import ModelError
from synth.signals import Signal
from synth.statespace import Array, readonly

PRINT_THRESHOLD = 1e-6  # of a half range: a smaller value prints as 0


@dataclass(frozen=True, eq=False)
class Box:
    """Symbols (d,) of `signals`, and symbols of `constants` (q,) with their `values`.

    Constants stay symbols so that CasADi does not fold them: once folded, 0.1 + 0.2 - 0.3 looks like any small number.
    """

    symbols: ca.SX
    signals: tuple[Signal, ...]
    constants: ca.SX = field(default_factory=lambda: ca.SX(0, 1))
    values: Array = field(default_factory=lambda: readonly([]))

    def with_values(self, exprs: ca.SX) -> ca.SX:
        """Return the expressions with the values of the constants substituted."""
        return ca.substitute(exprs, self.constants, ca.SX(ca.DM(self.values.tolist())))

    def evaluate(self, exprs: ca.SX, points: Array) -> Array:
        """Return the values (k, l, points) of `exprs` (k, l) at columns of `points` (d, points).

        Raises ModelError where one is not finite.
        """
        function = ca.Function("e", [self.symbols, self.constants], [ca.densify(ca.vec(exprs))])
        values = np.asarray(function(points, self.values)).reshape(exprs.size2(), exprs.size1(), -1).transpose(1, 0, 2)
        require_finite("the model or a derivative of it", values, self.signals, points)
        return values


def scatter(box: Sequence[Signal], count: int, seed: int) -> Array:
    """Return `count` points, uniform at random inside the box, as (d, count)."""
    unit = np.random.default_rng(seed).uniform(size=(len(box), count))
    return within(box, unit)


def within(box: Sequence[Signal], unit: Array) -> Array:
    """Return the points of the box at coordinates from 0 to 1, both (d, k)."""
    low, high = (np.array([getattr(s, end) for s in box]).reshape(-1, 1) for end in ("low", "high"))
    return low + (high - low) * unit


def grid(d: int, count: int) -> Array:
    """Return coordinates (d, k) from 0 to 1 on a grid of `count` points along each axis, vertices included."""
    axes = np.meshgrid(*[np.linspace(0.0, 1.0, count)] * d, indexing="ij")
    return np.array([a.ravel() for a in axes]).reshape(d, -1) if d else np.zeros((0, 1))


def half_widths(box: Sequence[Signal]) -> Array:
    """Return half of each signal's range (d,)."""
    return np.array([(s.high - s.low) / 2 for s in box])


def centre(box: Sequence[Signal]) -> Array:
    """Return the middle of each signal's range (d,)."""
    return np.array([(s.high + s.low) / 2 for s in box])


def signal_indices(expr: ca.SX, symbols: ca.SX, box: Sequence[Signal]) -> list[int]:
    """Return the indices of the signals whose `symbols` (d,) occur in an expression."""
    occurs = {s.element_hash() for s in ca.symvar(expr)}
    return [k for k in range(len(box)) if symbols[k].element_hash() in occurs]


def where(box: Sequence[Signal], point: Array) -> str:
    """Return a point (d,) as text: each signal with its value and unit."""
    values = np.where(np.abs(point) > PRINT_THRESHOLD * half_widths(box), point, 0.0)
    return ", ".join(f"{s.name} = {v:.6g} {s.unit}".removesuffix(" 1") for s, v in zip(box, values, strict=True))


def require_finite(what: str, values: Array, box: Sequence[Signal], points: Array) -> None:
    """Raise ModelError with the point if an entry of `values` (..., k) at `points` (d, k) is not finite."""
    bad = np.flatnonzero(~np.isfinite(values.reshape(-1, points.shape[1])).all(axis=0))
    if len(bad):
        raise ModelError(
            f"{what} is not finite at {where(box, points[:, bad[0]])}: "
            "shrink the ranges of the signals to where the model is finite"
        )
