"""Where the body is, from the voltages of two or more two-axis Hall sensors: modified GLSDC, in a fixed time.

    V_ax, V_ay, V_bx .. --->[ guard ]---> <name>_held ---> [ estimator ]---> X, Y, yaw, their deviations, flags
                               |------- complete -------------^

A sample begins where the last motion leads: sines and cosines of that position and yaw are computed once, and `descent`
corrects it. The damping of `correction` holds to it what the voltages do not tell: two sensors lose rank at places.
There the estimate goes on as it did in one direction for as long as the place is passed, and is `damped`.

`valid` is an estimate that has converged, is not damped, leaves residuals as small as the field's model does, is no
motion that a body cannot make, and rests on measurements that are all accepted, or on the others where there are more
than two sensors. Its place is certain, as no other within a range of yaws has the same voltages, and has never been
lost since. Positions are absolute in a pitch, and count pitches on from where `init` puts them; a body that has left
the pitches that are counted, or the yaws that are declared, is not valid again until then. The voltages are the same
when everything is turned by 90 degrees about a strong block, so that the yaw is known to a quarter turn; it goes on
from the last one.

Deviations are those of a body at rest, from the normal equations: deviation^2 (H'W H + damping)^-1, where the yaw is
damped as the phases are: that it is held more firmly makes none of them smaller.

Source: Kawato, Kim, "Multi-Degree-of-Freedom Precision Position Sensing", section 3.B, Fig. 9.
"""

from collections.abc import Sequence
from functools import reduce
from math import pi, sqrt
from operator import add

import casadi as ca
import numpy as np

from designs.hall_position.glsdc import base, channels, descent, tracking
from designs.hall_position.glsdc.correction import AXES, Equations, Wave
from designs.hall_position.glsdc.descent import Named, Problem
from designs.hall_position.glsdc.parameters import Array, Tuning
from synth.block import Block, Exprs, Step, build
from synth.signals import Signal
from synth.timing import Discrete

REASON = "an estimator moves nothing: once latched it goes on and tells so in the fault word"
MORE = 4  # times as much as with two sensors may the damping decide at a certain place, with more than two
LOOSE = 1e4  # m: 1e-3 is never exceeded, but intervals do not see what is equal in numerator and denominator
APART = 4.0  # deviations, rms, of voltages that do not fit each other
USUAL = Tuning()
# Relative, of polynomials: a sine that is wrong by 3e-7 is a position that is wrong by 3 nm.
SURROGATE_ERROR: dict[type[np.floating], float] = {np.float32: 3e-7, np.float64: 1e-15}
FLAGS = (
    channels.CONVERGED,
    Signal("damped", "1", 0, 1, "the voltages do not tell all of the position"),
    Signal(
        "valid", "1", 0, 1, "converged, place certain and never lost, not damped, astray or sudden, inputs accepted"
    ),
    Signal(
        "restarted",
        "1",
        0,
        1,
        "its place has been lost, or left what is declared: pitches are not known, and nothing is valid until init",
    ),
)


def guarded(array: Array, time: Discrete, tuning: Tuning = USUAL, name: str = "hall_position") -> Block:
    """Return the estimator behind the guard of its voltages."""
    return channels.guarded(name, time, len(array.positions), estimator(array, time, tuning), REASON)


def estimator(array: Array, time: Discrete, tuning: Tuning = USUAL) -> Block:
    """Return the Block from held voltages, ``complete`` and with a spare sensor ``fault_V_ax`` .. to X, Y and yaw."""
    problem = descent.problem(array, tuning)

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        named: Named = []
        left_out, begun = tracking.left_out(array, u, x), tracking.expected(x, problem)
        heading = base.heading(begun["yaw"], named)
        sensors = base.sensors(base.Base(u, begun, k, heading, left_out), problem, named)
        found = descent.corrected(sensors, problem, named)
        freedom = channels.freedom(len(array.positions), 3, left_out)
        leaning = _leaning(found.last.equations, problem)
        damped = leaning > tuning.leaning / problem.damping
        once = tuning.surprise * array.deviation / sqrt(problem.damping)  # rad
        surprise = once + once * x["astray"] if tracking.spare(array) else ca.SX(once)
        sudden = found.last.moved > surprise**2
        large = found.last.squares > freedom * tuning.residual**2
        near = tracking.near(begun["yaw"] + found.at.yaw, x, tuning)
        astray = ca.logic_or(large, ca.if_else(x["certain"], sudden, ca.logic_and(x["searching"], ca.logic_not(near))))
        good = ca.logic_and(found.converged, ca.logic_not(ca.logic_or(damped, ca.logic_or(astray, sudden))))
        telling = ca.logic_and(good, _telling(left_out, near, leaning, x, problem))
        telling = telling if tracking.spare(array) else ca.logic_and(telling, u["complete"])
        apart = found.last.squares > freedom * min(tuning.residual, APART * array.deviation) ** 2
        ahead = tracking.ahead(found, tracking.Verdict(astray, apart, damped, telling), begun, x, problem)
        lever = _levers(heading, ahead.turn, array, named)
        output = _position(ahead.found, lever, array) | _deviations(found.last.equations, lever, problem)
        accepted = ahead.inside if tracking.spare(array) else ca.logic_and(ahead.inside, u["complete"])
        known = ca.logic_and(ahead.certain, ca.logic_not(x["restarted"]))
        output |= {"residual": channels.residual(found.last.squares, freedom), "converged": found.converged}
        output |= {
            "damped": damped,
            "valid": ca.logic_and(good, ca.logic_and(known, accepted)),
            "restarted": x["restarted"],
        }
        output |= {"without": x["without"]} if tracking.spare(array) else {}
        return Step(output, ahead.next, named)

    return build(
        "estimator",
        time,
        law,
        inputs=channels.held(len(array.positions), tracking.spare(array)),
        outputs=_outputs(array, tuning),
        states=tracking.states(problem),
        constants=base.constants(array),
        tag="GLSDC, Fig. 9",
    )


