"""Compensators against python-control, high precision and the published loops of the planar positioner."""

from collections.abc import Callable

import control
import mpmath
import numpy as np
import pytest
import scipy.signal
from hypothesis import example, given, settings
from hypothesis import strategies as st

from synth.analyse.loops import feedback_loop, loop, stability_margins
from synth.statespace import StateSpace
from synth.synthesise.classical import lead_lag
from synth.synthesise.classical.lead_lag import Compensator
from synth.timing import Continuous, Discrete
from tests import tolerances

Method = Callable[[Compensator, float, float], lead_lag.LeadLag]
T, W = 1e-3, 108.9
METHODS = (lead_lag.tustin, lead_lag.prewarped)
UNITS = {"q_error": "m", "f": "N"}


def paper() -> Compensator:
    """Y(21)."""
    return lead_lag.from_time_constants(1.5e4, [0.11, 0.1], [0.00088], 1, input="q_error", output="f", units=UNITS)


def inertia(value: float = 1.52) -> StateSpace:
    names = (("q", "v"), ("f",), ("q",), Continuous(), {"q": "m", "v": "m/s", "f": "N"})
    return StateSpace([[0, 1], [0, 0]], [[0], [1 / value]], [[1, 0]], [[0]], *names)


def rational(K: Compensator) -> control.TransferFunction:
    return control.tf(K.gain * np.atleast_1d(np.poly(K.zeros)), np.atleast_1d(np.poly(K.poles)))


def test_time_constants_and_zeros_and_poles_say_the_same() -> None:
    s = np.array([0.1j, 3j, 100j, 2 + 5j])
    expected = 1.5e4 * (1 + 0.11 * s) / (1 + 0.00088 * s) * (1 + 0.1 * s) / s
    np.testing.assert_allclose(paper().model.response(s)[:, 0, 0], expected, rtol=tolerances.of("double"))
    assert paper().gain == pytest.approx(1.5e4 * 0.11 * 0.1 / 0.00088)
    for gain, zeros, poles in (
        (323252.0, (-102.91, -10.0), (-776.828, 0.0)),  # Y(23)
        (900.0, (-80.0413, -10.0), (-604.199, 0.0)),  # Y(24)
    ):
        expected = gain * (s - zeros[0]) * (s - zeros[1]) / (s - poles[0]) / (s - poles[1])
        response = Compensator(gain, zeros, poles).model.response(s)[:, 0, 0]
        np.testing.assert_allclose(response, expected, rtol=tolerances.of("double"))


def test_pi_and_filtered_pd_are_special_cases() -> None:
    s = np.array([0.3j, 40j])
    pi = lead_lag.from_time_constants(7.0, [0.2], [], 1)
    pd = lead_lag.from_time_constants(7.0, [0.2], [0.01])
    gain = lead_lag.from_time_constants(-7.0, [], [])
    np.testing.assert_allclose(pi.model.response(s)[:, 0, 0], 7 * (1 + 0.2 * s) / s, rtol=1e-12)
    np.testing.assert_allclose(pd.model.response(s)[:, 0, 0], 7 * (1 + 0.2 * s) / (1 + 0.01 * s), rtol=1e-12)
    for method in METHODS:
        sampled = method(gain, T, W)
        assert sampled.discrete.D[0, 0] == -7.0 and sampled.zeros == () and sampled.phase_error == 0


def random(rng: np.random.Generator) -> Compensator:
    n = int(rng.integers(1, 4))
    poles = (*-rng.uniform(1, 900, n - 1), 0.0) if rng.random() < 0.5 else tuple(-rng.uniform(1, 900, n))
    zeros = -rng.uniform(1, 900, int(rng.integers(0, n + 1)))
    return Compensator(float(rng.normal() * 100), tuple(map(float, zeros)), tuple(map(float, poles)))


