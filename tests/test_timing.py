"""Continuous and sampled time never mix, nor do two periods."""

import math
from typing import Any

import numpy as np
import pytest

from synth.errors import TimingError
from synth.timing import Continuous, Discrete, Time, common, period


@pytest.mark.parametrize("period_s", [0.0, -1e-3, math.nan, math.inf])
def test_a_period_is_finite_and_positive(period_s: float) -> None:
    with pytest.raises(TimingError, match=f"{period_s} s: it must be finite and positive"):
        Discrete(period_s)


@pytest.mark.parametrize("period_s", ["a", None, True, 1j, [1.0], np.array([0.1])])
def test_a_period_is_a_number(period_s: Any) -> None:
    with pytest.raises(TimingError, match=r"the sample period is .*: give a number of seconds"):
        Discrete(period_s)
    assert Discrete(np.float64(0.1)) == Discrete(0.1)


@pytest.mark.parametrize("time", [Continuous(), Discrete(1e-3)])
def test_equal_times_have_that_time_in_common(time: Time) -> None:
    assert common(time) == common(time, time, time) == time


@pytest.mark.parametrize(
    ("first", "second", "text"),
    [
        (Continuous(), Discrete(1e-3), "continuous time meets discrete time of 0.001 s"),
        (Discrete(1e-3), Discrete(2e-3), "discrete time of 0.001 s meets discrete time of 0.002 s"),
    ],
)
def test_unlike_times_are_refused(first: Time, second: Time, text: str) -> None:
    with pytest.raises(TimingError, match=f"{text}: discretise or resample"):
        common(first, first, second)


def test_only_sampled_time_has_a_period() -> None:
    assert period(Discrete(1.25e-3)) == 1.25e-3
    with pytest.raises(TimingError, match="discretise it first"):
        period(Continuous())
