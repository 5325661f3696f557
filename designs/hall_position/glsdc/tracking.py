"""Integrity monitor and tracker of (X, Y, yaw) from sample to sample: prediction, gates, lost sensors, restarts.

A sample is predicted to move the body as the last one did, motion <- motion + follow * correction; of the yaw, which is
damped more, by so much less. Two sensors that pass a place where they lose rank read the same on two ways out of it.

A residual fault is a sample whose residuals exceed those of the field's model, or whose motion no body makes from a
certain place. A body whose place was known then goes on as before. At the SUSPECT-th fault in a row, with more than two
sensors, the one that differs most from its prediction is left out from then on, if the others differ by no more than
the field's model and motions explain, and by CONTRAST times less than it, and if not all of them fit another place. If
PATIENCE samples do not end it, the place is lost. As after `init`, it is searched until a sample converges: corrections
are followed wherever they lead, and every PATIENCE samples begin elsewhere in the pitch, with the last certain yaw.

Where two sensors lose rank, ways of like voltages cross, and a body that passes there may be followed on the wrong one
for as long as the residuals do not tell. So a place is certain only when no other within a window of yaws has the same
voltages, and stays so until a sample is damped. More than two sensors tell all places apart at such yaws; two do where
the damping decides little, far enough from where ways cross. Of more, two that remain make no place certain: they need
not be such a pair.
"""

from dataclasses import dataclass
from functools import reduce
from math import pi, sqrt
from operator import add

import casadi as ca

from designs.hall_position.glsdc import channels, planar_model, restarts
from designs.hall_position.glsdc.parameters import Tuning
from designs.hall_position.glsdc.planar_model import AXES, Normal, Problem
from models.hall_two_waves import PlanarArray
from synth.block import Exprs, State
from synth.blocks.glsdc import Solution, Vector
from synth.signals import Signal

POSE, MOTION = ("phase_x", "phase_y", "yaw"), ("motion_x", "motion_y", "motion_yaw")
SUSPECT = 2  # samples
CONTRAST = 25  # of squared residuals
INCONSISTENT = 4.0  # deviations, rms, of voltages that do not fit each other
MORE = 4  # times as much as with two sensors may the damping decide at a certain place, with more than two


@dataclass(frozen=True, eq=False)
class Judgement:
    """Whether a sample has a residual fault, voltages that do not fit each other, or is damped, or none of these.

    `unambiguous`: it is so good that its place is the only one.
    """

    residual_fault: ca.SX
    inconsistent: ca.SX
    damped: ca.SX
    good: ca.SX
    unambiguous: ca.SX


@dataclass(frozen=True, eq=False)
class NextState:
    """The pose by the names of the states, the yaw since the sample began, and the next states.

    `inside`: whether pitches are counted there, and the yaw is valid; `certain`: whether its place is.
    """

    pose: Exprs
    turn: ca.SX
    next: Exprs
    inside: ca.SX
    certain: ca.SX


def states(of: Problem) -> list[State]:
    """Return what is remembered."""
    n = of.tuning.pitches
    reals = [Signal(f"phase_{a}", "rad", -pi, pi, "of the sensors' centre in its pitch") for a in AXES]
    reals += [Signal("yaw", "rad", -pi, pi, "of the last sample")]
    reals += [Signal("yaw_known", "rad", -pi, pi, "of the last sample whose place was certain")]
    reals += [Signal(f"start_{a}", "rad", -pi, pi, "phase with which the last search began") for a in AXES]
    reals += [Signal(f"pitch_{a}", "1", -n, n, "whole pitches to the one of the sensors' centre") for a in AXES]
    about = ("of the phase, expected in a sample",) * 2 + ("expected in a sample",)
    if of.tuning.follow:
        reals += [Signal(b.name, "rad", b.low, b.high, a) for b, a in zip(of.descent.bounds, about, strict=True)]
    counts = [restarts.ASTRAY, restarts.SEARCHING]
    counts += [Signal("certain", "1", 0, 1, "no other place has the same voltages")]
    counts += [Signal("placed", "1", 0, 1, "its place has been certain"), restarts.RESTARTED]
    if is_redundant(of.array):
        counts += [left_out_number(of.array)]
    return restarts.states(reals, counts)


