"""Margins against closed forms, against python-control, and against the poles of loops closed at the margin."""

import control
import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from synth.analyse import discretise
from synth.analyse.loops import stability_margins, transfer
from synth.errors import ModelError
from synth.statespace import StateSpace
from synth.timing import Continuous
from tests import tolerances
from tests.analyse.scalar_loops import EXACT, decays, gain, loop, off_boundary


def test_an_integrator_has_90_degrees_at_its_gain() -> None:
    loop_margins = stability_margins.of_loop(loop([5], [1, 0]))
    (crossing,) = loop_margins.gain_crossings
    assert loop_margins.stable and crossing.frequency == pytest.approx(5, rel=EXACT)
    assert loop_margins.phase_margin == pytest.approx(90, rel=EXACT)
    assert loop_margins.delay_margin == pytest.approx(np.pi / 2 / 5, rel=EXACT)
    assert (
        loop_margins.gain_margin == np.inf
        and loop_margins.gain_reduction_margin == 0
        and not loop_margins.phase_crossings
    )
    assert loop_margins.peak_sensitivity == pytest.approx(1, abs=1e-5)  # reached at infinity


@pytest.mark.parametrize("k", [1e-4, 1e6])
def test_no_crossing_is_too_slow_or_too_fast(k: float) -> None:
    loop_margins = stability_margins.of_loop(loop([k], [1, 0]))
    assert [c.frequency for c in loop_margins.gain_crossings] == pytest.approx([k], rel=EXACT)


def test_a_second_order_loop_meets_its_closed_form() -> None:
    """L = w^2 / (s (s + 2 zeta w)): crossing at w sqrt(sqrt(4 zeta^4 + 1) - 2 zeta^2), S by brute force."""
    w, zeta = 30.0, 0.25
    loop_margins = stability_margins.of_loop(loop([w * w], [1, 2 * zeta * w, 0]))
    crossing = w * np.sqrt(np.sqrt(4 * zeta**4 + 1) - 2 * zeta**2)
    v = np.linspace(0.5, 2, 2_000_001)
    sensitivity = np.abs((-(v**2) + 2j * zeta * v) / (1 - v**2 + 2j * zeta * v))
    assert loop_margins.gain_crossings[0].frequency == pytest.approx(crossing, rel=EXACT)
    assert loop_margins.phase_margin == pytest.approx(np.degrees(np.arctan2(2 * zeta * w, crossing)), rel=EXACT)
    assert loop_margins.peak_sensitivity == pytest.approx(sensitivity.max(), rel=tolerances.of("peak"))
    assert loop_margins.peak_frequency == pytest.approx(w * v[sensitivity.argmax()], rel=1e-5)
    assert loop_margins.modulus_margin == pytest.approx(1 / sensitivity.max(), rel=tolerances.of("peak"))


def test_three_equal_lags_have_the_gain_margin_8() -> None:
    loop_margins = stability_margins.of_loop(gain(loop([1], [1, 3, 3, 1]), 4))
    assert loop_margins.gain_margin == pytest.approx(2, rel=EXACT)
    assert loop_margins.phase_crossings[0].frequency == pytest.approx(np.sqrt(3), rel=EXACT)
    assert not stability_margins.of_loop(gain(loop([1], [1, 3, 3, 1]), 8.01)).stable
    assert stability_margins.of_loop(gain(loop([1], [1, 3, 3, 1]), 7.99)).stable


def test_an_unstable_plants_lower_gain_margin_lies_at_zero_frequency() -> None:
    loop_margins = stability_margins.of_loop(loop([4], [1, -1]))
    assert loop_margins.stable and loop_margins.gain_margin == np.inf
    assert loop_margins.gain_reduction_margin == pytest.approx(0.25, rel=EXACT)
    assert loop_margins.phase_crossings[0].frequency == 0
    assert decays(loop([1.01], [1, -1])) and not decays(loop([0.99], [1, -1]))
    maglev = stability_margins.of_loop(loop([9, 12], [1, 3, -1, -3]))  # 3 (3 s + 4) / ((s + 3) (s + 1) (s - 1))
    assert maglev.gain_reduction_margin == pytest.approx(0.25, rel=EXACT)


