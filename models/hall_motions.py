"""Known motions of the body, and the voltages of its sensors by model (2), with noise.

    V_k = R(yaw)' B(P_k) + noise,    P_k = (X, Y) + R(yaw) r_k,    B_X = c + alpha sin(w X) + beta sin(5 w X)

in NumPy, independent of the estimator's expressions.
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import log, pi, sqrt
from string import ascii_lowercase
from typing import Any

import numpy as np
from numpy.typing import NDArray

from models.hall_array import Pair
from models.hall_two_waves import PlanarArray as Array
from synth import numeric
from synth.errors import ModelError
from synth.timing import Discrete

Numbers = NDArray[Any]
Point = tuple[float, float, float]  # X, Y in m and the yaw in rad
Each = float | Numbers  # a scalar, or one number for each column
START_TIME = 0.1  # s
WAVES, SPREAD = 3, (0.2, 1.0)  # sines along each axis, and their frequencies
GENTLEST = 0.1  # lower bound of the acceleration's factor
YAW, SWINGS = 0.03, (0.1, 3.0)  # rad, Hz
HARMONICS, RATES = (1, 2, 3), (0.25, 0.75)  # of a motion, and range of its lowest frequency, Hz


@dataclass(frozen=True, eq=False)
class Pose:
    """Poses of bodies: X, Y in m and the yaw in rad, of one shape."""

    X: Numbers
    Y: Numbers
    yaw: Numbers

    def place(self, at: Pair) -> tuple[Numbers, Numbers]:
        """Return the position of a point of the body, m."""
        (x, y), c, s = at, np.cos(self.yaw), np.sin(self.yaw)
        return self.X + c * x - s * y, self.Y + s * x + c * y

    def displaced(self, by: Each, heading: Numbers, rotation: Each = 0.0) -> "Pose":
        """Return poses displaced by a distance in m along a heading in rad, and turned in rad."""
        return Pose(self.X + by * np.cos(heading), self.Y + by * np.sin(heading), self.yaw + rotation)


Course = Callable[[int], Pose]  # from the number of a sample to the poses of the bodies


@dataclass(frozen=True)
class Limits:
    """Speed along each axis, m/s, acceleration in the plane, m/s^2, and yaws to either side, rad."""

    speed: float
    acceleration: float
    yaw: float = YAW


def random_poses(array: Array, n: int, yaw: float, rng: np.random.Generator) -> Pose:
    """Draw n poses over the pitch, at yaws in rad of up to `yaw` to either side.

    Raises ModelError unless n is a whole number above 0 and the yaw at least 0.
    """
    n = numeric.whole("the number of bodies", n)
    if numeric.number("the yaw", yaw) < 0:
        raise ModelError(f"the yaw is {yaw} rad: give its largest absolute value, at least 0")
    X, Y = rng.uniform(0, array.pitch, (2, n))
    return Pose(X, Y, rng.uniform(-yaw, yaw, n))


def course_at_rest(pose: Pose) -> Course:
    """Return the course of bodies at rest."""
    return lambda k: pose


def random_course(
    array: Array, time: Discrete, bodies: int, within: Limits, rng: np.random.Generator, slowest: float = 1.0
) -> Course:
    """Return a course of bodies on random sines, whose speed and acceleration stay within limits.

    Every other body is slower by a random factor down to `slowest`. Yaws oscillate within the limit.

    Raises ModelError for no body, or a limit that is not positive.
    """
    bodies = numeric.whole("the number of bodies", bodies)
    for name in ("speed", "acceleration", "yaw"):
        numeric.positive(f"the {name} that is the limit", getattr(within, name))
    middle = rng.uniform(0, array.pitch, (2, bodies))
    every = np.arange(bodies) % 2
    part = np.exp(every * rng.uniform(log(slowest), 0, bodies))
    gentle = part * np.exp(every * rng.uniform(log(max(slowest, GENTLEST)), 0, bodies))
    along = [_waves(bodies, part * within.speed, gentle * within.acceleration / sqrt(2), rng) for _ in "xy"]
    yaw = rng.uniform(-within.yaw, within.yaw, bodies)
    swing = (within.yaw - np.abs(yaw)) * rng.random(bodies)
    rate, phase = 2 * pi * np.exp(rng.uniform(log(SWINGS[0]), log(SWINGS[1]), bodies)), rng.uniform(0, 2 * pi, bodies)

    def at(k: int) -> Pose:
        t = k * time.period_s
        return Pose(middle[0] + along[0](t), middle[1] + along[1](t), yaw + swing * np.sin(rate * t + phase))

    return at


def _waves(bodies: int, speed: Numbers, acceleration: Numbers, rng: np.random.Generator) -> Callable[[float], Numbers]:
    """Return displacements (bodies,) over time that reach this speed and acceleration where all sines add up."""
    part, rate = rng.dirichlet([1.0] * WAVES, bodies).T, rng.uniform(*SPREAD, (WAVES, bodies))
    rate *= acceleration / speed / (part * rate).sum(axis=0)
    phase = rng.uniform(0, 2 * pi, (WAVES, bodies))
    return lambda t: (speed * part / rate * np.sin(rate * t + phase)).sum(axis=0)


def volts(array: Array, pose: Pose) -> Numbers:
    """Return the voltages at poses of any shape, (.., sensors, 2), V."""
    w, c, s = array.wave_number, np.cos(pose.yaw), np.sin(pose.yaw)
    sensor_volts = []
    for place in array.positions:
        bx, by = (array.c + array.alpha * np.sin(w * p) + array.beta * np.sin(5 * w * p) for p in pose.place(place))
        sensor_volts.append(np.stack([c * bx + s * by, c * by - s * bx], axis=-1))
    return np.stack(sensor_volts, axis=-2)


def noisy(array: Array, pose: Pose, seed: int | np.random.Generator) -> Numbers:
    """Return the voltages with the array's noise, (.., sensors, 2), V."""
    exact = volts(array, pose)
    return exact + array.deviation * np.random.default_rng(seed).standard_normal(exact.shape)


