"""Pose in six degrees of freedom from four or more two-axis Hall sensors, with protection levels.

    V_k = [u v]' B(P_k),   P_k = (X, Y, Z) + R r_k,   R = R_z(yaw) R_y(pitch) R_x(roll) = [u v t]
    B_x = sum over n of a_n exp(-n (w (Z - Z_0) + o_z)) sin(n (w X + o_x)),   o = w R r_k,   n = 1, 5
    B_y likewise, B_z with the cosines of both

With a fifth sensor one that fails is excluded. The body is level at the height Z_0 within the ranges of `Tuning`, and
rests while it is searched. A body that is turned by a quarter shows the same voltages: its yaw is within the declared
range at init.

Source: Kawato, Kim, "A Novel Multi-DOF Precision Positioning Methodology Using Two-Axis Hall-Effect Sensors", section
3, Fig. 6 (b) and Fig. 9.
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import hypot, inf, pi, radians
from string import ascii_lowercase

import casadi as ca

from designs.hall_position.glsdc import channels
from designs.hall_position.protected import estimator as estimators
from designs.hall_position.protected import metres
from models.hall_two_waves import SpatialArray
from synth import numeric
from synth.block import Block, Constant, Exprs
from synth.blocks.estimate import glsdc_estimator, glsdc_model, glsdc_search
from synth.blocks.estimate.glsdc_integrity import Integrity
from synth.blocks.estimate.glsdc_model import Phase, Unknown
from synth.blocks.estimate.glsdc_search import Search
from synth.blocks.estimate.glsdc_solution import Iteration
from synth.blocks.guard import safety
from synth.composition import compose
from synth.errors import ModelError
from synth.numeric import between
from synth.signals import Signal, signal_names
from synth.timing import Discrete

MIN_SENSORS = 4  # one more is redundant
ANGLES = ("roll", "pitch", "yaw")
OUTPUTS = ("X", "Y", "Z", *ANGLES)


@dataclass(frozen=True)
class Tuning:
    """Tuning; lengths in m, angles and phases in rad.

    Raises ModelError for a value out of its range.
    """

    model_error: float = between(0, 1e-3, inf)  # V rms of a voltage
    corrections: int = between(1, 4, 20)  # a sample, all with the Jacobian at the prediction
    phase_step: float = between(0, 0.5, 1)  # largest correction in a sample
    turn_step: float = between(0, 0.05, 1)
    velocity_gain: float = between(0, 0.5, 1)
    gap: float = between(0, 1e-3, 0.002)  # to either side of the height
    tilt: float = between(0, 0.02, 0.05)  # to either side
    yaw: float = between(0, radians(12), 1)  # to either side
    largest_phase: float = between(0, 0.02, 3)  # standard deviations that are resolved
    largest_height: float = between(0, 1e-4, 1)
    largest_turn: float = between(0, 3e-3, 1)
    position_limit: float = between(0, 5e-4, inf)  # of the protection levels
    starts: int = between(1, 24, 1000)
    dwell: int = between(1, 5, 1000)
    patience: int = between(1, 8, 1000)
    repeats: int = between(1, 6, 1000)
    pitches: int = between(1, 8, 1000)

    def __post_init__(self) -> None:
        numeric.check_fields(self)


DEFAULT_TUNING = Tuning()


def guarded_estimator(
    array: SpatialArray, time: Discrete, tuning: Tuning = DEFAULT_TUNING, name: str = "hall_pose"
) -> Block:
    """Return the estimator behind the guard of its voltages, with X, Y and Z in m.

    Raises ModelError for fewer than four places.
    """
    places = len(set(array.positions))
    if places < MIN_SENSORS:
        raise ModelError(
            f"{places} sensors lose rank on curves in the pitch, and no redundant voltage is left to detect a false "
            f"one: give {MIN_SENSORS} or more, each at a place of its own"
        )
    volts = channels.voltages(len(array.positions))
    phases = estimator(array, time, tuning).renamed({"valid": "phases_valid"})
    located = metres.metres(array, time, tuning.pitches, phases)
    guard = safety.guard(time, [safety.GuardedInput(s, 0.0, True) for s in volts], channels.BAD_SAMPLES)
    screen = [glsdc_search.screen(time, volts, estimators.groups(array), tuning.repeats)] if is_redundant(array) else []
    direct = [s.name for s in phases.outputs if "phase" not in s.name]
    outputs = [*(s.name for s in located.outputs), *direct]
    return compose(name, [guard, *screen, phases, located], inputs=signal_names(volts), outputs=outputs)


def is_redundant(array: SpatialArray) -> bool:
    """Return whether one sensor can be excluded."""
    return len(array.positions) > MIN_SENSORS


def estimator(array: SpatialArray, time: Discrete, tuning: Tuning = DEFAULT_TUNING) -> Block:
    """Return the estimator of the phases w X and w Y, of Z and of the three angles."""
    volts = channels.voltages(len(array.positions))
    along = array.wave_number * tuning.position_limit
    limits, groups = {"phase_x": along, "phase_y": along}, estimators.groups(array)
    redundant = Integrity(limits, exclude=True, groups=groups, screened=True)
    return glsdc_estimator.estimator(
        "estimator",
        time,
        measurement(array),
        glsdc_model.covariance([array.deviation] * len(volts), [tuning.model_error] * len(volts)),
        channels=volts,
        unknowns=_unknowns(array, tuning),
        phases=_phases(array, tuning),
        constants=[Constant("alpha", array.alpha, "V", "fundamental"), Constant("beta", array.beta, "V", "5th wave")],
        iteration=Iteration(tuning.corrections, held_jacobian=True),
        integrity=redundant if is_redundant(array) else Integrity(limits),
        search=Search(tuning.starts, {"phase_x": 0.15, "phase_y": 0.15, "yaw": 0.02}, tuning.patience, tuning.dwell),
        tag="GLSDC, Fig. 9",
    )


def measurement(array: SpatialArray) -> Callable[[Exprs, Exprs], Exprs]:
    """Return the voltages by unknowns and phases."""
    arms = dict(zip(_letters(array), array.arms, strict=True))

    def voltages(q: Exprs, k: Exprs) -> Exprs:
        u, v, _ = axes = _body_axes(q)
        of: dict[str, ca.SX] = {}
        for letter, arm in arms.items():
            lift = array.wave_number * (q["Z"] - array.height) + _offset(arm, axes, 2)
            decay = ca.exp(-lift)
            (x, up_x), (y, up_y) = (_wave(q, f"{letter}{axis}", decay, k) for axis in "xy")
            for axis, e in zip("xy", (u, v), strict=True):
                of[f"V_{letter}{axis}"] = e[0] * x + e[1] * y + e[2] * (up_x + up_y)
        return of

    return voltages


def _wave(q: Exprs, name: str, decay: ca.SX, k: Exprs) -> tuple[ca.SX, ca.SX]:
    """Return the waves along an axis with the sine and with the cosine, V: Chebyshev's polynomials of either."""
    s, c, d = decay * q[f"sin_{name}"], decay * q[f"cos_{name}"], decay**2
    fifth = [v * (5 * d**2 + v**2 * (16 * v**2 - 20 * d)) for v in (s, c)]
    return k["alpha"] * s + k["beta"] * fifth[0], k["alpha"] * c + k["beta"] * fifth[1]


