"""An encoder rounds to the nearest count, and to nothing else."""

import numpy as np
import pytest

from synth.errors import SignalError
from synth.simulate.sensors import Encoder


def test_reading_is_the_nearest_count() -> None:
    y = np.random.default_rng(0).uniform(-1, 1, 1000)
    counts = np.arange(-101, 102) * 0.01
    nearest = counts[np.argmin(np.abs(y[:, None] - counts), axis=1)]
    assert np.allclose(Encoder(0.01).read(y), nearest, rtol=0, atol=1e-15)
    assert not np.allclose(np.floor(y / 0.01) * 0.01, nearest, rtol=0, atol=1e-15)


def test_a_reading_reads_as_itself() -> None:
    m = Encoder(1e-5).read(np.linspace(0.01, 0.03, 777))
    assert np.array_equal(Encoder(1e-5).read(m), m)


def test_zero_resolution_is_ideal() -> None:
    assert Encoder().read(0.123456789) == 0.123456789


@pytest.mark.parametrize("resolution", [-1e-5, np.nan, np.inf])
def test_a_resolution_that_is_none_is_refused(resolution: float) -> None:
    with pytest.raises(SignalError, match="encoder resolution"):
        Encoder(resolution)
