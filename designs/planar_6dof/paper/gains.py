"""Audit of the optimal gains: (49) by lqrd, (42) by the filter's Riccati equation, (33)-(35) and what is observable.

(26) has the states x, y, phi and their rates d, f, v; (31) adds the integrals z1, z2, z3. With b and c for the printed
accelerations per ampere of (26), the yaw of motor C left out (Y-23),

    x'' = b i_C,    y'' = b (i_A + i_B),    phi'' = c (i_B - i_A)

so that K falls into three loops of one input: i_C, i_A = i_B, and -i_A = i_B, the last two with the weight 2 on it.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from decimal import Decimal
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_continuous_are
from scipy.optimize import linear_sum_assignment

from designs.planar_6dof import lqg
from designs.planar_6dof.lqg import STATES, WEIGHTS
from designs.planar_6dof.paper.bench import Bench
from synth import timing
from synth.analyse import discretise, structure
from synth.report.audit import Outcome, Printed, Published, recomputes
from synth.statespace import StateSpace
from synth.synthesise.feedback import lqr
from synth.synthesise.observers import kalman, reduced_compensator, reduced_observer
from synth.timing import Continuous

Array = NDArray[np.float64]

POSITIONS, INTEGRALS, RATES = STATES[:3], STATES[3:6], STATES[6:]
ROW = {"x": 2, "z1": 2, "d": 2}  # of K in which the gain of a state stands without a minus; else 1
MODEL = ("Y-5.per_ampere", "Y-6.per_ampere", "Y-7.rate_lqg")  # the printed numbers that the sampled (31) follows from
LOST = 4  # places by which the scan's decimal points are too far right in the gains of the rates
POLES = (0.0, 0.35, 0.7)  # of observers that work, L = (1 - p) / T
SAME = 1e-9  # distance of poles in z that are one


@recomputes("Y-10", *MODEL, "Y-10.*")
def optimal(bench: Bench, printed: Published) -> Outcome:
    """Recompute (49) with the weights that make it, and recover these from (49)."""
    of, point = stage_of(bench), _with_points(printed)
    computed = gains(of, WEIGHTS)
    recovered: dict[str, float] = {}
    for k, axis in enumerate(POSITIONS):
        recovered |= weights(of, axis, tuple(point[n].value for n in STATES[k::3]))
    figures = [(f"gain of {n}", computed[n], printed[n].unit) for n in STATES]
    figures += [(f"weight on {n} from the printed gains", recovered[n], "1") for n in STATES]
    return Outcome(figures, *(all(p[n].agrees(value) for n, value in computed.items()) for p in (printed, point)))


@recomputes("Y-11", *MODEL, "Y-11.*")
def printed_weights(bench: Bench, printed: Published) -> Outcome:
    """Recompute (49) with the weights as printed."""
    q, wanted = tuple(printed[f"q_{n}"].value for n in STATES), _with_points(bench.published["Y-10"])
    computed = gains(stage_of(bench), q, printed["r"].value)
    figures = [(f"gain of {n}", value, wanted[n].unit) for n, value in computed.items()]
    return Outcome(figures, all(wanted[n].agrees(value) for n, value in computed.items()))


@recomputes("Y-36", *MODEL, "Y-10.*")
def separation(bench: Bench, printed: Published) -> Outcome:
    """Recompute the poles of (33) term by term and compare them with those of its parts."""
    held = sampled(stage_of(bench))
    K = matrix({n: gain.value for n, gain in _with_points(bench.published["Y-10"]).items()})
    closed, figures = held.A - held.B @ K, []
    for p in POLES:
        L = _observer_gain(held, p)
        whole = np.linalg.eigvals(loop_33(held, K, L))
        parts = np.concatenate([np.linalg.eigvals(closed), np.linalg.eigvals(held.A[6:, 6:] - L @ held.A[:6, 6:])])
        figures.append((f"poles that are those of the parts, observer {p:g}", float(_common(whole, parts)), "1"))
    for k, axis in enumerate(POSITIONS):  # A - B K keeps the axes apart
        greatest = float(np.abs(np.linalg.eigvals(closed[k::3, k::3])).max())
        figures.append((f"greatest |z| of A - B K, {axis}", greatest, "1"))
    return Outcome(figures, all(count == 12 for _, count, _ in figures[: len(POLES)]) and _is_the_loop(held, K))


@recomputes("Y-37")
def observability(bench: Bench, printed: Published) -> Outcome:
    """Recount the modes that no input moves and that no output shows."""
    plain, whole = (model(stage_of(bench), integrals) for integrals in (False, True))
    shown = replace(whole, C=np.eye(6, 9), D=np.zeros((6, 3)), outputs=(*POSITIONS, *INTEGRALS))
    cases = {"(26), (27)": plain, "(31), (32)": whole, "(31) with the integrals as outputs": shown}
    hidden = {n: len(structure.unmoved(m.A.T, m.C.T, m.states, m.time)) for n, m in cases.items()}
    stuck = {n: len(structure.unmoved(m.A, m.B, m.states, m.time)) for n, m in list(cases.items())[:2]}
    figures = [(f"modes that no output of {n} shows", float(k), "1") for n, k in hidden.items()]
    figures += [(f"modes that no input of {n} moves", float(k), "1") for n, k in stuck.items()]
    first, second, corrected = (not any((*stuck.values(), k)) for k in hidden.values())
    return Outcome(figures, first and second, first and corrected)


@dataclass(frozen=True)
class Stage:
    """b in m/s^2/A and c in rad/s^2/A of (26), and the sample period in s."""

    per_ampere: float
    turning: float
    period_s: float


def stage_of(bench: Bench) -> Stage:
    """Return the stage of (26), sampled as the paper says."""
    b, c, rate = (bench.printed(source) for source in MODEL)
    return Stage(b, c, 1 / rate)


@cache
def model(of: Stage, integrals: bool) -> StateSpace:
    """Return (31), (32), or (26), (27) without the integrals, in continuous time."""
    whole = lqg.model(of.per_ampere, of.turning)
    if integrals:
        return whole
    keep = [i for i, name in enumerate(STATES) if name not in INTEGRALS]
    A, B, C = whole.A[np.ix_(keep, keep)], whole.B[keep], whole.C[:, keep]
    return replace(whole, A=A, B=B, C=C, states=tuple(STATES[i] for i in keep), units={})


@cache
def sampled(of: Stage) -> StateSpace:
    """Return (31), (32) sampled with the currents held."""
    return discretise.zero_order_hold(model(of, True), of.period_s)


def one(of: Stage, axis: str) -> tuple[StateSpace, float]:
    """Return an axis with its integral and rate and one input, and the weight on that input for R = I."""
    k = POSITIONS.index(axis)
    b = of.per_ampere if axis == "x" else 2 * (of.per_ampere if axis == "y" else of.turning)
    A, B = np.array([[0.0, 0, 1], [1, 0, 0], [0, 0, 0]]), np.array([[0.0], [0], [b]])
    chain = StateSpace(A, B, np.eye(1, 3), np.zeros((1, 1)), STATES[k::3], ("i",), (axis,), Continuous())
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
    flow = np.vstack([np.hstack([chain.A, chain.B]), np.zeros((1, 4))])

    def left(x: Array, q: Array) -> Array:
        X, W = np.zeros((3, 3)), discretise.gramian(flow, np.diag(np.append(q[:3], q[3:] * r)), of.period_s).W
        X[np.triu_indices(3)] = x
        X = X + np.triu(X, 1).T
        cost = closed.T @ X @ closed - X + both.T @ W @ both
        return np.append(cost[np.triu_indices(3)], sampled.B.T @ X @ closed + (W @ both)[3:])

    columns = np.array([left(e[:6], e[6:]) for e in np.eye(10)]).T
    solution = np.linalg.solve(columns[:, :9], -columns[:, 9])
    return dict(zip(chain.states, solution[6:].tolist(), strict=True))


def unsampled_gain(of: Stage, theta: float) -> Array:
    """Return the gain of (41) for (26), (27) with Theta = theta I and L Psi L' = I."""
    return kalman.continuous(model(of, False), np.eye(6), theta * np.eye(3)).L


