"""Separation, the compensator's matrices, and stationary covariances."""

from dataclasses import replace

import numpy as np
import pytest
import scipy.linalg
from hypothesis import given, settings
from hypothesis import strategies as st

from synth.errors import ModelError
from synth.statespace import of
from synth.synthesise.feedback import lqr
from synth.synthesise.observers import kalman, lqg
from synth.timing import Continuous, Discrete, Time
from tests import tolerances
from tests.synthesise.observers.models import FORMS, T, held_mass, mass


def random_loop(seed: int, time: Time) -> tuple[lqr.Gain, kalman.Estimator]:
    rng = np.random.default_rng(seed)
    n, m, p = rng.integers(1, 5), rng.integers(1, 3), rng.integers(1, 3)
    A = rng.normal(size=(n, n)) * (1.0 if isinstance(time, Continuous) else 0.6)
    model = of((A, rng.normal(size=(n, m)), rng.normal(size=(p, n)), 0.3 * rng.normal(size=(p, m)), time))
    Q, W, joint = (lambda root: (root @ root.T + (root @ root.T).T) / 2 + 0.1 * np.eye(len(root)) for _ in range(3))
    weight = joint(rng.normal(size=(n + m, n + m)))
    gain = lqr.lqr(model, weight[:n, :n], weight[n:, n:], weight[:n, n:])
    make = kalman.continuous if isinstance(time, Continuous) else kalman.discrete
    return gain, make(model, Q(rng.normal(size=(n, n))), W(rng.normal(size=(p, p))))


# Separation


@settings(derandomize=True, max_examples=15, deadline=None)
@given(st.integers(0, 10**6))
def test_the_poles_are_those_of_the_regulator_and_of_the_estimator(seed: int) -> None:
    for time in (Continuous(), Discrete(0.1)):
        gain, estimator = random_loop(seed, time)
        for form in FORMS:
            loop = form(gain, estimator)
            assert loop.separation < tolerances.of("multiple_root")
            assert len(loop.poles) == len(gain.poles) + len(estimator.poles)


def test_a_gain_of_another_model_shows_in_the_separation() -> None:
    estimator = held_mass()
    heavier = replace(estimator.model, B=estimator.model.B / 1.3)
    gain = lqr.lqr(heavier, np.diag([1e4, 1]), [[1e-2]])
    assert lqg.current(gain, estimator).separation > 1e-4
    detuned = replace(estimator, L=estimator.L * 1.1)
    gain_of_model = lqr.lqr(estimator.model, np.diag([1e4, 1]), [[1e-2]])
    assert lqg.predictor(gain_of_model, estimator).separation < tolerances.of("double") * 1e2
    assert lqg.predictor(gain_of_model, detuned).separation > 1e-3


def test_the_compensator_is_its_textbook_matrices() -> None:
    estimator = held_mass()
    model, L, M = estimator.model, estimator.L, estimator.M
    K = lqr.lqr(model, np.diag([1e4, 1]), [[1e-2]]).K
    gain = lqr.lqr(model, np.diag([1e4, 1]), [[1e-2]])
    A, B, C = model.A, model.B, model.C
    before, now = lqg.predictor(gain, estimator).compensator, lqg.current(gain, estimator).compensator
    close = {"rtol": tolerances.of("double"), "atol": 1e-12}
    np.testing.assert_allclose(before.A, A + B @ K - L @ C, **close)
    np.testing.assert_allclose(before.B, L, **close)
    np.testing.assert_allclose(before.C, K, **close)
    np.testing.assert_array_equal(before.D, 0)
    kept = np.eye(2) - M @ C
    np.testing.assert_allclose(now.A, A - L @ C + B @ K @ kept, **close)
    np.testing.assert_allclose(now.B, L + B @ K @ M, **close)
    np.testing.assert_allclose(now.D, K @ M, **close)
    assert (before.inputs, before.outputs, before.states) == (("y",), ("f",), ("x_estimate", "v_estimate"))
    assert now.states == ("x_predicted", "v_predicted")
    assert (before.unit("f"), now.unit("y"), now.unit("v_predicted")) == ("N", "m", "m/s")


# Stationary covariances


