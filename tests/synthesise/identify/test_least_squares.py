"""Least squares agree with NumPy and SciPy; intervals cover what they say; what is not determined is named."""

from dataclasses import replace

import numpy as np
import pytest
import scipy.optimize
from hypothesis import given, settings
from hypothesis import strategies as st

from synth.errors import ModelError, SignalError
from synth.synthesise.identify import least_squares
from synth.synthesise.identify.estimates import Estimate
from tests import tolerances

NAMES = ("k", "c", "m", "d", "e")


def problem(seed: int) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    k = int(rng.integers(1, 6))
    Phi = rng.normal(size=(int(rng.integers(k + 2, 40)), k)) * 10.0 ** rng.uniform(-6, 6, k)
    return Phi, Phi @ (rng.normal(size=k) / np.abs(Phi).max(axis=0)) + 0.1 * rng.normal(size=len(Phi))


@settings(derandomize=True, max_examples=25, deadline=None)
@given(st.integers(0, 10**6))
def test_estimates_and_errors_are_those_of_numpy_and_of_curve_fit(seed: int) -> None:
    Phi, y = problem(seed)
    names = NAMES[: Phi.shape[1]]
    estimate = least_squares.solve(Phi, y, names)
    size = np.abs(Phi).max(axis=0)
    theta, ssr, *_ = np.linalg.lstsq(Phi / size, y, rcond=None)
    np.testing.assert_allclose(estimate.values * size, theta, rtol=1e-9, atol=tolerances.of("double"))
    assert estimate.rms["y"] == pytest.approx(np.sqrt(ssr[0] / len(y)))
    assert estimate.residual_freedom == len(y) - len(names)
    fitted, covariance = scipy.optimize.curve_fit(lambda P, *t: P @ np.array(t), Phi / size, y, p0=np.zeros(len(names)))
    np.testing.assert_allclose(estimate.values * size, fitted, rtol=1e-5, atol=1e-6)
    np.testing.assert_allclose(estimate.covariance * size * size[:, None], covariance, rtol=1e-4, atol=1e-9)


def test_a_line_by_hand() -> None:
    """Through (0, 1), (1, 3), (2, 4), (3, 6): slope 1.6, offset 1.1, residuals -0.1, 0.3, -0.3, 0.1, s^2 = 0.1."""
    estimate = least_squares.solve(
        [[0, 1], [1, 1], [2, 1], [3, 1]], [1, 3, 4, 6], ("slope", "offset"), units={"slope": "m"}
    )
    assert estimate.by_name == pytest.approx({"slope": 1.6, "offset": 1.1})
    assert estimate.covariance == pytest.approx(0.1 * np.array([[4, -6], [-6, 14]]) / 20)
    reach = 4.302652729911275 * np.sqrt(0.02)  # Student's 97.5 % point for 2 degrees of freedom, from a table
    np.testing.assert_allclose(estimate.intervals[0], [1.6 - reach, 1.6 + reach])
    assert estimate.correlation[0, 1] == pytest.approx(-6 / np.sqrt(56))
    assert estimate.r_squared["y"] == pytest.approx(1 - 0.2 / 13) and estimate.rms["y"] == pytest.approx(np.sqrt(0.05))
    assert "slope [m]" in str(estimate) and "2 degrees of freedom" in str(estimate)


def coverage(logs: int) -> float:
    """Return the share of 95 % intervals that hold the truth, three from each log of 8 rows."""
    rng, truth = np.random.default_rng(7), np.array([2.0, -1.0, 0.5])
    hits = []
    for _ in range(logs):
        Phi = rng.normal(size=(8, 3))
        low, high = least_squares.solve(Phi, Phi @ truth + 0.3 * rng.normal(size=8), NAMES[:3]).intervals.T
        hits.append((low <= truth) & (truth <= high))
    return float(np.mean(hits))


def test_intervals_hold_the_truth_as_often_as_they_say(monkeypatch: pytest.MonkeyPatch) -> None:
    """Three intervals of one log go together at worst: the share has a standard deviation of at most 1.1 %."""
    assert abs(coverage(500) - 0.95) < 0.03
    right = least_squares.estimate

    def biased(*args: object) -> Estimate:
        estimate = right(*args)
        return replace(
            estimate,
            covariance=estimate.covariance
            * estimate.residual_freedom
            / (estimate.residual_freedom + len(estimate.parameters)),
        )

    monkeypatch.setattr(least_squares, "estimate", biased)
    assert abs(coverage(250) - 0.95) > 0.03, "planted: s^2 with N for N - k"


def test_outputs_with_different_noise_are_weighted_by_their_residuals() -> None:
    rng = np.random.default_rng(3)
    Phi = rng.normal(size=(400, 2, 2))
    noise = {"fine": 1e-3, "coarse": 10.0}
    y = Phi @ [3.0, -2.0] + rng.normal(size=(400, 2)) * list(noise.values())
    known = least_squares.solve(Phi, y, NAMES[:2], tuple(noise), noise)
    estimate = least_squares.solve(Phi, y, NAMES[:2], tuple(noise))
    np.testing.assert_allclose(estimate.values, known.values, atol=1e-6)
    np.testing.assert_allclose(estimate.errors, known.errors, rtol=0.05)
    np.testing.assert_allclose(estimate.errors, 1e-3 / np.sqrt(400), rtol=0.15)
    assert estimate.rms == pytest.approx(noise, rel=0.1)


