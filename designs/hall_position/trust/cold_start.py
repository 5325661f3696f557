"""From `init` to a valid estimate: how many samples, anywhere in the pitch, at yaws within those that are assumed.

The search begins at one point after another of a sequence that fills the pitch, PATIENCE samples at each. Three sensors
tell all places apart. Two do not: a body at rest is found, but its place is certain only in a part of the pitch; one
that moves comes to such a part.
"""

from dataclasses import dataclass

import numpy as np

from designs.hall_position.accuracy import layouts
from designs.hall_position.trust import fleet
from designs.hall_position.trust.fleet import Kind
from designs.hall_position.trust.motions import Numbers, Pose
from synth import numeric
from synth.errors import ModelError
from synth.statespace import readonly


@dataclass(frozen=True, eq=False)
class ColdStart:
    """Poses (n, 3) in m and rad, and how many samples each took until it was valid (n,), 0 for never.

    `found` (n,): whether the last estimate is the place, valid or not. Of all `samples` `wrong` were valid elsewhere.
    """

    poses: Numbers
    took: Numbers
    found: Numbers
    samples: int
    wrong: int

    @property
    def valid(self) -> float:
        """Return the share that became valid."""
        return float((self.took > 0).mean())


def grid(kind: Kind, points: int, yaws: Numbers) -> Pose:
    """Return poses over the whole pitch, points^2 at each of the yaws in rad.

    Raises ModelError for no point, or yaws that are none or not finite.
    """
    yaws = numeric.table("the yaws", np.reshape(yaws, (-1, 1)), 1)[:, 0]
    return Pose(*layouts.poses(kind.array.pitch, points, yaws))


def run(kind: Kind, pose: Pose, samples: int, speed: float = 0.0, seed: int = 0) -> ColdStart:
    """Start bodies that are at poses (n,), or leave them at a speed in m/s in any direction.

    Raises ModelError for no sample or pose, or figures that are not finite.
    """
    samples, speed = numeric.whole("the number of samples", samples), numeric.number("the speed", speed)
    pose = _checked(pose)
    rng, n = np.random.default_rng(seed), len(pose.X)
    heading = rng.uniform(0, 2 * np.pi, n)

    def at(k: int) -> Pose:
        gone = speed * k * kind.time.period_s
        return Pose(pose.X + gone * np.cos(heading), pose.Y + gone * np.sin(heading), pose.yaw)

    took, wrong, found = np.zeros(n, int), 0, np.zeros(n, bool)
    for i, (_, seen) in enumerate(fleet.followed(kind, fleet.unplaced(kind, n), at, samples, rng)):
        took = np.where((took == 0) & seen.valid, i + 1, took)
        found = seen.deviations.max(axis=0) <= fleet.WRONG
        wrong += int(seen.wrong.sum())
    poses = readonly(np.column_stack([pose.X, pose.Y, pose.yaw]))
    return ColdStart(poses, readonly(took), readonly(found), n * samples, wrong)


def _checked(pose: Pose) -> Pose:
    shapes = [np.shape(v) for v in (pose.X, pose.Y, pose.yaw)]
    if len(shapes[0]) != 1 or len(set(shapes)) > 1:
        raise ModelError(f"X, Y and the yaw of the poses have the shapes {shapes}: give as many of each, (n,)")
    return Pose(*numeric.table("the poses", np.column_stack([pose.X, pose.Y, pose.yaw]), 3).T)
