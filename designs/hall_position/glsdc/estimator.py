"""Position and yaw from the voltages of two or more two-axis Hall sensors: modified GLSDC, in a fixed time.

    V_ax, V_ay, V_bx .. --->[ guard ]---> <name>_held ---> [ estimator ]---> X, Y, yaw, their deviations, flags
                               |------- complete -------------^

The damping holds to the predicted pose what the voltages do not tell: two sensors lose rank at places, where the
estimate goes on as it did in one direction and is `damped`.

`valid` is an estimate that has converged, is not damped, has neither a residual fault nor a sudden motion, and rests on
measurements that are all accepted, or on the others with more than two sensors. Its place is certain and has never been
lost since. Positions count pitches on from where `init` puts them; a body that has left the pitches that are counted,
or the yaws that are declared, is not valid again until then. The voltages are the same when everything is turned by 90
degrees about a strong block: the yaw is known to a quarter turn, and goes on from the last one.

Deviations are those of a body at rest, deviation^2 (H'W H + damping)^-1, where the yaw is damped as the phases are.

Source: Kawato, Kim, "Multi-Degree-of-Freedom Precision Position Sensing", section 3.B, Fig. 9.
"""

import casadi as ca
import numpy as np

from designs.hall_position.glsdc import channels, planar_model, tracking
from designs.hall_position.glsdc.parameters import Tuning
from designs.hall_position.glsdc.planar_model import Normal, Problem
from models import hall_planar
from models.hall_two_waves import PlanarArray
from synth.block import Block, Exprs, Step, build
from synth.blocks import glsdc, phasor
from synth.blocks.glsdc import Named
from synth.blocks.phasor import Phasor
from synth.signals import Signal
from synth.timing import Discrete

REASON = "an estimator moves nothing: once latched it goes on and tells so in the fault word"
LOOSE = 1e4  # m: 1e-3 is never exceeded, but intervals do not see what is equal in numerator and denominator
USUAL = Tuning()
# Relative, of polynomials: a sine that is wrong by 3e-7 is a position that is wrong by 3 nm.
SURROGATE_ERROR: dict[type[np.floating], float] = {np.float32: 3e-7, np.float64: 1e-15}
FLAGS = {
    "damped": "the voltages do not tell all of the position",
    "valid": "converged, place certain and never lost, not damped, astray or sudden, inputs accepted",
    "restarted": "its place has been lost, or left what is declared: pitches are not known, and nothing is valid until "
    "init",
}


def guarded(array: PlanarArray, time: Discrete, tuning: Tuning = USUAL, name: str = "hall_position") -> Block:
    """Return the estimator behind the guard of its voltages."""
    return channels.guarded(name, time, len(array.positions), estimator(array, time, tuning), REASON)


def estimator(array: PlanarArray, time: Discrete, tuning: Tuning = USUAL) -> Block:
    """Return the Block from held voltages, ``complete`` or, if redundant, ``fault_V_ax`` .. to X, Y and yaw."""
    of, redundant = planar_model.problem(array, tuning), tracking.is_redundant(array)

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        named: Named = []
        left_out, begun = tracking.left_out(array, u, x), tracking.predict(x, of)
        heading = phasor.reduced(begun["yaw"], 2, "yaw_part", named)
        sensors = planar_model.sensors(u, begun, k, heading, left_out, of, named)
        solution = glsdc.descend(planar_model.weigh(sensors, of, named), of.descent)
        normal, yaw = solution.last.normal, begun["yaw"] + solution.at[2]
        judged = tracking.judge(of, solution, yaw, _prior_weight(normal, of), left_out, u, x)
        after = tracking.advance(solution, judged, begun, x, of)
        lever = _lever(heading, after.turn, array, named)
        known = ca.logic_and(after.certain, ca.logic_not(x["restarted"]))
        accepted = after.inside if redundant else ca.logic_and(after.inside, u["complete"])
        freedom = channels.freedom(len(array.positions), 3, left_out)
        output = _position(after.pose, lever, array) | _deviations(normal, lever, of)
        output |= {"residual": channels.residual(solution.last.squares, freedom), "converged": solution.converged}
        output |= {"damped": judged.damped, "valid": ca.logic_and(judged.good, ca.logic_and(known, accepted))}
        output |= {"restarted": x["restarted"]} | ({"without": x["without"]} if redundant else {})
        return Step(output, after.next, named)

    return build(
        "estimator",
        time,
        law,
        inputs=channels.held(len(array.positions), redundant),
        outputs=_outputs(array, tuning),
        states=tracking.states(of),
        constants=hall_planar.constants(array),
        tag="GLSDC, Fig. 9",
    )


def _outputs(array: PlanarArray, tuning: Tuning) -> list[Signal]:
    far = (tuning.pitches + 2) * array.pitch + sum(map(abs, array.centre))
    outputs = channels.outputs(("X", "Y", "yaw"), far, LOOSE, FLAGS)
    return [*outputs, tracking.left_out_number(array)] if tracking.is_redundant(array) else outputs


def _lever(heading: Phasor, yaw: ca.SX, array: PlanarArray, named: Named) -> Phasor:
    """Return the centre from the body's origin, m, turned by a yaw since the sample began."""
    x, y = array.centre
    if x == y == 0:
        return Phasor(ca.SX(0), ca.SX(0))
    return heading.times(hall_planar.turned(yaw, named)[0]).times(Phasor(ca.SX(x), ca.SX(y)))


def _position(pose: Exprs, lever: Phasor, array: PlanarArray) -> dict[str, ca.SX]:
    """Return X and Y of the body's origin, m, and the yaw."""
    x, y = (pose[f"phase_{a}"] / array.wave_number + pose[f"pitch_{a}"] * array.pitch for a in planar_model.AXES)
    return {"X": x - lever.cosine, "Y": y - lever.sine, "yaw": pose["yaw"]}


def _deviations(of: Normal, lever: Phasor, problem: Problem) -> dict[str, ca.SX]:
    """Return the standard deviations of X, Y in m and of the yaw, rad."""
    sigma, w = problem.array.deviation, problem.array.wave_number
    yaw = 1 / _yaw_information(of, problem)
    slopes = lever.sine, -lever.cosine  # X = X_centre - lever_x, whose derivative is lever_y
    deviations = {"deviation_yaw": sigma * ca.sqrt(yaw)}
    for name, n, slope in zip("XY", of.axes, slopes, strict=True):
        by_yaw = n.coupling * n.inverse - w * slope
        deviations[f"deviation_{name}"] = sigma / w * ca.sqrt(n.inverse + yaw * by_yaw**2)
    return deviations


def _prior_weight(of: Normal, problem: Problem) -> ca.SX:
    """Return the trace of (N + damping)^-1, 1/V^2: times the damping how many of three parameters that decides."""
    total, alone = ca.SX(problem.array.radius**2), ca.SX(0)
    for n in of.axes:
        total, alone = total + (n.coupling * n.inverse) ** 2, alone + n.inverse
    return total / _yaw_information(of, problem) + alone


def _yaw_information(of: Normal, problem: Problem) -> ca.SX:
    """Return the information of a sample on the yaw, damped no more than the phases are."""
    return of.data_information + problem.damping * problem.array.radius**2
