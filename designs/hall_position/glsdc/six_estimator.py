"""Pose in all six degrees of freedom from the voltages of four or more two-axis Hall sensors: GLSDC.

It works as `estimator` does, with one Jacobian a sample. With a fifth sensor a sensor of which a voltage is refused is
left out. `valid` is an estimate that has converged, is not damped, has neither a residual fault nor a sudden motion,
lies within the gap and the tilts of the tuning, and rests on measurements that are accepted. After PATIENCE faults in a
row the body is searched: every PATIENCE samples begin elsewhere in the pitch, level, at the height and with the last
yaw that was known. Pitches then count from 0. Deviations are those of the Jacobian where the sample begins.

Source: Kawato, Kim, "Multi-Degree-of-Freedom Precision Position Sensing", section 3, Fig. 6 (b) and Fig. 9.
"""

from collections.abc import Sequence
from dataclasses import replace
from functools import reduce
from math import pi
from typing import NamedTuple

import casadi as ca
import numpy as np

from designs.hall_position.glsdc import channels, restarts, spatial_model
from designs.hall_position.glsdc.parameters import SpatialTuning
from designs.hall_position.glsdc.spatial_model import POSE, Problem
from models.hall_two_waves import SpatialArray
from synth.block import Block, Constant, Exprs, State, Step, build, clip
from synth.blocks import glsdc
from synth.blocks.glsdc import Factorised, Named, Solution
from synth.errors import ModelError
from synth.signals import Signal
from synth.timing import Discrete

ENOUGH = 4  # sensors; one more is redundant
USUAL = SpatialTuning()
# Relative, of polynomials: a sine that is wrong by 2e-7 is a position that is wrong by 2 nm.
SURROGATE_ERROR: dict[type[np.floating], float] = {np.float32: 2e-7, np.float64: 1e-15}
MOTION = tuple(f"motion_{name}" for name in POSE)
OUTPUTS = ("X", "Y", "Z", "roll", "pitch", "yaw")
FLAGS = {
    "damped": "the voltages do not tell all of the pose",
    "valid": "converged, neither damped, astray nor sudden, inputs accepted, in its ranges",
    "restarted": "has looked for its place again: pitches are not known any more",
}


class NextState(NamedTuple):
    """The pose and the next states, by name; `inside`: whether it is within its ranges."""

    pose: Exprs
    next: Exprs
    inside: ca.SX


def is_redundant(array: SpatialArray) -> bool:
    """Return whether one sensor can be left out."""
    return len(array.positions) > ENOUGH


def guarded(array: SpatialArray, time: Discrete, tuning: SpatialTuning = USUAL, name: str = "hall_pose") -> Block:
    """Return the estimator behind the guard of its voltages."""
    return channels.guarded(name, time, len(array.positions), estimator(array, time, tuning))


def estimator(array: SpatialArray, time: Discrete, tuning: SpatialTuning = USUAL) -> Block:
    """Return the Block from held voltages, ``complete`` or with a redundant sensor ``fault_V_ax`` .. to the pose.

    Raises ModelError for fewer than four places, or of sensors with a redundant one fewer than four after its loss.
    """
    _check_places(array)
    of, redundant = spatial_model.problem(array, tuning), is_redundant(array)

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        named: Named = []
        begun = _predict(x, of)
        left_out = channels.refused(len(array.positions), u) if redundant else None
        solution = spatial_model.correct(begun, spatial_model.sensors(array, u, k, left_out), of, named)
        freedom, last = channels.freedom(len(array.positions), 6, left_out), solution.last
        fault = last.squares > freedom * tuning.residual**2
        after = _advance(solution, fault, begun, x, of)
        variances = glsdc.variances(last.normal.factors)
        damped = glsdc.dot([ca.SX(d) for d in of.damping], variances) > tuning.leaning
        sudden = last.cost - last.squares > (tuning.surprise * array.deviation) ** 2
        doubt = ca.logic_or(damped, ca.logic_or(fault, sudden))
        accepted = after.inside if redundant else ca.logic_and(after.inside, u["complete"])
        valid = ca.logic_and(ca.logic_and(solution.converged, ca.logic_not(doubt)), accepted)
        output = _position(after.pose, array) | _deviations(variances, array)
        output |= {"residual": channels.residual(last.squares, freedom), "converged": solution.converged}
        output |= {"damped": damped, "valid": valid, "restarted": x["restarted"]}
        return Step(output, after.next, named)

    return build(
        "estimator",
        time,
        law,
        inputs=channels.held(len(array.positions), redundant),
        outputs=channels.outputs(OUTPUTS, (tuning.pitches + 2) * array.pitch, 1, FLAGS),
        states=_states(of),
        constants=[Constant("alpha", array.alpha, "V", "fundamental"), Constant("beta", array.beta, "V", "5th wave")],
        tag="GLSDC, Fig. 9",
    )


