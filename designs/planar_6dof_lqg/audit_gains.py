"""Audit of the optimal gains: (49) by lqrd, (42) by the filter's Riccati equation, (33)-(35) and what is observable.

`audit_stage` states the model. All of it follows from the printed (26), with the yaw of motor C left out (Y-23).
"""

from dataclasses import replace
from decimal import Decimal
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_continuous_are
from scipy.optimize import linear_sum_assignment

from designs.planar_6dof_lqg import audit_stage
from designs.planar_6dof_lqg.audit_stage import INTEGRALS, MODEL, POSITIONS, RATES, STATES, Array, Prints
from synth import timing
from synth.analyse import structure
from synth.report.audit import Printed, Published, Row, judge, row
from synth.statespace import StateSpace
from synth.synthesise.observers import kalman, reduced_compensator, reduced_observer

WEIGHTS = (1e4, 1e3, 1e3, 1e10, 1e9, 1e10, 1e2, 1e1, 2e1)  # on STATES: those that make (49); not printed
LOST = 4  # places by which the scan's decimal points are too far right in the gains of the rates
POLES = (0.0, 0.35, 0.7)  # of observers that work, L = (1 - p) / T
SAME = 1e-9  # distance of poles in z that are one


def optimal(published: Prints, printed: Published) -> Row:
    """Y-10: recompute (49) with the weights that make it, and recover these from (49)."""
    of, point = audit_stage.stage(published), _with_points(printed)
    found = audit_stage.gains(of, WEIGHTS)
    recovered: dict[str, float] = {}
    for k, axis in enumerate(POSITIONS):
        recovered |= audit_stage.weights(of, axis, tuple(point[n].value for n in STATES[k::3]))
    figures = [(f"gain of {n}", found[n], printed[n].unit) for n in STATES]
    figures += [(f"weight on {n} from the printed gains", recovered[n], "1") for n in STATES]
    why = (
        "Rule: all nine gains within one unit of the last printed digit. Not with the printed decimal points and Q "
        "(Y-11); with four places more behind the points of the rates' gains, which the scan lost, and Q = diag("
        f"{', '.join(f'{q:g}' for q in WEIGHTS)}), R = I, at 800 Hz. Each axis' three gains have one solution in "
        "three weights, near these."
    )
    mended = all(point[n].agrees(value) for n, value in found.items())
    as_printed = all(printed[n].agrees(value) for n, value in found.items())
    depends = (*MODEL, *(f"Y-10.{n}" for n in STATES))
    return row(printed, figures, judge(as_printed, mended), why, depends)


def printed_weights(published: Prints, printed: Published) -> Row:
    """Y-11: recompute (49) with the weights as printed."""
    q = tuple(printed[f"q_{n}"].value for n in STATES)
    found = audit_stage.gains(audit_stage.stage(published), q, printed["r"].value)
    wanted = _with_points(published["Y-10"])
    figures = [(f"gain of {n}", value, wanted[n].unit) for n, value in found.items()]
    why = (
        "Rule: all nine gains within one unit of the last printed digit of (49), its decimal points mended. None is; "
        "Y-10 has the weights that make it."
    )
    agree = all(wanted[n].agrees(value) for n, value in found.items())
    return row(printed, figures, judge(agree), why, (*MODEL, *(f"Y-11.{n}" for n in printed.numbers)))


def kalman_gain(published: Prints, printed: Published) -> Row:
    """Y-12: recompute (42) by (41), for (26) and for the sampled model's parts."""
    held, theta = audit_stage.held(audit_stage.stage(published)), printed["theta"].value
    plain = kalman.continuous(audit_stage.model(audit_stage.stage(published), False), np.eye(6), theta * np.eye(3)).L
    H = misapplied(held, theta)
    poles = np.linalg.eigvals(held.A[6:, 6:] - H @ held.A[:6, 6:])
    figures = [
        ("H, own position, (41) for (26) with L Psi L' = I", plain[0, 0], "1/s"),
        ("H, own position", H[0, 0], "1/s"),
        ("H, another position", H[0, 1], "1/s"),
        ("H, own integral", H[0, 3], "1/s^2"),
        ("greatest |z| of A22 - H A12", float(np.abs(poles).max()), "1"),
    ]
    why = (
        "Rule: the three sizes of entry within one unit of the last printed digit. (41) for (26), (27) gives a matrix "
        "of 6 rows with other entries. The printed one, of 3 rows, solves the continuous (41) for the sampled A22 = I, "
        "A12 = (T I; T^2/2 I) at 800 Hz, with Theta = 5e-5 I and all entries of L Psi L' 5e-5. As the gain of a "
        "sampled observer that is no filter: its error has poles at z = -1 and just beyond and does not decay."
    )
    named = dict(zip(("own", "other", "integral"), (float(f[1]) for f in figures[1:4]), strict=True))
    mended = all(printed[n].agrees(value) for n, value in named.items())
    as_printed = printed["own"].agrees(plain[0, 0]) and printed["other"].agrees(plain[0, 1])
    return row(printed, figures, judge(as_printed, mended), why, ("Y-7.rate_lqg", "Y-12.theta"))


