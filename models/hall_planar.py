"""Measurement model and Jacobian over (X, Y, yaw) of two-axis Hall sensors in the body's plane, with phasors.

The residual V - R(yaw)' B(P) of a sensor at P is taken in the field's axes, R(yaw) V - B(P): it has the same length
there, and its Jacobian over (X, Y, yaw) is sparse up to the sign,

    X:  [g_X, 0, h_X],  g_X = B_X'(P_X),  h_X = B_Y - g_X o_Y
    Y:  [0, g_Y, h_Y],  g_Y = B_Y'(P_Y),  h_Y = g_Y o_X - B_X

Lengths are phases in rad, with the wave number w = 2 pi / pitch; B' is the derivative by the phase; o = w R(yaw) r is
the sensor's offset from the centre. Phasors of a displaced pose are the predicted ones rotated by a small angle, and
sin(5 p) = sin(p) (5 - 20 sin(p)^2 + 16 sin(p)^4).

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

POWERS = (1, 3, 5)  # of the sine, in alpha sin p + beta sin 5p


@dataclass(frozen=True, eq=False)
class Sensor:
    """A sensor at a pose: its phases along X and Y and offset from the centre, rad, and its voltages in field axes, V.

    `field` are the constant and the coefficients of sin, sin^3 and sin^5; `slope` are those of the derivative.
    """

    phases: tuple[Phasor, Phasor]
    offset: Phasor
    volts: Phasor
    field: Sequence[ca.SX]
    slope: Sequence[ca.SX]


class Row(NamedTuple):
    """The residual e of a voltage in field axes, and g and h of its Jacobian: e = g U + h T to first order."""

    e: ca.SX
    g: ca.SX
    h: ca.SX


def constants(array: PlanarArray) -> list[Constant]:
    """Return the coefficients of the field by powers of the sine, and of its derivative by the phase."""
    values = dict(zip(POWERS, (array.alpha + 5 * array.beta, -20 * array.beta, 16 * array.beta), strict=True))
    about = "coefficient of the field alpha sin p + beta sin 5p, by powers of sin p"
    field = [Constant(f"field_{n}", v, "V", about) for n, v in values.items()]
    return [
        *field,
        *(
            Constant(
                f"slope_{n - 1}", n * v, "V", "coefficient of the field's derivative by the phase p, by powers of sin p"
            )
            for n, v in values.items()
        ),
    ]


def rotation_phasor(yaw: ca.SX, named: NamedExpressions) -> tuple[Phasor, ca.SX]:
    """Return the phasor of a small yaw, and its versine 1 - cos = 2 sin^2(yaw / 2)."""
    sine, half = ca.sin(yaw), sqrt(2) * ca.sin(yaw / 2)
    named.append((Signal("yaw_change_sine", "1", -1, 1, "sine of the change of yaw in the sample"), sine))
    named.append((Signal("half_yaw_change_sine", "1", -2, 2, "sine of half the change of yaw, times sqrt(2)"), half))
    return Phasor(1 - half**2, sine), half**2


def displace(sensors: Sequence[Sensor], displacement: Vector, named: NamedExpressions) -> list[Sensor]:
    """Return the sensors of a body displaced by (U, V, T), rad."""
    rotation, versine = rotation_phasor(displacement[2], named)
    return [_displaced(s, displacement, rotation, versine) for s in sensors]


def _displaced(s: Sensor, displacement: Vector, rotation: Phasor, versine: ca.SX) -> Sensor:
    x, y = s.offset.cosine, s.offset.sine
    dx, dy = -x * versine - y * rotation.sine, -y * versine + x * rotation.sine
    phases = s.phases[0].times(phasor.of(displacement[0] + dx)), s.phases[1].times(phasor.of(displacement[1] + dy))
    return replace(s, phases=phases, offset=Phasor(x + dx, y + dy), volts=s.volts.times(rotation))


def rows(s: Sensor) -> tuple[Row, Row]:
    """Return the voltages of a sensor along X and Y."""
    B, g = [], []
    for p in s.phases:
        q = p.sine**2
        B.append(s.field[0] + p.sine * (s.field[1] + q * (s.field[2] + q * s.field[3])))
        g.append(p.cosine * (s.slope[0] + q * (s.slope[1] + q * s.slope[2])))
    x = Row(s.volts.cosine - B[0], g[0], B[1] - g[0] * s.offset.sine)
    return x, Row(s.volts.sine - B[1], g[1], g[1] * s.offset.cosine - B[0])
