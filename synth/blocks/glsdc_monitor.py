"""Integrity monitor of a weighted least-squares estimator: test, protection levels and exclusion in each sample.

    excluded = 0:  valid needs c <= T;      protection levels of the test
    excluded = k:  valid needs c_k <= T_1;  protection levels of the separations from hypothesis k

A converged sample whose c exceeds T excludes the channel of the hypothesis with the least cost from the next sample on;
one whose c does not takes every channel in again. c and the hypotheses are of all channels, linear about the estimate
in use. Nothing is valid where a fault of some channel is not detectable.
"""

from dataclasses import dataclass
from math import sqrt

import casadi as ca
import numpy as np

from synth.block import Exprs, State, clip
from synth.blocks import glsdc, glsdc_integrity, glsdc_solution
from synth.blocks.glsdc import LdlFactors, LdlNormalEquations, Solution, Vector, dot
from synth.blocks.glsdc_integrity import ROUNDING, Full, Hypotheses, Integrity, Thresholds
from synth.blocks.glsdc_jacobian import Model
from synth.blocks.glsdc_linearisation import Linearisation
from synth.blocks.glsdc_solution import DYNAMIC_RANGE, Normal
from synth.errors import ModelError, SignalError
from synth.signals import Signal

LEVEL_RANGE = 100.0  # limits: a larger protection level is not resolved


@dataclass(frozen=True, eq=False)
class Monitor:
    """The monitor of a model, and its thresholds."""

    model: Model
    integrity: Integrity
    thresholds: Thresholds


@dataclass(frozen=True, eq=False)
class Judgement:
    """Whether the sample passes, its protection levels by unknown, and the number of the channel to exclude next."""

    passes: ca.SX
    levels: Exprs
    next_excluded: ca.SX


def monitor(model: Model, integrity: Integrity) -> Monitor:
    """Return the monitor of a model.

    Raises SignalError for limits of other names, and ModelError without redundancy, for a prior about the prediction,
    or exclusion with dependent channels or an Implicit model.
    """
    names, priors = [u.name for u in model.unknowns], [u for u in model.unknowns if u.prior < np.inf]
    if not integrity.limits or not set(integrity.limits) <= set(names):
        raise SignalError(f"the limits are of {', '.join(integrity.limits) or 'none'}: give some of {', '.join(names)}")
    for u in priors:
        if u.prior_value is None:
            raise ModelError(
                f"the prior of '{u.name}' is about the prediction, which carries a fault from sample to sample, past "
                "the test: give a prior_value, or no prior"
            )
    if integrity.exclude and not model.is_diagonal:
        raise ModelError("R has covariances: exclusion needs channels whose errors are independent")
    if integrity.exclude and model.is_implicit:
        raise ModelError("the model is Implicit: exclusion needs residuals of single channels, give h")
    freedom = len(model.channels) + len(priors) - len(names)
    if freedom < (2 if integrity.exclude else 1):
        raise ModelError(
            f"{len(model.channels)} channels and {len(priors)} priors for {len(names)} unknowns: a test needs one more "
            "channel than unknowns, exclusion two more"
        )
    return Monitor(model, integrity, glsdc_integrity.thresholds(freedom, integrity.false_alarm, integrity.risk))


def states(of: Monitor) -> list[State]:
    """Return the states of the monitor."""
    return [State(excluded_number(of), 0, True)] if of.integrity.exclude else []


def outputs(of: Monitor) -> list[Signal]:
    """Return the protection levels and, with exclusion, the number of the excluded channel."""
    levels = [_level(of, u.name, u.signal.unit) for u in of.model.unknowns if u.name in of.integrity.limits]
    return [*levels, *([excluded_number(of)] if of.integrity.exclude else [])]


def _level(of: Monitor, name: str, unit: str) -> Signal:
    about = f"protection level of {name}: a fault in one channel moves it by more only with the declared risk"
    return Signal(f"protection_{name}", unit, 0, LEVEL_RANGE * of.integrity.limits[name], about)


def excluded_number(of: Monitor) -> Signal:
    """Return the signal with the number of the excluded channel, 0 for none."""
    return Signal("excluded", "1", 0, len(of.model.channels), "number of the channel excluded as faulty, 0 for none")


def weights(of: Monitor, x: Exprs) -> Vector | None:
    """Return the weight of each channel (m,), 0 for the excluded one; None without exclusion."""
    numbers = range(1, len(of.model.channels) + 1)
    return [x["excluded"] != j for j in numbers] if of.integrity.exclude else None