def predict(x: Exprs, of: Problem) -> Exprs:
    """Return the phases and the yaw with which a sample begins."""
    return {n: x[n] + x[m] if of.tuning.follow else x[n] for n, m in zip(POSE, MOTION, strict=True)}


def is_redundant(array: PlanarArray) -> bool:
    """Return whether one sensor can be left out."""
    return len(array.positions) > 2


def left_out_number(array: PlanarArray) -> Signal:
    """Return the number of the sensor that is left out, 0 for none."""
    return Signal("without", "1", 0, len(array.positions), "number of the sensor that is left out")


def left_out(array: PlanarArray, u: Exprs, x: Exprs) -> Vector | None:
    """Return which sensors are left out: one that is suspected, and those of which a voltage is refused."""
    if not is_redundant(array):
        return None
    refused = channels.refused(len(array.positions), u)
    return [ca.logic_or(each, x["without"] == n) for n, each in enumerate(refused, 1)]


def valid_yaw_limit(array: PlanarArray, tuning: Tuning) -> float:
    """Return the yaws to either side at which a place may be valid, rad.

    With two sensors no two of these are further apart than the yaws within which their places are told apart.
    """
    return tuning.yaw if is_redundant(array) else min(tuning.yaw, tuning.turn / 2)


def in_yaw_window(yaw: ca.SX, x: Exprs, tuning: Tuning) -> ca.SX:
    """Return whether a yaw is near the last certain one; across half a turn where one may be certain there."""
    by = ca.fabs(yaw - x["yaw_known"])
    around = tuning.yaw + tuning.turn > pi
    return ca.logic_or(by <= tuning.turn, ca.fabs(by - 2 * pi) <= tuning.turn) if around else by <= tuning.turn


def judge(
    of: Problem, solution: Solution[Normal], yaw: ca.SX, weight: ca.SX, left_out: Vector | None, u: Exprs, x: Exprs
) -> Judgement:
    """Judge a sample that ends at a yaw, where the damping decides damping * `weight` parameters."""
    array, tuning, last = of.array, of.tuning, solution.last
    freedom = channels.freedom(len(array.positions), 3, left_out)
    damped = weight > tuning.leaning / of.damping
    gate = tuning.surprise * array.deviation / sqrt(of.damping)  # rad
    gates = ca.SX(gate) if left_out is None else gate + gate * x["astray"]
    sudden = planar_model.squared_motion(last.at, array.radius) > gates**2
    large = last.squares > freedom * tuning.residual**2
    near = in_yaw_window(yaw, x, tuning)
    lost = ca.if_else(x["certain"], sudden, ca.logic_and(x["searching"], ca.logic_not(near)))
    fault = ca.logic_or(large, lost)
    good = ca.logic_and(solution.converged, ca.logic_not(ca.logic_or(damped, ca.logic_or(fault, sudden))))
    unambiguous = ca.logic_and(good, _is_only_place(left_out, near, weight, x, of))
    unambiguous = ca.logic_and(unambiguous, u["complete"]) if left_out is None else unambiguous
    inconsistent = last.squares > freedom * min(tuning.residual, INCONSISTENT * array.deviation) ** 2
    return Judgement(fault, inconsistent, damped, good, unambiguous)


def _is_only_place(left_out: Vector | None, near: ca.SX, weight: ca.SX, x: Exprs, of: Problem) -> ca.SX:
    """Return whether a place is told apart from all others, from the sample after that which ended the search.

    With two sensors it takes a yaw in the window. A body that moves is sudden then until its motion is known.
    """
    known, threshold = ca.logic_not(x["searching"]), of.tuning.certain / of.damping
    if left_out is None:
        return ca.logic_and(ca.logic_and(near, known), weight <= threshold)
    enough = ca.logic_and(reduce(add, left_out) < len(left_out) - 2, weight <= MORE * threshold)
    return ca.logic_and(enough, known)


