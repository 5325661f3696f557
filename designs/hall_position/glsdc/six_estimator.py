"""Pose in all six degrees of freedom from the voltages of four or more two-axis Hall sensors: GLSDC.

It works as `estimator` does, with one Jacobian a sample. With a fifth sensor, a sensor with a refused voltage is
excluded. An estimate is `valid` if it has converged, is not damped, has no residual fault, passes the innovation gate,
lies within the gap and the tilts of the tuning, and uses accepted voltages only. After PATIENCE consecutive residual
faults the body is searched: every PATIENCE samples start elsewhere in the pitch, level, at the nominal height and with
the yaw of the last sample without a fault. Pitches then count from 0. Deviations are those of the Jacobian at the
predicted pose.

Source: Kawato, Kim, "A Novel Multi-DOF Precision Positioning Methodology Using Two-Axis Hall-Effect Sensors", section
3, Fig. 6 (b) and Fig. 9.
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
from synth.blocks.glsdc import LdlNormalEquations, NamedExpressions, Solution
from synth.errors import ModelError
from synth.signals import Signal
from synth.timing import Discrete

MIN_SENSORS = 4  # sensors; one more is redundant
DEFAULT_TUNING = SpatialTuning()
# Relative, of polynomials: an error of 2e-7 in a sine is an error of 2 nm in the position.
SURROGATE_ERROR: dict[type[np.floating], float] = {np.float32: 2e-7, np.float64: 1e-15}
MOTION = tuple(f"motion_{name}" for name in POSE)
OUTPUTS = ("X", "Y", "Z", "roll", "pitch", "yaw")
FLAGS = {
    "damped": "the voltages alone do not determine the pose: the prior decides a part of it",
    "valid": "converged, not damped, no residual fault, innovation within its gate, inputs accepted, within its ranges",
    "lock_lost": "position lock lost: the count of pitches is unknown until init",
}


class NextState(NamedTuple):
    """The pose and the next states, by name; `inside`: whether the pose is within its ranges."""

    pose: Exprs
    next: Exprs
    inside: ca.SX


def is_redundant(array: SpatialArray) -> bool:
    """Return whether one sensor can be excluded."""
    return len(array.positions) > MIN_SENSORS


def guarded_estimator(
    array: SpatialArray, time: Discrete, tuning: SpatialTuning = DEFAULT_TUNING, name: str = "hall_pose"
) -> Block:
    """Return the estimator behind the guard of its voltages."""
    return channels.with_guard(name, time, len(array.positions), estimator(array, time, tuning))


def estimator(array: SpatialArray, time: Discrete, tuning: SpatialTuning = DEFAULT_TUNING) -> Block:
    """Return the Block from held voltages, ``complete`` or with a redundant sensor ``fault_V_ax`` .. to the pose.

    Raises ModelError for fewer than four places, also after the loss of any sensor where one is redundant.
    """
    _check_places(array)
    setup, redundant = spatial_model.problem(array, tuning), is_redundant(array)

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        named: NamedExpressions = []
        prediction = _predict(x, setup)
        excluded = channels.refused_sensors(len(array.positions), u) if redundant else None
        solution = spatial_model.correct(prediction, spatial_model.sensors(array, u, k, excluded), setup, named)
        freedom, last = channels.freedom(len(array.positions), 6, excluded), solution.last
        fault = last.squares > freedom * tuning.residual_limit**2
        after = _advance(solution, fault, prediction, x, setup)
        variances = glsdc.variances(last.normal.factors)
        damped = glsdc.dot([ca.SX(d) for d in setup.damping], variances) > tuning.max_prior_weight
        gate_exceeded = last.cost - last.squares > (tuning.innovation_gate_sigma * array.deviation) ** 2
        rejected = ca.logic_or(damped, ca.logic_or(fault, gate_exceeded))
        accepted = after.inside if redundant else ca.logic_and(after.inside, u["complete"])
        valid = ca.logic_and(ca.logic_and(solution.converged, ca.logic_not(rejected)), accepted)
        output = _position(after.pose, array) | _deviations(variances, array)
        output |= {"residual": channels.residual(last.squares, freedom), "converged": solution.converged}
        output |= {"damped": damped, "valid": valid, "lock_lost": x["lock_lost"]}
        return Step(output, after.next, named)

    return build(
        "estimator",
        time,
        law,
        inputs=channels.estimator_inputs(len(array.positions), redundant),
        outputs=channels.outputs(OUTPUTS, (tuning.pitches + 2) * array.pitch, 1, FLAGS),
        states=_states(setup),
        constants=[Constant("alpha", array.alpha, "V", "fundamental"), Constant("beta", array.beta, "V", "5th wave")],
        tag="GLSDC, Fig. 9",
    )


def _check_places(array: SpatialArray) -> None:
    places = array.positions
    if len(set(places)) < MIN_SENSORS:
        raise ModelError(
            f"{len(set(places))} sensors lose rank on curves in the pitch, and no redundant voltage is left to "
            f"detect a false one: give {MIN_SENSORS} or more, each at a place of its own"
        )
    if is_redundant(array) and any(len({*places[:k], *places[k + 1 :]}) < MIN_SENSORS for k in range(len(places))):
        raise ModelError(
            f"{len(places)} sensors at {len(set(places))} places leave fewer than {MIN_SENSORS} of these after the "
            "loss of one: give each a place of its own"
        )


def _states(setup: Problem) -> list[State]:
    n = setup.tuning.pitches
    reals = [replace(s, about="pose of the last sample") for s in setup.ranges]
    reals += [Signal(f"start_{a}", "rad", -pi, pi, "phase at which the last search started") for a in "xy"]
    reals += [Signal("yaw_last_good", "rad", -pi, pi, "yaw of the last sample without a residual fault")]
    reals += [Signal(f"count_{a}", "1", -n, n, "number of whole pitches from the middle one") for a in "xy"]
    reals += [replace(s, name=f"motion_{s.name}", about="predicted change per sample") for s in setup.descent.bounds]
    return restarts.states(reals, [restarts.RESIDUAL_FAULTS, restarts.SEARCHING, restarts.LOCK_LOST])


def _predict(x: Exprs, setup: Problem) -> dict[str, ca.SX]:
    """Return the predicted pose, with gap and tilts clipped to their ranges."""
    prediction = {n: x[n] + x[m] for n, m in zip(POSE, MOTION, strict=True)}
    return prediction | {s.name: clip(prediction[s.name], s) for s in setup.ranges[2:5]}


def _advance(
    solution: Solution[LdlNormalEquations], fault: ca.SX, prediction: Exprs, x: Exprs, setup: Problem
) -> NextState:
    """Return the pose and the states after the corrections of the predicted pose."""
    correction = restarts.gate_correction(fault, POSE, solution.at, x)
    pose = {name: prediction[name] + correction[name] for name in POSE}
    inside = [ca.fabs(pose[s.name]) < s.high for s in setup.ranges[2:5]]
    for a in "xy":
        pose[f"phase_{a}"], turns = restarts.wrap(pose[f"phase_{a}"])
        inside.append(ca.fabs(x[f"count_{a}"]) < setup.tuning.pitches)
        pose[f"count_{a}"] = x[f"count_{a}"] + ca.if_else(inside[-1], turns, 0)
    pose["yaw"], _ = restarts.wrap(pose["yaw"])
    restart, faults = restarts.count_faults(fault, x)
    next = pose | {name: ca.if_else(restart, 0, pose[name]) for name in (*POSE[2:5], "count_x", "count_y")}
    next |= restarts.next_phases(restart, pose, x)
    next |= {"yaw": ca.if_else(restart, x["yaw_last_good"], pose["yaw"])}
    next |= {"yaw_last_good": ca.if_else(fault, x["yaw_last_good"], pose["yaw"]), "residual_faults": faults}
    next |= {"searching": ca.if_else(restart, 1, ca.if_else(fault, x["searching"], 0))}
    next |= {"lock_lost": ca.if_else(restart, 1, x["lock_lost"])}
    motion_unknown = ca.logic_and(fault, x["searching"])
    next |= {
        m: ca.if_else(motion_unknown, 0, x[m] + setup.tuning.velocity_gain * correction[n])
        for m, n in zip(MOTION, POSE, strict=True)
    }
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
    return {f"deviation_{name}": size * ca.sqrt(channels.ROOT_REGULARISATION + v) for name, size, v in named}
