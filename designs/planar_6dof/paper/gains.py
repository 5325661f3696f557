"""Audit of the optimal gains: (49) by lqrd, (42) by the filter's Riccati equation, and (33)-(35).

(26) has the states x, y, phi and their rates d, f, v; (31) adds the integrals z1, z2, z3. With b and c for the printed
accelerations per ampere of (26), the yaw of motor C left out (Y-23),

    x'' = b i_C,    y'' = b (i_A + i_B),    phi'' = c (i_B - i_A)

K decouples into three loops of one input each: i_C, i_A = i_B, and -i_A = i_B, the last two with input weight 2.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache

import numpy as np
from scipy.linalg import solve_continuous_are
from scipy.optimize import linear_sum_assignment

from designs.planar_6dof import lqg
from designs.planar_6dof.lqg import STATES, WEIGHTS
from synth import timing
from synth.analyse import discretise
from synth.analyse.structure import structure
from synth.statespace import Array, StateSpace
from synth.synthesise.feedback import lqr
from synth.synthesise.observers import kalman, reduced_observer
from synth.timing import Continuous

POSITIONS, INTEGRALS = STATES[:3], STATES[3:6]
ROW = {"x": 2, "z1": 2, "d": 2}  # of K in which the gain of a state is positive; else 1
SAME = 1e-9  # distance below which poles in z are equal


@dataclass(frozen=True)
class Stage:
    """b in m/s^2/A and c in rad/s^2/A of (26), and the sample period in s."""

    per_ampere: float
    yaw_per_ampere: float
    period_s: float


@cache
def model(of: Stage, integrals: bool) -> StateSpace:
    """Return (31), (32), or (26), (27) without the integrals, in continuous time."""
    return lqg.model(of.per_ampere, of.yaw_per_ampere, integrals)


@cache
def sampled_model(of: Stage) -> StateSpace:
    """Return (31), (32) sampled with the currents held."""
    return discretise.zero_order_hold(model(of, True), of.period_s)


def axis_model(of: Stage, axis: str) -> tuple[StateSpace, float]:
    """Return an axis with its integral and rate and one input, and the weight on that input for R = I."""
    k = POSITIONS.index(axis)
    b = of.per_ampere if axis == "x" else 2 * (of.per_ampere if axis == "y" else of.yaw_per_ampere)
    A, B = np.array([[0.0, 0, 1], [1, 0, 0], [0, 0, 0]]), np.array([[0.0], [0], [b]])
    chain = StateSpace(A, B, np.eye(1, 3), np.zeros((1, 1)), STATES[k::3], ("i",), (axis,), Continuous())
    return chain, 1.0 if axis == "x" else 2.0


@cache
def gains(of: Stage, q: tuple[float, ...] = WEIGHTS, r: float = 1.0) -> Mapping[str, float]:
    """Return the magnitude of each gain of lqrd, by state, for diagonal weights in the order of STATES."""
    K = -lqr.lqrd(model(of, True), np.array(q), r * np.ones(3), of.period_s).K
    return {n: float(K[ROW.get(n, 1), i]) for i, n in enumerate(STATES)}


def matrix(size: Mapping[str, float]) -> Array:
    """Return K (3, 9) of (49) from the magnitudes of its gains by state, u = -K x."""
    k = np.array([size[n] for n in STATES])
    x, y, phi = (np.tile(np.arange(3) == i, 3) * k for i in range(3))
    return np.array([y - phi, y + phi, x])


@cache
def weights(of: Stage, axis: str, gains: tuple[float, ...]) -> Mapping[str, float]:
    """Return the diagonal weights on an axis, its integral and its rate for which lqrd gives three gains K.

    K and the cost-to-go X of the sampled model are linear in the weights q on state and input, W(q) over a period:

        X = F'X F + [I; -K]' W [I; -K],    G'X F + W_ux - W_uu K = 0,    F = A - G K

    nine equations in the six entries of X and the three of q.
    """
    chain, r = axis_model(of, axis)
    sampled, K = discretise.zero_order_hold(chain, of.period_s), np.array([gains])
    closed, both = sampled.A - sampled.B @ K, np.vstack([np.eye(3), -K])
    flow = np.vstack([np.hstack([chain.A, chain.B]), np.zeros((1, 4))])

    def residual(x: Array, q: Array) -> Array:
        X, W = np.zeros((3, 3)), discretise.gramian(flow, np.diag(np.append(q[:3], q[3:] * r)), of.period_s).W
        X[np.triu_indices(3)] = x
        X = X + np.triu(X, 1).T
        cost = closed.T @ X @ closed - X + both.T @ W @ both
        return np.append(cost[np.triu_indices(3)], sampled.B.T @ X @ closed + (W @ both)[3:])

    columns = np.array([residual(e[:6], e[6:]) for e in np.eye(10)]).T
    solution = np.linalg.solve(columns[:, :9], -columns[:, 9])
    return dict(zip(chain.states, solution[6:].tolist(), strict=True))


def continuous_gain(of: Stage, theta: float) -> Array:
    """Return the gain of (41) for (26), (27) with Theta = theta I and L Psi L' = I."""
    return kalman.continuous(model(of, False), np.eye(6), theta * np.eye(3)).L


