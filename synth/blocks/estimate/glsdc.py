"""Gaussian least squares differential correction (GLSDC): damped Gauss-Newton of fixed length with a descent check.

    minimise  J(d) = |V - h(q + d)|^2 + d' damping d

    d_0 = 0;   J(d_i) <= J(best) + slack ?   yes: best = d_i, d_i+1 = d_i + correction, within its bounds
                                             no:  d_i+1 = (best + d_i) / 2

for any measurement model h and any number of unknowns, i = 0 .. n-1: J is computed n times whatever the voltages are.
J(d_n) is not computed. d_n is the result only if the last correction is a small fraction of a standard deviation in the
metric of the normal equations, (gradient' N^-1 gradient)^(1/2) / deviation; otherwise the best d_i is the result.

A model supplies each trial with its normal equations, factorised without pivoting (`factorise_information`):

    N = H'H + damping = L D L',    D_j >= least_j,    |L_ij| <= (N_ii / least_j)^(1/2)

Both inequalities hold up to rounding. The code enforces them, which bounds every quantity computed from the factors.
`glsdc_estimator` makes a Block of all this from any measurement model.

Sources: Golub, Van Loan, "Matrix Computations", section 4.1 (LDL'); Kawato, Kim, "A Novel Multi-DOF Precision
Positioning Methodology Using Two-Axis Hall-Effect Sensors", Fig. 9.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import reduce
from math import sqrt
from operator import add
from typing import Generic, Protocol, TypeVar

import casadi as ca

from synth.block import clip
from synth.law import call, label
from synth.signals import Signal

UNLIMITED = 4

Vector = Sequence[ca.SX]
NamedExpressions = list[tuple[Signal, ca.SX]]
LimitStep = Callable[[int, ca.SX], tuple[ca.SX, ca.SX]]
"""Maps an unknown's index and its computed step to its limited value and the step actually taken."""


class NormalEquations(Protocol):
    """Normal equations at a trial."""

    @property
    def decrease(self) -> ca.SX:
        """gradient' N^-1 gradient: the decrease of the cost by a full correction, to first order."""

    def solve(self, choose: LimitStep, scale: float = 1.0) -> list[ca.SX]:
        """Return the unknowns after the step, N^-1 gradient times `scale`, by back substitution.

        `choose` limits each of them.
        """


N = TypeVar("N", bound=NormalEquations)


@dataclass(frozen=True, eq=False)
class Trial(Generic[N]):
    """A displacement (n,) with its residuals (m,), their sum of squares, its cost and its normal equations."""

    at: Vector
    residuals: Vector
    squares: ca.SX
    cost: ca.SX
    normal: N


@dataclass(frozen=True, eq=False)
class Solution(Generic[N]):
    """The resulting displacement (n,), the first and the last trial, and whether the corrections have converged."""

    at: Vector
    first: Trial[N]
    last: Trial[N]
    converged: ca.SX


@dataclass(frozen=True)
class Descent:
    """The number of `corrections`, each multiplied by `scale`, and the `bounds` of each unknown of d.

    A cost counts as no higher than the lowest one if it exceeds it by at most `slack` plus the relative `rounding`.
    The corrections have converged when the predicted decrease is at most `decrease_tolerance`.
    """

    corrections: int
    bounds: tuple[Signal, ...]
    slack: float
    decrease_tolerance: float
    rounding: float = 0.0
    scale: float = 1.0


def descend(evaluate: Callable[[int, Vector], Trial[N]], of: Descent) -> Solution[N]:
    """Return the result of the corrections; `evaluate` makes the i-th trial, whose displacement is 0 for i = 0."""

    def iteration(
        i: int, before: Trial[N], better: ca.SX, best: Vector, lowest: ca.SX
    ) -> tuple[Trial[N], ca.SX, Vector, ca.SX]:
        lowest = ca.if_else(better, before.cost, lowest)
        trial = evaluate(i, call("correction", _next, before, better, best, of))
        better = trial.cost <= (1 + of.rounding) * lowest + of.slack
        best = _choose(better, trial.at, best)
        label(better=better, best=best, lowest=lowest)
        return trial, better, best, lowest

    trial = first = call("first_trial", evaluate, 0, [ca.SX(0)] * len(of.bounds))
    best, lowest, better = trial.at, trial.cost, ca.SX(1)
    for i in range(1, of.corrections):
        trial, better, best, lowest = call(f"iteration_{i}", iteration, i, trial, better, best, lowest)

    def last_correction(trial: Trial[N], better: ca.SX, best: Vector) -> tuple[list[ca.SX], ca.SX]:
        untried = _next(trial, ca.SX(1), best, of)
        converged = ca.logic_and(better, trial.normal.decrease <= of.decrease_tolerance)
        label(better=better, untried=untried, best=best, converged=converged)
        return _choose(converged, untried, best), converged

    at, converged = call("last_correction", last_correction, trial, better, best)
    return Solution(at, first, trial, converged)


def iterate(evaluate: Callable[[int, Vector], Trial[N]], of: Descent) -> Solution[N]:
    """Return the result of the corrections without the descent check: every correction is applied."""

    def iteration(i: int, before: Trial[N]) -> Trial[N]:
        return evaluate(i, call("correction", _next, before, ca.SX(1), before.at, of))

    trial = first = call("first_trial", evaluate, 0, [ca.SX(0)] * len(of.bounds))
    for i in range(1, of.corrections):
        trial = call(f"iteration_{i}", iteration, i, trial)

    def last_correction(trial: Trial[N]) -> tuple[list[ca.SX], ca.SX]:
        return _next(trial, ca.SX(1), trial.at, of), trial.normal.decrease <= of.decrease_tolerance

    at, converged = call("last_correction", last_correction, trial)
    return Solution(at, first, trial, converged)


