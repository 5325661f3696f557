"""Two-axis Hall sensors in the plane as a measurement model of the estimator `synth.blocks.estimate.glsdc_estimator`.

    residuals   R(yaw) V_k - a B(phase_k),   phase_k = w (X, Y) + R(yaw) arm_k        of sensor k, arms in rad
    unknowns    w X, w Y in rad, the yaw, and the amplitude a where it is estimated; a is 1 otherwise
    field       B_X = c + alpha sin p + beta sin 5p, a polynomial in sin p; B_Y likewise

Source: Kawato, Kim, "A Novel Multi-DOF Precision Positioning Methodology Using Two-Axis Hall-Effect Sensors", (2),
section 3.B.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from math import hypot, pi, sqrt
from string import ascii_lowercase

import casadi as ca
import numpy as np

from designs.hall_position.glsdc import channels
from designs.hall_position.glsdc.parameters import Tuning
from models.hall_array import Pair
from models.hall_two_waves import PlanarArray, SpatialArray
from synth.block import Constant, Exprs
from synth.blocks.estimate import glsdc_jacobian, glsdc_solution
from synth.blocks.estimate.glsdc import NamedExpressions, Solution
from synth.blocks.estimate.glsdc_jacobian import Model, Prediction
from synth.blocks.estimate.glsdc_model import Measurement, Phase, RotatedMeasurement, Unknown
from synth.blocks.estimate.glsdc_solution import Iteration, Normal
from synth.law import call
from synth.signals import Signal

AXES = ("x", "y")
POSE = ("phase_x", "phase_y", "yaw")


@dataclass(frozen=True, eq=False)
class Problem:
    """The model about the sensors' centre with its `damping` in V^2, and how the cost is minimised."""

    array: PlanarArray
    tuning: Tuning
    model: Model
    iteration: Iteration
    damping: float


def problem(array: PlanarArray, tuning: Tuning) -> Problem:
    """Return the problem; the yaw and each phase move a sensor's phase by half of `tuning.max_phase_step` at most."""
    half = tuning.max_phase_step / 2
    turn, prior = array.yaw_within(half), array.deviation / (array.alpha * sqrt(tuning.damping))
    sizes = (prior, half), (prior, half), (prior / (array.radius * tuning.yaw_damping_ratio), turn)
    unknowns = [
        Unknown(Signal(name, "rad", -pi, pi), sigma, step, periodic=True, prior=sigma)
        for name, (sigma, step) in zip(POSE, sizes, strict=True)
    ]
    volts = channels.voltages(len(array.positions))
    model = glsdc_jacobian.model(
        in_body_axes(partial(field, len(array.positions), array.c), len(array.positions)),
        array.deviation**2 * np.eye(len(volts)),
        volts,
        (),
        unknowns,
        phases(array.arms, pi + half, half, turn),
        field_constants(array),
    )
    iteration = Iteration(
        tuning.iterations, descent_check=True, convergence=tuning.convergence_sigma, scale=tuning.scale
    )
    return Problem(array, tuning, model, iteration, tuning.damping * array.alpha**2)


def solve(of: Problem, u: Exprs, pose: Exprs, k: Exprs, named: NamedExpressions) -> tuple[Solution[Normal], Prediction]:
    """Return the solution of a sample from a predicted pose."""
    measured = [u[f"{s.name}_held"] for s in of.model.channels]
    constants = ca.vertcat(*(k[c.name] for c in field_constants(of.array)))
    values = [pose[n] for n in POSE]
    prediction = call("prediction", glsdc_jacobian.predict, of.model, values, measured, constants, named)
    sample = glsdc_solution.Problem(of.model, prediction, [ca.SX(0)] * len(POSE), None)
    return glsdc_solution.solve(sample, of.iteration), prediction


def field_constants(array: PlanarArray) -> list[Constant]:
    """Return the coefficients of B by powers of the sine as constants of a Block; c is none."""
    coefficients = {1: array.alpha + 5 * array.beta, 3: -20 * array.beta, 5: 16 * array.beta}
    texts = {1: "alpha + 5 beta: of sin p", 3: "-20 beta: of sin^3 p", 5: "16 beta: of sin^5 p"}
    about = "in the field alpha sin p + beta sin 5p"
    return [Constant(f"field_{n}", v, "V", f"{texts[n]} {about}") for n, v in coefficients.items()]


def phases(arms: Sequence[Pair], largest: float, step: float, turn: float) -> list[Phase]:
    """Return the phase of each sensor along each axis, of a body whose phases are up to `largest`, rad.

    In a sample these move by a `step`, and the body turns by `turn` rad at most.
    """
    each = []
    for letter, (x, y) in zip(ascii_lowercase, arms, strict=False):
        change = step + (abs(x) + abs(y)) * turn
        for axis, arm in (("x", (x, -y)), ("y", (y, x))):
            each.append(Phase(f"{letter}{axis}", _phase(axis, arm), largest + hypot(x, y), change))
    return each


def _phase(axis: str, arm: Pair) -> Callable[[Exprs, Exprs], ca.SX]:
    def phase(q: Exprs, k: Exprs) -> ca.SX:
        return q[f"phase_{axis}"] + arm[0] * q["cos_yaw"] + arm[1] * q["sin_yaw"]

    return phase


def position_numbers(array: PlanarArray | SpatialArray) -> list[Constant]:
    """Return the numbers of a position from its phase and its pitch that the C names."""
    return [
        Constant("pitch", array.pitch, "m", "of the magnet matrix"),
        Constant("length_per_phase", 1 / array.wave_number, "m/rad", "pitch / (2 pi)"),
    ]


def arm_numbers(arms: Sequence[Pair]) -> list[Constant]:
    """Return the arms of the sensors as numbers that the C names, rad of phase."""
    return [
        Constant(f"arm_{letter}_{axis}", arm, "rad", f"arm of sensor {letter} along {axis}, times 2 pi over the pitch")
        for letter, each in zip(ascii_lowercase, arms, strict=False)
        for axis, arm in zip(AXES, each, strict=True)
        if arm
    ]


def in_body_axes(of: Measurement, sensors: int) -> RotatedMeasurement:
    """Return the model of sensors in a field, by its voltages in fixed axes."""
    return RotatedMeasurement(of, "yaw", [(f"V_{letter}x", f"V_{letter}y") for letter in ascii_lowercase[:sensors]])


def field(sensors: int, c: float, q: Exprs, k: Exprs, amplitude: str = "") -> Exprs:
    """Return the voltages of the sensors, V, in the axes of the field; `amplitude` is the name of its unknown."""
    of = {}
    f1, f3, f5 = (k[f"field_{n}"] for n in (1, 3, 5))
    for letter in ascii_lowercase[:sensors]:
        for axis in AXES:
            p = q[f"sin_{letter}{axis}"]
            value = p * (f1 + p**2 * (f3 + p**2 * f5))
            of[f"V_{letter}{axis}"] = q[amplitude] * value if amplitude else c + value
    return of
