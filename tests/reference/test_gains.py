"""Gains in high precision agree with SciPy's Riccati solvers and with the poles that they shall place."""

from math import cos, pi

import mpmath  # type: ignore[import-untyped]
import numpy as np
import pytest
from scipy import linalg

from synth.reference import gains

T, W = 1e-3, 1.5 * pi
MODES = (0.0, W)


def doubles(A: gains.Matrix) -> np.ndarray:
    return np.array(A.tolist(), dtype=float)


def test_lqrd_is_the_gain_of_the_sampled_cost() -> None:
    A, B, weights, R = (
        np.array([[0.0, 0, 1], [1, 0, 0], [0, 0, 0]]),
        np.array([[0.0], [0], [13.0]]),
        (1e4, 1e9, 10),
        2.0,
    )
    with mpmath.workdps(60):
        X, K = (doubles(v) for v in gains.lqrd(mpmath.matrix(A.tolist()), mpmath.matrix([0, 0, 13]), weights, R, T))
    F = np.block([[A, B], [np.zeros((1, 4))]])
    E = linalg.expm(np.block([[-F.T, np.diag([*weights, R])], [np.zeros((4, 4)), F]]) * T)
    step, cost = E[4:, 4:], E[4:, 4:].T @ E[:4, 4:]
    expected = linalg.solve_discrete_are(step[:3, :3], step[:3, 3:], cost[:3, :3], cost[3:, 3:], s=cost[:3, 3:])
    np.testing.assert_allclose(X, expected, rtol=1e-6)
    poles = np.linalg.eigvals(step[:3, :3] - step[:3, 3:] @ K)
    assert np.abs(poles).max() < 1


def test_the_symmetric_root_locus_is_the_riccati_gain() -> None:
    weights = (3e4, 3e4, 2.5e9, 2.5e7, 2.5e7)
    with mpmath.workdps(60):
        m = gains.product(MODES)
        n = (m, np.polymul([1, 0], m), [1], [1, 0], [1, 0, 0])
        K = [float(v) for v in gains.symmetric_root_locus(MODES, list(zip(weights, n, strict=True)))]
    A = np.zeros((5, 5))
    A[0, 1] = A[2, 3] = A[3, 4] = A[4, 0] = 1
    A[4, 3] = -(W**2)
    B = np.array([[0.0], [1], [0], [0], [0]])
    X = linalg.solve_continuous_are(A, B, np.diag(weights), np.eye(1))
    np.testing.assert_allclose(K, -(B.T @ X)[0], rtol=1e-7)


def test_the_leapfrog_has_the_poles_of_the_modes_and_the_response_of_the_model() -> None:
    with mpmath.workdps(60):
        A, B = (doubles(v) for v in gains.leapfrog(MODES, T))
        R = gains.to_leapfrog(MODES, T)
        Phi, held = (doubles(v) for v in gains.zero_order_hold(gains.companion(MODES), mpmath.matrix([0, 0, 1]), T))
        R = doubles(R)
    assert sorted(np.linalg.eigvals(A).real) == pytest.approx(sorted([1.0, cos(W * T), cos(W * T)]))
    np.testing.assert_allclose(R @ A, Phi @ R, atol=1e-12 * np.abs(R).max())
    np.testing.assert_allclose(R @ B, held, atol=1e-15)
    K = gains.on_leapfrog([1.0, 2.0, 3.0, 4.0, 5.0], MODES, T)
    np.testing.assert_allclose(K, [1.0, 2.0, *(np.array([3.0, 4.0, 5.0]) @ R)], rtol=1e-12)


def test_an_observer_has_a_triple_pole() -> None:
    A, C = np.array([[1, T, T * T / 2], [0, 1, T], [0, 0, 1]]), np.array([[1.0, 0, 0]])
    p = np.exp(-120 * T)
    M = np.array([gains.triple_pole(120.0, T)]).T
    np.testing.assert_allclose(np.poly(A @ (np.eye(3) - M @ C)), np.poly([p, p, p]), atol=1e-12)


def test_the_derivative_of_a_ramp_is_its_rate() -> None:
    fade, rho, h = gains.derivative_filter(1000, T)
    s = r = 0.0
    for _ in range(100):
        before, s = s, fade * s + 2e-3
        r = fade * r + s + rho * before
    assert h * r == pytest.approx(2.0, rel=1e-12)