def advance(solution: Solution[Normal], judged: Judgement, begun: Exprs, x: Exprs, of: Problem) -> NextState:
    """Return what comes of corrections of the pose with which a sample has `begun`."""
    fault, tuning = judged.residual_fault, of.tuning
    by = restarts.unless_held(fault, POSE, solution.at, x)
    pose = {"yaw": restarts.wrap(begun["yaw"] + by["yaw"])[0]}
    limit, counted = valid_yaw_limit(of.array, tuning), ca.SX(1)
    for a in AXES:
        phase, turns = restarts.wrap(begun[f"phase_{a}"] + by[f"phase_{a}"])
        pose |= {f"phase_{a}": phase, f"pitch_{a}": x[f"pitch_{a}"] + turns}
        counted = ca.logic_and(counted, ca.fabs(pose[f"pitch_{a}"]) <= tuning.pitches)
    turned = ca.fabs(pose["yaw"])
    inside = ca.logic_and(counted, turned <= limit)
    next, again = _search(solution, judged, x, of)
    unambiguous = ca.logic_and(judged.unambiguous, inside)
    certain = ca.logic_or(unambiguous, ca.logic_and(x["certain"], ca.logic_not(judged.damped)))
    known = ca.logic_and(certain, ca.logic_not(fault))
    # What is not certain may follow a wrong way for a while, at yaws that the body does not have.
    left = ca.logic_or(ca.logic_not(counted), turned > ca.if_else(certain, limit, 2 * limit))
    lost = ca.logic_and(x["placed"], ca.logic_or(again, left))
    next |= {"placed": ca.logic_or(certain, x["placed"]), "restarted": ca.logic_or(x["restarted"], lost)}
    next |= {"certain": ca.if_else(again, 0, certain), "yaw_known": ca.if_else(known, pose["yaw"], x["yaw_known"])}
    next |= pose | {"yaw": ca.if_else(again, x["yaw_known"], pose["yaw"])}
    next |= restarts.phases(again, pose, x)
    if tuning.follow:
        gains = (tuning.follow, tuning.follow, tuning.follow / tuning.firm)
        moved = {m: x[m] + g * by[n] for m, n, g in zip(MOTION, POSE, gains, strict=True)}
        next |= {m: ca.if_else(x["searching"], 0, v) for m, v in moved.items()}
    return NextState(pose, by["yaw"], next, inside, certain)


def _search(solution: Solution[Normal], judged: Judgement, x: Exprs, of: Problem) -> tuple[dict[str, ca.SX], ca.SX]:
    """Return the next counts and flags, and whether the next sample begins elsewhere."""
    fault = judged.residual_fault
    again, faults = restarts.count(fault, x)
    next = {"astray": faults}
    if is_redundant(of.array):
        worst, alone = _worst(solution.first.residuals, of)
        known = ca.logic_and(x["certain"], x["astray"] >= SUSPECT - 1)
        suspected = ca.logic_and(ca.logic_and(fault, judged.inconsistent), ca.logic_and(known, alone))
        next["without"] = ca.if_else(again, 0, ca.if_else(suspected, worst, x["without"]))
    ended = ca.logic_and(solution.converged, ca.logic_not(fault))
    next["searching"] = ca.if_else(again, 1, ca.if_else(ended, 0, x["searching"]))
    return next, again


def _worst(residuals: Vector, of: Problem) -> tuple[ca.SX, ca.SX]:
    """Return the number of the sensor with the largest squares, from 1 on, and whether it is the only one by them."""
    n = len(of.array.positions)
    squares = [a**2 + b**2 for a, b in zip(residuals[:n], residuals[n:], strict=True)]
    most, number, others = squares[0], ca.SX(1), ca.SX(0)
    for k, square in enumerate(squares[1:], 2):
        number = ca.if_else(square > most, k, number)
        most, others = ca.fmax(square, most), others + ca.fmin(square, most)
    agree = others <= 2 * (n - 1) * of.expected**2
    return number, ca.logic_and(agree, CONTRAST * others <= most)
