"""How often an estimate of three or four sensors is valid, and valid and wrong, over unknown fields and faults.

    own         the field of the model                     calibrated   the same, and RESIDUAL V rms in each voltage
    fabricated  the finite matrix of fabricated blocks     built        the same with remanence +-2 %, tilt +-1 deg and
                                                                        place +-0.1 mm of blocks; places of sensors
                                                                        +-0.1 mm, their angles +-1 deg, gains +-1 %

The amplitude is anywhere within +-10 %. Bodies rest, or move at up to SPEED, tracked from the start. After BEFORE
samples a sensor fails (`faults`). `wrong` is an error above 0.5 mm or 20 mrad.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cache, lru_cache

import numpy as np
from numpy.typing import NDArray

from designs.hall_position.config import TIME
from designs.hall_position.glsdc.estimator import SURROGATE_ERROR
from designs.hall_position.protected import config
from designs.hall_position.protected.parameters import Tuning
from models import hall_motions as motions
from models.hall_motions import Numbers, Pose
from studies.hall import built_matrix, hall_bench
from studies.hall.protected import faults
from synth.errors import ModelError
from synth.execute import host
from synth.statespace import Array

WRONG, WRONG_YAW, SIGMAS = 5e-4, 0.02, 4.0  # m, rad, deviations
FIELDS = ("own", "calibrated", "fabricated", "built")
RESIDUAL = 4e-3  # V rms
AMPLITUDE, GAIN, ANGLE, PLACE = 0.1, 0.01, np.radians(1), 1e-4  # relative, relative, rad, m
REACH, YAW, SPEED = 0.035, 0.16, 0.2  # m, rad, m/s
BEFORE, AFTER, SEEDS = 4, 40, 3  # samples, samples, matrices as built
AXES = ("X", "Y", "yaw")
OUTCOME = (
    "valid %, valid and wrong % of samples, of bodies, rms/deviation of X and Y, of yaw, beyond 4 deviations %, um"
)
KEPT = 64  # sets of voltages, of a few runs over the same poses


@dataclass(frozen=True)
class Outcome:
    """Shares of samples that are `valid`, and that are valid and `wrong`, and of bodies that were ever so.

    Of valid samples `ratio` is the rms error over the deviation of X and Y, `yaw_ratio` that of the yaw, `beyond` the
    share of errors above SIGMAS deviations, and `error` the largest error of a position, m.
    """

    valid: float
    wrong: float
    wrong_bodies: float
    ratio: float
    yaw_ratio: float
    beyond: float
    error: float

    def __str__(self) -> str:
        """Return the numbers as OUTCOME says."""
        shares = f"{100 * self.valid:7.2f} {100 * self.wrong:7.3f} {100 * self.wrong_bodies:7.3f}"
        return f"{shares} {self.ratio:5.2f} {self.yaw_ratio:5.2f} {100 * self.beyond:6.3f} {1e6 * self.error:7.0f}"


@dataclass(frozen=True, eq=False)
class World:
    """Bodies (N,) in a field: how to read the voltages (N, sensors, 2) at their poses."""

    read: Callable[[Pose], Numbers]
    sensors: int


@dataclass(frozen=True, eq=False)
class Samples:
    """Samples (k, N) that are `valid`, with errors, deviations and protection levels (k, N, 3) of X, Y, m, and yaw."""

    valid: Numbers
    errors: Numbers
    deviations: Numbers
    levels: Numbers

    @property
    def error(self) -> Numbers:
        """The distances (k, N) from the true position, m."""
        return np.hypot(self.errors[..., 0], self.errors[..., 1])

    def outcome(self) -> Outcome:
        """Return the shares of the samples and of the bodies."""
        wrong = self.valid & is_wrong(self.errors)
        squares = (self.errors[self.valid] / self.deviations[self.valid]) ** 2
        return Outcome(
            valid=float(self.valid.mean()),
            wrong=float(wrong.mean()),
            wrong_bodies=float(wrong.any(axis=0).mean()),
            ratio=float(np.sqrt(squares[:, :2].mean())) if squares.size else 0.0,
            yaw_ratio=float(np.sqrt(squares[:, 2].mean())) if squares.size else 0.0,
            beyond=float((squares > SIGMAS**2).mean()) if squares.size else 0.0,
            error=float(self.error[self.valid].max(initial=0.0)),
        )


def is_wrong(errors: Numbers) -> Numbers:
    """Return which errors (.., 3) of X, Y and yaw count as wrong."""
    return np.asarray((np.hypot(errors[..., 0], errors[..., 1]) > WRONG) | (np.abs(errors[..., 2]) > WRONG_YAW))


@cache
def compile_estimator(tuning: Tuning, name: str = config.NAME) -> host.Controller:
    """Return the estimator's C in single precision; C that does not ship calls sinf and cosf of the C library."""
    if tuning != config.TUNINGS[name]:
        return host.compile_block(config.block(tuning, name), np.float32, libm=True)
    return host.compile_block(config.block(tuning, name), np.float32, error=SURROGATE_ERROR[np.float32])


