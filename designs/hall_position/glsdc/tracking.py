"""Integrity monitor and tracker of (X, Y, yaw): prediction, gates, ambiguity, restarts.

Prediction: the body moves as in the last sample, motion <- motion + velocity_gain * correction; for the yaw, which is
damped more, the gain is smaller by yaw_damping_ratio.

Residual fault: the residuals exceed `residual_limit`; or the innovation exceeds its gate with the ambiguity resolved;
or a search ends outside the yaw window. While tracking, the correction is then discarded. After PATIENCE faults
position lock is lost. The position is then searched as after `init`, until a sample converges without a fault:
corrections are not gated, and every PATIENCE samples start elsewhere in the pitch, at the last good yaw.

Pitches are counted from the first unambiguous sample on: a search crosses pitches that the body does not.

Ambiguity: at singular points of two sensors, curves of equal voltages cross, and a body that passes one may be tracked
on the wrong curve until the residuals show it. The ambiguity is therefore resolved only where no other pose in a window
of yaws has the same voltages, and remains resolved until a sample is damped. That is where the prior decides little,
which is far from the singular points.
"""

from dataclasses import dataclass
from math import pi, sqrt

import casadi as ca

from designs.hall_position.glsdc import channels, restarts
from designs.hall_position.glsdc.parameters import Tuning
from designs.hall_position.glsdc.planar import AXES, POSE, Problem
from synth.block import Constant, Exprs, State
from synth.blocks.estimate.glsdc import Solution
from synth.blocks.estimate.glsdc_solution import Normal
from synth.blocks.guard.safety import limit
from synth.law import label
from synth.signals import Signal

MOTION = ("motion_x", "motion_y", "motion_yaw")


@dataclass(frozen=True, eq=False)
class Integrity:
    """Flags of a sample: residual fault, damped, or `good` without any of these.

    `unambiguous`: besides, no other pose in the yaw window has the same voltages.
    """

    residual_fault: ca.SX
    damped: ca.SX
    good: ca.SX
    unambiguous: ca.SX


@dataclass(frozen=True, eq=False)
class NextState:
    """The pose by the names of the states, the change of yaw in the sample, and the next states.

    `inside`: whether the pitches are within the count and the yaw within its limit.
    """

    pose: Exprs
    yaw_change: ca.SX
    next: Exprs
    inside: ca.SX
    ambiguity_resolved: ca.SX


def states(problem: Problem) -> list[State]:
    """Return the states of the tracker."""
    n = problem.tuning.pitches
    reals = [
        Signal(f"phase_{a}", "rad", -pi, pi, f"phase of the sensors' centre along {a}, within its pitch") for a in AXES
    ]
    reals += [Signal("yaw", "rad", -pi, pi, "yaw of the last sample")]
    reals += [Signal("yaw_last_good", "rad", -pi, pi, "yaw of the last sample with the ambiguity resolved")]
    reals += [Signal(f"start_{a}", "rad", -pi, pi, f"phase along {a} at which the last search started") for a in AXES]
    reals += [Signal(f"pitch_{a}", "1", -n, n, f"number of whole pitches along {a}, from the middle one") for a in AXES]
    about = ("predicted change of phase per sample",) * 2 + ("predicted change of yaw per sample",)
    if problem.tuning.velocity_gain:
        sizes = zip(MOTION, problem.model.unknowns, about, strict=True)
        reals += [Signal(name, "rad", -u.step, u.step, text) for name, u, text in sizes]
    counts = [restarts.RESIDUAL_FAULTS, restarts.SEARCHING]
    counts += [Signal("ambiguity_resolved", "1", 0, 1, "no other position has the same voltages")]
    counts += [Signal("acquired", "1", 0, 1, "position lock has been acquired since init"), restarts.LOCK_LOST]
    return restarts.states(reals, counts)


