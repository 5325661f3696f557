"""Disk margins of loops whose peak follows by hand, at rest, at Nyquist and at infinity, and loops that are refused."""

import control
import numpy as np
import pytest

from synth.analyse.loops import disk, feedback_loop, stability_margins
from synth.statespace import StateSpace, of
from synth.timing import Discrete
from tests.analyse.disk_tolerances import DOUBLE, LEVEL


@pytest.mark.parametrize("zeta", [0.1, 0.4])
def test_a_second_order_loop_meets_its_closed_form(zeta: float) -> None:
    """L = w^2/(s (s + 2 zeta w)): max |T| = 1/(2 zeta sqrt(1 - zeta^2)) at w sqrt(1 - 2 zeta^2)."""
    w = 30.0
    loop = of(control.ss(control.tf([w * w], [1, 2 * zeta * w, 0])))
    least = 2 * zeta * np.sqrt(1 - zeta**2)
    margin = disk.of_loop(loop, skew=-1.0)
    assert margin.lower <= least <= margin.upper * (1 + DOUBLE) and margin.lower == pytest.approx(least, rel=LEVEL)
    assert margin.frequency == pytest.approx(w * np.sqrt(1 - 2 * zeta**2), rel=1e-3)  # the peak is flat
    assert (margin.gain_low, margin.gain_high) == pytest.approx((1 - least, 1 + least), rel=LEVEL)
    assert margin.phase == pytest.approx(np.degrees(2 * np.arcsin(least / 2)), rel=LEVEL)
    modulus = disk.of_loop(loop, skew=1.0)
    assert modulus.alpha == pytest.approx(stability_margins.of_loop(loop).modulus_margin, rel=LEVEL)
    assert modulus.gain_high == pytest.approx(1 / (1 - modulus.alpha), rel=DOUBLE)
    balanced = disk.of_loop(loop)
    assert balanced.gain_low * balanced.gain_high == pytest.approx(1.0, rel=DOUBLE)
    assert balanced.phase == pytest.approx(np.degrees(2 * np.arctan(balanced.alpha / 2)), rel=DOUBLE)


def test_an_integrator_keeps_every_gain_and_90_degrees() -> None:
    """|S - 1/2| = 1/2 at all frequencies: alpha = 2, f is the right half-plane; T and S alone give less."""
    loop = of(([[0.0]], [[1.0]], [[5.0]], [[0.0]]))
    margin = disk.of_loop(loop)
    assert margin.alpha == pytest.approx(2.0, rel=LEVEL) and margin.gain_low == pytest.approx(0.0, abs=LEVEL)
    assert margin.phase == pytest.approx(90.0, rel=LEVEL) and margin.gain_high > 1e5
    assert disk.of_loop(loop, 1.0).alpha == pytest.approx(1.0, rel=LEVEL)
    assert disk.of_loop(loop, -1.0).alpha == pytest.approx(1.0, rel=LEVEL)


def satellite() -> tuple[StateSpace, StateSpace]:
    """Return the spinning satellite (Doyle 1986) with a = 10 and the controller u = -y."""
    a = 10.0
    plant = of(([[0, a], [-a, 0]], np.eye(2), [[1, a], [-a, 1]], np.zeros((2, 2))))
    return plant, of((np.zeros((0, 0)), np.zeros((0, 2)), np.zeros((2, 0)), np.eye(2)))


def test_the_spinning_satellite_is_robust_in_each_channel_and_fragile_in_both() -> None:
    """Each channel alone has L = 1/s; with both, 1 -+ d in the gains destabilises for d > 1/sqrt(101) at w = 0."""
    loop = feedback_loop.close(*satellite()).Li
    for alone in disk.loop_at_a_time(loop).values():
        assert alone.alpha == pytest.approx(2.0, rel=LEVEL)
    margin = disk.of_loop(loop, skew=-1.0)
    assert margin.alpha == pytest.approx(1 / np.sqrt(101), rel=LEVEL)
    balanced = disk.of_loop(loop)
    assert balanced.alpha == pytest.approx(0.09975124, rel=LEVEL)  # python-control's figure on a fine grid
    assert (balanced.gain_low, balanced.gain_high, balanced.phase) == pytest.approx((0.905, 1.105, 5.71), abs=5e-3)
    both = disk.of_loop(feedback_loop.close(*satellite()).both)
    assert both.channels == ("u1", "u2", "y1", "y2") and both.alpha == pytest.approx(balanced.alpha / 2, rel=2e-3)


