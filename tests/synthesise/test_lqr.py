"""Gains against a published table, costs against simulation, and the cross term of the held cost."""

import control
import numpy as np
import pytest
import scipy.linalg
from hypothesis import given, settings
from hypothesis import strategies as st

from synth.errors import SignalError, TimingError
from synth.statespace import StateSpace
from synth.synthesise import internal_model, lqr
from synth.timing import Continuous, Discrete
from tests import tolerances

OMEGA0 = 1.5 * np.pi
# The poles are printed in the paper; weights and gains are recomputed from them: (Q, K, poles, decimals of the poles)
PUBLISHED = {
    "y": (
        (3e4, 3e4, 2.5e9, 2.5e7, 2.5e7),
        ("-1699.7", "-182.75", "-50000", "2725.5", "-7806.8"),
        (-173.2, -2.61 + 5.48j, -2.61 - 5.48j, -2.16 + 1.77j, -2.16 - 1.77j),
        (1, 2, 2, 2, 2),
    ),
    "x, z": (
        (1500, 1500, 4.5e8, 2.25e6, 2.25e6),
        ("-525.33", "-50.504", "-21213", "-1253.6", "-2742.2"),
        (-38.73, -3.2 + 5.89j, -3.2 - 5.89j, -2.69 + 2.23j, -2.69 - 2.23j),
        (2, 1, 1, 2, 2),
    ),
    "theta": (
        (4e4, 4e4, 4e9, 4e7, 4e7),
        ("-2050.0", "-210.00", "-63246", "1910.6", "-9901.3"),
        (-200, -2.81 + 5.58j, -2.81 - 5.58j, -2.19 + 1.82j, -2.19 - 1.82j),
        (0, 2, 2, 2, 2),
    ),
}


def model(A: object, B: object) -> StateSpace:
    A, B = np.atleast_2d(np.asarray(A, float)), np.atleast_2d(np.asarray(B, float))
    states, inputs = tuple(f"x{i}" for i in range(len(A))), tuple(f"u{i}" for i in range(B.shape[1]))
    return StateSpace(A, B, np.eye(len(A)), np.zeros(B.shape), states, inputs, states, Continuous())


def axis() -> StateSpace:
    """A double integrator with the internal model of 0 and OMEGA0, states (e, de, xi1, xi2, xi3)."""
    double = StateSpace([[0, 1], [0, 0]], [[0], [1]], [[1, 0]], [[0]], ("e", "de"), ("w",), ("e",), Continuous())
    return internal_model.augmented(double, (0.0, OMEGA0))


def random_problem(seed: int) -> tuple[StateSpace, np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    n, m = rng.integers(2, 4), rng.integers(1, 3)
    C = rng.normal(size=(n, n))
    return (
        model(rng.normal(size=(n, n)), rng.normal(size=(n, m))),
        C @ C.T + 0.1 * np.eye(n),
        np.diag(rng.uniform(1, 3, m)),
    )


@pytest.mark.parametrize("name", PUBLISHED)
def test_the_published_gains_and_poles_come_out_to_the_printed_digits(name: str) -> None:
    Q, printed, poles, decimals = PUBLISHED[name]
    found = lqr.lqr(axis(), np.diag(Q), [[1.0]])
    for value, text in zip(found.K[0], printed, strict=True):
        last = 10.0 ** -(len(text.split(".")[1]) if "." in text else 0)
        assert abs(value - float(text)) <= tolerances.of("print_K") * last
    for pole, places in zip(poles, decimals, strict=True):
        nearest = min(found.poles, key=lambda s: abs(s - pole))
        off = max(abs(nearest.real - pole.real), abs(nearest.imag - pole.imag))
        assert off <= tolerances.of("print_K") * 10.0**-places * (1 + 1e-9)
    detuned = lqr.lqr(axis(), np.diag(Q) * 1.01, [[1.0]])
    assert abs(detuned.K[0, 0] - float(printed[0])) > tolerances.of("print_K")


def test_the_sign_is_inside_the_gain_and_the_fields_say_what_was_minimised() -> None:
    c, Q, R = random_problem(2)
    found = lqr.lqr(c, Q, R)
    K, *_ = control.lqr(c.A, c.B, Q, R, method="scipy")
    np.testing.assert_allclose(found.K, -K, rtol=tolerances.of("pencil"))
    np.testing.assert_allclose(np.linalg.eigvals(c.A + c.B @ found.K).real.max(), found.poles.real.max(), rtol=1e-9)
    np.testing.assert_array_equal(found.Q, Q)
    np.testing.assert_array_equal(found.N, np.zeros(c.B.shape))
    assert (found.states, found.inputs, found.time) == (c.states, c.inputs, Continuous())


@settings(derandomize=True, max_examples=10, deadline=None)
@given(st.integers(0, 10**6), st.floats(0.01, 0.5))
def test_the_held_cost_agrees_with_quadrature(seed: int, T: float) -> None:
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


def test_the_held_cost_of_an_integrator_is_its_closed_form() -> None:
    """x' = u, Q = R = 1: W = [[T, T^2/2], [T^2/2, T + T^3/3]]."""
    T = 0.5
    cost = lqr.sampled_cost(model([[0]], [[1]]), [[1]], [[1]], T)
    assert (cost.Q[0, 0], cost.N[0, 0], cost.R[0, 0]) == (T, T * T / 2, T + T**3 / 3)


@pytest.mark.parametrize("a", [-30.0, -300.0])
def test_the_held_cost_of_a_fast_mode_keeps_its_digits(a: float) -> None:
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


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_the_simulated_cost_is_that_of_the_riccati_solution(seed: int) -> None:
    c, Q, R = random_problem(seed)
    T, x = 0.3, np.ones(len(c.A))
    found = lqr.lqrd(c, Q, R, T)
    told = x @ found.certificate.X @ x
    assert found.time == Discrete(T)
    assert simulated_cost(c, found.K, Q, R, T, x) == pytest.approx(told, rel=tolerances.of("quadrature"))
    cost = lqr.sampled_cost(c, Q, R, T)
    crossless = lqr.lqr(cost.model, cost.Q, cost.R)
    assert simulated_cost(c, crossless.K, Q, R, T, x) > told * (1 + 1e-4)
    assert abs(x @ crossless.certificate.X @ x / told - 1) > 1e-3


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


def test_what_is_no_cost_or_no_continuous_model_is_refused() -> None:
    c, Q, R = random_problem(1)
    with pytest.raises(TimingError, match="continuous"):
        lqr.lqrd(lqr.sampled_cost(c, Q, R, 0.1).model, Q, R, 0.1)
    lopsided = Q.copy()
    lopsided[0, 1] += 1
    with pytest.raises(SignalError, match="Q is not symmetric"):
        lqr.lqrd(c, lopsided, R, 0.1)
    with pytest.raises(SignalError, match="matrix R is"):
        lqr.lqrd(c, Q, np.eye(len(R) + 1), 0.1)
