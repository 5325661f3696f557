"""The noise of several outputs is that of the restricted likelihood, and intervals from few rows cover."""

import numpy as np
import pytest
import scipy.optimize

from synth.synthesise.identify import least_squares

TRUTH = np.array([1.0, 2.0, 3.0])
NAMES = ("a", "b", "c")


def restricted_likelihood(X: np.ndarray, y: np.ndarray, log_s2: np.ndarray) -> float:
    """Return minus twice the restricted log-likelihood, from matrices over all samples (Patterson, Thompson 1971)."""
    V = np.diag(np.tile(np.exp(log_s2), len(y) // len(log_s2)))
    W = np.linalg.inv(V)
    beta = np.linalg.solve(X.T @ W @ X, X.T @ W @ y)
    r = y - X @ beta
    return float(np.linalg.slogdet(V)[1] + np.linalg.slogdet(X.T @ W @ X)[1] + r @ W @ r)


def kenward_roger(X: np.ndarray, s2: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the covariance and freedoms of Kenward and Roger from matrices over all samples."""
    outputs = len(s2)
    V = np.diag(np.tile(s2, len(X) // outputs))
    W, parts = np.linalg.inv(V), [np.diag(np.tile(row, len(X) // outputs)) for row in np.eye(outputs)]
    C = np.linalg.inv(X.T @ W @ X)
    R = W - W @ X @ C @ X.T @ W
    spread = 2 * np.linalg.inv([[np.trace(R @ a @ R @ b) for a in parts] for b in parts])
    P = [-X.T @ W @ a @ W @ X for a in parts]
    more = sum(
        spread[i, j] * (X.T @ W @ parts[i] @ W @ parts[j] @ W @ X - P[i] @ C @ P[j])
        for i in range(outputs)
        for j in range(outputs)
    )
    slopes = np.array([np.diag(C @ p @ C) for p in P])  # minus dC_ii / ds_j^2
    freedoms = 2 * np.diag(C) ** 2 / np.einsum("ik,ij,jk->k", slopes, spread, slopes)
    return C + 2 * C @ more @ C, freedoms


def dense(J: least_squares.Jacobian) -> np.ndarray:
    """Return a Jacobian (N p, k + s f) with all its zeros."""
    groups, length, p, f = J.group.shape
    blocks = np.zeros((groups, length * p, groups, f))
    blocks[range(groups), :, range(groups)] = J.group.reshape(groups, length * p, f)
    return np.hstack([J.shared.reshape(groups * length * p, -1), blocks.reshape(groups * length * p, -1)])


@pytest.mark.parametrize("f", [0, 2])
def test_noise_and_confidence_are_those_of_the_restricted_likelihood(f: int) -> None:
    rng = np.random.default_rng(4)
    J = least_squares.Jacobian(rng.normal(size=(20, 2, 3)), rng.normal(size=(4, 5, 2, f)))
    X = dense(J)
    y = X @ rng.normal(size=X.shape[1]) + (rng.normal(size=(20, 2)) * [0.3, 2.0]).ravel()
    s = np.ones(2)
    for _ in range(200):
        solution = least_squares.solve_with_deviations(J, y.reshape(20, 2), s, NAMES)
        s = least_squares.noise_deviations(solution.e, solution.U, solution.Q)
    expected = scipy.optimize.minimize(
        lambda v: restricted_likelihood(X, y, v), np.zeros(2), method="BFGS", options={"gtol": 1e-8}
    )
    np.testing.assert_allclose(s**2, np.exp(expected.x), rtol=1e-4)
    known = least_squares.noise_confidence(solution.U, solution.Q, solution.root)
    covariance, freedoms = kenward_roger(X, s**2)
    np.testing.assert_allclose(known.covariance, covariance[:3, :3], rtol=1e-8)
    np.testing.assert_allclose(known.degrees_of_freedom, freedoms[:3], rtol=1e-8)
    W = np.tile(1 / s**2, 20)
    theta = np.linalg.solve(X.T * W @ X, X.T * W @ y)
    np.testing.assert_allclose(solution.theta, theta[:3], rtol=1e-9)


def coverage(rows: int, noise: tuple[float, float], logs: int) -> float:
    """Return the share of 95 % intervals that hold the truth, three from each log of two outputs."""
    rng, hits = np.random.default_rng(11), []
    for _ in range(logs):
        Phi = rng.normal(size=(rows, 2, 3))
        y = Phi @ TRUTH + rng.normal(size=(rows, 2)) * noise
        low, high = least_squares.solve(Phi, y, NAMES, ("p", "q")).intervals.T
        hits.append((low < TRUTH) & (high > TRUTH))
    return float(np.mean(hits))


@pytest.mark.parametrize(("rows", "noise"), [(4, (0.1, 0.1)), (8, (1.0, 1e-3))])
def test_intervals_from_few_rows_cover(rows: int, noise: tuple[float, float]) -> None:
    """120 logs: the share has a standard deviation of at most 2 %; 91 to 95 % were found over 4 to 15 rows."""
    assert coverage(rows, noise, 120) > 0.87