def _outputs(array: Array, tuning: Tuning) -> list[Signal]:
    far = (tuning.pitches + 2) * array.pitch + sum(map(abs, array.centre))
    found = [Signal(axis, "m", -far, far, "of the body's origin over the matrix") for axis in "XY"]
    found += [Signal("yaw", "rad", -pi, pi, "of the body over the matrix")]
    noise = "standard deviation by the noise of the voltages"
    found += [Signal(f"deviation_{a}", "m", 0, LOOSE, noise) for a in "XY"]
    found += [Signal("deviation_yaw", "rad", 0, 1, noise)]
    found += [channels.RESIDUAL, *FLAGS]
    left_out = Signal("without", "1", 0, len(array.positions), "number of the sensor that is left out")
    return [*found, left_out] if tracking.spare(array) else found


def _telling(left_out: Sequence[ca.SX] | None, near: ca.SX, leaning: ca.SX, x: Exprs, of: Problem) -> ca.SX:
    """Return whether a place is told apart from all others, from the sample on after that which ended the search.

    With two sensors it takes a yaw `near` the last one. A body that moves is then sudden until its motion is known.
    """
    found, sensors, certain = ca.logic_not(x["searching"]), len(of.array.positions), of.tuning.certain / of.damping
    if left_out is None:
        return ca.logic_and(ca.logic_and(near, found), leaning <= certain)
    enough = ca.logic_and(reduce(add, left_out) < sensors - 2, leaning <= MORE * certain)
    return ca.logic_and(enough, found)


def _levers(heading: Wave, yaw: ca.SX, array: Array, named: Named) -> dict[str, ca.SX]:
    """Return by axis how far the centre lies from the body's origin, m, turned by a yaw since the sample began."""
    x, y = array.centre
    if x == y == 0:
        return dict.fromkeys(AXES, ca.SX(0))
    turn, _ = descent.turned(yaw, named)
    s = heading.sine * turn.cosine + heading.cosine * turn.sine
    c = heading.cosine * turn.cosine - heading.sine * turn.sine
    return {"x": c * x - s * y, "y": s * x + c * y}


def _position(pose: Exprs, lever: Exprs, array: Array) -> dict[str, ca.SX]:
    """Return X and Y of the body's origin, m, and the yaw."""
    return {a.upper(): _metres(pose, a, array) - lever[a] for a in AXES} | {"yaw": pose["yaw"]}


def _metres(pose: Exprs, axis: str, array: Array) -> ca.SX:
    return pose[f"phase_{axis}"] / array.wave_number + pose[f"pitch_{axis}"] * array.pitch


def _deviations(of: Equations, lever: Exprs, problem: Problem) -> dict[str, ca.SX]:
    """Return the standard deviations of X, Y in m and of the yaw, rad."""
    array = problem.array
    yaw, sigma, w = 1 / _information(of, problem), array.deviation, array.wave_number
    by_yaw = {"x": lever["y"], "y": -lever["x"]}  # X = X_centre - lever_x, whose derivative is lever_y
    found = {"deviation_yaw": sigma * ca.sqrt(yaw)}
    for axis, n in of.axes.items():
        slope = n.coupling * n.inverse - w * by_yaw[axis]
        found[f"deviation_{axis.upper()}"] = sigma / w * ca.sqrt(n.inverse + yaw * slope**2)
    return found


def _leaning(of: Equations, problem: Problem) -> ca.SX:
    """Return the trace of (N + damping)^-1, 1/V^2: times the damping how many of three parameters that decides."""
    total, alone = ca.SX(problem.array.radius**2), ca.SX(0)
    for n in of.axes.values():
        total, alone = total + (n.coupling * n.inverse) ** 2, alone + n.inverse
    return total / _information(of, problem) + alone


def _information(of: Equations, problem: Problem) -> ca.SX:
    """Return what a sample tells of the yaw, damped no more than the phases are."""
    return of.told + problem.damping * problem.array.radius**2
