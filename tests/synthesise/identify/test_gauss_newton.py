"""Gauss-Newton finds SciPy's minimum, its intervals cover, and errors for no convergence or undetermined parameters."""

import numpy as np
import pytest
import scipy.optimize

from synth.errors import ModelError
from synth.synthesise.identify import gauss_newton

T = np.linspace(0, 3, 40)
NAMES = ("amplitude", "rate")


def decay(theta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    shape = np.exp(-theta[1] * T)
    return theta[0] * shape[:, None], np.stack([shape, -theta[0] * T * shape], axis=1)[:, None, :]


def data(seed: int, noise: float = 0.05) -> np.ndarray:
    return decay(np.array([2.0, 1.3]))[0] + noise * np.random.default_rng(seed).normal(size=(len(T), 1))


@pytest.mark.parametrize("start", [[1.0, 1.0], [0.1, 5.0], [10.0, 0.0], [2.0, -1.0]])
def test_the_minimum_and_its_errors_are_those_of_curve_fit(start: list[float]) -> None:
    y = data(1)
    fit = gauss_newton.minimise(decay, y, start, NAMES, ("y",))
    scipy_theta, covariance = scipy.optimize.curve_fit(
        lambda t, a, r: a * np.exp(-r * t), T, y.ravel(), p0=[1, 1], xtol=1e-12
    )
    np.testing.assert_allclose(fit.estimate.values, scipy_theta, rtol=1e-6)
    np.testing.assert_allclose(fit.estimate.covariance, covariance, rtol=1e-4)
    rest = y.ravel() - scipy_theta[0] * np.exp(-scipy_theta[1] * T)
    assert fit.estimate.r_squared["y"] == pytest.approx(1 - rest @ rest / ((y - y.mean()) ** 2).sum())
    assert fit.optimality <= gauss_newton.OPTIMALITY and "Converged after" in str(fit)


def test_intervals_hold_the_truth_as_often_as_they_say() -> None:
    hits = []
    for seed in range(250):
        low, high = gauss_newton.minimise(decay, data(seed), [1.5, 1.0], NAMES, ("y",)).estimate.intervals.T
        hits.append((low <= [2.0, 1.3]) & (high >= [2.0, 1.3]))
    assert abs(np.mean(hits) - 0.95) < 0.03, "standard deviation at most 1.4 %"


def test_an_exact_log_gives_the_truth() -> None:
    fit = gauss_newton.minimise(decay, data(0, 0.0), [1.0, 0.5], NAMES, ("y",))
    np.testing.assert_allclose(fit.estimate.values, [2, 1.3], rtol=1e-8)


def test_outputs_with_different_noise_are_weighted_by_their_residuals() -> None:
    rng = np.random.default_rng(4)

    def twice(theta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        g, J = decay(theta)
        return np.hstack([g, 1000 * g]), np.concatenate([J, 1000 * J], axis=1)

    noise = {"fine": 0.01, "coarse": 500.0}
    y = twice(np.array([2.0, 1.3]))[0] + rng.normal(size=(len(T), 2)) * list(noise.values())
    fit = gauss_newton.minimise(twice, y, [1.0, 1.0], NAMES, tuple(noise))
    known = gauss_newton.minimise(twice, y, [1.0, 1.0], NAMES, tuple(noise), noise=noise)
    np.testing.assert_allclose(fit.estimate.values, known.estimate.values, rtol=1e-3)
    np.testing.assert_allclose(fit.estimate.errors, known.estimate.errors, rtol=0.3)
    assert fit.estimate.rms == pytest.approx(noise, rel=0.3)


def test_what_the_data_do_not_determine_is_named() -> None:
    def product(theta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        g, J = decay(np.array([theta[0] * theta[1], theta[2]]))
        return g, np.stack([J[:, :, 0] * theta[1], J[:, :, 0] * theta[0], J[:, :, 1]], axis=2)

    with pytest.raises(
        ModelError, match=r"the data leave (1/gain and size|gain and 1/size) in proportion undetermined"
    ):
        gauss_newton.minimise(product, data(1), [1.0, 1.0, 1.0], ("gain", "size", "rate"), ("y",))


def flipped(theta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    g, J = decay(theta)
    return g, -J


def test_what_does_not_converge_is_refused() -> None:
    with pytest.raises(
        ModelError, match=r"no minimum was found in \d+ steps: .* of the residual is still in the range of the Jacobian"
    ):
        gauss_newton.minimise(flipped, data(1), [1.0, 1.0], NAMES, ("y",))
    with pytest.raises(ModelError, match="not finite at the start"):
        gauss_newton.minimise(decay, data(1), [1.0, -1e3], NAMES, ("y",))


def test_an_outlier_is_named() -> None:
    y = data(1)
    y[17] += 3
    largest = gauss_newton.minimise(decay, y.tolist(), [1.5, 1.0], NAMES, ("y",)).estimate.largest
    assert largest.row == 17 and largest.deviations > 5
    with pytest.raises(ModelError, match=r"the residual is largest for 'y' in row 17"):
        gauss_newton.minimise(flipped, y, [1.0, 1.0], NAMES, ("y",))


def test_a_residual_of_zero_has_no_rms_to_compare_with() -> None:
    with pytest.raises(ModelError, match=r"undetermined.*; the residual is 0 in all rows$"):
        gauss_newton.minimise(decay, np.zeros((len(T), 1)), [0.0, 1.0], NAMES, ("y",))


def test_noise_that_does_not_settle_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    def twice(theta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        g, J = decay(theta)
        return np.hstack([g, 2 * g]), np.concatenate([J, 2 * J], axis=1)

    y = np.hstack([data(1), 2 * data(2, 0.5)])
    monkeypatch.setattr(gauss_newton, "PASSES", 1)
    with pytest.raises(ModelError, match=r"does not converge in 1 fits: give the `noise`"):
        gauss_newton.minimise(twice, y, [1.5, 1.0], NAMES, ("p", "q"))
