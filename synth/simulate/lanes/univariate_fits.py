"""Polynomials for functions of one variable of a lowered program, one for each set of parameters.

    f(v; p) -> sum_j c_j(p) t^j,   t = (2 v - low - high)/(high - low),   v in low .. high

Chebyshev interpolation gives the coefficients; the least degree is taken whose error, measured between the nodes on
some sets of parameters, is below a bound relative to the largest |f|.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from synth.emit.passes import univariate
from synth.emit.passes.univariate import Univariate
from synth.emit.program import numeric
from synth.emit.program.lower import Program
from synth.emit.proof.ranges import Range

Array = NDArray[np.float64]

DEGREES = range(4, 31)
SINES = frozenset({"sin", "cos"})


@dataclass(frozen=True, eq=False)
class Fit:
    """A polynomial of `degree` in t for a function of the lowered program, on low .. high of its variable."""

    function: Univariate
    low: float
    high: float
    degree: int

    def variable(self, t: Array) -> Array:
        """Return the variable at t in -1 .. 1."""
        return 0.5 * ((self.high - self.low) * t + (self.high + self.low))


def equal_functions(program: Program, R: Sequence[Range]) -> list[list[Univariate]]:
    """Return the functions of one variable in groups that are the same but for their variable; R are the ranges."""
    groups: dict[str, list[Univariate]] = {}
    for f in univariate.find(program, R):
        groups.setdefault(_key(program, f), []).append(f)
    return list(groups.values())


def _key(program: Program, f: Univariate) -> str:
    """Return the expression of a function in its variable; equal functions of different variables have equal keys.

    The rows follow the expression, not the order of the program's nodes.
    """
    place, rows, waiting = {f.variable: 0}, list[tuple[object, ...]](), [f.root]
    while waiting:
        k = waiting[-1]
        node = program.nodes[k]
        missing = [] if k in place else [a for a in node.args if a not in place]
        waiting += missing[::-1]
        if not missing:
            waiting.pop()
        if not missing and k not in place:
            place[k] = len(place)
            rows.append((node.op, *(place[a] for a in node.args), node.name, node.value))
    return repr(rows)


def number_of_sines(program: Program, f: Univariate) -> float:
    """Return how many sines and cosines make up a function, infinity if it has another function of libm."""
    inner, waiting = set[int](), [f.root]
    while waiting:
        k = waiting.pop()
        if k != f.variable and k not in inner:
            inner.add(k)
            waiting += program.nodes[k].args
    ops = [program.nodes[k].op for k in inner]
    others = univariate.TRANSCENDENTAL - SINES
    return np.inf if any(op in others for op in ops) else sum(op in SINES for op in ops)


def least_degree(
    program: Program, f: Univariate, known: Mapping[int, Array], low: float, high: float, error: float
) -> Fit | None:
    """Return the fit of the least degree with at most this error, or None; `known` has the parameters\' values."""
    for degree in DEGREES:
        fit = Fit(f, low, high, degree)
        if largest_error(program, fit, interpolate(program, fit, known), known).max() <= error:
            return fit
    return None


def _values(program: Program, fit: Fit, t: Array, known: Mapping[int, Array]) -> Array:
    """Return the function (points, plants) at t."""
    variable = {fit.function.variable: fit.variable(t)[:, np.newaxis]}
    return np.asarray(numeric.evaluate(program, [fit.function.root], {**known, **variable})[fit.function.root])


def interpolate(program: Program, fit: Fit, known: Mapping[int, Array]) -> Array:
    """Return the coefficients (degree + 1, plants), lowest power first."""
    n = fit.degree + 1
    angle = np.pi * (np.arange(n) + 0.5) / n
    values = _values(program, fit, np.cos(angle), known)
    series = _weighted_sums(np.array([np.cos(j * angle) for j in range(n)]), values)
    series = series * np.where(np.arange(n), 2.0, 1.0)[:, np.newaxis] / n
    return _weighted_sums(_powers(n).T, series)


@cache
def _powers(n: int) -> Array:
    """Return the coefficients of the first n Chebyshev polynomials in their rows, lowest power first."""
    return np.array([np.pad(chebyshev.cheb2poly(row), (0, n - 1 - j)) for j, row in enumerate(np.eye(n))])


def _weighted_sums(weights: Array, rows: Array) -> Array:
    """Return weights (m, n) times rows (n, plants) in a fixed order: a matrix product rounds as its library decides."""
    total = np.zeros((len(weights), *rows.shape[1:]))
    for weight, row in zip(weights.T, rows, strict=True):
        total = total + weight[:, np.newaxis] * row
    return total


def largest_error(program: Program, fit: Fit, coefficients: Array, known: Mapping[int, Array]) -> Array:
    """Return the largest error (plants,) between the nodes, relative to the largest value."""
    t = np.linspace(-1.0, 1.0, 4 * fit.degree + 1)
    value = np.zeros((len(t), 1)) + coefficients[-1]
    for c in coefficients[-2::-1]:
        value = c + t[:, np.newaxis] * value
    truth = _values(program, fit, t, known)
    return np.asarray(np.abs(value - truth).max(axis=0) / np.abs(truth).max(axis=0))
