"""Position and yaw from four two-axis Hall sensors, with the field's amplitude estimated and a faulty sensor excluded.

residuals   R(yaw) V_k - a B(phase_k),   phase_k = w (X, Y) + w R(yaw) r_k        of sensor k at r_k in the body
unknowns    w X, w Y in rad, the yaw, and the amplitude a with a prior about 1
"""

from collections.abc import Callable, Sequence
from functools import partial
from math import hypot, pi
from string import ascii_lowercase

import casadi as ca

from designs.hall_position.four import metres
from designs.hall_position.four.parameters import Tuning
from designs.hall_position.glsdc import channels
from models import hall_planar
from models.hall_two_waves import PlanarArray
from synth.block import Block, Exprs
from synth.blocks import glsdc_estimator, glsdc_model, safety, screening
from synth.blocks.glsdc_integrity import Integrity
from synth.blocks.glsdc_model import Implicit, Phase, Unknown
from synth.blocks.glsdc_search import Search
from synth.blocks.glsdc_solution import Iteration
from synth.composition import compose
from synth.signals import Signal, signal_names
from synth.timing import Discrete

DIRECT = (
    *("yaw", "amplitude", "deviation_yaw", "deviation_amplitude", "protection_yaw", "chi_square"),
    *("converged", "weak", "excluded", "tracking", "lost", "valid"),
)


def guarded_estimator(name: str, array: PlanarArray, time: Discrete, tuning: Tuning) -> Block:
    """Return the estimator behind the guard and the screening of its voltages, with its position in m."""
    phases = phase_estimator(array, time, tuning).renamed({"valid": "phases_valid"})
    return guard_and_locate(name, array, time, tuning, phases)


def guard_and_locate(
    name: str, array: PlanarArray, time: Discrete, tuning: Tuning, phases: Block, between: Sequence[Block] = ()
) -> Block:
    """Return guard, screening, the Blocks `between` them and the estimator, and the position in m as one Block."""
    volts = channels.voltages(len(array.positions))
    inputs = [safety.GuardedInput(s, 0.0, True) for s in volts]
    guard = safety.guard(time, inputs, channels.BAD_SAMPLES, reason=glsdc_estimator.REASON)
    screen = screening.screen(time, volts, groups(array), tuning.repeats)
    position = metres.metres(array, time, tuning.pitches, phases)
    blocks = [guard, screen, *between, phases, position]
    lengths = [s.name for s in position.outputs if s.unit == "m"]
    return compose(name, blocks, inputs=signal_names(volts), outputs=[*lengths, *DIRECT])


def phase_estimator(array: PlanarArray, time: Discrete, tuning: Tuning) -> Block:
    """Return the estimator of w X, w Y, the yaw and the amplitude."""
    volts = channels.voltages(len(array.positions))
    count = len(volts)
    return glsdc_estimator.estimator(
        "estimator",
        time,
        Implicit(partial(_residuals, array)),
        glsdc_model.covariance([array.deviation] * count, [tuning.model_error] * count),
        channels=volts,
        unknowns=_unknowns(tuning),
        phases=_phases(array, tuning),
        constants=[c for c in hall_planar.field_constants(array) if c.name.startswith("field")],
        iteration=Iteration(tuning.corrections, held_jacobian=True),
        integrity=integrity(array, tuning),
        search=search(tuning),
    )


def groups(array: PlanarArray) -> list[list[str]]:
    """Return the names of the voltages by sensor: they fail together."""
    return [[f"V_{letter}x", f"V_{letter}y"] for letter in ascii_lowercase[: len(array.positions)]]


def integrity(array: PlanarArray, tuning: Tuning) -> Integrity:
    """Return the limits of the protection levels, in rad."""
    along = array.wave_number * tuning.position_limit
    limits = {"phase_x": along, "phase_y": along, "yaw": tuning.yaw_limit}
    return Integrity(limits, tuning.false_alarm, tuning.risk, exclude=True, groups=groups(array), screened=True)


def search(tuning: Tuning) -> Search:
    """Return the search over the pitch and the yaws."""
    along, turn = tuning.agreement, tuning.yaw_agreement
    return Search(tuning.starts, {"phase_x": along, "phase_y": along, "yaw": turn}, tuning.patience, tuning.dwell)


def _unknowns(tuning: Tuning) -> list[Unknown]:
    phases = [
        Unknown(
            Signal(f"phase_{a}", "rad", -pi, pi),
            tuning.largest_phase,
            tuning.phase_step,
            periodic=True,
            velocity_gain=tuning.velocity_gain,
        )
        for a in "xy"
    ]
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


def _phases(array: PlanarArray, tuning: Tuning) -> list[Phase]:
    """Return the phase of each sensor along each axis."""
    phases = []
    for letter, place in zip(ascii_lowercase, array.positions, strict=False):
        rx, ry = (array.wave_number * v for v in place)
        reach = hypot(rx, ry)
        for axis, arm in (("x", (rx, -ry)), ("y", (ry, rx))):
            change = tuning.phase_step + (abs(rx) + abs(ry)) * tuning.yaw_step
            phases.append(Phase(f"{letter}{axis}", _phase(axis, arm), pi + reach, change))
    return phases


def _phase(axis: str, arm: tuple[float, float]) -> Callable[[Exprs, Exprs], ca.SX]:
    def phase(q: Exprs, k: Exprs) -> ca.SX:
        return q[f"phase_{axis}"] + arm[0] * q["cos_yaw"] + arm[1] * q["sin_yaw"]

    return phase


def _residuals(array: PlanarArray, q: Exprs, y: Exprs, k: Exprs) -> Exprs:
    """Return R(yaw) V - a B of each sensor, V, in the axes of the field."""
    residuals, c, s = {}, q["cos_yaw"], q["sin_yaw"]
    for letter in ascii_lowercase[: len(array.positions)]:
        vx, vy = y[f"V_{letter}x"], y[f"V_{letter}y"]
        for axis, v in (("x", c * vx - s * vy), ("y", c * vy + s * vx)):
            p = q[f"sin_{letter}{axis}"]
            field = p * (k["field_1"] + p**2 * (k["field_3"] + p**2 * k["field_5"]))
            residuals[f"V_{letter}{axis}"] = v - q["amplitude"] * field
    return residuals
