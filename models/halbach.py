"""Flux density above a concentrated-field magnet matrix: two Halbach arrays at right angles, superposed.

            z ^      strong side                 blocks of width l/4 and height Delta, magnetised along X as
              |  ~~~~~~~~~~~~~~~~~~                  +z, -x, -z, +x, +z, ..      pitch l, w = 2 pi / l
              +---+---+---+---+---+---> X        The second array is the same along Y. The magnetisation of the
              | ^ | < | v | > | ^ |              matrix is the sum of both.

The magnetisation of an array has the Fourier coefficients (4 / (n pi)) sin(n pi / 4) along z, and the same, except for
the sign, along x. Above the array the contributions of both add for n = 1, 5, 9, .. and cancel for n = 3, 7, .. The
finite height Delta multiplies the field by 1 - exp(-n w Delta). With the remanence m = mu0 M0 of one array, and the
origin at the centre of a block that both arrays magnetise along +z,

    B_X = sum_n A_n sin(n w X),  B_Y = sum_n A_n sin(n w Y),  B_Z = sum_n A_n (cos(n w X) + cos(n w Y)),
    A_n(z) = (4 / (n pi)) sin(n pi / 4) m (1 - exp(-n w Delta)) exp(-n w z),    n = 1, 5, 9, ..

This field has neither divergence nor curl. Finite extent and imperfect blocks are neglected.

Source: Kawato, Kim, "A Novel Multi-DOF Precision Positioning Methodology Using Two-Axis Hall-Effect Sensors", section
2; Yu, Kim, "Design of Precision Positioner with Hall-effect Sensors", Table 2.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import pi, sin

import casadi as ca

from synth.block import Exprs

HARMONICS = (1, 5, 9)


@dataclass(frozen=True, eq=False)
class Field:
    """Flux density in T along X, Y and Z."""

    x: ca.SX
    y: ca.SX
    z: ca.SX


def wave_number(p: Exprs) -> ca.SX:
    """Return the fundamental wave number 2 pi / l in rad/m for the pitch l in m."""
    return 2 * pi / p["l"]


def amplitude(n: int, z: ca.SX, p: Exprs) -> ca.SX:
    """Return A_n in T at the height z in m of the harmonic n (odd); 0 where the contributions cancel (n = 3, 7, ..)."""
    if n % 4 != 1:
        return ca.SX(0)
    w = n * wave_number(p)
    return 4 / (n * pi) * sin(n * pi / 4) * p["mu0_M0"] * (1 - ca.exp(-w * p["Delta"])) * ca.exp(-w * z)


def field(X: ca.SX, Y: ca.SX, z: ca.SX, p: Exprs, harmonics: Sequence[int] = HARMONICS) -> Field:
    """Return the flux density in T at X, Y in m from the origin, z in m above the matrix.

    `p` holds the pitch l and the blocks' height Delta in m, and the remanence mu0_M0 of one array in T.
    """
    w, A = wave_number(p), {n: amplitude(n, z, p) for n in harmonics}
    B_X = sum((A[n] * ca.sin(n * w * X) for n in harmonics), start=ca.SX(0))
    B_Y = sum((A[n] * ca.sin(n * w * Y) for n in harmonics), start=ca.SX(0))
    B_Z = sum((A[n] * (ca.cos(n * w * X) + ca.cos(n * w * Y)) for n in harmonics), start=ca.SX(0))
    return Field(B_X, B_Y, B_Z)
