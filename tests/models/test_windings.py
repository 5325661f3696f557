"""Phase currents: sum, amplitude, the way back, and the slots' currents that they must reproduce."""

import math

import numpy as np
import pytest

from models import windings

CASES = [(1.0, 0.0, 0.3), (-2.0, 3.5, 2.0), (0.7, -0.1, -4.0), (0.0, 4.95, 100.0)]


def park(a: float, b: float, c: float, angle: float) -> np.ndarray:
    """Return i_d, i_q, rms, of three phase currents: sqrt(2)/3 of what they make along either axis."""
    axes = angle + np.array([0, -1, 1]) * 2 * math.pi / 3
    return math.sqrt(2) / 3 * np.array([np.cos(axes), -np.sin(axes)]) @ np.array([a, b, c], dtype=float)


@pytest.mark.parametrize(("d", "q", "angle"), CASES)
def test_phases_sum_to_zero_and_come_back(d: float, q: float, angle: float) -> None:
    a, b, c = windings.phase_currents(d, q, angle).values()
    assert a + b + c == pytest.approx(0, abs=1e-13)
    assert park(a, b, c, angle) == pytest.approx([d, q], abs=1e-12)
    assert park(a, c, b, angle) != pytest.approx([d, q], abs=1e-2)


@pytest.mark.parametrize(("d", "q", "angle"), CASES)
def test_amplitude_and_rms(d: float, q: float, angle: float) -> None:
    turn = angle + np.linspace(0, 2 * np.pi, 3600, endpoint=False)
    b = np.array([windings.phase_currents(d, q, th)["b"] for th in turn])
    assert np.abs(b).max() == pytest.approx(math.sqrt(2) * math.hypot(d, q), rel=1e-5)
    assert np.sqrt(np.mean(b**2)) == pytest.approx(math.hypot(d, q), rel=1e-12)


@pytest.mark.parametrize("x_m", [0.0, 0.004, -0.031])
def test_the_phases_are_the_travelling_wave_of_the_slots(x_m: float) -> None:
    # A slot at x_s carries sqrt(2) (i_d sin k(x_s - x_m) - i_q cos k(x_s - x_m)): i_d > 0 weakens a magnet at x_m, and
    # i_q > 0 pushes it along -x, as F_H = -K_h L_h i_q says. Phase b lies two slots of tau/3 after a, c four.
    tau, i_d, i_q = 0.05715, 1.2, -0.8
    k = math.pi / tau
    phases = windings.phase_currents(i_d, i_q, windings.electrical_angle(x_m, tau))
    for slot, current in zip((0, 2, 4), phases.values(), strict=True):
        at = k * (slot * tau / 3 - x_m)
        assert current == pytest.approx(math.sqrt(2) * (i_d * math.sin(at) - i_q * math.cos(at)), abs=1e-12)