def test_direct_feedthrough_crosses_at_infinity() -> None:
    loop_margins = stability_margins.of_loop(loop([-0.5, 0, 0], [1, 2, 1]))
    assert loop_margins.gain_margin == pytest.approx(2, rel=EXACT)
    assert loop_margins.phase_crossings[-1].frequency == np.inf
    with pytest.raises(ModelError, match="1 \\+ L has no inverse"):
        stability_margins.of_loop(loop([-1, 0], [1, 1]))


@pytest.mark.filterwarnings("ignore:stability_margins. Falling back:UserWarning")
@settings(derandomize=True, max_examples=20, deadline=None)
@given(st.integers(0, 10**6), st.booleans())
def test_random_loops_agree_with_python_control(seed: int, sampled: bool) -> None:
    rng = np.random.default_rng(seed)
    n = int(rng.integers(2, 5))
    poles = np.concatenate([-rng.uniform(0.2, 5, n), [0.0]])
    zeros = -rng.uniform(0.5, 8, n - 1)
    L = loop(np.poly(zeros) * rng.uniform(0.5, 30), np.poly(poles))
    L = discretise.delay_samples(discretise.zero_order_hold(L, 0.05), 1) if sampled else L
    loop_margins, witness = stability_margins.of_loop(L), control.stability_margins(L.to_control(), returnall=True)
    gm, pm, _, wpc, wgc, _ = witness
    assume(len(wgc) > 0)
    theirs = [abs(control.evalfr(L.to_control(), np.exp(0.05j * w) if sampled else 1j * w)) for w in wgc]
    assume(theirs == pytest.approx(np.ones(len(wgc)), rel=1e-4))  # its fallback for sampled loops reads a grid
    assert [c.frequency for c in loop_margins.gain_crossings] == pytest.approx(sorted(wgc), rel=1e-5)
    at = np.argsort(wgc)
    ours = [(c.phase_margin + 180) % 360 for c in loop_margins.gain_crossings]
    assert ours == pytest.approx(list((np.asarray(pm)[at] + 180) % 360), abs=1e-3)
    inner = [(f, g) for f, g in sorted(zip(wpc, gm, strict=True)) if f > 1e-3 and np.isfinite(g) and g > 0]
    mine = [c for c in loop_margins.phase_crossings if c.frequency > 1e-3]
    for f, g in inner:
        assert any(
            c.frequency == pytest.approx(f, rel=1e-4) and c.gain_margin == pytest.approx(g, rel=1e-3) for c in mine
        )
    assert loop_margins.stable == decays(L)


def test_a_sampled_loop_may_cross_at_nyquist() -> None:
    """L = 1 / (z + 0.5) at z = -1 is -2, at z = 1 is 2/3: stable below the gain 0.5 only."""
    L = loop([0.4], [1, 0.5], 0.1)
    loop_margins = stability_margins.of_loop(L)
    assert loop_margins.stable and loop_margins.phase_crossings[-1].frequency == pytest.approx(np.pi / 0.1)
    assert loop_margins.gain_margin == pytest.approx(0.5 / 0.4, rel=EXACT)
    assert decays(gain(L, 0.999 * loop_margins.gain_margin)) and not decays(gain(L, 1.001 * loop_margins.gain_margin))
    assert loop_margins.peak_sensitivity == pytest.approx(5, rel=EXACT)  # 1/|1 - 0.8|, at Nyquist itself


@settings(derandomize=True, max_examples=10, deadline=None)
@given(st.integers(0, 10**6), st.booleans())
def test_the_loop_is_marginal_at_each_of_its_margins(seed: int, sampled: bool) -> None:
    rng = np.random.default_rng(seed)
    L = loop(rng.uniform(1, 20) * np.poly(-rng.uniform(1, 9, 1)), np.poly([0, *-rng.uniform(0.5, 9, 3)]))
    L = discretise.zero_order_hold(L, 0.05) if sampled else L
    loop_margins = stability_margins.of_loop(L)
    assume(loop_margins.stable)
    if np.isfinite(loop_margins.gain_margin):
        assert decays(gain(L, loop_margins.gain_margin * (1 - 1e-4))) and not decays(
            gain(L, loop_margins.gain_margin * (1 + 1e-4))
        )
    # a rotation of L by its phase margin puts it on -1, and then S has no bound
    crossing = loop_margins.gain_crossings[0]
    value = stability_margins.response(L)(crossing.frequency)[0] * np.exp(-1j * np.radians(crossing.phase_margin))
    assert value == pytest.approx(-1, abs=1e-7)


