"""The sampled filter is D(s) = s w^2 / (s + w)^2 for every input that is linear between samples, and starts softly."""

import numpy as np
import pytest
import scipy.signal

from synth.block import Block
from synth.blocks.laws import derivative_filter
from synth.signals import Signal
from synth.timing import Discrete
from tests import tolerances

T, W = 1e-3, 1000.0
Q, RATE = Signal("q", "m", -1, 1), Signal("dq", "m/s", -5000, 5000)


def block(bandwidth: float = W) -> Block:
    return derivative_filter.block("filter_q", Discrete(T), Q, RATE, bandwidth)


def run(filter: Block, q: np.ndarray, ready: np.ndarray) -> np.ndarray:
    """Return the rate after each sample."""
    step, x, rates = filter.function(), filter.initial, []
    assert [s.name for s in filter.inputs] == ["q", "ready"]
    for k in range(len(q)):
        x, y = (np.asarray(v).ravel() for v in step(x, [q[k], ready[k]]))
        rates.append(y[0])
    return np.array(rates)


def from_rest(n: int) -> np.ndarray:
    """Return the input ``ready`` of a guard: set from the second sample on."""
    return (np.arange(n) > 0).astype(float)


@pytest.mark.parametrize("bandwidth", [50.0, 1000.0, 3000.0])
def test_a_ramp_is_answered_as_in_continuous_time(bandwidth: float) -> None:
    """q = q0 + a t from t = 0: the rate is a (1 - (1 + w t) exp(-w t)), at each sample exactly."""
    k, slope = np.arange(60), 0.8
    rates = run(block(bandwidth), 0.2 + slope * k * T, from_rest(60))
    wt = bandwidth * k * T
    np.testing.assert_allclose(rates, slope * (1 - (1 + wt) * np.exp(-wt)), rtol=0, atol=tolerances.of("double"))


@pytest.mark.parametrize("omega", [5.0, 300.0, 2500.0])
def test_a_sine_is_answered_as_the_first_order_hold_of_D(omega: float) -> None:
    k = np.arange(400)
    rates = run(block(), 0.5 * np.sin(omega * k * T), from_rest(400))
    A, B, C, D = scipy.signal.tf2ss([W * W, 0], [1, 2 * W, W * W])
    A, B, C, D, _ = scipy.signal.cont2discrete((A, B, C, D), T, method="foh")
    z = np.exp(1j * omega * T)
    response = (C @ np.linalg.solve(z * np.eye(2) - A, B) + D)[0, 0]
    tail = slice(100, None)
    exact = 0.5 * np.imag(response * z**k)
    np.testing.assert_allclose(rates[tail], exact[tail], rtol=0, atol=tolerances.of("settled") * omega)
    continuous = 1j * omega * W**2 / (1j * omega + W) ** 2
    # a sine is linear between samples, and free of images of itself, to some (w T)^2
    assert abs(response / continuous - 1) < (omega * T) ** 2
    if omega >= 300:
        assert np.abs(rates[tail] - 0.5 * np.imag(continuous * z**k)[tail]).max() > 1e-3  # the two differ


def test_it_starts_without_a_jump() -> None:
    """Before the measurements are good q stands at 0, then jumps to 0.7, which is no motion."""
    q, ready = np.r_[np.zeros(5), np.full(30, 0.7)], np.r_[np.zeros(6), np.ones(29)]
    assert not run(block(), q, ready).any()
    assert np.abs(run(block(), q, np.ones(35))).max() > 100 * 0.7 / W  # ready too early shows the jump


def test_a_jump_later_on_is_a_rate_whose_sum_is_the_jump() -> None:
    rates = run(block(), np.r_[np.zeros(3), np.full(100, 0.6)], from_rest(103))
    assert rates.max() < 0.6 / T and rates.sum() * T == pytest.approx(0.6, rel=tolerances.of("double"))
    assert np.abs(rates[-1]) < tolerances.of("settled")


def test_the_dc_gain_survives_single_precision() -> None:
    """q enters by its differences alone: standing still at any q gives the rate 0, whatever the constants' rounding."""
    rounded = block().rounded(np.float32)
    assert not run(rounded, np.full(20, 0.123456789), from_rest(20)).any()


def test_states_carry_bounds_by_induction() -> None:
    """|d| <= width: |s| <= width / (1 - lambda), and the rate stays below width / T, as r below that over h."""
    states = {s.name: s for s in derivative_filter.block("f", Discrete(T), Signal("q", "m", 0.5, 2), RATE, W).states}
    bounds = {n: (s.signal.high, s.initial) for n, s in states.items()}
    fade, h = np.exp(-1), (1 - 2 * np.exp(-1)) / T  # w T = 1
    assert list(bounds) == ["q_prev", "s", "r"] and bounds["q_prev"] == (2, 0.5) and states["q_prev"].signal.low == 0.5
    assert bounds["s"] == (pytest.approx(1.5 / (1 - fade), rel=2e-4), 0)
    assert bounds["r"] == (pytest.approx(1.5 / T / h, rel=3e-4), 0)
    assert all(s.signal.low == -s.signal.high for n, s in states.items() if n != "q_prev")


@pytest.mark.parametrize("scalar", [np.float32, np.float64])
@pytest.mark.parametrize("bandwidth", [50.0, 1000.0, 3000.0])
def test_no_motion_drives_the_states_to_their_bounds(bandwidth: float, scalar: type[np.floating]) -> None:
    """The differences that stretch a state most are full widths of one sign, more than any q can make.

    The states come to rest inside by half of the slack and more, so that the limits of the Block never act.
    """
    rounded = block(bandwidth).rounded(scalar)
    step, x = rounded.function(), rounded.initial
    high = np.array([s.signal.high for s in rounded.states])
    for _ in range(2000):
        x = np.asarray(step([-1.0, *x[1:]], [1.0, 1.0])[0]).ravel()
    assert (x[1:] < high[1:] * (1 - derivative_filter.SLACK / 2)).all()
    assert (x[1:] > high[1:] * (1 - 3 * derivative_filter.SLACK)).all()