@settings(derandomize=True, max_examples=15, deadline=None)
@given(st.integers(0, 10**6))
@example(3)
@example(85)
@example(167)
def test_python_control_samples_it_alike(seed: int) -> None:
    """As state-space forms: those of transfer functions are sampled through polynomials with all roots near z = 1.

    These lose up to ten digits, as in the three examples, where this package is right to fifteen.
    """
    rng = np.random.default_rng(seed)
    K, at = random(rng), float(rng.uniform(20, 2500))
    system, z = control.ss(rational(K)), np.exp(1j * np.array([0.02, 0.4, 2.0]))
    expected = {
        lead_lag.tustin: control.sample_system(system, T, "tustin"),
        lead_lag.prewarped: control.sample_system(system, T, "tustin", prewarp_frequency=at),
    }
    for method, witness in expected.items():
        sampled = method(K, T, at)
        near = tolerances.of("double") * np.abs(witness(z)).max()
        np.testing.assert_allclose(
            sampled.discrete.response(z)[:, 0, 0], witness(z), rtol=0, atol=near, err_msg=sampled.method
        )
        assert len(sampled.poles) == len(K.poles) and sampled.discrete.time == Discrete(T)


@pytest.mark.parametrize("method", METHODS)
def test_zeros_poles_and_gain_are_those_of_the_sampled_model(method: Method) -> None:
    for K in (paper(), Compensator(3.0, (), (-50.0, 0.0)), Compensator(-3.0, (-20.0,), (-50.0, -300.0))):
        sampled, z = method(K, T, W), np.exp(1j * np.array([0.02, 0.4, 2.0]))
        value = (
            sampled.gain
            * np.prod([z - v for v in sampled.zeros], axis=0)
            / np.prod([z - v for v in sampled.poles], axis=0)
        )
        np.testing.assert_allclose(sampled.discrete.response(z)[:, 0, 0], value, rtol=tolerances.of("double"))
        assert sum(abs(p - 1) < 1e-15 for p in sampled.poles) == K.poles.count(0.0)


def test_the_errors_at_the_frequency_are_reported() -> None:
    z, s = np.exp(1j * W * T), 1j * W
    for method in METHODS:
        sampled = method(paper(), T, W)
        ratio = sampled.discrete.response(z)[0, 0, 0] / paper().model.response(s)[0, 0, 0]
        assert sampled.gain_error == pytest.approx(abs(ratio) - 1, abs=1e-12)
        assert sampled.phase_error == pytest.approx(np.degrees(np.angle(ratio)), abs=1e-10)
    exact = lead_lag.prewarped(paper(), T, W)
    assert abs(exact.gain_error) < 1e-12 and abs(exact.phase_error) < 1e-10
    bent = lead_lag.tustin(paper(), T, W)  # its frequency scale is (2/T) tan(w T / 2)
    warped_ratio = paper().model.response(2j / T * np.tan(W * T / 2))[0, 0, 0] / paper().model.response(s)[0, 0, 0]
    assert bent.gain_error == pytest.approx(abs(warped_ratio) - 1, abs=1e-12) and abs(bent.gain_error) > 1e-4


def test_the_numbers_are_rounded_once() -> None:
    """Fifty digits, rounded: the numbers are the same on every machine."""
    with mpmath.workdps(50):
        half = mpmath.mpf(W) * mpmath.mpf(T) / 2
        scale = mpmath.mpf(W) / mpmath.tan(half)
        K = paper()
        z = [float((scale + mpmath.mpf(v)) / (scale - mpmath.mpf(v))) for v in (*K.zeros, *K.poles)]
        gain = mpmath.mpf(K.gain)
        for v in K.zeros:
            gain *= scale - mpmath.mpf(v)
        for v in K.poles:
            gain /= scale - mpmath.mpf(v)
        sampled = lead_lag.prewarped(K, T, W)
        assert [*sampled.zeros, *sampled.poles] == z and sampled.gain == float(gain)