def world(field: str, bodies: int, rng: np.random.Generator, name: str = config.NAME) -> World:
    """Return bodies in a field with the sensors of an estimator; raise ModelError for an unknown field."""
    if field not in FIELDS:
        raise ModelError(f"'{field}' is not a known field: give one of {', '.join(FIELDS)}")
    array, scale = config.array(name), 1 + AMPLITUDE * rng.uniform(-1, 1, (bodies, 1, 1))
    sensors = len(array.positions)
    if field in ("own", "calibrated"):
        residual = (RESIDUAL if field == "calibrated" else 0.0) * rng.standard_normal((bodies, sensors, 2))
        return World(lambda pose: scale * motions.volts(array, pose) + residual, sensors)
    seeds = SEEDS if field == "built" else 1
    scale = scale * (1 + (GAIN if field == "built" else 0.0) * rng.uniform(-1, 1, (bodies, sensors, 2)))
    turn = (ANGLE if field == "built" else 0.0) * rng.uniform(-1, 1, (bodies, sensors))
    benches = [_bench(field, seed, name) for seed in range(seeds)]

    def read(pose: Pose) -> Numbers:
        poses, V = np.column_stack([pose.X, pose.Y, pose.yaw]), np.zeros((bodies, sensors, 2))
        for k, bench in enumerate(benches):
            V[k::seeds] = static_voltages(bench, np.ascontiguousarray(poses[k::seeds]))
        c, s = np.cos(turn), np.sin(turn)
        return scale * np.stack([c * V[..., 0] - s * V[..., 1], s * V[..., 0] + c * V[..., 1]], axis=-1)

    return World(read, sensors)


def static_voltages(bench: hall_bench.Bench, poses: Numbers) -> Numbers:
    """Return the voltages (N, sensors, 2) at poses (N, 3), without noise; the last ones serve other faults, too."""
    return _static_voltages(bench, poses.tobytes()).copy()


@lru_cache(KEPT)
def _static_voltages(bench: hall_bench.Bench, poses: bytes) -> Numbers:
    at = np.frombuffer(poses).reshape(-1, 3)
    return np.asarray(hall_bench.static_voltages(bench, at).reshape(len(at), -1, 2))


@cache
def _bench(field: str, seed: int, name: str) -> hall_bench.Bench:
    places, rng = np.array(config.array(name).positions), np.random.default_rng(seed)
    if field == "built":
        places = places + PLACE * rng.uniform(-1, 1, places.shape)
        return hall_bench.Bench(tuple(map(tuple, places)), built_matrix.Tolerances(seed=seed))
    return hall_bench.Bench(tuple(map(tuple, places)), built_matrix.Tolerances(0.0, 0.0, 0.0))


def run(
    tuning: Tuning,
    field: str,
    fault: str,
    bodies: int,
    speed: float = 0.0,
    seed: int = 0,
    name: str = config.NAME,
) -> Samples:
    """Return the samples after a fault of bodies that are tracked; raise ModelError for an unknown field or fault."""
    rng = np.random.default_rng(seed)
    of = world(field, bodies, rng, name)
    return simulate(compile_estimator(tuning, name), tuning, of, fault, bodies, speed, rng)


