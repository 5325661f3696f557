"""Twofold sums and products against exact integers and ball arithmetic."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from synth.analyse.numerics import precise, twofold


def exact(balls: object) -> np.ndarray:
    """The entries of a ball matrix, each rounded."""
    return np.array([[float(balls[i, j].mid()) for j in range(balls.ncols())] for i in range(balls.nrows())])


def double(values: np.ndarray) -> twofold.Twofold:
    return twofold.Twofold(values, np.zeros_like(values))


def error(product: twofold.Twofold, balls: object, unit: np.ndarray) -> float:
    """The largest error of high + low beside `unit`."""
    rest = balls - precise.matrix(product.high) - precise.matrix(product.low)
    return float((np.abs(exact(rest)) / unit).max())


@settings(derandomize=True, max_examples=30, deadline=None)
@given(seed=st.integers(0, 10**6), n=st.sampled_from([1, 2, 3, 15, 16, 17, 40]), spread=st.sampled_from([0, 30]))
def test_products_have_a_third_more_digits_than_double(seed: int, n: int, spread: int) -> None:
    """An entry is off by n 2^-74 of the largest in its row times the largest in its column; double by n 2^-53."""
    rng = np.random.default_rng(seed)
    X, Y = rng.normal(size=(5, n)), rng.normal(size=(n, 4))
    X, Y = X * 2.0 ** rng.integers(-spread, spread + 1, (5, 1)), Y * 2.0 ** rng.integers(-spread, spread + 1, 4)
    unit = n * np.abs(X).max(axis=1)[:, None] * np.abs(Y).max(axis=0)
    with precise.precision(512):
        balls = precise.matrix(X) * precise.matrix(Y)
        product = twofold.product(X, Y)
        assert error(product, balls, unit) <= 2.0**-72
        assert error(double(X @ Y), balls, unit) <= 2.0**-52  # what the same measure says of double
        Z = rng.normal(size=(4, 3))
        wide = 4 * unit.max(axis=1)[:, None] * np.abs(Z).max(axis=0)
        assert error(twofold.product(product, Z), balls * precise.matrix(Z), wide) <= 2.0**-70


def test_double_is_not_enough_for_the_bound() -> None:
    rng = np.random.default_rng(1)
    X, Y = rng.normal(size=(5, 40)), rng.normal(size=(40, 4))
    unit = 40 * np.abs(X).max(axis=1)[:, None] * np.abs(Y).max(axis=0)
    with precise.precision(512):
        assert error(double(X @ Y), precise.matrix(X) * precise.matrix(Y), unit) > 2.0**-62


def test_sums_that_cancel_keep_what_is_left() -> None:
    rng = np.random.default_rng(2)
    X, Y = rng.normal(size=(3, 3)), rng.normal(size=(3, 3))
    tiny = 2.0**-60 * rng.normal(size=(3, 3))
    left = (double(X) + Y + tiny - X - Y).rounded()
    np.testing.assert_allclose(left, tiny, rtol=2.0**-40)
    assert np.abs(((X + Y) + tiny) - X - Y - tiny).min() > 0  # double loses it completely


def test_parts_and_transposes_are_those_of_the_sum() -> None:
    a = twofold.product(np.arange(6.0).reshape(2, 3), np.full((3, 2), 0.1))
    np.testing.assert_array_equal(a.T[:1].rounded(), a.rounded().T[:1])
    np.testing.assert_array_equal((-a).rounded(), -a.rounded())
    assert (a - a).rounded() == pytest.approx(0)
