"""Known motions of the body, and what its sensors read on them by model (2), with noise.

    V_k = R(yaw)' B(P_k) + noise,    P_k = (X, Y) + R(yaw) r_k,    B_X = c + alpha sin(w X) + beta sin(5 w X)

in NumPy, apart from the expressions of the estimator.
"""

from dataclasses import dataclass
from math import pi
from string import ascii_lowercase
from typing import Any

import numpy as np
from numpy.typing import NDArray

from models.hall_array import Pair
from models.hall_two_waves import PlanarArray as Array

Numbers = NDArray[Any]
Each = float | Numbers  # one for all columns, or one for each
SETTING_OUT = 0.1  # s
HARMONICS, RATES = (1, 2, 3), (0.25, 0.75)  # of a motion, and its lowest frequencies, Hz


@dataclass(frozen=True, eq=False)
class Pose:
    """Where bodies are: X, Y in m and the yaw in rad, of one shape."""

    X: Numbers
    Y: Numbers
    yaw: Numbers

    def place(self, at: Pair) -> tuple[Numbers, Numbers]:
        """Return where a place in the body is, m."""
        (x, y), c, s = at, np.cos(self.yaw), np.sin(self.yaw)
        return self.X + c * x - s * y, self.Y + s * x + c * y

    def moved(self, by: Each, heading: Numbers, turned: Each = 0.0) -> "Pose":
        """Return poses so many m away in a direction, and turned, both in rad."""
        return Pose(self.X + by * np.cos(heading), self.Y + by * np.sin(heading), self.yaw + turned)


def volts(array: Array, pose: Pose) -> Numbers:
    """Return what sensors read at poses of any shape, (.., sensors, 2), V."""
    w, c, s = array.wave_number, np.cos(pose.yaw), np.sin(pose.yaw)
    found = []
    for place in array.positions:
        bx, by = (array.c + array.alpha * np.sin(w * p) + array.beta * np.sin(5 * w * p) for p in pose.place(place))
        found.append(np.stack([c * bx + s * by, c * by - s * bx], axis=-1))
    return np.stack(found, axis=-2)


def noisy(array: Array, pose: Pose, seed: int | np.random.Generator) -> Numbers:
    """Return the same with noise."""
    found = volts(array, pose)
    return found + array.deviation * np.random.default_rng(seed).standard_normal(found.shape)


def named(given: Numbers) -> dict[str, Numbers]:
    """Return voltages (.., sensors, 2) by the names of the inputs."""
    letters = ascii_lowercase[: given.shape[-2]]
    return {f"V_{letter}{axis}": given[..., k, i] for k, letter in enumerate(letters) for i, axis in enumerate("xy")}


def wander(period_s: float, shape: tuple[int, int], seed: int, travel: Each, yaw: Each, turn: Each = 0.0) -> Pose:
    """Return smooth random motions (n, columns) within `travel` m and `yaw` rad, and `turn` rad/s besides.

    They set out from rest. A travel of 0.3 m has speeds of 2 m/s, 2 mm a sample at 800 Hz, and accelerations of
    20 m/s^2.
    """
    rng, (n, columns) = np.random.default_rng(seed), shape
    t = period_s * np.arange(n)[:, np.newaxis]
    t = np.where(t < SETTING_OUT, t**2 / (2 * SETTING_OUT), t - SETTING_OUT / 2)

    def along(size: Each) -> Numbers:
        waves = [(1 / k, k * rng.uniform(*RATES, columns), rng.uniform(0, 2 * pi, columns)) for k in HARMONICS]
        return np.divide(size, 2) * np.sum([a * np.sin(2 * pi * f * t + p) for a, f, p in waves], axis=0)

    return Pose(along(travel), along(travel), along(yaw) + turn * t * rng.choice([-1, 1], columns))
