"""Iterated weighted least squares (Gauss-Newton, GLSDC) as a Block, of any measurement model; MATLAB `lsqnonlin`.

    minimise  (y - h(q))' R^-1 (y - h(q)) + sum over priors of (q_i - p_i)^2 / sigma_i^2
    q <- q + N^-1 (H'e - P (q - p)),   N = H'H + P = L D L',   covariance s^2 N^-1

with e, H whitened as in `glsdc_jacobian` and P = diag(s^2 / sigma_i^2), a fixed number of times a sample, from the last
estimate and its motion on. The sum of the corrections of a sample is limited, and so is each estimate, to its range.

A pivot of L D L' is never less than that of the largest deviation which an unknown may have. A limit that acts shows in
the deviation, and the estimate is then `weak` and not valid; so is one whose information exceeds DYNAMIC_RANGE^2 times
the least, beyond which single precision loses the pivots. Emission proves from these limits that nothing divides by 0
and nothing overflows.

An estimate is `valid` if it has converged, every channel was accepted, it is not weak and, with integrity monitoring
(`glsdc_monitor`), the residuals pass their test and each protection level is below its limit. It is otherwise in its
range, and no more. A prior about the prediction must cover how far the body leaves it; the covariance then bounds that
of the estimate.

Sources: Kawato, Kim, "A Novel Multi-DOF Precision Positioning Methodology Using Two-Axis Hall-Effect Sensors", section
3.B, Fig. 9; Crassidis, Junkins, "Optimal Estimation of Dynamic Systems", section 1.4 (GLSDC).

The numbers that the C names, with units, are scale, pivots, limits, thresholds and starts; their letters are those of
`glsdc_solution`, `glsdc_integrity` and `glsdc_search`. A number that a signal's range or a constant of geometry has
already, such as pi, has no name here.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from math import pi, sqrt

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike

from synth import arguments
from synth.block import Block, Constant, Exprs, State, Step, build, clip
from synth.blocks.estimate import glsdc_integrity, glsdc_jacobian, glsdc_monitor, glsdc_search, glsdc_solution
from synth.blocks.estimate.glsdc import NamedExpressions, Solution, Vector
from synth.blocks.estimate.glsdc_integrity import Integrity, Separation
from synth.blocks.estimate.glsdc_jacobian import Model
from synth.blocks.estimate.glsdc_model import Implicit, Measurement, Phase, RotatedMeasurement, Unknown
from synth.blocks.estimate.glsdc_monitor import Monitor
from synth.blocks.estimate.glsdc_search import SCREENED, Sample, Search
from synth.blocks.estimate.glsdc_solution import DYNAMIC_RANGE, Iteration, Normal, Problem
from synth.blocks.guard import safety
from synth.blocks.guard.safety import limit
from synth.composition import compose
from synth.errors import ModelError
from synth.law import call, label
from synth.signals import Signal, product_unit, quotient_unit, signal_names
from synth.timing import Discrete


def of_solution(of: Model, iteration: Iteration) -> list[Constant]:
    """Return the numbers of the scale, of the corrections and of the factors L D L'."""
    s, unit = of.scale, _scale_unit(of)
    square = product_unit(unit, unit)
    tolerance = f"({iteration.convergence:g} channel_sigma)^2: a smaller predicted decrease has converged"
    numbers = [limit("decrease_tolerance", iteration.convergence**2 * s**2, square, tolerance)]
    if s != 1:
        numbers += [
            Constant("channel_sigma", s, unit, "deviation of a channel, from R"),
            Constant("channel_variance", s**2, square, "variance of a channel, from R"),
            Constant("inverse_channel_variance", 1 / s**2, quotient_unit("1", square), "1 / variance"),
        ]
    if iteration.descent_check:
        numbers += [
            Constant("slack", glsdc_solution.SLACK * s**2, square, "rise of the cost that counts as none: rounding"),
            Constant("rounding_factor", 1 + glsdc_solution.ROUNDING, "1", "of a cost that counts as no higher"),
        ]
    for p in of.phases:
        numbers += [
            limit(f"largest_phase_{p.name}", p.largest, "rad", "largest size of a phase"),
            limit(f"largest_change_{p.name}", p.change, "rad", "largest change of a phase in a sample"),
        ]
    return [*numbers, *_of_unknowns(of, square), *_of_factors(of)]


