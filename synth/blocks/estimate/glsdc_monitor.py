"""Integrity monitor of a weighted least-squares estimator: test, protection levels and exclusion in each sample.

    excluded = 0:  valid needs c <= T;      protection levels of the test
    excluded = k:  valid needs c_k <= T_1;  protection levels of the separations from hypothesis k

A converged sample whose c exceeds T excludes the group of the hypothesis with the least cost from the next sample on;
one whose c does not takes every channel in again. A group is a channel, or several that fail together. One that a check
in front has refused is excluded in the same sample. The c and the hypotheses that decide on this are of all channels,
linear about the estimate in use, or with a search about the prediction of the track: a large fault moves the estimate
out of the linear range, and not the prediction. With a held Jacobian these hypotheses also leave the group out of the
corrections (`glsdc_integrity`). Nothing is valid where a fault of some group is not detectable.

    plausible_j = plausible_j or hypothesis j passes      since a group is excluded; it counts in the levels, too
    doubted     = a level is above its limit and a hypothesis beside the one in use is plausible, or in a trial
    competing   = the plausible hypothesis of the largest cost that fails now, after a doubted sample
    plausible_competing = 0 if its own solution has c > REFUTED T_1

Which group is at fault is then not known, and following the wrong one takes the prediction out of the range in which
the right hypothesis is linear: that it fails its test later says nothing. It is therefore remembered until the
corrections without its group, which are not linear, fail. Such a trial takes the sample after a doubted one: the track
goes on by its motion, and the sample is not valid. A group that the check in front has refused is not in doubt.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import casadi as ca
import numpy as np

from synth.block import Exprs, State, clip
from synth.blocks.estimate import glsdc, glsdc_integrity, glsdc_solution
from synth.blocks.estimate.glsdc import LdlFactors, Solution, Vector
from synth.blocks.estimate.glsdc_integrity import ROUNDING, Hypotheses, Integrity, Separation, Thresholds
from synth.blocks.estimate.glsdc_jacobian import Linearisation, Model
from synth.blocks.estimate.glsdc_search import SCREENED
from synth.blocks.estimate.glsdc_solution import DYNAMIC_RANGE, Iteration, Problem
from synth.errors import ModelError, SignalError
from synth.law import call, label
from synth.signals import Signal

LEVEL_RANGE = 100.0  # limits: a larger protection level is not resolved
REFUTED = 2.0  # T_1: what two corrections of a true hypothesis leave of an error of linearisation
DOUBTED = Signal("doubted", "1", 0, 1, "another group than the excluded one may be at fault")


@dataclass(frozen=True, eq=False)
class Monitor:
    """The monitor of a model, its `groups` of channels by index, its thresholds, and T_1 of each group."""

    model: Model
    integrity: Integrity
    groups: tuple[tuple[int, ...], ...]
    thresholds: Thresholds
    hypothesis: tuple[float, ...]


@dataclass(frozen=True, eq=False)
class Judgement:
    """Whether the sample passes its test and is not a trial, its protection levels by unknown, whether they are within
    their limits, with exclusion the next states of the monitor, and whether the exclusion is doubted.
    """

    passes: ca.SX
    levels: Exprs
    within: ca.SX
    next: Exprs
    doubted: ca.SX


def monitor(model: Model, integrity: Integrity) -> Monitor:
    """Return the monitor of a model.

    Raises SignalError for limits of other names, and ModelError without redundancy, for a prior about the prediction,
    or exclusion with dependent channels or residuals that mix channels of several groups.
    """
    groups = integrity.index_groups([s.name for s in model.channels])
    largest = max(map(len, groups))
    names, priors = [u.name for u in model.unknowns], [u for u in model.unknowns if u.prior < np.inf]
    if not integrity.limits or not set(integrity.limits) <= set(names):
        raise SignalError(f"the limits are of {', '.join(integrity.limits) or 'none'}: give some of {', '.join(names)}")
    for u in priors:
        if u.prior_value is None:
            raise ModelError(
                f"the prior of '{u.name}' is about the prediction, which carries a fault from sample to sample, past "
                "the test: give a prior_value, or no prior"
            )
    if integrity.screened and not integrity.exclude:
        raise ModelError("the channels are screened without exclusion: a refused group needs exclude=True")
    if integrity.exclude and not model.is_diagonal:
        raise ModelError("R has covariances: exclusion needs channels whose errors are independent")
    if integrity.exclude and not _is_blockwise(model, groups):
        raise ModelError("a residual depends on channels of several groups: exclusion needs residuals of one each")
    freedom = len(model.channels) + len(priors) - len(names)
    if freedom < (1 + largest if integrity.exclude else 1):
        raise ModelError(
            f"{len(model.channels)} channels and {len(priors)} priors for {len(names)} unknowns: a test needs one more "
            f"channel than unknowns, exclusion of {largest} together {1 + largest} more"
        )
    by_size = {
        n: glsdc_integrity.thresholds(freedom, integrity.false_alarm, integrity.risk, n) for n in map(len, groups)
    }
    hypothesis = tuple(by_size[len(group)].hypothesis for group in groups)
    return Monitor(model, integrity, groups, by_size[largest], hypothesis)


def _is_blockwise(model: Model, groups: Sequence[Sequence[int]]) -> bool:
    """Whether the error of a channel acts on residuals of its own group only."""
    acting = model.function.sparsity_out(2)
    return all(acting.has_nz(i, j) <= (i in group) for group in groups for j in group for i in range(acting.size1()))


def states(of: Monitor) -> list[State]:
    """Return the states of the monitor."""
    if not of.integrity.exclude:
        return []
    competing = Signal(
        "competing", "1", 0, len(of.groups), "number of the group whose hypothesis is tested next, 0 for none"
    )
    return [State(s, 0, True) for s in (excluded_number(of), *_plausible(of), competing)]


def _plausible(of: Monitor) -> list[Signal]:
    about = "hypothesis {} has passed since a group is excluded, and its own solution has not failed"
    return [Signal(f"plausible_{k}", "1", 0, 1, about.format(k)) for k in range(1, len(of.groups) + 1)]


def outputs(of: Monitor) -> list[Signal]:
    """Return the protection levels and, with exclusion, the number of the excluded channel."""
    levels = [_level(of, u.name, u.signal.unit) for u in of.model.unknowns if u.name in of.integrity.limits]
    return [*levels, *([excluded_number(of), DOUBTED] if of.integrity.exclude else [])]


def _level(of: Monitor, name: str, unit: str) -> Signal:
    fault = "one channel" if all(len(group) == 1 for group in of.groups) else "one group of channels"
    about = (
        f"protection level of {name}: with errors of the covariance R, a fault in {fault} moves it by more only with "
        "the declared risk"
    )
    return Signal(f"protection_{name}", unit, 0, LEVEL_RANGE * of.integrity.limits[name], about)


def excluded_number(of: Monitor) -> Signal:
    """Return the signal with the number of the excluded group, 0 for none."""
    what = "channel" if all(len(group) == 1 for group in of.groups) else "group of channels"
    return Signal("excluded", "1", 0, len(of.groups), f"number of the {what} excluded as faulty, 0 for none")


def inputs(of: Monitor) -> list[Signal]:
    """Return the results of the check in front of channels that are screened."""
    about = "number of the group of channels that is refused or frozen, 0 for none"
    return [SCREENED, Signal("rejected", "1", 0, len(of.groups), about)]


def with_rejection(of: Monitor, u: Exprs, x: Exprs) -> Exprs:
    """Return the states with the group that is left out in this sample as ``excluded``: refused, or the competing one.

    ``track_excluded`` is the group that the track leaves out; ``certain`` tells whether it is the refused one, and
    ``trial`` whether the sample tests the competing one.
    """
    if not of.integrity.exclude:
        return {**x, "trial": ca.SX(0)}
    certain, track, trial = ca.SX(0), x["excluded"], x["competing"] > 0
    if of.integrity.screened:
        certain = u["rejected"] > 0
        track = clip(ca.if_else(certain, u["rejected"], track), excluded_number(of))
        trial = ca.logic_and(trial, ca.logic_not(certain))
    excluded = ca.if_else(trial, x["competing"], track)
    return {**x, "excluded": excluded, "track_excluded": track, "certain": certain, "trial": trial}


def weights(of: Monitor, x: Exprs) -> Vector | None:
    """Return the weight of each channel (m,), 0 for the excluded one; None without exclusion."""
    if not of.integrity.exclude:
        return None
    number = {j: k for k, group in enumerate(of.groups) for j in group}
    groups = range(len(of.groups))
    none = x["excluded"] < 1
    included = [
        ca.if_else(none, 1, glsdc_integrity.choose(x["excluded"], [ca.SX(float(k != j)) for k in groups]))
        for j in groups
    ]
    label(none=none)
    return [included[number[j]] for j in range(len(of.model.channels))]


def solve(
    of: Monitor | None, problem: Problem, iteration: Iteration, tracked: bool, x: Exprs
) -> tuple[Solution[Any], Separation | None]:
    """Return the solution of a sample, and the hypotheses about its prediction where the corrections use them."""
    if of and of.integrity.exclude and tracked and iteration.held_jacobian:
        return glsdc_integrity.solve(problem, iteration, of.groups, x["excluded"], _axes(of))
    return glsdc_solution.solve(problem, iteration), None


def judge(
    of: Monitor, solution: Solution[Any], about: Separation | None, tracked: bool, cost: ca.SX, sigmas: Vector, x: Exprs
) -> Judgement:
    """Return the judgement of a sample with its least cost c s^2 and its deviations (n,).

    The hypotheses, unless those of `about`, are linear about the prediction if it is `tracked`, else the solution.
    """
    if of.integrity.exclude:
        decides = ca.SX(1) if tracked else solution.converged
        trial = solution.first if tracked else solution.last
        if about is None:
            about = glsdc_integrity.separate(of.model, of.groups, trial, _single(of, trial.normal.linear))
        moved = [end - begin for end, begin in zip(solution.at, trial.at, strict=True)]
        label(moved=moved)
        return _judge_hypotheses(of, about, moved, decides, cost, sigmas, x)
    normal = solution.last.normal
    faults = _hypotheses(of, normal.factors, normal.linear)
    levels = {
        i: glsdc_integrity.detected_level(faults, i, of.thresholds, of.model.scale, sigmas[i])
        for i in _limit_indices(of)
    }
    passes = cost <= of.thresholds.test * of.model.scale**2
    return _judgement(of, passes, levels, faults, ca.SX(1))


def _judge_hypotheses(
    of: Monitor, about: Separation, moved: Vector, decides: ca.SX, cost: ca.SX, sigmas: Vector, x: Exprs
) -> Judgement:
    """Return the judgement from the hypotheses about a trial, from which the solution is `moved` (n,) away."""
    model, variance = of.model, of.model.scale**2
    faults, full, full_cost = about.faults, about.full, about.cost
    costs = glsdc_integrity.costs(faults, full.scores, full_cost)
    # The excluded group counts as passing: its hypothesis is the estimate in use, whose variance the levels need.
    passing = [
        ca.logic_or(c <= limit * variance + ROUNDING * full_cost, x["excluded"] == k)
        for k, (c, limit) in enumerate(zip(costs, of.hypothesis, strict=True), 1)
    ]
    remembered = [x[s.name] for s in _plausible(of)]
    plausible = [ca.logic_or(now, before) for now, before in zip(passing, remembered, strict=True)]
    none, levels = x["excluded"] == 0, {}
    for i in _limit_indices(of):
        unknown = model.unknowns[i].name
        levels[i] = call(f"level_{unknown}", _protection_level, of, about, i, plausible, moved[i], sigmas[i], none)
    test = full_cost <= of.thresholds.test * variance
    limit = ca.if_else(none, of.thresholds.test, _excluded_threshold(of, x))
    passes = ca.logic_and(about.in_range, cost <= limit * variance)
    best = ca.if_else(test, 0, glsdc_integrity.most_likely(costs))
    trial, certain = x["trial"], x["certain"]
    decides = ca.logic_and(decides, ca.logic_not(trial))
    excluded = clip(ca.if_else(decides, best, x["track_excluded"]), excluded_number(of))
    made = _judgement(of, passes, levels, faults, none)
    uncertain = ca.logic_not(ca.logic_or(none, certain))
    contested = ca.logic_and(ca.logic_and(uncertain, glsdc.total(plausible) > 1), ca.logic_not(made.within))
    doubted = ca.logic_or(trial, contested)
    refuted = ca.logic_and(trial, cost > REFUTED * variance * _excluded_threshold(of, x))
    keeps, next = ca.logic_and(uncertain, excluded > 0), {}
    for k, (signal, now, before) in enumerate(zip(_plausible(of), plausible, remembered, strict=True), 1):
        kept = ca.logic_and(before, ca.logic_not(ca.logic_and(refuted, x["excluded"] == k)))
        next[signal.name] = ca.logic_and(keeps, ca.if_else(trial, kept, now))
    failing = [
        ca.if_else(ca.logic_and(before, ca.logic_not(now)), c, 0)
        for c, now, before in zip(costs, passing, remembered, strict=True)
    ]
    begins = ca.logic_and(ca.logic_and(keeps, contested), ca.logic_not(trial))
    next |= {"excluded": excluded, "competing": ca.if_else(begins, glsdc_integrity.most_costly(failing), 0)}
    # A sample whose levels are within their limits is not contested, and a trial does not pass.
    label(
        best=best, doubted=doubted, now=now, none=none, full_cost=full_cost, plausible=plausible, costs=costs,
        passes=passes, failing=failing, decides=decides, test=test, limit=limit, excluded=excluded, uncertain=uncertain,
        contested=contested, refuted=refuted, keeps=keeps, passing=passing,
    )  # fmt: skip
    return Judgement(ca.logic_and(passes, ca.logic_not(trial)), made.levels, made.within, next, doubted)


def _protection_level(
    of: Monitor, about: Separation, i: int, plausible: Vector, moved: ca.SX, sigma: ca.SX, none: ca.SX
) -> ca.SX:
    """Return the protection level of unknown i: that of the test, or of the separations unless `none` is excluded."""
    separated = of.integrity.overbound * glsdc_integrity.separated_level(
        about.faults, i, about.full, plausible, moved, of.thresholds.deviations * of.model.scale
    )
    detected = glsdc_integrity.detected_level(about.faults, i, of.thresholds, of.model.scale, sigma)
    return ca.if_else(none, detected, separated)


def _excluded_threshold(of: Monitor, x: Exprs) -> ca.SX | float:
    """Return T_1 of the excluded group."""
    if len(set(of.hypothesis)) == 1:
        return of.hypothesis[0]
    return glsdc.total((x["excluded"] == k) * limit for k, limit in enumerate(of.hypothesis, 1))


def _hypotheses(of: Monitor, factors: LdlFactors, linear: Linearisation) -> Hypotheses:
    return glsdc_integrity.hypotheses(of.groups, factors, _single(of, linear), of.model.floors, DYNAMIC_RANGE)


def _single(of: Monitor, linear: Linearisation) -> Linearisation:
    """Return a linearisation with the unit vectors of each group's own residuals, which span the same hypotheses."""
    if not _is_blockwise(of.model, of.groups):
        return linear
    return replace(linear, directions=_axes(of))


def _axes(of: Monitor) -> list[dict[int, ca.SX]]:
    return [{j: ca.SX(1)} for j in range(len(of.model.channels))]


def _limit_indices(of: Monitor) -> list[int]:
    return [i for i, u in enumerate(of.model.unknowns) if u.name in of.integrity.limits]


def _judgement(of: Monitor, passes: ca.SX, levels: dict[int, ca.SX], faults: Hypotheses, none: ca.SX) -> Judgement:
    """Return the judgement with levels within their limits, or those while a group is excluded unless `none` is."""
    by_name, within = {}, faults.detectable
    for i, level in levels.items():
        u = of.model.unknowns[i]
        signal, limit = _level(of, u.name, u.signal.unit), of.integrity.limits[u.name]
        by_name[signal.name] = clip(ca.if_else(faults.detectable, level, signal.high), signal)
        within = ca.logic_and(within, by_name[signal.name] <= ca.if_else(none, limit, excluded_limit(of, u.name)))
    label(level=level)
    return Judgement(passes, by_name, within, {}, ca.SX(0))


def excluded_limit(of: Monitor, name: str) -> float:
    """Return the limit of the protection level of an unknown while a group is excluded, in its unit."""
    return of.integrity.excluded_limits * of.integrity.limits[name]
