"""Bounds over intervals against values inside, and crossings of delayed loops against a fine grid."""

import control
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from synth.analyse.loops import crossings, stability_margins, transfer, zpk
from synth.errors import ModelError
from synth.statespace import Array

POLES = np.array([-0.01 + 3j, -0.01 - 3j, 0.5, 0.0, -40.0])
ZEROS = np.array([2j, -2j, 7.0])


def loop(hold: float = 0.7) -> zpk.ZeroPoleGain:
    part = zpk.of_system(control.tf(np.poly(ZEROS).real * -30.0, np.poly(POLES).real))
    return zpk.of_rational(part, 0.2 + hold / 2, hold)


def brute(w: Array, hold: float = 0.7) -> Array:
    s = 1j * w[:, None]
    held = np.exp(-0.2j * w) * np.exp(-0.5j * w * hold) * np.sinc(w * hold / (2 * np.pi))
    return np.asarray(-30.0 * np.prod(s - ZEROS, axis=1) / np.prod(s - POLES, axis=1) * held)


def test_the_sum_of_factors_is_the_loop() -> None:
    w = np.geomspace(0.01, 300, 500)
    np.testing.assert_allclose(loop().value(w), brute(w), rtol=1e-9)


@settings(derandomize=True, max_examples=60, deadline=None)
@given(st.floats(0.01, 60), st.floats(1e-4, 0.5), st.sampled_from([0.0, 0.7]))
def test_values_and_slopes_lie_within_their_bounds(start: float, width: float, hold: float) -> None:
    L = loop(hold)
    ends = zpk.interval_ends(L, np.array([start, start * (1 + width)]), start * (1 + width), turning=True)
    a, b = ends[:-1], ends[1:]
    low, high = L.log_gain_bounds(a, b)
    for slopes, f in ((L.phase_slope(a, b), L.phase), (L.log_gain_slope(a, b), L.log_gain)):
        for k in range(len(a)):
            w = np.linspace(a[k] + 1e-3 * (b[k] - a[k]), b[k] - 1e-3 * (b[k] - a[k]), 50)
            slope, slack = np.diff(f(w)) / np.diff(w), 1e-6 * (1 + 1 / (b[k] - a[k]))
            assert slopes[0][k] - slack <= slope.min() and slope.max() <= slopes[1][k] + slack
            size = L.log_gain(w)
            assert low[k] - 1e-9 <= size.min() and size.max() <= high[k] + 1e-9


def test_crossings_are_those_of_a_fine_grid() -> None:
    model = transfer.with_delay_and_hold(control.tf(np.poly(ZEROS).real * -30.0, np.poly(POLES).real), 0.2, 0.7)
    course = crossings.of_delayed_loop(model, zpk.of_system(model.model), None, 20.0)
    w = np.linspace(1e-3, 20, 2_000_001)
    L = brute(w)
    unit = w[:-1][np.diff(np.sign(np.log(np.abs(L)))) != 0]
    real = np.flatnonzero((np.diff(np.sign(L.imag)) != 0) & (L.real[:-1] < 0) & (np.abs(np.diff(L)) < np.abs(L[:-1])))
    assert [c.frequency for c in course.gain_crossings] == pytest.approx(unit.tolist(), abs=2e-5)
    assert [c.frequency for c in course.phase_crossings] == pytest.approx(w[real].tolist(), abs=2e-5)
    assert 1 / course.peak == pytest.approx(np.abs(1 + L).min(), rel=1e-6)


def test_a_gain_that_only_touches_one_counts_as_a_crossing() -> None:
    """|L| = 1 touched from below by a resonance: an interval that stays undecided counts as a crossing."""
    zeta = 0.05
    touching = control.tf([2 * zeta * np.sqrt(1 - zeta**2)], [1, 2 * zeta, 1])
    loop_margins = stability_margins.of_loop(transfer.with_delay_and_hold(touching, 0.3))
    assert loop_margins.phase_margin < 180 and loop_margins.gain_crossings[0].frequency == pytest.approx(
        np.sqrt(1 - 2 * zeta**2), rel=1e-6
    )