def _of_unknowns(of: Model, square: str) -> Iterator[Constant]:
    columns = zip(
        of.unknowns, of.floors, of.weak_from, of.prior_weights, glsdc_solution.forward_bounds(of), strict=True
    )
    for u, floor, weak, weight, forward in columns:
        n, unit = u.name, u.signal.unit
        information = quotient_unit(square, product_unit(unit, unit))
        inverse, largest = quotient_unit("1", information), _quantity(u.largest_deviation, unit)
        resolved = f"a larger N_ii is not resolved: {DYNAMIC_RANGE:g}^2 times the least pivot"
        yield limit(
            f"least_pivot_{n}", floor, information, f"channel_variance / sigma^2, sigma = {largest}, the largest"
        )
        yield limit(f"largest_information_{n}", DYNAMIC_RANGE**2 * floor, information, resolved)
        yield limit(
            f"weak_from_{n}",
            weak,
            inverse,
            f"sigma^2 / channel_variance, sigma = {largest}, less 1e-05 of it for rounding",
        )
        yield limit(f"largest_deviation_{n}", u.largest_deviation, unit, "largest sigma that is reported")
        yield limit(f"largest_step_{n}", u.step, unit, "correction of a sample at most")
        if u.velocity_gain:
            yield limit(f"largest_motion_{n}", u.step, unit, "predicted change a sample at most")
        yield limit(f"largest_z_{n}", forward, quotient_unit(square, unit), "bound of L^-1 H'e, which never acts")
        if weight:
            prior = _quantity(u.prior, unit)
            yield Constant(
                f"prior_weight_{n}", weight, information, f"channel_variance / sigma^2, sigma = {prior} of the prior"
            )
        if u.signal.high != pi:
            yield from safety.ends(u.signal)
            yield from [_width(u)] if u.periodic else []


def _width(of: Unknown) -> Constant:
    return Constant(f"width_{of.name}", of.width, of.signal.unit, "width of its range")


def _of_factors(of: Model) -> Iterator[Constant]:
    """Return the bounds of L below its diagonal."""
    for i, (row, of_row) in enumerate(zip(of.unknowns, of.floors, strict=True)):
        for column, of_column in zip(of.unknowns[:i], of.floors[:i], strict=True):
            unit = quotient_unit(column.signal.unit, row.signal.unit)
            yield limit(
                f"largest_L_{row.name}_{column.name}",
                DYNAMIC_RANGE * sqrt(of_row / of_column),
                unit,
                f"bound of L in row {row.name}",
            )


