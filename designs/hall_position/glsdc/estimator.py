"""Position and yaw from the voltages of two or more two-axis Hall sensors: modified GLSDC with integrity monitoring.

    V_ax, V_ay, V_bx .. --->[ guard ]---> <name>_held ---> [ estimator ]---> X, Y, yaw, their deviations, flags
                               |------- complete -------------^

The damping is a prior on the predicted pose. At singular points two sensors do not determine the whole pose: there the
estimate follows the prediction in one direction and is flagged `damped`.

An estimate is `valid` if it has converged, is not damped, has no residual fault, and passes the innovation gate. All
voltages must be accepted. Its position must be unambiguous, and position lock must have been held since it was
acquired. Pitches are counted from the one that `init` assumes. A
body that leaves the counted pitches or the yaw limit loses position lock, and nothing is valid until `init`. The
voltages do not change when the body turns by 90 degrees about a strong block: the yaw is known up to a quarter turn and
is tracked from the last one.

Deviations are those of a body at rest, deviation^2 (H'W H + damping)^-1, with the yaw damped as the phases are.

Source: Kawato, Kim, "A Novel Multi-DOF Precision Positioning Methodology Using Two-Axis Hall-Effect Sensors", section
3.B, Fig. 9.
"""

from dataclasses import replace
from math import pi

import casadi as ca
import numpy as np

from designs.hall_position.glsdc import channels, planar, tracking
from designs.hall_position.glsdc.parameters import Tuning
from designs.hall_position.glsdc.planar import Problem
from models.hall_two_waves import PlanarArray
from synth.block import Block, Constant, Exprs, Step, build
from synth.blocks.estimate import glsdc_estimator, phasor
from synth.blocks.estimate.glsdc import NamedExpressions
from synth.blocks.estimate.glsdc_solution import Normal
from synth.blocks.estimate.phasor import Phasor
from synth.law import call, label
from synth.signals import Signal
from synth.timing import Discrete

MAX_DEVIATION = 1e4  # m: 1e-3 is never exceeded, but interval arithmetic loses the correlation of a quotient
DEFAULT_TUNING = Tuning()
# Relative, of polynomials: 2e-7 in a sine is 2 nm in the position, which a step of a search may magnify a hundredfold.
SURROGATE_ERROR: dict[type[np.floating], float] = {np.float32: 1.8e-7, np.float64: 1e-15}
FLAGS = {
    "converged": "the last correction is small, and no correction raised the cost",
    "damped": "the voltages alone do not determine the pose: the prior decides a part of it",
    "valid": "converged, unambiguous, position lock held, not damped, no residual fault, innovation within its gate, "
    "inputs accepted",
    "lock_lost": "position lock lost, or pitches or yaw out of range: nothing is valid until init",
}


def guarded_estimator(
    array: PlanarArray, time: Discrete, tuning: Tuning = DEFAULT_TUNING, name: str = "hall_position"
) -> Block:
    """Return the estimator behind the guard of its voltages."""
    volts = channels.voltages(len(array.positions))
    return glsdc_estimator.guarded(estimator(array, time, tuning), name, volts, channels.BAD_SAMPLES)


def estimator(array: PlanarArray, time: Discrete, tuning: Tuning = DEFAULT_TUNING) -> Block:
    """Return the Block from held voltages and ``complete`` to X, Y and yaw."""
    problem = planar.problem(array, tuning)
    numbers = [
        *glsdc_estimator.of_solution(problem.model, problem.iteration),
        *planar.arm_numbers(array.arms),
        *tracking.numbers(problem),
        *_numbers(problem),
    ]

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        named: NamedExpressions = []
        prediction = tracking.predict(x, problem)
        solution, predicted = planar.solve(problem, u, prediction, k, named)
        normal, yaw = solution.last.normal, prediction["yaw"] + solution.at[2]
        yaw_variance = _yaw_variance(normal, problem)
        weight = _prior_weight(normal, yaw_variance, problem)
        integrity = call("integrity", tracking.check_integrity, problem, solution, yaw, weight, u, x)
        after = call("track", tracking.advance, solution, integrity, prediction, x, problem)
        lever = _lever(predicted.turns[-1], after.yaw_change, array)
        known = ca.logic_and(after.ambiguity_resolved, ca.logic_not(x["lock_lost"]))
        accepted = ca.logic_and(after.inside, u["complete"])
        freedom = channels.freedom(len(array.positions), 3)
        output = _position(after.pose, lever, array) | _deviations(normal, yaw_variance, lever, problem)
        output |= {"residual": channels.residual(solution.last.squares, freedom), "converged": solution.converged}
        output |= {"damped": integrity.damped, "valid": ca.logic_and(integrity.good, ca.logic_and(known, accepted))}
        output |= {"lock_lost": x["lock_lost"]}
        label(
            prediction=prediction, yaw_variance=yaw_variance, yaw=yaw, integrity=integrity, weight=weight,
            accepted=accepted,
        )  # fmt: skip
        return Step(output, after.next, named, predicted.certified, numbers)

    return build(
        "estimator",
        time,
        law,
        inputs=[*(replace(s, name=f"{s.name}_held") for s in problem.model.channels), glsdc_estimator.COMPLETE],
        outputs=_outputs(array, tuning),
        states=tracking.states(problem),
        constants=planar.field_constants(array),
        tag="GLSDC, Fig. 9",
    )


