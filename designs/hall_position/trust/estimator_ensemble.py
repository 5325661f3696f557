"""Many bodies at once through the compiled C of the guarded estimator, on voltages by model (2) with noise.

A position is compared within the pitch, which is all that a search tells.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from math import pi

import numpy as np

from designs.hall_position.config import TIME
from designs.hall_position.glsdc import estimator
from designs.hall_position.glsdc.parameters import Tuning
from models import hall_motions as motions
from models.hall_motions import Course, Numbers, Pose
from models.hall_two_waves import PlanarArray as Array
from synth import numeric
from synth.block import unranged
from synth.execute import build, host
from synth.simulate import ensemble
from synth.simulate.ensemble import Scores

USUAL = Tuning()


@dataclass(frozen=True)
class EstimatorConfig:
    """Sensors, and how they are estimated from."""

    array: Array
    tuning: Tuning = USUAL


@cache
def compile_estimator(kind: EstimatorConfig) -> host.Controller:
    """Return the estimator's C in single precision, compiled."""
    block = estimator.guarded_estimator(kind.array, TIME, kind.tuning)
    return build.compiled(unranged(block), np.float32, error=estimator.SURROGATE_ERROR[np.float32])


def states_at(kind: EstimatorConfig, pose: Pose, before: Pose | None = None, resolved: bool = True) -> host.Records:
    """Return the states of bodies that are at poses (N,), and were at others a sample before, or at rest.

    Where that is not certain a yaw about 0 is assumed, as after `init`.
    """
    state = ensemble.started(compile_estimator(kind), len(pose.X))
    w, pitch = kind.array.wave_number, kind.array.pitch
    now, last = (each.place(kind.array.centre) for each in (pose, before or pose))
    for axis, at, past in zip("xy", now, last, strict=True):
        turns = np.round(at / pitch)
        state[f"estimator_phase_{axis}"], state[f"estimator_pitch_{axis}"] = w * (at - turns * pitch), turns
        if kind.tuning.velocity_gain:
            state[f"estimator_motion_{axis}"] = w * (at - past)
    if kind.tuning.velocity_gain and before:
        state["estimator_motion_yaw"] = pose.yaw - before.yaw
    state["estimator_yaw"], state["estimator_searching"] = wrap_angle(pose.yaw), 0
    if resolved:
        state["estimator_yaw_last_good"] = wrap_angle(pose.yaw)
        state["estimator_ambiguity_resolved"] = state["estimator_acquired"] = 1
    return state


def states_on_course(kind: EstimatorConfig, at: Course) -> host.Records:
    """Return the states of bodies on a course, before sample 0."""
    return states_at(kind, at(-1), at(-2))


def wrap_angle(angle: Numbers) -> Numbers:
    """Return angles within half a turn."""
    return (angle + pi) % (2 * pi) - pi


def step(kind: EstimatorConfig, state: host.Records, volts: Numbers) -> host.Batch:
    """Advance bodies (N,) by a sample on voltages (N, sensors, 2)."""
    return compile_estimator(kind).batch(state, motions.by_input(volts))


def score(kind: EstimatorConfig, outputs: Mapping[str, Numbers], pose: Pose) -> Scores:
    """Return the scores of outputs (N,) by where the bodies are."""
    pitch = kind.array.pitch
    along = [(outputs[a] - getattr(pose, a) + pitch / 2) % pitch - pitch / 2 for a in "XY"]
    errors = np.array([*along, wrap_angle(outputs["yaw"] - pose.yaw)])
    stated = np.array([outputs[f"deviation_{a}"] for a in ("X", "Y", "yaw")])
    return Scores(outputs["valid"] > 0, np.hypot(*along), np.abs(errors) / stated)


def track(
    kind: EstimatorConfig,
    state: host.Records,
    at: Course,
    samples: int,
    rng: np.random.Generator,
    spoilt: Callable[[int, Numbers], Numbers] = lambda k, volts: volts,
) -> Iterator[tuple[host.Batch, Scores]]:
    """Yield what each sample makes of bodies that are at known poses, on noisy voltages that are `spoilt` then.

    Raises ModelError for a number of samples that is none.
    """
    for k in range(numeric.whole("the number of samples", samples)):
        pose = at(k)
        batch = step(kind, state, spoilt(k, motions.noisy(kind.array, pose, rng)))
        state = batch.states
        yield batch, score(kind, batch.outputs, pose)


def track_scores(
    kind: EstimatorConfig, state: host.Records, at: Course, samples: int, rng: np.random.Generator
) -> Scores:
    """Return the scores (samples, N) of bodies that are at known poses; raise ModelError as `followed`."""
    return ensemble.stacked([scores for _, scores in track(kind, state, at, samples, rng)])
