"""Servo axis in NumPy, its gains in 60 digits by mpmath: reference of `blocks.laws.axis`.

One sample of an axis x' = A x + B u, y = C x, whose command u comes a period T late, with e = y - r:

    x^(k)   = x~ + M (y - C x~),       x~+ = A_T x~ + B_T u(k-1) + L (y - C x~)          L = A_T M
    xi+     = Phi_T xi + N_T e + E (u_made - u)
    u       = K [x^(k+1); xi^(k+1)] + f r     with   x^(k+1) = A_T x^ + B_T u(k-1),  xi^(k+1) = Phi_T xi + N_T C x^

K minimises the sampled integral of the weights; X of both Riccati equations comes from a doubling recursion. xi is kept
as eta, xi = R eta: sum+ = sum + e; p+ = p + c q, q+ = q - p+ + e with c = 2 - 2 cos(w T). y is the first state of x,
and process noise acts on the last one.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import mpmath  # type: ignore[import-untyped]
import numpy as np
from numpy.typing import NDArray

from synth.reference import gains as precise

Array = NDArray[Any]
Columns = Mapping[str, Array]
Bounds = Mapping[str, tuple[float, float]]  # of each state by name, as the Block declares them
Matrix = Any  # of mpmath


@dataclass(frozen=True)
class Servo:
    """What an axis is asked for, and the names of its states.

    `A` (n rows) and `B` (n,) are the continuous model; `modes` are pairs (frequency in rad/s, rate in 1/s), `weights`
    those of the n states, `process` and `sensor` the noises, `anti_windup` in 1/s, `T` in s. `estimates` are the
    names of x~ and u(k-1), in this order; those of eta are sum, p1, q1, and so on.
    """

    name: str
    A: tuple[tuple[float, ...], ...]
    B: tuple[float, ...]
    modes: tuple[tuple[float, float], ...]
    weights: tuple[float, ...]
    command_weight: float
    process: float
    sensor: float
    set_point_weight: float
    anti_windup: float
    T: float
    estimates: tuple[str, ...]

    @property
    def states(self) -> list[str]:
        """The names of the states after ``servo_<name>_``: eta, x~ and u(k-1)."""
        oscillators = range(1, 1 + sum(w != 0 for w, _ in self.modes))
        return ["sum", *(f"{part}{j}" for j in oscillators for part in "pq"), *self.estimates]


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


@dataclass(frozen=True)
class Command:
    """The command u, the position a sample later, as rows eta+ without the excess and x~+ = x^(k+1), and E."""

    u: Array
    position: Array
    eta: Array
    prediction: Array
    E: Sequence[Array]


def weight_of_modes(modes: Sequence[tuple[float, float]], weight: float) -> Matrix:
    """Return the weight on xi for which each mode's error decays at its speed: that on its oscillator's states."""
    n = len(precise.product([w for w, _ in modes])) - 1
    Q = mpmath.zeros(n)
    for w, speed in modes:
        others = list(precise.product([v for v, _ in modes if v != w]))[::-1]
        rows = [[0, *others], [mpmath.mpf(w) * c for c in others]] if w else [others]
        for row in rows:
            z = mpmath.matrix([[*row, *[0] * (n - len(row))]])
            Q += (2 if w else 1) * mpmath.mpf(speed) ** 2 * mpmath.mpf(weight) * z.T * z
    return Q


def observer_gain(A: Matrix, C: Matrix, modes: Sequence[float], decay: float, T: float) -> Matrix:
    """Return E for which A - E C has the modes' poles exp(j w T), shrunk by exp(-decay T) (Ackermann)."""
    n, fade = A.rows, mpmath.exp(-mpmath.mpf(decay) * mpmath.mpf(T))
    p = mpmath.eye(n)
    for w in modes:
        turn = 2 * fade * mpmath.cos(mpmath.mpf(w) * mpmath.mpf(T))
        p = p * (A * A - turn * A + fade**2 * mpmath.eye(n) if w else A - fade * mpmath.eye(n))
    last = mpmath.zeros(n, 1)
    last[n - 1] = 1
    return p * mpmath.inverse(precise.controllability(A.T, C.T).T) * last


