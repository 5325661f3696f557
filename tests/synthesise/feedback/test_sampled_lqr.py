"""The cost held over a sample period against quadrature, closed forms and simulation."""

import numpy as np
import pytest
import scipy.linalg
from hypothesis import given, settings
from hypothesis import strategies as st

from synth.errors import ModelError
from synth.statespace import StateSpace
from synth.synthesise.feedback import lqr
from synth.timing import Discrete
from tests import tolerances
from tests.synthesise.feedback.problems import model, random_problem


@settings(derandomize=True, max_examples=10, deadline=None)
@given(st.integers(0, 10**6), st.floats(0.01, 0.5))
def test_the_period_cost_agrees_with_quadrature(seed: int, T: float) -> None:
    c, Q, R = random_problem(seed)
    n, m = c.B.shape
    F, weight = np.block([[c.A, c.B], [np.zeros((m, n + m))]]), scipy.linalg.block_diag(Q, R)

    nodes, weights = np.polynomial.legendre.leggauss(20)
    flows = [scipy.linalg.expm(F * T / 2 * (v + 1)) for v in nodes]
    W = T / 2 * sum(w * M.T @ weight @ M for w, M in zip(weights, flows, strict=True))
    cost = lqr.sampled_cost(c, Q, R, T)
    ours = np.block([[cost.Q, cost.N], [cost.N.T, cost.R]])
    np.testing.assert_allclose(ours, W, rtol=0, atol=tolerances.of("quadrature") * np.abs(W).max())
    assert np.abs(cost.N).max() > 1e-6 * np.abs(W).max()  # a cross term where Q and R have none


def test_the_period_cost_of_an_integrator_is_its_closed_form() -> None:
    """x' = u, Q = R = 1: W = [[T, T^2/2], [T^2/2, T + T^3/3]]."""
    T = 0.5
    cost = lqr.sampled_cost(model([[0]], [[1]]), [[1]], [[1]], T)
    assert (cost.Q[0, 0], cost.N[0, 0], cost.R[0, 0]) == (T, T * T / 2, T + T**3 / 3)


@pytest.mark.parametrize("a", [-30.0, -300.0])
def test_the_period_cost_of_a_fast_mode_keeps_its_digits(a: float) -> None:
    """x' = a x + u over 1 s: int exp(2 a t) dt; the exponentials inside reach exp(300)."""
    cost = lqr.sampled_cost(model([[a]], [[1]]), [[1]], [[1]], 1.0)
    assert cost.Q[0, 0] == pytest.approx(np.expm1(2 * a) / (2 * a), rel=1e-15)


def simulated_cost(c: StateSpace, K: np.ndarray, Q: np.ndarray, R: np.ndarray, T: float, x: np.ndarray) -> float:
    """The continuous cost of u = K x, held over T, by Gauss quadrature of the flow inside each period."""
    n, m = c.B.shape
    F = np.block([[c.A, c.B], [np.zeros((m, n + m))]])
    nodes, weights = np.polynomial.legendre.leggauss(8)
    flows = [scipy.linalg.expm(F * T * (v + 1) / 2)[:n] for v in nodes]
    over, total = scipy.linalg.expm(F * T)[:n], 0.0
    for _ in range(4000):
        u = K @ x
        inside = [flow @ np.concatenate([x, u]) for flow in flows]
        total += T * (u @ R @ u) + T / 2 * sum(w * (v @ Q @ v) for w, v in zip(weights, inside, strict=True))
        x = over @ np.concatenate([x, u])
        if np.abs(x).max() < 1e-12:
            break
    return float(total)


def simulated_form(c: StateSpace, K: np.ndarray, Q: np.ndarray, R: np.ndarray, T: float) -> np.ndarray:
    """The matrix of the cost as a quadratic form of the start, from starts e_i + e_j."""
    E = np.eye(len(c.A))
    cost = [[simulated_cost(c, K, Q, R, T, a + b) for a in E] for b in E]
    single = np.diag(cost) / 4
    return (np.array(cost) - single[:, None] - single) / 2


