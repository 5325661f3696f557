"""Eigenvalues of exact matrices: those of a Jordan block do not scatter, and a constant mode does not decay."""

import numpy as np
import pytest

from synth.analyse.numerics import precise
from synth.statespace import Complex
from synth.synthesise.riccati import exact
from synth.timing import Continuous, Discrete
from tests import tolerances


def of(F: object) -> Complex:
    with precise.precision():
        return exact.eigenvalues(exact.ball(np.asarray(F, dtype=float)))


def test_a_jordan_block_has_its_pole_to_the_last_digit() -> None:
    block = 0.5 * np.eye(5) + np.diag([1.0] * 4, 1)
    np.testing.assert_array_equal(of(block), [0.5] * 5)
    mixed = block + 1e-13 * np.diag([1.0], -4)  # one rounding of this size moves them by its fifth root
    np.testing.assert_allclose(np.abs(of(mixed) - 0.5), [1e-13**0.2] * 5, rtol=1e-9)


def test_eigenvalues_agree_with_numpy() -> None:
    F = np.random.default_rng(0).normal(size=(6, 6))
    np.testing.assert_allclose(of(F), np.sort_complex(np.linalg.eigvals(F)), rtol=tolerances.of("double"))
    assert of(np.zeros((0, 0))).shape == (0,)


@pytest.mark.parametrize(
    ("poles", "time", "expected"),
    [
        ([-1, 0, 1], Continuous(), [True, False, False]),
        ([-1e6, -1e-7], Continuous(), [True, False]),
        ([0, -0.999, 1 - 1e-13, -1, 1.1], Discrete(1), [True, True, False, False, False]),
    ],
)
def test_what_decays(poles: list[float], time: Continuous | Discrete, expected: list[bool]) -> None:
    np.testing.assert_array_equal(exact.decays(np.array(poles, dtype=complex), time), expected)


@pytest.mark.parametrize("ratio", [1e6, 1e12, 1e18])
def test_a_slow_mode_beside_a_fast_one_is_compared_with_its_own_size(ratio: float) -> None:
    assert exact.unstable_pole(np.diag([-1.0, -ratio]), Continuous()) is None
    assert exact.unstable_pole(np.diag([1.0, -ratio]), Continuous()) == 1


def test_what_decays_by_a_rounding_error_alone_lasts() -> None:
    turn = np.array([[-1e-15, 1.0], [-1.0, -1e-15]])
    assert abs(exact.unstable_pole(turn, Continuous()) or 0) == pytest.approx(1)
    assert exact.unstable_pole(turn - 1e-9 * np.eye(2), Continuous()) is None
    assert exact.unstable_pole(np.array([[1 - 1e-15]]), Discrete(1)) is not None
    assert exact.unstable_pole(np.array([[1 - 1e-9]]), Discrete(1)) is None
    assert exact.unstable_pole(np.zeros((0, 0)), Continuous()) is None


def test_a_double_undamped_mode_lasts_however_it_scatters() -> None:
    """(s^2 + w^2)^2 in companion form, in random coordinates: rounding splits each pole by 1e-8."""
    rng = np.random.default_rng(4)
    for w in np.linspace(0.5, 5, 10):
        A = np.diag([1.0] * 3, 1)
        A[-1] = [-(w**4), 0, -2 * w * w, 0]
        V = np.linalg.qr(rng.normal(size=(4, 4)))[0]
        assert exact.unstable_pole(V @ A @ V.T, Continuous()) is not None


@pytest.mark.parametrize(("s", "continuous", "sampled"), [(0.0, 0, None), (1.0, 1, 1), (-1.0, None, -1)])
def test_a_jordan_block_whose_left_eigenvectors_are_not_finite_counts(
    s: float, continuous: complex | None, sampled: complex | None
) -> None:
    """For s = 0 an eigenvector is infinite; without a bound in its place nothing would count as growing."""
    block = exact.ball(s * np.eye(3) + np.eye(3, k=1))
    with precise.precision():
        assert exact.exact_unstable_pole(block, Continuous()) == continuous
        assert exact.exact_unstable_pole(block, Discrete(1.0)) == sampled