def numbers(of: Problem) -> list[Constant]:
    """Return the numbers of the gates, the ambiguity and the restarts that the C names."""
    array, tuning = of.array, of.tuning
    freedom, valid_yaw = channels.freedom(len(array.positions), 3), valid_yaw_limit(tuning)
    yaw_gain = tuning.velocity_gain / tuning.yaw_damping_ratio
    decided = "parameters that the prior decides, over the damping"
    return [
        limit("damped_from", tuning.max_prior_weight / of.damping, "1/V^2", f"{tuning.max_prior_weight:g} {decided}"),
        limit(
            "resolved_to", tuning.ambiguity_threshold / of.damping, "1/V^2", f"{tuning.ambiguity_threshold:g} {decided}"
        ),
        limit(
            "squared_gate",
            _gate(of) ** 2,
            "rad^2",
            f"{tuning.innovation_gate_sigma:g} sigma of the innovation, squared",
        ),
        limit(
            "residual_limit",
            _residual_limit(of),
            "V^2",
            f"{freedom} times the square of {tuning.residual_limit:g} V rms",
        ),
        limit("yaw_window", tuning.yaw_window, "rad", "about the last good yaw: there two sensors are unambiguous"),
        limit("yaw_limit", valid_yaw, "rad", "of a valid estimate"),
        limit("ambiguous_yaw_limit", 2 * valid_yaw, "rad", "before the ambiguity is resolved"),
        limit("most_pitches", tuning.pitches, "1", "counted to either side"),
        Constant("yaw_velocity_gain", yaw_gain, "1", "of a correction, added to the predicted motion of the yaw"),
        *restarts.numbers(),
    ]


def _gate(of: Problem) -> float:
    """Return the largest innovation that a motion explains, rad."""
    return of.tuning.innovation_gate_sigma * of.array.deviation / sqrt(of.damping)


def _residual_limit(of: Problem) -> float:
    """Return the largest sum of squared residuals without a fault, V^2."""
    return channels.freedom(len(of.array.positions), 3) * of.tuning.residual_limit**2


def predict(x: Exprs, problem: Problem) -> Exprs:
    """Return the predicted phases and yaw."""
    return {n: x[n] + x[m] if problem.tuning.velocity_gain else x[n] for n, m in zip(POSE, MOTION, strict=True)}


def valid_yaw_limit(tuning: Tuning) -> float:
    """Return the largest absolute yaw of a valid estimate, rad, half the yaw window at most."""
    return min(tuning.yaw_limit, tuning.yaw_window / 2)


def in_yaw_window(yaw: ca.SX, x: Exprs, tuning: Tuning) -> ca.SX:
    """Return whether a yaw is in the yaw window about the last good one, also across half a turn where reachable."""
    difference = ca.fabs(yaw - x["yaw_last_good"])
    wraps = tuning.yaw_limit + tuning.yaw_window > pi
    inside = difference <= tuning.yaw_window
    return ca.logic_or(inside, ca.fabs(difference - 2 * pi) <= tuning.yaw_window) if wraps else inside


def check_integrity(
    problem: Problem, solution: Solution[Normal], yaw: ca.SX, weight: ca.SX, u: Exprs, x: Exprs
) -> Integrity:
    """Return the integrity flags of a sample that ends at a yaw; the prior decides damping * `weight` parameters."""
    array, tuning, last = problem.array, problem.tuning, solution.last
    damped = weight > tuning.max_prior_weight / problem.damping
    gate_exceeded = last.at[0] ** 2 + last.at[1] ** 2 + array.radius**2 * last.at[2] ** 2 > _gate(problem) ** 2
    residuals_large = last.squares > _residual_limit(problem)
    in_window = in_yaw_window(yaw, x, tuning)
    lost = ca.if_else(x["ambiguity_resolved"], gate_exceeded, ca.logic_and(x["searching"], ca.logic_not(in_window)))
    fault = ca.logic_or(residuals_large, lost)
    good = ca.logic_and(solution.converged, ca.logic_not(ca.logic_or(damped, ca.logic_or(fault, gate_exceeded))))
    # Not before a sample after the search: a moving body exceeds the gate until its motion has been estimated.
    tracking, threshold = ca.logic_not(x["searching"]), tuning.ambiguity_threshold / problem.damping
    unique = ca.logic_and(ca.logic_and(in_window, tracking), weight <= threshold)
    unambiguous = ca.logic_and(ca.logic_and(good, unique), u["complete"])
    label(in_window=in_window, gate_exceeded=gate_exceeded, lost=lost, tracking=tracking, unique=unique)
    return Integrity(fault, damped, good, unambiguous)


