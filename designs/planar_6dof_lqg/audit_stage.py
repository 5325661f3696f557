"""The stage of (26), with the integrals of (31), and its optimal gains by lqrd.

(26) has the states x, y, phi and their rates d, f, v; (31) adds the integrals z1, z2, z3. With b and c for the printed
accelerations per ampere of (26)

    x'' = b i_C,    y'' = b (i_A + i_B),    phi'' = c (i_B - i_A)

so that K falls into three loops of one input: i_C, i_A = i_B, and -i_A = i_B, the last two with the weight 2 on it.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from designs.planar_6dof_leadlag.audit_bench import number
from synth.analyse import discretise
from synth.report.audit import Published
from synth.statespace import StateSpace
from synth.synthesise.feedback import lqr
from synth.timing import Continuous

Array = NDArray[np.float64]
Prints = Mapping[str, Published]

POSITIONS, INTEGRALS, RATES = ("x", "y", "phi"), ("z1", "z2", "z3"), ("d", "f", "v")
STATES = (*POSITIONS, *INTEGRALS, *RATES)
CURRENTS = ("i_AQ", "i_BQ", "i_CQ")
ROW = {"x": 2, "z1": 2, "d": 2}  # of K in which the gain of a state stands without a minus; else 1
MODEL = ("Y-5.per_ampere", "Y-6.per_ampere", "Y-7.rate_lqg")  # the printed numbers that the sampled (31) follows from


@dataclass(frozen=True)
class Stage:
    """b in m/s^2/A and c in rad/s^2/A of (26), and the sample period in s."""

    per_ampere: float
    turning: float
    period_s: float


def stage(published: Prints) -> Stage:
    """Return the stage of (26), sampled as the paper says."""
    b, c, rate = (number(published, source) for source in MODEL)
    return Stage(b, c, 1 / rate)


@cache
def model(of: Stage, integrals: bool) -> StateSpace:
    """Return (31), (32), or (26), (27) without the integrals, in continuous time."""
    b, c = of.per_ampere, of.turning
    A, B = np.zeros((9, 9)), np.vstack([np.zeros((6, 3)), [[0, 0, b], [b, b, 0], [-c, c, 0]]])
    A[:3, 6:] = A[3:6, :3] = np.eye(3)
    keep = [STATES.index(n) for n in STATES if integrals or n not in INTEGRALS]
    states = tuple(STATES[i] for i in keep)
    C, D = np.eye(3, len(keep)), np.zeros((3, 3))
    return StateSpace(A[np.ix_(keep, keep)], B[keep], C, D, states, CURRENTS, POSITIONS, Continuous())


@cache
def held(of: Stage) -> StateSpace:
    """Return (31), (32) sampled with the currents held."""
    return discretise.zero_order_hold(model(of, True), of.period_s)


def one(of: Stage, axis: str) -> tuple[StateSpace, float]:
    """Return an axis with its integral and rate and one input, and the weight on that input for R = I."""
    k = POSITIONS.index(axis)
    b = of.per_ampere if axis == "x" else 2 * (of.per_ampere if axis == "y" else of.turning)
    A, B = np.array([[0.0, 0, 1], [1, 0, 0], [0, 0, 0]]), np.array([[0.0], [0], [b]])
    states = (POSITIONS[k], INTEGRALS[k], RATES[k])
    chain = StateSpace(A, B, np.eye(1, 3), np.zeros((1, 1)), states, ("i",), (axis,), Continuous())
    return chain, 1.0 if axis == "x" else 2.0


@cache
def gains(of: Stage, q: tuple[float, ...], r: float = 1.0) -> Mapping[str, float]:
    """Return the size of each gain of lqrd, by state, for diagonal weights in the order of STATES."""
    K = -lqr.lqrd(model(of, True), np.array(q), r * np.ones(3), of.period_s).K
    return {n: float(K[ROW.get(n, 1), i]) for i, n in enumerate(STATES)}


def matrix(size: Mapping[str, float]) -> Array:
    """Return K (3, 9) of (49) from the sizes of its gains by state, u = -K x."""
    k = np.array([size[n] for n in STATES])
    x, y, phi = (np.tile(np.arange(3) == i, 3) * k for i in range(3))
    return np.array([y - phi, y + phi, x])


@cache
def weights(of: Stage, axis: str, wanted: tuple[float, ...]) -> Mapping[str, float]:
    """Return the diagonal weights on an axis, its integral and its rate for which lqrd gives three gains K.

    K and the cost-to-go X of the sampled model are linear in the weights q on state and input, W(q) over a period:

        X = F'X F + [I; -K]' W [I; -K],    G'X F + W_ux - W_uu K = 0,    F = A - G K

    nine equations in the six entries of X and the three of q.
    """
    chain, r = one(of, axis)
    sampled, K = discretise.zero_order_hold(chain, of.period_s), np.array([wanted])
    closed, both = sampled.A - sampled.B @ K, np.vstack([np.eye(3), -K])

    def left(x: Array, q: Array) -> Array:
        X, W = np.zeros((3, 3)), _over_a_period(chain, np.append(q[:3], q[3:] * r), of.period_s)
        X[np.triu_indices(3)] = x
        X = X + np.triu(X, 1).T
        cost = closed.T @ X @ closed - X + both.T @ W @ both
        return np.append(cost[np.triu_indices(3)], sampled.B.T @ X @ closed + (W @ both)[3:])

    unknowns = np.eye(10)
    columns = np.array([left(e[:6], e[6:]) for e in unknowns]).T
    found = np.linalg.solve(columns[:, :9], -columns[:, 9])
    return dict(zip(chain.states, found[6:].tolist(), strict=True))


def _over_a_period(chain: StateSpace, q: Array, period_s: float) -> Array:
    """Return W (4, 4) of [x; u]' W [x; u], what x'diag(q) x + q_4 u^2 gathers over a period with u held."""
    F = np.vstack([np.hstack([chain.A, chain.B]), np.zeros((1, 4))])
    return discretise.gramian(F, np.diag(q), period_s).W
