"""GLSDC in six degrees of freedom in plain NumPy, for comparison; N bodies advance one sample at a time.

The potential of the field, V m, of which the sensors' axes e see -e.grad at their places P = (X, Y, Z) + R r:

    Phi = sum over n = 1, 5 of a_n / (n w) exp(-n w (Z - height)) (cos(n w X) + cos(n w Y))

A coordinate q moves what is read by e'(q).B + e.(grad B P'(q)), with the derivatives of R = R_z R_y R_x as products of
matrices. Corrections are least-squares solutions of the rows over those of the damping, by one orthogonal factorisation
where the sample begins, in m and rad. Sines and exponentials are NumPy's, of 5 w X as of w X.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from math import pi, sqrt
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]
Columns = Mapping[str, Array]

SLACK = 0.01  # of deviation^2
PATIENCE = 5  # samples
PART = 0.25  # of the ranges of height and tilts, in a sample
PLASTIC = 1.324717957244746  # g, g^3 = g + 1
POSE = ("phase_x", "phase_y", "rise", "roll", "pitch", "yaw")
OUTPUTS = ("X", "Y", "Z", "roll", "pitch", "yaw")
WAVES = (1, 5)
GENERATORS = np.array([[[0, 0, 0], [0, 0, -1], [0, 1, 0]], [[0, 0, 1], [0, 0, 0], [-1, 0, 0]]], dtype=float)


@dataclass(frozen=True)
class Setup:
    """Sensors in the body, m, the field, V at a height in m, and the numbers of the algorithm."""

    positions: tuple[tuple[float, float, float], ...]
    alpha: float
    beta: float
    height: float
    pitch: float
    deviation: float
    corrections: int
    damping: float
    reach: float
    follow: float
    settled: float
    leaning: float
    surprise: float
    residual: float
    gap: float
    tilt: float
    pitches: int

    @property
    def wave_number(self) -> float:
        """Return w, rad/m."""
        return 2 * pi / self.pitch

    @property
    def spare(self) -> bool:
        """Return whether a sensor can be left out."""
        return len(self.positions) > 4

    @property
    def stiffness(self) -> Array:
        """Return the damping's root by coordinate, V/m and V/rad."""
        flat = np.array(self.positions)[:, :2]
        arm = sqrt((flat**2).sum() / len(flat))
        return sqrt(self.damping) * self.alpha * self.wave_number * np.array([1, 1, 1, arm, arm, arm])

    @property
    def bounds(self) -> Array:
        """Return how far a sample may move each coordinate, m and rad."""
        w, half = self.wave_number, self.reach / 2
        arm = w * np.abs(np.array(self.positions)[:, :2]).sum(axis=1).max()
        yaw = (sqrt(arm**2 + 2 * arm * half) - arm) / arm
        return np.array([half / w, half / w, PART * self.gap, PART * self.tilt, PART * self.tilt, yaw])

    @property
    def ranges(self) -> Array:
        """Return within what the height, roll and pitch are, m and rad."""
        return np.array([self.gap, self.tilt, self.tilt])

    @property
    def units(self) -> Array:
        """Return what a state's unit is of each coordinate, rad/m and 1."""
        return np.array([self.wave_number] * 3 + [1.0] * 3)


@dataclass(frozen=True)
class Held:
    """The factorisation where a sample begins: Q (N, m + 6, 6) and R (N, 6, 6)."""

    Q: Array
    R: Array


@dataclass(frozen=True)
class Trial:
    """A displacement (N, 6) with its squared residuals and cost (N,), V^2, and z = Q'b (N, 6), V."""

    at: Array
    squares: Array
    cost: Array
    z: Array


def initial_state(setup: Setup) -> dict[str, Array]:
    """Return the state after init, by name."""
    names = [*POSE, "yaw_known", "count_x", "count_y", "start_x", "start_y", *(f"motion_{p}" for p in POSE)]
    return {n: np.array([1.0 * (n == "searching")]) for n in (*names, "astray", "searching", "restarted")}


def begun(setup: Setup, state: Columns) -> Array:
    """Return the pose (N, 6) with which a sample begins, m and rad."""
    start = np.stack([state[p] + state[f"motion_{p}"] for p in POSE], axis=1) / setup.units
    start[:, 2:5] = np.clip(start[:, 2:5], -setup.ranges, setup.ranges)
    return start


