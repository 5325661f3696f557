"""Values of one planar motor, and which axes of the platen the forces of the three accelerate.

One motor: G and K of (17), the Lorentz force by quadrature, and the angles of the phases. They are functions of
numbers, because the pitch of Table 1 differs from that of the matrix and a comparison needs both. The platen:
(18)-(20), to compare with Table 3 and (26).

Source: Yu, Kim, section 5.1, (17)-(20), (26), Tables 1 to 3; see `lorentz_motor`, `planar_stage`.
"""

from collections.abc import Mapping
from math import pi

import casadi as ca
import numpy as np

from models import halbach, lorentz_motor, planar_stage
from synth.signals import signal_names

Parameters = Mapping[str, float]
Accelerations = Mapping[str, float]  # by axis

POINTS = 24  # of Gauss-Legendre quadrature along each side of a band
FORCE_ROUNDING = 1e-9  # of the largest acceleration of an axis by one motor: less is rounding
FORCES = tuple(f"{motor}{axis}" for motor in planar_stage.MOTORS for axis in "yz")


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


def accelerations_per_force(p: Mapping[str, float]) -> dict[str, Accelerations]:
    """Return `accelerations` of each of FORCES."""
    return {force: accelerations(p, force) for force in FORCES}


def accelerations(p: Mapping[str, float], force: str) -> Accelerations:
    """Return the accelerations of the six axes, level in the middle of the matrix, per ampere that makes one of FORCES.

    Parameters that are not in `p` are as published.
    """
    plant = planar_stage.plant().with_parameters(**p)
    known, at = constants({s.name: s.value for s in plant.parameters}), dict.fromkeys(planar_stage.AXES, ca.SX(0))
    motor, centre = force[0], planar_stage.centres(at, known)[force[0]]
    i_q, i_d = (ca.SX(float(axis == force[1])) for axis in "yz")
    phases = lorentz_motor.phase_currents(i_q, i_d, centre.X if motor == "C" else centre.Y, known)
    u = {f"i_{motor}{phase}": float(i) for phase, i in phases.items()}
    slopes = plant.f(np.zeros(len(plant.states)), [u.get(n, 0.0) for n in signal_names(plant.inputs)], plant.values)
    slope = dict(zip(signal_names(plant.states), np.asarray(slopes).ravel(), strict=True))
    return {axis: float(slope[planar_stage.RATE[axis]]) for axis in planar_stage.AXES}


def decoupled_rows(accelerations: Mapping[str, Accelerations], table: Mapping[str, Mapping[str, float]]) -> int:
    """Return how many rows of a table of forces by axis accelerate that axis alone."""
    return sum(_accelerated_axes(accelerations, forces) == {axis} for axis, forces in table.items())


def _accelerated_axes(accelerations: Mapping[str, Accelerations], forces: Mapping[str, float]) -> set[str]:
    total = {n: sum(size * accelerations[force][n] for force, size in forces.items()) for n in planar_stage.AXES}
    return {
        n for n, a in total.items() if abs(a) > FORCE_ROUNDING * max(abs(each[n]) for each in accelerations.values())
    }
