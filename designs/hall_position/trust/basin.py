"""How far a start may be off so that five corrections lead to the truth, and what is flagged where they do not.

A body rests; the estimate starts elsewhere, as in operation but not certain. Within the first sample corrections lead
to the truth, or elsewhere: to another minimum, where residuals are large, or to another place with the same voltages.
Samples later the estimate has searched. None may be valid away from the truth, ever.
"""

from dataclasses import dataclass

import numpy as np

from designs.hall_position.trust import fleet
from designs.hall_position.trust.fleet import Kind
from designs.hall_position.trust.motions import Numbers, Pose
from synth import numeric
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
class Reach:
    """Over X and Y (n,) in m: how far all starts about a place, (n, n) in m, lead to it in the first sample."""

    X: Numbers
    Y: Numbers
    reach: Numbers


def mapped(kind: Kind, bodies: int, yaw: float, samples: int = 60, seed: int = 0) -> Basin:
    """Return where starts lead about places anywhere in the pitch, at yaws in rad of up to `yaw` to either side.

    Raises ModelError for no body or sample, or a yaw that is none.
    """
    samples = numeric.whole("the number of samples", samples)
    rng, pitch = np.random.default_rng(seed), kind.array.pitch
    pose = fleet.anywhere(kind, bodies, yaw, rng)
    off, turned = FAR * pitch * rng.random(bodies), TURNED * rng.random(bodies)
    start = _off(pose, off, rng.uniform(0, 2 * np.pi, bodies), turned * rng.choice([-1, 1], bodies))
    state, right, wrong = fleet.placed(kind, start, certain=False), [], 0
    for _, seen in fleet.followed(kind, state, lambda k: pose, samples, rng):
        right.append(seen.deviations.max(axis=0) <= fleet.WRONG)
        wrong += int(seen.wrong.sum())
    edges = [FAR * pitch * np.arange(BINS[0] + 1) / BINS[0], TURNED * np.arange(BINS[1] + 1) / BINS[1]]
    first, then = (_shares(off, turned, now, edges) for now in (right[0], right[-1]))
    return Basin(readonly(edges[0][1:]), readonly(edges[1][1:]), first, then, bodies * samples, wrong)


def over_pitch(kind: Kind, points: int, yaw: float = 0.0, seed: int = 0) -> Reach:
    """Return how far starts at the right yaw may be off, on a grid of places over the pitch.

    Raises ModelError for no point, or a yaw that is not finite.
    """
    points, yaw = numeric.whole("the number of points", points), numeric.number("the yaw", yaw)
    rng, pitch = np.random.default_rng(seed), kind.array.pitch
    along = pitch * np.arange(points) / points
    rings = NEAR * pitch * np.arange(1, RINGS + 1) / RINGS
    X, Y, d, h = np.meshgrid(along, along, rings, 2 * np.pi * np.arange(DIRECTIONS) / DIRECTIONS, indexing="ij")
    pose = Pose(X.ravel(), Y.ravel(), np.full(X.size, yaw))
    state = fleet.placed(kind, _off(pose, d.ravel(), h.ravel(), np.zeros(X.size)), certain=False)
    seen = fleet.judged(kind, fleet.stepped(kind, state, fleet.voltages(kind, pose, rng)).outputs, pose)
    right = (seen.deviations.max(axis=0) <= fleet.WRONG).reshape(X.shape).all(axis=3)
    return Reach(readonly(along), readonly(along), readonly(rings[0] * np.cumprod(right, axis=2).sum(axis=2)))


def _off(pose: Pose, by: Numbers, heading: Numbers, turned: Numbers) -> Pose:
    return Pose(pose.X + by * np.cos(heading), pose.Y + by * np.sin(heading), pose.yaw + turned)


def _shares(off: Numbers, turned: Numbers, right: Numbers, edges: list[Numbers]) -> Numbers:
    every, _, _ = np.histogram2d(off, turned, edges)
    good, _, _ = np.histogram2d(off[right], turned[right], edges)
    with np.errstate(invalid="ignore"):
        return readonly(good / every)