def test_static_loops() -> None:
    """L = diag(3, 1): S - 1/2 = diag(-1/4, 0), so f_1 = -1/3 destabilises; L = 1: only f = -1 does."""
    empty = np.zeros((0, 0)), np.zeros((0, 2)), np.zeros((2, 0))
    margin = disk.of_loop((*empty, np.diag([3.0, 1.0])))
    assert margin.certified and margin.alpha == pytest.approx(4.0, rel=LEVEL)
    assert margin.factors[0] == pytest.approx(-1 / 3, rel=1e-6)
    unit = disk.of_loop((*empty, np.eye(2)))
    assert unit.alpha == np.inf and unit.gain_low == -1 and unit.gain_high == np.inf and unit.phase == 180
    L = np.array([[1.0, 8.0], [0.3, 1.0]])
    M = np.linalg.inv(np.eye(2) + L) - np.eye(2) / 2
    turns = np.exp(1j * np.linspace(0, 2 * np.pi, 3601))
    mu = max(np.abs(np.linalg.eigvals(M * np.array([1.0, turn]))).max() for turn in turns)
    assert disk.of_loop((*empty, L, Discrete(1e-3))).alpha == pytest.approx(1 / mu, rel=1e-5)


def test_the_peak_may_lie_at_zero_at_nyquist_or_at_infinity() -> None:
    """T = 4/(s + 3) is largest at 0; 1/(z + 0.5) closes to a pole at z = -0.9; L = -0.5 s/(s + 1) at infinity."""
    slow = disk.of_loop(control.ss(control.tf([4], [1, -1])), -1.0)
    assert slow.frequency == 0 and slow.alpha == pytest.approx(0.75, rel=LEVEL)
    assert slow.factors == pytest.approx([0.25], rel=LEVEL)
    fast = disk.of_loop(control.ss(control.tf([0.4], [1, 0.5], 0.1)), -1.0)
    assert fast.frequency == pytest.approx(np.pi / 0.1) and fast.alpha == pytest.approx(0.1 / 0.4, rel=LEVEL)
    assert fast.factors == pytest.approx([1.25], rel=LEVEL)
    direct = disk.of_loop(control.ss(control.tf([-0.5, 0], [1, 1])), -1.0)
    assert direct.frequency == np.inf and direct.alpha == pytest.approx(1.0, rel=LEVEL)
    assert direct.factors == pytest.approx([2.0], rel=LEVEL)
    assert [m.certified for m in (slow, fast, direct)] == [True] * 3


@pytest.mark.parametrize("pole", [-0.99999, 0.99999])
def test_a_sampled_pole_near_minus_one_or_one_costs_no_accuracy(pole: float) -> None:
    """L = g/(z - p), T = g/(z - p + g): |T| is largest at z = -1 or 1, where it is g/(1 - |p - g|)."""
    gain = -0.5 * (1 - abs(pole)) * np.sign(pole)
    margin = disk.of_loop(([[pole]], [[1.0]], [[gain]], [[0.0]], Discrete(1e-3)), -1.0)
    assert margin.alpha == pytest.approx((1 - abs(pole - gain)) / abs(gain), rel=LEVEL)


def test_a_disk_margin_prints_its_certificate() -> None:
    margin = disk.of_loop(feedback_loop.close(*satellite()).Li)
    text = repr(margin)
    assert "Disk margin of 2 channels in continuous time: 0.09975" in text and "proved for all frequencies" in text
    assert "0.90499 to 1.105" in text and "5.7106 deg" in text and "\nu1 " in text and "|f|" in text
    assert "not proved between" in repr(disk.of_loop(feedback_loop.close(*satellite()).Li, certify=False))
    assert list(margin.worst.items()) == [("u1", margin.delta[0]), ("u2", margin.delta[1])]
    with pytest.raises(ValueError, match="read-only"):
        margin.curve[0] = 1.0