def simulate(
    controller: host.Controller,
    tuning: Tuning,
    of: World,
    fault: str,
    bodies: int,
    speed: float,
    rng: np.random.Generator,
    yaw: float = YAW,
) -> Samples:
    """Return the samples after a fault of bodies that are tracked; raise ModelError for an unknown fault.

    Yaws are up to `yaw` to either side, rad.
    """
    chosen = faults.find(fault)
    heading, sensor = rng.uniform(0, 2 * np.pi, bodies), rng.integers(of.sensors, size=bodies)
    travel = speed * (BEFORE + AFTER) * TIME.period_s
    start, other = draw(REACH - travel, bodies, rng, yaw), draw(REACH, bodies, rng, yaw)
    kept = of.read(other)[np.arange(bodies), sensor]  # of a sensor that is stuck where it was before
    failure = faults.Failure(chosen, sensor, _second(bodies, rng), kept)
    states, outcomes = tracking_states(controller, tuning, start, speed, heading), []
    rest = of.read(start) if speed == 0 else None
    for k in range(BEFORE + AFTER):
        pose = start.displaced(speed * k * TIME.period_s, heading)
        V = of.read(pose) if rest is None else rest
        V = V + config.array().deviation * rng.standard_normal(V.shape)
        if k >= BEFORE:
            failure.corrupt(V, k - BEFORE)
        elif fault not in faults.LASTING:
            failure = replace(failure, kept=failure.of_sensor(V))
        batch = controller.batch(states, motions.by_input(np.clip(V, -faults.END, faults.END)))
        states = batch.states
        if k >= BEFORE:
            outcomes.append(_sample(batch.outputs, pose))
    return Samples(*(np.array(each) for each in zip(*outcomes, strict=True)))


def fail(fault: str, of: World, bodies: int, rng: np.random.Generator) -> faults.Failure:
    """Return a failure of a random sensor of each body; one that is stuck keeps its voltages at another place."""
    sensor, other = rng.integers(of.sensors, size=bodies), draw(REACH, bodies, rng)
    kept = of.read(other)[np.arange(bodies), sensor]
    return faults.Failure(faults.find(fault), sensor, _second(bodies, rng), kept)


def _second(bodies: int, rng: np.random.Generator) -> NDArray[np.int_]:
    """Draw which of the two voltages of a sensor fails (N,)."""
    return (rng.random(bodies) < 0.5).astype(int)


def draw(reach: float, bodies: int, rng: np.random.Generator, yaw: float = YAW) -> Pose:
    """Draw poses within `reach` m along X and Y, at yaws of up to `yaw` to either side, rad."""
    X, Y = rng.uniform(-reach, reach, (2, bodies))
    return Pose(X, Y, rng.uniform(-yaw, yaw, bodies))


def tracking_states(
    controller: host.Controller, tuning: Tuning, at: Pose, speed: float | Numbers, heading: Array
) -> host.Records:
    """Return the states of estimators that have tracked bodies up to poses."""
    array, states = config.array(), np.repeat(controller.init()[None], len(at.X))
    moved = speed * TIME.period_s * np.array([np.cos(heading), np.sin(heading)])
    for a, place, step in (("x", at.X, moved[0]), ("y", at.Y, moved[1])):
        turns = np.round(place / array.pitch)
        states[f"estimator_phase_{a}"] = states[f"metres_last_{a}"] = array.wave_number * (place - turns * array.pitch)
        states[f"metres_pitch_{a}"], states[f"estimator_motion_phase_{a}"] = turns, array.wave_number * step
    states["estimator_yaw"], states["estimator_start_number"], states["metres_counting"] = at.yaw, tuning.starts, 1
    names = states.dtype.names or ()
    tables = {"last_X": at.X, "last_Y": at.Y, "last_yaw": at.yaw, "motion_X": moved[0], "motion_Y": moved[1]}
    tables["aligned"] = np.ones(len(at.X))
    for name, value in tables.items():
        if f"calibration_{name}" in names:
            states[f"calibration_{name}"] = value
    return states


def _sample(outputs: Mapping[str, Numbers], pose: Pose) -> tuple[Numbers, Numbers, Numbers, Numbers]:
    """Return the fields of `Samples` for one sample."""
    deviations, levels = (
        np.stack([outputs[f"{prefix}_{a}"].astype(float) for a in AXES], axis=-1)
        for prefix in ("deviation", "protection")
    )
    return outputs["valid"] > 0, errors(outputs, pose), deviations, levels


def errors(outputs: Mapping[str, Numbers], pose: Pose) -> Numbers:
    """Return the errors (N, 3) of X, Y and yaw."""
    return np.stack([outputs[a].astype(float) - getattr(pose, a) for a in AXES], axis=-1)