def _numbers(of: Problem) -> list[Constant]:
    """Return the numbers of the position, its deviations and the prior that the C names."""
    array, r = of.array, of.tuning.yaw_damping_ratio
    least, w = of.damping * array.radius**2, array.wave_number
    return [
        *planar.position_numbers(array),
        Constant("sigma_per_wave_number", array.deviation / w, "V m/rad", "deviation of a voltage, pitch / (2 pi)"),
        Constant("squared_radius", array.radius**2, "rad^2", "of the arms of the sensors, sum of squares"),
        Constant("yaw_damping", (1 - r**2) * least, "V^2/rad^2", f"(1 - r^2) times that of the phases, r = {r:g}"),
        Constant("root_regularisation", channels.ROOT_REGULARISATION, "V^2", "keeps the argument of a root positive"),
    ]


def _outputs(array: PlanarArray, tuning: Tuning) -> list[Signal]:
    far = (tuning.pitches + 2) * array.pitch + sum(map(abs, array.centre))
    pose = [Signal(a, "m", -far, far, f"position of the body's origin along {a} of the magnet matrix") for a in "XY"]
    pose.append(Signal("yaw", "rad", -pi, pi, "yaw of the body relative to the magnet matrix"))
    return [
        *pose,
        *(_deviation(s) for s in pose),
        Signal("residual", "V", 0, 1e3, "rms of the voltage residuals, by degrees of freedom"),
        *(Signal(name, "1", 0, 1, about) for name, about in FLAGS.items()),
    ]


def _deviation(of: Signal) -> Signal:
    about = f"standard deviation of {of.name} from the voltages' noise"
    return Signal(f"deviation_{of.name}", of.unit, 0, MAX_DEVIATION if of.unit == "m" else 1, about)


def _lever(heading: Phasor, yaw: ca.SX, array: PlanarArray) -> Phasor:
    """Return the centre from the body's origin, m, at a heading that has changed by a yaw since the sample began."""
    x, y = array.centre
    if x == y == 0:
        return Phasor(ca.SX(0), ca.SX(0))
    label(heading=heading, yaw=yaw)
    return heading.times(phasor.of(yaw)).times(Phasor(ca.SX(x), ca.SX(y)))


def _position(pose: Exprs, lever: Phasor, array: PlanarArray) -> dict[str, ca.SX]:
    """Return X and Y of the body's origin, m, and the yaw."""
    x, y = (pose[f"phase_{a}"] / array.wave_number + pose[f"pitch_{a}"] * array.pitch for a in planar.AXES)
    label(pose=pose, x=x, y=y)
    return {"X": x - lever.cosine, "Y": y - lever.sine, "yaw": pose["yaw"]}


def _yaw_variance(normal: Normal, problem: Problem) -> ca.SX:
    """Return the variance of the yaw over deviation^2, with the yaw damped as the phases are.

    Its information, given the phases, is the last pivot, in which its prior is that of `yaw_damping_ratio`.
    """
    least = problem.damping * problem.array.radius**2
    pivot = 1 / normal.factors.inverse[2]
    label(pivot=pivot)
    return 1 / ca.fmax(pivot + (1 - problem.tuning.yaw_damping_ratio**2) * least, least)


def _deviations(normal: Normal, yaw: ca.SX, lever: Phasor, problem: Problem) -> dict[str, ca.SX]:
    """Return the standard deviations of X, Y in m and of the yaw, rad, from the variance of the yaw."""
    sigma, w, factors = problem.array.deviation, problem.array.wave_number, normal.factors
    slopes = lever.sine, -lever.cosine  # X = X_centre - lever_x, whose derivative is lever_y
    deviations = {"deviation_yaw": sigma * ca.sqrt(yaw)}
    for i, (name, slope) in enumerate(zip("XY", slopes, strict=True)):
        by_yaw = factors.lower[2][i] - w * slope
        deviations[f"deviation_{name}"] = sigma / w * ca.sqrt(factors.inverse[i] + yaw * by_yaw**2)
        label(name, by_yaw=by_yaw)
    return deviations


def _prior_weight(normal: Normal, yaw: ca.SX, problem: Problem) -> ca.SX:
    """Return the trace of the covariance over deviation^2; times the damping, how many parameters the prior decides."""
    x, y = normal.factors.lower[2]
    return yaw * (problem.array.radius**2 + x**2 + y**2) + normal.factors.inverse[0] + normal.factors.inverse[1]
