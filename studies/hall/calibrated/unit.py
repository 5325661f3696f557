"""A stage as built: matrix, places, gains and angles of its sensors, and its scan with a reference measurement.

The reference is an interferometer with three axes. The scan stops at the points of a grid of SPACING within REACH, as
near as the loop comes, at each of YAWS, and averages AVERAGED samples there. What is held out are random poses.
"""

from dataclasses import dataclass
from functools import cache
from itertools import product

import numpy as np

from designs.hall_position.glsdc import channels
from designs.hall_position.protected import config
from models.hall_motions import Numbers
from studies.hall import built_matrix
from studies.hall.built_matrix import Mounting
from studies.hall.hall_bench import Bench
from studies.hall.protected import trust
from synth.signals import signal_names
from synth.statespace import readonly
from synth.synthesise.identify.logs import Log

REFERENCES = {"X": 1e-6, "Y": 1e-6, "yaw": 1e-5}  # m, m, rad: standard deviations of the reference
AVERAGED = 8  # samples at a point of the scan
NOISE = config.array().deviation / AVERAGED**0.5  # V, of a mean
REACH, SPACING, YAWS, YAW_JITTER = 0.036, 2.4e-3, (-0.16, 0.0, 0.16), 0.005  # m, m, rad, rad
HELD_OUT = 1000  # poses
TOLERANCES = built_matrix.Tolerances


@dataclass(frozen=True, eq=False)
class Unit:
    """A stage: its bench, with the sensors as they are mounted, for the estimator of a name."""

    bench: Bench
    name: str = config.NAME

    @property
    def readings(self) -> dict[str, float]:
        """The names of the voltages, with the standard deviations of their means, V."""
        return dict.fromkeys(signal_names(channels.voltages(len(self.bench.places))), NOISE)

    def read(self, poses: Numbers) -> Numbers:
        """Return the voltages (N, sensors, 2) at poses (N, 3), without noise."""
        return trust.static_voltages(self.bench, np.ascontiguousarray(poses, np.float64))


@cache
def draw(field: str, seed: int, name: str = config.NAME) -> Unit:
    """Return a unit in the fabricated field, or as built with the tolerances of `trust`; others have other seeds."""
    places, rng = np.array(config.array(name).positions), np.random.default_rng(1000 + seed)
    size = 1.0 if field == "built" else 0.0
    placed = places + size * trust.PLACE * rng.uniform(-1, 1, places.shape)
    tolerances = TOLERANCES(seed=seed) if size else TOLERANCES(0.0, 0.0, 0.0)
    gains = 1 + size * trust.GAIN * rng.uniform(-1, 1, places.shape)
    angles = size * trust.ANGLE * rng.uniform(-1, 1, len(places))
    mountings = tuple(Mounting((float(x), float(y)), float(e)) for (x, y), e in zip(gains, angles, strict=True))
    return Unit(Bench(tuple(map(tuple, placed)), tolerances, mountings=mountings), name)


@cache
def scan(unit: Unit, seed: int = 0) -> Log:
    """Return the scan of the calibration."""
    rng, along = np.random.default_rng(seed), np.arange(-REACH, REACH + SPACING / 2, SPACING)
    points = np.array([(x, y, turn) for turn, x, y in product(YAWS, along, along)])
    jitter = rng.uniform(-1, 1, points.shape) * [SPACING / 2, SPACING / 2, YAW_JITTER]
    limits = np.array([REACH, REACH, YAWS[-1] + YAW_JITTER])
    return measure(unit, np.clip(points + jitter, -limits, limits), rng)


@cache
def held_out(unit: Unit, seed: int = 1, poses: int = HELD_OUT) -> Log:
    """Return readings at random poses, for residuals that the calibration has not seen."""
    rng = np.random.default_rng(seed)
    return measure(unit, rng.uniform(-1, 1, (poses, 3)) * [trust.REACH, trust.REACH, trust.YAW], rng)


def measure(unit: Unit, poses: Numbers, rng: np.random.Generator) -> Log:
    """Return means of the voltages at poses (N, 3), with the reference's measurement of these."""
    exact, names = unit.read(poses), list(unit.readings)
    V = exact + NOISE * rng.standard_normal(exact.shape)
    reference = poses + np.array(list(REFERENCES.values())) * rng.standard_normal(poses.shape)
    columns = dict(zip(REFERENCES, reference.T, strict=True))
    return Log({n: readonly(v) for n, v in (columns | dict(zip(names, V.reshape(len(V), -1).T, strict=True))).items()})