def judge(of: Monitor, solution: Solution[Normal], cost: ca.SX, sigmas: Vector, x: Exprs) -> Judgement:
    """Return the judgement of a sample with its least cost c s^2 and its deviations (n,)."""
    if of.integrity.exclude:
        return _judge_hypotheses(of, solution, cost, sigmas, x)
    normal = solution.last.normal
    faults = _hypotheses(of, normal.factors, normal.linear)
    levels = {
        i: glsdc_integrity.detected_level(faults, i, of.thresholds, of.model.scale, sigmas[i])
        for i in _limit_indices(of)
    }
    passes = cost <= of.thresholds.test * of.model.scale**2
    return _judgement(of, passes, levels, faults, ca.SX(0))


def _judge_hypotheses(of: Monitor, solution: Solution[Normal], cost: ca.SX, sigmas: Vector, x: Exprs) -> Judgement:
    model, normal, variance = of.model, solution.last.normal, of.model.scale**2
    factors, in_range = glsdc_solution.factorise(model, normal.linear.rows, normal.linear.rows)
    faults = _hypotheses(of, factors, normal.linear)
    full, full_cost = _full(of, factors, normal, faults, solution)
    costs = glsdc_integrity.costs(faults, full.scores, full_cost)
    passing = [c <= of.thresholds.hypothesis * variance + ROUNDING * full_cost for c in costs]
    none, levels = x["excluded"] == 0, {}
    for i in _limit_indices(of):
        reported = solution.at[i] - solution.last.at[i]
        separated = glsdc_integrity.separated_level(
            faults, i, full, passing, reported, of.thresholds.deviations * model.scale
        )
        detected = glsdc_integrity.detected_level(faults, i, of.thresholds, model.scale, sigmas[i])
        levels[i] = ca.if_else(none, detected, separated)
    test = full_cost <= of.thresholds.test * variance
    passes = ca.logic_and(in_range, ca.if_else(none, test, cost <= of.thresholds.hypothesis * variance))
    best = ca.if_else(test, 0, glsdc_integrity.most_likely(costs))
    return _judgement(of, passes, levels, faults, ca.if_else(solution.converged, best, x["excluded"]))


def _full(
    of: Monitor, factors: LdlFactors, normal: Normal, faults: Hypotheses, solution: Solution[Normal]
) -> tuple[Full, ca.SX]:
    """Return the solution with all channels, and its cost c s^2."""
    e, model = normal.linear.residuals, of.model
    gradient = glsdc_solution.gradient_of(normal.linear.rows, e, normal.pulls)
    forward = glsdc.substitute_forward(factors, gradient, glsdc_solution.forward_bounds(model))
    all_channels = LdlNormalEquations(factors, forward)
    bounds = [glsdc_solution.residual_bound(model) / sqrt(f) for f in model.floors]
    step = [clip(d, Signal("step", "1", -b, b)) for d, b in zip(all_channels.step, bounds, strict=True)]
    scores = [
        glsdc_integrity.dot_sparse(w, e) - dot(slope, step)
        for w, slope in zip(normal.linear.directions, faults.slopes, strict=True)
    ]
    prior_cost = solution.last.cost - solution.last.squares
    cost = ca.fmax(dot(e, e) + prior_cost - all_channels.decrease, 0)
    return Full(step, glsdc.variances(factors), scores), cost


def _hypotheses(of: Monitor, factors: LdlFactors, linear: Linearisation) -> Hypotheses:
    return glsdc_integrity.hypotheses(factors, linear, of.model.floors, DYNAMIC_RANGE)


def _limit_indices(of: Monitor) -> list[int]:
    return [i for i, u in enumerate(of.model.unknowns) if u.name in of.integrity.limits]


def _judgement(of: Monitor, passes: ca.SX, levels: dict[int, ca.SX], faults: Hypotheses, excluded: ca.SX) -> Judgement:
    by_name = {}
    for i, level in levels.items():
        u = of.model.unknowns[i]
        signal = _level(of, u.name, u.signal.unit)
        by_name[signal.name] = clip(ca.if_else(faults.detectable, level, signal.high), signal)
        passes = ca.logic_and(passes, by_name[signal.name] <= of.integrity.limits[u.name])
    return Judgement(passes, by_name, excluded)
