"""Motions of the stage: steps, the trackings of the paper, F section IV, and the measures of both.

A step comes SETTLE after the start, when the loop is at rest within a count of its encoders. Metrics are those of the
true position, as in the paper: overshoot relative to the step, t_s until it stays within 0.1 mm or 0.1 mrad, t_enc
until it stays within 10 um or 20 urad.

A wrong plant is not at rest after SETTLE: in `x_30` of `maglev_5dof` the gap still falls back to its set-point, and 3
of 96 machines keep the limit of "gap moves by"; after 4 s it would be 87. SETTLE stays, since 4 s would change nominal
values, such as the overshoot of `y_22_29` from 11.55 to 11.70 %.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np

from designs.maglev import platen
from designs.maglev.platen import RESOLUTION
from synth.block import Block
from synth.declare.stage import Stage
from synth.execute import host
from synth.simulate import metrics
from synth.simulate.rig import Rig, Wires
from synth.simulate.scenario import Trajectory, sample_times
from synth.statespace import Array, readonly

SETTLE, AFTER = 1.0, 8.0  # s before a step, and after it
BAND = 1e-4  # m or rad, the band of t_s
UNITS = {"y": "m", "x": "m", "z": "m", "phi": "rad", "theta": "rad"}
COUNTS = {axis: RESOLUTION if unit == "m" else 20e-6 for axis, unit in UNITS.items()}  # m or rad, F section IV-A
TRACK_FROM, TRACK_TO = 10.0, 60.0  # s, the window of the mean errors
NO_ROTATION: Wires = {**platen.WIRES, **{f"i_d{j}": {f"i_d{k}": 0.25 for k in platen.MOTORS} for j in platen.MOTORS}}


@dataclass(frozen=True, eq=False)
class StepRun:
    """The trajectory of a step with its set-point (N,), the metrics, and the sample of the step."""

    trajectory: Trajectory
    reference: Array
    response: metrics.StepResponse
    sample: int


def step(
    rig: Rig, axis: str, start: float, target: float, gap: float = 0.025, after: float = AFTER, **options: Any
) -> StepRun:
    """Run one step of `axis` from `start` to `target` (m, rad) at a gap in m, followed for `after` seconds.

    With `actuators` among the options the drive is left out, and with `locked` coordinates the fault handling, too: an
    encoder of a platen that is clamped looks like a frozen one.
    """
    rig = rig.without_drive if options.keys() & {"actuators", "locked"} else rig
    rig = without_fault_handling(rig) if "locked" in options else rig
    time = sample_times(SETTLE + after, rig.period_s)
    reference = np.where(time < SETTLE, start, target)
    trajectory = rig.run(SETTLE + after, {"y": gap} | {axis: start}, {f"{axis}_ref": reference}, **options)
    k = int(np.argmax(time >= SETTLE))
    response = metrics.step_response(time[k:], trajectory[axis][k:], start, target, BAND, COUNTS[axis])
    return StepRun(trajectory, reference, response, k)


def lift_off(rig: Rig) -> tuple[Trajectory, Array]:
    """Lift from rest on the lower stop to 25 mm by a ramp of 1 s; return the trajectory and the set-point."""
    time, start = sample_times(6.0, rig.period_s), platen.AXES[0].reference.high
    reference = start - (start - 0.025) * np.clip(time - SETTLE, 0.0, 1.0)
    return rig.run(6.0, {"y": platen.GAP[1]}, {"y_ref": reference}), reference


@lru_cache
def _courses(duration_s: float, period_s: float) -> dict[str, Array]:
    """Return the set-points of the 4-DOF tracking: a study runs it on many machines."""
    return {axis: readonly(course(sample_times(duration_s, period_s))) for axis, course in platen.COURSES.items()}


def tracking(rig: Rig, four: bool, duration_s: float = TRACK_TO) -> tuple[Trajectory, dict[str, Array]]:
    """Run the 4-DOF tracking or the 3-DOF ellipse from rest; return it with the set-points by axis."""
    courses = {axis: course for axis, course in _courses(duration_s, rig.period_s).items() if four or axis != "theta"}
    start = {axis: float(courses[axis][0]) for axis in ("y", "x", "z")}
    references = {f"{axis}_ref": course for axis, course in courses.items()}
    if four:
        return rig.run(duration_s, start, references), courses
    return rig.without_drive.run(duration_s, start, references, actuators=NO_ROTATION), courses


def mean_errors(
    trajectory: Trajectory, courses: Mapping[str, Array], start: float = TRACK_FROM, stop: float = TRACK_TO
) -> dict[str, float]:
    """Return the mean |true error| of each axis from `start` to `stop` s, m and rad."""
    errors = {axis: trajectory[axis] - courses.get(axis, 0.0) for axis in UNITS}
    return {axis: metrics.mean_absolute(trajectory.time, e, start, stop) for axis, e in errors.items()}


def motor_currents(trajectory: Trajectory) -> Array:
    """Return hypot(i_d, i_q) of the four commanded motor currents (4, N), A rms."""
    commands = trajectory.commands
    magnitudes = np.empty((len(platen.MOTORS), len(trajectory.time)))
    for i, j in zip(magnitudes, platen.MOTORS, strict=True):
        np.square(commands[f"i_d{j}"], out=i, dtype=float)
        i += np.square(commands[f"i_q{j}"], dtype=float)
    return np.sqrt(magnitudes, out=magnitudes)


def compile_block(block: Block, scalar: str) -> host.Controller:
    """Return a Block compiled in a scalar type by name."""
    kind = np.dtype(scalar).type
    return host.compile_block(block, kind, error=platen.SURROGATE_ERROR[kind])


@lru_cache(maxsize=8)
def _law_alone(stage: Stage, scalar: str) -> host.Controller:
    assert stage.law_alone is not None
    return compile_block(stage.law_alone.block, scalar)


def without_fault_handling(rig: Rig) -> Rig:
    """Return the rig with the law alone, which the stage declares."""
    return replace(rig, controller=_law_alone(rig.stage, np.dtype(rig.controller.scalar).name))
