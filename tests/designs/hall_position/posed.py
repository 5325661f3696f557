"""The estimator of six degrees of freedom over known motions: voltages in closed form, the emitted C, the reference."""

from collections.abc import Mapping
from functools import cache

import numpy as np

from designs.hall_position.accuracy import layouts
from designs.hall_position.glsdc import channels, six_estimator
from designs.hall_position.glsdc.parameters import SpatialTuning as Tuning
from designs.hall_position.reference_glsdc import Setup
from models import hall_two_waves
from models.hall_two_waves import SpatialArray as Array
from synth.block import Block, unranged
from synth.emit import write
from synth.execute import host
from synth.statespace import Array as Numbers
from synth.timing import Discrete
from tests.designs.hall_position import reference_six

TIME = Discrete(1 / 800)
L = 0.0508
ALPHA, BETA = 8.4 * 0.37502, -8.4 * 0.02146  # V: fabricated, 3 mm
ANY = Array(((0.0, 0.0, 0.0), (L, 0.0, 0.0), (0.0, L, 0.0)), ALPHA, BETA)
FOUR = hall_two_waves.with_positions(ANY, layouts.SPATIAL[4])
FIVE = hall_two_waves.with_positions(ANY, layouts.SPATIAL[5])
SIX = hall_two_waves.with_positions(ANY, layouts.SPATIAL[6])
USUAL = Tuning()

Columns = Mapping[str, Numbers]


@cache
def block(array: Array, tuning: Tuning = USUAL) -> Block:
    return unranged(six_estimator.guarded_estimator(array, TIME, tuning))


@cache
def emit_c(array: Array, tuning: Tuning = USUAL, scalar: type[np.floating] = np.float64) -> write.EmittedCode:
    return write.emit(unranged(block(array, tuning)), scalar, error=six_estimator.SURROGATE_ERROR[scalar])


@cache
def compile_c(array: Array, tuning: Tuning = USUAL, scalar: type[np.floating] = np.float64) -> host.Controller:
    files = emit_c(array, tuning, scalar)
    return host.load(files.files, files.manifest)


def setup(array: Array, tuning: Tuning = USUAL) -> Setup:
    """Return what the reference needs to know."""
    return Setup(vars(array) | vars(tuning))


def volts(array: Array, pose: Numbers) -> Numbers:
    """Return what sensors read at poses (.., 6) of X, Y, Z, roll, pitch, yaw, (.., sensors, 2), wave by wave."""
    X, Y, Z, roll, pitch, yaw = np.moveaxis(pose, -1, 0)
    (a, b, c), (s, t, u) = (f([roll, pitch, yaw]) for f in (np.cos, np.sin))
    axes = np.array(
        [
            [c * b, u * b, -t],
            [c * t * s - u * a, u * t * s + c * a, b * s],
            [c * t * a + u * s, u * t * a - c * s, b * a],
        ]
    )
    w, sensor_volts = 2 * np.pi / array.pitch, []
    for r in array.positions:
        x, y, z = np.array([X, Y, Z - array.height]) + np.tensordot(r, axes, 1)
        B = np.zeros((3, *X.shape))
        for n, size in ((1, array.alpha), (5, array.beta)):
            E = size * np.exp(-n * w * z)
            B += E * np.array([np.sin(n * w * x), np.sin(n * w * y), np.cos(n * w * x) + np.cos(n * w * y)])
        sensor_volts.append(np.stack([(axes[0] * B).sum(axis=0), (axes[1] * B).sum(axis=0)], axis=-1))
    return np.stack(sensor_volts, axis=-2)


def noisy(array: Array, pose: Numbers, seed: int = 0) -> Numbers:
    exact = volts(array, pose)
    return exact + array.deviation * np.random.default_rng(seed).standard_normal(exact.shape)


def wrap_angle(angle: Numbers) -> Numbers:
    return (angle + np.pi) % (2 * np.pi) - np.pi


