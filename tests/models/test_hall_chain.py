"""The chain behind a Hall sensor: gain, the converter's steps and range, and noise as its filter leaves it."""

import casadi as ca
import numpy as np
import pytest
from scipy import integrate

from models import hall_chain
from synth.errors import ModelError
from synth.timing import Discrete

CHAIN, TIME = hall_chain.Chain(), Discrete(1 / 800)


def test_gain_and_step() -> None:
    assert CHAIN.gain == pytest.approx(8.4)
    assert CHAIN.step == 10 / 65536
    w = 2 * np.pi / 50.8e-3
    assert CHAIN.gain * 0.37502 == pytest.approx(3.1502, abs=5e-5)
    assert CHAIN.noise / (CHAIN.gain * 0.37502 * w) == pytest.approx(2.567e-6, abs=5e-10)
    slow = hall_chain.Chain(sensitivity=0.1)  # why the sensitivity is 0.4 V/T and not 0.1
    assert slow.noise / (slow.gain * 0.37502 * w) > 10e-6


def test_the_filter_is_of_first_order() -> None:
    held, volts = ca.SX.sym("held"), ca.SX.sym("volts")
    f = ca.Function("slope", [held, volts], [hall_chain.slope(CHAIN, held, volts)])
    run = integrate.solve_ivp(lambda _, v: [float(f(v[0], 1.0))], (0, TIME.period_s), [0.0], rtol=1e-10, atol=1e-12)
    left = 1 - run.y[0, -1]
    assert left == pytest.approx(hall_chain.correlation(CHAIN, TIME), rel=1e-8)
    assert left == pytest.approx(np.exp(-np.pi / 2), rel=1e-8)


def test_noise_is_of_its_size_and_correlated_from_the_first_sample_on() -> None:
    noise = hall_chain.noise(CHAIN, TIME, (20000, 4), seed=5)
    assert noise.std(axis=0) == pytest.approx(4 * [1e-3], rel=0.02)  # 4 times the standard error of 0.5 %
    for lag in (1, 2):
        product = (noise[:, lag:] * noise[:, :-lag]).mean() / 1e-6
        assert product == pytest.approx(np.exp(-np.pi / 2 * lag), abs=0.02)
    np.testing.assert_array_equal(noise, hall_chain.noise(CHAIN, TIME, (20000, 4), seed=5))
    assert abs(np.corrcoef(noise[0:2000, 0], noise[2000:4000, 0])[0, 1]) < 0.1  # channels are on their own


@pytest.mark.parametrize(
    "changed", [{"corner": 0.0}, {"bits": -1}, {"span": float("nan")}, {"noise": -1e-3}, {"sensitivity": float("inf")}]
)
def test_figures_without_sense_are_refused(changed: dict[str, float]) -> None:
    with pytest.raises(ModelError, match=f"{next(iter(changed))} of the chain"):
        hall_chain.Chain(**changed)  # type: ignore[arg-type]
