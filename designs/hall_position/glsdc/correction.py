"""One differential correction of (X, Y, yaw): what sensors should read at a displacement, and the step from there.

    minimise  J(d) = sum over sensors k |R(yaw) V_k - B(P_k)|^2 + lambda (U^2 + V^2 + radius^2 T^2),   d = (U, V, T)

for the displacement d from the last sample's estimate: U, V phases of the centre in rad, T the yaw. R(yaw) V - B is as
long as V - R(yaw)' B, which is what the sensor reads less what it should. In the field's axes the Jacobian is sparse,

    X:  [g_X, 0, h_X],  g_X = B_X'(P_X),  h_X = B_Y - g_X o_Y      o = w R(yaw) r: the sensor's place about the centre
    Y:  [0, g_Y, h_Y],  g_Y = B_Y'(P_Y),  h_Y = g_Y o_X - B_X      in rad of phase, B' by the phase

so that U and V are eliminated one by one. With N_X = lambda + sum g_X^2 what is left for the yaw is, by Lagrange's
identity, a sum of squares: no difference of large numbers, and never less than lambda radius^2, the radius being the
sensors' mean arm times how much more firmly the yaw is held:

    N_T = lambda radius^2 + sum over X, Y of [sum over pairs (g_i h_j - g_j h_i)^2 + lambda sum h^2] / N

A phase is the base's turned by a small angle; sin(5 p) = sin(p) (5 - 20 sin(p)^2 + 16 sin(p)^4).

Source: Kawato, Kim, "Multi-Degree-of-Freedom Precision Position Sensing", section 3.B, Fig. 9.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import reduce
from itertools import combinations
from operator import add

import casadi as ca

AXES = ("x", "y")
ByAxis = Mapping[str, ca.SX]


@dataclass(frozen=True, eq=False)
class Displacement:
    """From the base: U and V, rad of phase by axis, and T, rad."""

    phase: ByAxis
    yaw: ca.SX


@dataclass(frozen=True, eq=False)
class Wave:
    """Sine and cosine of an angle."""

    sine: ca.SX
    cosine: ca.SX


@dataclass(frozen=True, eq=False)
class Sensor:
    """A sensor at the base: by axis its phase, its place about the centre, rad, and its voltages in field axes, V.

    `field` are the constant and the coefficients of sin, sin^3 and sin^5, `slope` those of the derivative.
    """

    phase: Mapping[str, Wave]
    place: ByAxis
    volts: ByAxis
    field: Sequence[ca.SX]
    slope: Sequence[ca.SX]


@dataclass(frozen=True, eq=False)
class Row:
    """One voltage in field axes, e = g U + h T to first order."""

    e: ca.SX
    g: ca.SX
    h: ca.SX


@dataclass(frozen=True, eq=False)
class Normal:
    """One axis of the normal equations, N U + coupling T = slope, with 1/N.

    `left` and `gain` are its parts of N_T and of the right side when U is eliminated.
    """

    inverse: ca.SX
    coupling: ca.SX
    slope: ca.SX
    left: ca.SX
    gain: ca.SX


@dataclass(frozen=True, eq=False)
class Equations:
    """The normal equations: those of the axes, and `information` N_T; T is to be `right` / N_T.

    `told` is the part of N_T that does not come of the yaw's own damping.
    """

    axes: Mapping[str, Normal]
    information: ca.SX
    told: ca.SX
    right: ca.SX


def rows(sensors: Sequence[Sensor], at: Displacement, turn: Wave, less: ca.SX) -> dict[str, list[Row]]:
    """Return the rows by axis at a displacement whose yaw has the wave `turn`; `less` is 1 - cos, exact about 0."""
    return _by_axis(_moved(s, at, turn, less) for s in sensors)


def base_rows(sensors: Sequence[Sensor]) -> dict[str, list[Row]]:
    """Return the rows by axis at the base."""
    return _by_axis(sensors)


def _moved(s: Sensor, at: Displacement, turn: Wave, less: ca.SX) -> Sensor:
    dx = -s.place["x"] * less - s.place["y"] * turn.sine
    dy = -s.place["y"] * less + s.place["x"] * turn.sine
    by = {"x": dx, "y": dy}
    volts = {
        "x": s.volts["x"] * turn.cosine - s.volts["y"] * turn.sine,
        "y": s.volts["y"] * turn.cosine + s.volts["x"] * turn.sine,
    }
    phase = {axis: _turned(s.phase[axis], at.phase[axis] + by[axis]) for axis in AXES}
    return Sensor(phase, {axis: s.place[axis] + by[axis] for axis in AXES}, volts, s.field, s.slope)


def _turned(base: Wave, by: ca.SX) -> Wave:
    s, c = ca.sin(by), ca.cos(by)
    return Wave(base.sine * c + base.cosine * s, base.cosine * c - base.sine * s)


def _by_axis(sensors: Iterable[Sensor]) -> dict[str, list[Row]]:
    both = [_pair(s) for s in sensors]
    return {axis: [pair[axis] for pair in both] for axis in AXES}


def _pair(s: Sensor) -> dict[str, Row]:
    B, g = {}, {}
    for axis, p in s.phase.items():
        q = p.sine**2
        B[axis] = s.field[0] + p.sine * (s.field[1] + q * (s.field[2] + q * s.field[3]))
        g[axis] = p.cosine * (s.slope[0] + q * (s.slope[1] + q * s.slope[2]))
    h = {"x": B["y"] - g["x"] * s.place["y"], "y": g["y"] * s.place["x"] - B["x"]}
    return {axis: Row(s.volts[axis] - B[axis], g[axis], h[axis]) for axis in AXES}


def squares(of: Mapping[str, Sequence[Row]]) -> ca.SX:
    """Return the sum of the squared residuals, V^2."""
    return _sum(r.e**2 for axis in AXES for r in of[axis])


def squares_by_sensor(of: Mapping[str, Sequence[Row]]) -> list[ca.SX]:
    """Return the squared residuals of each sensor, V^2."""
    return [_sum(r.e**2 for r in pair) for pair in zip(*(of[axis] for axis in AXES), strict=True)]


def equations(of: Mapping[str, Sequence[Row]], at: Displacement, damping: float, radius: float) -> Equations:
    """Return the normal equations at a displacement, damped by `damping`, V^2, and a yaw `radius`^2 times that."""
    axes = {axis: _normal(of[axis], at.phase[axis], damping) for axis in AXES}
    stiff = damping * radius**2
    told = _sum(n.left * n.inverse for n in axes.values())
    return Equations(axes, stiff + told, told, _sum(n.gain * n.inverse for n in axes.values()) - stiff * at.yaw)


def _normal(of: Sequence[Row], phase: ca.SX, damping: float) -> Normal:
    coupling = _sum(r.g * r.h for r in of)
    turn = _sum(r.h * r.e for r in of)
    left, gain = damping * _sum(r.h**2 for r in of), damping * (turn + phase * coupling)
    for a, b in combinations(of, 2):
        across = a.g * b.h - b.g * a.h
        left, gain = left + across**2, gain + across * (a.g * b.e - b.g * a.e)
    slope = _sum(r.g * r.e for r in of) - damping * phase
    return Normal(1 / (damping + _sum(r.g**2 for r in of)), coupling, slope, left, gain)


def _sum(terms: Iterable[ca.SX]) -> ca.SX:
    return reduce(add, terms)