def of_monitor(of: Monitor) -> list[Constant]:
    """Return the thresholds of the test and of the hypotheses, and the limits of the protection levels."""
    t, s, unit, risk = of.thresholds, of.model.scale, _scale_unit(of.model), f"risk {of.integrity.risk:g}"
    square, least = product_unit(unit, unit), glsdc_integrity.DETECTABLE
    freedom = len(of.model.channels) - len(of.model.unknowns) + sum(p > 0 for p in of.model.prior_weights)
    test = f"chi-square of {freedom} degrees of freedom, false alarm {of.integrity.false_alarm:g}"
    undetected = f"channel_sigma times the root of the noncentrality: a fault that passes the test with {risk}"
    gain = "1 / separability, less 1e-05 of it, of a fault that is detectable"
    numbers = [
        Constant("test_threshold", t.test, "1", test),
        limit("test_cost", t.test * s**2, square, "test_threshold times channel_variance"),
        Constant("level_sigmas", t.deviations, "1", f"sigmas of a protection level, half of {risk}"),
        Constant("undetected", sqrt(t.noncentrality) * s, unit, undetected),
        limit("least_separability", least, "1", "below it a fault looks like a motion"),
        limit("largest_gain", (1 - glsdc_integrity.ROUNDING) / least, "1", gain),
        limit("largest_mixing", sqrt(1 / least), "1", "bound of the factors of a group's separability"),
    ]
    if of.integrity.exclude:
        projection = glsdc_integrity.largest_projection(of.model)
        numbers += [
            Constant("level_noise", t.deviations * s, unit, "level_sigmas times channel_sigma"),
            Constant("cancellation", glsdc_integrity.ROUNDING, "1", "relative error of a cost by rounding"),
            limit("largest_projection", projection, unit, "bound of |x_j'g|, which never acts"),
        ]
        if of.integrity.overbound != 1:
            about = "factor on the protection levels while a group is excluded"
            numbers.append(Constant("overbound", of.integrity.overbound, "1", about))
    for size, threshold in sorted({len(g): T for g, T in zip(of.groups, of.hypothesis, strict=True)}.items()):
        if np.isfinite(threshold):
            of_size = "" if len(set(of.hypothesis)) == 1 else f"_of_{size}"
            about = f"chi-square of {freedom - size} degrees of freedom, half of {risk}: without the excluded group"
            cost = "hypothesis_threshold times channel_variance"
            numbers += [
                Constant(f"hypothesis_threshold{of_size}", threshold, "1", about),
                Constant(f"hypothesis_cost{of_size}", threshold * s**2, square, cost),
                Constant(
                    f"refuted_cost{of_size}",
                    glsdc_monitor.REFUTED * threshold * s**2,
                    square,
                    f"{glsdc_monitor.REFUTED:g} times hypothesis_cost: of a competing hypothesis that is refuted",
                ),
            ]
    return [*numbers, *_of_limits(of)]


def _of_limits(of: Monitor) -> Iterator[Constant]:
    share = of.integrity.excluded_limits
    for u in of.model.unknowns:
        if most := of.integrity.limits.get(u.name):
            n, unit, times = u.name, u.signal.unit, glsdc_monitor.LEVEL_RANGE
            largest = f"{times:g} times the limit: level that is reported at most"
            yield limit(f"limit_{n}", most, unit, "of a valid protection level")
            yield limit(f"largest_level_{n}", times * most, unit, largest)
            if share < 1:
                about = f"{share:g} times the limit, while a group is excluded"
                yield limit(f"excluded_limit_{n}", glsdc_monitor.excluded_limit(of, n), unit, about)


def of_search(of: Search, unknowns: Sequence[Unknown]) -> list[Constant]:
    """Return the numbers of a search: its counts, the increments of a start and what counts as one solution."""
    increments = of.increments(unknowns)
    numbers = of.counts()
    for u in (u for u in unknowns if u.name in increments):
        n, unit = u.name, u.signal.unit
        numbers += [
            *([] if u.periodic or u.signal.high == pi else [_width(u)]),
            Constant(f"increment_{n}", increments[n], unit, "from one start to the next: Roberts' sequence"),
            limit(f"agreement_{n}", of.agreement[n], unit, "solutions closer than this count as one"),
        ]
    return numbers


def _scale_unit(of: Model) -> str:
    """Return the unit of s: that of the channels, or 1 after whitening by R."""
    return of.channels[0].unit if np.array_equal(of.whitening, np.eye(len(of.channels))) else "1"


def _quantity(value: float, unit: str) -> str:
    return f"{value:g}" if unit == "1" else f"{value:g} {unit}"


CHI_SQUARE = Signal("chi_square", "1", 0, 1e9, "weighted sum of squared residuals, and of the priors")
COMPLETE = Signal("complete", "1", 0, 1, "every channel was accepted in this sample")
FLAGS = (
    Signal("converged", "1", 0, 1, "the last correction is small"),
    Signal("weak", "1", 0, 1, "the channels do not determine every unknown to its largest deviation"),
    Signal("valid", "1", 0, 1, "converged, complete, not weak, and passes the integrity monitor if there is one"),
)
SAFE_OUTPUT_EFFECT = "an estimator moves nothing: once latched it continues, and the fault word shows the latch"