def _check_places(array: SpatialArray) -> None:
    places = array.positions
    if len(set(places)) < ENOUGH:
        raise ModelError(
            f"{len(set(places))} sensors lose rank on curves in the pitch, and no voltage is left by which a false "
            f"one is seen: give {ENOUGH} or more, each at a place of its own"
        )
    if is_redundant(array) and any(len({*places[:k], *places[k + 1 :]}) < ENOUGH for k in range(len(places))):
        raise ModelError(
            f"{len(places)} sensors at {len(set(places))} places leave fewer than {ENOUGH} of these after the loss "
            "of one: give each a place of its own"
        )


def _states(of: Problem) -> list[State]:
    n = of.tuning.pitches
    reals = [replace(s, about="of the last sample") for s in of.ranges]
    reals += [Signal(f"start_{a}", "rad", -pi, pi, "where it was last begun elsewhere") for a in "xy"]
    reals += [Signal("yaw_known", "rad", -pi, pi, "of the last sample that was not astray")]
    reals += [Signal(f"count_{a}", "1", -n, n, "whole pitches to the one of the origin") for a in "xy"]
    reals += [replace(s, name=f"motion_{s.name}", about="expected in a sample") for s in of.descent.bounds]
    return restarts.states(reals, [restarts.ASTRAY, restarts.SEARCHING, restarts.RESTARTED])


def _predict(x: Exprs, of: Problem) -> dict[str, ca.SX]:
    """Return the pose with which a sample begins, at a gap and tilts that are within their ranges."""
    begun = {n: x[n] + x[m] for n, m in zip(POSE, MOTION, strict=True)}
    return begun | {s.name: clip(begun[s.name], s) for s in of.ranges[2:5]}


def _advance(solution: Solution[Factorised], fault: ca.SX, begun: Exprs, x: Exprs, of: Problem) -> NextState:
    """Return what comes of the corrections of a pose with which a sample has `begun`, and of a residual fault."""
    by = restarts.unless_held(fault, POSE, solution.at, x)
    pose = {name: begun[name] + by[name] for name in POSE}
    inside = [ca.fabs(pose[s.name]) < s.high for s in of.ranges[2:5]]
    for a in "xy":
        pose[f"phase_{a}"], turns = restarts.wrap(pose[f"phase_{a}"])
        inside.append(ca.fabs(x[f"count_{a}"]) < of.tuning.pitches)
        pose[f"count_{a}"] = x[f"count_{a}"] + ca.if_else(inside[-1], turns, 0)
    pose["yaw"], _ = restarts.wrap(pose["yaw"])
    again, count = restarts.count(fault, x)
    next = pose | {name: ca.if_else(again, 0, pose[name]) for name in (*POSE[2:5], "count_x", "count_y")}
    next |= restarts.phases(again, pose, x)
    next |= {"yaw": ca.if_else(again, x["yaw_known"], pose["yaw"])}
    next |= {"yaw_known": ca.if_else(fault, x["yaw_known"], pose["yaw"]), "astray": count}
    next |= {"searching": ca.if_else(again, 1, ca.if_else(fault, x["searching"], 0))}
    next |= {"restarted": ca.if_else(again, 1, x["restarted"])}
    lost = ca.logic_and(fault, x["searching"])
    next |= {m: ca.if_else(lost, 0, x[m] + of.tuning.follow * by[n]) for m, n in zip(MOTION, POSE, strict=True)}
    return NextState(pose, next, reduce(ca.logic_and, inside))


def _position(pose: Exprs, array: SpatialArray) -> dict[str, ca.SX]:
    """Return the body's origin, m, and its angles."""
    w = array.wave_number
    x, y = (pose[f"phase_{a}"] / w + pose[f"count_{a}"] * array.pitch for a in "xy")
    return {"X": x, "Y": y, "Z": array.height + pose["rise"] / w} | {name: pose[name] for name in OUTPUTS[3:]}


def _deviations(variances: Sequence[ca.SX], array: SpatialArray) -> dict[str, ca.SX]:
    """Return standard deviations, m and rad."""
    sizes = [array.deviation / array.wave_number] * 3 + [array.deviation] * 3
    named = zip(OUTPUTS, sizes, variances, strict=True)
    return {f"deviation_{name}": size * ca.sqrt(channels.LEAST + v) for name, size, v in named}
