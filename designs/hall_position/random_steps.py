"""Test stimuli of the Hall position estimator and its input guard, for the comparison of its implementations.

The guard replaces each invalid voltage (outside +-SPAN, or NaN) by the last valid one; BAD_SAMPLES consecutive samples
with an invalid voltage set a latch. Three kinds of stimuli cover estimator and guard:

random    independent steps from random states. In two thirds of the steps the voltages are those of a pose at a random
          distance from the predicted one, in a third they are random. One voltage in a hundred is NaN
edge      independent steps from random states, some at the ends of their ranges. Every input is at an end of its range,
          beyond it, or NaN
motion    smooth motions over several pitches, half of them with full turns of yaw, from `init` with an unknown
          position. One motion in five has invalid voltages: single ones, then several samples in a row, at last enough
          in a row to set the latch
"""

from dataclasses import dataclass
from math import ceil

import numpy as np

from designs.hall_position import config, reference, reference_guard
from designs.hall_position.reference_glsdc import Setup
from models import hall_motions as motions
from models.hall_motions import Numbers, Pose
from models.hall_two_waves import PlanarArray
from synth.block import Block
from synth.verify import sampling
from synth.verify.sampling import Columns

SEED = 2_013
POSE_DEVIATIONS = (1e-3, 0.05, 0.3)  # rad of phase: standard deviations of the pose from the predicted one
NAN_SHARE = 0.01  # share of the voltages that are NaN
RANGE_END_SHARE = 0.25  # share of the states that are at an end of their range
INTEGER_STATES = ("estimator_pitch_x", "estimator_pitch_y")  # stored as floating-point numbers
TRAVEL = 0.3  # m: six pitches; the speed reaches 2 m/s
# Motions alternate between the first pair (rad, rad/s) and the second, which makes a full turn in 0.5 s.
ALTERNATING_YAW, ALTERNATING_YAW_RATE = (0.04, 0.5), (0.0, 13.0)
MOTION_SAMPLES = 500  # samples of one motion
BAD_MOTION_INTERVAL = 5  # the motions 0, 5, 10, .. have invalid voltages
SINGLE_INTERVAL = 60  # samples from one single invalid voltage to the next
LONGEST_RUN_START, LATCHING_RUN_START = 205, 305  # sample at which a run of invalid voltages begins
SAMPLES_AFTER_LATCH = 3  # samples by which the last run is longer than the latch needs


@dataclass(frozen=True, eq=False)
class Subject:
    """An estimator under test: its sensors, its Block, and the setup of its reference."""

    name: str
    array: PlanarArray
    block: Block
    setup: Setup


def setup() -> Setup:
    """Return the setup of the reference."""
    return Setup(vars(config.array()) | vars(config.TUNING))


def subject() -> Subject:
    """Return the estimator with all that its comparison with the reference needs."""
    return Subject(config.NAME, config.array(), config.block(), setup())


def operating_steps(subject: Subject, n: int) -> tuple[Columns, Columns]:
    """Draw n independent steps (states, inputs) in operation: the random stimuli."""
    rng, array = np.random.default_rng(SEED), subject.array
    states, w = sampling.states_anywhere(subject.block, rng, n, whole=INTEGER_STATES), array.wave_number
    predicted = reference.predict(subject.setup, reference_guard.estimator_states(states))
    deviation = rng.choice(POSE_DEVIATIONS, n)[:, np.newaxis]
    x, y, yaw = (predicted + deviation * rng.standard_normal((n, 3)) / [w, w, array.radius]).T
    # The estimator's x and y are those of the sensors' centre r_c; the body is at (x, y) - R(yaw) r_c.
    (cx, cy), c, s = array.centre, np.cos(yaw), np.sin(yaw)
    V = motions.noisy(array, Pose(x - c * cx + s * cy, y - s * cx - c * cy, yaw), SEED)
    span = reference_guard.SPAN
    V = np.where((rng.random(n) < 1 / 3)[:, np.newaxis, np.newaxis], rng.uniform(-span, span, V.shape), V)
    V[rng.random(V.shape) < NAN_SHARE] = np.nan
    return states, motions.by_input(V)


def edge_steps(subject: Subject, n: int) -> tuple[Columns, Columns]:
    """Draw n independent steps (states, inputs) at the ends of ranges: the edge stimuli."""
    rng, block = np.random.default_rng(SEED + 1), subject.block
    states = sampling.states_anywhere(block, rng, n, whole=INTEGER_STATES)
    for s in block.states:
        ends = rng.choice((s.signal.low, s.signal.high), n)
        states[s.name] = np.where(rng.random(n) < RANGE_END_SHARE, ends, states[s.name])
    return states, {signal.name: sampling.at_edges(signal, rng, n) for signal in block.inputs}


def motion_inputs(subject: Subject, n: int) -> Columns:
    """Return the inputs (MOTION_SAMPLES, motions) of motions with at least n samples together."""
    count = ceil(n / MOTION_SAMPLES)
    yaw, yaw_rate = np.resize(ALTERNATING_YAW, count), np.resize(ALTERNATING_YAW_RATE, count)
    pose = motions.smooth_motions(config.TIME.period_s, (MOTION_SAMPLES, count), SEED, TRAVEL, yaw, yaw_rate)
    V = motions.noisy(subject.array, pose, SEED + 1)
    _invalidate(V[:, ::BAD_MOTION_INTERVAL], reference_guard.BAD_SAMPLES)
    return motions.by_input(V)


def _invalidate(V: Numbers, bad_samples: int) -> None:
    """Overwrite some of the voltages (MOTION_SAMPLES, motions, sensors, 2) by invalid ones.

    The longest run that sets no latch has `bad_samples` - 1 samples; the last run is longer and sets it.
    """
    k = np.arange(MOTION_SAMPLES)
    V[k % SINGLE_INTERVAL == SINGLE_INTERVAL - 1, :, 0, 1] = np.nan
    longest, latching = k - LONGEST_RUN_START, k - LATCHING_RUN_START
    V[(longest >= 0) & (longest < bad_samples - 1), :, 1, 0] = 2 * reference_guard.SPAN
    V[(latching >= 0) & (latching < bad_samples + SAMPLES_AFTER_LATCH), :, 1, 1] = -np.inf
