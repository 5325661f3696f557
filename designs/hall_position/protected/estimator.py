"""Position and yaw from four two-axis Hall sensors, with the field's amplitude estimated and a faulty sensor excluded.

The model is `glsdc.planar`, of the body's origin; the amplitude has a prior about 1.
"""

from collections.abc import Sequence
from functools import partial
from math import pi
from string import ascii_lowercase

from designs.hall_position.glsdc import channels, planar
from designs.hall_position.protected import metres
from designs.hall_position.protected.parameters import Tuning
from models.hall_two_waves import PlanarArray, SpatialArray
from synth.block import Block
from synth.blocks.estimate import glsdc_estimator, glsdc_model, glsdc_search
from synth.blocks.estimate.glsdc_integrity import Integrity
from synth.blocks.estimate.glsdc_model import Implicit, Unknown
from synth.blocks.estimate.glsdc_search import Search
from synth.blocks.estimate.glsdc_solution import Iteration
from synth.blocks.guard import safety
from synth.composition import compose
from synth.signals import Signal, signal_names
from synth.timing import Discrete

DIRECT = (
    *("yaw", "amplitude", "deviation_yaw", "deviation_amplitude", "protection_yaw", "chi_square"),
    *("converged", "weak", "excluded", "doubted", "tracking", "lost", "valid"),
)


def guarded_estimator(name: str, array: PlanarArray, time: Discrete, tuning: Tuning) -> Block:
    """Return the estimator behind the guard and the screening of its voltages, with its position in m."""
    return with_guard(name, array, time, blocks(array, time, tuning))


def blocks(array: PlanarArray, time: Discrete, tuning: Tuning) -> list[Block]:
    """Return the Blocks from held voltages to the position in m."""
    return locate(array, time, tuning, phase_estimator(array, time, tuning).renamed({"valid": "phases_valid"}))


def locate(
    array: PlanarArray, time: Discrete, tuning: Tuning, phases: Block, between: Sequence[Block] = ()
) -> list[Block]:
    """Return screening, the Blocks `between` it and the estimator of phases, this, and the position in m."""
    screen = glsdc_search.screen(time, channels.voltages(len(array.positions)), groups(array), tuning.repeats)
    return [screen, *between, phases, metres.metres(array, time, tuning.pitches, phases)]


def with_guard(name: str, array: PlanarArray, time: Discrete, located: Sequence[Block]) -> Block:
    """Return the Blocks from held voltages to the position behind the guard of the voltages, as one Block."""
    volts = channels.voltages(len(array.positions))
    inputs = [safety.GuardedInput(s, 0.0, True) for s in volts]
    guard = safety.guard(time, inputs, channels.BAD_SAMPLES, safe_output_effect=glsdc_estimator.SAFE_OUTPUT_EFFECT)
    lengths = [s.name for block in located for s in block.outputs if s.unit == "m"]
    return compose(name, [guard, *located], inputs=signal_names(volts), outputs=[*lengths, *DIRECT])


def phase_estimator(array: PlanarArray, time: Discrete, tuning: Tuning) -> Block:
    """Return the estimator of w X, w Y, the yaw and the amplitude."""
    volts = channels.voltages(len(array.positions))
    count, w = len(volts), array.wave_number
    arms = [(w * x, w * y) for x, y in array.positions]
    field = partial(planar.field, len(array.positions), 0.0, amplitude="amplitude")
    return glsdc_estimator.estimator(
        "estimator",
        time,
        Implicit(planar.in_body_axes(field, len(array.positions)).residual),
        glsdc_model.covariance([array.deviation] * count, [tuning.model_error] * count),
        channels=volts,
        unknowns=_unknowns(tuning),
        phases=planar.phases(arms, pi, tuning.phase_step, tuning.yaw_step),
        constants=planar.field_constants(array),
        iteration=Iteration(tuning.corrections, held_jacobian=True),
        integrity=integrity(array, tuning),
        search=search(tuning),
        numbers=planar.arm_numbers(arms),
    )


def groups(array: PlanarArray | SpatialArray) -> list[list[str]]:
    """Return the names of the voltages by sensor: they fail together."""
    return [[f"V_{letter}x", f"V_{letter}y"] for letter in ascii_lowercase[: len(array.positions)]]


def integrity(array: PlanarArray, tuning: Tuning) -> Integrity:
    """Return the limits of the protection levels, in rad."""
    along = array.wave_number * tuning.position_limit
    limits = {"phase_x": along, "phase_y": along, "yaw": tuning.yaw_limit}
    return Integrity(
        limits,
        tuning.false_alarm,
        tuning.risk,
        exclude=True,
        groups=groups(array),
        screened=True,
        excluded_limits=tuning.excluded_limits,
        overbound=tuning.overbound,
    )


def search(tuning: Tuning) -> Search:
    """Return the search over the pitch and the yaws."""
    agreement = {"phase_x": tuning.agreement, "phase_y": tuning.agreement, "yaw": tuning.yaw_agreement}
    return Search(tuning.starts, agreement, tuning.patience, tuning.dwell, tuning.all_sensors)


def phase_unknowns(largest: float, step: float, velocity_gain: float) -> list[Unknown]:
    """Return w X and w Y within a turn, by largest deviation, largest correction and gain of the predicted motion."""
    return [
        Unknown(Signal(f"phase_{a}", "rad", -pi, pi), largest, step, periodic=True, velocity_gain=velocity_gain)
        for a in "xy"
    ]


def _unknowns(tuning: Tuning) -> list[Unknown]:
    phases = phase_unknowns(tuning.largest_phase, tuning.phase_step, tuning.velocity_gain)
    turn, spread = tuning.yaw_range, tuning.amplitude_range
    yaw = Unknown(
        Signal("yaw", "rad", -turn, turn),
        tuning.largest_yaw,
        tuning.yaw_step,
        angle=True,
        velocity_gain=tuning.velocity_gain,
    )
    amplitude = Signal("amplitude", "1", 1 - spread, 1 + spread, "field over that of the model")
    size = Unknown(amplitude, tuning.largest_amplitude, spread / 2, 1.0, prior=tuning.amplitude_prior, prior_value=1.0)
    return [*phases, yaw, size]
