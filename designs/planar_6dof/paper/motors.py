"""Values of one planar motor: G and K of (17), the Lorentz force by quadrature, and the angles of the phases.

They are functions of numbers, because the pitch of Table 1 differs from that of the matrix and a comparison needs both.

Source: Yu, Kim, section 5.1, (17), Tables 1 and 2; see `lorentz_motor`.
"""

from collections.abc import Mapping
from math import pi

import casadi as ca
import numpy as np

from models import halbach, lorentz_motor

Parameters = Mapping[str, float]

POINTS = 24  # of Gauss-Legendre quadrature along each side of a band


def constants(p: Parameters) -> dict[str, ca.SX]:
    """Return numbers by name as the constant expressions that models take."""
    return {name: ca.SX(value) for name, value in p.items()}


def G(l: float, w: float, area: float, Delta: float) -> float:
    """Return the geometric constant in m^3 of a pitch and width in m and a winding of m^2, over blocks Delta high."""
    return float(lorentz_motor.geometric_constant(constants({"l": l, "w": w, "area": area, "Delta": Delta})))


def force_constant(p: Parameters, variant: lorentz_motor.Variant = "lorentz") -> float:
    """Return K in N/A."""
    return float(lorentz_motor.force_constant(constants(p), variant))


def lorentz_force(p: Parameters, y: float) -> tuple[float, float]:
    """Return f_y and f_z in N for i_Q = 1 A at y in m, by quadrature over the bands without simplification."""
    known, l = constants(p), p["l"]
    nodes, weights = np.polynomial.legendre.leggauss(POINTS)
    high = float(lorentz_motor.thickness(known))
    heights, along = p["z0"] + high * (nodes + 1) / 2, l / 12 * nodes
    A = np.asarray(ca.DM(halbach.amplitude(1, ca.SX(heights), known))).ravel()
    total = np.zeros(2)
    for phase, i in currents(l, y).items():
        for sign, shift in ((1, 0.0), (-1, 0.5)):
            at = 2 * pi / l * (y + (lorentz_motor.PHASE_OFFSETS[phase] + shift) * l + along)
            total += sign * i * l / 12 * np.array([weights @ np.cos(at), -weights @ np.sin(at)])
    sheet = high / 2 * (weights @ A) * p["Nm"] * p["w"] * float(lorentz_motor.turn_density(known))
    return float(sheet * total[0]), float(sheet * total[1])


def ripple(p: Parameters) -> float:
    """Return the ripple of the force of i_Q over a pitch or its lift, the larger one, in % of the force at y = 0."""
    forces = np.array([lorentz_force(p, y) for y in np.linspace(0, p["l"], 7)])
    return round(100 * float(np.abs(forces / forces[0, 0] - [1, 0]).max()), 9)  # the rest is rounding


def currents(l: float, y: float) -> dict[str, float]:
    """Return the phase currents of i_Q = 1 A at y in m."""
    phases = lorentz_motor.phase_currents(ca.SX(1), ca.SX(0), ca.SX(y), {"l": ca.SX(l)})
    return {phase: float(i) for phase, i in phases.items()}


def band_spacing() -> float:
    """Return the angle in degrees from band to band."""
    places = np.sort([(c + half) % 1 for c in lorentz_motor.PHASE_OFFSETS.values() for half in (0, 0.5)])
    return 360 * float(np.diff(places).max())


def phase_spacing() -> float:
    """Return the angle in degrees from the current of phase A to that of B."""
    cosine, sine = currents(1.0, 0.0), currents(1.0, 0.25)
    return float(np.degrees(np.arctan2(sine["B"], cosine["B"]) - np.arctan2(sine["A"], cosine["A"])))