def continuous_gain_of_sampled_model(of: Stage, theta: float) -> Array:
    """Return H (3, 6) of the continuous (41) for the sampled A22, A12, Theta = theta I and L Psi L' = theta ones."""
    held = sampled_model(of)
    A12 = held.A[:6, 6:]
    sigma = solve_continuous_are(held.A[6:, 6:].T, A12.T, np.full((3, 3), theta), theta * np.eye(6))
    return np.asarray(sigma @ A12.T / theta)


def greatest_pole(of: Stage, H: Array) -> float:
    """Return the greatest |z| of A22 - H A12."""
    held = sampled_model(of)
    return float(np.abs(np.linalg.eigvals(held.A[6:, 6:] - H @ held.A[:6, 6:])).max())


def loop_33(held: StateSpace, K: Array, L: Array) -> Array:
    """Return the matrix (12, 12) of (33) on x1, x2 and x3 = x2^ - L x1."""
    A11, A12, A21, A22 = held.A[:6, :6], held.A[:6, 6:], held.A[6:, :6], held.A[6:, 6:]
    B1, B2, k1, k2 = held.B[:6], held.B[6:], K[:, :6], K[:, 6:]
    rows = [
        [A11 - B1 @ k1 - B1 @ k2 @ L, A12, -B1 @ k2],
        [A21 - B2 @ k1 - B2 @ k2 @ L, A22, -B2 @ k2],
        [
            (A22 - L @ A12) @ L + A21 - L @ A11 - (B2 - L @ B1) @ (k1 + k2 @ L),
            np.zeros((3, 3)),
            A22 - L @ A12 - B2 @ k2 + L @ B1 @ k2,
        ],
    ]
    return np.block(rows)


def shared_poles(held: StateSpace, K: Array, pole: float) -> int:
    """Return how many poles of (33) are those of A - B K and A22 - L A12, with L = (1 - pole) / T on the positions."""
    L = _observer_gain(held, pole)
    whole, closed = np.linalg.eigvals(loop_33(held, K, L)), np.linalg.eigvals(held.A - held.B @ K)
    parts = np.concatenate([closed, np.linalg.eigvals(held.A[6:, 6:] - L @ held.A[:6, 6:])])
    distance = np.abs(whole[:, None] - parts)
    return int((distance[linear_sum_assignment(distance)] < SAME).sum())


def slowest(held: StateSpace, K: Array, axis: str) -> float:
    """Return the greatest |z| of A - B K in an axis, which is decoupled from the others."""
    k = POSITIONS.index(axis)
    return float(np.abs(np.linalg.eigvals((held.A - held.B @ K)[k::3, k::3])).max())


def is_reduced_order_loop(held: StateSpace, K: Array) -> bool:
    """Return whether (33) is the loop of a reduced-order observer with the sampled model."""
    L = _observer_gain(held, 0.5)
    observer = reduced_observer.from_gain(held, (*POSITIONS, *INTEGRALS), L)
    A = reduced_observer.compensator(observer, -K).loop.A
    return bool(np.allclose(A, loop_33(held, K, L), rtol=SAME, atol=SAME * float(np.abs(A).max())))


def _observer_gain(held: StateSpace, pole: float) -> Array:
    return (1 - pole) / timing.period(held.time) * np.eye(3, 6)


def unobservable_modes(of: Stage, integrals: bool, shown: bool = False) -> int:
    """Return the number of unobservable modes of `model`; `shown` takes the integrals as outputs, too."""
    m = model(of, integrals)
    return len(structure.uncontrollable_modes(m.A.T, np.eye(9, 6) if shown else m.C.T, m.states, m.time))


def uncontrollable_modes(of: Stage, integrals: bool) -> int:
    """Return the number of uncontrollable modes of `model`."""
    m = model(of, integrals)
    return len(structure.uncontrollable_modes(m.A, m.B, m.states, m.time))
