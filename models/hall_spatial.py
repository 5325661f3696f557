"""Measurement model and Jacobian in six degrees of freedom of two-axis Hall sensors in a body, with phasors.

    V_k = [u v]' B(P_k),   P_k = (X, Y, Z) + R r_k,    q = (phase_x, phase_y, rise, roll, pitch, yaw) in rad

Lengths are in units of phase: the gradient of B is that of `hall_two_waves` over w, and places are o = w R r. With rows
p of the gradient in the body's axes, p_i = R' grad B R_i, b = R' B and a sensor at (x, y, z) rad in the body,

    u:  p_1 by phases,  t = (y p_13 - z p_12,  z p_11 - x p_13 - b_3,  x p_12 - y p_11 + b_2)    by turns in the body
    v:  p_2 by phases,  t = (y p_23 - z p_22 + b_3,  z p_12 - x p_23,  x p_22 - y p_12 - b_1)

    by roll t_1,  by pitch cos(roll) t_2 - sin(roll) t_3,  by yaw -sin(pitch) t_1 + cos(pitch) (sin(roll) t_2 + ..)
"""

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca

from synth.blocks import phasor
from synth.blocks.glsdc import Vector, dot, total
from synth.blocks.phasor import Phasor

Waves = tuple[Phasor, Phasor]  # fundamental and 5th wave along an axis, times their decay


@dataclass(frozen=True, eq=False)
class Attitude:
    """Roll as a phasor, and the body's axes in the field's."""

    roll: Phasor
    axes: tuple[Vector, Vector, Vector]


@dataclass(frozen=True, eq=False)
class Sensor:
    """Position of a sensor in the body, rad, its voltages, and alpha and beta of the field, V."""

    arm: tuple[float, float, float]
    volts: tuple[ca.SX, ca.SX]
    alpha: ca.SX
    beta: ca.SX


@dataclass(frozen=True, eq=False)
class Observed:
    """A sensor with the waves along X and Y at its position."""

    sensor: Sensor
    x: Waves
    y: Waves


def attitude(yaw: Phasor, by_x: ca.SX, by_y: ca.SX) -> Attitude:
    """Return R_z(yaw) R_y(pitch) R_x(roll)."""
    roll, pitch = phasor.of(by_x), phasor.of(by_y)
    across = pitch.sine * roll.sine, pitch.sine * roll.cosine
    x = yaw.cosine * pitch.cosine, yaw.sine * pitch.cosine, -pitch.sine
    y = (
        yaw.cosine * across[0] - yaw.sine * roll.cosine,
        yaw.sine * across[0] + yaw.cosine * roll.cosine,
        pitch.cosine * roll.sine,
    )
    z = (
        yaw.cosine * across[1] + yaw.sine * roll.sine,
        yaw.sine * across[1] - yaw.cosine * roll.sine,
        pitch.cosine * roll.cosine,
    )
    return Attitude(roll, (x, y, z))


def place(sensor: Sensor, body: Attitude) -> Vector:
    """Return the position of a sensor from the body's origin, rad."""
    return [total(r * e[i] for r, e in zip(sensor.arm, body.axes, strict=True) if r) for i in range(3)]


def observe(sensor: Sensor, place: Vector, phases: Sequence[Phasor], rise: ca.SX) -> Observed:
    """Return a sensor at a place about the body's origin and at phases along X and Y, the body raised, all in rad."""
    decay = ca.exp(-(rise + place[2]))
    x, y = (_waves(p, decay) for p in phases)
    return Observed(sensor, x, y)


def _waves(phasor: Phasor, decay: ca.SX) -> Waves:
    """Return the waves along an axis; the fifth power of decay (cosine + i sine) is the 5th wave."""
    s, c = decay * phasor.sine, decay * phasor.cosine
    p, q = s**2, c**2
    both = 10 * p * q
    return Phasor(c, s), Phasor(c * (q**2 - both + 5 * p**2), s * (p**2 - both + 5 * q**2))


def _flux(observed: Observed) -> Vector:
    """Return B, V."""
    sensor, x, y = observed.sensor, observed.x, observed.y
    along = [sensor.alpha * first.sine + sensor.beta * fifth.sine for first, fifth in (x, y)]
    up = sensor.alpha * (x[0].cosine + y[0].cosine) + sensor.beta * (x[1].cosine + y[1].cosine)
    return *along, up


def residuals(observed: Observed, body: Attitude) -> list[ca.SX]:
    """Return the residuals of u and v, V."""
    B = _flux(observed)
    return [volts - dot(e, B) for volts, e in zip(observed.sensor.volts, body.axes[:2], strict=True)]


def rows(observed: Observed, body: Attitude) -> tuple[Vector, Vector]:
    """Return the Jacobian's rows of u and v, (6,) each, V by rad."""
    sensor, B, fifth = observed.sensor, _flux(observed), 5 * observed.sensor.beta
    f = [sensor.alpha * w[0].sine + fifth * w[1].sine for w in (observed.x, observed.y)]
    g = [sensor.alpha * w[0].cosine + fifth * w[1].cosine for w in (observed.x, observed.y)]
    first, second, _ = body.axes
    p, r = (
        (g[0] * e[0] - f[0] * e[2], g[1] * e[1] - f[1] * e[2], -f[0] * e[0] - f[1] * e[1] - (g[0] + g[1]) * e[2])
        for e in (first, second)
    )
    p11, p12, p13 = (dot(p, e) for e in body.axes)
    p22, p23 = (dot(r, e) for e in body.axes[1:])
    b, (a, d, h) = [dot(B, e) for e in body.axes], sensor.arm
    turn_u = d * p13 - h * p12, h * p11 - a * p13 - b[2], a * p12 - d * p11 + b[1]
    turn_v = d * p23 - h * p22 + b[2], h * p12 - a * p23, a * p22 - d * p12 - b[0]
    return (*p, *_angles(turn_u, body)), (*r, *_angles(turn_v, body))


def _angles(t: Vector, body: Attitude) -> Vector:
    """Return the derivatives by roll, pitch and yaw, from those `t` by rotations about the body's axes."""
    roll = body.roll
    return t[0], roll.cosine * t[1] - roll.sine * t[2], total(e[2] * each for e, each in zip(body.axes, t, strict=True))
