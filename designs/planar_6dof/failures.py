"""Hall channel failures (stuck, zero, NaN), at rest and in motion: detection, isolation, and the consequences.

Each of the six channels fails alone, FAILURE seconds after the start, with noise, as described in
`synth.simulate.faults.failure_experiments`. Experiments from START report each channel, a survey over PLACES reports
counts.
A platen that a failure carries away may tilt until the lasers are out of range, and then latches.
"""

from collections.abc import Mapping, Sequence
from functools import cache, partial

import numpy as np
from numpy.typing import NDArray

from designs.planar_6dof import interface
from designs.planar_6dof.loop import Array, measured_positions
from designs.planar_6dof.sensing import calibration, contradictions
from designs.planar_6dof.sensing import sections as sensing
from models import planar_stage
from synth.check import Check
from synth.declare.experiments import Run
from synth.simulate.experiments import Experiment
from synth.simulate.faults import failure_experiments
from synth.simulate.faults.failure_experiments import NAN, Failure, Texts
from synth.simulate.rig import Rig
from synth.simulate.scenario import Trajectory, sample_times

Place = Mapping[str, float]

FAILURE, DURATION, MOVES = 0.3, 1.3, 0.1  # s: from MOVES on the set-points move
START = {"x": 0.009, "y": 0.005}  # m: a place at which no channel reads zero
REST = {"x": 0.0, "y": 0.0}  # m/s
SPEED = {"x": 0.020, "y": 0.015}  # m/s, in motion
PLACES = 12  # of a survey, spread over a pitch; the platen leaves each in another direction
SPEEDS = (0.0, 0.02, 0.08)  # m/s, of a survey
HALL = planar_stage.HALL
SLEW = interface.SLEW * (1 + 1e-5)  # A/s: single precision of 1.26 A over a sample
LIMITS = failure_experiments.Limits(5, interface.BAD_SAMPLES, SLEW, "A/s", f"declared: {interface.SLEW:g}")
FAULT_VALUES = {NAN: np.nan, "zero": 0.0, "stuck": None}
FAULT_TEXTS = {NAN: "reads NaN", "zero": "drops to zero", "stuck": "sticks"}
SHOWN = ("x", "y", "phi")


def fail(loop: Rig, channel: str, kind: str, start: Place = START, speed: Place = REST) -> Failure:
    """Run the stage with a channel that fails permanently after FAILURE seconds, at a `speed` in m/s."""
    moving_s = np.maximum(sample_times(DURATION, loop.period_s) - MOVES, 0.0)
    references = {f"{axis}_ref": at + speed[axis] * moving_s for axis, at in start.items()}
    return failure_experiments.fail(
        loop, channel, FAULT_VALUES[kind], FAILURE, DURATION, references, start, contradicts
    )


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
    bits = failure_experiments.bits(loop)
    return np.where(run.faults & np.bitwise_or.reduce([bits[name] for name in HALL]), 0.0, rho)


def coasting_speed(f: Failure) -> dict[str, float]:
    """Return the speed of the coasting platen at the end as a figure; 0 without a latch."""
    speed = 0.0 if f.samples_to_latch is None else float(np.hypot(f.run["vx"][-1], f.run["vy"][-1]))
    return {f"coasts at, {f.sensor}, mm/s": 1e3 * speed}


def checks(failures: Sequence[Failure], kind: str) -> list[Check]:
    """Return the checks of every failure; each must be detected."""
    return failure_experiments.checks(failures, kind, LIMITS, seen=True)


def _by_channel(loop: Rig, name: str, kind: str, moving: bool) -> Experiment:
    """Return the experiment of one kind of failure over all channels."""
    failures = [fail(loop, channel, kind, START, SPEED if moving else REST) for channel in HALL]
    title = f"A Hall channel {FAULT_TEXTS[kind]} {'in motion' if moving else 'at rest'}"
    texts = Texts(name, title, f"each of six channels by itself after {FAILURE:g} s", SHOWN)
    return failure_experiments.by_sensor(texts, failures, checks(failures, kind), coasting_speed)


@cache
def places() -> tuple[tuple[Place, Place], ...]:
    """Return PLACES starts in m with directions, a low-discrepancy sequence over a pitch and a turn (Roberts)."""
    pitch, pairs = planar_stage.plant().parameter("l").value, []
    for n in range(PLACES):
        x, y, turn = ((0.5 + n * step) % 1 for step in (0.7548776662466927, 0.5698402909980532, 0.6180339887498949))
        start = {"x": (0.8 * x - 0.4) * pitch, "y": (0.8 * y - 0.4) * pitch}
        pairs.append((start, {"x": float(np.cos(2 * np.pi * turn)), "y": float(np.sin(2 * np.pi * turn))}))
    return tuple(pairs)


def survey(loop: Rig, name: str, kind: str, speeds: Sequence[float] = SPEEDS) -> Experiment:
    """Return the survey of one kind of failure over all channels, places and speeds in m/s."""
    failures = [
        fail(loop, channel, kind, start, {axis: v * part for axis, part in way.items()})
        for channel in HALL
        for start, way in places()
        for v in speeds
    ]
    about = f"each channel at {PLACES} places, at {', '.join(f'{1e3 * v:g}' for v in speeds)} mm/s"
    texts = Texts(name, f"A Hall channel {FAULT_TEXTS[kind]}, anywhere", about, SHOWN)
    return failure_experiments.survey(texts, failures, LIMITS)


ALL = (
    *(
        Run(f"{kind}_{'moving' if moving else 'resting'}", partial(_by_channel, kind=kind, moving=moving))
        for moving in (False, True)
        for kind in FAULT_VALUES
    ),
    *(Run(f"{kind}_anywhere", partial(survey, kind=kind)) for kind in ("zero", "stuck")),
)
