"""Random motion without end: how fast a body may be, by derivation, and that the estimate stays with it.

A sample expects the last motion m, m <- m + follow e, e = d - m the correction, in rad of phase of the sensors' centre.

    speed           m is kept within reach / 2 along each axis:                 w v T <= reach / 2
    acceleration    e <- (1 - follow) e + w a T^2, so that |e| <= w |a| T^2 / follow, and a motion from a certain place
                    is one that a body makes while alpha sqrt(damping) |e| <= surprise deviation

For 800 Hz and the tuning that ships the first is 3.23 m/s along each axis. Of the second, 77.9 m/s^2 in the plane,
MARGIN is left to the noise and to yaws, which move the sensors by their mean arm: 39.0 m/s^2. At all of it one body in
fifty is lost with three sensors in 1500 samples.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from math import log, pi, sqrt

import numpy as np

from designs.hall_position.glsdc import tracking
from designs.hall_position.trust import fleet
from designs.hall_position.trust.fleet import Course, Kind
from designs.hall_position.trust.motions import Numbers, Pose
from synth import numeric
from synth.check import Check

MARGIN = 0.5  # of the acceleration
FAR = 1000  # pitches: motions at the limits lead further than what ships counts
WORST = 1e-4  # m: ten deviations at the worst place where an estimate is valid
WAVES, SPREAD = 3, (0.2, 1.0)  # sines along each axis, and their frequencies
SLOWEST, GENTLEST = 1e-3, 0.1  # parts of the speed, and of the acceleration by that: bodies creep as well
YAW, SWINGS = 0.03, (0.1, 3.0)  # rad, Hz
PART = 0.95  # of the yaws that are declared


@dataclass(frozen=True)
class Limits:
    """Speed along each axis, m/s, acceleration in the plane, m/s^2, and yaws to either side, rad."""

    speed: float
    acceleration: float
    yaw: float = YAW


@dataclass(frozen=True)
class Endurance:
    """What came of so many samples: the shares that are valid, and of bodies that have `lost` their place.

    `wrong` were valid elsewhere; `worst` is the largest error of the valid ones, m, `off` of all, within the pitch.
    """

    limits: Limits
    samples: int
    valid: float
    lost: float
    wrong: int
    worst: float
    off: float


def checks(name: str, kind: Kind, bodies: int, samples: int) -> list[Check]:
    """Check that no body is lost, and none wrong, within the limits."""
    found = run(kind, bodies, samples, limits(kind))
    within = f"{found.limits.speed:.3g} m/s, {found.limits.acceleration:.3g} m/s^2, {found.samples} samples"
    about = f"{within}, {100 * found.valid:.3g} % valid"
    what = f"{name}, random motion"
    return [
        Check(f"{what}: bodies lost", found.lost, 0, "1", about),
        Check(f"{what}: samples valid elsewhere", found.wrong, 0, "1", about),
        Check(f"{what}: worst valid position", found.worst, WORST, "m", about),
    ]


def limits(kind: Kind) -> Limits:
    """Return how fast the sensors' centre may be, with MARGIN."""
    t, a, T = kind.tuning, kind.array, kind.time.period_s
    e = t.surprise * a.deviation / (a.alpha * sqrt(t.damping))
    speed, acceleration = t.reach / 2 / (a.wave_number * T), (1 - MARGIN) * t.follow * e / (a.wave_number * T**2)
    return Limits(speed, acceleration, PART * tracking.valid_yaw_limit(a, t))


def run(kind: Kind, bodies: int, samples: int, within: Limits, seed: int = 0) -> Endurance:
    """Run so many bodies for so many samples on random motions within a limit; pitches are counted to FAR.

    Half of the bodies come to the limit, the others to parts of it that are drawn down to SLOWEST.

    Raises ModelError for no sample, and as `motion`.
    """
    kind = replace(kind, tuning=replace(kind.tuning, pitches=FAR))
    rng = np.random.default_rng(seed)
    at = motion(kind, bodies, within, rng, SLOWEST)
    state = fleet.moving(kind, at)
    valid = wrong = 0
    worst = off = 0.0
    for batch, seen in fleet.followed(kind, state, at, samples, rng):
        state = batch.states
        valid, wrong = valid + int(seen.valid.sum()), wrong + int(seen.wrong.sum())
        worst, off = max(worst, float(seen.off[seen.valid].max(initial=0))), max(off, float(seen.off.max()))
    lost = float((state["estimator_restarted"] > 0).mean())
    return Endurance(within, bodies * samples, valid / (bodies * samples), lost, wrong, worst, off)


def motion(kind: Kind, bodies: int, within: Limits, rng: np.random.Generator, slowest: float = 1.0) -> Course:
    """Return where bodies are at a sample, on random sines whose speed and acceleration do not exceed a limit.

    Every other body is slower, by a part that is drawn down to `slowest`. Yaws swing within the limit.

    Raises ModelError for no body, or a limit that is not positive.
    """
    bodies = numeric.whole("the number of bodies", bodies)
    for name in ("speed", "acceleration", "yaw"):
        numeric.positive(f"the {name} that is the limit", getattr(within, name))
    middle = rng.uniform(0, kind.array.pitch, (2, bodies))
    every = np.arange(bodies) % 2
    part = np.exp(every * rng.uniform(log(slowest), 0, bodies))
    gentle = part * np.exp(every * rng.uniform(log(max(slowest, GENTLEST)), 0, bodies))
    along = [_sines(bodies, part * within.speed, gentle * within.acceleration / sqrt(2), rng) for _ in "xy"]
    yaw = rng.uniform(-within.yaw, within.yaw, bodies)
    swing = (within.yaw - np.abs(yaw)) * rng.random(bodies)
    rate, phase = 2 * pi * np.exp(rng.uniform(log(SWINGS[0]), log(SWINGS[1]), bodies)), rng.uniform(0, 2 * pi, bodies)

    def at(k: int) -> Pose:
        t = k * kind.time.period_s
        return Pose(middle[0] + along[0](t), middle[1] + along[1](t), yaw + swing * np.sin(rate * t + phase))

    return at


def _sines(bodies: int, speed: Numbers, acceleration: Numbers, rng: np.random.Generator) -> Callable[[float], Numbers]:
    """Return displacements (bodies,) over time whose speed and acceleration reach these where all sines agree."""
    part, rate = rng.dirichlet([1.0] * WAVES, bodies).T, rng.uniform(*SPREAD, (WAVES, bodies))
    rate *= acceleration / speed / (part * rate).sum(axis=0)
    phase = rng.uniform(0, 2 * pi, (WAVES, bodies))
    return lambda t: (speed * part / rate * np.sin(rate * t + phase)).sum(axis=0)
