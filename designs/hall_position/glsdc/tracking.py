"""From one sample to the next: the motion goes on, pitches are counted, and what is astray looks for its place again.

A sample is expected to move the body as the last one did, motion <- motion + follow * correction; of the yaw, which is
held more firmly, by so much less. That decides where the voltages do not tell: two sensors that pass a place where they
lose rank see the same on two ways out of it.

A sample is astray whose residuals are larger than those of the field's model, or that is a motion which no body makes
from a certain place. A body whose place was known goes on then as it did before. At the SUSPECT-th of them in a row,
unless there are only two sensors, the one that differs most from what this leads to expect is left out from then on, if
the others differ by no more than the field's model and motions lead to expect, and by CONTRAST times less than it, and
if all of them do not fit some other place. If PATIENCE samples do not end it, the place is not known any more. As after
`init`, it is searched until a sample converges: corrections are followed wherever they lead, and every PATIENCE samples
begin elsewhere in the pitch, at points that fill it evenly however many they are (Roberts' sequence), with the last yaw
that was certain. An estimate that has `restarted`, as its place was certain and got lost, counts its pitches from
anywhere, and may do so on a sensor that fails.

Where two sensors lose rank, ways of like voltages cross, and a body that passes there may be followed on the wrong one
for as long as the residuals do not tell. So a place is certain only when no other within a range of yaws has the same
voltages, and stays so until a sample is damped. More than two sensors tell all places apart at such yaws; with two, it
takes one where the damping decides little, which lies far enough from where ways cross. Of more, two that are left keep
the place that is certain, but make none so: they need not be such a pair.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import pi

import casadi as ca

from designs.hall_position.glsdc import channels, restarts
from designs.hall_position.glsdc.correction import AXES
from designs.hall_position.glsdc.descent import Found, Problem
from designs.hall_position.glsdc.parameters import Array, Tuning
from synth.block import Exprs, State
from synth.signals import Signal

POSE, MOTION = ("phase_x", "phase_y", "yaw"), ("motion_x", "motion_y", "motion_yaw")
SUSPECT = 2  # samples
CONTRAST = 25  # of squared residuals


@dataclass(frozen=True, eq=False)
class Ahead:
    """Where the body is found, by the names of the states, and the yaw since the sample began; the next states.

    `inside`: whether it is where pitches are counted, at a yaw that is declared; `certain`: whether its place is.
    """

    found: Exprs
    turn: ca.SX
    next: Exprs
    inside: ca.SX
    certain: ca.SX


@dataclass(frozen=True, eq=False)
class Verdict:
    """Whether what is found is `astray`, or `damped`, or so good that its place is the only one: `telling`.

    `apart`: the voltages do not fit each other, as far as their noise or the field's model tells.
    """

    astray: ca.SX
    apart: ca.SX
    damped: ca.SX
    telling: ca.SX


def states(of: Problem) -> list[State]:
    """Return what is remembered."""
    n, sensors = of.tuning.pitches, len(of.array.positions)
    reals = [Signal(f"phase_{a}", "rad", -pi, pi, "of the sensors' centre in its pitch") for a in AXES]
    reals += [Signal("yaw", "rad", -pi, pi, "of the last sample")]
    reals += [Signal("yaw_known", "rad", -pi, pi, "of the last sample whose place was certain")]
    reals += [Signal(f"start_{a}", "rad", -pi, pi, "phase with which the last search began") for a in AXES]
    reals += [Signal(f"pitch_{a}", "1", -n, n, "whole pitches to the one of the sensors' centre") for a in AXES]
    if of.tuning.follow:
        reals += [Signal(f"motion_{a}", "rad", -of.phase, of.phase, "of the phase, expected in a sample") for a in AXES]
        reals += [Signal("motion_yaw", "rad", -of.yaw, of.yaw, "expected in a sample")]
    counts = [restarts.ASTRAY, restarts.SEARCHING]
    counts += [Signal("certain", "1", 0, 1, "no other place has the same voltages")]
    counts += [Signal("placed", "1", 0, 1, "its place has been certain")]
    counts += [restarts.RESTARTED]
    counts += [Signal("without", "1", 0, sensors, "number of the sensor that is left out")] if spare(of.array) else []
    return [*(State(s, 0.0) for s in reals), *(State(s, int(s.name == "searching"), True) for s in counts)]


def expected(x: Exprs, of: Problem) -> Exprs:
    """Return the phases and the yaw with which a sample begins."""
    return {n: x[n] + x[m] if of.tuning.follow else x[n] for n, m in zip(POSE, MOTION, strict=True)}


def spare(array: Array) -> bool:
    """Return whether one sensor can be left out."""
    return len(array.positions) > 2


def left_out(array: Array, u: Exprs, x: Exprs) -> Sequence[ca.SX] | None:
    """Return which sensors are left out: one that is tried without, and those of which a voltage is refused."""
    if not spare(array):
        return None
    refused = channels.refused(len(array.positions), u)
    return [ca.logic_or(each, x["without"] == n) for n, each in enumerate(refused, 1)]


def declared(array: Array, tuning: Tuning) -> float:
    """Return the yaws to either side at which a place may be valid, rad.

    With two sensors no two of these are further apart than the yaws within which their places are told apart.
    """
    return tuning.yaw if spare(array) else min(tuning.yaw, tuning.turn / 2)


def near(yaw: ca.SX, x: Exprs, tuning: Tuning) -> ca.SX:
    """Return whether a yaw is near the last one that was known; across half a turn where one may be known there."""
    by = ca.fabs(yaw - x["yaw_known"])
    around = tuning.yaw + tuning.turn > pi
    return ca.logic_or(by <= tuning.turn, ca.fabs(by - 2 * pi) <= tuning.turn) if around else by <= tuning.turn


def ahead(found: Found, verdict: Verdict, begun: Exprs, x: Exprs, of: Problem) -> Ahead:
    """Return what comes of corrections of the pose with which a sample has `begun`."""
    astray = verdict.astray
    stays = ca.logic_and(astray, ca.logic_not(x["searching"]))
    by = {name: ca.if_else(stays, 0, d) for name, d in zip(POSE, (*found.at.phase.values(), found.at.yaw), strict=True)}
    pose = {"yaw": restarts.wrapped(begun["yaw"] + by["yaw"])[0]}
    most, counted = declared(of.array, of.tuning), ca.SX(1)
    for a in AXES:
        phase, turns = restarts.wrapped(begun[f"phase_{a}"] + by[f"phase_{a}"])
        pose |= {f"phase_{a}": phase, f"pitch_{a}": x[f"pitch_{a}"] + turns}
        counted = ca.logic_and(counted, ca.fabs(pose[f"pitch_{a}"]) <= of.tuning.pitches)
    turned = ca.fabs(pose["yaw"])
    inside = ca.logic_and(counted, turned <= most)
    next, again = _searched(verdict, found, x, of)
    telling = ca.logic_and(verdict.telling, inside)
    certain = ca.logic_or(telling, ca.logic_and(x["certain"], ca.logic_not(verdict.damped)))
    known = ca.logic_and(certain, ca.logic_not(astray))
    next |= {"placed": ca.logic_or(certain, x["placed"])}
    # What is not certain may follow a wrong way for a while, at yaws that the body does not have.
    left = ca.logic_or(ca.logic_not(counted), turned > ca.if_else(certain, most, 2 * most))
    gone = ca.logic_and(x["placed"], ca.logic_or(again, left))
    next["restarted"] = ca.logic_or(x["restarted"], gone)
    next |= {"certain": ca.if_else(again, 0, certain), "yaw_known": ca.if_else(known, pose["yaw"], x["yaw_known"])}
    next |= pose | {"yaw": ca.if_else(again, x["yaw_known"], pose["yaw"])}
    next |= restarts.phases(again, pose, x)
    if of.tuning.follow:
        follow = dict.fromkeys(POSE, of.tuning.follow) | {"yaw": of.tuning.follow / of.tuning.firm}
        next |= {m: ca.if_else(x["searching"], 0, x[m] + follow[n] * by[n]) for m, n in zip(MOTION, POSE, strict=True)}
    return Ahead(pose, by["yaw"], next, inside, certain)


def _searched(verdict: Verdict, found: Found, x: Exprs, of: Problem) -> tuple[dict[str, ca.SX], ca.SX]:
    """Return the next counts and flags, and whether the next sample begins elsewhere."""
    astray, restart = verdict.astray, restarts.counted(verdict.astray, x)
    next, again = {"astray": restart.astray}, restart.again
    if spare(of.array):
        worst, alone = _worst(found.first.by_sensor, of)
        known = ca.logic_and(x["certain"], x["astray"] >= SUSPECT - 1)
        suspected = ca.logic_and(ca.logic_and(astray, verdict.apart), ca.logic_and(known, alone))
        next["without"] = ca.if_else(again, 0, ca.if_else(suspected, worst, x["without"]))
    ended = ca.logic_and(found.converged, ca.logic_not(astray))
    next["searching"] = ca.if_else(again, 1, ca.if_else(ended, 0, x["searching"]))
    return next, again


def _worst(by_sensor: Sequence[ca.SX], of: Problem) -> tuple[ca.SX, ca.SX]:
    """Return the number of the sensor with the largest squares, from 1 on, and whether it is the only one by them."""
    most, number, others = by_sensor[0], ca.SX(1), ca.SX(0)
    for n, squares in enumerate(by_sensor[1:], 2):
        number = ca.if_else(squares > most, n, number)
        most, others = ca.fmax(squares, most), others + ca.fmin(squares, most)
    agree = others <= 2 * (len(by_sensor) - 1) * of.expected**2
    return number, ca.logic_and(agree, CONTRAST * others <= most)