@arguments.checked
def estimator(
    name: str,
    time: Discrete,
    h: Measurement | Implicit | RotatedMeasurement,
    R: ArrayLike,
    *,
    channels: Sequence[Signal],
    unknowns: Sequence[Unknown],
    angles: Sequence[str] = (),
    phases: Sequence[Phase] = (),
    constants: Sequence[Constant] = (),
    iteration: Iteration | None = None,
    integrity: Integrity | None = None,
    search: Search | None = None,
    numbers: Sequence[Constant] = (),
    tag: str = "weighted least squares",
) -> Block:
    """Return the Block from ``<channel>_held`` and ``complete`` to the unknowns.

    `h` maps the unknowns and `constants` to a value for each channel; a periodic unknown q, and an angle, has cos_q and
    sin_q too. R (m, m) is the covariance of the channels; `glsdc_model.covariance` makes one from noise and model
    error. `angles` are the channels whose range is one turn. h has the cosine and the sine of each of the `phases`,
    too. With a `search` (`glsdc_search`) the estimate begins anywhere; without one it begins at the start of each
    unknown. `numbers` are those of h and of the phases that the C names.

    Outputs are each unknown, ``deviation_<unknown>``, ``chi_square`` (the least cost, WSSE), ``converged``, ``weak``
    and ``valid``; with `integrity` also ``protection_<unknown>``, and with exclusion ``excluded``, the number of the
    channel or group that is left out, and ``doubted``; with a `search` ``tracking`` and ``lost``.

    Raises ModelError for a covariance that does not fit, fewer channels and priors than unknowns, what
    `glsdc_solution.check` finds, or integrity without redundancy; SignalError for names that are repeated, an h that
    does not return a value for each channel, or limits that are not those of the unknowns.
    """
    of = glsdc_jacobian.model(h, arguments.matrix("R", R), channels, angles, unknowns, phases, constants)
    glsdc_solution.check(of, constants)
    monitor = None if integrity is None else glsdc_monitor.monitor(of, integrity)
    _check_search(of, monitor, search)
    own_numbers = [
        Constant("largest_chi_square", CHI_SQUARE.high, "1", "weighted sum that is reported at most", is_limit=True),
        *of_solution(of, iteration or Iteration()),
        *(of_monitor(monitor) if monitor else []),
        *(of_search(search, of.unknowns) if search else []),
    ]

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        named: NamedExpressions = []
        x = glsdc_monitor.with_rejection(monitor, u, x) if monitor else x
        weights = call("weights", glsdc_monitor.weights, monitor, x) if monitor else None
        problem = _problem(of, u, x, ca.vcat([k[c.name] for c in constants]), weights, named)
        solution, about = glsdc_monitor.solve(monitor, problem, iteration or Iteration(), search is not None, x)
        step = _step(Monitored(of, monitor, search), problem, solution, about, u, x, named)
        label(x=x, weights=weights or ())
        return replace(step, numbers=[*numbers, *own_numbers])

    return build(
        name,
        time,
        law,
        inputs=[
            *(replace(s, name=f"{s.name}_held") for s in of.channels),
            *(glsdc_monitor.inputs(monitor) if monitor and monitor.integrity.screened else [COMPLETE]),
        ],
        outputs=[
            *_outputs(of),
            *(glsdc_monitor.outputs(monitor) if monitor else []),
            *([glsdc_search.TRACKING, glsdc_search.LOST] if search else []),
        ],
        states=[
            *_states(of),
            *(glsdc_monitor.states(monitor) if monitor else []),
            *(search.states(of.unknowns) if search else []),
        ],
        constants=constants,
        tag=tag,
    )


@arguments.checked
def guarded(
    block: Block, name: str, channels: Sequence[Signal], bad_samples: int, safe_output_effect: str = SAFE_OUTPUT_EFFECT
) -> Block:
    """Return the estimator behind the guard of its channels, which latches after `bad_samples` incomplete samples.

    Raises SignalError as `safety.guard`, WiringError for channels that are not the estimator's.
    """
    inputs = [safety.GuardedInput(s, min(max(0.0, s.low), s.high), True) for s in channels]
    guard = safety.guard(block.time, inputs, bad_samples, safe_output_effect=safe_output_effect)
    return compose(name, [guard, block], inputs=signal_names(channels), outputs=signal_names(block.outputs))


