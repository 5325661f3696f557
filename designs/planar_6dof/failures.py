"""Hall channel failures (stuck, zero, NaN), at rest and in motion: detection, isolation, and the consequences.

Each of the six channels fails alone, FAILURE seconds after the start, with noise: the `SensorFaults` of the declared
experiments. Those from START report each channel, those over PLACES report counts. A law can know of a failure from the
first sample on with a residual out of bounds. A platen that a failure carries away may tilt until the lasers are out of
range, and then latches.
"""

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from designs.planar_6dof import vertical
from designs.planar_6dof.loop import Array, measured_positions
from designs.planar_6dof.sensing import calibration, contradictions
from designs.planar_6dof.sensing import sections as sensing
from models import planar_stage
from synth.declare.experiments import Course, SensorFaults
from synth.simulate.faults import campaign
from synth.simulate.rig import Rig
from synth.simulate.scenario import Trajectory

Place = Mapping[str, float]

FAILURE, DURATION, MOVES = 0.3, 1.3, 0.1  # s: from MOVES on the set-points move
FROZEN = FAILURE + 1e-3  # s: a channel that sticks keeps its reading of FAILURE
START = {"x": 0.009, "y": 0.005}  # m: a place at which no channel reads zero
REST = {"x": 0.0, "y": 0.0}  # m/s
SPEED = {"x": 0.020, "y": 0.015}  # m/s, in motion
PLACES = 12  # of a survey, spread over a pitch; the platen leaves each in another direction
SPEEDS = (0.0, 0.02, 0.08)  # m/s, of a survey
HALL = planar_stage.HALL
ISOLATION = 5  # samples
KINDS = {"nan": "not finite", "zero": "zero", "stuck": "frozen"}
TEXTS = {"nan": "reads NaN", "zero": "drops to zero", "stuck": "sticks"}


def contradicts(loop: Rig, run: Trajectory) -> NDArray[np.bool_]:
    """Return the samples (N,) with a residual out of bounds."""
    return np.asarray(residuals(loop, run) > 1)


def residuals(loop: Rig, run: Trajectory) -> Array:
    """Return rho (N,) of `sensing.sections`, 0 once the fault word names a channel."""
    measured, A = measured_positions(loop, run), calibration.of(loop.plant).amplitude
    bounds = {
        s.name: contradictions.EXCESS_BOUND * A**2 if s.unit == "V^2" else contradictions.RESIDUAL_BOUND * A
        for s in sensing.RESIDUALS
    }
    rho = np.sqrt(np.sum([(measured[name] / bound) ** 2 for name, bound in bounds.items()], axis=0))
    bits = campaign.input_bits(loop)
    return np.where(run.faults & np.bitwise_or.reduce([bits[name] for name in HALL]), 0.0, rho)


def _course(time: Array, at: float, speed: float, axis: str) -> Array:
    """Return a set-point (N,) at times in s, which begins to move at MOVES and stops at the end of its range."""
    end = vertical.REFERENCES[axis]
    return np.clip(at + speed * np.maximum(time - MOVES, 0.0), end.low, end.high)


def motion(start: Place, speed: Place) -> dict[str, Course]:
    """Return the set-points of a platen that leaves a place in m at a speed in m/s."""
    return {f"{axis}_ref": partial(_course, at=at, speed=speed[axis], axis=axis) for axis, at in start.items()}


def failures(kind: str, speed: Place = REST, sensors: Sequence[str] = HALL, label: str = "") -> SensorFaults:
    """Return the experiment of one kind of failure of each channel, from START on."""
    title = f"A Hall channel {TEXTS[kind]} {'at rest' if speed == REST else 'in motion'}"
    return _of_kind(kind, sensors, [motion(START, speed)], title=title, label=label)


def places() -> tuple[tuple[Place, Place], ...]:
    """Return PLACES starts in m with directions, a low-discrepancy sequence over a pitch and a turn (Roberts)."""
    pitch, pairs = planar_stage.plant().parameter("l").value, []
    for n in range(PLACES):
        x, y, turn = ((0.5 + n * step) % 1 for step in (0.7548776662466927, 0.5698402909980532, 0.6180339887498949))
        start = {"x": (0.8 * x - 0.4) * pitch, "y": (0.8 * y - 0.4) * pitch}
        pairs.append((start, {"x": float(np.cos(2 * np.pi * turn)), "y": float(np.sin(2 * np.pi * turn))}))
    return tuple(pairs)


def survey(kind: str) -> SensorFaults:
    """Return the survey of one kind of failure over all channels, places and speeds."""
    motions = [motion(at, {axis: v * part for axis, part in way.items()}) for at, way in places() for v in SPEEDS]
    texts = {"title": f"A Hall channel {TEXTS[kind]}, anywhere", "label": f"{kind}_anywhere"}
    return _of_kind(kind, HALL, motions, unnoticed=np.inf, **texts)


def _of_kind(kind: str, sensors: Sequence[str], motions: Sequence[Mapping[str, Course]], **fields: Any) -> SensorFaults:
    at_s, known = FROZEN if kind == "stuck" else FAILURE, None if kind == "nan" else contradicts
    words, shown = ("channel", "current", "residual out of bounds"), ("x", "y", "phi")
    return SensorFaults(
        KINDS[kind], sensors, at_s, DURATION, motions, known, ISOLATION, words=words, shown=shown, **fields
    )


ALL = (
    *(
        failures(kind, speed, label=f"{kind}_{where}")
        for where, speed in (("resting", REST), ("moving", SPEED))
        for kind in KINDS
    ),
    survey("zero"),
    survey("stuck"),
)
