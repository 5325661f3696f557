"""Information, its worst case and zeros of determinants, on measurements with known results."""

from collections.abc import Sequence
from typing import Any

import casadi as ca
import mpmath
import numpy as np
import pytest

from synth.analyse.numerics import precise
from synth.analyse.observability import information, isolated_zeros
from synth.errors import ModelError

# Two ranges from beacons at (0, 0) and (a, 0) to a place (x, y): rank is lost on the line through them.
A = 3.0
Q = ca.SX.sym("q", 2)
RANGES = ca.Function("ranges", [Q], [ca.vertcat(ca.norm_2(Q), ca.norm_2(Q - ca.DM([A, 0.0])))])


def test_deviations_are_those_of_the_inverse_information() -> None:
    at = np.random.default_rng(0).uniform(0.5, 2.0, (50, 2))
    H = information.jacobians(RANGES, at)
    expected = [0.1 * np.sqrt(np.diag(np.linalg.inv(h.T @ h))) for h in H]
    for sizes in ([1.0, 1.0], [1.0, 0.2]):
        np.testing.assert_allclose(information.accuracy(H, 0.1, sizes).deviations, expected, rtol=1e-10)
    np.testing.assert_allclose(information.accuracy(H, 0.1, [1.0, 1.0]).condition, np.linalg.cond(H), rtol=1e-10)


def test_lost_rank_has_no_deviation_and_no_bias() -> None:
    H = information.jacobians(RANGES, [[1.0, 0.0], [1.0, 1.0]])
    accuracy = information.accuracy(H, 0.1, [1.0, 1.0])
    assert (
        np.isinf(accuracy.deviations[0]).all()
        and np.isinf(accuracy.condition[0])
        and np.isfinite(accuracy.deviations[1]).all()
    )
    with pytest.raises(ModelError, match="rank is lost at 1 of the places, the first is number 0"):
        information.bias(H, np.zeros((2, 2)), [1.0, 1.0])
    assert np.isinf(information.accuracy(H[1:, :1], 0.1, [1.0, 1.0]).deviations).all()  # fewer rows than unknowns


def test_the_bias_is_that_of_least_squares() -> None:
    H = np.random.default_rng(1).normal(size=(4, 5, 3))
    extra = H @ np.array([1.0, -2.0, 0.5]) + 0.0
    np.testing.assert_allclose(information.bias(H, extra, [1.0, 2.0, 3.0]), np.tile([1.0, -2.0, 0.5], (4, 1)))


def test_small_columns_keep_their_digits() -> None:
    H = np.random.default_rng(0).standard_normal((50, 6, 3)) * [1, 10**-13.5, 10**-13.5]
    norms = np.linalg.norm(H, axis=1)
    equal, extra = H / norms[:, None], np.ones((50, 6))
    inverse = np.linalg.inv(equal.transpose(0, 2, 1) @ equal)
    exact = np.sqrt(np.diagonal(inverse, axis1=1, axis2=2)) / norms
    np.testing.assert_allclose(information.accuracy(H, 1.0, [1, 1, 1]).deviations, exact, rtol=1e-12)
    expected = np.array([np.linalg.lstsq(e, v)[0] for e, v in zip(equal, extra, strict=True)]) / norms
    np.testing.assert_allclose(information.bias(H, extra, [1, 1, 1]), expected, rtol=1e-9)


def test_a_place_with_much_information_does_not_hide_one_with_little() -> None:
    H = np.array([1e6 * np.eye(2), np.eye(2)])
    assert information.largest_deviation(H, 1.0, [1.0, 1.0]) == pytest.approx(1.0, rel=1e-6)


def test_the_largest_deviation_after_a_loss_is_that_of_the_rows_that_stay() -> None:
    H = np.random.default_rng(2).normal(size=(30, 6, 2))
    left = [np.delete(H, [2 * k, 2 * k + 1], axis=1) for k in range(3)]
    expected = max(information.largest_deviation(h, 0.1, [1.0, 2.0]) for h in left)
    assert information.largest_deviation(H, 0.1, [1.0, 2.0], 2) == pytest.approx(expected, rel=1e-6)
    with pytest.raises(ModelError, match="6 rows do not make groups of 4"):
        information.largest_deviation(H, 0.1, [1.0, 2.0], 4)


