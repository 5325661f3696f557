"""Where the body is, from the voltages of two or more two-axis Hall sensors: modified GLSDC, in a fixed time.

    V_ax, V_ay, V_bx .. --->[ guard ]---> <name>_held ---> [ estimator ]---> X, Y, yaw, their deviations, flags
                               |------- complete -------------^

A sample begins where the last one ended: sines and cosines of that position and yaw are computed once, and `descent`
corrects it. The damping of `correction` holds to the last estimate what the voltages do not tell: two sensors lose rank
at places. There the estimate stays where it was in one direction for as long as the place is passed, and is `damped`.

`valid` is an estimate that has converged, is not damped, leaves residuals as small as the field's model does, and rests
on measurements that are all accepted. Positions are absolute in a pitch, and count pitches on from where `init` puts
them; a body that comes to the last of the pitches that are counted is not valid again until then. The voltages are the
same when everything is turned by 90 degrees about a strong block, so that the yaw is known to a quarter turn; it goes
on from the last one.

Deviations are those of a body at rest, from the normal equations: deviation^2 (H'W H + damping)^-1.

Source: Kawato, Kim, "Multi-Degree-of-Freedom Precision Position Sensing", section 3.B, Fig. 9.
"""

from collections.abc import Mapping
from dataclasses import replace
from math import pi
from string import ascii_lowercase

import casadi as ca

from designs.hall_position import descent
from designs.hall_position.correction import AXES, Equations, Sensor, Wave
from designs.hall_position.descent import Found, Named, Problem
from designs.hall_position.parameters import Array, Tuning
from synth.block import Block, Constant, Exprs, State, Step, build, clip
from synth.compose import compose
from synth.signals import Signal, names
from synth.synthesise import safety
from synth.timing import Discrete

SPAN = 5.0  # V, of the converter
BAD_SAMPLES = 5
LEAST = 1e-20  # V^2, in a root: squares are not below 0, which is not seen of products that may not be rounded
USUAL = Tuning()
UNIT = Signal("unit", "1", -1, 1)
COMPLETE = Signal("complete", "1", 0, 1, "every measurement is good")
FLAGS = (
    Signal("converged", "1", 0, 1, "the last correction is small, and none has raised the cost"),
    Signal("damped", "1", 0, 1, "the voltages do not tell all of the position"),
    Signal("valid", "1", 0, 1, "converged, not damped, residual and inputs accepted, pitch counted"),
)


def voltages(array: Array) -> tuple[Signal, ...]:
    """Return the voltages of sensors a, b, ... in order, each with its two axes."""
    letters = ascii_lowercase[: len(array.positions)]
    return tuple(Signal(f"V_{k}{axis}", "V", -SPAN, SPAN, "Hall sensor and axis") for k in letters for axis in AXES)


def guarded(array: Array, time: Discrete, tuning: Tuning = USUAL, name: str = "hall_position") -> Block:
    """Return the estimator behind the guard of its voltages, which latches after BAD_SAMPLES incomplete samples."""
    inputs = voltages(array)
    guard = safety.guard(time, [safety.Guarded(s, 0.0, True) for s in inputs], BAD_SAMPLES)
    block = estimator(array, time, tuning)
    return compose(name, [guard, block], inputs=names(inputs), outputs=names(block.outputs))


def estimator(array: Array, time: Discrete, tuning: Tuning = USUAL) -> Block:
    """Return the Block from held voltages and ``complete`` to X, Y in m, yaw in rad, their deviations and flags."""
    problem = descent.problem(array, tuning)

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        named: Named = []
        heading = _wave(x["yaw"], 2, "yaw_part", named)
        sensors = [_sensor(problem, n, u, x, k, heading, named) for n in range(len(array.positions))]
        found = descent.corrected(sensors, problem, named)
        next, inside = _ahead(found, x, tuning)
        lever = _levers(heading, found, array, named)
        output = _position(next, lever, array) | _deviations(found.last.equations, lever, array)
        return Step(output | _judged(found, problem, ca.logic_and(inside, u["complete"])), next, named)

    return build(
        "estimator",
        time,
        law,
        inputs=[*(replace(s, name=f"{s.name}_held") for s in voltages(array)), COMPLETE],
        outputs=_outputs(array, tuning),
        states=_states(tuning),
        constants=_constants(array),
        tag="GLSDC, Fig. 9",
    )


