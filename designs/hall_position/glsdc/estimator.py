"""Position and yaw from the voltages of two or more two-axis Hall sensors: modified GLSDC with integrity monitoring.

    V_ax, V_ay, V_bx .. --->[ guard ]---> <name>_held ---> [ estimator ]---> X, Y, yaw, their deviations, flags
                               |------- complete -------------^

The damping is a prior on the predicted pose. At singular points two sensors do not determine the whole pose: there the
estimate follows the prediction in one direction and is flagged `damped`.

An estimate is `valid` if it has converged, is not damped, has no residual fault, and passes the innovation gate. All
voltages must be accepted; with more than two sensors, those of the sensors in use. Its position must be unambiguous,
and position lock must have been held since it was acquired. Pitches are counted from the one that `init` assumes. A
body that leaves the counted pitches or the yaw limit loses position lock, and nothing is valid until `init`. The
voltages do not change when the body turns by 90 degrees about a strong block: the yaw is known up to a quarter turn and
is tracked from the last one.

Deviations are those of a body at rest, deviation^2 (H'W H + damping)^-1, with the yaw damped as the phases are.

Source: Kawato, Kim, "A Novel Multi-DOF Precision Positioning Methodology Using Two-Axis Hall-Effect Sensors", section
3.B, Fig. 9.
"""

import casadi as ca
import numpy as np

from designs.hall_position.glsdc import channels, numbers, planar_model, tracking
from designs.hall_position.glsdc.parameters import Tuning
from designs.hall_position.glsdc.planar_model import Normal, Problem
from models import hall_planar
from models.hall_two_waves import PlanarArray
from synth.block import Block, Exprs, Step, build
from synth.blocks import glsdc, phasor
from synth.blocks.glsdc import NamedExpressions
from synth.blocks.phasor import Phasor
from synth.signals import Signal
from synth.timing import Discrete

REASON = "an estimator moves nothing: once latched it continues, and the fault word shows the latch"
MAX_DEVIATION = 1e4  # m: 1e-3 is never exceeded, but interval arithmetic loses the correlation of a quotient
DEFAULT_TUNING = Tuning()
# Relative, of polynomials: an error of 3e-7 in a sine is an error of 3 nm in the position.
SURROGATE_ERROR: dict[type[np.floating], float] = {np.float32: 3e-7, np.float64: 1e-15}
FLAGS = {
    "damped": "the voltages alone do not determine the pose: the prior decides a part of it",
    "valid": "converged, unambiguous, position lock held, not damped, no residual fault, innovation within its gate, "
    "inputs accepted",
    "lock_lost": "position lock lost, or pitches or yaw out of range: nothing is valid until init",
}


def guarded_estimator(
    array: PlanarArray, time: Discrete, tuning: Tuning = DEFAULT_TUNING, name: str = "hall_position"
) -> Block:
    """Return the estimator behind the guard of its voltages."""
    return channels.with_guard(name, time, len(array.positions), estimator(array, time, tuning), REASON)


