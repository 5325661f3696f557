"""GLSDC of a position from waves of four sources: the least-squares solution, within its bounds, at no higher cost."""

from functools import cache

import casadi as ca
import numpy as np
import pytest
from scipy import optimize

from synth.blocks.estimate import glsdc
from synth.blocks.estimate.glsdc import Descent, LdlFactors, LdlNormalEquations, Trial, Vector
from synth.signals import Signal
from synth.statespace import Array

SOURCES = np.array([[0.0, 0.0], [4.0, 0.0], [0.0, 3.0], [5.0, 5.0]])
DAMPING = (1e-6, 1e-6)
MOST = 4 / DAMPING[0]  # a column holds four cosines
BOUNDS = tuple(Signal(name, "m", -2, 2) for name in "xy")
USUAL = Descent(6, BOUNDS, slack=1e-8, decrease_tolerance=1e-8)  # of a deviation of 1 mm


def factorise(rows: list[list[ca.SX]], most: float) -> LdlFactors:
    """Return the factors of H'H + DAMPING, whose columns have |h_i|^2 <= `most` DAMPING_i."""
    return glsdc.factorise_information(glsdc.information(rows, rows, DAMPING), DAMPING, (1 + most) ** 0.5)[0]


@cache
def solver(of: Descent) -> ca.Function:
    """Return (place, waves) -> (displacement, converged, cost before, variances, Jacobian)."""
    q, V = ca.SX.sym("q", 2), ca.SX.sym("V", len(SOURCES))

    def waves(d: Vector) -> ca.SX:
        return ca.vcat([ca.sin(ca.sqrt((q[0] + d[0] - x) ** 2 + (q[1] + d[1] - y) ** 2)) for x, y in SOURCES])

    H = ca.jacobian(waves([ca.SX(0), ca.SX(0)]), q)
    rows = [ca.horzsplit(row) for row in ca.vertsplit(H)]
    factors = factorise(rows, MOST)

    def evaluate(i: int, at: Vector) -> Trial[LdlNormalEquations]:
        e, damped = ca.vertsplit(V - waves(at)), [w * v for w, v in zip(DAMPING, at, strict=True)]
        squares = glsdc.dot(e, e)
        gradient = [glsdc.dot([r[j] for r in rows], e) - damped[j] for j in range(len(at))]
        normal = LdlNormalEquations(factors, glsdc.substitute_forward(factors, gradient))
        return Trial(at, e, squares, squares + glsdc.dot(damped, at), normal)

    solution = glsdc.descend(evaluate, of)
    variances = ca.vcat(glsdc.variances(factors))
    return ca.Function("f", [q, V], [ca.vcat(solution.at), solution.converged, solution.first.cost, variances, H])


def read(at: Array) -> Array:
    return np.asarray(np.sin(np.linalg.norm(SOURCES - at, axis=1)))


def cost(q: Array, d: Array, V: Array) -> float:
    return float(((V - read(q + d)) ** 2).sum() + (DAMPING * d) @ d)


def test_the_result_is_the_least_squares_solution() -> None:
    rng = np.random.default_rng(1)
    for at in rng.uniform(1, 2, (20, 2)):
        V, q = read(at) + 1e-3 * rng.standard_normal(len(SOURCES)), at + rng.uniform(-0.05, 0.05, 2)
        d, converged, *_ = (np.asarray(v).ravel() for v in solver(USUAL)(q, V))
        best = optimize.least_squares(lambda d, q=q, V=V: V - read(q + d), np.zeros(2), xtol=1e-14).x
        assert converged[0] == 1 and np.abs(d - best).max() < 5e-4  # half a deviation


def rises(of: Descent) -> float:
    """Return the largest rise of the cost, for waves that no position produces."""
    rng = np.random.default_rng(2)
    worst = -np.inf
    for _ in range(300):
        q, V = rng.uniform(0, 4, 2), rng.uniform(-1, 1, len(SOURCES))
        d, _, before, *_ = (np.asarray(v).ravel() for v in solver(of)(q, V))
        assert (np.abs(d) <= 2).all()
        worst = max(worst, cost(q, d, V) - before[0])
    return worst


def test_no_sample_raises_the_cost() -> None:
    assert rises(USUAL) <= 5e-8
    assert rises(Descent(6, BOUNDS, slack=1e9, decrease_tolerance=1e-8)) > 0.1  # without the check it does


@pytest.mark.parametrize("most", [1e4 * MOST, 1e-3])
def test_variances_are_those_of_the_inverse(most: float) -> None:
    """They differ if the entries of L are at their bound, as for columns longer than `most` allows."""
    q = np.array([1.0, 2.0])
    H = np.asarray(solver(USUAL)(q, read(q))[-1]) * [1, 100]
    rows = [[ca.SX(v) for v in row] for row in H]
    variances = [float(v) for v in glsdc.variances(factorise(rows, most))]
    exact = np.linalg.inv(H.T @ H + np.diag(DAMPING)).diagonal()
    assert np.allclose(variances, exact, rtol=1e-12) == (most > 1)
