"""The sampled servo's cost against the continuous integral, and its limits."""

from dataclasses import replace

import numpy as np
import pytest
import scipy.linalg
from hypothesis import given, settings
from hypothesis import strategies as st

from synth.errors import SignalError
from synth.statespace import StateSpace
from synth.synthesise.regulation import internal_model, servo
from synth.timing import Continuous, Discrete
from tests import tolerances


def plant(rng: np.random.Generator) -> StateSpace:
    """Return a random plant of 3 states, 2 inputs and 2 outputs with a direct term."""
    D = 0.2 * rng.normal(size=(2, 2))
    matrices = rng.normal(size=(3, 3)), rng.normal(size=(3, 2)), rng.normal(size=(2, 3)), D
    return StateSpace(*matrices, ("a", "b", "c"), ("f", "g"), ("y", "z"), Continuous())


def running_cost(
    regulator: servo.Servo, c: StateSpace, Q: np.ndarray, R: np.ndarray, T: float, start: np.ndarray
) -> float:
    """Return int (x'Qx + u'Ru) dt from `start` (x, xi): u and e held, Gauss quadrature inside each period."""
    model = internal_model.exosystem((0.0, 2.0))
    Phi, N = np.kron(np.eye(2), model.Phi), np.kron(np.eye(2), model.N)
    n, k = 3, len(Phi)
    F = np.zeros((n + k + 4, n + k + 4))
    F[:n, :n], F[:n, n + k : n + k + 2] = c.A, c.B
    F[n : n + k, n : n + k], F[n : n + k, n + k + 2 :] = Phi, N
    weight = scipy.linalg.block_diag(Q, R, np.zeros((2, 2)))
    nodes, parts = np.polynomial.legendre.leggauss(8)
    flows = [scipy.linalg.expm(F * T / 2 * (v + 1)) for v in nodes]
    W = T / 2 * sum(w * M.T @ weight @ M for w, M in zip(parts, flows, strict=True))
    full = np.vstack([np.eye(n + k), regulator.K, np.hstack([c.C, np.zeros((2, k))]) + c.D @ regulator.K])
    loop = (scipy.linalg.expm(F * T) @ full)[: n + k]
    assert np.abs(np.linalg.eigvals(loop)).max() < 1
    return float(start @ scipy.linalg.solve_discrete_lyapunov(loop.T, full.T @ W @ full) @ start)


@settings(derandomize=True, max_examples=5, deadline=None)
@given(st.integers(0, 10**6))
def test_no_other_gain_has_a_lower_continuous_cost(seed: int) -> None:
    rng = np.random.default_rng(seed)
    c, T = plant(rng), 0.1
    Q, R = np.diag(rng.uniform(0.5, 2, 9)), np.diag([1.0, 2.0])
    regulator = servo.lqrd(c, (0.0, 2.0), Q, R, T)
    start = rng.normal(size=9)
    best = running_cost(regulator, c, Q, R, T, start)
    for _ in range(3):
        other = replace(regulator, K=regulator.K * (1 + 0.02 * rng.normal(size=regulator.K.shape)))
        assert running_cost(other, c, Q, R, T, start) > best * (1 - tolerances.of("double"))
    continuous = servo.lqr(c, (0.0, 2.0), Q, R)
    assert running_cost(replace(regulator, K=continuous.K), c, Q, R, T, start) > best * (1 + 1e-6)


def test_the_sampled_gain_goes_to_the_continuous_one() -> None:
    """To the first order of the period: a tenth of it leaves a tenth of the difference."""
    c = plant(np.random.default_rng(1))
    whole = servo.lqr(c, (0.0, 2.0), np.eye(9), np.eye(2)).K
    far, near = (np.abs(servo.lqrd(c, (0.0, 2.0), np.eye(9), np.eye(2), T).K - whole).max() for T in (1e-2, 1e-3))
    assert far / near == pytest.approx(10, rel=0.05)


def test_the_sum_is_minimised_for_a_sampled_plant() -> None:
    """An integrator: the gain of SciPy's Riccati equation for the augmented plant."""
    sampled = StateSpace([[1.0]], [[0.1]], [[1.0]], [[0.0]], ("x",), ("u",), ("x",), Discrete(0.1))
    regulator = servo.lqr(sampled, (0.0,), np.eye(2), [1.0])
    A, B = np.array([[1.0, 0.0], [0.1, 1.0]]), np.array([[0.1], [0.0]])
    X = scipy.linalg.solve_discrete_are(A, B, np.eye(2), np.eye(1))
    K = -np.linalg.solve(np.eye(1) + B.T @ X @ B, B.T @ X @ A)
    np.testing.assert_allclose(regulator.K, K, rtol=tolerances.of("pencil"))


def test_weights_are_given_by_name() -> None:
    c = plant(np.random.default_rng(2))
    names = {"y": "gap", "z": "tilt"}
    c = c.renamed(names)
    Q = {"a": 1.0, "b": 1.0, "c": 1.0, "xi1_gap": 2.0, "xi1_tilt": 3.0}
    regulator = servo.lqrd(c, (0.0,), Q, {"f": 1.0, "g": 1.0}, 0.1)
    listed = servo.lqrd(c, (0.0,), np.diag([1, 1, 1, 2.0, 3.0]), np.eye(2), 0.1)
    np.testing.assert_array_equal(regulator.K, listed.K)
    with pytest.raises(SignalError, match="names 'xi2_gap', which is not one of a, b, c, xi1_gap, xi1_tilt"):
        servo.lqrd(c, (0.0,), {"xi2_gap": 1.0}, [1.0, 1.0], 0.1)