def test_a_continuous_cross_weight_is_held_too() -> None:
    """x' = u with 2 n x u beside Q = R = 1: W = [[T, T^2/2 + n T], [., T + T^3/3 + n T^2]]."""
    T, n = 0.5, 0.25
    cost = lqr.sampled_cost(model([[0]], [[1]]), [[1]], [[1]], T, [[n]])
    np.testing.assert_allclose(cost.N, [[T * T / 2 + n * T]], rtol=tolerances.of("double"))
    np.testing.assert_allclose(cost.R, [[T + T**3 / 3 + n * T * T]], rtol=tolerances.of("double"))
    c, Q, R = random_problem(6)
    N = 0.1 * np.ones(c.B.shape)
    fast, limit = lqr.lqrd(c, Q, R, 1e-5, N).K, lqr.lqr(c, Q, R, N).K
    assert np.abs(fast - limit).max() < 0.1 * np.abs(lqr.lqr(c, Q, R).K - limit).max()


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_the_simulated_cost_is_that_of_the_riccati_solution(seed: int) -> None:
    c, Q, R = random_problem(seed)
    T, x = 0.3, np.ones(len(c.A))
    gain = lqr.lqrd(c, Q, R, T)
    expected_cost = x @ gain.certificate.X @ x
    assert gain.time == Discrete(T)
    assert simulated_cost(c, gain.K, Q, R, T, x) == pytest.approx(expected_cost, rel=tolerances.of("quadrature"))
    cost = lqr.sampled_cost(c, Q, R, T)
    crossless = lqr.lqr(cost.model, cost.Q, cost.R)
    assert simulated_cost(c, crossless.K, Q, R, T, x) > expected_cost * (1 + 1e-4)
    assert abs(x @ crossless.certificate.X @ x / expected_cost - 1) > 1e-3


def test_a_short_period_gives_the_continuous_gain() -> None:
    c, Q, R = random_problem(4)
    slow, fast, limit = lqr.lqrd(c, Q, R, 1e-3).K, lqr.lqrd(c, Q, R, 1e-5).K, lqr.lqr(c, Q, R).K
    assert np.abs(fast - limit).max() < 0.02 * np.abs(slow - limit).max() < 0.02 * np.abs(limit).max()


def test_the_cost_ratio_is_that_of_the_worst_start() -> None:
    c, Q, R = random_problem(3)
    T, gain = 0.3, lqr.lqr(c, Q, R)
    ratio, best = lqr.cost_ratio(c, gain, Q, R, T), lqr.lqrd(c, Q, R, T)
    costs = [simulated_form(c, K, Q, R, T) for K in (gain.K, best.K)]
    assert ratio == pytest.approx(scipy.linalg.eigh(*costs, eigvals_only=True)[-1], rel=tolerances.of("ode"))
    assert ratio > 1.01
    assert lqr.cost_ratio(c, best, Q, R, T) == pytest.approx(1, abs=tolerances.of("pencil"))


def test_a_gain_that_is_unstable_when_held_costs_without_bound() -> None:
    c = model([[0, 1], [0, 0]], [[0], [1]])
    Q, R = np.diag([1e6, 1.0]), np.eye(1)
    assert lqr.cost_ratio(c, lqr.lqr(c, Q, R), Q, R, 0.1) == np.inf
    assert lqr.cost_ratio(c, lqr.lqr(c, Q, R), Q, R, 1e-3) < 1.1


def test_a_state_that_costs_nothing_is_left_aside() -> None:
    c, Q, R = model(np.diag([-1.0, -2.0]), [[1], [0]]), np.diag([1.0, 0.0]), np.eye(1)
    assert lqr.cost_ratio(c, lqr.lqr(c, Q, R), Q, R, 0.1) == pytest.approx(1, abs=1e-2)


OSCILLATOR = ([[0, 1], [-1, 0]], [[0], [1]])


@pytest.mark.filterwarnings("error")
def test_the_cost_ratio_does_not_depend_on_units() -> None:
    """A double integrator, and one whose states are in units over twelve decades."""
    A, B, q = np.array([[0, 1.0], [0, 0]]), np.array([[0], [1.0]]), np.array([1.0, 1.0])
    plain = lqr.cost_ratio((A, B), lqr.lqr((A, B), q, [1]), q, [1], 0.3)
    d = np.array([1e-6, 1e6])
    c = (A * d / d[:, None], B / d[:, None])
    assert plain > 1.01
    assert lqr.cost_ratio(c, lqr.lqr(c, q * d * d, [1]), q * d * d, [1], 0.3) == pytest.approx(plain, rel=1e-8)


def test_a_period_that_aliases_modes_is_named() -> None:
    """An oscillator of 1 rad/s seen every half turn: z = -1 twice, and the input moves one of them."""
    for period in (np.pi, 2 * np.pi):
        with pytest.raises(
            ModelError, match=r"held over .* take another period, preferably a shorter one, below 3.142 s"
        ):
            lqr.lqrd(OSCILLATOR, [1, 1], [1], period)
    assert np.abs(lqr.lqrd(OSCILLATOR, [1, 1], [1], 3.0).poles).max() < 1
    with pytest.raises(ModelError, match="actuate x2 or take it out"):  # no period mends this
        lqr.lqrd(([[-1, 0], [0, 1]], [[1], [0]]), [1, 1], [1], 0.1)
