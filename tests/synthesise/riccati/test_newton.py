"""Newton's method: the residual against ball arithmetic, what follows from a small step, starts that are far off."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from synth.analyse.numerics import precise
from synth.synthesise.riccati import doubling, exact_riccati, newton
from synth.synthesise.riccati.equation import Equation, Solution
from tests import tolerances
from tests.synthesise.riccati.test_doubling import random_equation


def exact_residual(e: Equation, X: np.ndarray) -> np.ndarray:
    """The residual with its sign, rounded from balls."""
    with precise.precision(512):
        balls = exact_riccati._problem(e).residual(precise.matrix(X))
        return np.array([float(v.mid()) for v in balls.entries()]).reshape(X.shape)


def certified_solution(e: Equation) -> newton.CertifiedSolution:
    bilinear = doubling.bilinear_map(e)
    start = doubling.solution(e, bilinear)
    assert start is not None
    certified = newton.refine(e, start, bilinear)
    assert certified is not None
    return certified


@pytest.mark.parametrize("continuous", [True, False])
@settings(derandomize=True, max_examples=30, deadline=None)
@given(seed=st.integers(0, 10**6))
def test_the_residual_of_a_solution_is_that_of_ball_arithmetic(continuous: bool, seed: int) -> None:
    """It is some 1e-16 of the terms, and known to 1e-20 of them: four digits where double has none."""
    e = random_equation(seed, continuous)
    X = certified_solution(e).solution.X
    T = e.terms(X).max()
    residual, L = e.residual(X)
    assert np.abs(residual - exact_residual(e, X)).max() <= 1e-20 * T
    with precise.precision():
        exact_L = precise.rounded(exact_riccati._problem(e).feedback(precise.matrix(X)))
    np.testing.assert_allclose(L, exact_L, rtol=0, atol=2 * tolerances.of("last_bit") * np.abs(exact_L).max())


@pytest.mark.parametrize("continuous", [True, False])
def test_the_residual_in_plain_double_precision_would_not_do(continuous: bool) -> None:
    missed = []
    for seed in range(10):
        e = random_equation(seed, continuous)
        X = certified_solution(e).solution.X
        P = X @ e.B + e.N if continuous else e.A.T @ X @ e.B + e.N
        linear_terms = e.A.T @ X + X @ e.A if continuous else e.A.T @ X @ e.A - X
        plain = linear_terms - P @ np.linalg.solve(e.weight(X), P.T) + e.Q
        missed.append(np.abs(plain - exact_residual(e, X)).max() / e.terms(X).max())
    assert np.median(missed) > 1e-18


@pytest.mark.parametrize("continuous", [True, False])
@settings(derandomize=True, max_examples=20, deadline=None)
@given(seed=st.integers(0, 10**6))
def test_after_a_small_step_the_residual_follows(continuous: bool, seed: int) -> None:
    e = random_equation(seed, continuous)
    X = certified_solution(e).solution.X
    E = np.random.default_rng(seed).normal(size=X.shape)
    near = X + 1e-11 * (E + E.T) * np.abs(X).max()
    defect, L = e.residual(X)
    iterate = newton._Iterate.of(e, Solution(X, L, e.A - e.B @ L, defect, np.zeros_like(X)))
    updated, updated_L = iterate.update_residual(e, near)
    there, fresh = e.residual(near)
    np.testing.assert_allclose(updated, there, rtol=0, atol=1e-6 * np.abs(there).max())
    np.testing.assert_allclose(updated_L, fresh, rtol=0, atol=4 * tolerances.of("last_bit") * np.abs(L).max())


def test_from_far_newton_reaches_the_solution() -> None:
    e = random_equation(3, True)
    right = certified_solution(e).solution.X
    certified = newton.refine(e, 10 * right, doubling.bilinear_map(e))
    assert certified is not None
    np.testing.assert_allclose(certified.solution.X, right, rtol=tolerances.of("folded"))


def test_a_start_whose_loop_does_not_decay_is_given_up() -> None:
    """x' = x + u: u = -x / 2 leaves the pole 1/2."""
    e = Equation(np.eye(1), np.eye(1), 3 * np.eye(1), np.eye(1), np.zeros((1, 1)), True)
    assert newton.refine(e, np.array([[0.5]]), doubling.bilinear_map(e)) is None
    sampled = Equation(np.eye(1), np.eye(1), np.eye(1), np.eye(1), np.zeros((1, 1)), False)
    assert newton.refine(sampled, np.array([[-2.0]]), doubling.bilinear_map(sampled)) is None  # R + B'XB < 0


def test_an_asymmetric_start_does_not_deceive_the_certificate() -> None:
    """The residual is that of a symmetric X: what is asymmetric would not show in it."""
    e = random_equation(12, True)
    right = certified_solution(e).solution.X
    assert len(right) > 1
    E = np.triu(np.ones_like(right), 1) * 1e-3 * np.abs(right).max()
    certified = newton.refine(e, right + E, doubling.bilinear_map(e))
    assert certified is not None
    np.testing.assert_array_equal(certified.solution.X, certified.solution.X.T)
    np.testing.assert_allclose(certified.solution.X, right, rtol=tolerances.of("folded"))
