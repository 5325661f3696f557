"""Designs whose sampled loops are taken apart again: python-control, eigenvalues, a half-sample forgotten."""

import control
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from synth.analyse import loop, stability_margins
from synth.errors import ModelError, SignalError, TimingError
from synth.statespace import StateSpace
from synth.synthesise.classical import crossover, lead_lag
from synth.timing import Continuous
from tests import tolerances

T, W = 1e-3, 2 * np.pi * 25
EXACT = tolerances.of("frequency")


def stage(stiffness: float = 0.0) -> StateSpace:
    names = (("q", "v"), ("f",), ("q",), Continuous(), {"q": "m", "v": "m/s", "f": "N"})
    return StateSpace([[0, 1], [-stiffness / 1.52, 0]], [[0], [1 / 1.52]], [[1, 0]], [[0]], *names)


@pytest.mark.parametrize("method", [lead_lag.tustin, lead_lag.prewarped, lead_lag.matched, lead_lag.zero_order_hold])
@pytest.mark.parametrize("delay", [0.0, 0.7e-3, 1e-3, 2.4e-3])
@pytest.mark.filterwarnings("ignore:stability_margins. Falling back:UserWarning")
def test_the_sampled_loop_has_the_crossover_and_the_margin_asked_for(method: lead_lag.Method, delay: float) -> None:
    design = crossover.design(stage(), W, 30.0, T, delay, W / 15, method=method)
    last = design.margins.gain_crossings[-1]
    assert last.frequency == pytest.approx(W, rel=EXACT) and last.phase_margin == pytest.approx(30, rel=EXACT)
    assert design.margins.stable and design.closed.stable
    assert sum(abs(p - 1) < 1e-12 for p in design.compensator.poles) == 1
    # python-control on the product of what was found and a plant resampled, delayed by whole samples
    if delay in (0.0, 1e-3):
        P = control.sample_system(stage().to_control(), T, "zoh") * control.tf([1], [1] + [0] * round(delay / T), T)
        _, pm, _, wcp = control.margin(P * control.tf(control.ss(design.compensator.discrete.to_control())))
        assert (wcp, pm) == pytest.approx((W, 30.0), rel=1e-4)


@settings(derandomize=True, max_examples=15, deadline=None)
@given(st.floats(5, 60), st.floats(20, 60), st.floats(0, 2e-3), st.sampled_from([-2e3, 0.0, 2e3]))
def test_the_value_of_the_loop_at_the_crossover_is_what_was_asked(
    hertz: float, degrees: float, delay: float, stiffness: float
) -> None:
    w = 2 * np.pi * hertz
    try:
        design = crossover.design(stage(stiffness), w, degrees, T, delay, sections=2)
    except ModelError as error:
        assert any(reason in str(error) for reason in ("not stable", "alternates", "degrees of lead"))
        return
    z = np.exp(1j * w * T)
    value = (loop.sampled(stage(stiffness), T, delay).response(z) @ design.compensator.discrete.response(z))[0, 0, 0]
    assert value == pytest.approx(np.exp(1j * np.radians(degrees - 180)), abs=1e-9)
    assert np.abs(design.closed.poles).max() < 1


def test_a_half_sample_forgotten_would_be_seen() -> None:
    """The planted defect: the same compensator on a plant that is late by half a sample more."""
    design = crossover.design(stage(), W, 35.0, T, 0.5e-3)
    late = loop.sampled(stage(), T, 1e-3)
    z = np.exp(1j * W * T)
    value = (late.response(z) @ design.compensator.discrete.response(z))[0, 0, 0]
    assert np.degrees(np.angle(-value)) == pytest.approx(35 - np.degrees(W * T / 2), rel=1e-6)
    assert design.margins.phase_margin == pytest.approx(35.0, rel=EXACT)


def test_the_lead_is_the_closed_form_for_a_double_integrator() -> None:
    """margin + what the hold takes (w T / 2) + the delay (w tau) + integral action (atan(wi / w))."""
    design = crossover.design(stage(), W, 30.0, T, 0.8e-3, W / 10)
    needed = 30 + np.degrees(W * T / 2 + W * 0.8e-3 + np.arctan(0.1))
    assert design.lead == pytest.approx(needed, abs=0.2)  # the prewarped integrator lags by a little less
    root = np.tan(np.radians(45 + design.lead / 2))
    assert design.compensator.continuous.zeros == pytest.approx((-W / root, -W / 10))
    assert design.compensator.continuous.poles == pytest.approx((-W * root, 0.0))
    two = crossover.design(stage(), W, 60.0, T, 2e-3, W / 10, sections=2)
    assert len(two.compensator.poles) == 3 and two.lead < crossover.MAX_LEAD


