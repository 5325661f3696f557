"""Magnitudes over a box: how large terms grow, and how near a matrix comes to being singular.

For expressions e_i(s), a matrix M(s) and a box S of signals s = (s_1, ..., s_d),

    max over S of |e_i|,    min over S of |det M|,    max over S of cond_2(M).

Method. Values on a grid that contains the vertices, then local refinement within the box from the best grid points
(from the gradient for |e_i| and |det M|, by a simplex for the condition number). A change of sign of det M is followed
by bisection to a point where M is singular. The figures are attained in S; that nothing larger hides between the grid
points is as sure as the grid is fine, no proof.

Source: the maximisation is (10) of Fulford, Maggiore, Apkarian, the matrix that of (12).
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import brentq, minimize

from synth import arguments, law
from synth.errors import ModelError, SignalError
from synth.signals import Signal, names
from synth.statespace import Array, readonly

Exprs = Mapping[str, ca.SX]

GRID = 9  # points along each signal
SEEDS = 3  # grid points that are refined


@dataclass(frozen=True, eq=False)
class Magnitudes:
    """Maxima (k, t) of |term j| over a box at each of k points along one signal; `worst` (k, t, d) says where.

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
    """How near a matrix comes to being singular over a box, and the signals' values there.

    `min_abs_det` is 0 where the determinant changes sign. `max_cond` is in the 2-norm and depends on units.
    """

    min_abs_det: float
    det_at: Mapping[str, float]
    max_cond: float
    cond_at: Mapping[str, float]


@dataclass(frozen=True, eq=False)
class _Scan:
    """Points of a box in unit coordinates, (d, k) from 0 to 1, and the way back to signals."""

    low: Array
    width: Array

    def signals(self, unit: ArrayLike) -> Array:
        unit = np.asarray(unit, dtype=np.float64)
        return self.low.reshape(-1, *[1] * (unit.ndim - 1)) + self.width.reshape(-1, *[1] * (unit.ndim - 1)) * unit

    def grid(self) -> Array:
        axes = np.meshgrid(*[np.linspace(0.0, 1.0, GRID)] * len(self.low), indexing="ij")
        return np.array([axis.ravel() for axis in axes]).reshape(len(self.low), -1)


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
    boxed, scan = names(box), _scan(box)
    free = law.column("the symbols", symbols, boxed)
    known = {along: symbols.get(along), **{n: symbols.get(n) for n in held}}
    if unknown := [n for n, s in known.items() if s is None]:
        raise SignalError(f"no symbol for {', '.join(unknown)}: there are {', '.join(symbols)}")
    best = []
    for point in points:
        values = dict(held) | {along: float(point)}
        old, new = law.column("the symbols", symbols, values), ca.vcat(list(values.values()))
        exprs = [ca.substitute(ca.SX(expr), old, ca.SX(new)) for expr in terms.values()]
        best.append([_largest(n, _compiled(e, free, scan), scan, boxed) for n, e in zip(terms, exprs, strict=True)])
    maxima = readonly([[value for value, _ in row] for row in best])
    worst = readonly([[scan.signals(at) for _, at in row] for row in best])
    return Magnitudes(along, readonly(points), tuple(terms), boxed, maxima, worst)


@arguments.checked
def conditioning(matrix: ca.SX, symbols: Exprs, box: Sequence[Signal]) -> Conditioning:
    """Return min |det| and max cond of a square `matrix` over `box`, and where they are.

    `symbols` maps the names in `box` to the symbols in `matrix`.

    Raises SignalError when the matrix contains another symbol, ModelError when it is not square or not finite.
    """
    if matrix.size1() != matrix.size2():
        raise ModelError(f"a matrix of shape {matrix.shape} has no determinant: give as many inputs as outputs")
    boxed, scan = names(box), _scan(box)
    free = law.column("the symbols", symbols, boxed)
    det_value, det_at = _least_determinant(_compiled(ca.det(matrix), free, scan), scan, boxed)
    evaluate = _function(ca.vec(matrix), free)
    n = matrix.size1()

    def cond(unit: Array) -> float:
        values = np.asarray(evaluate(scan.signals(unit))).reshape(n, n, order="F")
        return float(np.linalg.cond(values)) if np.isfinite(values).all() else np.inf

    cond_value, cond_at = _largest_condition(cond, scan)
    named = [dict(zip(boxed, map(float, scan.signals(at)), strict=True)) for at in (det_at, cond_at)]
    return Conditioning(det_value, named[0], cond_value, named[1])


