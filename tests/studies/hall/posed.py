"""The estimator of six degrees of freedom over known motions: the emitted C, its states and its errors."""

from collections.abc import Mapping
from functools import cache

import numpy as np

from designs.hall_position.glsdc import channels
from models.hall_two_waves import SpatialArray as Array
from studies.hall.protected import spatial
from studies.hall.protected.spatial import Tuning
from synth.block import Block, unranged
from synth.emit import write
from synth.execute import host
from synth.statespace import Array as Numbers
from synth.timing import Discrete

TIME = Discrete(1 / 800)
USUAL = Tuning()

Columns = Mapping[str, Numbers]


@cache
def block(array: Array, tuning: Tuning = USUAL) -> Block:
    return unranged(spatial.guarded_estimator(array, TIME, tuning))


@cache
def compile_c(array: Array, tuning: Tuning = USUAL) -> host.Controller:
    """Return the C in double precision, with functions of libm."""
    files = write.emit(block(array, tuning), np.float64, libm=True)
    return host.load(files.files, files.manifest)


def wrap_angle(angle: Numbers) -> Numbers:
    return (angle + np.pi) % (2 * np.pi) - np.pi


def tracking_states(array: Array, pose: Numbers) -> host.Records:
    """Return the C's state records of estimators that track bodies at rest at poses (N, 6)."""
    states, w = np.repeat(compile_c(array).init()[np.newaxis], len(pose)), array.wave_number
    for i, axis in enumerate("xy"):
        count = np.round(pose[:, i] / array.pitch)
        states[f"estimator_phase_{axis}"] = states[f"metres_last_{axis}"] = w * (pose[:, i] - count * array.pitch)
        states[f"metres_pitch_{axis}"] = count
    for i, name in enumerate(spatial.OUTPUTS[2:], 2):
        states[f"estimator_{name}"] = pose[:, i]
    states["estimator_start_number"], states["metres_counting"] = USUAL.starts, 1
    return states


def by_input(array: Array, V: Numbers) -> dict[str, Numbers]:
    """Return voltages (N, sensors, 2) by the names of the inputs."""
    return dict(zip((s.name for s in channels.voltages(len(array.positions))), V.reshape(len(V), -1).T, strict=True))


def replay(array: Array, states: host.Records, V: Numbers) -> host.Columns:
    """Return the C's outputs (n, N) over voltages (n, N, sensors, 2), from states (N,)."""
    samples = []
    for now in V:
        batch = compile_c(array).batch(states, by_input(array, now))
        states = batch.states
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


def errors(outputs: Columns, pose: Numbers) -> Numbers:
    """Return by how much the poses found are off (.., 6), m and rad."""
    off = np.stack([outputs[name] for name in spatial.OUTPUTS], axis=-1) - pose
    off[..., 5] = wrap_angle(off[..., 5])
    return off
