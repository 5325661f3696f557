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

    p_i = overbound (max over passing j of |q_ji - q_ki| + k max over passing j of sigma_ji)

The true hypothesis passes with 1 - risk/2, and its estimate is within k sigma: again at most the risk, for h linear
over the separations. One that has passed since the exclusion counts as passing (`glsdc_monitor`).

Channels that fail together, as the two of a sensor, form a group, with columns W_G and S = W_G'W_G - W_G'H N^-1 H'W_G.
Its factors S = L D L' turn the columns into independent ones, x <- L^-1 x, u <- L^-1 u, s <- D, and each term above
into a sum over the group: x_i' S^-1 x_i for x_ij^2 / s_j, and u' S^-1 u for u_j^2 / s_j, with n - g freedoms left.

A prior counts as a measurement without faults. The faults are those of a single group, the errors are normal with the
covariance R, and h is linear over the separations of hypotheses that pass.

Sources: Brown, "A Baseline GPS RAIM Scheme", Navigation 39 (1992); Walter, Enge, "Weighted RAIM for Precision
Approach", ION GPS (1995); Blanch et al., "Advanced RAIM User Algorithm Description", ION GNSS (2012).

Gauss-Newton corrections without an excluded group of channels, by a rank update of the factors of all channels.

    N = H'H + P = L D L'  of all channels at the prediction, once a sample;   x_j, gain_j = 1/s_j of `glsdc_integrity`
    N_k = N - H_k'H_k,    N_k^-1 = N^-1 + sum over j of group k of x_j gain_j x_j'        (Woodbury)

    first correction    q - x_j u_j gain_j        from the solution q of all channels, with their scores u_j
    later ones          N_k^-1 g,                 g = H'e - P (o + d) without the residuals of the group

The hypotheses that monitor the solution have computed x_j, gain_j and u_j anyway: there is no second factorisation.
Each displacement is limited by itself.

Source: Golub, Van Loan, "Matrix Computations", section 2.1.4 (Sherman-Morrison-Woodbury formula).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import reduce
from math import sqrt

import casadi as ca
from scipy import optimize, stats

from synth import arguments, numeric
from synth.block import clip
from synth.blocks.estimate import glsdc, glsdc_jacobian, glsdc_solution
from synth.blocks.estimate.glsdc import LdlFactors, LdlNormalEquations, LimitStep, Solution, Trial, Vector, dot, total
from synth.blocks.estimate.glsdc_jacobian import Linearisation, Model
from synth.blocks.estimate.glsdc_solution import DYNAMIC_RANGE, Iteration, Normal, Problem
from synth.errors import ModelError, SignalError
from synth.law import call, label
from synth.signals import Signal

DETECTABLE = 1e-3  # least s_j of a unit w_j: below, single precision does not tell a fault from a motion
ROUNDING = 1e-5  # relative error of c_j by cancellation in single precision, added to T_1
MOST_FREEDOM = 1000
LEAST_PROBABILITY = 1e-12  # below, double precision loses the noncentral distribution


@arguments.checked
@dataclass(frozen=True)
class Integrity:
    """What is asked of the monitor: `limits` of the protection levels by unknown, in its unit (alert limits).

    `false_alarm`: probability that a sample without fault fails the test. `risk`: largest probability that a sample is
    valid and an unknown errs by more than its protection level. With `exclude`, a faulty channel is excluded, or its
    group: `groups` are the channels that fail together, and any other channel is a group by itself, after these.
    `screened`: a check in front, as `glsdc_search.screen`, gives the number of a group to exclude, ``rejected``, and
    ``screened`` in place of ``complete``. `excluded_limits` multiplies the limits while a group is excluded: what is
    left has less redundancy, and a limit that allows a fault to come may be too wide for one that is there. `overbound`
    multiplies the levels while a group is excluded: more than 1 where the errors of the model are not normal, or where
    h bends over the separations of hypotheses.

    Raises ModelError for a probability or a limit out of its range.
    """

    limits: Mapping[str, float]
    false_alarm: float = numeric.between(0, 1e-5, 0.5)
    risk: float = numeric.between(0, 1e-4, 0.5)
    exclude: bool = False
    groups: Sequence[Sequence[str]] = ()
    screened: bool = False
    excluded_limits: float = numeric.between(0, 1.0, 1)
    overbound: float = numeric.between(0, 1.0, 10)

    def __post_init__(self) -> None:
        numeric.check_fields(self)
        for name, limit in self.limits.items():
            numeric.positive(f"the limit of the protection level of '{name}'", limit)

    def index_groups(self, names: Sequence[str]) -> tuple[tuple[int, ...], ...]:
        """Return the groups as indices of all channels, which have these names.

        Raises SignalError for a group without channels, a name that is no channel, and one that is listed twice.
        """
        listed = [name for group in self.groups for name in group]
        strangers = [n for n in listed if n not in names]
        repeated = [n for n in listed if listed.count(n) > 1]
        if strangers or repeated or not all(self.groups):
            wrong = f"'{(strangers or repeated)[0]}'" if strangers or repeated else "no channel"
            raise SignalError(f"a group has {wrong}: give each of {', '.join(names)} in one group at most")
        alone = [[name] for name in names if name not in listed]
        return tuple(tuple(names.index(n) for n in group) for group in (*self.groups, *alone))


