"""The controller of the levitator in NumPy, its gains in 60 digits by mpmath: of the toolkit only `synth.reference`.

One sample of an axis x' = A x + B u, y = C x, whose command u comes a period T late, with e = y - r:

    x^(k)   = x~ + M (y - C x~),       x~+ = A_T x~ + B_T u(k-1) + L (y - C x~)          L = A_T M
    xi+     = Phi_T xi + N_T e + E (u_made - u)
    u       = K [x^(k+1); xi^(k+1)] + f r     with   x^(k+1) = A_T x^ + B_T u(k-1),  xi^(k+1) = Phi_T xi + N_T C x^

K minimises the sampled integral of the weights; X of both Riccati equations comes from a doubling recursion. xi is kept
as eta, xi = R eta: sum+ = sum + e; p+ = p + c q, q+ = q - p+ + e with c = 2 - 2 cos(w T).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from math import pi
from typing import Any

import mpmath  # type: ignore[import-untyped]
import numpy as np
from numpy.typing import NDArray

from synth.reference import gains as precise
from synth.reference import guard

Array = NDArray[Any]
Columns = Mapping[str, Array]
Matrix = Any  # of mpmath

T = 1 / 2000
MAINS, SCAN, WINDUP = 100 * pi, 20 * pi, 30.0
M, F0, K, ELL, G, MASS, COIL, DAMPING, SPRING = 1.5, 14.0, 20.0, 5e-3, 9.81, 0.3, 8.0, 1.0, 400.0
LIMITS = {"z": (-7e-4, 7e-4), "x": (-1.1e-3, 1.1e-3), "z_ref": (-5e-4, 5e-4), "x_ref": (-8e-4, 8e-4)}
STOPS = (-6e-4, 6e-4)  # m, of z: the field is known between them
CURRENTS = {"i1": 3.0, "i2": 2.0}
MADE = 51.0  # m/s^2, of z'': what the coil can make in the box of the stage
SLEW, BAD_SAMPLES = 100.0, 4


@dataclass(frozen=True)
class Axis:
    """What an axis is asked for: continuous model, {frequency: speed}, weights of its states and command, noises, b."""

    A: Sequence[Sequence[float]]
    B: Sequence[float]
    modes: Mapping[float, float]
    weights: Sequence[float]
    command_weight: float
    process: float
    sensor: float
    set_point_weight: float


AXES = {
    "z": Axis([[0, 1], [0, 0]], [0, 1], {0.0: 25.0, SCAN: 20.0}, (1e8, 1e3), 1e-2, 3e-5, 1e-14, 0.6),
    "x": Axis(
        [[0, 1], [-SPRING / MASS, -DAMPING / MASS]], [0, COIL / MASS], {0.0: 25.0, SCAN: 20.0, MAINS: 20.0},
        (1e8, 1e2), 1e1, 1e-4, 1e-14, 0.5,
    ),
}  # fmt: skip
BOUNDS = {  # of the controller's states, as its manifest declares them
    "z": {
        "sum": 0.34,
        "p1": 0.0096,
        "q1": 0.26,
        "z_predicted": 1.4e-3,
        "vz_predicted": 1.3,
        "w_z_late1_predicted": 57.0,
    },
    "x": {
        "sum": 0.51,
        "p1": 0.014,
        "q1": 0.41,
        "p2": 0.073,
        "q2": 0.48,
        "x_predicted": 2.4e-3,
        "vx_predicted": 2.8,
        "i2_late1_predicted": 2.3,
    },
}


@dataclass(frozen=True)
class Gains:
    """One axis in doubles: held model, estimator, gains of u on x^, u(k-1), eta and r, one sample of eta, and E."""

    A: Array
    B: Array
    L: Array
    M: Array
    on_x: Array
    on_late: Array
    on_eta: Array
    propagate: Array
    drive: Array
    E: Array
    on_r: Array


def weight_of_modes(modes: Mapping[float, float], weight: float) -> Matrix:
    """Return the weight on xi for which each mode's error decays at its speed: that on its oscillator's states."""
    n = len(precise.product(list(modes))) - 1
    Q = mpmath.zeros(n)
    for w, speed in modes.items():
        others = list(precise.product([v for v in modes if v != w]))[::-1]
        rows = [[0, *others], [mpmath.mpf(w) * c for c in others]] if w else [others]
        for row in rows:
            z = mpmath.matrix([[*row, *[0] * (n - len(row))]])
            Q += (2 if w else 1) * mpmath.mpf(speed) ** 2 * mpmath.mpf(weight) * z.T * z
    return Q


def observer_gain(A: Matrix, C: Matrix, modes: Sequence[float]) -> Matrix:
    """Return E for which A - E C has the modes' poles exp(j w T), shrunk by exp(-a T) (Ackermann)."""
    n, fade = A.rows, mpmath.exp(-mpmath.mpf(WINDUP) * mpmath.mpf(T))
    p = mpmath.eye(n)
    for w in modes:
        turn = 2 * fade * mpmath.cos(mpmath.mpf(w) * mpmath.mpf(T))
        p = p * (A * A - turn * A + fade**2 * mpmath.eye(n) if w else A - fade * mpmath.eye(n))
    last = mpmath.zeros(n, 1)
    last[n - 1] = 1
    return p * mpmath.inverse(precise.controllability(A.T, C.T).T) * last