def known_state(array: Array, pose: Numbers, tuning: Tuning = USUAL) -> dict[str, Numbers]:
    """Return the reference's state (N,) of bodies that are known to be, at rest, at poses (N, 6)."""
    n, w = len(pose), array.wave_number
    state = {name: np.repeat(v, n) for name, v in reference_six.initial_state(setup(array, tuning)).items()}
    for i, axis in enumerate("xy"):
        count = np.round(pose[:, i] / array.pitch)
        state |= {f"phase_{axis}": w * (pose[:, i] - count * array.pitch), f"count_{axis}": count}
    state |= {"rise": w * (pose[:, 2] - array.height), "roll": pose[:, 3], "pitch": pose[:, 4]}
    return state | {"yaw": wrap_angle(pose[:, 5]), "yaw_last_good": wrap_angle(pose[:, 5]), "searching": np.zeros(n)}


def state_records(
    array: Array, state: Columns, tuning: Tuning = USUAL, scalar: type[np.floating] = np.float64
) -> host.Records:
    """Return the C's state records (N,) for states of the reference."""
    states = np.repeat(compile_c(array, tuning, scalar).init()[np.newaxis], len(state["yaw"]))
    for name, v in state.items():
        states[f"estimator_{name}"] = v
    return states


def by_input(array: Array, V: Numbers) -> dict[str, Numbers]:
    """Return voltages (N, sensors, 2) by the names of the inputs."""
    return dict(zip((s.name for s in channels.voltages(len(array.positions))), V.reshape(len(V), -1).T, strict=True))


def replay(
    array: Array, pose: Numbers, V: Numbers, tuning: Tuning = USUAL, scalar: type[np.floating] = np.float64
) -> host.Columns:
    """Return the C's outputs (n, N) over voltages (n, N, sensors, 2), begun at poses (N, 6)."""
    state, samples = state_records(array, known_state(array, pose, tuning), tuning, scalar), []
    for now in V:
        batch = compile_c(array, tuning, scalar).batch(state, by_input(array, now))
        state = batch.states
        samples.append(batch.outputs)
    return {name: np.array([f[name] for f in samples]) for name in samples[0]}


def motion(n: int, columns: int, seed: int, travel: float, turn: float = 0.0) -> Numbers:
    """Return smooth random motions (n, columns, 6) of `travel` m, 0.4 mm of gap, 8 mrad of tilt, 5 deg and a `turn`.

    A travel of 0.3 m has speeds of 2 m/s, 2 mm a sample, and accelerations of 20 m/s^2; the turn is in rad/s.
    """
    rng, t = np.random.default_rng(seed), np.arange(n)[:, np.newaxis] / 800

    def wander(size: float) -> Numbers:
        waves = [(1 / k, k * rng.uniform(0.25, 0.75, columns), rng.uniform(0, 6, columns)) for k in (1, 2, 3)]
        return size / 2 * np.sum([a * np.sin(2 * np.pi * f * t + p) for a, f, p in waves], axis=0)

    sizes = (travel, travel, 4e-4, 8e-3, 8e-3, 0.09)
    pose = np.stack([wander(size) for size in sizes], axis=-1)
    pose[..., 2] += 3e-3
    pose[..., 5] += turn * t * rng.choice([-1, 1], columns)
    return pose


def places(n: int, seed: int, yaw: float = 0.09, gap: float = 4e-4, tilt: float = 8e-3) -> Numbers:
    """Return n poses (n, 6) anywhere in the pitch, within a yaw, a gap and a tilt."""
    rng = np.random.default_rng(seed)
    low = np.array([0, 0, 3e-3 - gap, -tilt, -tilt, -yaw])
    return rng.uniform(low, np.array([L, L, 3e-3 + gap, tilt, tilt, yaw]), (n, 6))


def errors(outputs: Columns, pose: Numbers) -> Numbers:
    """Return by how much the poses found are off (.., 6), m and rad."""
    off = np.stack([outputs[name] for name in six_estimator.OUTPUTS], axis=-1) - pose
    off[..., 5] = wrap_angle(off[..., 5])
    return off
