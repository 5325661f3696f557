"""Worst condition of a matrix M(s) (p, m), p <= m, of a model's signals, over the box of the signals.

Rows and columns have different units. Columns are therefore in half ranges of their inputs, and each row is divided by
its largest norm in the box. After this scaling, with S the largest singular value anywhere in the box,

    condition(s) = S / (least singular value at s) :

the factor by which an input may need more of its range at s than where M is largest. It is infinite where M has no
right inverse.

Method. M is evaluated on a grid that contains the vertices (for more than four signals: the vertices, the centre and a
Halton sequence). A simplex search minimises the least singular value from the worst points. If the determinant of a
square M changes sign, bisection finds a singular point. The result is not proved to be global: a worse point may lie
between the evaluated points.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product

import casadi as ca
import numpy as np
from scipy.optimize import brentq, minimize

from synth import arguments
from synth.analyse.numerics import nearest_root, precise
from synth.errors import ModelError, SignalError
from synth.signals import Signal, signal_names
from synth.statespace import Array, readonly

GRID = 9  # points along each of up to DENSE signals
DENSE = 4
SEQUENCE_POINTS = 2000  # points of the sequence, for more signals
SEEDS = 3  # points from which the simplex starts
CONDITION_LIMIT = 1e8
IMPROVEMENT = 1e-9  # relative: a refined point must be worse by more than this to replace its starting point


@dataclass(frozen=True, eq=False)
class Scaled:
    """M with columns in half ranges and rows divided by their largest norms `rows` (p,); `box` has its signals.

    `function` gives vec M at points; `inputs` and `labels` name the columns and rows, `strongest` is S.
    """

    function: ca.Function
    box: tuple[Signal, ...]
    inputs: tuple[Signal, ...]
    labels: tuple[str, ...]
    rows: Array
    strongest: float

    def at(self, points: Array) -> Array:
        """Return the scaled matrices (k, p, m) at points of the box (d, k)."""
        shape = (len(self.inputs), len(self.labels), points.shape[1])
        values = np.asarray(self.function(points)).reshape(shape)
        nearest_root.require_finite("the matrix that the inputs enter by", values, self.box, points)
        return np.asarray(values.transpose(2, 1, 0) * nearest_root.half_widths(self.inputs) / self.rows[:, None])

    def condition(self, points: Array) -> Array:
        """Return S over the least singular value (k,) at points of the box (d, k)."""
        least = np.linalg.svd(self.at(points), compute_uv=False)[:, -1]
        with np.errstate(divide="ignore"):
            return np.asarray(np.where(least > precise.LIMIT * self.strongest, self.strongest / least, np.inf))


@dataclass(frozen=True)
class WorstCondition:
    """The largest condition of a matrix over a box, infinite if it is singular, and the point by name and as text.

    `at` holds the signals that enter the matrix. If the value of one signal alone makes the matrix singular, `where`
    has only this signal.
    """

    condition: float
    at: Mapping[str, float]
    where: str

    @property
    def singular(self) -> bool:
        """Whether the condition exceeds 1e8."""
        return not self.condition <= CONDITION_LIMIT


@arguments.checked
def scaled(
    matrix: ca.SX, symbols: ca.SX, signals: Sequence[Signal], inputs: Sequence[Signal], labels: Sequence[str]
) -> Scaled:
    """Return `matrix` (p, m) in the `symbols` (d,) of `signals`, scaled; one row per label, one column per input.

    Raises SignalError for sizes that do not fit or an unknown symbol; ModelError if a row is zero on the whole box or
    an entry is not finite.
    """
    if matrix.shape != (len(labels), len(inputs)) or symbols.shape != (len(signals), 1):
        raise SignalError(
            f"a matrix {matrix.shape} of symbols {symbols.shape} has {len(labels)} rows, {len(inputs)} columns and "
            f"{len(signals)} signals named: give each row, each column and each symbol a name"
        )
    if unknown := {v.name() for v in ca.symvar(matrix)} - {v.name() for v in ca.symvar(symbols)}:
        raise SignalError(f"the matrix contains {', '.join(sorted(unknown))}: give each symbol its signal")
    indices = nearest_root.signal_indices(matrix, symbols, signals)
    entering = tuple(signals[k] for k in indices)
    function = ca.Function("M", [symbols[indices]], [ca.densify(ca.vec(matrix))])
    unscaled = Scaled(function, entering, tuple(inputs), tuple(labels), np.ones(len(labels)), 1.0)
    values = unscaled.at(_points(entering))
    rows = np.linalg.norm(values, axis=2).max(axis=0)
    if not rows.all():
        raise ModelError(f"the row of '{labels[int(rows.argmin())]}' is zero on the whole domain: no input enters it")
    strongest = float(np.linalg.norm(values / rows[:, None], 2, axis=(1, 2)).max())
    return replace(unscaled, rows=readonly(rows), strongest=strongest)


@arguments.checked
def worst(matrix: Scaled) -> WorstCondition:
    """Return the point of its box where the matrix is singular or closest to singular."""
    points = _points(matrix.box)
    distance = (points - nearest_root.centre(matrix.box)[:, None]) / nearest_root.half_widths(matrix.box)[:, None]
    points = points[:, np.argsort(np.abs(distance).sum(axis=0), kind="stable")]  # the closest to the centre wins a tie
    condition = matrix.condition(points)
    seeds = np.argsort(-condition, kind="stable")[:SEEDS]
    if np.isinf(condition[seeds[0]]):
        return _worst_at(matrix, np.inf, points[:, seeds[0]])
    if (crossing := _crossing(matrix, points)) is not None:
        return _worst_at(matrix, np.inf, crossing)
    if not len(points):
        return _worst_at(matrix, float(condition[0]), points[:, 0])
    best, at = float(condition[seeds[0]]), points[:, seeds[0]]
    for k in seeds:
        value, refined = _refine(matrix, points[:, k])
        if value > best * (1 + IMPROVEMENT):
            best, at = value, refined
    return _worst_at(matrix, best, at)


def _points(signals: Sequence[Signal]) -> Array:
    d = len(signals)
    if d <= DENSE:
        return nearest_root.within(signals, nearest_root.grid(d, GRID))
    from scipy.stats import qmc  # slow to import (1 s) and seldom needed

    vertices = np.array(list(product((0.0, 1.0), repeat=min(d, 10))))
    vertices = np.hstack([vertices, np.full((len(vertices), d - vertices.shape[1]), 0.5)])
    spread = qmc.Halton(d, scramble=False).random(SEQUENCE_POINTS)
    return nearest_root.within(signals, np.vstack([np.full((1, d), 0.5), vertices, spread]).T)


def _crossing(matrix: Scaled, points: Array) -> Array | None:
    """Return a point between two of `points` where the determinant of a square matrix is zero, if it changes sign."""
    if len(matrix.labels) != len(matrix.inputs):
        return None
    determinant = np.linalg.det(matrix.at(points))
    start, end = points[:, determinant.argmin()], points[:, determinant.argmax()]
    if not determinant.min() < 0 < determinant.max():
        return None

    def along(t: float) -> float:
        return float(np.linalg.det(matrix.at((start + t * (end - start))[:, None]))[0])

    at = np.asarray(start + brentq(along, 0.0, 1.0, xtol=1e-15) * (end - start))
    if not matrix.condition(at[:, None])[0] > 1 / np.sqrt(np.finfo(float).eps):
        raise ModelError(
            f"the matrix has a pole near {nearest_root.where(matrix.box, at)}: its determinant changes sign "
            "without a zero; shrink the ranges of the signals to where the model is finite"
        )
    return at


def _refine(matrix: Scaled, start: Array) -> tuple[float, Array]:
    low, width = start * 0 + [s.low for s in matrix.box], 2 * nearest_root.half_widths(matrix.box)

    def least(unit: Array) -> float:
        return float(np.linalg.svd(matrix.at((low + width * unit)[:, None]), compute_uv=False)[0, -1])

    options = {"xatol": 1e-10, "fatol": 1e-15}
    bounds = [(0.0, 1.0)] * len(start)
    unit = minimize(least, (start - low) / width, method="Nelder-Mead", bounds=bounds, options=options).x
    at = low + width * unit
    return float(matrix.condition(at[:, None])[0]), at


def _worst_at(matrix: Scaled, condition: float, at: Array) -> WorstCondition:
    named = dict(zip(signal_names(matrix.box), map(float, at), strict=True))
    enough = _decisive_signal(matrix, at) if np.isinf(condition) and len(at) > 1 else None
    if enough is not None:
        return WorstCondition(condition, named, nearest_root.where(matrix.box[enough : enough + 1], at[[enough]]))
    return WorstCondition(condition, named, nearest_root.where(matrix.box, at) or "every point")


def _decisive_signal(matrix: Scaled, at: Array) -> int | None:
    """Return the index of a signal whose value alone makes the matrix singular, for any values of the others."""
    points = nearest_root.scatter(matrix.box, precise.POINTS, precise.SEEDS[0])
    for k, value in enumerate(at):
        points_k = points.copy()
        points_k[k] = value
        if not (matrix.condition(points_k) <= CONDITION_LIMIT).any():
            return k
    return None
