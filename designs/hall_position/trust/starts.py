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
from numpy.typing import NDArray

from designs.hall_position.trust import fleet
from designs.hall_position.trust.fleet import Kind
from designs.hall_position.trust.motions import Each, Numbers, Pose
from synth import numeric
from synth.simulate import ensemble
from synth.statespace import readonly

FAR, TURNED = 0.5, np.radians(10)  # of the pitch, and rad, that starts are off at most
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
    then: Numbers
    samples: int
    wrong: int


@dataclass(frozen=True, eq=False)
class ColdStart:
    """How many samples each body took until it was valid (N,), 0 for never; whether the last estimate is its place.

    Of all samples `wrong` were valid elsewhere.
    """

    took: NDArray[np.int_]
    found: NDArray[np.bool_]
    wrong: int

    @property
    def valid(self) -> float:
        """Return the share that became valid."""
        return float((self.took > 0).mean())


def basin(kind: Kind, bodies: int, yaw: float, samples: int = 60, seed: int = 0) -> Basin:
    """Return where starts lead about places anywhere in the pitch, at yaws in rad of up to `yaw` to either side.

    Raises ModelError for no body or sample, or a yaw that is none.
    """
    rng, pitch = np.random.default_rng(seed), kind.array.pitch
    pose = fleet.anywhere(kind, bodies, yaw, rng)
    off, turned = FAR * pitch * rng.random(bodies), TURNED * rng.random(bodies)
    start = _off(pose, off, rng.uniform(0, 2 * np.pi, bodies), turned * rng.choice([-1, 1], bodies))
    state = fleet.placed(kind, start, certain=False)
    seen = ensemble.stacked([scores for _, scores in fleet.followed(kind, state, lambda k: pose, samples, rng)])
    edges = [FAR * pitch * np.arange(BINS[0] + 1) / BINS[0], TURNED * np.arange(BINS[1] + 1) / BINS[1]]
    every, _, _ = np.histogram2d(off, turned, edges)
    led = [np.histogram2d(off[right], turned[right], edges)[0] for right in (seen.right[0], seen.right[-1])]
    with np.errstate(invalid="ignore"):
        first, then = (readonly(good / every) for good in led)
    return Basin(readonly(edges[0][1:]), readonly(edges[1][1:]), first, then, bodies * samples, int(seen.wrong.sum()))


def reach(kind: Kind, points: int, seed: int = 0) -> Numbers:
    """Return how far all starts about a place may be off at yaw 0 to lead to it in the first sample, (points, points).

    In m, over X and Y of the pitch. Raises ModelError for no point.
    """
    rng, pitch = np.random.default_rng(seed), kind.array.pitch
    along = pitch * np.arange(numeric.whole("the number of points", points)) / points
    rings = NEAR * pitch * np.arange(1, RINGS + 1) / RINGS
    X, Y, d, h = np.meshgrid(along, along, rings, 2 * np.pi * np.arange(DIRECTIONS) / DIRECTIONS, indexing="ij")
    pose = Pose(X.ravel(), Y.ravel(), np.zeros(X.size))
    state = fleet.placed(kind, _off(pose, d.ravel(), h.ravel()), certain=False)
    ((_, seen),) = fleet.followed(kind, state, lambda k: pose, 1, rng)
    right = seen.right.reshape(X.shape).all(axis=3)
    return readonly(rings[0] * np.cumprod(right, axis=2).sum(axis=2))


def cold_start(kind: Kind, pose: Pose, samples: int, speed: float = 0.0, seed: int = 0) -> ColdStart:
    """Start bodies that are at poses (n,), or leave them at a speed in m/s in any direction.

    Raises ModelError for no sample.
    """
    rng, n = np.random.default_rng(seed), len(pose.X)
    heading = rng.uniform(0, 2 * np.pi, n)

    def at(k: int) -> Pose:
        return _off(pose, speed * k * kind.time.period_s, heading)

    state = ensemble.started(fleet.compiled(kind), n)
    seen = ensemble.stacked([scores for _, scores in fleet.followed(kind, state, at, samples, rng)])
    took = np.where(seen.valid.any(axis=0), 1 + seen.valid.argmax(axis=0), 0)
    return ColdStart(took, seen.right[-1], int(seen.wrong.sum()))


def _off(pose: Pose, by: Each, heading: Numbers, turned: Each = 0.0) -> Pose:
    return Pose(pose.X + by * np.cos(heading), pose.Y + by * np.sin(heading), pose.yaw + turned)
