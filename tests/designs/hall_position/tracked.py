"""The estimator over known motions: voltages by model (2), the emitted C in double, and the reference beside it."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from designs.hall_position import reference
from designs.hall_position.glsdc import channels, estimator
from designs.hall_position.glsdc.parameters import Tuning
from designs.hall_position.reference_glsdc import Setup
from models import hall_motions as motions
from models.hall_two_waves import PlanarArray as Array
from synth.block import Block, unranged
from synth.emit import write
from synth.execute import host
from synth.statespace import Array as Numbers
from synth.timing import Discrete

TIME = Discrete(1 / 800)
L = 0.0508
W = 2 * np.pi / L
ALPHA, BETA = 8.4 * 0.37502, -8.4 * 0.02146  # V: fabricated, 3 mm
SPACING = 0.75 * L / 2
PAIR = ((-SPACING, -SPACING), (SPACING, SPACING))
TWO = Array(PAIR, 0.0, ALPHA, BETA)
THREE = Array((*PAIR, (0.640 * L, 0.613 * L)), 0.0, ALPHA, BETA)
USUAL = Tuning()
ARRAYS = {"two": TWO, "three": THREE}

Columns = Mapping[str, Numbers]


@dataclass(frozen=True)
class Pose:
    """Where bodies are: X, Y in m and the yaw in rad, of one shape, and how they move in a sample."""

    X: Numbers
    Y: Numbers
    yaw: Numbers
    motion: "Pose | None" = None


@cache
def block(array: Array, tuning: Tuning = USUAL) -> Block:
    return estimator.guarded_estimator(array, TIME, tuning)


@cache
def emit_c(array: Array, tuning: Tuning = USUAL, scalar: type[np.floating] = np.float64) -> write.EmittedCode:
    return write.emit(unranged(block(array, tuning)), scalar, error=estimator.SURROGATE_ERROR[scalar])


@cache
def compile_c(array: Array, tuning: Tuning = USUAL, scalar: type[np.floating] = np.float64) -> host.Controller:
    files = emit_c(array, tuning, scalar)
    return host.load(files.files, files.manifest)


def setup(array: Array, tuning: Tuning = USUAL) -> Setup:
    """Return what the reference needs to know."""
    return Setup(vars(array) | vars(tuning))


def noisy(array: Array, pose: Pose, seed: int = 0) -> Numbers:
    return motions.noisy(array, motions.Pose(pose.X, pose.Y, pose.yaw), seed)


def volts(array: Array, pose: Pose) -> Numbers:
    return motions.volts(array, motions.Pose(pose.X, pose.Y, pose.yaw))


def wrap_angle(angle: Numbers) -> Numbers:
    return (angle + np.pi) % (2 * np.pi) - np.pi


def known_state(array: Array, pose: Pose, tuning: Tuning = USUAL) -> dict[str, Numbers]:
    """Return the reference's state (N,) of bodies that are known to be at poses (N,), and to move as they say."""
    n = len(pose.X)
    state = {name: np.repeat(v, n) for name, v in reference.initial_state(setup(array, tuning)).items()}
    for axis, at in zip("xy", centre(array, pose), strict=True):
        pitch = np.round(at / L)
        state |= {f"phase_{axis}": W * (at - pitch * L), f"pitch_{axis}": pitch}
    if pose.motion and tuning.velocity_gain:
        next_centre = centre(array, displace(pose, pose.motion))
        state |= {f"motion_{a}": W * (e - b) for a, e, b in zip("xy", next_centre, centre(array, pose), strict=True)}
        state |= {"motion_yaw": pose.motion.yaw}
    yaw = wrap_angle(pose.yaw)
    known = {"searching": np.zeros(n), "ambiguity_resolved": np.ones(n), "acquired": np.ones(n)}
    return state | known | {"yaw": yaw, "yaw_last_good": yaw}


def centre(array: Array, pose: Pose) -> tuple[Numbers, Numbers]:
    """Return where the middle of the sensors is, m."""
    (x, y), c, s = array.centre, np.cos(pose.yaw), np.sin(pose.yaw)
    return pose.X + c * x - s * y, pose.Y + s * x + c * y


def displace(pose: Pose, by: Pose, times: float = 1.0) -> Pose:
    return Pose(pose.X + times * by.X, pose.Y + times * by.Y, pose.yaw + times * by.yaw)


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
    flat = V.reshape(len(V), -1).T
    return dict(zip((s.name for s in channels.voltages(len(array.positions))), flat, strict=True))


def replay(array: Array, pose: Pose, V: Numbers, tuning: Tuning = USUAL) -> host.Columns:
    """Return the C's outputs (n, N) over voltages (n, N, sensors, 2), begun at poses (N,)."""
    state, samples = state_records(array, known_state(array, pose, tuning), tuning), []
    for now in V:
        batch = compile_c(array, tuning).batch(state, by_input(array, now))
        state = batch.states
        samples.append(batch.outputs)
    return {name: np.array([f[name] for f in samples]) for name in samples[0]}


def motion(n: int, columns: int, seed: int, travel: float, yaw: float, turn: float = 0.0) -> Pose:
    """Return smooth random motions (n, columns) within `travel` m and `yaw` rad, and `turn` rad/s besides.

    A travel of 0.3 m has speeds of 2 m/s, 2 mm a sample, and accelerations of 20 m/s^2.
    """
    rng, t = np.random.default_rng(seed), np.arange(n)[:, np.newaxis] / 800

    def wander(size: float) -> Numbers:
        waves = [(1 / k, k * rng.uniform(0.25, 0.75, columns), rng.uniform(0, 6, columns)) for k in (1, 2, 3)]
        return size / 2 * np.sum([a * np.sin(2 * np.pi * f * t + p) for a, f, p in waves], axis=0)

    return Pose(wander(travel), wander(travel), wander(yaw) + turn * t * rng.choice([-1, 1], columns))


def before_start(pose: Pose) -> Pose:
    """Return where bodies are a sample before their motions (n, N) begin, as these go on."""
    first, second = (Pose(pose.X[i], pose.Y[i], pose.yaw[i]) for i in (0, 1))
    motion = displace(second, first, -1.0)
    return replace(displace(first, motion, -1.0), motion=motion)


def position_error(outputs: Columns, pose: Pose) -> Numbers:
    """Return how far the positions found are off, m."""
    return np.hypot(outputs["X"] - pose.X, outputs["Y"] - pose.Y)


def places(n: int, seed: int, yaw: float) -> Pose:
    """Return n poses anywhere in the pitch, at yaws within `yaw` rad."""
    rng = np.random.default_rng(seed)
    return Pose(rng.uniform(0, L, n), rng.uniform(0, L, n), rng.uniform(-yaw, yaw, n))


def at_rest(pose: Pose, n: int) -> Pose:
    """Return bodies (N,) that rest for n samples, (n, N)."""
    return Pose(*(np.repeat(v[np.newaxis], n, axis=0) for v in (pose.X, pose.Y, pose.yaw)))
