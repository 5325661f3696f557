"""Models of plane vectors that a turned body measures, and how the phasor of its angle moves."""

from math import pi

import casadi as ca
import numpy as np

from synth.blocks.estimate import glsdc_jacobian, phasor
from synth.blocks.estimate.glsdc_model import Implicit, RotatedMeasurement, Unknown
from synth.signals import Signal
from synth.statespace import Array


def rotated_model(h: RotatedMeasurement | Implicit) -> glsdc_jacobian.Model:
    channels = [Signal(n, "V", -5, 5) for n in ("V_x", "V_y")]
    unknowns = [Unknown(Signal(n, "rad", -pi, pi), 1.0, 0.5, periodic=True, prior=1.0) for n in ("x", "yaw")]
    return glsdc_jacobian.model(h, np.eye(2), channels, (), unknowns, (), ())


ROTATED = RotatedMeasurement(lambda q, k: {"V_x": 2 * q["sin_x"], "V_y": 3 * q["cos_x"]}, "yaw", [("V_x", "V_y")])


def jacobian_error(of: glsdc_jacobian.Model, volts: Array) -> float:
    """Return the largest difference of H from that of y - R'f by differences, in fixed axes, at any residual."""
    x, yaw, change = 0.4, 0.7, 1e-6

    def h(q: Array) -> Array:
        c, s = np.cos(q[1]), np.sin(q[1])
        return np.array([[c, s], [-s, c]]) @ [2 * np.sin(q[0]), 3 * np.cos(q[0])]

    q = np.array([x, yaw])
    slopes = np.column_stack([(h(q + d) - h(q - d)) / (2 * change) for d in change * np.eye(2)])
    c, s = np.cos(yaw), np.sin(yaw)
    e, H, _ = of.function(q, np.cos(q), np.sin(q), [], [], [], volts)
    assert np.allclose(np.asarray(e).ravel(), np.array([[c, -s], [s, c]]) @ (volts - h(q)))
    return float(np.abs(np.array([[c, -s], [s, c]]) @ slopes - np.asarray(H)).max())


def test_the_jacobian_of_a_turned_body_is_that_of_its_measurements() -> None:
    """Far from a solution the derivative of the turned residual is another one."""
    assert jacobian_error(rotated_model(ROTATED), np.array([1.0, -2.0])) < 1e-8
    assert jacobian_error(rotated_model(Implicit(ROTATED.residual)), np.array([1.0, -2.0])) > 0.5


def test_a_phasor_moves_without_a_difference_of_cosines() -> None:
    """In single precision a cosine near 1 has no digits of its small changes left."""
    start, by = phasor.Phasor(ca.SX(1), ca.SX(0)), ca.SX.sym("by")
    unknown = Unknown(Signal("yaw", "rad", -pi, pi), 1.0, 0.5, periodic=True)
    chord = glsdc_jacobian._chord(start, unknown, by, by)
    for b in (1e-9, 1e-4, 0.1):
        exact = -2 * np.sin(b / 2) ** 2, np.sin(b)
        computed = [float(ca.Function("f", [by], [v])(b)) for v in (chord.cosine, chord.sine)]
        assert np.allclose(computed, exact, rtol=1e-14, atol=0)
    assert np.cos(1e-9) - 1 == 0
