"""Delayed loops against the Lambert W function, Padé delays, and the published margins of the planar positioner."""

import control
import numpy as np
import pytest
import scipy.special
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from synth.analyse.loops import stability_margins, transfer
from synth.errors import ModelError
from synth.timing import Continuous
from tests import tolerances

DOUBLE, EXACT = tolerances.of("double"), tolerances.of("frequency")

# k (1 + a s) / (1 + b s) (1 + c s) / s over an inertia: gain, a, inertia, then Hz and degrees of the continuous loop,
# held at 1 kHz and at 800 Hz
POSITIONER = {
    "x, y": (1.5e4, 0.11, 1.52, (17.330, 74.507), (17.322, 71.387), (17.317, 70.607)),
    "phi": (35.0, 0.12, 0.0022, (30.045, 75.008), (30.002, 69.613), (29.977, 68.271)),
}


def tf(numerator: object, denominator: object) -> object:
    return control.tf(numerator, denominator)


def positioner(k: float, a: float, inertia: float) -> object:
    return tf(k * np.polymul([a, 1], [0.1, 1]), inertia * np.array([0.00088, 1, 0, 0, 0]))


def count(loop: transfer.Delayed) -> float:
    return stability_margins.count_unstable_poles(loop)


def lambert_count(a: float, k: float, tau: float) -> int:
    """Count the zeros right of the axis of s + a + k exp(-s tau): s = W_n(-k tau exp(a tau)) / tau - a."""
    n = np.arange(-60, 61)
    return int((scipy.special.lambertw(-k * tau * np.exp(a * tau), n).real / tau - a > 0).sum())


def test_the_response_is_the_product_of_its_factors() -> None:
    w = np.array([0.3, 4.0, 90.0])
    response = transfer.response(transfer.with_delay_and_hold(tf([5], [1, 2]), 0.03, 0.1))(w)
    s = 1j * w
    expected = 5 / (s + 2) * np.exp(-0.03 * s) * (1 - np.exp(-0.1 * s)) / (0.1 * s)
    np.testing.assert_allclose(response, expected, rtol=DOUBLE)
    assert transfer.response(transfer.with_delay_and_hold(tf([5], [1, 2]), 0.0, 0.1))(0.0) == pytest.approx(2.5)


@settings(derandomize=True, max_examples=30, deadline=None)
@given(st.floats(-3, 3), st.floats(0.1, 40), st.floats(0.01, 2))
def test_unstable_poles_are_counted_as_the_lambert_function_counts_them(a: float, k: float, tau: float) -> None:
    n = np.arange(-60, 61)
    roots = scipy.special.lambertw(-k * tau * np.exp(a * tau), n) / tau - a
    assume(np.abs(roots.real).min() > 1e-4 and k * tau < 50)
    assert count(transfer.with_delay_and_hold(tf([k], [1, a]), tau)) == lambert_count(a, k, tau)


@pytest.mark.parametrize("tau", [0.01, 0.04, 0.2])
@pytest.mark.parametrize(
    ("numerator", "denominator"),
    [
        ([20, 60, 40], [1, 9, 0, 0]),  # two integrators
        ([8, 20], [1, 3, -4]),  # an unstable pole
        (np.polymul([2, 3], [1, 1, 9]), np.polymul([1, 4, 0], [1, 0, 9])),  # a resonator on the axis
        ([0.4, 9], [1, 2]),  # passes its input straight on
    ],
)
def test_unstable_poles_are_counted_as_a_pade_delay_counts_them(
    numerator: list[float], denominator: list[float], tau: float
) -> None:
    above, below = control.pade(tau, 9)
    closed = np.polyadd(np.polymul(numerator, above), np.polymul(denominator, below))
    assert count(transfer.with_delay_and_hold(tf(numerator, denominator), tau)) == (np.roots(closed).real > 1e-7).sum()


@pytest.mark.parametrize(("hidden", "unstable"), [(1.0, 1), (-1.0, 0)])
def test_a_cancelled_pole_is_counted(hidden: float, unstable: int) -> None:
    loop = (np.diag([hidden, -2.0]), [[0.0], [1.0]], [[1.0, 5.0]], [[0.0]])
    assert count(transfer.with_delay_and_hold(loop, 0.1)) == unstable


def test_direct_feedthrough_of_one_or_more_gives_infinitely_many_unstable_poles() -> None:
    for D in (-2.0, 1.0):
        loop = transfer.with_delay_and_hold(tf([D, 2], [1, 1]), 0.1)
        loop_margins = stability_margins.of_loop(loop)
        assert count(loop) == np.inf and not loop_margins.stable and loop_margins.delay_margin == 0
    held = transfer.with_delay_and_hold(tf([-0.5, 2], [1, 1]), 0.01, 0.1)
    assert stability_margins.of_loop(held).stable and stability_margins.of_loop(held).direct == 0


