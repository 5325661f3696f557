"""Pairs of Hall voltages, one sine and one cosine of an axis: position within a pitch, and the equation of the yaw.

    s = A S(t),  c = A C(t),  t = 2 pi x / l        rotated back by the predicted yaw
    m = s^2 + c^2 less its nominal value, a polynomial in (s c)^2

The problem, with the letters used here, is stated in `sections`.

Source: Yu, Kim, section 3.1, (1)-(5).
"""

from dataclasses import dataclass

import casadi as ca

from designs.planar_6dof.sensing import calibration
from synth.block import Constant, Exprs
from synth.law import label


@dataclass(frozen=True, eq=False)
class Pair:
    """One axis' voltages rotated back by the yaw, s = A S and c = A C, and the excess m of s^2 + c^2."""

    s: ca.SX
    c: ca.SX
    m: ca.SX


def pair(axis: str, s: ca.SX, c: ca.SX, k: Exprs) -> Pair:
    """Return the pair of voltages that are rotated back."""
    product = (s * c) ** 2
    label(axis, squared_product=product)
    return Pair(s, c, s**2 + c**2 - (k["power_0"] + product * (k["power_1"] + product * k["power_2"])))


def slope(p: Pair, k: Exprs) -> ca.SX:
    """Return 3 pi/2 A S'."""
    return p.c * p.c**2 * (k["slope_0"] + p.s**2 * k["slope_1"])


def yaw_equation(
    X: Pair, Y: Pair, h: tuple[ca.SX, ca.SX], r: tuple[ca.SX, ca.SX], k: Exprs, least: float
) -> tuple[ca.SX, ca.SX]:
    """Return numerator and denominator, V^2, of the yaw less the predicted one in rad; h3 is half of h_3."""
    h3 = X.s * (Y.s - Y.c) + Y.s * (X.s - X.c)
    (h1, h2), (r1, r2) = h, r
    information = h1**2 + h2**2 + 2 * k["amplitude_weight"] * h3**2 + least
    label(h3=h3)
    return h1 * r1 - h2 * r2 + k["amplitude_weight"] * (h3 * (X.m - Y.m)), information


def place(axis: str, p: Pair, r: ca.SX, k: Exprs, cal: calibration.Calibration) -> ca.SX:
    """Return the position within the pitch, m, from the ratio r of the pair."""
    l, f = cal.pitch, ca.SX(0)
    for n in reversed(range(len(cal.position))):
        f = k[f"position_{2 * n + 1}"] + r**2 * f
    f = r * f
    near = ca.if_else(p.c < 0, ca.if_else(f > 0, f - l / 2, f + l / 2), f)
    label(axis, f=f)
    return ca.if_else(p.s**2 <= p.c**2, near, ca.if_else(p.s < 0, -l / 4, l / 4) - f)


def constants(cal: calibration.Calibration, weight: float) -> list[Constant]:
    """Return the fits, and the weight of m_x - m_y in the yaw, as constants of a law."""
    position = [(f"position_{2 * n + 1}", v, "m") for n, v in enumerate(cal.position)]
    slope = [(f"slope_{n}", v, f"1/V^{2 * n + 2}") for n, v in enumerate(cal.slope)]
    power = [
        (f"power_{n}", v, unit) for n, (v, unit) in enumerate(zip(cal.power, ("V^2", "1/V^2", "1/V^6"), strict=True))
    ]
    fits = [
        Constant(name, v, unit, f"fit of the {name.partition('_')[0]} in the calculated field")
        for name, v, unit in (*position, *slope, *power)
    ]
    about = f"2 W / V_0^2, W = {weight:g}: weight of m_x - m_y in the yaw"
    return [*fits, Constant("amplitude_weight", 2 * weight / cal.amplitude**2, "1/V^2", about)]
