"""Ensemble simulation of the guarded estimator's compiled C, on voltages by model (2) with noise.

Positions are compared within the pitch: a search does not determine the number of the pitch.
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
from synth.execute import host
from synth.simulate import sampling
from synth.simulate.sampling import Scores

DEFAULT_TUNING = Tuning()


@dataclass(frozen=True)
class EstimatorConfig:
    """Sensors of an estimator, and its tuning."""

    array: Array
    tuning: Tuning = DEFAULT_TUNING


@cache
def compile_estimator(config: EstimatorConfig) -> host.Controller:
    """Return the estimator's C in single precision, compiled."""
    block = estimator.guarded_estimator(config.array, TIME, config.tuning)
    return host.compile_block(unranged(block), np.float32, error=estimator.SURROGATE_ERROR[np.float32])


def states_at(config: EstimatorConfig, pose: Pose, before: Pose | None = None, resolved: bool = True) -> host.Records:
    """Return the states of an estimator that tracks bodies at poses (N,), a sample after poses `before`, or at rest.

    If the ambiguity is not `resolved`, the last good yaw is 0, as after `init`.
    """
    state = sampling.initial_states(compile_estimator(config), len(pose.X))
    w, pitch = config.array.wave_number, config.array.pitch
    now, last = (each.place(config.array.centre) for each in (pose, before or pose))
    for axis, at, past in zip("xy", now, last, strict=True):
        turns = np.round(at / pitch)
        state[f"estimator_phase_{axis}"], state[f"estimator_pitch_{axis}"] = w * (at - turns * pitch), turns
        if config.tuning.velocity_gain:
            state[f"estimator_motion_{axis}"] = w * (at - past)
    if config.tuning.velocity_gain and before:
        state["estimator_motion_yaw"] = pose.yaw - before.yaw
    state["estimator_yaw"], state["estimator_searching"] = wrap_angle(pose.yaw), 0
    if resolved:
        state["estimator_yaw_last_good"] = wrap_angle(pose.yaw)
        state["estimator_ambiguity_resolved"] = state["estimator_acquired"] = 1
    return state


def states_on_course(config: EstimatorConfig, at: Course) -> host.Records:
    """Return the states of an estimator that tracks bodies on a course, before sample 0."""
    return states_at(config, at(-1), at(-2))


def wrap_angle(angle: Numbers) -> Numbers:
    """Return angles wrapped to -pi .. pi."""
    return (angle + pi) % (2 * pi) - pi


def step(config: EstimatorConfig, state: host.Records, volts: Numbers) -> host.Batch:
    """Advance bodies (N,) by a sample on voltages (N, sensors, 2)."""
    return compile_estimator(config).batch(state, motions.by_input(volts))


def score(config: EstimatorConfig, outputs: Mapping[str, Numbers], pose: Pose) -> Scores:
    """Return the scores of outputs (N,) against the true poses."""
    pitch = config.array.pitch
    along = [(outputs[a] - getattr(pose, a) + pitch / 2) % pitch - pitch / 2 for a in "XY"]
    errors = np.array([*along, wrap_angle(outputs["yaw"] - pose.yaw)])
    stated = np.array([outputs[f"deviation_{a}"] for a in ("X", "Y", "yaw")])
    return Scores(outputs["valid"] > 0, np.hypot(*along), np.abs(errors) / stated)


def track(
    config: EstimatorConfig,
    state: host.Records,
    at: Course,
    samples: int,
    rng: np.random.Generator,
    corrupt: Callable[[int, Numbers], Numbers] = lambda k, volts: volts,
) -> Iterator[tuple[host.Batch, Scores]]:
    """Yield the batch and the scores of each sample, on noisy voltages passed through `corrupt`.

    Raises ModelError unless the number of samples is a whole number above 0.
    """
    for k in range(numeric.whole("the number of samples", samples)):
        pose = at(k)
        batch = step(config, state, corrupt(k, motions.noisy(config.array, pose, rng)))
        state = batch.states
        yield batch, score(config, batch.outputs, pose)


def track_scores(
    config: EstimatorConfig, state: host.Records, at: Course, samples: int, rng: np.random.Generator
) -> Scores:
    """Return the scores (samples, N) of bodies on a course; raise ModelError as `track`."""
    return sampling.stack([scores for _, scores in track(config, state, at, samples, rng)])