def _outputs(array: Array, tuning: Tuning) -> list[Signal]:
    far = (tuning.pitches + 1) * array.pitch + sum(map(abs, array.centre))
    found = [Signal(axis, "m", -far, far, "of the body's origin over the matrix") for axis in "XY"]
    found += [Signal("yaw", "rad", -pi, pi, "of the body over the matrix")]
    found += [Signal(f"deviation_{a}", "m", 0, 1, "standard deviation by the noise of the voltages") for a in "XY"]
    found += [Signal("deviation_yaw", "rad", 0, 1, "standard deviation by the noise of the voltages")]
    return [*found, Signal("residual", "V", 0, 1e3, "root mean square by degrees of freedom"), *FLAGS]


def _states(tuning: Tuning) -> list[State]:
    n = tuning.pitches
    found = [Signal(f"phase_{a}", "rad", -pi, pi, "of the sensors' centre in its pitch") for a in AXES]
    found += [Signal("yaw", "rad", -pi, pi, "of the last sample")]
    found += [Signal(f"pitch_{a}", "1", -n, n, "whole pitches to the one of the sensors' centre") for a in AXES]
    return [State(s, 0.0) for s in found]


def _constants(array: Array) -> list[Constant]:
    powers = {1: array.alpha + 5 * array.beta, 3: -20 * array.beta, 5: 16 * array.beta}
    about = "alpha sin p + beta sin 5p by powers of the sine"
    field = [Constant(f"field_{n}", v, "V", about) for n, v in powers.items()]
    return [*field, *(Constant(f"slope_{n - 1}", n * v, "V", f"derivative of {about}") for n, v in powers.items())]


def _wave(angle: ca.SX, halvings: int, name: str, named: Named) -> Wave:
    """Return sine and cosine of an angle, from those of a part of it that is small enough for polynomials."""
    s, c = ca.sin(angle / 2**halvings), ca.cos(angle / 2**halvings)
    for what, value in (("sine", s), ("cosine", c)):
        named.append((Signal(f"{name}_{what}", "1", -1, 1, f"of 1/{2**halvings} of it"), value))
    for _ in range(halvings):
        s, c = 2 * s * c, 1 - 2 * s**2
    return Wave(clip(s, UNIT), clip(c, UNIT))


def _sensor(of: Problem, n: int, u: Exprs, x: Exprs, k: Exprs, heading: Wave, named: Named) -> Sensor:
    """Return sensor n where the last sample has left it; its weight is on its voltages."""
    letter, scale, (ax, ay) = ascii_lowercase[n], of.array.scales[n], of.array.arms[n]
    s, c = heading.sine, heading.cosine
    place = {"x": c * ax - s * ay, "y": s * ax + c * ay}
    phase = {a: _wave(x[f"phase_{a}"] + place[a], of.halvings, "phase_part", named) for a in AXES}
    vx, vy = (scale * u[f"V_{letter}{a}_held"] for a in AXES)
    volts = {"x": c * vx - s * vy, "y": s * vx + c * vy}
    field = [ca.SX(scale * of.array.c), *(scale * k[f"field_{i}"] for i in (1, 3, 5))]
    return Sensor(phase, place, volts, field, [scale * k[f"slope_{i}"] for i in (0, 2, 4)])