def by_input(voltages: Numbers) -> dict[str, Numbers]:
    """Return voltages (.., sensors, 2) by the names of the estimator's inputs."""
    letters = ascii_lowercase[: voltages.shape[-2]]
    return {f"V_{letter}{axis}": voltages[..., k, i] for k, letter in enumerate(letters) for i, axis in enumerate("xy")}


def rest_then_move(samples: int, rest: int, start: Point, displacement: Point) -> Pose:
    """Return poses (samples,) of a body that rests at a start, and then moves smoothly by a displacement."""
    progress = np.clip((np.arange(samples) - rest) / (samples - rest), 0, 1)
    along = progress - np.sin(2 * np.pi * progress) / (2 * np.pi)
    return Pose(*(begin + by * along for begin, by in zip(start, displacement, strict=True)))


def smooth_motions(
    period_s: float, shape: tuple[int, int], seed: int, travel: Each, yaw: Each, turn: Each = 0.0
) -> Pose:
    """Return smooth random motions (n, columns) within `travel` m and `yaw` rad, plus a rotation by `turn` rad/s.

    They start from rest. A travel of 0.3 m has speeds of 2 m/s, 2 mm a sample at 800 Hz, and accelerations of
    20 m/s^2.
    """
    rng, (n, columns) = np.random.default_rng(seed), shape
    t = period_s * np.arange(n)[:, np.newaxis]
    t = np.where(t < START_TIME, t**2 / (2 * START_TIME), t - START_TIME / 2)

    def along(size: Each) -> Numbers:
        waves = [(1 / k, k * rng.uniform(*RATES, columns), rng.uniform(0, 2 * pi, columns)) for k in HARMONICS]
        return np.divide(size, 2) * np.sum([a * np.sin(2 * pi * f * t + p) for a, f, p in waves], axis=0)

    return Pose(along(travel), along(travel), along(yaw) + turn * t * rng.choice([-1, 1], columns))
