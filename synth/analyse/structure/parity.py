"""Parity relations of redundant sensors: the left null space of the output Jacobian (analytical redundancy).

    outputs y = h(q) of n positions q,   C = dh/dq (m, n),   W C = 0, the rows of W independent:   W (h(q) - h(q0)) = 0

up to the nonlinearity of h. Every row w of W is a residual r = w y that is zero for sensors without a fault, whatever
the motion. A residual of healthy sensors is bounded by

    |r| <= c + e,   c = sum_i |w_i| offset_i + max over the range of |w (h(q) - h(q0))|,
                    e = sum_i |w_i| resolution_i / 2

White noise adds to it, with the standard deviation s and the quantile K of a small chance. The mean of
(r - r one sample ago)^2 measures 2 s^2, with the rounding of a body that moves, and is 0 where nothing moves:

    r^2 <= t^2 + gain mean (r - r one sample ago)^2,   t = c + e,   gain = K^2 / 2  t^2 / (t^2 - c^2)

The gain is the least with which that bound is nowhere below c + K s.

Each row is reduced (row echelon form), so it has few entries, and scaled: its
largest entry is 1 or -1.

Source: Chow, Willsky, "Analytical redundancy and the design of robust failure detection systems", IEEE Trans. Automatic
Control 29 (1984), section II, for sensors of one instant; von Neumann, Kent, Bellinson, Hart, "The mean square
successive difference", Annals of Mathematical Statistics 12 (1941).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from math import sqrt
from statistics import NormalDist

import casadi as ca
import numpy as np

from synth import arguments
from synth.errors import ModelError
from synth.plant import Plant
from synth.statespace import Array

SMALL = 1e-9  # of the largest entry: an entry below is 0
DIGITS = 12  # of an entry: an entry of 1 is exact
GRID = 3  # points of each position over its range


@arguments.checked
@dataclass(frozen=True)
class Tolerance:
    """Resolution, largest constant error and largest standard deviation of white noise of a sensor, in its unit."""

    resolution: float
    offset: float
    noise: float = 0.0


@arguments.checked
@dataclass(frozen=True)
class Relation:
    """Weights (1) by sensor of one residual, and the largest |residual| of healthy sensors, in their unit.

    It is `threshold` without noise. Its square rises by `gain` times the mean squared change of the residual in a
    sample, to that of `largest`. A gain of 0 is that of sensors without noise.
    """

    weights: Mapping[str, float]
    threshold: float
    gain: float = 0.0
    largest: float = 0.0


@arguments.checked
def relations(
    plant: Plant, sensors: Mapping[str, str], tolerances: Mapping[str, Tolerance], chance: float = 1e-9
) -> tuple[Relation, ...]:
    """Return the parity relations of `sensors`, plant outputs by sensor name; none where no sensor is redundant.

    Noise exceeds its quantile in a share `chance` of the samples.

    The positions are the states that an output depends on. Their ranges are those of the plant, and C is that at their
    middle. Units of sensors that stand in one relation must agree.

    Raises ModelError for no sensors, an output that the plant does not have, that depends on an input or on no state, a
    missing tolerance, a relation between sensors of different units, or a chance outside 0 .. 1.
    """
    if not 0 < chance < 1:
        raise ModelError(f"noise exceeds the threshold with the chance {chance}: give one between 0 and 1")
    if not sensors:
        raise ModelError("no sensors are given: give the output that each sensor reads")
    outputs = {s.name: s for s in plant.outputs}
    for sensor, of in sensors.items():
        if of not in outputs or sensor not in tolerances:
            raise ModelError(f"sensor '{sensor}' reads '{of}': give an output of '{plant.name}' and a tolerance for it")
    h, middle, points = _output_map(plant, list(sensors.values()))
    W = _left_null_space(np.array(h.jacobian()(middle, h(middle))))
    names = list(sensors)
    resolution, offset, noise = np.array([(t.resolution, t.offset, t.noise) for t in map(tolerances.get, names) if t]).T
    K = -NormalDist().inv_cdf(chance / 2)
    deviations = np.array([np.array(h(p) - h(middle)).ravel() for p in points])
    parities = []
    for w in W:
        weights = {n: float(v) for n, v in zip(names, w, strict=True) if v}
        units = {outputs[sensors[n]].unit for n in weights}
        if len(units) > 1:
            raise ModelError(
                f"the relation of {', '.join(weights)} mixes {', '.join(sorted(units))}: scale the outputs"
            )
        curvature = float(np.max(np.abs(deviations @ w), initial=0.0))
        constant = float(np.abs(w) @ offset) + curvature
        threshold, variance, gain = constant + float(np.abs(w) @ resolution / 2), 0.0, 0.0
        if (noise * w).any():
            variance = float(w**2 @ (noise**2 + resolution**2 / 12))
            gain = K**2 / 2 / (1 - (constant / threshold) ** 2)
        parities.append(Relation(weights, threshold, gain, sqrt(threshold**2 + 2 * gain * variance)))
    return tuple(parities)


def _output_map(plant: Plant, names: Sequence[str]) -> tuple[ca.Function, Array, Array]:
    """Return q -> the outputs `names`, the middle of the range of q, and a grid (GRID^n, n) of it."""
    x, u, p = (ca.SX.sym(name, n) for name, n in zip("xup", map(plant.h.size1_in, range(3)), strict=True))
    rows = {s.name: e for s, e in zip(plant.outputs, ca.vertsplit(plant.h(x, u, p)), strict=True)}
    values = [q.value for q in plant.parameters]
    y = (
        ca.substitute(ca.vcat([rows[n] for n in names]), p, ca.DM(values))
        if values
        else ca.vcat([rows[n] for n in names])
    )
    for name in names:
        acting = [s.name for s, e in zip(plant.inputs, ca.which_depends(rows[name], u, 1, False), strict=True) if e]
        if acting:
            raise ModelError(
                f"the output '{name}' depends on the input '{acting[0]}', which no parity relation cancels: "
                "leave its sensor out"
            )
        if not any(ca.which_depends(rows[name], x, 1, False)):
            raise ModelError(f"the output '{name}' depends on no state: leave its sensor out")
    moving = [i for i, depends in enumerate(ca.which_depends(y, x, 1, False)) if depends]
    free = ca.vcat([x[i] for i in moving])
    fixed = [i for i in range(x.numel()) if i not in moving]
    others = ca.vcat([x[i] for i in fixed])
    y = ca.substitute(y, others, ca.DM.zeros(others.numel())) if fixed else y
    ends = [(plant.states[i].low, plant.states[i].high) for i in moving]
    grid = np.array(list(product(*(np.linspace(low, high, GRID) for low, high in ends))))
    return ca.Function("measured", [free], [y]), np.mean(ends, axis=1), grid


def _left_null_space(C: Array) -> Array:
    """Return the rows w with w C = 0 in row echelon form; the largest entry is 1 or -1, the first is positive."""
    U, s, _ = np.linalg.svd(C)
    rank = int(np.count_nonzero(s > SMALL * s[0])) if s.size else 0
    W = U[:, rank:].T.copy()
    for i in range(len(W)):
        column = int(np.argmax(np.abs(W[i])))
        W[i] /= W[i, column]
        for k in range(len(W)):
            if k != i:
                W[k] -= W[k, column] * W[i]
    W[np.abs(W) < SMALL] = 0.0
    scaled = [w / np.abs(w).max() * np.sign(w[np.flatnonzero(w)[0]]) for w in W]
    return np.round(np.array(scaled).reshape(-1, len(C)), DIGITS)
