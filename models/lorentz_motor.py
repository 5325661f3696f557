"""Lorentz forces of one three-phase ironless planar motor above a magnet matrix, and its commutation.

       one pitch l of the winding, along the motion y          each band: width l/6, height Gamma, length w across,
       +----+----+----+----+----+----+                         eta0 turns per m^2; Nm pitches in all
       | A  | -B | C  | -A | B  | -C |   ^ Gamma
       +----+----+----+----+----+----+   v                     phases lie at c_A = 0, c_B = -l/3, c_C = +l/3
          ~~~~~ gap z0 ~~~~~                                   and return half a pitch further
       ===== matrix, strong side ======

The Lorentz force of the bands' current density eta0 i in the matrix's field (`models.halbach`), over a length w of one
pitch across, in which the field of the other array averages out, is

    f_y = Nm w eta0 sum_j i_j int_z0^(z0 + Gamma) int_-l/12^l/12 (B(y + c_j + s) - B(y + c_j + l/2 + s)) ds dz

with B = B_Z of the array along y, and f_z the same with -B_Y. With the fundamental of the field and gamma = 2 pi / l

    [f_y]       [ cos gamma y  sin gamma y]   [2/3   -1/3       -1/3     ]   [i_A]
    [f_z]  = K  [-sin gamma y  cos gamma y]   [ 0   1/sqrt(3)  -1/sqrt(3)]   [i_B]                            (17)
                                                                             [i_C]
    K = (3 / (2 pi)) mu0_M0 eta0 Nm G exp(-gamma z0),
    G = (sqrt(2) w l^2 / pi^2) (1 - exp(-gamma Gamma)) (1 - exp(-gamma Delta))

(17) prints 1/2 where the integral gives 3 / (2 pi): the distribution factor 3/pi of bands of 60 degrees is missing, and
the printed force is 4.7 % too large. `Variant` names the choice. The harmonics 5 and 9 of the field cause force ripple.

Source: Yu, Kim, "Design of Precision Positioner with Hall-effect Sensors and Multivariable Control Methodology", (17),
Tables 1 and 2.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import pi, sin, sqrt
from typing import Literal

import casadi as ca

from models import halbach
from synth.signals import Parameter

Values = Mapping[str, ca.SX]
Variant = Literal["lorentz", "printed"]

TABLE_1, TABLE_2 = "Table 1", "Table 2"
PARAMETERS = (
    Parameter("l", 304.8e-3 / 6, "m", 1e-3, "Table 2: 304.8 mm in six pitches; Table 1 prints 50.977 mm"),
    Parameter("turns", 305.0, "1", 0.0, TABLE_1),
    Parameter("area", 8.6524e-5, "m^2", 1e-4, "Table 1, whose 10^5 m^2 misses the sign of the exponent"),
    Parameter("w", 304.8e-3 / 6, "m", 1e-3, "one pitch, as G needs; Table 2 prints a width of 12.7 mm"),
    Parameter("Nm", 2.0, "1", 0.0, "not printed: the pitches for which (26) follows from (17)"),
    Parameter("z0", 2.3e-3, "m", 0.05, TABLE_2),
    Parameter("Delta", 304.8e-3 / 24, "m", 1e-3, "Table 2: l/4"),
    Parameter("mu0_M0", 0.71, "T", 0.01, TABLE_2),
    Parameter("resistance", 4.98, "ohm", 0.01, TABLE_1),
    Parameter("inductance", 15.264e-3, "H", 0.01, TABLE_1),
)
OFFSETS = {"A": 0.0, "B": -1 / 3, "C": 1 / 3}  # of the phases' bands, in pitches


@dataclass(frozen=True, eq=False)
class MotorForces:
    """Forces in N on the winding: along its motion and up."""

    y: ca.SX
    z: ca.SX


def turn_density(p: Values) -> ca.SX:
    """Return eta0 in 1/m^2: turns over the area of a winding."""
    return p["turns"] / p["area"]


def thickness(p: Values) -> ca.SX:
    """Return Gamma in m: the area of a winding over its width l/6."""
    return 6 * p["area"] / p["l"]


def geometric_constant(p: Values) -> ca.SX:
    """Return G in m^3. Source: (17)."""
    k = halbach.wave_number(p)
    return ca.sqrt(2) * p["w"] * p["l"] ** 2 / pi**2 * (1 - ca.exp(-k * thickness(p))) * (1 - ca.exp(-k * p["Delta"]))


def force_constant(p: Values, variant: Variant = "lorentz") -> ca.SX:
    """Return K in N/A at the gap z0. Source: (17), whose factor 1/2 is "printed"."""
    factor = {"lorentz": 3 / (2 * pi), "printed": 0.5}[variant]
    decay = ca.exp(-halbach.wave_number(p) * p["z0"])
    return factor * p["mu0_M0"] * turn_density(p) * p["Nm"] * geometric_constant(p) * decay


def forces(
    y: ca.SX, z: ca.SX, currents: Mapping[str, ca.SX], p: Values, harmonics: Sequence[int] = (1,)
) -> MotorForces:
    """Return the forces in N on a winding at y in m along the motion, lifted by z in m above the gap z0.

    `currents` in A by phase; `harmonics` of the field beside the fundamental cause ripple.
    """
    k = halbach.wave_number(p)
    f_y, f_z = ca.SX(0), ca.SX(0)
    for n in harmonics:
        band = 2 / (n * k) * sin(n * pi / 6)
        height = (1 - ca.exp(-n * k * thickness(p))) / (n * k)
        each = 2 * p["Nm"] * p["w"] * turn_density(p) * band * height * halbach.amplitude(n, p["z0"] + z, p)
        for phase, offset in OFFSETS.items():
            angle = n * (k * y + 2 * pi * offset)
            f_y += each * currents[phase] * ca.cos(angle)
            f_z -= each * currents[phase] * ca.sin(angle)
    return MotorForces(f_y, f_z)


def phase_currents(i_q: ca.SX, i_d: ca.SX, y: ca.SX, p: Values) -> dict[str, ca.SX]:
    """Return the phase currents in A that make f_y = K i_q and f_z = K i_d at y in m; i_q, i_d are amplitudes in A."""
    angle = halbach.wave_number(p) * y
    alpha = ca.cos(angle) * i_q - ca.sin(angle) * i_d
    beta = ca.sin(angle) * i_q + ca.cos(angle) * i_d
    half = sqrt(3) / 2 * beta
    return {"A": alpha, "B": half - alpha / 2, "C": -half - alpha / 2}
