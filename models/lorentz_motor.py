"""Force model and dq commutation of a three-phase ironless linear motor above a Halbach array.

       one pitch l of the winding, along y
       +----+----+----+----+----+----+
       | A  | -B | C  | -A | B  | -C |   ^ Gamma           conductor bands: width l/6 along y, thickness Gamma,
       +----+----+----+----+----+----+   v                 length w across y, eta0 turns per m^2
          ~~~~~ gap z0 ~~~~~                               the winding has Nm pitches
       ===== array, strong side =====

The axis y is the motor's direction of motion, whichever axis of the stage that is. The forward conductors of a phase j
are centred at c_A = 0, c_B = -l/3 and c_C = +l/3, its return conductors half a pitch further. With the flux density
(B_y, B_z) of the array whose magnetisation varies along y (`models.halbach`), the Lorentz force of the currents i_j is

    f_y =  Nm w eta0 sum_j i_j I[B_z],    f_z = -Nm w eta0 sum_j i_j I[B_y],

    I[B] = integral over z = z0 .. z0 + Gamma and s = -l/12 .. l/12 of  B(y + c_j + s) - B(y + c_j + l/2 + s).

The magnet matrix contains a second array, which varies across y. Its field averages to zero over the length w, because
w is one pitch.

For the fundamental of the field, with the wave number gamma = 2 pi / l, the integrals give the Clarke and Park
transforms (Simulink `Clarke Transform`, `Park Transform`) times a force constant K:

    [f_y]       [ cos gamma y  sin gamma y]   [2/3   -1/3       -1/3     ]   [i_A]
    [f_z]  = K  [-sin gamma y  cos gamma y]   [ 0   1/sqrt(3)  -1/sqrt(3)]   [i_B]                            (17)
                                                                             [i_C]
    K = (3 / (2 pi)) mu0_M0 eta0 Nm G exp(-gamma z0),
    G = (sqrt(2) w l^2 / pi^2) (1 - exp(-gamma Gamma)) (1 - exp(-gamma Delta))

`phase_currents` is the inverse transform. The source prints (17) with 1/2 in place of 3 / (2 pi): the distribution
factor 3/pi of bands of 60 degrees is missing, and the printed force is 4.7 % too large. `Variant` selects the factor:
"lorentz" for that of the integral, "printed" for that of the source. The harmonics 5 and 9 of the field cause force
ripple.

Source: Yu, Kim, "Design of Precision Positioner with Hall-effect Sensors and Multivariable Control Methodology", (17),
Tables 1 and 2.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import pi, sin, sqrt
from typing import Literal

import casadi as ca

from models import halbach
from synth.block import Exprs
from synth.signals import Parameter

Variant = Literal["lorentz", "printed"]

TABLE_1, TABLE_2 = "Table 1", "Table 2"
PARAMETERS = (
    Parameter("l", 304.8e-3 / 6, "m", 1e-3, "Table 2: 304.8 mm in six pitches; Table 1 prints 50.977 mm"),
    Parameter("turns", 305.0, "1", 0.0, TABLE_1),
    Parameter("area", 8.6524e-5, "m^2", 1e-4, "Table 1; it prints the unit 10^5 m^2 in place of 10^-5 m^2"),
    Parameter("w", 304.8e-3 / 6, "m", 1e-3, "one pitch, so that G is right; Table 2 prints a width of 12.7 mm"),
    Parameter("Nm", 2.0, "1", 0.0, "the number of pitches is not printed; with 2, (26) follows from (17)"),
    Parameter("z0", 2.3e-3, "m", 0.05, TABLE_2),
    Parameter("Delta", 304.8e-3 / 24, "m", 1e-3, "Table 2: l/4"),
    Parameter("mu0_M0", 0.71, "T", 0.01, TABLE_2),
    Parameter("resistance", 4.98, "ohm", 0.01, TABLE_1),
    Parameter("inductance", 15.264e-3, "H", 0.01, TABLE_1),
)
PHASE_OFFSETS = {"A": 0.0, "B": -1 / 3, "C": 1 / 3}  # c_j / l


@dataclass(frozen=True, eq=False)
class MotorForces:
    """Forces on the winding in N: y along the motion, z upwards."""

    y: ca.SX
    z: ca.SX


def turn_density(p: Exprs) -> ca.SX:
    """Return eta0 in 1/m^2: the turns of a band divided by its cross-section."""
    return p["turns"] / p["area"]


def thickness(p: Exprs) -> ca.SX:
    """Return Gamma in m: the cross-section of a band divided by its width l/6."""
    return 6 * p["area"] / p["l"]


def geometric_constant(p: Exprs) -> ca.SX:
    """Return G in m^3. Source: (17)."""
    gamma, Gamma = halbach.wave_number(p), thickness(p)
    G_infinite = ca.sqrt(2) * p["w"] * p["l"] ** 2 / pi**2  # of a winding and magnets of infinite height
    return G_infinite * (1 - ca.exp(-gamma * Gamma)) * (1 - ca.exp(-gamma * p["Delta"]))


def force_constant(p: Exprs, variant: Variant = "lorentz") -> ca.SX:
    """Return K in N/A at the gap z0. Source: (17)."""
    factor = {"lorentz": 3 / (2 * pi), "printed": 0.5}[variant]
    decay = ca.exp(-halbach.wave_number(p) * p["z0"])
    return factor * p["mu0_M0"] * turn_density(p) * p["Nm"] * geometric_constant(p) * decay


def forces(y: ca.SX, z: ca.SX, currents: Mapping[str, ca.SX], p: Exprs, harmonics: Sequence[int] = (1,)) -> MotorForces:
    """Return the forces on a winding at the position y in m, at the gap z0 + z in m.

    `currents` holds the phase currents in A by name. `harmonics` lists the orders of the field that are included; all
    except the fundamental, 1, cause ripple.
    """
    gamma, Gamma = halbach.wave_number(p), thickness(p)
    f_y, f_z = ca.SX(0), ca.SX(0)
    for n in harmonics:
        integral_s = 2 / (n * gamma) * sin(n * pi / 6)  # of cos(n gamma s) over the width of a band
        integral_z = (1 - ca.exp(-n * gamma * Gamma)) / (n * gamma)  # of the decay over its thickness
        amplitude = halbach.amplitude(n, p["z0"] + z, p)
        force_per_ampere = 2 * p["Nm"] * p["w"] * turn_density(p) * integral_s * integral_z * amplitude
        for phase, offset in PHASE_OFFSETS.items():
            angle = n * (gamma * y + 2 * pi * offset)
            f_y += force_per_ampere * currents[phase] * ca.cos(angle)
            f_z -= force_per_ampere * currents[phase] * ca.sin(angle)
    return MotorForces(f_y, f_z)


def phase_currents(i_q: ca.SX, i_d: ca.SX, y: ca.SX, p: Exprs) -> dict[str, ca.SX]:
    """Return the phase currents in A that make f_y = K i_q and f_z = K i_d at the position y in m.

    `i_q` and `i_d` are amplitudes in A.
    """
    angle = halbach.wave_number(p) * y
    alpha = ca.cos(angle) * i_q - ca.sin(angle) * i_d
    beta = ca.sin(angle) * i_q + ca.cos(angle) * i_d
    quadrature = sqrt(3) / 2 * beta
    return {"A": alpha, "B": quadrature - alpha / 2, "C": -quadrature - alpha / 2}