def test_a_crossing_below_180_degrees_needs_most_of_a_turn_of_delay() -> None:
    """L = k (s + 1)^2 / s^3 is unstable for small k: its phase margin is negative, its delay margin is not."""
    L = loop(0.1 * np.poly([-1, -1]), [1, 0, 0, 0])
    loop_margins = stability_margins.of_loop(L)
    (crossing,) = loop_margins.gain_crossings
    assert not loop_margins.stable and crossing.phase_margin < 0 < crossing.delay_margin
    late = stability_margins.response(L)(crossing.frequency)[0] * np.exp(
        -1j * crossing.frequency * crossing.delay_margin
    )
    assert late == pytest.approx(-1, abs=1e-7)
    assert crossing.delay_margin == pytest.approx(np.radians(360 + crossing.phase_margin) / crossing.frequency)


@pytest.mark.parametrize("k", [0.5, 1.0, 2.0])
def test_a_sampled_loop_is_stable_up_to_its_delay_margin_in_whole_samples(k: float) -> None:
    T = 0.01
    L = discretise.zero_order_hold(loop([20 * k, 60 * k], [1, 8, 0]), T)
    samples = stability_margins.of_loop(L).delay_margin / T
    below = int(np.floor(samples))
    assert (
        below >= 3 and decays(discretise.delay_samples(L, below)) and not decays(discretise.delay_samples(L, below + 1))
    )


def test_a_continuous_loop_is_stable_up_to_its_delay_margin() -> None:
    """A Padé delay of order 8 replaces the delay."""
    L = loop([20, 60], [1, 8, 0])
    most = stability_margins.of_loop(L).delay_margin
    for factor, bears in ((0.99, True), (1.01, False)):
        late = control.tf(*control.pade(factor * most, 8)) * control.tf([20, 60], [1, 8, 0])
        assert (np.roots(np.polyadd(late.num[0][0], late.den[0][0])).real < 0).all() == bears


def test_margins_of_a_static_loop_and_of_a_zero_loop() -> None:
    still = StateSpace(np.zeros((0, 0)), np.zeros((0, 1)), np.zeros((1, 0)), [[-0.5]], (), ("u",), ("y",), Continuous())
    assert stability_margins.of_loop(still).gain_margin == 2 and stability_margins.of_loop(still).peak_sensitivity == 2
    nothing = stability_margins.of_loop(gain(loop([1], [1, 1]), 0.0))
    assert nothing.stable and nothing.peak_sensitivity == 1 and not nothing.gain_crossings


def test_a_hidden_undamped_mode_is_not_stable() -> None:
    hidden = StateSpace(np.diag([-1.0, 0.0]), [[1], [0]], [[1, 1]], [[0]], ("a", "b"), ("u",), ("y",), Continuous())
    assert not stability_margins.of_loop(hidden).stable


@settings(derandomize=True, max_examples=25, deadline=None)
@given(st.integers(0, 10**6), st.booleans())
def test_a_closed_loop_pole_lies_on_the_boundary_at_each_crossing(seed: int, sampled: bool) -> None:
    """At a gain crossing L times exp(-i phase margin), at a phase crossing L times the gain margin."""
    rng = np.random.default_rng(seed)
    resonance = [1, 2 * 10 ** rng.uniform(-4, -1), 1]
    poles = np.polymul(resonance, np.poly([*-rng.uniform(0.2, 5, 2), 0.0]))
    L = loop(rng.uniform(0.1, 3) * np.poly(-rng.uniform(0.5, 4, 2)), poles)
    L = discretise.delay_samples(discretise.zero_order_hold(L, 0.3), 2) if sampled else L
    loop_margins = stability_margins.of_loop(L)
    crossings = [(c.frequency, np.exp(-1j * np.radians(c.phase_margin))) for c in loop_margins.gain_crossings]
    crossings += [(c.frequency, c.gain_margin) for c in loop_margins.phase_crossings if 0 < c.frequency < 10]
    assert crossings
    for frequency, factor in crossings:
        assert off_boundary(L, factor, frequency) < 1e-6
    (frequency, factor), *_ = crossings
    assert off_boundary(L, factor * np.exp(0.01j), frequency) > 1e-6  # the test detects 0.01 rad