@dataclass(frozen=True, eq=False)
class _Compiled:
    """A scalar expression over unit coordinates: many values at once, or one value with its gradient."""

    values: Callable[[Array], Array]
    slope: Callable[[Array], tuple[float, Array]]


def _scan(box: Sequence[Signal]) -> _Scan:
    if not box:
        raise SignalError("the box is empty: name at least one signal to vary")
    low = np.array([s.low for s in box])
    return _Scan(low, np.array([s.high for s in box]) - low)


def _function(exprs: ca.SX, free: ca.SX) -> ca.Function:
    own = {s.name() for s in ca.symvar(free)}
    if left := sorted({s.name() for s in ca.symvar(exprs)} - own):
        raise SignalError(f"the expression contains {', '.join(left)}: put each into the box, or hold it at a value")
    return ca.Function("e", [free], [ca.densify(exprs)])


def _compiled(expr: ca.SX, free: ca.SX, scan: _Scan) -> _Compiled:
    value, gradient = _function(expr, free), _function(ca.jacobian(expr, free), free)

    def slope(unit: Array) -> tuple[float, Array]:
        at = scan.signals(unit)
        return float(value(at)), np.asarray(gradient(at)).ravel() * scan.width

    return _Compiled(lambda unit: np.asarray(value(scan.signals(unit))).ravel(), slope)


def _finite(what: str, values: Array, unit: Array, scan: _Scan, boxed: Sequence[str]) -> None:
    bad = np.flatnonzero(~np.isfinite(values))
    if len(bad):
        at = scan.signals(unit[:, bad[0]])
        where = ", ".join(f"{n} = {v:.6g}" for n, v in zip(boxed, at, strict=True))
        raise ModelError(f"{what} is {values[bad[0]]} at {where}: shrink the box to where the model is finite")


def _largest(name: str, expr: _Compiled, scan: _Scan, boxed: Sequence[str]) -> tuple[float, Array]:
    unit = scan.grid()
    values = expr.values(unit)
    _finite(f"term '{name}'", values, unit, scan, boxed)
    seeds = np.argsort(-np.abs(values))[:SEEDS]
    tried = [_descend(expr, unit[:, k], -np.sign(values[k])) for k in seeds]
    tried += [(float(values[k]), unit[:, k]) for k in seeds]
    value, at = max(tried, key=lambda pair: abs(pair[0]))
    return abs(value), at


def _least_determinant(det: _Compiled, scan: _Scan, boxed: Sequence[str]) -> tuple[float, Array]:
    unit = scan.grid()
    values = det.values(unit)
    _finite("the determinant", values, unit, scan, boxed)
    seeds = np.argsort(np.abs(values))[:SEEDS]
    tried = [_descend(det, unit[:, k], np.sign(values[k])) for k in seeds]
    tried += [(float(values[k]), unit[:, k]) for k in seeds]
    signed = [*tried, (float(values.min()), unit[:, values.argmin()]), (float(values.max()), unit[:, values.argmax()])]
    below, above = min(signed, key=lambda pair: pair[0]), max(signed, key=lambda pair: pair[0])
    if below[0] <= 0 <= above[0]:
        return 0.0, _zero_between(det, below[1], above[1])
    value, at = min(tried, key=lambda pair: abs(pair[0]))
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
    """Return the value and place that descent of sign * expr within the box leads to."""
    scale = abs(expr.slope(start)[0]) or 1.0

    def objective(unit: Array) -> tuple[float, Array]:
        value, gradient = expr.slope(unit)
        return sign * value / scale, sign * gradient / scale

    at = minimize(objective, start, jac=True, bounds=[(0.0, 1.0)] * len(start), options={"ftol": 1e-15}).x
    return expr.slope(at)[0], at


def _largest_condition(cond: Callable[[Array], float], scan: _Scan) -> tuple[float, Array]:
    unit = scan.grid()
    values = np.array([cond(column) for column in unit.T])
    start = unit[:, values.argmax()]
    if not np.isfinite(values.max()):
        return float("inf"), start
    options = {"xatol": 1e-10, "fatol": 1e-12}
    at = minimize(lambda w: -cond(w), start, method="Nelder-Mead", bounds=[(0.0, 1.0)] * len(start), options=options).x
    return max((cond(at), at), (float(values.max()), start), key=lambda pair: pair[0])
