"""Significant digits: rounding, bounds from above, poles with and without an imaginary part."""

import math

import numpy as np
import pytest

from synth.synthesise import digits


def test_cut_drops_last_bits() -> None:
    assert digits.significant(np.pi, 4) == 3.142
    assert digits.significant(math.nextafter(0.1, 1), 12) == digits.significant(0.1, 12) == 0.1


@pytest.mark.parametrize("value", [1.0, 1e-17, 1.0000001e-17, 9.99e-5, 0.0123, 1.7e300])
def test_a_bound_is_rounded_up_to_two_digits(value: float) -> None:
    bound = digits.round_up(value)
    assert value <= bound <= 1.1 * value and bound == float(f"{bound:.1e}")


def test_the_bound_of_zero_is_zero() -> None:
    assert digits.round_up(0.0) == 0.0


def test_poles() -> None:
    assert digits.pole(0.9 - 0.1j) == "0.9-0.1i"
    assert digits.pole(complex(-1 / 3, 1e-12)) == "-0.333333"