def _problem(
    of: Model, u: Exprs, x: Exprs, constants: ca.SX, weights: Vector | None, named: NamedExpressions
) -> Problem:
    values = call("extrapolation", _extrapolate, of, x)
    measured = [u[f"{s.name}_held"] for s in of.channels]
    offsets = [v.offset(value) for v, value in zip(of.unknowns, values, strict=True)]
    prediction = call("prediction", glsdc_jacobian.predict, of, values, measured, constants, named)
    return Problem(of, prediction, offsets, weights)


def _extrapolate(of: Model, x: Exprs) -> list[ca.SX]:
    """Return the predicted unknowns: those of the last sample, and their motions on."""
    return [v.wrap(x[v.name] + x[_motion(v).name]) if v.velocity_gain else x[v.name] for v in of.unknowns]


@dataclass(frozen=True, eq=False)
class Monitored:
    """A model with its monitor and its search, if it has them."""

    model: Model
    monitor: Monitor | None
    search: Search | None


def _step(
    estimator: Monitored,
    problem: Problem,
    solution: Solution[Normal],
    about: Separation | None,
    u: Exprs,
    x: Exprs,
    named: NamedExpressions,
) -> Step:
    of, monitor, search = estimator.model, estimator.monitor, estimator.search
    normal, unknowns = solution.last.normal, of.unknowns
    sigmas, weak = call("deviations", _deviations, of, normal)
    cost = ca.fmax(solution.last.cost - normal.decrease, 0)
    complete = u[SCREENED.name if monitor and monitor.integrity.screened else COMPLETE.name]
    accepted = ca.logic_and(complete, ca.logic_not(weak))
    good = ca.logic_and(solution.converged, accepted)
    starts = problem.prediction.values
    pose, motions = call("movement", _movement, estimator, starts, solution, x)
    next = pose | motions
    output = pose | {_deviation(v).name: sigma for v, sigma in zip(unknowns, sigmas, strict=True)}
    output |= {CHI_SQUARE.name: ca.fmin(cost / of.scale**2, CHI_SQUARE.high)}
    if monitor:
        judgement = call(
            "judgement", glsdc_monitor.judge, monitor, solution, about, search is not None, cost, sigmas, x
        )
        accepted, output = ca.logic_and(accepted, judgement.passes), output | dict(judgement.levels)
        good = ca.logic_and(ca.logic_and(good, judgement.passes), judgement.within)
        next |= dict(judgement.next)
        if monitor.integrity.exclude:
            output |= {"excluded": x["track_excluded"], "doubted": judgement.doubted}
        if search:
            good, tracked = _track(
                estimator, problem, Sample(starts, pose, solution.converged, accepted), good, next, x
            )
            output, next = output | dict(tracked[0]), next | dict(tracked[1])
            label(tracked=tracked[1])
    output |= {"converged": solution.converged, "weak": weak, "valid": good}
    label(cost=cost, accepted=accepted, good=good, weak=weak, pose=pose, motions=motions)
    for v, start in zip(unknowns, starts, strict=True):
        label(v.name, predicted=start)
    return Step(output, next, named, problem.prediction.certified)


def _track(
    of: Monitored, problem: Problem, sample: Sample, good: ca.SX, next: Exprs, x: Exprs
) -> tuple[ca.SX, tuple[Exprs, Exprs]]:
    """Return whether the estimate is valid, and what the search changes in outputs and in next states."""
    search = of.search
    assert search is not None
    tracking, lost = glsdc_search.is_tracking(search, x), glsdc_search.is_lost(search, x)
    changed = call("search", glsdc_search.advance, search, of.model.unknowns, sample, x)
    changed |= call("motion", _tracked_motions, of.model, tracking, sample, next, x)
    for state in glsdc_monitor.states(of.monitor) if of.monitor else []:
        changed[state.name] = ca.if_else(tracking, next[state.name], 0)
    valid = ca.logic_and(good, ca.logic_and(tracking, ca.logic_not(lost)))
    return valid, ({"tracking": tracking, "lost": lost}, changed)


