"""Counts and zeros from remainder sequences, against all complex zeros in ball arithmetic and polynomials by hand."""

from typing import Any

import flint
import numpy as np
import pytest

from synth.analyse.numerics import precise, sturm

NONE = flint.fmpz_poly([])


def product(*zeros: int | complex) -> flint.fmpz_poly:
    """Return a polynomial with whole zeros, a complex one with its conjugate."""
    P = flint.fmpz_poly([1])
    for z in zeros:
        whole = complex(z)
        a, b = int(whole.real), int(whole.imag)
        P *= flint.fmpz_poly([a * a + b * b, -2 * a, 1] if b else [-a, 1])
    return P


def random_parts(seed: int) -> tuple[flint.fmpz_poly, flint.fmpz_poly]:
    """Return the real and the imaginary part of a polynomial with coefficients of many sizes."""
    rng = np.random.default_rng(seed)
    degree = int(rng.integers(2, 31))
    size = 2.0 ** rng.uniform(0, 50, (2, degree + 1))
    real, imaginary = ((rng.standard_normal(degree + 1) * s).round() for s in size)
    return flint.fmpz_poly([*map(int, real)]), flint.fmpz_poly([*map(int, imaginary)])


@pytest.mark.parametrize("seed", range(20))
def test_the_counts_are_those_of_all_complex_zeros(seed: int) -> None:
    real, imaginary = random_parts(seed)
    with precise.precision(128):
        zeros: Any = real.complex_roots()
        turned: list[Any] = (flint.acb_poly(real) + flint.acb(0, 1) * flint.acb_poly(imaginary)).roots()
    assert sturm.count_right_half_plane(real, NONE) == sum(count for z, count in zeros if z.real > 0)
    assert sturm.count_right_half_plane(real, imaginary) == sum(z.real > 0 for z in turned)
    positive = sorted(float(z.real) for z, _ in zeros if z.imag == 0 and z.real > 0)
    zeros_of_product = sturm.positive_zeros(real, 128)
    assert zeros_of_product is not None
    assert [float(z) for z in zeros_of_product] == positive


def test_zeros_on_the_axis_and_repeated_zeros_beside_it() -> None:
    assert sturm.count_right_half_plane(product(3, 3, 1 + 2j, -1, -2 + 5j), NONE) == 4
    assert sturm.count_right_half_plane(product(0, -1, -2), NONE) is None  # a zero on the axis is in neither half
    assert sturm.count_right_half_plane(product(2j, -1), NONE) is None
    assert sturm.count_right_half_plane(flint.fmpz_poly([5]), NONE) == 0
    assert sturm.count_right_half_plane(NONE, NONE) is None


def test_positive_zeros_close_to_each_other_repeated_and_at_the_ends_of_the_range() -> None:
    close = flint.fmpz_poly([-(10**12), 10**12]) * flint.fmpz_poly([-(10**12 + 1), 10**12])  # 1 and 1 + 1e-12
    zeros_of_product = sturm.positive_zeros(close * product(0, 0, 7, 7, -3, 1 + 1j), 128)
    assert zeros_of_product is not None
    assert np.allclose([float(z) for z in zeros_of_product], [1.0, 1 + 1e-12, 7.0], rtol=1e-15, atol=0)
    assert sturm.positive_zeros(product(-1, -2, 1 + 1j), 128) == []
    assert sturm.positive_zeros(NONE, 128) == []
    wide = sturm.positive_zeros(product(10**30) * flint.fmpz_poly([-1, 10**30]), 128)
    assert wide is not None
    assert np.allclose([float(z) for z in wide], [1e-30, 1e30], rtol=1e-15, atol=0)


def test_a_sequence_with_a_gap_is_left_to_the_caller() -> None:
    assert sturm.positive_zeros(flint.fmpz_poly([-1, 0, 0, 0, 1]), 128) is None  # x^4 - 1: 4 x^3, then 1