@settings(derandomize=True, max_examples=10, deadline=None)
@given(st.integers(0, 10**6))
def test_a_stationary_covariance_satisfies_its_equation(seed: int) -> None:
    rng = np.random.default_rng(seed)
    n = rng.integers(1, 6)
    A, root = rng.normal(size=(n, n)), rng.normal(size=(n, n))
    W = (root @ root.T + (root @ root.T).T) / 2
    stable = A - (np.linalg.eigvals(A).real.max() + 0.1) * np.eye(n)
    X = kalman.stationary(stable, W, Continuous())
    assert np.abs(stable @ X + X @ stable.T + W).max() < tolerances.of("lyapunov") * np.abs(X).max()
    damped = 0.95 * A / np.abs(np.linalg.eigvals(A)).max()
    X = kalman.stationary(damped, W, Discrete(1.0))
    assert np.abs(damped @ X @ damped.T + W - X).max() < tolerances.of("lyapunov") * np.abs(X).max()


@pytest.mark.parametrize("ratio", [1e6, 1e10, 1e15, 1e18])
def test_a_covariance_keeps_its_digits_beside_a_fast_mode(ratio: float) -> None:
    """x' = -a x + w has the variance W / 2 a, and E x1 x2 = W12 / (a1 + a2)."""
    W = np.array([[1.0, 0.5], [0.5, 1.0]])
    X = kalman.stationary(np.diag([-1, -ratio]), W, Continuous())
    exact = W / np.add.outer([1, ratio], [1, ratio])
    np.testing.assert_allclose(X, exact, rtol=tolerances.of("double"))


def test_a_dense_stiff_covariance_is_that_of_its_modes() -> None:
    """Symmetric A = V diag(a) V' of a rotation with exact entries, rates 1 .. 1e6, W = -A - A': X = I."""
    V = np.array([[1, 1, 1, 1], [1, -1, 1, -1], [1, 1, -1, -1], [1, -1, -1, 1]]) / 2
    A = V @ np.diag([-1.0, -128.0, -8192.0, -1048576.0]) @ V.T
    X = kalman.stationary(A, -2 * A, Continuous())
    np.testing.assert_allclose(X, np.eye(4), atol=tolerances.of("double"))


@pytest.mark.parametrize("time", [Continuous(), Discrete(0.01)])
def test_a_covariance_of_an_undamped_mode_is_refused_whatever_rounding_says(time: Continuous | Discrete) -> None:
    for w in range(1, 21):
        turn = np.array([[0.0, w], [-w, 0.0]])
        A = turn if isinstance(time, Continuous) else scipy.linalg.expm(turn * time.period_s)
        with pytest.raises(ModelError, match="does not decay, and the covariance is unbounded"):
            kalman.stationary(A, np.eye(2), time)


# Names, prints, refusals


def test_an_input_that_the_gain_does_not_set_reaches_the_estimator() -> None:
    model = replace(mass(), B=[[0, 0], [0.66, 9.8]], D=[[0, 0]], inputs=("f", "tilt"))
    estimator = kalman.kalmd(model, {"v": 1e-3}, [25e-10], T)
    held = estimator.model
    gain = lqr.lqr(held.select(held.outputs, ("f",)), np.diag([1e6, 1]), [[1e-2]])
    loop = lqg.predictor(gain, estimator)
    assert loop.compensator.inputs == ("y", "tilt")
    assert "tilt" in loop.loop.inputs
    assert loop.separation < tolerances.of("double") * 1e2
    # what is known is not mistaken for an error: the estimates stay those of the states
    x = np.zeros(4)
    for _ in range(50):
        x = loop.loop.A @ x + loop.loop.B[:, loop.loop.inputs.index("tilt")] * 1e-3
    np.testing.assert_allclose(x[2:], x[:2], rtol=tolerances.of("double") * 1e2)
    assert abs(x[0]) > 1e-9


def test_controllers_print_themselves() -> None:
    estimator = held_mass()
    loop = lqg.current(
        lqr.lqr(lqr.with_integrators(estimator.model, ("y",)), np.diag([1e6, 1, 1e8]), [[1e-2]]), estimator
    )
    assert "LQG controller of f from y" in repr(loop)
    assert "separation: the poles of the loop lie within" in repr(loop)
    assert "y_reference [m]" in repr(loop)


def test_a_control_whose_column_of_B_is_G_stays_an_input() -> None:
    estimator = kalman.kalmd(mass(), [1.0], [1.0], T, mass().B[:, [0]])
    named = kalman.kalmd(mass(), [1.0], [1.0], T, ["f"])
    np.testing.assert_array_equal(estimator.L, named.L)
    loop = lqg.predictor(lqr.lqrd(mass(), np.eye(2), [1.0], T), estimator)
    assert loop.compensator.outputs == ("f",) and loop.separation < tolerances.of("double") * 1e2