def step(setup: Setup, state: Columns, volts: Array, refused: Array) -> tuple[dict[str, Array], dict[str, Array]]:
    """Return outputs and next state for held voltages (N, sensors, 2), of which some are `refused`."""
    bad = np.any(refused, axis=2)
    weights = 1.0 * ~bad if setup.spare else np.ones(bad.shape)
    freedom = 2 * len(setup.positions) - 6 - 2 * np.any(weights == 0, axis=1)
    start = begun(setup, state)
    held, last, end, converged = descend(setup, start, volts, weights)
    astray = last.squares > freedom * setup.residual**2
    end = np.where((astray & (state["searching"] == 0))[:, None], 0.0, end)
    found, next, inside = advance(setup, state, start + end, astray)
    for i, p in enumerate(POSE):
        bound, f = setup.bounds[i] * setup.units[i], setup.units[i]
        moved = np.clip(state[f"motion_{p}"] + setup.follow * f * end[:, i], -bound, bound)
        next[f"motion_{p}"] = np.where(astray & (state["searching"] > 0), 0, moved)
    inverse = np.linalg.inv(held.R)
    out = {name: found[:, i] for i, name in enumerate(OUTPUTS)}
    spread = setup.deviation * np.sqrt((inverse**2).sum(axis=2))
    out |= {f"deviation_{name}": spread[:, i] for i, name in enumerate(OUTPUTS)}
    damped = ((setup.stiffness[:, None] * inverse) ** 2).sum(axis=(1, 2)) > setup.leaning
    sudden = last.cost - last.squares > (setup.surprise * setup.deviation) ** 2
    accepted = inside if setup.spare else inside & ~bad.any(axis=1)
    out |= {"residual": np.sqrt(last.squares / freedom), "converged": converged, "damped": damped}
    out |= {"valid": converged & ~damped & ~astray & ~sudden & accepted, "restarted": state["restarted"]}
    return out, next


def descend(setup: Setup, start: Array, volts: Array, weights: Array) -> tuple[Held, Trial, Array, Array]:
    """Return what is held, the last trial, the displacement (N, 6) after all corrections, and what has converged."""
    held = factorised(setup, start, weights)
    trial = tried(setup, held, start, np.zeros_like(start), volts, weights)
    best, lowest, better = trial.at, trial.cost, np.ones(len(start), bool)
    for _ in range(setup.corrections - 1):
        at = np.where(better[:, None], corrected(setup, held, trial), (trial.at + best) / 2)
        trial = tried(setup, held, start, at, volts, weights)
        better = trial.cost <= lowest + SLACK * setup.deviation**2
        best, lowest = np.where(better[:, None], at, best), np.where(better, trial.cost, lowest)
    converged = better & ((trial.z**2).sum(axis=1) <= (setup.settled * setup.deviation) ** 2)
    return held, trial, np.where(converged[:, None], corrected(setup, held, trial), best), converged


def factorised(setup: Setup, start: Array, weights: Array) -> Held:
    """Return the factorisation of the weighted rows over those of the damping."""
    H = read(setup, start)[1] * np.repeat(weights, 2, axis=1)[:, :, None]
    stiff = np.broadcast_to(np.diag(setup.stiffness), (len(start), 6, 6))
    Q, R = np.linalg.qr(np.concatenate([H, stiff], axis=1))
    return Held(Q, R)


def tried(setup: Setup, held: Held, start: Array, at: Array, volts: Array, weights: Array) -> Trial:
    """Return the trial of a displacement (N, 6)."""
    e = (volts.reshape(len(at), -1) - read(setup, start + at)[0]) * np.repeat(weights, 2, axis=1)
    b = np.concatenate([e, -setup.stiffness * at], axis=1)
    return Trial(at, (e**2).sum(axis=1), (b**2).sum(axis=1), np.einsum("nmi,nm->ni", held.Q, b))


def corrected(setup: Setup, held: Held, trial: Trial) -> Array:
    """Return the displacement (N, 6) that a correction leads to; where one is limited, those before it fit it."""
    R, moved = held.R, np.zeros_like(trial.at)
    for i in reversed(range(6)):
        step = (trial.z[:, i] - np.einsum("nk,nk->n", R[:, i, i + 1 :], moved[:, i + 1 :])) / R[:, i, i]
        moved[:, i] = np.clip(trial.at[:, i] + step, -setup.bounds[i], setup.bounds[i]) - trial.at[:, i]
    return trial.at + moved