def test_the_count_on_the_stability_boundary_is_refused() -> None:
    with pytest.raises(ModelError, match=r"\|1 \+ L\| is .* at 5 rad/s: rounding hides .*; change its gain"):
        stability_margins.of_loop(transfer.with_delay_and_hold(tf([5], [1, 0]), np.pi / 10))
    with pytest.raises(ModelError, match="more than 1000 turns: give `high` below"):
        stability_margins.of_loop(transfer.with_delay_and_hold(tf([0.5], [1, 0]), 3e3))
    assert not stability_margins.of_loop(transfer.with_delay_and_hold(tf([0.5], [1, 0]), 3e3), high=1.5).stable


def test_a_delayed_loop_of_an_integrator_has_its_closed_form() -> None:
    """L = k exp(-s tau) / s: phase margin 90 - k tau, L < 0 first at pi / (2 tau)."""
    k, tau = 5.0, 0.1
    loop_margins = stability_margins.of_loop(transfer.with_delay_and_hold(tf([k], [1, 0]), tau))
    (crossing,) = loop_margins.gain_crossings
    assert loop_margins.stable and crossing.frequency == pytest.approx(k, rel=EXACT)
    assert crossing.phase_margin == pytest.approx(90 - np.degrees(k * tau), rel=EXACT)
    assert crossing.delay_margin == pytest.approx(np.pi / 2 / k - tau, rel=EXACT)
    assert loop_margins.gain_margin == pytest.approx(np.pi / 2 / tau / k, rel=EXACT)
    assert loop_margins.phase_crossings[1].frequency == pytest.approx(5 * np.pi / 2 / tau, rel=EXACT)
    w = np.linspace(1, 40, 400_001)
    brute = 1 / np.abs(1 + k * np.exp(-1j * w * tau) / (1j * w))
    assert loop_margins.peak_sensitivity == pytest.approx(brute.max(), rel=tolerances.of("peak"))
    assert loop_margins.peak_frequency == pytest.approx(w[brute.argmax()], rel=1e-4)


def test_a_small_delay_keeps_its_high_crossing_and_no_delay_gives_the_model_itself() -> None:
    loop_margins = stability_margins.of_loop(transfer.with_delay_and_hold(tf([5], [1, 0]), 1e-3))
    assert loop_margins.gain_margin == pytest.approx(np.pi / 2 / 1e-3 / 5, rel=EXACT)
    plain, none = (
        stability_margins.of_loop(tf([20, 60], [1, 8, 0])),
        stability_margins.of_loop(transfer.with_delay_and_hold(tf([20, 60], [1, 8, 0]), 0)),
    )
    assert none.stable and none.gain_crossings == plain.gain_crossings


def test_direct_feedthrough_below_one_crosses_infinitely_often() -> None:
    loop_margins = stability_margins.of_loop(transfer.with_delay_and_hold(tf([0.5, 2], [1, 1]), 0.1))
    assert loop_margins.stable and loop_margins.phase_crossings[-1].frequency == np.inf
    assert loop_margins.phase_crossings[-1].gain_margin == pytest.approx(2, rel=EXACT)
    assert loop_margins.gain_margin < 2  # at a finite frequency, where |L| is still larger


@pytest.mark.parametrize("axis", list(POSITIONER))
def test_the_positioners_loops_have_their_recomputed_margins(axis: str) -> None:
    """The continuous loop, and the same with the factor (1 - exp(-s T)) / (s T) of a sample hold and no delay.

    So the controller stays continuous there, and aliases are left out. A hold taken as half a sample of delay, or one
    left out, is seen in the last digits.
    """
    k, a, inertia, *rows = POSITIONER[axis]
    loop = positioner(k, a, inertia)
    for hold, (hertz, degrees) in zip((0.0, 1e-3, 1 / 800), rows, strict=True):
        loop_margins = stability_margins.of_loop(transfer.with_delay_and_hold(loop, 0.0, hold))
        (crossing,) = loop_margins.gain_crossings
        assert loop_margins.stable
        assert crossing.frequency / (2 * np.pi) == pytest.approx(hertz, abs=0.5e-3)
        assert crossing.phase_margin == pytest.approx(degrees, abs=0.5e-3)
    late = stability_margins.of_loop(transfer.with_delay_and_hold(loop, 0.5e-3)).gain_crossings[0]
    assert abs(late.frequency / (2 * np.pi) - rows[1][0]) > 5e-3


def test_each_kind_of_system_is_accepted_and_a_delayed_loop_prints() -> None:
    arrays = ([[-2.0]], [[1.0]], [[5.0]], [[0.0]])
    systems = (arrays, (*arrays, Continuous()), tf([5], [1, 2]))
    values = [transfer.response(s)(3.0)[0] for s in systems]
    assert values == pytest.approx([5 / (2 + 3j)] * 3)
    assert "delay 0.1 s, hold 0.2 s, both exact" in repr(transfer.with_delay_and_hold(arrays, 0.1, 0.2))


def test_on_an_undamped_pole_the_response_is_that_just_beside_it() -> None:
    L = transfer.response(([[0, 1], [-1, 0]], [[0], [1]], [[1, 0]], [[0]]))
    assert abs(L(1.0)[0]) > 1e12
    with pytest.raises(ModelError, match="a pole"):
        transfer.response(([[0.0]], [[1.0]], [[1.0]], [[0.0]]))(0.0)
