"""Corrections without an excluded group by a rank update: against NumPy, of every number of the group, and a defect."""

from dataclasses import replace

import casadi as ca
import numpy as np
import pytest

from synth.blocks.estimate import glsdc_integrity, glsdc_jacobian, glsdc_monitor
from synth.blocks.estimate.glsdc_integrity import Integrity
from synth.blocks.estimate.glsdc_model import Implicit, Unknown
from synth.blocks.estimate.glsdc_solution import Iteration, Problem
from synth.signals import Signal
from synth.statespace import Array

CHANNELS = [Signal(f"y_{k}", "V", -2.0, 2.0) for k in range(6)]
UNKNOWNS = [
    Unknown(Signal("x", "m", -5.0, 5.0), 5.0, 4.0),
    Unknown(Signal("size", "1", -5.0, 5.0), 2.0, 4.0, prior=0.5, prior_value=1.0),
]
GROUPS = [["y_0", "y_1"], ["y_2", "y_3"], ["y_4", "y_5"]]
ROWS = np.array([[1.0, 0.3], [0.2, 1.1], [-0.7, 0.4], [0.5, -0.9], [0.8, 0.8], [-0.4, 1.3]])
Y, SIGMA = np.array([0.4, -0.2, 0.9, 0.3, -0.5, 1.1]), 0.5


def model() -> glsdc_jacobian.Model:
    """Return a linear model, of which one correction is the solution."""

    def residual(q: dict[str, ca.SX], y: dict[str, ca.SX], k: object) -> dict[str, ca.SX]:
        return {s.name: y[s.name] - r[0] * q["x"] - r[1] * q["size"] for s, r in zip(CHANNELS, ROWS, strict=True)}

    return glsdc_jacobian.model(Implicit(residual), SIGMA**2 * np.eye(6), CHANNELS, (), UNKNOWNS, (), ())


def solution(number: int, corrections: int, defect: float = 0.0) -> tuple[Array, Array, float]:
    """Return the displacement, the variances and the least cost; a `defect` adds to the gains of the rank update."""
    of, excluded = model(), ca.SX(number)
    monitor = glsdc_monitor.monitor(of, Integrity({"x": 1.0}, exclude=True, groups=GROUPS))
    weights = glsdc_monitor.weights(monitor, {"excluded": excluded})
    start = [ca.SX(0.1), ca.SX(1.2)]
    prediction = glsdc_jacobian.predict(of, start, [ca.SX(float(v)) for v in Y], ca.SX(0, 1), [])
    problem = Problem(of, prediction, [ca.SX(0), ca.SX(0.2)], weights)
    axes = [{j: ca.SX(1)} for j in range(6)]
    iteration = Iteration(corrections, held_jacobian=True)
    result, _ = glsdc_integrity.solve(problem, iteration, monitor.groups, excluded, axes)
    normal = result.last.normal
    if defect:
        normal = replace(normal, removal=replace(normal.removal, gains=[g + defect for g in normal.removal.gains]))
    at, variances = (np.array([float(ca.evalf(v)) for v in each]) for each in (result.at, normal.variances))
    return at, variances, float(ca.evalf(result.last.cost - normal.decrease))


def reference_solution(number: int) -> tuple[Array, Array, float]:
    used = np.repeat(np.arange(1, 4) != number, 2)
    H, y, weight = ROWS[used], Y[used], (SIGMA / 0.5) ** 2
    N = H.T @ H + np.diag([0, weight])
    q = np.linalg.solve(N, H.T @ y + [0, weight])
    cost = np.sum((y - H @ q) ** 2) + weight * (q[1] - 1) ** 2
    return q - [0.1, 1.2], np.diag(np.linalg.inv(N)), float(cost)


@pytest.mark.parametrize("number", range(4))
@pytest.mark.parametrize("corrections", [1, 2])
def test_the_rank_update_is_the_solution_without_the_group(number: int, corrections: int) -> None:
    for value, reference in zip(solution(number, corrections), reference_solution(number), strict=True):
        np.testing.assert_allclose(value, reference, rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize("count", range(1, 9))
def test_a_value_is_chosen_by_its_number(count: int) -> None:
    n, values = ca.SX.sym("n"), [ca.SX(float(10 + k)) for k in range(1, count + 1)]
    chosen = ca.Function("chosen", [n], [glsdc_integrity.choose(n, values)])
    assert [float(chosen(k)) for k in range(count + 1)] == [11.0, *(10.0 + k for k in range(1, count + 1))]