def test_an_exact_fit_has_no_error() -> None:
    Phi = np.random.default_rng(1).normal(size=(9, 2))
    estimate = least_squares.solve(Phi, Phi @ [1.0, 2.0], NAMES[:2])
    assert (estimate.errors < tolerances.of("double")).all() and estimate.values == pytest.approx([1, 2])


def test_what_the_data_do_not_determine_is_named() -> None:
    rng = np.random.default_rng(2)
    a, b, c = rng.normal(size=(3, 20))
    y = a + 0.01 * rng.normal(size=20)
    with pytest.raises(ModelError, match=r"leave 0\.71 k - 0\.71 c undetermined: log samples in which .* or hold one"):
        least_squares.solve(np.column_stack([a, a, b]), y, NAMES[:3])
    with pytest.raises(ModelError, match=r"leave 0\.89 k - 0\.45 c undetermined"):
        least_squares.solve(np.column_stack([a, 2 * a, b]), y, NAMES[:3])
    with pytest.raises(ModelError, match=r"leave c undetermined"):
        least_squares.solve(np.column_stack([a, 0 * a, b]), y, NAMES[:3])
    with pytest.raises(ModelError, match=r"leave .* and .* undetermined") as caught:
        least_squares.solve(np.column_stack([a, b, c, a + b, 3 * c]), y, NAMES)
    parts = str(caught.value).removeprefix("the data leave ").split(" undetermined")[0].split(" and ")
    assert {frozenset(part.split()[1::3]) for part in parts} == {frozenset("kcd"), frozenset("me")}
    nearly = np.column_stack([a, a + 1e-6 * b])
    assert least_squares.solve(nearly, y, NAMES[:2]).condition > 1e5, "weak, but determined"


def test_an_estimate_answers_by_name() -> None:
    estimate = least_squares.solve([[1.0], [2.0], [3.0]], [1.0, 2.0, 3.1], ("k",))
    assert estimate["k"] == estimate.values[0]
    with pytest.raises(SignalError, match="'m' was not estimated: k were"):
        estimate["m"]


def test_few_rows_do_not_determine_the_noise_of_several_outputs() -> None:
    """A fit that passes through one output would tell errors of 1e-11 where they are 0.1."""
    rng = np.random.default_rng(0)
    Phi = rng.normal(size=(3, 2, 3))
    y = Phi @ [1.0, 2.0, 3.0] + 0.1 * rng.normal(size=(3, 2))
    with pytest.raises(SignalError, match=r"3 rows of 'p', on which 3 parameters act, .*: give the `noise`.* log 1 or"):
        least_squares.solve(Phi, y, NAMES[:3], ("p", "q"))
    assert least_squares.solve(Phi, y, NAMES[:3], ("p", "q"), {"p": 1.0, "q": 1.0}).errors.min() > 1e-3
    Phi = rng.normal(size=(9, 2, 3))
    y = Phi @ [1.0, 2.0, 3.0] + [0.0, 0.1] * rng.normal(size=(9, 2))
    with pytest.raises(ModelError, match=r"exact for 'p' but not for other outputs, .*: give the `noise`"):
        least_squares.solve(Phi, y, NAMES[:3], ("p", "q"))


def test_noise_that_does_not_settle_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    rng = np.random.default_rng(0)
    Phi = rng.normal(size=(9, 2, 3))
    monkeypatch.setattr(least_squares, "PASSES", 2)
    with pytest.raises(ModelError, match=r"does not converge in 2 fits: give the `noise`"):
        least_squares.solve(Phi, rng.normal(size=(9, 2)), NAMES[:3], ("p", "q"))


def test_the_largest_residual_is_named() -> None:
    rng = np.random.default_rng(4)
    Phi = rng.normal(size=(100, 2, 2))
    y = Phi @ [3.0, -2.0] + rng.normal(size=(100, 2)) * [1e-3, 10.0]
    y[57, 0] += 0.05
    estimate = least_squares.solve(Phi, y, NAMES[:2], ("fine", "coarse"))
    assert (estimate.largest.output, estimate.largest.row) == ("fine", 57) and estimate.largest.deviations > 8
    assert "The largest residual is that of 'fine' in row 57" in str(estimate)
    one = least_squares.solve([[1.0], [1.0], [1.0], [1.0]], [0.0, 0.0, 0.0, 4.0], ("k",)).largest
    assert one.row == 3 and one.deviations == pytest.approx(3 / (2 * np.sqrt(3 / 4))), "s = 2, leverage 1/4"
    assert one.median_of_largest == pytest.approx(1.409, abs=2e-3), "(2 F(v) - 1)^4 = 1/2 at v = 1.409, F from a table"