def test_the_difference_equation_answers_as_scipys_filter() -> None:
    """A chain of sections stepped by hand, against lfilter on the polynomials of the printed zeros, poles and gain."""
    u, sampled = np.random.default_rng(1).normal(size=40), lead_lag.prewarped(paper(), T, W)
    x, y = np.zeros(2), []
    for value in u:
        y.append(float((sampled.discrete.C @ x + sampled.discrete.D[0] * value)[0]))
        x = sampled.discrete.A @ x + sampled.discrete.B[:, 0] * value
    expected = scipy.signal.lfilter(sampled.gain * np.poly(sampled.zeros), np.poly(sampled.poles), u)
    np.testing.assert_allclose(y, expected, rtol=0, atol=1e-9 * np.abs(expected).max())


def test_the_positioners_step_is_that_of_the_loop_sampled_by_the_trapezoidal_rule() -> None:
    """Y-9 recomputes to 12 ms, 13.036 % and 133 ms (10 to 90 %, 2 %) at 1 kHz with Tustin's rule and no delay.

    The continuous loop gives 13.16 ms, 12.655 % and 134.4 ms, the prewarped one 13.04 % too: the row was sampled.
    """
    discrete = lead_lag.tustin(paper(), T, W).discrete
    closed = feedback_loop.close(loop.sampled(inertia(), T), discrete).T
    y, x = [], np.zeros(len(closed.A))
    for _ in range(1000):
        y.append(float((closed.C @ x + closed.D[:, 0])[0]))
        x = closed.A @ x + closed.B[:, 0]
    y = np.array(y)
    assert 100 * (y.max() - 1) == pytest.approx(13.036, abs=0.5e-3)
    assert np.argmax(y >= 0.9) - np.argmax(y >= 0.1) == 12
    assert np.flatnonzero(np.abs(y - 1) > 0.02)[-1] == 133
    whole = feedback_loop.close(inertia(), paper().model).T
    _, smooth = scipy.signal.step((whole.A, whole.B, whole.C, whole.D), T=np.linspace(0, 0.1, 4001))
    assert 100 * (smooth.max() - 1) == pytest.approx(12.655, abs=1e-3)


def test_the_sampled_controller_keeps_the_published_loops_margin_under_the_hold() -> None:
    """With the prewarped controller in place of the continuous one, Y-7 at 1 kHz keeps its digits: 17.322, 71.387."""
    closed = feedback_loop.close(loop.sampled(inertia(), T), lead_lag.prewarped(paper(), T, W).discrete)
    (crossing,) = stability_margins.of_loop(closed.L).gain_crossings
    assert crossing.frequency / (2 * np.pi) == pytest.approx(17.322, abs=0.5e-3)
    assert crossing.phase_margin == pytest.approx(71.387, abs=0.5e-3)
    # half a sample forgotten is seen: 3 degrees
    late = feedback_loop.close(loop.sampled(inertia(), T, T / 2), lead_lag.prewarped(paper(), T, W).discrete)
    (crossing,) = stability_margins.of_loop(late.L).gain_crossings
    assert abs(crossing.phase_margin - 71.387) > 3


def test_signals_and_units_are_carried_and_printed() -> None:
    model = paper().model
    assert model.labels((*model.states, *model.outputs)) == ("f_section1 [m s]", "f_section2 [m s]", "f [N]")
    lag = Compensator(1.0, (), (-1.0, -2.0), units={"error": "m"}).model
    assert [lag.unit(s) for s in lag.states] == ["m s", "m s s"]
    sampled = lead_lag.prewarped(paper(), T, W)
    assert sampled.discrete.unit("f_section1") == "m"
    assert "q_error [m] to f [N]" in repr(paper()) and "-1136.3636" in repr(paper())
    assert "prewarped tustin" in repr(sampled) and "17.332 Hz" in repr(sampled) and "0.27490527" in repr(sampled)
