"""One sensor in six degrees of freedom: what it should read at a pose, its two rows of the Jacobian, and their sums.

In units of phase, so that the gradient of B is that of `six_field` over w and places are o = w R r. With rows p of the
gradient turned into the body's axes, p_i = R' grad B R_i, b = R' B and a sensor at (x, y, z) rad in the body,

    u:  p_1 by phases,  t = (y p_13 - z p_12,  z p_11 - x p_13 - b_3,  x p_12 - y p_11 + b_2)    by turns in the body
    v:  p_2 by phases,  t = (y p_23 - z p_22 + b_3,  z p_12 - x p_23,  x p_22 - y p_12 - b_1)

    by roll t_1,  by pitch cos(roll) t_2 - sin(roll) t_3,  by yaw -sin(pitch) t_1 + cos(pitch) (sin(roll) t_2 + ..)
"""

from dataclasses import dataclass

import casadi as ca

from designs.hall_position.glsdc.correction import Wave
from synth.synthesise.normal_equations import dot, total

Vector = tuple[ca.SX, ca.SX, ca.SX]


@dataclass(frozen=True, eq=False)
class Attitude:
    """Waves of roll and pitch, and the body's axes in the field's."""

    roll: Wave
    pitch: Wave
    axes: tuple[Vector, Vector, Vector]


@dataclass(frozen=True, eq=False)
class Sensor:
    """Where a sensor is in the body, rad, its voltages, and the field's alpha and beta that it sees, V."""

    arm: tuple[float, float, float]
    volts: tuple[ca.SX, ca.SX]
    alpha: ca.SX
    beta: ca.SX


@dataclass(frozen=True, eq=False)
class Waves:
    """Fundamental and 5th wave along an axis, times their decay: sines and cosines."""

    first: Wave
    fifth: Wave


def attitude(yaw: Wave, roll: Wave, pitch: Wave) -> Attitude:
    """Return R_z(yaw) R_y(pitch) R_x(roll)."""
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
    return Attitude(roll, pitch, (x, y, z))


def place(of: Sensor, body: Attitude) -> Vector:
    """Return where a sensor is about the body's origin, rad."""
    at = [total(r * e[i] for r, e in zip(of.arm, body.axes, strict=True) if r) for i in range(3)]
    return at[0], at[1], at[2]


def waves(of: Wave, decay: ca.SX) -> Waves:
    """Return the waves along an axis, of a phase; the fifth power of decay (cosine + i sine) is the 5th wave."""
    s, c = decay * of.sine, decay * of.cosine
    p, q = s**2, c**2
    both = 10 * p * q
    return Waves(Wave(s, c), Wave(s * (p**2 - both + 5 * q**2), c * (q**2 - both + 5 * p**2)))


def flux(of: Sensor, x: Waves, y: Waves) -> Vector:
    """Return B, V."""
    along = [of.alpha * axis.first.sine + of.beta * axis.fifth.sine for axis in (x, y)]
    up = of.alpha * (x.first.cosine + y.first.cosine) + of.beta * (x.fifth.cosine + y.fifth.cosine)
    return along[0], along[1], up


def residuals(of: Sensor, B: Vector, body: Attitude) -> tuple[ca.SX, ca.SX]:
    """Return what u and v read beyond what they should, V."""
    u, v = (volts - dot(e, B) for volts, e in zip(of.volts, body.axes[:2], strict=True))
    return u, v


def rows(of: Sensor, x: Waves, y: Waves, body: Attitude) -> tuple[tuple[ca.SX, ...], tuple[ca.SX, ...]]:
    """Return the Jacobian's rows of u and v, (6,) each, V by rad."""
    B, fifth = flux(of, x, y), 5 * of.beta
    f, g = ([of.alpha * w1 + fifth * w5 for w1, w5 in each] for each in _pairs(x, y))
    first, second, _ = body.axes
    p, r = (
        (g[0] * e[0] - f[0] * e[2], g[1] * e[1] - f[1] * e[2], -f[0] * e[0] - f[1] * e[1] - (g[0] + g[1]) * e[2])
        for e in (first, second)
    )
    p11, p12, p13 = (dot(p, e) for e in body.axes)
    p22, p23 = (dot(r, e) for e in body.axes[1:])
    b, (a, d, h) = [dot(B, e) for e in body.axes], of.arm
    turn_u = d * p13 - h * p12, h * p11 - a * p13 - b[2], a * p12 - d * p11 + b[1]
    turn_v = d * p23 - h * p22 + b[2], h * p12 - a * p23, a * p22 - d * p12 - b[0]
    return (*p, *_angles(turn_u, body)), (*r, *_angles(turn_v, body))


def _pairs(x: Waves, y: Waves) -> tuple[list[tuple[ca.SX, ca.SX]], list[tuple[ca.SX, ca.SX]]]:
    """Return sines and cosines of the fundamental and the 5th along X and Y."""
    axes = (x, y)
    return [(a.first.sine, a.fifth.sine) for a in axes], [(a.first.cosine, a.fifth.cosine) for a in axes]


def _angles(t: Vector, body: Attitude) -> Vector:
    """Return by roll, pitch and yaw what is `t` by turns about the body's axes."""
    roll = body.roll
    return t[0], roll.cosine * t[1] - roll.sine * t[2], total(e[2] * each for e, each in zip(body.axes, t, strict=True))
