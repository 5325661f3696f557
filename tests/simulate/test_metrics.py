"""Metrics against the closed form of the second-order step response.

    y = 1 - exp(-z w t) (cos(v t) + z w / v sin(v t)),  v = w sqrt(1 - z^2)

It overshoots by exp(-pi z / sqrt(1 - z^2)); its error crosses a band for the last time at a root that bisection finds.
"""

import numpy as np
import pytest
from scipy.optimize import brentq

from synth.errors import SignalError
from synth.simulate import metrics

Z, W = 0.4, 5.0
V = W * np.sqrt(1 - Z**2)
TIME = np.arange(60000) * 1e-4


def error(t: np.ndarray) -> np.ndarray:
    return -np.exp(-Z * W * t) * (np.cos(V * t) + Z * W / V * np.sin(V * t))


def crossings(band: float) -> np.ndarray:
    """All times at which |error| crosses the band, refined by root finding."""
    coarse = np.linspace(0, 6, 120001)
    excess = lambda t: abs(error(t)) - band  # noqa: E731
    signs = np.sign(excess(coarse))
    return np.array([brentq(excess, coarse[i], coarse[i + 1]) for i in np.flatnonzero(np.diff(signs))])


@pytest.mark.parametrize(("start", "target"), [(0.0, 1.0), (0.029, 0.022), (-5.0, 2.0)])
def test_step_of_a_second_order_system(start: float, target: float) -> None:
    step = target - start
    response = metrics.step_response(
        TIME, target + step * error(TIME), start, target, 0.05 * abs(step), 1e-3 * abs(step)
    )
    assert response.overshoot == pytest.approx(np.exp(-np.pi * Z / np.sqrt(1 - Z**2)), rel=1e-6)
    assert response.t_s == pytest.approx(crossings(0.05)[-1], abs=1.01e-4)
    assert response.t_enc == pytest.approx(crossings(1e-3)[-1], abs=1.01e-4)
    assert response.t_s < response.t_enc
    assert abs(crossings(0.05)[0] - response.t_s) > 0.1, "the first entry must not pass for settling"


def test_mean_absolute_error_over_a_window() -> None:
    assert metrics.mean_absolute(TIME, 3 * np.sin(2 * np.pi * TIME), 1.0, 4.0) == pytest.approx(6 / np.pi, rel=1e-4)
    assert metrics.mean_absolute([0, 1, 2], [5, -1, 3], 1, 2) == 2.0


def test_missing_events_take_infinite_time() -> None:
    assert metrics.settling_time(TIME, error(TIME) + 1, 0.1) == np.inf
    assert metrics.settling_time([0, 1, 2], [0.0, 0.0, 1.0], 0.1) == np.inf
    assert metrics.settling_time([3, 4, 5], [0.0, 0.0, 0.0], 0.1) == 0.0
    assert metrics.first_exit(TIME, error(TIME), -1, 1) == np.inf


def test_nan_samples_are_outside_every_band() -> None:
    assert metrics.settling_time([0, 1, 2], [0.0, np.nan, 0.0], 0.1) == 2.0
    assert metrics.settling_time([0, 1, 2], [0.0, 0.0, np.nan], 0.1) == np.inf
    assert np.isnan(metrics.overshoot([0.0, np.nan], 0, 1))
    assert np.isnan(metrics.mean_absolute([0, 1], [0.0, np.nan]))
    assert metrics.first_exit([0, 1, 2], [0.0, np.nan, 0.0], -1, 1) == 1.0


def test_first_exit() -> None:
    assert metrics.first_exit([2.0, 2.5, 3.0], [0.0, 1.1, 0.0], -1, 1) == 2.5


def test_no_overshoot_is_zero() -> None:
    assert metrics.overshoot([0.0, 0.5, 0.9], 0, 1) == 0.0


@pytest.mark.parametrize(
    ("call", "says"),
    [
        (lambda: metrics.overshoot([1.0], 1, 1), "finite step"),
        (lambda: metrics.overshoot([], 0, 1), "no sample"),
        (lambda: metrics.settling_time([0, 1], [0, 1], 0.0), "band is 0.0"),
        (lambda: metrics.settling_time([0, 1], [0, 1], np.nan), "band is nan"),
        (lambda: metrics.settling_time([0, 1], [0], 1.0), r"\(2,\) and values \(1,\)"),
        (lambda: metrics.settling_time([], [], 1.0), r"\(0,\)"),
        (lambda: metrics.mean_absolute([0, 1], [0, 1], 5, 6), "no sample in 5 .. 6 s"),
    ],
)
def test_invalid_responses_are_refused(call, says: str) -> None:
    with pytest.raises(SignalError, match=says):
        call()


def test_the_rise_time_of_a_lag_is_its_time_constant_times_log_9() -> None:
    time = np.linspace(0, 1, 100_001)
    rise_time = metrics.rise_time(time, 2 - 3 * (1 - np.exp(-time / 0.05)), 2, -1)
    assert rise_time == pytest.approx(0.05 * np.log(9), rel=1e-6)
    coarse = metrics.rise_time(time[::1000], 1 - np.exp(-time[::1000] / 0.05), 0, 1)
    assert coarse == pytest.approx(0.05 * np.log(9), rel=0.02)  # linear between samples of a fifth of the time constant
    assert metrics.rise_time(time, 0.8 * time, 0, 1) == np.inf
    assert metrics.rise_time([0.0, 1.0], [1.0, 1.0], 0, 1) == 0
    with pytest.raises(SignalError, match="a rise time needs a finite step"):
        metrics.rise_time(time, time, 1, 1)
