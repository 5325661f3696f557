"""Crossings that a grid misses, and crossings of traced loops."""

import control
import numpy as np
import pytest

from synth.analyse.loops import grid_crossings, stability_margins
from synth.errors import ModelError
from synth.statespace import StateSpace, from_control, of
from tests.analyse.scalar_loops import EXACT, decays, gain, loop, off_boundary


@pytest.mark.parametrize("w0", [0.37, 61.8, 4321.0])
@pytest.mark.parametrize("zeta", [1e-3, 1e-6])
def test_a_resonance_far_narrower_than_the_grid_is_found(w0: float, zeta: float) -> None:
    """An integrator of gain w0/1000 with a residue so large that the resonance reaches |L| of some 50."""
    peak = 50 * 2 * zeta
    resonance = control.tf([peak * w0**2], [1, 2 * zeta * w0, w0**2]) + control.tf([w0 / 1000], [1, 0])
    loop_margins = stability_margins.of_loop(from_control(control.ss(resonance)))
    around = [c.frequency for c in loop_margins.gain_crossings if abs(c.frequency / w0 - 1) < 0.5]
    assert len(around) == 2 and around[0] < w0 < around[1]
    assert np.abs(np.array(around) / w0 - 1) == pytest.approx(50 * zeta, rel=0.1)
    assert (
        loop_margins.stable and not loop_margins.phase_crossings
    )  # each part stays above -180 degrees, and so does their sum


def test_a_notch_far_narrower_than_the_grid_is_found() -> None:
    notch = control.tf([1, 2e-7, 1], [1, 2e-3, 1]) * control.tf([1.5], [1])
    loop_margins = stability_margins.of_loop(from_control(control.ss(notch)))
    assert len(loop_margins.gain_crossings) == 2


def test_a_peak_of_sensitivity_far_narrower_than_the_grid_is_found() -> None:
    """L passes -1 at a distance of 1e-4, where nothing in L itself is narrow."""
    L = gain(loop([1], [1, 3, 3, 1]), 8 * (1 - 1e-6))
    loop_margins = stability_margins.of_loop(L)
    w = np.sqrt(3) * (1 + np.linspace(-1e-5, 1e-5, 20001))
    brute = 1 / np.abs(1 + L.response(1j * w)[:, 0, 0]).min()
    assert brute > 1e5 and loop_margins.peak_sensitivity == pytest.approx(brute, rel=1e-4)


def test_poles_on_the_axis_are_no_crossings() -> None:
    """A resonator inside the controller: L is infinite at 3 rad/s, and its imaginary part changes sign there."""
    b, a = np.polymul([2.0, 3.0], [1, 1, 9]), np.polymul([1, 0, 0], [1, 0, 9])
    loop_margins = stability_margins.of_loop(loop(b, a))
    assert loop_margins.stable == decays(loop(b, a))
    assert all(abs(c.frequency - 3) > 1e-3 for c in loop_margins.phase_crossings)
    assert np.isfinite(loop_margins.peak_sensitivity) and loop_margins.gain_crossings
    undamped = stability_margins.of_loop(loop([1], [1, 0, 1]))
    assert not undamped.stable and undamped.gain_crossings[0].frequency == pytest.approx(np.sqrt(2), rel=EXACT)


