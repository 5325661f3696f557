"""Maxima of terms, and the least determinant and largest condition number of a matrix, over a box of signals.

For expressions e_i(s), a matrix M(s) and a box S of signals s = (s_1, ..., s_d),

    max over S of |e_i|,    min over S of |det M|,    max over S of cond_2(M).

Method. The functions are evaluated on a grid that contains the vertices and then optimised locally from the best grid
points, by gradient for |e_i| and |det M| and by simplex for the condition number. If det M changes sign, bisection
finds a point where M is singular. All results are attained in S. They are not proved to be global: a higher value may
lie between the grid points.

Source: Fulford, Maggiore, Apkarian, equations (10) for the maximisation and (12) for the matrix.

Matrix equilibration: rows and columns scaled to similar size, which makes a rank independent of units.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeVar

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import brentq, minimize

from synth import arguments, law
from synth.analyse.numerics import nearest_root as boxes
from synth.errors import ModelError, SignalError
from synth.signals import Signal, signal_names
from synth.statespace import Array, readonly

Matrix = TypeVar("Matrix", Array, NDArray[np.complex128])

PASSES = 5


def equilibrated(M: Matrix) -> tuple[Matrix, Array, Array]:
    """Return diag(r) M diag(c) with rows and columns of similar size, r and c."""
    r, c = np.ones(len(M)), np.ones(M.shape[1])
    for _ in range(PASSES):
        for axis, factor in ((1, r), (0, c)):
            size = np.sqrt(np.abs(r[:, None] * M * c).max(axis=axis, initial=0.0))
            factor /= np.where(size > 0, size, 1.0)
    return r[:, None] * M * c, r, c


def is_singular(M: Matrix) -> bool:
    """Tell whether a square M is singular within rounding, in any units; an empty M is not."""
    return bool(M.size and np.linalg.cond(equilibrated(M)[0]) > 1 / np.finfo(float).eps)


Exprs = Mapping[str, ca.SX]

GRID = 9  # points along each signal
SEEDS = 3  # best grid points, from which the local optimisation starts


@dataclass(frozen=True, eq=False)
class Magnitudes:
    """Maxima (k, t) of |term j| over a box at each of k points along one signal; `worst` (k, t, d) has their locations.

    `box` names the d signals of the box in order; values are in the units of terms and signals.
    """

    along: str
    points: Array
    terms: tuple[str, ...]
    box: tuple[str, ...]
    maxima: Array
    worst: Array

    def of(self, term: str) -> Array:
        """Return the maxima (k,) of one term."""
        if term not in self.terms:
            raise SignalError(f"no term '{term}': there are {', '.join(self.terms)}")
        return self.maxima[:, self.terms.index(term)]


@dataclass(frozen=True)
class Conditioning:
    """The least |det| and the largest condition number of a matrix over a box, and the signals' values there.

    `min_abs_det` is 0 if the determinant changes sign. `max_cond` is in the 2-norm and depends on units.
    """

    min_abs_det: float
    det_at: Mapping[str, float]
    max_cond: float
    cond_at: Mapping[str, float]


@arguments.checked
def magnitudes(
    terms: Exprs, symbols: Exprs, box: Sequence[Signal], along: str, points: ArrayLike, held: Mapping[str, float]
) -> Magnitudes:
    """Maximise |term| over `box` at each of `points` of the signal `along`, with other signals `held`.

    `symbols` maps the names of all signals to the symbols in `terms`.

    Raises SignalError when a term contains a symbol that is neither in the box, nor `along`, nor held; ModelError when
    a term is not finite in the box.
    """
    points = np.atleast_1d(arguments.real("points", points))
    if points.ndim != 1 or not np.isfinite(points).all():
        raise SignalError(f"the points of '{along}' have shape {points.shape} or are not finite: give finite numbers")
    _require_box(box)
    boxed = signal_names(box)
    free = law.column("the symbols", symbols, boxed)
    known = {along: symbols.get(along), **{n: symbols.get(n) for n in held}}
    if unknown := [n for n, s in known.items() if s is None]:
        raise SignalError(f"no symbol for {', '.join(unknown)}: there are {', '.join(symbols)}")
    best = []
    for point in points:
        values = dict(held) | {along: float(point)}
        old, new = law.column("the symbols", symbols, values), ca.vcat(list(values.values()))
        exprs = [ca.substitute(ca.SX(expr), old, ca.SX(new)) for expr in terms.values()]
        best.append([_largest_value(n, _compile(e, free, box), box) for n, e in zip(terms, exprs, strict=True)])
    maxima = readonly([[value for value, _ in row] for row in best])
    worst = readonly([[_signals(box, at) for _, at in row] for row in best])
    return Magnitudes(along, readonly(points), tuple(terms), boxed, maxima, worst)


@arguments.checked
def conditioning(matrix: ca.SX, symbols: Exprs, box: Sequence[Signal]) -> Conditioning:
    """Return min |det| and max cond of a square `matrix` over `box`, and their locations.

    `symbols` maps the names in `box` to the symbols in `matrix`.

    Raises SignalError when the matrix contains another symbol, ModelError when it is not square or not finite.
    """
    if matrix.size1() != matrix.size2():
        raise ModelError(f"a matrix of shape {matrix.shape} has no determinant: give as many inputs as outputs")
    _require_box(box)
    boxed = signal_names(box)
    free = law.column("the symbols", symbols, boxed)
    det_value, det_at = _least_determinant(_compile(ca.det(matrix), free, box), box)
    evaluate = _function(ca.vec(matrix), free)
    n = matrix.size1()

    def cond(unit: Array) -> float:
        values = np.asarray(evaluate(_signals(box, unit))).reshape(n, n, order="F")
        return float(np.linalg.cond(values)) if np.isfinite(values).all() else np.inf

    cond_value, cond_at = _largest_condition(cond, len(box))
    named = [dict(zip(boxed, map(float, _signals(box, at)), strict=True)) for at in (det_at, cond_at)]
    return Conditioning(det_value, named[0], cond_value, named[1])


@dataclass(frozen=True, eq=False)
class _Compiled:
    """A scalar expression over unit coordinates: many values at once, or one value with its gradient."""

    values: Callable[[Array], Array]
    slope: Callable[[Array], tuple[float, Array]]


def _signals(signals: Sequence[Signal], unit: ArrayLike) -> Array:
    """Return the point (d,), or the points (d, k), of the box at coordinates from 0 to 1."""
    at = np.asarray(unit, dtype=np.float64)
    return boxes.within(signals, at.reshape(len(at), -1)).reshape(at.shape)


def _require_box(signals: Sequence[Signal]) -> None:
    if not signals:
        raise SignalError("the box is empty: name at least one signal to vary")


def _function(exprs: ca.SX, free: ca.SX) -> ca.Function:
    known = {s.name() for s in ca.symvar(free)}
    if left := sorted({s.name() for s in ca.symvar(exprs)} - known):
        raise SignalError(f"the expression contains {', '.join(left)}: put each into the box, or hold it at a value")
    return ca.Function("e", [free], [ca.densify(exprs)])


def _compile(expr: ca.SX, free: ca.SX, box: Sequence[Signal]) -> _Compiled:
    value, gradient = _function(expr, free), _function(ca.jacobian(expr, free), free)
    width = 2 * boxes.half_widths(box)

    def slope(unit: Array) -> tuple[float, Array]:
        at = _signals(box, unit)
        return float(value(at)), np.asarray(gradient(at)).ravel() * width

    return _Compiled(lambda unit: np.asarray(value(_signals(box, unit))).ravel(), slope)


def _largest_value(name: str, expr: _Compiled, box: Sequence[Signal]) -> tuple[float, Array]:
    unit = boxes.grid(len(box), GRID)
    values = expr.values(unit)
    boxes.require_finite(f"term '{name}'", values, box, boxes.within(box, unit))
    seeds = np.argsort(-np.abs(values))[:SEEDS]
    candidates = [_descend(expr, unit[:, k], -np.sign(values[k])) for k in seeds]
    candidates += [(float(values[k]), unit[:, k]) for k in seeds]
    value, at = max(candidates, key=lambda pair: abs(pair[0]))
    return abs(value), at


def _least_determinant(det: _Compiled, box: Sequence[Signal]) -> tuple[float, Array]:
    unit = boxes.grid(len(box), GRID)
    values = det.values(unit)
    boxes.require_finite("the determinant", values, box, boxes.within(box, unit))
    seeds = np.argsort(np.abs(values))[:SEEDS]
    candidates = [_descend(det, unit[:, k], np.sign(values[k])) for k in seeds]
    candidates += [(float(values[k]), unit[:, k]) for k in seeds]
    signed = [
        *candidates,
        (float(values.min()), unit[:, values.argmin()]),
        (float(values.max()), unit[:, values.argmax()]),
    ]
    below, above = min(signed, key=lambda pair: pair[0]), max(signed, key=lambda pair: pair[0])
    if below[0] <= 0 <= above[0]:
        return 0.0, _zero_between(det, below[1], above[1])
    value, at = min(candidates, key=lambda pair: abs(pair[0]))
    return abs(value), at


def _zero_between(expr: _Compiled, start: Array, end: Array) -> Array:
    def along(t: float) -> float:
        return expr.slope(start + t * (end - start))[0]

    if along(0.0) == 0:
        return start
    if along(1.0) == 0:
        return end
    return start + brentq(along, 0.0, 1.0, disp=False) * (end - start)


def _descend(expr: _Compiled, start: Array, sign: float) -> tuple[float, Array]:
    """Return the local minimum of sign * expr within the box, from `start`, and its location."""
    scale = abs(expr.slope(start)[0]) or 1.0

    def objective(unit: Array) -> tuple[float, Array]:
        value, gradient = expr.slope(unit)
        return sign * value / scale, sign * gradient / scale

    at = minimize(objective, start, jac=True, bounds=[(0.0, 1.0)] * len(start), options={"ftol": 1e-15}).x
    return expr.slope(at)[0], at


def _largest_condition(cond: Callable[[Array], float], d: int) -> tuple[float, Array]:
    unit = boxes.grid(d, GRID)
    values = np.array([cond(column) for column in unit.T])
    start = unit[:, values.argmax()]
    if not np.isfinite(values.max()):
        return float("inf"), start
    options = {"xatol": 1e-10, "fatol": 1e-12}
    at = minimize(lambda w: -cond(w), start, method="Nelder-Mead", bounds=[(0.0, 1.0)] * len(start), options=options).x
    return max((cond(at), at), (float(values.max()), start), key=lambda pair: pair[0])
