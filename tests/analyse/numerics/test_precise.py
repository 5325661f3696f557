"""Balls decide the double to which they round only where all of their numbers round to it."""

import flint
import numpy as np
import pytest

from synth.analyse.numerics import precise


def ball(centre: flint.arb, radius: flint.arb) -> flint.arb_mat:
    return flint.arb_mat([[centre + flint.arb(0, radius)]])


@pytest.mark.parametrize("exponent", [-60, -120])
def test_a_ball_across_the_middle_between_two_doubles_is_open(exponent: int) -> None:
    with precise.precision():
        middle, small = 1 + flint.arb(2) ** -53, flint.arb(2) ** exponent
        assert precise.doubles(ball(middle, small)) is None
        np.testing.assert_array_equal(precise.doubles(ball(middle - 2 * small, small)), [[1.0]])
        np.testing.assert_array_equal(precise.doubles(ball(middle + 2 * small, small)), [[1 + 2.0**-52]])
        assert precise.doubles(ball(flint.arb(1), flint.arb(2) ** -52)) is None


@pytest.mark.parametrize(("odd", "even"), [(1, 1.0), (3, 1 + 2.0**-51)])
def test_what_a_thousand_bits_do_not_tell_from_the_middle_is_the_middle(odd: int, even: float) -> None:
    with precise.precision(4096):
        middle, small = 1 + odd * flint.arb(2) ** -53, flint.arb(2) ** -1100
        for centre in (middle, middle - small / 2, middle + small / 2):
            np.testing.assert_array_equal(precise.doubles(ball(centre, small)), [[even]])


def test_what_is_far_smaller_than_the_largest_entry_is_zero() -> None:
    with precise.precision():
        around_zero = flint.arb(0, flint.arb(2) ** -210)
        np.testing.assert_array_equal(precise.doubles(flint.arb_mat([[1, around_zero]])), [[1.0, 0.0]])
        assert precise.doubles(flint.arb_mat([[1, around_zero * 2**20]])) is None
        assert precise.doubles(flint.arb_mat([[1, flint.arb("nan")]])) is None
