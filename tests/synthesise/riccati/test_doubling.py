"""Doubling against SciPy's direct solvers; the bilinear maps must change nothing but the number of passes."""

import numpy as np
import pytest
import scipy.linalg
from hypothesis import given, settings
from hypothesis import strategies as st

from synth.synthesise.riccati import equation
from synth.synthesise.riccati.equation import Equation


def random_equation(seed: int, continuous: bool) -> Equation:
    rng = np.random.default_rng(seed)
    n, m = int(rng.integers(1, 6)), int(rng.integers(1, 3))
    W = rng.normal(size=(n + m, n + m))
    W = W @ W.T + 0.1 * np.eye(n + m)
    return Equation(
        rng.normal(size=(n, n)), rng.normal(size=(n, m)), W[:n, :n], W[n:, n:], W[:n, n:], continuous=continuous
    )


@pytest.mark.parametrize("continuous", [True, False])
@settings(derandomize=True, max_examples=20, deadline=None)
@given(seed=st.integers(0, 10**6), rate=st.floats(0.1, 10.0))
def test_what_a_decaying_state_costs_is_scipys(continuous: bool, seed: int, rate: float) -> None:
    """The linear equations are solved to some four digits, which is what Newton's steps need."""
    rng = np.random.default_rng(seed)
    n = int(rng.integers(1, 6))
    A = rng.normal(size=(n, n))
    A = A - (np.linalg.eigvals(A).real.max() + 0.3) * np.eye(n) if continuous else A / 1.1 / np.linalg.norm(A, 2)
    C = rng.normal(size=(n, n))
    W = C + C.T
    decay = equation.stable_map(A, equation.Bilinear(rate, continuous))
    assert decay is not None
    solver = scipy.linalg.solve_continuous_lyapunov if continuous else scipy.linalg.solve_discrete_lyapunov
    Y = solver(A.T, -W if continuous else W)
    np.testing.assert_allclose(decay.gramian(W), Y, rtol=0, atol=1e-3 * np.abs(Y).max())


@pytest.mark.parametrize("continuous", [True, False])
def test_what_does_not_decay_has_no_cost(continuous: bool) -> None:
    edge = 0.0 if continuous else 1.0
    for value in (edge, edge + 0.5):
        assert equation.stable_map(np.diag([edge - 0.5, value]), equation.Bilinear(1.0, continuous)) is None


def test_the_rate_keeps_off_an_eigenvalue_of_the_model() -> None:
    """x' = x + u, Q small: the loop's pole is -1.0000005, and c = 1 would make c I - A singular."""
    e = Equation(np.eye(1), np.eye(1), 1e-6 * np.eye(1), np.eye(1), np.zeros((1, 1)), True)
    assert abs(equation.bilinear_map(e).c - 1) > 0.5


def test_a_short_period_takes_no_more_passes() -> None:
    """The map moves poles near z = 1 towards 0: powers for a pole at 1 - 1e-6 are as many as for one at 0.5."""
    counts = []
    for pole in (0.5, 1 - 1e-6):
        e = Equation(np.array([[pole]]), (1 - pole) * np.eye(1), 1e-3 * np.eye(1), np.eye(1), np.zeros((1, 1)), False)
        decay = equation.stable_map(e.A, equation.bilinear_map(e))
        assert decay is not None
        counts.append(len(decay.powers))
    plain = equation.stable_map(np.array([[1 - 1e-6]]), equation.Bilinear(1.0, False))
    assert plain is not None and max(counts) <= 4 < 20 < len(plain.powers)
