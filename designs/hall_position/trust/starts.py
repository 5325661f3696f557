"""Starts of the estimate: how far off corrections lead to the truth, and how long it takes from `init` to a valid one.

A body rests and the estimate starts elsewhere, as in operation but not certain. Within the first sample corrections
lead to the truth, or elsewhere: to another minimum, where residuals are large, or to another place with the same
voltages. Samples later the estimate has searched. None may be valid away from the truth, ever.

From `init` on the search begins at one point after another of a sequence that fills the pitch, PATIENCE samples at
each. Three sensors tell all places apart. Two do not: a body at rest is found, but its place is certain only in a part
of the pitch; one that moves comes to such a part.
"""

from dataclasses import dataclass

import numpy as np

from designs.hall_position.trust import estimator_ensemble
from designs.hall_position.trust.estimator_ensemble import EstimatorConfig
from models import hall_motions as motions
from models.hall_motions import Numbers, Pose
from synth import numeric
from synth.simulate import ensemble
from synth.simulate.ensemble import Scores
from synth.statespace import readonly

MAX_DISTANCE, MAX_YAW = 0.5, np.radians(10)  # of the pitch, and rad, that starts are off at most
BINS = (8, 4)  # of these
DIRECTIONS, RINGS, NEAR = 8, 16, 0.125  # of starts about a place; distances up to this part of the pitch


@dataclass(frozen=True, eq=False)
class Basin:
    """Starts off by up to `off` (n,) in m and `turned` (m,) in rad: shares (n, m) that lead to the truth.

    `first` in the first sample, `then` in the last one, NaN where there was no start. Of all `samples` of all bodies
    `wrong` were valid elsewhere.
    """

    off: Numbers
    turned: Numbers
    first: Numbers
    last: Numbers
    samples: int
    wrong: int


def basin(kind: EstimatorConfig, bodies: int, yaw: float, samples: int = 60, seed: int = 0) -> Basin:
    """Return where starts lead about places anywhere in the pitch, at yaws in rad of up to `yaw` to either side.

    Raises ModelError for no body or sample, or a yaw that is none.
    """
    rng, pitch = np.random.default_rng(seed), kind.array.pitch
    pose = motions.random_poses(kind.array, bodies, yaw, rng)
    off, turned = MAX_DISTANCE * pitch * rng.random(bodies), MAX_YAW * rng.random(bodies)
    start = pose.displaced(off, rng.uniform(0, 2 * np.pi, bodies), turned * rng.choice([-1, 1], bodies))
    scores = estimator_ensemble.track_scores(
        kind, estimator_ensemble.states_at(kind, start, resolved=False), motions.course_at_rest(pose), samples, rng
    )
    edges = [MAX_DISTANCE * pitch * np.arange(BINS[0] + 1) / BINS[0], MAX_YAW * np.arange(BINS[1] + 1) / BINS[1]]
    every, _, _ = np.histogram2d(off, turned, edges)
    led = [np.histogram2d(off[right], turned[right], edges)[0] for right in scores.right[[0, -1]]]
    with np.errstate(invalid="ignore"):
        first, last = (readonly(good / every) for good in led)
    return Basin(readonly(edges[0][1:]), readonly(edges[1][1:]), first, last, bodies * samples, int(scores.wrong.sum()))


def capture_radius(kind: EstimatorConfig, points: int, seed: int = 0) -> Numbers:
    """Return how far all starts about a place may be off at yaw 0 to lead to it in the first sample, (points, points).

    In m, over X and Y of the pitch. Raises ModelError for no point.
    """
    rng, pitch = np.random.default_rng(seed), kind.array.pitch
    along = pitch * np.arange(numeric.whole("the number of points", points)) / points
    rings = NEAR * pitch * np.arange(1, RINGS + 1) / RINGS
    X, Y, d, h = np.meshgrid(along, along, rings, 2 * np.pi * np.arange(DIRECTIONS) / DIRECTIONS, indexing="ij")
    pose = Pose(X.ravel(), Y.ravel(), np.zeros(X.size))
    state = estimator_ensemble.states_at(kind, pose.displaced(d.ravel(), h.ravel()), resolved=False)
    right = (
        estimator_ensemble.track_scores(kind, state, motions.course_at_rest(pose), 1, rng)
        .right.reshape(X.shape)
        .all(axis=3)
    )
    return readonly(rings[0] * np.cumprod(right, axis=2).sum(axis=2))


def cold_start(kind: EstimatorConfig, pose: Pose, samples: int, speed: float = 0.0, seed: int = 0) -> Scores:
    """Return the scores (samples, n) from `init` of bodies that are at poses (n,), or leave them at a speed in m/s.

    Each goes in a direction of its own. Raises ModelError for no sample.
    """
    rng, n = np.random.default_rng(seed), len(pose.X)
    heading = rng.uniform(0, 2 * np.pi, n)

    def at(k: int) -> Pose:
        return pose.displaced(speed * k * estimator_ensemble.TIME.period_s, heading)

    return estimator_ensemble.track_scores(
        kind, ensemble.started(estimator_ensemble.compile_estimator(kind), n), at, samples, rng
    )