def _body_axes(q: Exprs) -> tuple[list[ca.SX], list[ca.SX], list[ca.SX]]:
    """Return the columns of R."""
    (a, s), (b, t), (c, u) = ((q[f"cos_{n}"], q[f"sin_{n}"]) for n in ANGLES)
    return (
        [c * b, u * b, -t],
        [c * t * s - u * a, u * t * s + c * a, b * s],
        [c * t * a + u * s, u * t * a - c * s, b * a],
    )


def _offset(arm: tuple[float, ...], axes: tuple[list[ca.SX], ...], i: int) -> ca.SX:
    return sum((r * e[i] for r, e in zip(arm, axes, strict=True) if r), ca.SX(0))


def _phases(array: SpatialArray, tuning: Tuning) -> list[Phase]:
    phases = []
    for letter, arm in zip(_letters(array), array.arms, strict=True):
        reach = hypot(*arm)
        change = tuning.phase_step + 3 * reach * tuning.turn_step
        for i, axis in enumerate("xy"):
            phases.append(Phase(f"{letter}{axis}", _angle(axis, arm, i), pi + reach, change))
    return phases


def _angle(axis: str, arm: tuple[float, ...], i: int) -> Callable[[Exprs, Exprs], ca.SX]:
    return lambda q, k: q[f"phase_{axis}"] + _offset(arm, _body_axes(q), i)


def _unknowns(array: SpatialArray, tuning: Tuning) -> list[Unknown]:
    def angle(name: str, size: float) -> Unknown:
        step = min(tuning.turn_step, size / 2)
        signal = Signal(name, "rad", -size, size)
        return Unknown(signal, tuning.largest_turn, step, angle=True, velocity_gain=tuning.velocity_gain)

    phases = estimators.phase_unknowns(tuning.largest_phase, tuning.phase_step, tuning.velocity_gain)
    low, high = array.height - tuning.gap, array.height + tuning.gap
    height = Unknown(
        Signal("Z", "m", low, high, "height of the body's origin above the magnet matrix"),
        tuning.largest_height,
        tuning.gap / 2,
        array.height,
        velocity_gain=tuning.velocity_gain,
    )
    turns = [angle(name, size) for name, size in zip(ANGLES, (tuning.tilt, tuning.tilt, tuning.yaw), strict=True)]
    return [*phases, height, *turns]


def _letters(array: SpatialArray) -> str:
    return ascii_lowercase[: len(array.positions)]