@cache
def gains(axis: Servo) -> Gains:
    """Return the gains of one axis, each rounded once."""
    modes, T = [w for w, _ in axis.modes], axis.T
    with mpmath.workdps(60):
        A, B = mpmath.matrix([list(row) for row in axis.A]), mpmath.matrix(list(axis.B))
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
        noise[n - 1, n - 1] = axis.process
        _, noise = precise.gramian(A.T, noise, T)
        C, V = mpmath.zeros(1, n), mpmath.matrix([[axis.sensor]])
        C[0] = 1
        P, _ = precise.riccati(A_T.T, C.T, noise, V, mpmath.zeros(n, 1))
        correction = P * C.T * mpmath.inverse(C * P * C.T + V)
        turn, drive = precise.leapfrog(modes, T)
        R = precise.to_leapfrog(modes, T)
        on_x, on_eta = K_x * A_T + K_xi * N_T * C, K_xi * R * turn
        numbers = (A_T, B_T, A_T * correction, correction, on_x, K_x * B_T, on_eta, turn, drive)
        E = observer_gain(turn, on_eta, modes, axis.anti_windup, T)
        on_r = mpmath.matrix([-axis.set_point_weight * on_x[0]])
        return Gains(*(np.array(v.tolist(), dtype=np.float64) for v in (*numbers, E, on_r)))


def initial_state(axes: Sequence[Servo]) -> dict[str, Array]:
    """Return the states after init, by name."""
    return {f"servo_{axis.name}_{n}": np.array(0.0) for axis in axes for n in (*axis.states, "started")}


def along(matrix: Array, *columns: Array) -> Array:
    """Return a matrix times columns (n, ...)."""
    return np.einsum("ij,j...->i...", matrix, np.stack(np.broadcast_arrays(*columns)))


def command(axis: Servo, y: Array, r: Array, state: Columns, bounds: Bounds) -> Command:
    """Return the command of one sample for a position and a set-point (N,), from the states by name in their bounds."""
    k, names = gains(axis), [f"servo_{axis.name}_{n}" for n in axis.states]
    m = len(names) - len(axis.A) - 1  # states of the internal model
    kept = [np.asarray(state[n], dtype=np.float64) for n in names]
    started = np.asarray(state[f"servo_{axis.name}_started"]) > 0
    eta, (q, *rates), late = kept[:m], kept[m:-1], kept[-1]
    q = np.where(started, q, np.clip(q + y, *bounds[names[m]]))  # 0 after init: rests at y
    now = np.stack([q, *rates]) + along(k.M, y - q)
    prediction = along(k.A, *now) + along(k.B, late)
    changed = bench_gains(axis, state)
    at_rest = changed.get(("start_sum", "y"), -(k.on_x[0, 0] + k.on_r[0, 0]) / k.on_eta[0, 0]) * y
    eta[0] = np.where(
        started, eta[0], np.clip(eta[0] + at_rest, *bounds[names[0]])
    )  # no command, with the set-point at y
    on_y = (k.on_x @ k.M)[0, 0]  # of y - C x~
    on_q = k.on_x[0] - on_y * np.eye(len(now))[0]
    factors = [*k.on_eta[0], *on_q, k.on_late[0, 0], on_y, k.on_r[0, 0]]
    columns = zip([*axis.states, "y", "r"], [*eta, q, *rates, late, y, r], factors, strict=True)
    u = np.sum(np.broadcast_arrays(*(changed.get(("u", n), factor) * value for n, value, factor in columns)), axis=0)
    E = [changed.get((f"next_{n}", "excess"), e) for n, e in zip(axis.states, k.E[:, 0], strict=False)]
    return Command(u, prediction[0], along(k.propagate, *eta) + along(k.drive, y - r), prediction, E)


def bench_gains(axis: Servo, state: Columns) -> dict[tuple[str, str], Array]:
    """Return the gains that change on the machine, states ``servo_<name>_<row>_from_<column>``, by row and column.

    Rows are u, start_sum, and ``next_<state>`` of eta; columns are states, y, r, and excess.
    """
    gains_of = {}
    for name in state:
        row, of, column = name.removeprefix(f"servo_{axis.name}_").partition("_from_")
        if name.startswith(f"servo_{axis.name}_") and of:
            ends = {f"{axis.name}_held": "y", f"{column.removesuffix('_excess')}_excess": "excess"}
            column = ends.get(column, column if column in axis.states else "r")
            gains_of[row if row.startswith(("start_", "next_")) else "u", column] = np.asarray(state[name], np.float64)
    return gains_of


def next_state(axis: Servo, after: Command, made: Array, excess: Array, bounds: Bounds) -> dict[str, Array]:
    """Return the next states by name, within their bounds; the actuator has `made` the command but for an `excess`."""
    eta = [of + factor * excess for of, factor in zip(after.eta, after.E, strict=True)]
    values = dict(zip((f"servo_{axis.name}_{n}" for n in axis.states), [*eta, *after.prediction, made], strict=True))
    bounded = {n: np.clip(value, *bounds[n]) for n, value in values.items()}
    return bounded | {f"servo_{axis.name}_started": np.ones_like(after.u)}