def separation(published: Prints, printed: Published) -> Row:
    """Y-36: recompute the poles of (33) term by term and compare them with those of its parts."""
    held = audit_stage.held(audit_stage.stage(published))
    K = audit_stage.matrix({n: gain.value for n, gain in _with_points(published["Y-10"]).items()})
    closed, figures = held.A - held.B @ K, []
    for p in POLES:
        L = (1 - p) / timing.period(held.time) * np.eye(3, 6)
        whole = np.linalg.eigvals(loop_33(held, K, L))
        parts = np.concatenate([np.linalg.eigvals(closed), np.linalg.eigvals(held.A[6:, 6:] - L @ held.A[:6, 6:])])
        figures.append((f"poles that are those of the parts, observer {p:g}", float(_common(whole, parts)), "1"))
    for k, axis in enumerate(POSITIONS):  # A - B K keeps the axes apart
        greatest = float(np.abs(np.linalg.eigvals(closed[k::3, k::3])).max())
        figures.append((f"greatest |z| of A - B K, {axis}", greatest, "1"))
    why = (
        "Rule: all twelve poles of (33), built from its printed blocks for the sampled (31) with (49), are within 1e-9 "
        "of those of A - B K and A22 - L A12, for L = (1 - p)/T on the positions, p = 0, 0.35 and 0.7; and (33) is the "
        "loop that the library builds."
    )
    agree = all(count == 12 for _, count, _ in figures[: len(POLES)]) and _is_the_loop(held, K)
    return row(printed, figures, judge(agree), why, (*MODEL, *(f"Y-10.{n}" for n in STATES)))


def observability(published: Prints, printed: Published) -> Row:
    """Y-37: recount the modes that no input moves and that no output shows."""
    of = audit_stage.stage(published)
    plain, whole = audit_stage.model(of, False), audit_stage.model(of, True)
    shown = replace(whole, C=np.eye(6, 9), D=np.zeros((6, 3)), outputs=(*POSITIONS, *INTEGRALS))
    cases = {"(26), (27)": plain, "(31), (32)": whole, "(31) with the integrals as outputs": shown}
    hidden = {n: len(structure.unmoved(m.A.T, m.C.T, m.states, m.time)) for n, m in cases.items()}
    stuck = {n: len(structure.unmoved(m.A, m.B, m.states, m.time)) for n, m in cases.items()}
    figures = [(f"modes that no output of {n} shows", float(k), "1") for n, k in hidden.items()]
    figures += [(f"modes that no input of {n} moves", float(k), "1") for n, k in list(stuck.items())[:2]]
    why = (
        "Rule: no mode is left that no input moves or no output shows. The integrals of (31) move nothing that (32) "
        "shows; they are known all the same, since the controller computes them, and with them as outputs, as (42) "
        "takes them, all modes show."
    )
    as_printed = not any((*stuck.values(), hidden["(26), (27)"], hidden["(31), (32)"]))
    mended = not any((*stuck.values(), hidden["(26), (27)"], hidden["(31) with the integrals as outputs"]))
    return row(printed, figures, judge(as_printed, mended), why)


def misapplied(held: StateSpace, theta: float) -> Array:
    """Return H (3, 6) of the continuous (41) for the sampled A22, A12, Theta = theta I and L Psi L' = theta ones."""
    A12 = held.A[:6, 6:]
    sigma = solve_continuous_are(held.A[6:, 6:].T, A12.T, np.full((3, 3), theta), theta * np.eye(6))
    return np.asarray(sigma @ A12.T / theta)


def loop_33(held: StateSpace, K: Array, L: Array) -> Array:
    """Return the matrix (12, 12) of (33) on x1, x2 and x3 = x2^ - L x1."""
    A11, A12, A21, A22 = held.A[:6, :6], held.A[:6, 6:], held.A[6:, :6], held.A[6:, 6:]
    B1, B2, k1, k2 = held.B[:6], held.B[6:], K[:, :6], K[:, 6:]
    first = [
        A11 - B1 @ k1 - B1 @ k2 @ L,
        A21 - B2 @ k1 - B2 @ k2 @ L,
        (A22 - L @ A12) @ L + A21 - L @ A11 - (B2 - L @ B1) @ (k1 + k2 @ L),
    ]
    second = [A12, A22, np.zeros((3, 3))]
    third = [-B1 @ k2, -B2 @ k2, A22 - L @ A12 - B2 @ k2 + L @ B1 @ k2]
    return np.block([list(blocks) for blocks in zip(first, second, third, strict=True)])


def _is_the_loop(held: StateSpace, K: Array) -> bool:
    """Tell whether (33) is the loop of a reduced-order observer with the sampled model."""
    L = 0.5 / timing.period(held.time) * np.eye(3, 6)
    observer = reduced_observer.from_gain(held, (*POSITIONS, *INTEGRALS), L)
    found = reduced_compensator.compensator(observer, -K).loop.A
    return bool(np.allclose(found, loop_33(held, K, L), rtol=SAME, atol=SAME * float(np.abs(found).max())))


def _common(found: NDArray[Any], wanted: NDArray[Any]) -> int:
    """Return how many of two sets of poles, paired as near as can be, are the same."""
    distance = np.abs(found[:, None] - wanted)
    return int((distance[linear_sum_assignment(distance)] < SAME).sum())


def _with_points(printed: Published) -> dict[str, Printed]:
    """Return the printed gains by state, with the decimal points that the scan lost."""
    found = {n: printed[n] for n in STATES}
    mended = {n: Printed(str(Decimal(found[n].text).scaleb(-LOST)), found[n].unit) for n in RATES}
    return found | mended
