"""An encoder rounds to the nearest count; an analogue sensor saturates and adds noise."""

from collections.abc import Callable

import numpy as np
import pytest

from synth.errors import SignalError
from synth.simulate.scenario import Analogue, Encoder, Sensor


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


def test_a_reading_starts_over_after_its_span() -> None:
    assert Encoder(0.25, span=2.0, low=-1.0).read([0.9, 0.85, 1.0, -1.0, -1.1, 7.3]) == pytest.approx(
        [-1.0, 0.75, -1.0, -1.0, 1.0 - 2.0, -0.75]
    )
    y = np.random.default_rng(1).uniform(-50, 50, 1000)
    np.testing.assert_allclose(Encoder(span=6.0, low=0.5).read(y), 0.5 + (y - 0.5) % 6.0, rtol=0, atol=1e-13)


@pytest.mark.parametrize("resolution", [-1e-5, np.nan, np.inf])
def test_a_resolution_that_is_none_is_refused(resolution: float) -> None:
    with pytest.raises(SignalError, match="encoder resolution"):
        Encoder(resolution)


def test_offset_and_gain_errors_come_before_the_counts() -> None:
    assert Encoder(0.0, 0.5, 0.01).read(2.0) == pytest.approx(2.52)
    assert Encoder(0.1, 0.04, 0.01).read(1.1) == pytest.approx(1.2)  # 1.151
    assert Analogue(-1.0, 1.0, bits=3, offset=0.2).read([0.1, 0.9, -7.0]) == pytest.approx([0.25, 1.0, -1.0])


def test_noise_has_its_size_and_its_seed() -> None:
    sensor = Analogue(-10.0, 10.0, noise=1e-3, seed=3)
    noise = sensor.noise_of(20_000, 0)
    assert np.std(noise) == pytest.approx(1e-3, rel=0.03) and abs(np.mean(noise)) < 3e-5
    assert np.array_equal(noise, sensor.noise_of(20_000, 0)) and not np.array_equal(noise, sensor.noise_of(20_000, 1))
    assert abs(np.corrcoef(noise, sensor.noise_of(20_000, 1))[0, 1]) < 0.05


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: Analogue(1.0, 1.0), "spans 1.0 .. 1.0"),
        (lambda: Analogue(0.0, 1.0, bits=0), "0 bits: give a whole number from 1 to 53"),
        (lambda: Analogue(0.0, 1.0, noise=-1.0), "noise -1.0 rms"),
        (lambda: Encoder(0.0, np.nan), "encoder has the offset nan"),
        (lambda: Encoder(1e-3, 0.0, np.inf), "encoder has the offset 0.0 and the gain error inf"),
        (lambda: Encoder(span=-1.0, low=0.0), "encoder span is -1.0 from 0.0: give finite numbers"),
        (lambda: Encoder(span=1.0), "encoder span is 1.0 from -inf: give finite numbers"),
        (lambda: Analogue(-1e308, 1e308, bits=2), "give finite ends"),
        (lambda: Analogue(0, 1, noise=1, seed=-1), "give a whole number from 0 on"),
    ],
)
def test_errors_that_are_no_numbers_are_refused(make: Callable[[], Sensor], words: str) -> None:
    with pytest.raises(SignalError, match=words):
        make()