@cache
def gains(name: str) -> Gains:
    """Return the gains of one axis, each rounded once."""
    axis = AXES[name]
    modes = list(axis.modes)
    with mpmath.workdps(60):
        A, B = mpmath.matrix(axis.A), mpmath.matrix(list(axis.B))
        Phi, n = precise.companion(modes), A.rows
        k = Phi.rows
        N = mpmath.zeros(k, 1)
        N[k - 1] = 1
        F = mpmath.zeros(n + k + 2)  # x, xi, u, and the e that drives xi, held like u
        F[:n, :n], F[:n, n + k], F[n : n + k, n : n + k], F[n : n + k, n + k + 1] = A, B, Phi, N
        W = precise.diagonal(
            precise.diagonal(mpmath.diag(list(axis.weights)), weight_of_modes(axis.modes, axis.weights[0])),
            mpmath.diag([axis.command_weight, 0]),
        )
        E, cost = precise.gramian(F, W, T)
        held = mpmath.zeros(n + k + 2, n + k + 1)  # e = C x at the sample
        held[: n + k + 1, :], held[n + k + 1, 0] = mpmath.eye(n + k + 1), 1
        step, W = (E * held)[: n + k, :], held.T * cost * held
        m = n + k
        _, gain = precise.riccati(step[:, :m], step[:, m], W[:m, :m], W[m:, m:], W[:m, m:])
        K_x, K_xi = -gain[:, :n], -gain[:, n:]
        A_T, B_T, N_T = E[:n, :n], E[:n, n + k], E[n:m, m + 1]
        noise = mpmath.zeros(n)
        noise[1, 1] = axis.process
        _, noise = precise.gramian(A.T, noise, T)
        C, V = mpmath.zeros(1, n), mpmath.matrix([[axis.sensor]])
        C[0] = 1
        P, _ = precise.riccati(A_T.T, C.T, noise, V, mpmath.zeros(n, 1))
        correction = P * C.T * mpmath.inverse(C * P * C.T + V)
        turn, drive = precise.leapfrog(modes, T)
        R = precise.to_leapfrog(modes, T)
        on_x, on_eta = K_x * A_T + K_xi * N_T * C, K_xi * R * turn
        numbers = (A_T, B_T, A_T * correction, correction, on_x, K_x * B_T, on_eta, turn, drive)
        E = observer_gain(turn, on_eta, modes)
        on_r = mpmath.matrix([-axis.set_point_weight * on_x[0]])
        return Gains(*(np.array(v.tolist(), dtype=np.float64) for v in (*numbers, E, on_r)))


def initial_state() -> dict[str, Array]:
    """Return the state after init, by name."""
    servos = {f"servo_{s}_{n}": np.array(0.0) for s, bounds in BOUNDS.items() for n in (*bounds, "started")}
    return guard.initial_state(LIMITS, CURRENTS, BAD_SAMPLES) | servos


def along(matrix: Array, *columns: Array) -> Array:
    """Return a matrix times columns (n, ...)."""
    return np.einsum("ij,j...->i...", matrix, np.stack(np.broadcast_arrays(*columns)))


def servo(s: str, values: Columns, state: Columns) -> tuple[Array, Array, Array, Array]:
    """Return the command, the position a sample ahead, eta+ without the excess, and x~+ = x^(k+1)."""
    k, names, y, r = gains(s), list(BOUNDS[s]), values[s], values[f"{s}_ref"]
    kept = {n: np.asarray(state[f"servo_{s}_{n}"], dtype=np.float64) for n in names}
    started = np.asarray(state[f"servo_{s}_started"]) > 0
    q, v, late = (kept[n] for n in names[-3:])
    q = np.where(started, q, np.clip(q + y, -BOUNDS[s][names[-3]], BOUNDS[s][names[-3]]))  # 0 after init: rests at y
    now = np.stack([q, v]) + along(k.M, y - q)
    ahead = along(k.A, *now) + along(k.B, late)
    eta = [kept[n] for n in names[:-3]]
    at_rest, bound = -(k.on_x[0, 0] + k.on_r[0, 0]) / k.on_eta[0, 0] * y, BOUNDS[s][names[0]]
    eta[0] = np.where(started, eta[0], np.clip(eta[0] + at_rest, -bound, bound))  # no command, with the set-point at y
    u = (along(k.on_x, *now) + along(k.on_late, late) + along(k.on_eta, *eta))[0] + k.on_r[0, 0] * r
    next_eta = along(k.propagate, *eta) + along(k.drive, y - r)
    return u, ahead[0], next_eta, ahead


def step(state: Columns, inputs: Columns) -> tuple[dict[str, Array], dict[str, Array], Array]:
    """Return (next state, outputs, fault word) of one sample, columns by name."""
    values, after, word = guard.standard(state, inputs, LIMITS, "zx", BAD_SAMPLES)
    latched, computed, next_states = after["guard_latched"] > 0, {}, {}
    for s, current in (("z", "i1"), ("x", "i2")):
        u, position, next_eta, ahead = servo(s, values, state)
        if s == "z":
            field = np.exp(np.clip(position, *STOPS) / ELL)
            demand = (M * (u + G) / field - F0) / K
            computed[current] = np.clip(demand, -CURRENTS[current], CURRENTS[current])
            excess = K * field / M * (computed[current] - demand)
            made = np.clip(field * (F0 + K * computed[current]) / M - G, -MADE, MADE)
        else:
            made = computed[current] = np.clip(u, -CURRENTS[current], CURRENTS[current])
            excess = made - u
        eta = next_eta + along(gains(s).E, excess)
        for (n, bound), value in zip(BOUNDS[s].items(), [*eta, *ahead, made], strict=True):
            next_states[f"servo_{s}_{n}"] = np.clip(value, -bound, bound)
        next_states[f"servo_{s}_started"] = np.ones_like(u)
    out, last = guard.slew(state, computed, latched, SLEW * T)
    return after | guard.frozen(state, next_states, latched) | last, out, word
