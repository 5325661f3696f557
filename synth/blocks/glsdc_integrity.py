"""Integrity monitoring (RAIM) of a least-squares estimate: chi-square test, protection levels, fault exclusion.

A fault of size b in channel j adds b w_j to the whitened residuals, with w_j column j of W de/dy. With N = H'H + P at
the estimate, x_j = N^-1 H'w_j and s_j = w_j'w_j - (H'w_j)'x_j, and c the least cost over s^2 (weighted sum of squared
residuals and priors, WSSE), n degrees of freedom:

    no fault           c ~ chi2(n)                          test: c <= T,        P(chi2(n) > T) = false alarm
    a fault in j       c ~ chi2(n, b^2 s_j / s^2)           P(chi2(n, L) <= T) = risk
    protection level   p_i = s max_j |x_ij| (L / s_j)^(1/2) + k sigma_i,         P(|N(0, 1)| > k) = risk / 2

The noise of the estimate is independent of c. A fault above the noncentrality L therefore passes with less than the
risk, and one below it moves the estimate by no more than the first term: the probability that a sample passes while
|q_i - estimate| > p_i is at most the risk, for a fault in any single channel and for none.

Exclusion (solution separation): hypothesis j, that channel j is at fault, has the estimate q_j = q - x_j u_j / s_j, the
cost c_j = c - u_j^2 / (s_j s^2) with u_j = w_j'e, and the variance sigma_i^2 + s^2 x_ij^2 / s_j. It passes if c_j is at
most T_1, P(chi2(n-1) > T_1) = risk / 2. All hypotheses that pass must agree: with channel k excluded

    p_i = max over passing j of |q_ji - q_ki| + k max over passing j of sigma_ji

The true hypothesis passes with 1 - risk/2, and its estimate is within k sigma: again at most the risk.

A prior counts as a measurement without faults. The faults are those of a single channel, the errors are normal with the
covariance R, and h is linear over the separations of hypotheses that pass.

Sources: Brown, "A Baseline GPS RAIM Scheme", Navigation 39 (1992); Walter, Enge, "Weighted RAIM for Precision
Approach", ION GPS (1995); Blanch et al., "Advanced RAIM User Algorithm Description", ION GNSS (2012).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import reduce
from math import sqrt

import casadi as ca
from scipy import optimize, stats

from synth import arguments, numeric
from synth.block import clip
from synth.blocks import glsdc
from synth.blocks.glsdc import LdlFactors, LdlNormalEquations, Vector
from synth.blocks.glsdc_linearisation import Linearisation
from synth.errors import ModelError
from synth.signals import Signal

DETECTABLE = 1e-3  # least s_j of a unit w_j: below, single precision does not tell a fault from a motion
ROUNDING = 1e-5  # relative error of c_j by cancellation in single precision, added to T_1
MOST_FREEDOM = 1000


@dataclass(frozen=True)
class Integrity:
    """What is asked of the monitor: `limits` of the protection levels by unknown, in its unit (alert limits).

    `false_alarm`: probability that a sample without fault fails the test. `risk`: largest probability that a sample is
    valid and an unknown errs by more than its protection level. With `exclude`, a faulty channel is excluded.

    Raises ModelError for a probability or a limit out of its range.
    """

    limits: Mapping[str, float]
    false_alarm: float = numeric.between(0, 1e-5, 0.5)
    risk: float = numeric.between(0, 1e-4, 0.5)
    exclude: bool = False

    def __post_init__(self) -> None:
        numeric.check_fields(self)
        for name, limit in self.limits.items():
            numeric.positive(f"the limit of the protection level of '{name}'", limit)


@dataclass(frozen=True)
class Thresholds:
    """T (`test`), L (`noncentrality`), k (`deviations`) and T_1 (`hypothesis`, infinite without a freedom for it)."""

    test: float
    noncentrality: float
    deviations: float
    hypothesis: float


@arguments.checked
def thresholds(freedom: int, false_alarm: float, risk: float) -> Thresholds:
    """Return the thresholds of a test with `freedom` degrees of freedom.

    Raises ModelError for no freedom, and for a probability out of 0 .. 0.5.
    """
    n = numeric.whole("the degrees of freedom", freedom, 1, MOST_FREEDOM)
    false_alarm, risk = (
        numeric.above(name, p, 0, 0.5) for name, p in (("the false alarm", false_alarm), ("the risk", risk))
    )
    test = float(stats.chi2.isf(false_alarm, n))

    def miss(noncentrality: float) -> float:
        return float(stats.ncx2.cdf(test, n, noncentrality)) - risk

    if miss(0.0) <= 0:
        raise ModelError(
            f"the false alarm is {false_alarm} and the risk {risk}: the test refuses so much that no fault is "
            "undetected with this risk, choose a smaller false alarm or a smaller risk"
        )
    high = 1.0
    while miss(high) > 0:
        high *= 2
    hypothesis = float(stats.chi2.isf(risk / 2, n - 1)) if n > 1 else float("inf")
    return Thresholds(test, float(optimize.brentq(miss, 0.0, high)), float(stats.norm.isf(risk / 4)), hypothesis)


@dataclass(frozen=True, eq=False)
class Hypotheses:
    """For each channel, of a unit w_j: slope H'w_j and move x_j, (n,), and the gain 1/s_j.

    `detectable`: every s_j is large enough to be known.
    """

    slopes: Sequence[Vector]
    moves: Sequence[Vector]
    gains: Vector
    detectable: ca.SX


def hypotheses(factors: LdlFactors, linear: Linearisation, floors: Sequence[float], ratio: float) -> Hypotheses:
    """Return the hypotheses of each channel.

    With least pivots f (n,), |x_ij| <= f_i^(-1/2) and |L^-1 H'w_j| <= ratio f^(1/2) up to rounding: these limit them.
    """
    slopes, moves, gains, detectable = [], [], [], ca.SX(1)
    for w in linear.directions:
        slope = [dot_sparse(w, [row[i] for row in linear.rows]) for i in range(len(floors))]
        forward = glsdc.substitute_forward(factors, slope, [ratio * sqrt(f) for f in floors])
        unit = LdlNormalEquations(factors, forward)
        separable = 1 - unit.decrease
        slopes.append(slope)
        moves.append(
            [clip(x, Signal("x", "1", -2 / sqrt(f), 2 / sqrt(f))) for x, f in zip(unit.step, floors, strict=True)]
        )
        detectable = ca.logic_and(detectable, separable > DETECTABLE)
        gains.append(1 / ca.fmax(separable, DETECTABLE))
    return Hypotheses(slopes, moves, gains, detectable)


def dot_sparse(weights: Mapping[int, ca.SX], values: Vector) -> ca.SX:
    """Return the sum of weight times value over the rows that have a weight."""
    return glsdc.total(w * values[k] for k, w in weights.items())


def detected_level(of: Hypotheses, i: int, thresholds: Thresholds, scale: float, sigma: ca.SX) -> ca.SX:
    """Return s (L max_j x_ij^2 / s_j)^(1/2) + k sigma_i: the protection level of an estimate that passes the test."""
    worst = reduce(ca.fmax, [x[i] ** 2 * gain for x, gain in zip(of.moves, of.gains, strict=True)])
    return scale * sqrt(thresholds.noncentrality) * ca.sqrt(worst) + thresholds.deviations * sigma


def costs(of: Hypotheses, scores: Vector, cost: ca.SX) -> list[ca.SX]:
    """Return the cost c_j s^2 of each hypothesis; `scores` are u_j (m,), `cost` is c s^2 with all channels."""
    return [cost - u**2 * gain for u, gain in zip(scores, of.gains, strict=True)]


def most_likely(costs: Vector) -> ca.SX:
    """Return the number, from 1, of the hypothesis with the least cost."""
    least, number = costs[0], ca.SX(1)
    for j, cost in enumerate(costs[1:], 2):
        number, least = ca.if_else(cost < least, j, number), ca.fmin(cost, least)
    return number


@dataclass(frozen=True, eq=False)
class Full:
    """The solution with all channels: its displacement (n,), its variances (n,) over s^2, and the scores u_j (m,)."""

    step: Vector
    variances: Vector
    scores: Vector


def separated_level(of: Hypotheses, i: int, full: Full, passing: Vector, reported: ca.SX, deviations: float) -> ca.SX:
    """Return max |q_ji - reported| + k max sigma_ji over the `passing` hypotheses (m,); `deviations` is k s."""
    apart, added = ca.SX(0), ca.SX(0)
    for x, gain, u, passes in zip(of.moves, of.gains, full.scores, passing, strict=True):
        apart = ca.fmax(apart, ca.if_else(passes, ca.fabs(full.step[i] - x[i] * (u * gain) - reported), 0))
        added = ca.fmax(added, ca.if_else(passes, x[i] ** 2 * gain, 0))
    return apart + deviations * ca.sqrt(full.variances[i] + added)