@pytest.mark.parametrize(
    ("numerator", "denominator", "delay", "crossings"),
    [
        ([2.1926450482675732, 54.81612620668933], [1, 10, 50], 0.02, [5.0]),  # at the frequency of a pole
        ([16.641005886756872, 9.984603532054125], [1, 12, 45], 1 / 300, None),
        ([1.0], [1.0, 0.0], 0.1, [1.0]),  # at a node of the grid
        ([1.0], [1.0, 0.0], 1e-3, [1.0]),
    ],
)
def test_a_crossing_on_a_node_is_kept(
    numerator: list[float], denominator: list[float], delay: float, crossings: list[float] | None
) -> None:
    loop_margins = stability_margins.of_loop(transfer.with_delay_and_hold(control.tf(numerator, denominator), delay))
    plain = stability_margins.of_loop(control.tf(numerator, denominator))
    expected = [c.frequency for c in plain.gain_crossings] if crossings is None else crossings
    assert [c.frequency for c in loop_margins.gain_crossings] == pytest.approx(expected, rel=1e-9)
    for c, d in zip(loop_margins.gain_crossings, plain.gain_crossings, strict=True):
        turned = d.phase_margin - np.degrees(delay * d.frequency)
        assert (c.phase_margin - turned) % 360 == pytest.approx(0, abs=1e-6) or (
            c.phase_margin - turned
        ) % 360 == pytest.approx(360, abs=1e-6)


@pytest.mark.parametrize("b", [[-1.0, 1.0], [1.0, 1.0], [-2.0, -2.0]])
def test_a_delayed_all_pass_of_gain_one_has_no_delay_margin(b: list[float]) -> None:
    loop_margins = stability_margins.of_loop(transfer.with_delay_and_hold(control.tf(b, [abs(b[0]), abs(b[0])]), 0.1))
    assert (
        not loop_margins.stable
        and loop_margins.delay_margin == 0
        and loop_margins.phase_margin == pytest.approx(0, abs=1e-6)
    )


def test_a_direct_path_of_minus_one_under_a_hold_is_well_posed() -> None:
    """L = -s / (s + 1), delayed and held: direct feedthrough of -1, removed by the hold."""
    loop_margins, beside = (
        stability_margins.of_loop(transfer.with_delay_and_hold(([[-1.0]], [[1.0]], [[1.0]], [[d]]), 0.1, 0.1))
        for d in (-1.0, -1 + 1e-9)
    )
    assert loop_margins.stable and loop_margins.gain_margin == pytest.approx(beside.gain_margin, rel=1e-6)


def test_a_loop_that_stays_close_to_gain_one_is_refused_in_time(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(crossings, "MOST_INTERVALS", 500)
    flat = control.tf([1.0, 1.0 + 1e-15], [1.0, 1.0])
    with pytest.raises(ModelError, match="cannot be separated"):
        stability_margins.of_loop(transfer.with_delay_and_hold(flat * 0.9999999999999, 0.1))


def test_lobes_of_the_hold_above_all_rates_of_the_loop_are_counted() -> None:
    """A loop with a gain of 500 at infinity crosses |L| = 1 in every lobe up to 2 * 500 / hold."""
    model = transfer.with_delay_and_hold(control.tf([500.0, -10.0], [1.0, 0.77]), 1e-3, 1e-3)
    course = crossings.of_delayed_loop(model, zpk.of_system(model.model), None, None)
    w = np.linspace(1.0, 1.2e6, 2_400_001)
    size = np.abs((500j * w - 10) / (1j * w + 0.77) * np.sinc(w * 1e-3 / (2 * np.pi)))
    assert len(course.gain_crossings) == np.count_nonzero(np.diff(np.sign(size - 1))) > 10
