"""Steady-state filters against closed forms, other solvers and simulation."""

from dataclasses import replace

import control
import numpy as np
import pytest
import scipy.linalg
import slycot
from hypothesis import given, settings
from hypothesis import strategies as st

from synth.statespace import StateSpace, of
from synth.synthesise.observers import kalman
from synth.timing import Continuous, Discrete, Time
from tests import tolerances
from tests.synthesise.observers.models import mass, run, scalar


def random_problem(seed: int, time: Time) -> tuple[StateSpace, np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """A model, stable or not, with G, W, V and S, [[W, S], [S', V]] > 0."""
    rng = np.random.default_rng(seed)
    n, m, p, q = rng.integers(2, 5), rng.integers(1, 3), rng.integers(1, 3), rng.integers(1, 3)
    A = rng.normal(size=(n, n)) * (1.0 if isinstance(time, Continuous) else 0.6)
    root = rng.normal(size=(p + q, p + q))
    joint = root @ root.T + 0.3 * np.eye(p + q)
    joint = (joint + joint.T) / 2
    model = of((A, rng.normal(size=(n, m)), rng.normal(size=(p, n)), rng.normal(size=(p, m)), time))
    return model, rng.normal(size=(n, q)), joint[:q, :q], joint[q:, q:], joint[:q, q:]


# Closed forms


@pytest.mark.parametrize("a", [-2.0, 0.0, 3.0])
def test_a_scalar_filter_in_continuous_time_is_its_closed_form(a: float) -> None:
    """2 a P - c^2 P^2 / v + w = 0."""
    w, v, c = 5.0, 0.2, 0.7
    estimator = kalman.continuous(scalar(a, Continuous(), c), [w], [v])
    root = np.sqrt(a * a + c * c * w / v)
    assert estimator.prior[0, 0] == pytest.approx((a + root) * v / c**2, rel=tolerances.of("double"))
    assert estimator.L[0, 0] == pytest.approx((a + root) / c, rel=tolerances.of("double"))
    assert estimator.poles[0].real == pytest.approx(-root, rel=tolerances.of("double"))
    assert estimator.M[0, 0] == 0
    np.testing.assert_array_equal(estimator.posterior, estimator.prior)


@pytest.mark.parametrize("a", [0.3, 1.0, 1.7])
def test_a_scalar_filter_in_discrete_time_is_its_closed_form(a: float) -> None:
    """P = a^2 P v / (P + v) + w."""
    w, v = 0.4, 0.9
    estimator = kalman.discrete(scalar(a, Discrete(0.1)), [w], [v])
    b = v * (a * a - 1) + w
    P = (b + np.sqrt(b * b + 4 * v * w)) / 2
    close = tolerances.of("double")
    assert estimator.prior[0, 0] == pytest.approx(P, rel=close)
    assert estimator.M[0, 0] == pytest.approx(P / (P + v), rel=close)
    assert estimator.L[0, 0] == pytest.approx(a * P / (P + v), rel=close)
    assert estimator.posterior[0, 0] == pytest.approx(P * v / (P + v), rel=close)


def test_the_position_filter_of_a_mass_is_its_closed_form() -> None:
    """x'' = w, density w: L = (sqrt(2) k, k^2) with k = (w / v)^(1/4), a Butterworth filter."""
    w, v = 1e-3, 25e-13
    estimator = kalman.continuous(mass(), {"v": w}, {"y": v})
    k = (w / v) ** 0.25
    np.testing.assert_allclose(estimator.L[:, 0], [np.sqrt(2) * k, k * k], rtol=tolerances.of("double"))


# Other solvers


def equation_residual(estimator: kalman.Estimator, W: np.ndarray, V: np.ndarray, S: np.ndarray) -> float:
    """The residual of the filter's equation at P and of L, written out here, over the size of W; W, V, S as entered."""
    A, C, P = estimator.model.A, estimator.model.C, estimator.prior
    if isinstance(estimator.model.time, Continuous):
        L = np.linalg.solve(V, (P @ C.T + S).T).T
        rest = A @ P + P @ A.T - L @ V @ L.T + W
    else:
        E = C @ P @ C.T + V
        L = np.linalg.solve(E, (A @ P @ C.T + S).T).T
        rest = A @ P @ A.T - L @ E @ L.T + W - P
    return float(max(np.abs(rest).max() / np.abs(W).max(), np.abs(estimator.L - L).max() / np.abs(L).max()))


@settings(derandomize=True, max_examples=15, deadline=None)
@given(st.integers(0, 10**6))
def test_random_filters_agree_with_scipy_and_with_their_equation(seed: int) -> None:
    for time, solver, make in (
        (Continuous(), scipy.linalg.solve_continuous_are, kalman.continuous),
        (Discrete(0.1), scipy.linalg.solve_discrete_are, kalman.discrete),
    ):
        model, G, W, V, S = random_problem(seed, time)
        estimator = make(model, W, V, G, S)
        GWG = (G @ W @ G.T + (G @ W @ G.T).T) / 2
        P = solver(model.A.T, model.C.T, GWG, V, s=G @ S)
        np.testing.assert_allclose(estimator.prior, P, rtol=0, atol=tolerances.of("pencil") * np.abs(P).max())
        assert equation_residual(estimator, GWG, V, G @ S) < tolerances.of("pencil")
        closed = np.linalg.eigvals(model.A - estimator.L @ model.C)
        assert (closed.real.max() if isinstance(time, Continuous) else np.abs(closed).max() - 1) < 0
        # dropped or transposed terms are seen by the same check
        assert equation_residual(estimator, GWG, V, 0 * G @ S) > 1e-6
        assert equation_residual(replace(estimator, prior=estimator.prior * (1 + 1e-6)), GWG, V, G @ S) > 1e-8
        unpropagated = replace(estimator, prior=estimator.posterior)
        assert isinstance(time, Continuous) or equation_residual(unpropagated, GWG, V, G @ S) > 1e-6


def test_python_control_and_slicot_agree() -> None:
    close = tolerances.of("pencil")
    model, G, W, V, _ = random_problem(3, Continuous())
    estimator = kalman.continuous(model, W, V, G)
    L, P, _ = control.lqe(model.A, G, model.C, W, V)
    np.testing.assert_allclose(estimator.L, L, rtol=close)
    np.testing.assert_allclose(estimator.prior, P, rtol=close)
    model, G, W, V, _ = random_problem(3, Discrete(0.1))
    estimator = kalman.discrete(model, W, V, G)
    L, P, _ = control.dlqe(model.A, G, model.C, W, V)
    np.testing.assert_allclose(estimator.L, L, rtol=close)
    np.testing.assert_allclose(estimator.prior, P, rtol=close)
    n, p = estimator.L.shape
    X, *_ = slycot.sb02od(n, p, model.A.T, model.C.T, G @ W @ G.T, V, "D")
    np.testing.assert_allclose(estimator.prior, X, rtol=close)


# Noise on a continuous plant that is measured at samples


def over_a_period(model: StateSpace, density: np.ndarray, P: np.ndarray, T: float) -> np.ndarray:
    """P' = A P + P A' + density over a period, by Gauss quadrature of its solution."""
    nodes, weights = np.polynomial.legendre.leggauss(20)
    flows = [scipy.linalg.expm(model.A * T / 2 * (v + 1)) for v in nodes]
    F = scipy.linalg.expm(model.A * T)
    return F @ P @ F.T + T / 2 * sum(w * M @ density @ M.T for w, M in zip(weights, flows, strict=True))


def test_the_covariance_grows_over_a_period_as_the_continuous_equation_says() -> None:
    model, G, W, V, _ = random_problem(5, Continuous())
    model, T = replace(model, D=0 * model.D), 0.4
    density, close = G @ W @ G.T, tolerances.of("quadrature")

    def misses(estimator: kalman.Estimator) -> float:
        prior = over_a_period(model, density, estimator.posterior, T)
        return float(np.abs(prior - estimator.prior).max() / np.abs(prior).max())

    assert misses(kalman.kalmd(model, W, V, T, G)) < close
    held = kalman.kalmd(model, W, V, T, G).model
    crude = kalman.discrete(held, (density + density.T) / 2 * T, V)
    assert misses(crude) > 1e-2  # W scaled by T only
    np.testing.assert_allclose(held.A, scipy.linalg.expm(model.A * T), rtol=tolerances.of("double"))


def test_many_fast_samples_of_large_covariance_are_the_continuous_filter() -> None:
    """V / T at each sample is the density V."""
    T, V = 1e-5, 25e-13
    fast, limit = kalman.kalmd(mass(), {"v": 1e-3}, [V / T], T), kalman.continuous(mass(), {"v": 1e-3}, [V])
    np.testing.assert_allclose(fast.L / T, limit.L, rtol=0.01)
    np.testing.assert_allclose(fast.prior, limit.prior, rtol=0.01)
    slow = kalman.kalmd(mass(), {"v": 1e-3}, [V / (10 * T)], 10 * T)
    assert np.abs(fast.L / T - limit.L).max() < 0.2 * np.abs(slow.L / (10 * T) - limit.L).max()


# Simulation


def simulated_covariances(
    estimator: kalman.Estimator, W: np.ndarray, G: np.ndarray, V: np.ndarray, S: np.ndarray
) -> list[np.ndarray]:
    """The covariances of x - x^ and of x less the current estimate over 20 000 runs, after 60 samples from rest."""
    rng, model, runs = np.random.default_rng(7), estimator.model, 20_000
    n, q = G.shape
    root = np.linalg.cholesky(np.block([[W, S], [S.T, V]]))
    x, predicted = np.zeros((runs, n)), np.zeros((runs, n))
    for _ in range(60):
        noise, u = rng.normal(size=(runs, len(root))) @ root.T, rng.normal(size=(runs, len(model.inputs)))
        y = x @ model.C.T + u @ model.D.T + noise[:, q:]
        e = y - predicted @ model.C.T - u @ model.D.T
        now = predicted + e @ estimator.M.T
        errors = [x - predicted, x - now]
        x = x @ model.A.T + u @ model.B.T + noise[:, :q] @ G.T
        predicted = predicted @ model.A.T + u @ model.B.T + e @ estimator.L.T
    return [error.T @ error / runs for error in errors]


def test_the_errors_of_a_simulation_have_the_covariances() -> None:
    model, G, W, V, S = random_problem(11, Discrete(0.1))
    estimator = kalman.discrete(model, W, V, G, S)

    def relative_difference(covariances: list[np.ndarray]) -> float:
        designed = (estimator.prior, estimator.posterior)
        return max(float(np.linalg.norm(c - P) / np.linalg.norm(P)) for c, P in zip(covariances, designed, strict=True))

    # the entries of a covariance of 20 000 runs scatter by sqrt(2 / 20 000) = 1 %
    assert relative_difference(simulated_covariances(estimator, W, G, V, S)) < 0.03
    uncrossed = kalman.discrete(model, W, V, G)
    assert relative_difference(simulated_covariances(uncrossed, W, G, V, S)) > 0.06


def test_both_forms_estimate_what_the_recursion_says_with_a_direct_term_and_cross_covariance() -> None:
    model, G, W, V, S = random_problem(2, Discrete(0.1))
    estimator = kalman.discrete(model, W, V, G, S)
    rng = np.random.default_rng(1)
    u, y = rng.normal(size=(30, len(model.inputs))), rng.normal(size=(30, len(model.outputs)))
    x, before, now = np.zeros(len(model.A)), [], []
    for uk, yk in zip(u, y, strict=True):
        e = yk - model.C @ x - model.D @ uk
        before, now = [*before, x], [*now, x + estimator.M @ e]
        x = model.A @ x + model.B @ uk + estimator.L @ e
    both = np.hstack([u, y])
    close = {"rtol": 0, "atol": tolerances.of("double") * 10 * np.abs(now).max()}
    np.testing.assert_allclose(run(estimator.predictor(), both), before, **close)
    np.testing.assert_allclose(run(estimator.current(), both), now, **close)


def test_the_forms_carry_names_and_units() -> None:
    estimator = kalman.kalmd(mass(), {"v": 1e-3}, {"y": 25e-10}, 1e-3)
    for form in (estimator.predictor(), estimator.current()):
        assert form.inputs == ("f", "y")
        assert form.outputs == ("x_estimate", "v_estimate")
        assert (form.unit("v_estimate"), form.unit("f"), form.time) == ("m/s", "N", Discrete(1e-3))
    assert estimator.current().states == ("x_predicted", "v_predicted")
    assert estimator.current().unit("v_predicted") == "m/s"
    assert estimator.deviations["v"] == np.sqrt(estimator.posterior[1, 1])


def test_a_filter_prints_its_deviations_with_units() -> None:
    text = repr(kalman.kalmd(mass(), {"v": 1e-3}, [25e-10], 1e-3))
    assert "deviation before a sample" in text
    assert "v [m/s]" in text
    assert "dual Riccati equation" in text
    assert "deviation of the innovation" in text
    assert "before" not in repr(kalman.continuous(mass(), {"v": 1e-3}, [25e-13]))


def test_inputs_named_as_noise_are_not_known_to_the_filter() -> None:
    by_name, by_matrix = (kalman.continuous(mass(), W, [25e-13], G) for W, G in (({"f": 1.0}, "f"), ([1.0], mass().B)))
    np.testing.assert_array_equal(by_name.L, by_matrix.L)
    assert by_name.predictor().inputs == ("y",)
    assert by_matrix.predictor().inputs == ("f", "y")


def test_noise_that_reaches_an_output_at_once_is_correlated_noise() -> None:
    """y = C x + F w + v: the same as V + F W F' and S = W F'."""
    model, G, W, V, S = random_problem(4, Discrete(0.1))
    F = np.ones((len(model.C), G.shape[1]))
    joined = of((model.A, G, model.C, F, model.time))
    estimator = kalman.discrete(joined, W, V, joined.inputs, S)
    total = V + F @ W @ F.T + F @ S + S.T @ F.T
    want = kalman.discrete(model, W, (total + total.T) / 2, G, W @ F.T + S)
    np.testing.assert_allclose(estimator.L, want.L, rtol=tolerances.of("double") * 10)
