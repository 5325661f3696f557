"""Hall position as an instance of the least-squares estimator of any model: X and Y within their pitch, and the yaw.

    residuals   R(yaw) V_k - B(phase_k),   phase_k = w (X, Y) + w R(yaw) r_k          of sensor k at r_k in the body
    unknowns    w X, w Y, in rad, and the yaw, each with a prior about its prediction

It stands beside `glsdc.estimator`, which has the same model, corrections and priors, written out for this problem, and
a tracker. X and Y are those of the body's origin, not counted over pitches. Nothing searches, excludes or resolves
ambiguities here: the first sample must begin near the body.
"""

from collections.abc import Callable
from functools import partial
from math import hypot, inf, pi, sqrt
from string import ascii_lowercase

import casadi as ca

from designs.hall_position.glsdc import channels
from designs.hall_position.glsdc.parameters import Tuning
from models import hall_planar
from models.hall_two_waves import PlanarArray
from synth.block import Block, Exprs, Step, build
from synth.blocks import glsdc_estimator, safety
from synth.blocks.glsdc_integrity import Integrity
from synth.blocks.glsdc_model import Implicit, Phase, Unknown
from synth.blocks.glsdc_solution import Iteration
from synth.composition import compose
from synth.signals import Signal, signal_names
from synth.timing import Discrete

USUAL, USUAL_ITERATION = Tuning(), Iteration(5, descent_check=True)
ROUNDING = 1e-6  # relative, of a range in single precision
AXES = {"x": "X", "y": "Y"}
DIRECT = ("yaw", "deviation_yaw", "chi_square", "converged", "weak", "valid")


def guarded_estimator(
    array: PlanarArray,
    time: Discrete,
    tuning: Tuning = USUAL,
    iteration: Iteration = USUAL_ITERATION,
    integrity: Integrity | None = None,
) -> Block:
    """Return the estimator of an array behind the guard of its voltages.

    `integrity` limits ``phase_x``, ``phase_y`` and ``yaw``, rad. There are then no priors, which would carry a fault
    from sample to sample; three sensors are needed.
    """
    volts = channels.voltages(len(array.positions))
    guard = safety.guard(
        time,
        [safety.GuardedInput(s, 0.0, True) for s in volts],
        channels.BAD_SAMPLES,
        reason=glsdc_estimator.REASON,
    )
    phases = phase_estimator(array, time, tuning, iteration, integrity)
    metres = _in_metres(array, time, phases)
    levels = [s.name for s in phases.outputs if s.name.startswith("protection")]
    outputs = [*signal_names(metres.outputs), *DIRECT, *levels]
    return compose("hall_generic", [guard, phases, metres], inputs=signal_names(volts), outputs=outputs)


def phase_estimator(
    array: PlanarArray, time: Discrete, tuning: Tuning, iteration: Iteration, integrity: Integrity | None = None
) -> Block:
    """Return the estimator of w X, w Y and the yaw."""
    prior = array.deviation / (array.alpha * sqrt(tuning.damping))  # rad of phase
    half, gain = tuning.max_phase_step / 2, tuning.velocity_gain
    turn, firmer = array.yaw_within(half), tuning.yaw_damping_ratio
    sizes = {"phase_x": (prior, half, gain), "phase_y": (prior, half, gain)}
    sizes |= {"yaw": (prior / (array.radius * firmer), turn, gain / firmer)}
    unknowns = [
        Unknown(
            Signal(name, "rad", -pi, pi),
            sigma,
            step,
            periodic=True,
            prior=inf if integrity else sigma,
            velocity_gain=velocity_gain,
        )
        for name, (sigma, step, velocity_gain) in sizes.items()
    ]
    volts = channels.voltages(len(array.positions))
    variances = array.deviation**2 * ca.DM.eye(len(volts)).full()
    return glsdc_estimator.estimator(
        "estimator",
        time,
        Implicit(partial(_residuals, array)),
        variances,
        channels=volts,
        unknowns=unknowns,
        phases=_phases(array, half, turn),
        constants=[c for c in hall_planar.field_constants(array) if c.name.startswith("field")],
        iteration=iteration,
        integrity=integrity,
    )


def _phases(array: PlanarArray, half: float, turn: float) -> list[Phase]:
    """Return the phase of each sensor along each axis."""
    phases = []
    for letter, place in zip(ascii_lowercase, array.positions, strict=False):
        rx, ry = (array.wave_number * v for v in place)
        reach = hypot(rx, ry)
        for axis, arm in (("x", (rx, -ry)), ("y", (ry, rx))):
            change = half + reach * (turn + turn**2 / 2)
            phases.append(Phase(f"{letter}{axis}", _phase(axis, arm), pi + reach, change))
    return phases


def _phase(axis: str, arm: tuple[float, float]) -> Callable[[Exprs, Exprs], ca.SX]:
    def phase(q: Exprs, k: Exprs) -> ca.SX:
        return q[f"phase_{axis}"] + arm[0] * q["cos_yaw"] + arm[1] * q["sin_yaw"]

    return phase


def _residuals(array: PlanarArray, q: Exprs, y: Exprs, k: Exprs) -> Exprs:
    """Return R(yaw) V - B of each sensor, V, in the axes of the field."""
    residuals = {}
    for letter in ascii_lowercase[: len(array.positions)]:
        vx, vy = y[f"V_{letter}x"], y[f"V_{letter}y"]
        volts = {"x": q["cos_yaw"] * vx - q["sin_yaw"] * vy, "y": q["sin_yaw"] * vx + q["cos_yaw"] * vy}
        for axis, v in volts.items():
            s = q[f"sin_{letter}{axis}"]
            field = array.c + s * (k["field_1"] + s**2 * (k["field_3"] + s**2 * k["field_5"]))
            residuals[f"V_{letter}{axis}"] = v - field
    return residuals


def _in_metres(array: PlanarArray, time: Discrete, phases: Block) -> Block:
    """Return the Block from phases and their deviations to X and Y in m."""
    by_name = {s.name: s for s in phases.outputs}
    rounded = (1 - ROUNDING) * array.wave_number
    inputs = [by_name[f"{prefix}phase_{a}"] for prefix in ("", "deviation_") for a in AXES]
    outputs = [
        Signal(s.name.replace(f"phase_{a}", AXES[a]), "m", s.low / rounded, s.high / rounded)
        for s, a in zip(inputs, (*AXES, *AXES), strict=True)
    ]

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        return Step({o.name: u[s.name] / array.wave_number for o, s in zip(outputs, inputs, strict=True)})

    return build("metres", time, law, inputs=inputs, outputs=outputs, tag="phase over wave number")