@pytest.mark.parametrize("above", [1e-3, 1e-5, 1e-7])
def test_a_pair_of_crossings_closer_than_the_grid_is_found(above: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """A resonance whose peak is 1 + above; without the search between nodes, the planted defect, the pair is missed."""
    zeta, wn = 0.05, 10.0
    rest = (1 + above) * 2 * zeta * np.sqrt(1 - zeta**2)
    L = loop([rest * wn**2], [1, 2 * zeta * wn, wn**2])
    v = np.roots([1, 4 * zeta**2 - 2, 1 - rest**2])  # |L| = 1 at (w / wn)^2
    frequencies = [c.frequency for c in stability_margins.of_loop(L).gain_crossings]
    assert frequencies == pytest.approx(sorted(wn * np.sqrt(v.real)), rel=1e-8)
    assert stability_margins.of_loop(gain(L, (1 - above) / (1 + above))).gain_crossings == ()
    monkeypatch.setattr(stability_margins, "EXACT_STATES", 0)
    assert [c.frequency for c in stability_margins.of_loop(L).gain_crossings] == pytest.approx(frequencies, rel=1e-8)
    monkeypatch.setattr(grid_crossings, "_with_extrema_between_nodes", lambda f, w, value: (w, value))
    assert above > 1e-4 or len(stability_margins.of_loop(L).gain_crossings) == 0


def test_an_undamped_loop_is_real_at_all_frequencies() -> None:
    """L = 1 / (s^2 + 1) < 0 above 1 rad/s: for every gain a pole is on the axis; the reported margin is 1."""
    loop_margins = stability_margins.of_loop(loop([1], [1, 0, 1]))
    assert not loop_margins.stable and loop_margins.phase_margin == pytest.approx(0, abs=1e-6)
    assert [c.gain_margin for c in loop_margins.phase_crossings] == pytest.approx([1], rel=EXACT)
    double = stability_margins.of_loop(loop([1], [1, 0, 0]))
    assert [c.gain_margin for c in double.phase_crossings] == pytest.approx([1], rel=EXACT)


def test_an_undamped_resonance_is_no_crossing_of_the_negative_axis() -> None:
    """Its real residue turns L from + to - through infinity, with the same small imaginary part on both sides."""
    L = from_control(control.ss(control.tf([1e-3], [1, 0]) + control.tf([1e-6], [1, 0, 1])))
    loop_margins = stability_margins.of_loop(L)
    assert not loop_margins.phase_crossings and len(loop_margins.gain_crossings) == 3
    w = np.array([c.frequency for c in loop_margins.gain_crossings])
    assert np.abs(1e-3 / (1j * w) + 1e-6 / (1 - w**2)) == pytest.approx(1, rel=1e-6)


@pytest.mark.parametrize("below", [1e-2, 1e-4, 1e-6])
def test_a_resonance_just_below_nyquist_is_found(below: float) -> None:
    """A pole pair at pi - below with a damping of a tenth of that."""
    angle, radius = np.pi - below, 1 - below / 10
    L = loop([0.5 * below**2], [1, -2 * radius * np.cos(angle), radius**2], 1.0)
    loop_margins = stability_margins.of_loop(L)
    w = np.pi - below * np.linspace(0, 4, 200_001)
    z = np.exp(1j * w)
    size = np.abs(0.5 * below**2 / (z**2 - 2 * radius * np.cos(angle) * z + radius**2))
    assert len(loop_margins.gain_crossings) == np.count_nonzero(np.diff(size > 1)) == 2
    for c in loop_margins.gain_crossings:
        assert off_boundary(L, np.exp(-1j * np.radians(c.phase_margin)), c.frequency) < 1e-9


def test_a_traced_loop_of_many_states_agrees_with_the_polynomials(monkeypatch: pytest.MonkeyPatch) -> None:
    w, zeta = np.geomspace(0.5, 200, 15), np.linspace(0.005, 0.05, 15)
    model = modal(w, zeta)
    exact = stability_margins.of_loop(model)
    monkeypatch.setattr(stability_margins, "EXACT_STATES", 10)
    traced = stability_margins.of_loop(model)
    assert [c.frequency for c in traced.gain_crossings] == pytest.approx(
        [c.frequency for c in exact.gain_crossings], rel=1e-8
    )
    assert traced.phase_margin == pytest.approx(exact.phase_margin, rel=1e-6)
    assert traced.modulus_margin == pytest.approx(exact.modulus_margin, rel=1e-6) and traced.stable == exact.stable


def modal(w: np.ndarray, zeta: np.ndarray) -> StateSpace:
    n = 2 * len(w)
    A, even = np.zeros((n, n)), np.arange(0, n, 2)
    A[even, even + 1], A[even + 1, even], A[even + 1, even + 1] = 1.0, -(w**2), -2 * zeta * w
    B, C = np.zeros((n, 1)), np.zeros((1, n))
    B[even + 1, 0], C[0, even] = 1.0, 0.2 * w**2
    return of((A, B, C, [[0.0]]))


def test_an_omitted_traced_crossing_fails_the_verification(monkeypatch: pytest.MonkeyPatch) -> None:
    """The planted defect: only the closed-loop poles reveal it."""
    L = loop([4.0], [1, 3, 3, 1])
    monkeypatch.setattr(stability_margins, "EXACT_STATES", 0)
    assert stability_margins.of_loop(L).gain_margin == pytest.approx(2, rel=EXACT)
    monkeypatch.setattr(grid_crossings, "_real_frequencies", lambda curve, unit: [])
    with pytest.raises(ModelError, match="the gain margin fails its verification: the closed loop has 0 unstable"):
        stability_margins.of_loop(L)
    monkeypatch.undo()
    monkeypatch.setattr(stability_margins, "EXACT_STATES", 0)
    monkeypatch.setattr(grid_crossings, "_unit_gain_frequencies", lambda curve: [])
    with pytest.raises(ModelError, match="the phase margin fails its verification"):
        stability_margins.of_loop(gain(L, 1.9))


def test_many_lightly_damped_modes_are_traced_or_refused() -> None:
    """The brackets of the trace and the search inside them have different rounding errors."""
    w = np.geomspace(1, 100, 29)
    loop_margins = stability_margins.of_loop(modal_rates(w, 1e-8))
    assert loop_margins.stable and len(loop_margins.gain_crossings) % 2 == 0


def modal_rates(w: np.ndarray, zeta: float) -> StateSpace:
    model = modal(w, np.full(len(w), zeta))
    C = np.zeros_like(model.C)
    C[0, 1::2] = 1e-3
    return of((model.A, model.B, C, model.D))


def test_a_single_omitted_traced_crossing_is_detected(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(stability_margins, "EXACT_STATES", 0)
    L = loop([4.0], [1, 3, 3, 1])
    roots = grid_crossings._roots
    monkeypatch.setattr(grid_crossings, "_roots", lambda f, w, value: roots(f, w, value)[1:])
    with pytest.raises(ModelError, match=r"0 crossings of \|L\| = 1 were found, but .L. goes from 4 to"):
        stability_margins.of_loop(L)