@dataclass(frozen=True)
class Thresholds:
    """T (`test`), L (`noncentrality`), k (`deviations`) and T_1 (`hypothesis`, infinite without a freedom for it)."""

    test: float
    noncentrality: float
    deviations: float
    hypothesis: float


@arguments.checked
def thresholds(freedom: int, false_alarm: float, risk: float, together: int = 1) -> Thresholds:
    """Return the thresholds of a test with `freedom` degrees of freedom, and of a group of channels that fail together.

    Raises ModelError for no freedom, no channel in the group, and for a probability out of LEAST_PROBABILITY .. 0.5.
    """
    n = numeric.whole("the degrees of freedom", freedom, 1, MOST_FREEDOM)
    left = n - numeric.whole("the number of channels that fail together", together, 1, MOST_FREEDOM)
    false_alarm, risk = (
        numeric.above(name, p, LEAST_PROBABILITY, 0.5)
        for name, p in (("the false alarm", false_alarm), ("the risk", risk))
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
    hypothesis = float(stats.chi2.isf(risk / 2, left)) if left > 0 else float("inf")
    return Thresholds(test, float(optimize.brentq(miss, 0.0, high)), float(stats.norm.isf(risk / 4)), hypothesis)


@dataclass(frozen=True, eq=False)
class Hypotheses:
    """For each channel, of a unit w_j: slope H'w_j (n,), and after L^-1 of its group the move x_j (n,) and gain 1/s_j.

    `groups` are the indices of the channels that fail together, and `mixing` the rows of L of each group below its
    diagonal. `detectable`: every s_j is large enough to be known.
    """

    groups: Sequence[Sequence[int]]
    slopes: Sequence[Vector]
    moves: Sequence[Vector]
    gains: Vector
    mixing: Sequence[Sequence[Vector]]
    detectable: ca.SX


def hypotheses(
    groups: Sequence[Sequence[int]],
    factors: LdlFactors,
    linear: Linearisation,
    floors: Sequence[float],
    ratio: float,
) -> Hypotheses:
    """Return the hypotheses of each group.

    With least pivots f (n,), |x_ij| <= f_i^(-1/2) and |L^-1 H'w_j| <= ratio f^(1/2) up to rounding: these limit them.
    """
    of_groups = [
        call(f"hypothesis_{n}", _hypothesis, group, factors, linear, floors, ratio) for n, group in enumerate(groups, 1)
    ]
    by_channel = {j: (h, k) for group, h in zip(groups, of_groups, strict=True) for k, j in enumerate(group)}
    channels = [by_channel[j] for j in range(len(by_channel))]
    slopes, moves = [h.slopes[k] for h, k in channels], [h.moves[k] for h, k in channels]
    gains, mixing = [h.members.inverse[k] for h, k in channels], [h.members.lower for h in of_groups]
    detectable = ca.SX(1)
    for gain in (gain for h in of_groups for gain in h.members.inverse):
        detectable = ca.logic_and(detectable, gain < (1 - ROUNDING) / DETECTABLE)
    label(gain=gains, detectable=detectable)
    return Hypotheses(groups, slopes, moves, gains, mixing, detectable)


@dataclass(frozen=True, eq=False)
class _Hypothesis:
    """The hypothesis of a group: slopes, moves after L^-1 (g, n), and the factors of its separability S."""

    slopes: Sequence[Vector]
    moves: Sequence[Vector]
    members: LdlFactors


def _hypothesis(
    group: Sequence[int], factors: LdlFactors, linear: Linearisation, floors: Sequence[float], ratio: float
) -> _Hypothesis:
    slopes, units = [], {}
    for j in group:
        slopes.append([dot_sparse(linear.directions[j], [row[i] for row in linear.rows]) for i in range(len(floors))])
        forward = glsdc.substitute_forward(factors, slopes[-1], [ratio * sqrt(f) for f in floors])
        units[j] = LdlNormalEquations(factors, forward)
        label(str(j + 1), forward=forward)
    moves = [_limit_moves(unit.step, floors) for unit in units.values()]
    members = _separabilities(group, units, linear)
    mixed = [_decorrelate([move[i] for move in moves], members.lower) for i in range(len(floors))]
    return _Hypothesis(slopes, [[column[k] for column in mixed] for k in range(len(group))], members)


def _limit_moves(move: Vector, floors: Sequence[float]) -> list[ca.SX]:
    """Return a move (n,) within its limits; of a few unknowns, interval arithmetic does not overflow without them."""
    if len(move) <= glsdc.UNLIMITED:
        return list(move)
    return [clip(x, Signal("x", "1", -2 / sqrt(f), 2 / sqrt(f))) for x, f in zip(move, floors, strict=True)]


def _separabilities(group: Sequence[int], units: Mapping[int, LdlNormalEquations], linear: Linearisation) -> LdlFactors:
    """Return the factors of S = W_G'W_G - W_G'H N^-1 H'W_G (g, g), each pivot DETECTABLE at least."""
    S = []
    for k, a in enumerate(group):
        products = zip(units[a].forward, units[a].factors.inverse, strict=True)
        weighted = [z * d for z, d in products]
        label(str(a + 1), weighted=weighted)
        row = [
            dot_sparse(linear.directions[a], _dense(linear.directions[b], len(linear.directions)))
            - glsdc.dot(weighted, units[b].forward)
            for b in group[:k]
        ]
        S.append([*row, 1 - units[a].decrease])
    label(S=S)
    return glsdc.factorise_information(S, [DETECTABLE] * len(group), 1 / sqrt(DETECTABLE))[0]


def _dense(direction: Mapping[int, ca.SX], m: int) -> list[ca.SX]:
    return [direction.get(k, ca.SX(0)) for k in range(m)]


def _decorrelate(values: Vector, lower: Sequence[Vector]) -> list[ca.SX]:
    """Return L^-1 values (g,), with the rows of L below its diagonal."""
    solved: list[ca.SX] = []
    for row, value in zip(lower, values, strict=True):
        solved.append(reduce(lambda left, term: left - term[0] * term[1], zip(row, solved, strict=True), value))
    return solved


def decorrelate(of: Hypotheses, scores: Vector) -> list[ca.SX]:
    """Return the scores u_j (m,) after L^-1 of each group."""
    solved = list(scores)
    for group, lower in zip(of.groups, of.mixing, strict=True):
        for j, u in zip(group, _decorrelate([scores[j] for j in group], lower), strict=True):
            solved[j] = u
    return solved


def dot_sparse(weights: Mapping[int, ca.SX], values: Vector) -> ca.SX:
    """Return the sum of weight times value over the rows that have a weight."""
    return glsdc.total(w * values[k] for k, w in weights.items())


def detected_level(of: Hypotheses, i: int, thresholds: Thresholds, scale: float, sigma: ca.SX) -> ca.SX:
    """Return s (L max_G x_i' S^-1 x_i)^(1/2) + k sigma_i: the protection level of an estimate that passes the test."""
    worst = reduce(ca.fmax, [_added_variance(of, group, i) for group in of.groups], ca.SX(0))
    return scale * sqrt(thresholds.noncentrality) * ca.sqrt(worst) + thresholds.deviations * sigma


def _added_variance(of: Hypotheses, group: Sequence[int], i: int) -> ca.SX:
    """Return x_i' S^-1 x_i of a group: what its exclusion adds to the variance of unknown i, over s^2."""
    return glsdc.total(of.moves[j][i] ** 2 * of.gains[j] for j in group)


def costs(of: Hypotheses, scores: Vector, cost: ca.SX) -> list[ca.SX]:
    """Return the cost c_j s^2 of each hypothesis; `scores` are u_j (m,) by `decorrelate`, `cost` is c s^2 of all."""
    label(scores=scores)
    return [cost - glsdc.total(scores[j] * (scores[j] * of.gains[j]) for j in group) for group in of.groups]


def most_likely(costs: Vector) -> ca.SX:
    """Return the number, from 1, of the hypothesis with the least cost."""
    least, number = costs[0], ca.SX(1)
    for j, cost in enumerate(costs[1:], 2):
        number, least = ca.if_else(cost < least, j, number), ca.fmin(cost, least)
    label(least=least, number=number)
    return number


def most_costly(costs: Vector) -> ca.SX:
    """Return the number, from 1, of the hypothesis with the largest cost above 0; 0 without one."""
    largest, number = costs[0], ca.if_else(costs[0] > 0, 1, 0)
    for j, cost in enumerate(costs[1:], 2):
        number, largest = ca.if_else(cost > largest, j, number), ca.fmax(cost, largest)
    label(number=number)
    return number


@dataclass(frozen=True, eq=False)
class Full:
    """The solution with all channels: displacement (n,), variances (n,) over s^2, and scores u_j (m,), decorrelated."""

    step: Vector
    variances: Vector
    scores: Vector


def separated_level(of: Hypotheses, i: int, full: Full, passing: Vector, reported: ca.SX, deviations: float) -> ca.SX:
    """Return max |q_ji - reported| + k max sigma_ji over the `passing` hypotheses; `deviations` is k s."""
    apart, added = ca.SX(0), ca.SX(0)
    for group, passes in zip(of.groups, passing, strict=True):
        separation = glsdc.total(of.moves[j][i] * (full.scores[j] * of.gains[j]) for j in group)
        difference = ca.fabs(full.step[i] - reported - separation)
        apart = ca.if_else(passes, ca.fmax(apart, difference), apart)
        added = ca.if_else(passes, ca.fmax(added, _added_variance(of, group, i)), added)
    label(added=added, apart=apart)
    return apart + deviations * ca.sqrt(full.variances[i] + added)


@dataclass(frozen=True, eq=False)
class Separation:
    """The hypotheses about a trial, the solution with all channels and its cost c s^2, and whether N is in range."""

    faults: Hypotheses
    full: Full
    cost: ca.SX
    in_range: ca.SX


@dataclass(frozen=True, eq=False)
class Removal:
    """x_j (n,) and gain_j of the excluded group; without one the gains are 0."""

    moves: Sequence[Vector]
    gains: Vector


@dataclass(frozen=True, eq=False)
class Reduced(Normal):
    """Normal equations of a trial without the excluded group, on the factors of all channels.

    `projections` are x_j'g, or -u_j at the first trial, whose `forward` is of all channels; `dropped` are then the
    squared residuals of the group, else 0.
    """

    removal: Removal
    projections: Vector
    dropped: ca.SX

    @property
    def decrease(self) -> ca.SX:
        """g' N_k^-1 g."""
        added = total(gain * p**2 for gain, p in zip(self.removal.gains, self.projections, strict=True))
        return super().decrease - self.dropped + added

    @property
    def variances(self) -> list[ca.SX]:
        """The diagonal of N_k^-1."""
        gains, moves = self.removal.gains, self.removal.moves
        added = [total(gain * x[i] ** 2 for gain, x in zip(gains, moves, strict=True)) for i in range(len(self.pulls))]
        return [v + a for v, a in zip(super().variances, added, strict=True)]

    def solve(self, choose: LimitStep, scale: float = 1.0) -> list[ca.SX]:
        """Return the unknowns after the step N_k^-1 g times `scale`, each limited by itself."""
        scaled = [gain * p for gain, p in zip(self.removal.gains, self.projections, strict=True)]
        steps = super().solve(lambda i, step: (step, step))
        added = [total(x[i] * v for x, v in zip(self.removal.moves, scaled, strict=True)) for i in range(len(steps))]
        label(steps=steps, added=added)
        return [choose(i, scale * (step + a))[0] for i, (step, a) in enumerate(zip(steps, added, strict=True))]


def solve(
    of: Problem,
    iteration: Iteration,
    groups: Sequence[Sequence[int]],
    excluded: ca.SX,
    axes: Sequence[Mapping[int, ca.SX]],
) -> tuple[Solution[Reduced], Separation]:
    """Return the solution of a sample with the Jacobian of the prediction, and the hypotheses about this.

    `excluded` is the number of the group that the weights leave out, 0 for none; `axes` are the unit vectors along
    which the channels of a group act.
    """
    of_all, begin = replace(of, weights=None), linearise(of, [ca.SX(0)] * len(of.offsets))
    factors = call("factors", glsdc_solution.factorise, of.model, begin.rows, begin.rows)
    whole = call("normal_equations", glsdc_solution.trial, of_all, [ca.SX(0)] * len(of.offsets), begin, factors)
    about = replace(begin, directions=axes)
    separation = call("separation", _separation, of.model, groups, *factors, whole, about)
    columns, gains, scores = call("removal", _removal, groups, separation, excluded)
    removal = Removal(columns, [ca.if_else(excluded < 1, 0, gain) for gain in gains])
    most = largest_projection(of.model)
    bound = Signal("projection", "1", -most, most)

    def trial(i: int, at: Vector) -> Trial[Reduced]:
        linear = replace(begin, residuals=linearise(of, at).residuals) if i else begin
        one = glsdc_solution.trial(of, at, linear, factors)
        used = glsdc_solution.weighted(of, linear.residuals)
        if i:
            gradient = glsdc_solution.gradient_of(linear.rows, used, one.normal.pulls)
            projections = [clip(dot(x, gradient), bound) for x in removal.moves]
            label(gradient=gradient, projection=projections)
            normal = _without_group(one.normal, removal, projections, ca.SX(0))
        else:
            dropped = whole.squares - one.squares
            normal = _without_group(whole.normal, removal, [-u for u in scores], dropped)
        return Trial(at, one.residuals, one.squares, one.cost, normal)

    label(in_range=factors[1], scores=scores)
    return glsdc_solution.iterate(of.model, iteration, trial), separation


def largest_projection(of: Model) -> float:
    """Return the bound of |x_j'g|: at most |e|, and what the factors of its group add; it keeps the square finite."""
    return (1 + 1 / sqrt(DETECTABLE)) * glsdc_solution.residual_bound(of)


def linearise(of: Problem, at: Vector) -> Linearisation:
    """Return the linearisation of a problem at a displacement."""
    return glsdc_jacobian.linearise(of.model, of.prediction, at)


def _without_group(of: Normal, removal: Removal, projections: Vector, dropped: ca.SX) -> Reduced:
    return Reduced(of.factors, of.forward, of.linear, of.pulls, of.in_range, removal, projections, dropped)


def _removal(
    groups: Sequence[Sequence[int]], of: Separation, excluded: ca.SX
) -> tuple[list[list[ca.SX]], list[ca.SX], list[ca.SX]]:
    """Return x_j, gain_j and the scores u_j of the excluded group, those of the first one without one."""

    def member(values: Vector, j: int) -> ca.SX:
        return choose(excluded, [values[group[j]] if j < len(group) else ca.SX(0) for group in groups])

    sizes, moves = range(max(map(len, groups))), of.faults.moves
    columns = [[member([x[i] for x in moves], j) for i in range(len(moves[0]))] for j in sizes]
    gains, scores = ([member(values, j) for j in sizes] for values in (of.faults.gains, of.full.scores))
    label(moves=moves)
    label("excluded", move=columns, gain=gains, score=scores)
    return columns, gains, scores


def choose(number: ca.SX, values: Vector) -> ca.SX:
    """Return the value of a number from 1 on, the first one of 0, by halving: both outcomes of a comparison occur."""

    def between(low: int, high: int) -> ca.SX:
        if high - low == 1:
            return values[low - 1]
        middle = (low + high) // 2
        return ca.if_else(number < middle, between(low, middle), between(middle, high))

    return between(1, len(values) + 1)


def separate(of: Model, groups: Sequence[Sequence[int]], about: Trial[Normal], linear: Linearisation) -> Separation:
    """Return the hypotheses about a trial; `linear` has the unit vectors along which the channels of a group act."""
    factors, in_range = glsdc_solution.factorise(of, about.normal.linear.rows, about.normal.linear.rows)
    return _separation(of, groups, factors, in_range, about, linear)


def _separation(
    of: Model,
    groups: Sequence[Sequence[int]],
    factors: LdlFactors,
    in_range: ca.SX,
    about: Trial[Normal],
    linear: Linearisation,
) -> Separation:
    faults = hypotheses(groups, factors, linear, of.floors, DYNAMIC_RANGE)
    normal, e = about.normal, about.normal.linear.residuals
    gradient = glsdc_solution.gradient_of(normal.linear.rows, e, normal.pulls)
    forward = glsdc.substitute_forward(factors, gradient, glsdc_solution.forward_bounds(of))
    all_channels = LdlNormalEquations(factors, forward)
    step = _limit_step(of, all_channels.step)
    scores = [dot_sparse(w, e) - dot(slope, step) for w, slope in zip(linear.directions, faults.slopes, strict=True)]
    cost = ca.fmax(dot(e, e) + about.cost - about.squares - all_channels.decrease, 0)
    full = Full(step, glsdc.variances(factors), decorrelate(faults, scores))
    label(gradient=gradient, forward=forward, scores=scores)
    return Separation(faults, full, cost, in_range)


def _limit_step(of: Model, step: Vector) -> list[ca.SX]:
    if len(step) <= glsdc.UNLIMITED:
        return list(step)
    bounds = [glsdc_solution.residual_bound(of) / sqrt(f) for f in of.floors]
    return [clip(d, Signal("step", "1", -b, b)) for d, b in zip(step, bounds, strict=True)]