def slope_deviation(q: np.ndarray) -> np.ndarray:
    """Return the deviation of q of a measurement sin(q) + 2 q."""
    return 1 / np.abs(np.cos(q) + 2)


def slope_change(q: np.ndarray, half: np.ndarray) -> np.ndarray:
    return np.abs(np.sin(q)) * half + half**2 / 2


def test_the_largest_deviation_is_attained_and_proved() -> None:
    worst = information.search(slope_deviation, slope_change, [0.0], [6.0], [4], 1e-3)
    assert worst.attained[0] == pytest.approx(1.0, rel=1e-3) and worst.at[0, 0] == pytest.approx(np.pi, abs=0.1)
    assert worst.attained[0] <= 1.0 <= worst.bound[0] <= 1.0011 * worst.attained[0]


def sines(shift: float) -> isolated_zeros.Equations:
    """Return sin(p) = shift, cos(2 q) + sin(p) = shift: zeros at which cos(2 q) = 0, eight of them."""

    def f(at: Sequence[Any]) -> list[Any]:
        return [at[0].sin() - shift, (2 * at[1]).cos() + at[0].sin() - shift]

    def possible(cells: np.ndarray, half: float) -> np.ndarray:
        first = np.abs(np.sin(cells[0]) - shift) <= half
        return first & (np.abs(np.cos(2 * cells[1]) + np.sin(cells[0]) - shift) <= 3 * half)

    return isolated_zeros.Equations(2, f, possible)


def test_all_zeros_are_found() -> None:
    with precise.precision():
        zeros = sorted(
            tuple(float(isolated_zeros.within_turn(v)) for v in c.at) for c in isolated_zeros.search(sines(0.5))
        )
    expected = sorted((p, np.pi / 4 * k) for p in (np.pi / 6, 5 * np.pi / 6) for k in (1, 3, 5, 7))
    np.testing.assert_allclose(zeros, expected, rtol=1e-15)


def test_slopes_are_the_derivatives() -> None:
    with precise.precision():
        at = (precise.matrix([[0.3]])[0, 0], precise.matrix([[0.8]])[0, 0])
        slopes = sines(0.5).slopes(at)
    expected = [[np.cos(0.3), 0.0], [np.cos(0.3), -2 * np.sin(1.6)]]
    np.testing.assert_allclose([[float(slopes[i, j]) for j in (0, 1)] for i in (0, 1)], expected, rtol=1e-15)


def test_a_zero_missed_by_newton_is_detected(monkeypatch: pytest.MonkeyPatch) -> None:
    right = isolated_zeros.newton

    def forgetful(*of: object) -> object:
        end = right(*of)  # type: ignore[arg-type]
        return None if end is not None and abs(float(end[1]) - np.pi / 4) < 0.1 else end

    monkeypatch.setattr(isolated_zeros, "newton", forgetful)
    monkeypatch.setattr(isolated_zeros, "MAX_BISECTIONS", 8)
    with precise.precision(), pytest.raises(ModelError, match=r"near the phases .* rad zeros meet or lie on a line"):
        isolated_zeros.search(sines(0.5))


def test_double_zeros_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(isolated_zeros, "MAX_BISECTIONS", 6)
    with precise.precision(), pytest.raises(ModelError, match="meet or lie on a line"):
        isolated_zeros.search(sines(1.0))


@pytest.mark.parametrize("condition", [1e3, 1e8, 1e10])
def test_the_bias_keeps_its_digits_where_the_condition_is_large(condition: float) -> None:
    """By the normal equations in 60 digits."""
    rng = np.random.default_rng(5)
    U, V = np.linalg.qr(rng.normal(size=(6, 3)))[0], np.linalg.qr(rng.normal(size=(3, 3)))[0]
    H, extra = U @ np.diag([1.0, 0.1, 1 / condition]) @ V.T, rng.normal(size=6)
    with mpmath.workdps(60):
        M, e = mpmath.matrix(H.tolist()), mpmath.matrix(extra.tolist())
        exact = np.array([float(v) for v in mpmath.lu_solve(M.T * M, M.T * e)])
    bias = information.bias(H[None], extra[None], np.ones(3))[0]
    assert np.linalg.norm(bias - exact) < 100 * np.finfo(float).eps * condition * np.linalg.norm(exact)