def read(setup: Setup, pose: Array) -> tuple[Array, Array]:
    """Return what sensors read at poses (N, 6), Z from the height on, (N, m) in V, and the derivatives (N, m, 6)."""
    turns = rotations(*pose[:, 3:].T)
    volts, slopes = [], []
    for r in setup.positions:
        B, gradient = field(setup, pose[:, :3] + turns[0] @ r)
        for axis in (0, 1):
            e = turns[0][:, :, axis]
            p = np.einsum("nij,nj->ni", gradient, e)
            by = [(d[:, :, axis] * B).sum(axis=1) + (p * (d @ r)).sum(axis=1) for d in turns[1:]]
            volts.append((e * B).sum(axis=1))
            slopes.append(np.column_stack([p, *by]))
    return np.stack(volts, axis=1), np.stack(slopes, axis=1)


def rotations(roll: Array, pitch: Array, yaw: Array) -> list[Array]:
    """Return R (N, 3, 3) and its derivatives by roll, pitch and yaw."""
    K, L = GENERATORS
    M = np.array([[0, -1.0, 0], [1.0, 0, 0], [0, 0, 0]])
    x, y, z = (
        np.eye(3) + np.sin(a)[:, None, None] * G + (1 - np.cos(a))[:, None, None] * (G @ G)
        for a, G in ((roll, K), (pitch, L), (yaw, M))
    )
    return [z @ y @ x, z @ y @ x @ K, z @ y @ L @ x, M @ z @ y @ x]


def field(setup: Setup, at: Array) -> tuple[Array, Array]:
    """Return B (N, 3) in V and its gradient (N, 3, 3) in V/m, places (N, 3) in m from the height on."""
    w, B, gradient = setup.wave_number, np.zeros((len(at), 3)), np.zeros((len(at), 3, 3))
    for n, a in zip(WAVES, (setup.alpha, setup.beta), strict=True):
        k, size = n * w, a * np.exp(-n * w * at[:, 2])
        for i in (0, 1):
            s, c = size * np.sin(k * at[:, i]), size * np.cos(k * at[:, i])
            B[:, i] += s
            B[:, 2] += c
            gradient[:, i, i] += k * c
            gradient[:, 2, 2] -= k * c
            gradient[:, i, 2] -= k * s
            gradient[:, 2, i] -= k * s
    return B, gradient


def advance(setup: Setup, state: Columns, pose: Array, astray: Array) -> tuple[Array, dict[str, Array], Array]:
    """Return the poses (N, 6) of the outputs, the next states, and which are within their ranges."""
    w, found = setup.wave_number, pose.copy()
    inside = np.all(np.abs(pose[:, 2:5]) < setup.ranges, axis=1)
    next: dict[str, Array] = {}
    for i, axis in enumerate("xy"):
        phase, turns = wrapped(w * pose[:, i])
        counted = np.abs(state[f"count_{axis}"]) < setup.pitches
        next |= {f"phase_{axis}": phase, f"count_{axis}": state[f"count_{axis}"] + np.where(counted, turns, 0)}
        found[:, i] = (phase / (2 * pi) + next[f"count_{axis}"]) * setup.pitch
        inside &= counted
    found[:, 2] += setup.height
    found[:, 5] = wrapped(pose[:, 5])[0]
    again = astray & (state["astray"] >= PATIENCE - 1)
    for axis, part in (("x", 1 / PLASTIC), ("y", 1 / PLASTIC**2)):
        moved = wrapped(state[f"start_{axis}"] + 2 * pi * (part - 1))[0]
        next[f"start_{axis}"] = np.where(again, moved, state[f"start_{axis}"])
        next[f"phase_{axis}"] = np.where(again, moved, next[f"phase_{axis}"])
    for i, name in ((2, "rise"), (3, "roll"), (4, "pitch")):
        f = setup.units[i]
        next[name] = np.where(again, 0.0, np.clip(f * pose[:, i], -f * setup.ranges[i - 2], f * setup.ranges[i - 2]))
    next |= {name: np.where(again, 0.0, next[name]) for name in ("count_x", "count_y")}
    next |= {"yaw": np.where(again, state["yaw_known"], found[:, 5])}
    next |= {"yaw_known": np.where(astray, state["yaw_known"], found[:, 5])}
    next |= {"astray": np.where(astray & ~again, state["astray"] + 1, 0)}
    next |= {"searching": np.where(again, 1, np.where(astray, state["searching"], 0))}
    return found, next | {"restarted": np.maximum(state["restarted"], again)}, inside


def wrapped(angle: Array) -> tuple[Array, Array]:
    """Return angles within half a turn, and the turns taken off."""
    turns = np.where(angle > pi, 1.0, np.where(angle < -pi, -1.0, 0.0))
    return angle - 2 * pi * turns, turns