def _next(trial: Trial[N], better: ca.SX, best: Vector, of: Descent) -> list[ca.SX]:
    """Return the next displacement: the corrected trial if the trial is better, else halfway back to the best."""

    def choose(i: int, step: ca.SX) -> tuple[ca.SX, ca.SX]:
        end = clip(ca.if_else(better, trial.at[i] + step, (trial.at[i] + best[i]) / 2), of.bounds[i])
        return end, end - trial.at[i]

    return trial.normal.solve(choose, of.scale)


def _choose(condition: ca.SX, then: Vector, other: Vector) -> list[ca.SX]:
    return [ca.if_else(condition, a, b) for a, b in zip(then, other, strict=True)]


@dataclass(frozen=True, eq=False)
class LdlFactors:
    """N = L D L': L below the diagonal by rows, and 1/D."""

    lower: tuple[tuple[ca.SX, ...], ...]
    inverse: tuple[ca.SX, ...]


@dataclass(frozen=True, eq=False)
class LdlNormalEquations:
    """Normal equations as factors of N and `forward` = L^-1 gradient."""

    factors: LdlFactors
    forward: Vector

    @property
    def decrease(self) -> ca.SX:
        """gradient' N^-1 gradient."""
        return total(z * (z * d) for z, d in zip(self.forward, self.factors.inverse, strict=True))

    @property
    def step(self) -> list[ca.SX]:
        """N^-1 gradient, without limits."""
        return self.solve(lambda i, step: (step, step))

    def solve(self, choose: LimitStep, scale: float = 1.0) -> list[ca.SX]:
        """Return the unknowns after the step times `scale`, by back substitution from the last unknown on."""
        n = len(self.forward)
        ends, moves = [ca.SX(0)] * n, [ca.SX(0)] * n
        for i in reversed(range(n)):
            step = scale * (self.forward[i] * self.factors.inverse[i])
            for k in range(i + 1, n):
                step -= self.factors.lower[k][i] * moves[k]
            ends[i], moves[i] = choose(i, step)
            label(step=step)
        return ends


def information(rows: Sequence[Vector], others: Sequence[Vector], prior: Sequence[float]) -> list[list[ca.SX]]:
    """Return the lower triangle of H'G + diag(prior (n,)) by rows, of Jacobian rows H and G (m, n)."""
    return [
        [
            total(r[i] * s[j] for r, s in zip(rows, others, strict=True)) + (prior[i] if i == j else 0)
            for j in range(i + 1)
        ]
        for i in range(len(prior))
    ]


def factorise_information(left: list[list[ca.SX]], least: Sequence[float], ratio: float) -> tuple[LdlFactors, ca.SX]:
    """Return L and D of an information matrix N, its lower triangle `left`, and whether its diagonal is in range.

    A pivot is at least `least` (n,). While N_ii <= ratio^2 least_i, it follows that |L_ij| <= ratio (least_i /
    least_j)^(1/2), which is where L is limited. Outside, the factors are finite and wrong.
    """
    in_range = ca.SX(1)
    for i, floor in enumerate(least):
        in_range = ca.logic_and(in_range, left[i][i] <= ratio**2 * floor)
    label(left=left)
    return _eliminate(left, least, ratio**2), in_range


def _eliminate(left: list[list[ca.SX]], least: Sequence[float], squared_ratio: float) -> LdlFactors:
    left = [list(row) for row in left]
    lower: list[list[ca.SX]] = [[] for _ in least]
    inverse = []
    for j, floor in enumerate(least):
        inverse.append(1 / ca.fmax(left[j][j], floor))
        for i in range(j + 1, len(least)):
            bound = sqrt(squared_ratio * least[i] / floor)
            lower[i].append(clip(left[i][j] * inverse[j], Signal("lower", "1", -bound, bound)))
        for i in range(j + 1, len(least)):
            for k in range(j + 1, i + 1):
                left[i][k] -= lower[i][j] * left[k][j]
    label(lower=lower, inverse=inverse, left=left)
    return LdlFactors(tuple(map(tuple, lower)), tuple(inverse))


def substitute_forward(of: LdlFactors, right: Vector, bounds: Sequence[float] = ()) -> list[ca.SX]:
    """Return z = L^-1 right (n,); with `bounds`, z_j is limited to +-bounds_j from j = UNLIMITED on.

    Interval arithmetic multiplies the bound of z_j by that of L with each j; those before do not overflow.
    """
    z: list[ca.SX] = []
    for j, value in enumerate(right):
        each = reduce(lambda left, term: left - term[0] * term[1], zip(of.lower[j], z, strict=True), value)
        z.append(clip(each, Signal("z", "1", -bounds[j], bounds[j])) if bounds and j >= UNLIMITED else each)
    return z


def variances(of: LdlFactors) -> list[ca.SX]:
    """Return the diagonal of N^-1: sums of squares of L^-1 by columns."""
    n, diagonal = len(of.inverse), []
    for i in range(n):
        column: list[ca.SX] = [ca.SX(1)]
        for k in range(i + 1, n):
            column.append(-total(of.lower[k][j] * column[j - i] for j in range(i, k)))
        diagonal.append(total(w**2 * d for w, d in zip(column, of.inverse[i:], strict=True)))
    label(diagonal=diagonal)
    return diagonal


def dot(a: Vector, b: Vector) -> ca.SX:
    """Return a.b."""
    return total(u * v for u, v in zip(a, b, strict=True))


def total(terms: Iterable[ca.SX]) -> ca.SX:
    """Return the sum of the terms, 0 if there are none."""
    terms = list(terms)
    return reduce(add, terms) if terms else ca.SX(0)