def advance(
    solution: Solution[Normal], integrity: Integrity, prediction: Exprs, x: Exprs, problem: Problem
) -> NextState:
    """Return the pose and the states after the corrections of the predicted pose."""
    fault, tuning = integrity.residual_fault, problem.tuning
    by = restarts.gate_correction(fault, POSE, solution.at, x)
    pose = {"yaw": restarts.wrap("yaw", prediction["yaw"] + by["yaw"])[0]}
    limit, counted = valid_yaw_limit(tuning), ca.SX(1)
    for a in AXES:
        moved = prediction[f"phase_{a}"] + by[f"phase_{a}"]
        phase, turns = restarts.wrap(a, moved)
        pose |= {f"phase_{a}": phase, f"pitch_{a}": x[f"pitch_{a}"] + ca.if_else(x["acquired"], turns, 0)}
        counted = ca.logic_and(counted, ca.fabs(pose[f"pitch_{a}"]) <= tuning.pitches)
        label(a, moved=moved)
    size = ca.fabs(pose["yaw"])
    inside = ca.logic_and(counted, size <= limit)
    next, restart = _search(solution, integrity, x)
    unambiguous = ca.logic_and(integrity.unambiguous, inside)
    resolved = ca.logic_or(unambiguous, ca.logic_and(x["ambiguity_resolved"], ca.logic_not(integrity.damped)))
    faultless = ca.logic_not(fault)
    reliable = ca.logic_and(resolved, faultless)
    # An ambiguous estimate may track a wrong curve for a while, at yaws that the body does not have.
    outside = ca.logic_or(ca.logic_not(counted), size > ca.if_else(resolved, limit, 2 * limit))
    lost = ca.logic_and(x["acquired"], ca.logic_or(restart, outside))
    next |= {"acquired": ca.logic_or(resolved, x["acquired"]), "lock_lost": ca.logic_or(x["lock_lost"], lost)}
    next |= {
        "ambiguity_resolved": ca.if_else(restart, 0, resolved),
        "yaw_last_good": ca.if_else(reliable, pose["yaw"], x["yaw_last_good"]),
    }
    next |= pose | {"yaw": ca.if_else(restart, x["yaw_last_good"], pose["yaw"])}
    next |= restarts.next_phases(restart, pose, x)
    if tuning.velocity_gain:
        gains = (tuning.velocity_gain, tuning.velocity_gain, tuning.velocity_gain / tuning.yaw_damping_ratio)
        motions = {m: x[m] + g * by[n] for m, n, g in zip(MOTION, POSE, gains, strict=True)}
        continued = {m: ca.if_else(x["searching"], 0, v) for m, v in motions.items()}
        next |= continued
        label(motions=motions, continued=continued)
    label(
        lost=lost, restart=restart, inside=inside, resolved=resolved, counted=counted, size=size,
        unambiguous=unambiguous, faultless=faultless, outside=outside, by=by,
    )  # fmt: skip
    return NextState(pose, by["yaw"], next, inside, resolved)


def _search(solution: Solution[Normal], integrity: Integrity, x: Exprs) -> tuple[dict[str, ca.SX], ca.SX]:
    """Return the next counts and flags, and whether the next sample restarts elsewhere."""
    fault = integrity.residual_fault
    restart, faults = restarts.count_faults(fault, x)
    next = {"residual_faults": faults}
    ended = ca.logic_and(solution.converged, ca.logic_not(fault))
    next["searching"] = ca.if_else(restart, 1, ca.if_else(ended, 0, x["searching"]))
    label(faults=faults)
    return next, restart