def _tracked_motions(of: Model, tracking: ca.SX, sample: Sample, next: Exprs, x: Exprs) -> dict[str, ca.SX]:
    """Return the next motions of a track, which keeps those of a sample that is not accepted, and 0 without one."""
    names = [_motion(v).name for v in of.unknowns if v.velocity_gain]
    return {n: ca.if_else(tracking, ca.if_else(sample.accepted, next[n], x[n]), 0) for n in names}


def _deviations(of: Model, normal: Normal) -> tuple[list[ca.SX], ca.SX]:
    """Return the limited deviation of each unknown, and whether one of them is not determined."""
    variances = normal.variances
    roots = [of.scale * ca.sqrt(variance) for variance in variances]
    sigmas = [clip(root, _deviation(v)) for v, root in zip(of.unknowns, roots, strict=True)]
    for v, variance in zip(of.unknowns, variances, strict=True):
        label(v.name, variance=variance)
    return sigmas, _is_weak(of, normal, variances)


def _movement(
    of: Monitored, starts: Vector, solution: Solution[Normal], x: Exprs
) -> tuple[dict[str, ca.SX], dict[str, ca.SX]]:
    """Return the unknowns after the corrections of a sample, and the next motions.

    A trial solves for another hypothesis: the track goes on without it.
    """
    unknowns = of.model.unknowns
    pose = {v.name: v.wrap(p + d) for v, p, d in zip(unknowns, starts, solution.at, strict=True)}
    motions = _motions(of.model, solution, x)
    if of.monitor and of.monitor.integrity.exclude:
        pose = {n: ca.if_else(x["trial"], p, q) for (n, q), p in zip(pose.items(), starts, strict=True)}
        motions = {n: ca.if_else(x["trial"], x[n], m) for n, m in motions.items()}
    return pose, motions


def _is_weak(of: Model, normal: Normal, variances: Vector) -> ca.SX:
    weak = ca.logic_not(normal.in_range)
    for variance, least in zip(variances, of.weak_from, strict=True):
        weak = ca.logic_or(weak, variance >= least)
    return weak


def _motions(of: Model, solution: Solution[Normal], x: Exprs) -> dict[str, ca.SX]:
    """Return the next motions; one that follows from a limited correction, as in a search, is 0."""
    return {
        (n := _motion(v).name): ca.if_else(ca.fabs(d) < v.step, x[n] + v.velocity_gain * d, 0)
        for v, d in zip(of.unknowns, solution.at, strict=True)
        if v.velocity_gain
    }


def _motion(of: Unknown) -> Signal:
    return Signal(f"motion_{of.name}", of.signal.unit, -of.step, of.step, f"predicted change of {of.name} a sample")


def _deviation(of: Unknown) -> Signal:
    about = f"standard deviation of {of.name}, limited"
    return Signal(f"deviation_{of.name}", of.signal.unit, 0, of.largest_deviation, about)


def _outputs(of: Model) -> list[Signal]:
    return [*(u.signal for u in of.unknowns), *map(_deviation, of.unknowns), CHI_SQUARE, *FLAGS]


def _states(of: Model) -> list[State]:
    motions = [State(_motion(u), 0.0) for u in of.unknowns if u.velocity_gain]
    return [*(State(u.signal, u.start) for u in of.unknowns), *motions]


def _check_search(of: Model, monitor: Monitor | None, search: Search | None) -> None:
    if search is None:
        return
    if monitor is None:
        raise ModelError("the search accepts what passes the test of the residuals: give integrity, too")
    if search.all_groups and not monitor.integrity.exclude:
        raise ModelError("the search needs all groups of channels, and none is ever excluded: omit all_groups")
    search.check(of.unknowns)