def misapplied(of: Stage, theta: float) -> Array:
    """Return H (3, 6) of the continuous (41) for the sampled A22, A12, Theta = theta I and L Psi L' = theta ones."""
    held = sampled(of)
    A12 = held.A[:6, 6:]
    sigma = solve_continuous_are(held.A[6:, 6:].T, A12.T, np.full((3, 3), theta), theta * np.eye(6))
    return np.asarray(sigma @ A12.T / theta)


def greatest_pole(of: Stage, H: Array) -> float:
    """Return the greatest |z| of A22 - H A12."""
    held = sampled(of)
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


def _observer_gain(held: StateSpace, pole: float) -> Array:
    return (1 - pole) / timing.period(held.time) * np.eye(3, 6)


def _is_the_loop(held: StateSpace, K: Array) -> bool:
    """Tell whether (33) is the loop of a reduced-order observer with the sampled model."""
    L = _observer_gain(held, 0.5)
    observer = reduced_observer.from_gain(held, (*POSITIONS, *INTEGRALS), L)
    A = reduced_compensator.compensator(observer, -K).loop.A
    return bool(np.allclose(A, loop_33(held, K, L), rtol=SAME, atol=SAME * float(np.abs(A).max())))


def _common(poles: NDArray[Any], wanted: NDArray[Any]) -> int:
    """Return how many of two sets of poles, paired as near as can be, are the same."""
    distance = np.abs(poles[:, None] - wanted)
    return int((distance[linear_sum_assignment(distance)] < SAME).sum())


def _with_points(printed: Published) -> dict[str, Printed]:
    """Return the printed gains by state, with the decimal points that the scan lost."""
    lost = {n: printed[n].text for n in RATES}
    mended = {n: Printed(str(Decimal(text).scaleb(-LOST)), printed[n].unit) for n, text in lost.items()}
    return {n: printed[n] for n in STATES} | mended
