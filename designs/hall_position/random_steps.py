"""Steps of the guarded estimator for comparison: drawn at random, at the edges of the ranges, and along motions.

random    states anywhere; a third of the voltages are of a pose about where the sample begins, a third of one
          further away, a third anywhere; one in a hundred is refused
edge      states anywhere and on the ends of their ranges, every input on the ends of its range, beyond, no number
motions   across many pitches and through full turns of yaw, from `init`, where the place is not known; in a fifth
          of them voltages are refused, alone, in runs, and in the end up to the latch
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
NEAR = (1e-3, 0.05, 0.3)  # rad of phase, from where a sample begins
REFUSED, ON_END = 0.01, 0.25  # shares of voltages, and of states
COUNTS = ("estimator_pitch_x", "estimator_pitch_y")  # whole numbers, held as real ones
TRAVEL = 0.3  # m: six pitches, at up to 2 m/s
YAW, TURN = (0.04, 0.5), (0.0, 13.0)  # rad, rad/s, of every other motion: a turn in 0.5 s
LENGTH, BAD_COLUMNS = 500, 5  # samples of a motion; of so many one has bad samples


@dataclass(frozen=True, eq=False)
class Subject:
    """An estimator that ships: its sensors, its Block, and the numbers of the reference."""

    name: str
    array: Array
    block: Block
    of: Setup


def setup(name: str = config.NAME) -> Setup:
    """Return the numbers of the reference; raise DesignError for an unknown name."""
    of = config.array(name)
    return Setup(vars(of) | vars(config.TUNING))


def subject(name: str) -> Subject:
    """Return what ships under a name for comparison with the reference."""
    return Subject(name, config.array(name), config.block(name), setup(name))


def in_operation(subject: Subject, n: int) -> tuple[Columns, Columns]:
    """Draw n random steps (states, inputs)."""
    rng, of, array = np.random.default_rng(SEED), subject.of, subject.array
    states, w = sampling.states_anywhere(subject.block, rng, n, whole=COUNTS), array.wave_number
    start, _ = reference.predict(
        of, reference_guard.estimator_states(states), np.zeros((n, len(of.positions), 2), bool)
    )
    size = rng.choice(NEAR, n)[:, np.newaxis] * rng.standard_normal((n, 3)) / [w, w, array.radius]
    x, y, yaw = (start + size).T
    (cx, cy), c, s = array.centre, np.cos(yaw), np.sin(yaw)
    V = motions.noisy(array, Pose(x - c * cx + s * cy, y - s * cx - c * cy, yaw), SEED)
    span = reference_guard.SPAN
    V = np.where((rng.random(n) < 1 / 3)[:, np.newaxis, np.newaxis], rng.uniform(-span, span, V.shape), V)
    V[rng.random(V.shape) < REFUSED] = np.nan
    return states, motions.named(V)


def at_the_edges(subject: Subject, n: int) -> tuple[Columns, Columns]:
    """Draw n edge steps (states, inputs)."""
    rng, block = np.random.default_rng(SEED + 1), subject.block
    states = sampling.states_anywhere(block, rng, n, whole=COUNTS)
    for s in block.states:
        ends = rng.choice((s.signal.low, s.signal.high), n)
        states[s.name] = np.where(rng.random(n) < ON_END, ends, states[s.name])
    return states, {signal.name: sampling.at_edges(signal, rng, n) for signal in block.inputs}


def along_motions(subject: Subject, n: int) -> Columns:
    """Return the inputs (LENGTH, columns) of at least n samples of motions."""
    columns = ceil(n / LENGTH)
    yaw, turn = np.resize(YAW, columns), np.resize(TURN, columns)
    pose = motions.wander(config.TIME.period_s, (LENGTH, columns), SEED, TRAVEL, yaw, turn)
    V = motions.noisy(subject.array, pose, SEED + 1)
    _refuse(V[:, ::BAD_COLUMNS], reference_guard.BAD_SAMPLES)
    return motions.named(V)


def _refuse(V: Numbers, limit: int) -> None:
    """Refuse voltages (LENGTH, columns, sensors, 2) in place: single ones, a run of nearly the limit, one up to it."""
    k = np.arange(LENGTH)
    V[k % 60 == 59, :, 0, 1] = np.nan
    V[(k >= 205) & (k < 205 + limit - 1), :, 1, 0] = 2 * reference_guard.SPAN
    V[(k >= 305) & (k < 305 + limit + 3), :, 1, 1] = -np.inf
