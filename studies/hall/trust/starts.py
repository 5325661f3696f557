"""Convergence of the estimate: basin of attraction, capture radius, and time from `init` to a valid estimate.

The body is at rest and the estimate starts elsewhere, in tracking but with the ambiguity unresolved. In the first
sample the corrections converge to the true position, to another minimum with large residuals, or to another position
with the same voltages. After more samples the estimator has searched. No estimate may be valid at a wrong position.

From `init` on the search starts at the points of a sequence that fills the pitch, with PATIENCE samples at each. Two
sensors locate a body at rest, but are unambiguous in a part of the pitch only; a moving body reaches such a part.
"""

from dataclasses import dataclass

import numpy as np

from designs.hall_position import config as hall
from designs.hall_position.glsdc import tracking
from models import hall_motions as motions
from models.hall_motions import Numbers, Pose
from studies.hall.protected import cold_start as cold_starts
from studies.hall.protected.cold_start import ColdStart
from studies.hall.protected.trust import World
from studies.hall.trust import estimator_ensemble
from studies.hall.trust.estimator_ensemble import EstimatorConfig
from synth import numeric
from synth.simulate import sampling
from synth.simulate.sampling import Scores
from synth.statespace import readonly

MAX_DISTANCE, MAX_YAW = 0.5, np.radians(10)  # of the pitch, and rad: largest offsets of starts
BINS = (8, 4)  # of these offsets
DIRECTIONS, RINGS = 8, 16  # of starts about a position
MAX_RING_RADIUS = 0.125  # of the pitch


@dataclass(frozen=True, eq=False)
class Basin:
    """Shares (n, m) of starts that converge, by upper bounds of their `displacement` (n,) in m and `yaw` (m,) in rad.
    `first` in the first sample, `last` in the last one, NaN in bins without a start. Of all `samples` of all bodies
    `misleading` were valid at a wrong position.
    """

    displacement: Numbers
    yaw: Numbers
    first: Numbers
    last: Numbers
    samples: int
    misleading: int


def basin(config: EstimatorConfig, bodies: int, yaw: float, samples: int = 60, seed: int = 0) -> Basin:
    """Return the basin about random positions in the pitch, at yaws in rad of up to `yaw` to either side.

    Raises ModelError for no body or sample, or an invalid yaw.
    """
    rng, pitch = np.random.default_rng(seed), config.array.pitch
    pose = motions.random_poses(config.array, bodies, yaw, rng)
    off, yaw_error = MAX_DISTANCE * pitch * rng.random(bodies), MAX_YAW * rng.random(bodies)
    start = pose.displaced(off, rng.uniform(0, 2 * np.pi, bodies), yaw_error * rng.choice([-1, 1], bodies))
    state = estimator_ensemble.states_at(config, start, resolved=False)
    scores = estimator_ensemble.track_scores(config, state, motions.course_at_rest(pose), samples, rng)
    edges = [MAX_DISTANCE * pitch * np.arange(BINS[0] + 1) / BINS[0], MAX_YAW * np.arange(BINS[1] + 1) / BINS[1]]
    every, _, _ = np.histogram2d(off, yaw_error, edges)
    converged = [np.histogram2d(off[right], yaw_error[right], edges)[0] for right in scores.is_correct[[0, -1]]]
    with np.errstate(invalid="ignore"):
        first, last = (readonly(good / every) for good in converged)
    return Basin(
        readonly(edges[0][1:]), readonly(edges[1][1:]), first, last, bodies * samples, int(scores.is_wrong.sum())
    )


def capture_radius(config: EstimatorConfig, points: int, seed: int = 0) -> Numbers:
    """Return the distance within which all starts at yaw 0 converge in the first sample, (points, points).

    In m, over X and Y of the pitch. Raises ModelError for no point.
    """
    rng, pitch = np.random.default_rng(seed), config.array.pitch
    along = pitch * np.arange(numeric.whole("the number of points", points)) / points
    rings = MAX_RING_RADIUS * pitch * np.arange(1, RINGS + 1) / RINGS
    X, Y, d, h = np.meshgrid(along, along, rings, 2 * np.pi * np.arange(DIRECTIONS) / DIRECTIONS, indexing="ij")
    pose = Pose(X.ravel(), Y.ravel(), np.zeros(X.size))
    state = estimator_ensemble.states_at(config, pose.displaced(d.ravel(), h.ravel()), resolved=False)
    scores = estimator_ensemble.track_scores(config, state, motions.course_at_rest(pose), 1, rng)
    right = scores.is_correct.reshape(X.shape).all(axis=3)
    return readonly(rings[0] * np.cumprod(right, axis=2).sum(axis=2))


def cold_start(config: EstimatorConfig, pose: Pose, samples: int, speed: float = 0.0, seed: int = 0) -> Scores:
    """Return the scores (samples, n) from `init` of bodies at poses (n,), at rest or leaving them at a speed in m/s.

    Each moves in a random direction. Raises ModelError for no sample.
    """
    rng, n = np.random.default_rng(seed), len(pose.X)
    heading = rng.uniform(0, 2 * np.pi, n)

    def at(k: int) -> Pose:
        return pose.displaced(speed * k * estimator_ensemble.TIME.period_s, heading)

    state = sampling.initial_states(estimator_ensemble.compile_estimator(config), n)
    return estimator_ensemble.track_scores(config, state, at, samples, rng)


def in_pitch(bodies: int, samples: int = cold_starts.SAMPLES, seed: int = 1) -> ColdStart:
    """Return the result from `init` of bodies at rest in the counted pitch, of the two sensors that ship."""
    rng, array = np.random.default_rng(seed), hall.array()
    pose = cold_starts.in_pitch(bodies, rng, tracking.valid_yaw_limit(hall.TUNING))
    of = World(lambda at: motions.volts(array, at), len(array.positions))
    controller = estimator_ensemble.compile_estimator(EstimatorConfig(array))
    return cold_starts.start(controller, of, pose, samples, rng)