def estimator(array: PlanarArray, time: Discrete, tuning: Tuning = DEFAULT_TUNING) -> Block:
    """Return the Block from held voltages, ``complete`` or, if redundant, ``fault_V_ax`` .. to X, Y and yaw."""
    problem, redundant = planar_model.problem(array, tuning), tracking.is_redundant(array)

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        named: NamedExpressions = []
        excluded, prediction = tracking.excluded_sensors(array, u, x), tracking.predict(x, problem)
        heading = phasor.by_range_reduction(prediction["yaw"], 2, "yaw_fraction", named)
        sensors = planar_model.sensors(u, prediction, k, heading, excluded, problem, named)
        solution = glsdc.descend(planar_model.trial_function(sensors, problem, named), problem.descent)
        normal, yaw = solution.last.normal, prediction["yaw"] + solution.at[2]
        integrity = tracking.check_integrity(problem, solution, yaw, _prior_weight(normal, problem), excluded, u, x)
        after = tracking.advance(solution, integrity, prediction, x, problem)
        lever = _lever(heading, after.yaw_change, array, named)
        known = ca.logic_and(after.ambiguity_resolved, ca.logic_not(x["lock_lost"]))
        accepted = after.inside if redundant else ca.logic_and(after.inside, u["complete"])
        freedom = channels.freedom(len(array.positions), 3, excluded)
        output = _position(after.pose, lever, array) | _deviations(normal, lever, problem)
        output |= {"residual": channels.residual(solution.last.squares, freedom), "converged": solution.converged}
        output |= {"damped": integrity.damped, "valid": ca.logic_and(integrity.good, ca.logic_and(known, accepted))}
        output |= {"lock_lost": x["lock_lost"]} | ({"excluded_sensor": x["excluded_sensor"]} if redundant else {})
        return Step(output, after.next, named, numbers=numbers.numbers(problem))

    return build(
        "estimator",
        time,
        law,
        inputs=channels.estimator_inputs(len(array.positions), redundant),
        outputs=_outputs(array, tuning),
        states=tracking.states(problem),
        constants=hall_planar.field_constants(array),
        tag="GLSDC, Fig. 9",
    )


def _outputs(array: PlanarArray, tuning: Tuning) -> list[Signal]:
    far = (tuning.pitches + 2) * array.pitch + sum(map(abs, array.centre))
    outputs = channels.outputs(("X", "Y", "yaw"), far, MAX_DEVIATION, FLAGS)
    return [*outputs, tracking.excluded_sensor_number(array)] if tracking.is_redundant(array) else outputs


def _lever(heading: Phasor, yaw: ca.SX, array: PlanarArray, named: NamedExpressions) -> Phasor:
    """Return the centre from the body's origin, m, at a heading that has changed by a yaw since the sample began."""
    x, y = array.centre
    if x == y == 0:
        return Phasor(ca.SX(0), ca.SX(0))
    return heading.times(hall_planar.rotation_phasor(yaw, named)[0]).times(Phasor(ca.SX(x), ca.SX(y)))


def _position(pose: Exprs, lever: Phasor, array: PlanarArray) -> dict[str, ca.SX]:
    """Return X and Y of the body's origin, m, and the yaw."""
    x, y = (pose[f"phase_{a}"] / array.wave_number + pose[f"pitch_{a}"] * array.pitch for a in planar_model.AXES)
    return {"X": x - lever.cosine, "Y": y - lever.sine, "yaw": pose["yaw"]}


def _deviations(normal: Normal, lever: Phasor, problem: Problem) -> dict[str, ca.SX]:
    """Return the standard deviations of X, Y in m and of the yaw, rad."""
    sigma, w = problem.array.deviation, problem.array.wave_number
    yaw = 1 / _yaw_information(normal, problem)
    slopes = lever.sine, -lever.cosine  # X = X_centre - lever_x, whose derivative is lever_y
    deviations = {"deviation_yaw": sigma * ca.sqrt(yaw)}
    for name, n, slope in zip("XY", normal.axes, slopes, strict=True):
        by_yaw = n.coupling * n.inverse - w * slope
        deviations[f"deviation_{name}"] = sigma / w * ca.sqrt(n.inverse + yaw * by_yaw**2)
    return deviations


def _prior_weight(normal: Normal, problem: Problem) -> ca.SX:
    """Return the trace of (N + damping)^-1, 1/V^2; times the damping, how many parameters the prior decides."""
    total, alone = ca.SX(problem.array.radius**2), ca.SX(0)
    for n in normal.axes:
        total, alone = total + (n.coupling * n.inverse) ** 2, alone + n.inverse
    return total / _yaw_information(normal, problem) + alone


def _yaw_information(normal: Normal, problem: Problem) -> ca.SX:
    """Return the information of a sample on the yaw, with the damping of the phases."""
    return normal.data_information + problem.damping * problem.array.radius**2
