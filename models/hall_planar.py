"""Measurement model of two-axis Hall sensors in the plane, and its Jacobian over (X, Y, yaw), evaluated with phasors.

A sensor at the phases P = (P_X, P_Y) measures V = R(yaw)' B(P) with, by axis, B_X = c + alpha sin P_X + beta sin 5 P_X
and B_Y likewise (`models.hall_two_waves`). All lengths are phases in rad, that is, lengths times the wave number
w = 2 pi / pitch. The residual is expressed in the field's axes,

    e = R(yaw) V - B(P),

where it has the same norm as V - R(yaw)' B(P). For a displacement (U, V, T) of X, Y and yaw the linearised condition of
zero residual is sparse, because B_X does not depend on P_Y nor B_Y on P_X:

    e_X = g_X U + h_X T,    g_X = dB_X / dP_X,    h_X = B_Y - g_X o_Y
    e_Y = g_Y V + h_Y T,    g_Y = dB_Y / dP_Y,    h_Y = g_Y o_X - B_X

where o = R(yaw) r is the sensor's offset from the centre of the sensors, r at yaw 0. In h the field itself stems from
the rotation of the voltages, and the term with o from the displacement of the sensor by the rotation.

Sine and cosine of every phase are a phasor. For a displaced pose the phasors of the predicted pose are rotated by small
angles, which needs no sine of a large angle; and sin 5 p = sin p (5 - 20 sin^2 p + 16 sin^4 p), so B is a polynomial in
sin p.

Source: Kawato, Kim, "A Novel Multi-DOF Precision Positioning Methodology Using Two-Axis Hall-Effect Sensors", section
3.B.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import sqrt
from typing import NamedTuple

import casadi as ca

from models.hall_two_waves import PlanarArray
from synth.block import Constant
from synth.blocks import phasor
from synth.blocks.glsdc import NamedExpressions, Vector
from synth.blocks.phasor import Phasor
from synth.signals import Signal

POWERS = (1, 3, 5)  # powers of sin p in alpha sin p + beta sin 5p


@dataclass(frozen=True, eq=False)
class Sensor:
    """A sensor at a pose: its phases along X and Y and its offset o in rad, and its voltages in the field's axes in V.

    `field` holds c and the coefficients of sin p, sin^3 p and sin^5 p in B; `slope` holds those
    of 1, sin^2 p and sin^4 p in g / cos p. The names of fields and locals of this module are printed into the C.
    """

    phases: tuple[Phasor, Phasor]
    offset: Phasor
    volts: Phasor
    field: Sequence[ca.SX]
    slope: Sequence[ca.SX]


class Row(NamedTuple):
    """The residual e of a voltage in the field's axes, and the entries g and h of its row of the Jacobian."""

    e: ca.SX
    g: ca.SX
    h: ca.SX


def field_constants(array: PlanarArray) -> list[Constant]:
    """Return the coefficients of B and of its derivative, by powers of the sine, as constants of a Block; c is none."""
    coefficients = (array.alpha + 5 * array.beta, -20 * array.beta, 16 * array.beta)
    values = dict(zip(POWERS, coefficients, strict=True))
    field = "coefficient of the field alpha sin p + beta sin 5p, by powers of sin p"
    slope = "coefficient of the field's derivative by the phase p, by powers of sin p"
    return [
        *(Constant(f"field_{n}", v, "V", field) for n, v in values.items()),
        *(Constant(f"slope_{n - 1}", n * v, "V", slope) for n, v in values.items()),
    ]


def rotation_phasor(yaw: ca.SX, named: NamedExpressions) -> tuple[Phasor, ca.SX]:
    """Return the phasor of a small yaw, and its versine 1 - cos yaw = 2 sin^2(yaw / 2).

    Appends the sines to the named expressions of the step.
    """
    sine, half = ca.sin(yaw), sqrt(2) * ca.sin(yaw / 2)
    named.append((Signal("yaw_change_sine", "1", -1, 1, "sine of the change of yaw in the sample"), sine))
    named.append((Signal("half_yaw_change_sine", "1", -2, 2, "sine of half the change of yaw, times sqrt(2)"), half))
    return Phasor(1 - half**2, sine), half**2


def displace(sensors: Sequence[Sensor], displacement: Vector, named: NamedExpressions) -> list[Sensor]:
    """Return the sensors of a body displaced by (U, V, T), rad; the sines go to the named expressions of the step."""
    rotation, versine = rotation_phasor(displacement[2], named)
    return [_displaced(s, displacement, rotation, versine) for s in sensors]


def _displaced(s: Sensor, displacement: Vector, rotation: Phasor, versine: ca.SX) -> Sensor:
    x, y = s.offset.cosine, s.offset.sine
    dx, dy = -x * versine - y * rotation.sine, -y * versine + x * rotation.sine
    phases = s.phases[0].times(phasor.of(displacement[0] + dx)), s.phases[1].times(phasor.of(displacement[1] + dy))
    return replace(s, phases=phases, offset=Phasor(x + dx, y + dy), volts=s.volts.times(rotation))


def residual_rows(s: Sensor) -> tuple[Row, Row]:
    """Return the residuals of a sensor along X and Y, each with its row of the Jacobian."""
    B, g = [], []
    for p in s.phases:
        q = p.sine**2
        B.append(s.field[0] + p.sine * (s.field[1] + q * (s.field[2] + q * s.field[3])))
        g.append(p.cosine * (s.slope[0] + q * (s.slope[1] + q * s.slope[2])))
    x = Row(s.volts.cosine - B[0], g[0], B[1] - g[0] * s.offset.sine)
    return x, Row(s.volts.sine - B[1], g[1], g[1] * s.offset.cosine - B[0])