def _ahead(found: Found, x: Exprs, tuning: Tuning) -> tuple[dict[str, ca.SX], ca.SX]:
    """Return the next states and whether the pitches are counted; the last pitch on either side is never left."""
    next, inside = {"yaw": _wrapped(x["yaw"] + found.at.yaw)[0]}, []
    for a in AXES:
        phase, turns = _wrapped(x[f"phase_{a}"] + found.at.phase[a])
        inside.append(ca.fabs(x[f"pitch_{a}"]) < tuning.pitches)
        next |= {f"phase_{a}": phase, f"pitch_{a}": x[f"pitch_{a}"] + ca.if_else(inside[-1], turns, 0)}
    return next, ca.logic_and(*inside)


def _wrapped(angle: ca.SX) -> tuple[ca.SX, ca.SX]:
    """Return an angle in -3 pi .. 3 pi within half a turn, and the whole turns that are taken off."""
    above, below = angle > pi, angle < -pi
    turns = ca.if_else(above, 1, ca.if_else(below, -1, 0))
    return ca.if_else(above, angle - 2 * pi, ca.if_else(below, angle + 2 * pi, angle)), turns


def _levers(heading: Wave, found: Found, array: Array, named: Named) -> dict[str, ca.SX]:
    """Return by axis how far the centre lies from the body's origin, m, after the last correction."""
    x, y = array.centre
    if x == y == 0:
        return dict.fromkeys(AXES, ca.SX(0))
    turn, _ = descent.turned(found.at.yaw, named)
    s = heading.sine * turn.cosine + heading.cosine * turn.sine
    c = heading.cosine * turn.cosine - heading.sine * turn.sine
    return {"x": c * x - s * y, "y": s * x + c * y}


def _position(next: Mapping[str, ca.SX], lever: Mapping[str, ca.SX], array: Array) -> dict[str, ca.SX]:
    """Return X and Y of the body's origin, m, and the yaw."""
    found = {a.upper(): _metres(next, a, array) - lever[a] for a in AXES}
    return found | {"yaw": next["yaw"]}


def _metres(next: Mapping[str, ca.SX], axis: str, array: Array) -> ca.SX:
    return next[f"phase_{axis}"] / array.wave_number + next[f"pitch_{axis}"] * array.pitch


def _deviations(of: Equations, lever: Mapping[str, ca.SX], array: Array) -> dict[str, ca.SX]:
    """Return the standard deviations of X, Y in m and of the yaw, rad."""
    yaw, sigma, w = 1 / of.information, array.deviation, array.wave_number
    by_yaw = {"x": lever["y"], "y": -lever["x"]}  # X = X_centre - lever_x, whose derivative is lever_y
    found = {"deviation_yaw": sigma * ca.sqrt(yaw)}
    for axis, n in of.axes.items():
        slope = by_yaw[axis] - n.coupling * n.inverse / w
        found[f"deviation_{axis.upper()}"] = sigma * ca.sqrt(n.inverse / w**2 + yaw * slope**2)
    return found


def _judged(found: Found, of: Problem, accepted: ca.SX) -> dict[str, ca.SX]:
    """Return the residual and the flags."""
    array, tuning, last = of.array, of.tuning, found.last
    freedom = 2 * len(array.positions) - 3
    by_damping = _leaning(last.equations, of)
    damped = by_damping > tuning.leaning
    small = last.squares <= freedom * tuning.residual**2
    valid = ca.logic_and(ca.logic_and(found.converged, ca.logic_not(damped)), ca.logic_and(small, accepted))
    return {
        "residual": ca.sqrt(LEAST + last.squares / freedom),
        "converged": found.converged,
        "damped": damped,
        "valid": valid,
    }


def _leaning(of: Equations, problem: Problem) -> ca.SX:
    """Return how many of the three parameters the damping decides: the trace of (N + damping)^-1 damping."""
    total, alone = ca.SX(problem.array.radius**2), ca.SX(0)
    for n in of.axes.values():
        total, alone = total + (n.coupling * n.inverse) ** 2, alone + n.inverse
    return problem.damping * (total / of.information + alone)
