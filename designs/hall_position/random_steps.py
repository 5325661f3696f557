"""Steps of the guarded estimator for verification: random, at the edges of the ranges, and along motions.

random    random states; a third of the voltages belong to a pose near the predicted one, a third to one further away,
          a third are random; one in a hundred is refused
edge      random states, also at the ends of their ranges; every input at the ends of its range, beyond, or NaN
motions   across many pitches and through full turns of yaw, from `init` with an unknown position; in a fifth of the
          motions voltages are refused, singly, in runs, and at the end up to the latch
"""

from dataclasses import dataclass
from math import ceil

import numpy as np

from designs.hall_position import config, reference, reference_guard
from designs.hall_position.reference_glsdc import Setup
from models import hall_motions as motions
from models.hall_motions import Numbers, Pose
from models.hall_two_waves import PlanarArray as Array
from synth.block import Block
from synth.verify import sampling
from synth.verify.sampling import Columns

SEED = 2_013
DISPLACEMENTS = (1e-3, 0.05, 0.3)  # rad of phase, standard deviations from the predicted pose
NAN_SHARE = 0.01  # of the voltages
AT_END_SHARE = 0.25  # of the states
COUNTS = ("estimator_pitch_x", "estimator_pitch_y")  # whole numbers, stored as real ones
TRAVEL = 0.3  # m: six pitches, at up to 2 m/s
YAW, YAW_RATE = (0.04, 0.5), (0.0, 13.0)  # rad, rad/s, in turn: every other motion rotates once in 0.5 s
LENGTH = 500  # samples of a motion
BAD_COLUMNS = 5  # every fifth motion has bad samples


@dataclass(frozen=True, eq=False)
class Subject:
    """A shipped estimator: its sensors, its Block, and the setup of its reference."""

    name: str
    array: Array
    block: Block
    setup: Setup


def setup(name: str = config.NAME) -> Setup:
    """Return the setup of the reference; raise DesignError for an unknown name."""
    return Setup(vars(config.array(name)) | vars(config.TUNING))


def subject(name: str) -> Subject:
    """Return the estimator of a name for comparison with its reference."""
    return Subject(name, config.array(name), config.block(name), setup(name))


def in_operation(subject: Subject, n: int) -> tuple[Columns, Columns]:
    """Draw n random steps (states, inputs)."""
    rng, array = np.random.default_rng(SEED), subject.array
    states, w = sampling.states_anywhere(subject.block, rng, n, whole=COUNTS), array.wave_number
    start, _ = reference.predict(
        subject.setup, reference_guard.estimator_states(states), np.zeros((n, len(array.positions), 2), bool)
    )
    size = rng.choice(DISPLACEMENTS, n)[:, np.newaxis] * rng.standard_normal((n, 3)) / [w, w, array.radius]
    x, y, yaw = (start + size).T
    (cx, cy), c, s = array.centre, np.cos(yaw), np.sin(yaw)
    V = motions.noisy(array, Pose(x - c * cx + s * cy, y - s * cx - c * cy, yaw), SEED)
    span = reference_guard.SPAN
    V = np.where((rng.random(n) < 1 / 3)[:, np.newaxis, np.newaxis], rng.uniform(-span, span, V.shape), V)
    V[rng.random(V.shape) < NAN_SHARE] = np.nan
    return states, motions.by_input(V)


def at_the_edges(subject: Subject, n: int) -> tuple[Columns, Columns]:
    """Draw n edge steps (states, inputs)."""
    rng, block = np.random.default_rng(SEED + 1), subject.block
    states = sampling.states_anywhere(block, rng, n, whole=COUNTS)
    for s in block.states:
        ends = rng.choice((s.signal.low, s.signal.high), n)
        states[s.name] = np.where(rng.random(n) < AT_END_SHARE, ends, states[s.name])
    return states, {signal.name: sampling.at_edges(signal, rng, n) for signal in block.inputs}


def along_motions(subject: Subject, n: int) -> Columns:
    """Return the inputs (LENGTH, columns) of at least n samples of motions."""
    columns = ceil(n / LENGTH)
    yaw, yaw_rate = np.resize(YAW, columns), np.resize(YAW_RATE, columns)
    pose = motions.smooth_motions(config.TIME.period_s, (LENGTH, columns), SEED, TRAVEL, yaw, yaw_rate)
    V = motions.noisy(subject.array, pose, SEED + 1)
    _refuse(V[:, ::BAD_COLUMNS], reference_guard.BAD_SAMPLES)
    return motions.by_input(V)


def _refuse(V: Numbers, limit: int) -> None:
    """Refuse voltages (LENGTH, columns, sensors, 2) in place: single ones, a run of nearly the limit, one up to it."""
    k = np.arange(LENGTH)
    V[k % 60 == 59, :, 0, 1] = np.nan
    V[(k >= 205) & (k < 205 + limit - 1), :, 1, 0] = 2 * reference_guard.SPAN
    V[(k >= 305) & (k < 305 + limit + 3), :, 1, 1] = -np.inf