def test_an_all_pass_returns_its_worst_crossings() -> None:
    """L = (s^2 - s + 1) / (s^2 + s + 1) is -1 at 1 rad/s; at 0.999 of its gain nothing crosses."""
    L = loop([1, -1, 1], [1, 1, 1])
    loop_margins = stability_margins.of_loop(L)
    assert not loop_margins.stable and len(loop_margins.gain_crossings) <= 2
    assert loop_margins.phase_margin == pytest.approx(0, abs=1) and loop_margins.delay_margin == 0
    assert (
        stability_margins.of_loop(gain(L, 0.999)).gain_crossings == ()
        and stability_margins.of_loop(gain(L, 0.999)).stable
    )
    # (1 - z / 2) / (z - 1 / 2) with the gain 1 is -1 at Nyquist
    sampled = stability_margins.of_loop(loop([-0.5, 1], [1, -0.5], 0.1))
    assert sampled.phase_margin < 1e-3 and len(sampled.gain_crossings) <= 2


def test_a_loop_of_gain_one_at_infinity_has_no_delay_margin() -> None:
    for D, pole in ((2.0, 3.0), (1.0, 3.0), (-1.5, 1.0)):
        loop_margins = stability_margins.of_loop(loop([D, 0.5], [1, pole]))
        assert (
            loop_margins.direct == abs(D)
            and loop_margins.delay_margin == 0
            and "Delay margin 0: |L| is" in repr(loop_margins)
        )
        assert not stability_margins.of_loop(transfer.with_delay_and_hold(loop([D, 0.5], [1, pole]), 1e-3)).stable
    loop_margins = stability_margins.of_loop(loop([2, 1], [1, 3]))
    assert (
        loop_margins.stable and loop_margins.gain_crossings[0].delay_margin > 0
    )  # the crossing alone would give the wrong margin
    assert stability_margins.of_loop(loop([0.9, 1], [1, 3])).delay_margin == np.inf


def test_margins_print_in_both_units_of_frequency() -> None:
    text = repr(stability_margins.of_loop(loop([20, 60], [1, 3, 0, -1])))
    assert "Margins of a stable loop" in text and "phase margin" in text and "[Hz]" in text
    table = stability_margins.of_loop(loop([5], [1, 0])).sheet().tables[1]
    assert table.rows == (("5", "0.79577", "90", "0.31416"),)
    assert "NOT STABLE" in repr(stability_margins.of_loop(loop([2], [-1, 1])))


def test_crossings_far_below_the_fastest_pole_count_and_limits_exclude_others() -> None:
    L = control.tf([0.5e9], [1, 1e9, 0])
    assert stability_margins.of_loop(L).gain_crossings[0].frequency == pytest.approx(0.5, rel=EXACT)
    three = control.tf([20.0], np.poly([-1.0, -2.0, -3.0]))
    whole = stability_margins.of_loop(three)
    (unit,), (real,) = whole.gain_crossings, whole.phase_crossings
    above = stability_margins.of_loop(three, low=(unit.frequency + real.frequency) / 2)
    assert not above.gain_crossings and above.phase_crossings == (real,)
    below = stability_margins.of_loop(three, high=(unit.frequency + real.frequency) / 2)
    assert below.gain_crossings == (unit,) and not below.phase_crossings
    assert stability_margins.of_loop(three, high=0.9 * whole.peak_frequency).peak_sensitivity < whole.peak_sensitivity


def test_an_all_pass_that_is_minus_one_at_rest_has_no_phase_margin() -> None:
    """L = -1 / z: at w = 0 it is -1, and a delay of exactly one sample moves L at Nyquist to -1."""
    loop_margins = stability_margins.of_loop(control.tf([-1.0], [1.0, 0.0], 1.0))
    assert (
        not loop_margins.stable
        and loop_margins.phase_margin == 0
        and loop_margins.delay_margin == pytest.approx(1.0, rel=EXACT)
    )


def test_a_closed_loop_pole_at_zero_is_not_stable() -> None:
    assert not stability_margins.of_loop(control.tf([1.0, -1.0], [1.0, 1.0])).stable