def test_a_plant_with_phase_to_spare_gets_a_lag() -> None:
    lag = crossover.design(([[-1.0]], [[1.0]], [[1.0]], [[0.0]]), W, 60.0, T)
    assert lag.lead < 0 and lag.margins.phase_margin == pytest.approx(60.0, rel=EXACT)


def test_more_lead_than_is_sound_is_refused_with_the_mend() -> None:
    with pytest.raises(ModelError, match=r"60 degrees at 314.159 rad/s needs 105 degrees of lead, but 1 section of at"):
        crossover.design(stage(), 2 * W, 60.0, T, 2e-3)
    with pytest.raises(ModelError, match=r"give -65 to 65; hold and delay take 45: use two sections, lower the cross"):
        crossover.design(stage(), 2 * W, 60.0, T, 2e-3)
    assert crossover.design(stage(), 2 * W, 60.0, T, 2e-3, sections=2).lead == pytest.approx(52.5)
    with pytest.raises(ModelError, match=r"but 2 sections .* -130 to 130; .*: lower the crossover, shorten the delay"):
        crossover.design(stage(), 2 * W, 60.0, T, 4e-3, sections=2)
    reversed_sign = StateSpace(stage().A, -stage().B, stage().C, stage().D, ("q", "v"), ("f",), ("q",), Continuous())
    with pytest.raises(ModelError, match="change the sign of the plant"):
        crossover.design(reversed_sign, W, 40.0, T)


def test_a_margin_alone_is_not_enough() -> None:
    """A resonance beyond the crossover comes through |L| = 1 again."""
    modal = control.tf([1], [1.52, 0, 0]) + control.tf([-0.6], [1, 2, 500.0**2])
    with pytest.raises(ModelError, match=r"crosses 157.08 rad/s with 35 degrees but is not stable: .*filter the loop"):
        crossover.design(modal, W, 35.0, T)
    with pytest.raises(ModelError, match=r"becomes z = -0\..*alternates from sample to sample: use a shorter period"):
        crossover.design(stage(), 6 * W, 60.0, T, 0.5e-3, sections=2)


def test_what_cannot_be_designed_is_refused() -> None:
    two = (np.eye(2), np.eye(2), np.eye(2), np.zeros((2, 2)))
    with pytest.raises(SignalError, match="open it at one signal"):
        crossover.design(two, W, 40.0, T)
    for corner in (0.0, W, -1.0):
        with pytest.raises(SignalError, match="above 0 and below the crossover"):
            crossover.design(stage(), W, 40.0, T, integral_corner=corner)
    with pytest.raises(SignalError, match="3 sections were asked for"):
        crossover.design(stage(), W, 40.0, T, sections=3)
    for margin in (0.0, 180.0, np.nan):
        with pytest.raises(SignalError, match="a margin between 0 and 180"):
            crossover.design(stage(), W, margin, T)
    for beyond in (4000.0, 0.0, -W, np.nan):
        with pytest.raises(TimingError, match="not between 0 and Nyquist"):
            crossover.design(stage(), beyond, 40.0, T)
    with pytest.raises(ModelError, match="the sampled plant has a zero at"):
        crossover.design(([[-1.0]], [[1.0]], [[0.0]], [[0.0]]), W, 40.0, T)
    with pytest.raises(TimingError, match="give the continuous model"):
        crossover.design(loop.sampled(stage(), T), W, 40.0, T)
    with pytest.raises(TimingError, match=r"the delay is -0.001 s"):
        crossover.design(stage(), W, 40.0, T, -1e-3)


def test_a_design_prints_what_was_asked_and_what_came() -> None:
    text = repr(crossover.design(stage(), W, 40.0, T, 0.7e-3))
    for part in (
        "asked: crossover 157.08 rad/s (25 Hz)",
        "prewarped tustin, q_error [m] to f_command [N]",
        "delay margin",
    ):
        assert part in text
    assert stability_margins.of_loop(control.tf([1], [1, 0])).stable
