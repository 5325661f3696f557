"""Where the body is in all six degrees of freedom, from the voltages of four or more two-axis Hall sensors: GLSDC.

    V_ax, V_ay, .. V_dy --->[ guard ]---> <name>_held ---> [ estimator ]---> X, Y, Z, roll, pitch, yaw, ..
                               |------- complete -------------^                deviations and flags

A sample begins where the last motion leads, motion <- motion + follow * correction, and `six_descent` corrects it. The
damping holds to that what the voltages do not tell; the estimate is `damped` there. With a fifth sensor a sensor of
which a voltage is refused is left out, and the others tell the pose.

`valid` is an estimate that has converged, is not damped, leaves residuals as small as the field's model does, is no
motion that a body cannot make, lies within the gap and the tilts of the tuning, and rests on measurements that are
accepted. A body whose residuals are larger goes on as before; after PATIENCE samples of that it is searched: every
PATIENCE samples begin elsewhere in the pitch, level, at the height and with the last yaw that was known, at points that
fill the pitch evenly (Roberts' sequence) wherever the corrections from the last one led. Pitches then count from 0.

Deviations are those of a body at rest, deviation^2 (H'H + damping)^-1, by the Jacobian where the sample begins.

Source: Kawato, Kim, "Multi-Degree-of-Freedom Precision Position Sensing", section 3, Fig. 6 (b) and Fig. 9.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import reduce
from math import pi
from string import ascii_lowercase

import casadi as ca
import numpy as np

from designs.hall_position.glsdc import channels, restarts, six_descent
from designs.hall_position.glsdc.channels import AXES
from designs.hall_position.glsdc.six_correction import Sensor
from designs.hall_position.glsdc.six_descent import POSE, Found, Named, Problem
from designs.hall_position.glsdc.six_parameters import Array, Tuning
from synth.block import Block, Constant, Exprs, State, Step, build, clip
from synth.errors import ModelError
from synth.signals import Signal
from synth.synthesise import normal_equations
from synth.timing import Discrete

ENOUGH = 4  # sensors; one more is to spare
USUAL = Tuning()
# Relative, of polynomials: a sine that is wrong by 2e-7 is a position that is wrong by 2 nm.
SURROGATE_ERROR: dict[type[np.floating], float] = {np.float32: 2e-7, np.float64: 1e-15}
MOTION = tuple(f"motion_{name}" for name in POSE)
OUTPUTS = ("X", "Y", "Z", "roll", "pitch", "yaw")
FLAGS = (
    channels.CONVERGED,
    Signal("damped", "1", 0, 1, "the voltages do not tell all of the pose"),
    Signal("valid", "1", 0, 1, "converged, neither damped, astray nor sudden, inputs accepted, in its ranges"),
    Signal("restarted", "1", 0, 1, "has looked for its place again: pitches are not known any more"),
)


@dataclass(frozen=True, eq=False)
class Ahead:
    """The pose found and the next states, by name; `inside`: whether it is within its ranges."""

    pose: Mapping[str, ca.SX]
    next: Mapping[str, ca.SX]
    inside: ca.SX


def spare(array: Array) -> bool:
    """Return whether one sensor can be left out."""
    return len(array.positions) > ENOUGH


def guarded(array: Array, time: Discrete, tuning: Tuning = USUAL, name: str = "hall_pose") -> Block:
    """Return the estimator behind the guard of its voltages."""
    return channels.guarded(name, time, len(array.positions), estimator(array, time, tuning))


def estimator(array: Array, time: Discrete, tuning: Tuning = USUAL) -> Block:
    """Return the Block from held voltages, ``complete`` or with a spare sensor ``fault_V_ax`` .. to the pose.

    Raises ModelError for fewer than four places, or of sensors with one to spare fewer than four after its loss.
    """
    _check_places(array)
    problem = six_descent.problem(array, tuning)

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        named: Named = []
        begun = _expected(x, problem)
        left_out = channels.refused(len(array.positions), u) if spare(array) else None
        start = six_descent.started(begun, _sensors(array, u, k, left_out), problem, named)
        found = six_descent.corrected(start, problem, named)
        freedom = channels.freedom(len(array.positions), 6, left_out)
        astray = found.last.squares > freedom * tuning.residual**2
        ahead = _ahead(found, astray, begun, x, problem)
        variances = normal_equations.variances(found.factors)
        leaning = normal_equations.dot([ca.SX(d) for d in problem.damping], variances)
        damped = leaning > tuning.leaning
        sudden = found.last.cost - found.last.squares > (tuning.surprise * array.deviation) ** 2
        doubt = ca.logic_or(damped, ca.logic_or(astray, sudden))
        accepted = ahead.inside if spare(array) else ca.logic_and(ahead.inside, u["complete"])
        valid = ca.logic_and(ca.logic_and(found.converged, ca.logic_not(doubt)), accepted)
        output = _position(ahead.pose, array) | _deviations(variances, array)
        output |= {"residual": channels.residual(found.last.squares, freedom), "converged": found.converged}
        output |= {"damped": damped, "valid": valid, "restarted": x["restarted"]}
        return Step(output, ahead.next, named)

    return build(
        "estimator",
        time,
        law,
        inputs=channels.held(len(array.positions), spare(array)),
        outputs=_outputs(array, tuning),
        states=_states(problem),
        constants=[Constant("alpha", array.alpha, "V", "fundamental"), Constant("beta", array.beta, "V", "5th wave")],
        tag="GLSDC, Fig. 9",
    )


def _check_places(array: Array) -> None:
    places = array.positions
    if len(set(places)) < ENOUGH:
        raise ModelError(
            f"{len(set(places))} sensors lose rank on curves in the pitch, and no voltage is left by which a false "
            f"one is seen: give {ENOUGH} or more, each at a place of its own"
        )
    if spare(array) and any(len({*places[:k], *places[k + 1 :]}) < ENOUGH for k in range(len(places))):
        raise ModelError(
            f"{len(places)} sensors at {len(set(places))} places leave fewer than {ENOUGH} of these after the loss "
            "of one: give each a place of its own"
        )


def _outputs(array: Array, tuning: Tuning) -> list[Signal]:
    far = (tuning.pitches + 2) * array.pitch
    found = [Signal(axis, "m", -far, far, "of the body's origin over the matrix") for axis in "XY"]
    found += [Signal("Z", "m", 0, 1, "of the body's origin above the matrix")]
    found += [Signal(name, "rad", -pi, pi, "of the body over the matrix") for name in OUTPUTS[3:]]
    about = "standard deviation by the noise of the voltages"
    found += [Signal(f"deviation_{name}", "m" if name in "XYZ" else "rad", 0, 1, about) for name in OUTPUTS]
    return [*found, channels.RESIDUAL, *FLAGS]


def _states(of: Problem) -> list[State]:
    n = of.tuning.pitches
    reals = [replace(s, about="of the last sample") for s in of.ranges]
    reals += [Signal(f"start_{a}", "rad", -pi, pi, "where it was last begun elsewhere") for a in AXES]
    reals += [Signal("yaw_known", "rad", -pi, pi, "of the last sample that was not astray")]
    reals += [Signal(f"count_{a}", "1", -n, n, "whole pitches to the one of the origin") for a in "xy"]
    reals += [Signal(m, "rad", s.low, s.high, "expected in a sample") for m, s in zip(MOTION, of.bounds, strict=True)]
    counts = [restarts.ASTRAY, restarts.SEARCHING, restarts.RESTARTED]
    return [*(State(s, 0.0) for s in reals), *(State(s, int(s.name == "searching"), True) for s in counts)]


def _expected(x: Exprs, of: Problem) -> dict[str, ca.SX]:
    """Return the pose with which a sample begins, at a gap and tilts that are within their ranges."""
    begun = {n: x[n] + x[m] for n, m in zip(POSE, MOTION, strict=True)}
    return begun | {s.name: clip(begun[s.name], s) for s in of.ranges[2:5]}


def _sensors(array: Array, u: Exprs, k: Exprs, left_out: Sequence[ca.SX] | None) -> list[Sensor]:
    """Return the sensors; one that is left out reads 0 in no field, by a product with 0."""
    found = []
    for n, (letter, arm) in enumerate(zip(ascii_lowercase, array.arms, strict=False)):
        kept = ca.SX(1) if left_out is None else 1 - left_out[n]
        ux, uy, alpha, beta = (
            kept * v for v in (u[f"V_{letter}x_held"], u[f"V_{letter}y_held"], k["alpha"], k["beta"])
        )
        found.append(Sensor(arm, (ux, uy), alpha, beta))
    return found


def _ahead(found: Found, astray: ca.SX, begun: Exprs, x: Exprs, of: Problem) -> Ahead:
    """Return what comes of the corrections of a pose with which a sample has `begun`, and which may be `astray`."""
    stays, tuning = ca.logic_and(astray, ca.logic_not(x["searching"])), of.tuning
    by = {name: ca.if_else(stays, 0, d) for name, d in zip(POSE, found.at, strict=True)}
    pose = {name: begun[name] + by[name] for name in POSE}
    inside = [ca.fabs(pose[s.name]) < s.high for s in of.ranges[2:5]]
    for a in "xy":
        pose[f"phase_{a}"], turns = restarts.wrapped(pose[f"phase_{a}"])
        inside.append(ca.fabs(x[f"count_{a}"]) < tuning.pitches)
        pose[f"count_{a}"] = x[f"count_{a}"] + ca.if_else(inside[-1], turns, 0)
    pose["yaw"], _ = restarts.wrapped(pose["yaw"])
    restart = restarts.counted(astray, x)
    again = restart.again
    next = pose | {name: ca.if_else(again, 0, pose[name]) for name in (*POSE[2:5], "count_x", "count_y")}
    next |= restarts.phases(again, pose, x)
    next |= {"yaw": ca.if_else(again, x["yaw_known"], pose["yaw"])}
    next |= {"yaw_known": ca.if_else(astray, x["yaw_known"], pose["yaw"])}
    next |= {"astray": restart.astray}
    next |= {"searching": ca.if_else(again, 1, ca.if_else(astray, x["searching"], 0))}
    next |= {"restarted": ca.if_else(again, 1, x["restarted"])}
    lost = ca.logic_and(astray, x["searching"])
    for m, bound in zip(MOTION, of.bounds, strict=True):
        next[m] = ca.if_else(lost, 0, x[m] + tuning.follow * by[bound.name])
    return Ahead(pose, next, reduce(ca.logic_and, inside))


def _position(pose: Exprs, array: Array) -> dict[str, ca.SX]:
    """Return the body's origin, m, and its angles."""
    w = array.wave_number
    found = {a.upper(): pose[f"phase_{a}"] / w + pose[f"count_{a}"] * array.pitch for a in "xy"}
    return found | {"Z": array.height + pose["rise"] / w} | {name: pose[name] for name in OUTPUTS[3:]}


def _deviations(variances: Sequence[ca.SX], array: Array) -> dict[str, ca.SX]:
    """Return standard deviations, m and rad."""
    sizes = [array.deviation / array.wave_number] * 3 + [array.deviation] * 3
    return {
        f"deviation_{name}": size * ca.sqrt(channels.LEAST + v)
        for name, size, v in zip(OUTPUTS, sizes, variances, strict=True)
    }
