"""The field above a concentrated-field magnet matrix: two Halbach arrays at right angles, superposed.

            z ^      strong side                 blocks of width l/4 and height Delta, magnetised along X as
              |  ~~~~~~~~~~~~~~~~~~                  +z, -x, -z, +x, +z, ..      period l, w = 2 pi / l
              +---+---+---+---+---+---> X        and likewise along Y; the matrix carries the sum of the two
              | ^ | < | v | > | ^ |

The blocks' magnetisation has the Fourier coefficients (4 / (n pi)) sin(n pi / 4) in z and, but for the sign, in x;
above the array they add for n = 1, 5, 9, .. and cancel for n = 3, 7, ... A layer from depth 0 to Delta adds the factor
1 - exp(-n w Delta), so that with the origin at the centre of a block +z and the remanence m = mu0 M0 of one array

    B_X = sum_n A_n sin(n w X),  B_Y = sum_n A_n sin(n w Y),  B_Z = sum_n A_n (cos(n w X) + cos(n w Y)),
    A_n(z) = (4 / (n pi)) sin(n pi / 4) m (1 - exp(-n w Delta)) exp(-n w z),    n = 1, 5, 9, ..

which has neither divergence nor curl. Finite extent and imperfect blocks are neglected.

Source: Kawato, Kim, "A Novel Multi-DOF Precision Positioning Methodology Using Two-Axis Hall-Effect Sensors", section
2; Yu, Kim, "Design of Precision Positioner with Hall-effect Sensors", Table 2.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import pi, sin

import casadi as ca

Values = Mapping[str, ca.SX]

HARMONICS = (1, 5, 9)


@dataclass(frozen=True, eq=False)
class Field:
    """Flux density in T along X, Y and Z."""

    x: ca.SX
    y: ca.SX
    z: ca.SX


def wave_number(p: Values) -> ca.SX:
    """Return w = 2 pi / l in 1/m for the pitch l in m."""
    return 2 * pi / p["l"]


def amplitude(n: int, z: ca.SX, p: Values) -> ca.SX:
    """Return A_n in T at the height z in m for an odd n; 0 where the two magnetisations cancel (n = 3, 7, ..)."""
    if n % 4 != 1:
        return ca.SX(0)
    w = n * wave_number(p)
    return 4 / (n * pi) * sin(n * pi / 4) * p["mu0_M0"] * (1 - ca.exp(-w * p["Delta"])) * ca.exp(-w * z)


def field(X: ca.SX, Y: ca.SX, z: ca.SX, p: Values, harmonics: Sequence[int] = HARMONICS) -> Field:
    """Return the flux density in T at X, Y in m from a strong block's centre, z in m above the matrix.

    `p` holds the pitch l and the blocks' height Delta in m, and the remanence mu0_M0 of one array in T.
    """
    w, A = wave_number(p), {n: amplitude(n, z, p) for n in harmonics}
    along_x = sum((A[n] * ca.sin(n * w * X) for n in harmonics), start=ca.SX(0))
    along_y = sum((A[n] * ca.sin(n * w * Y) for n in harmonics), start=ca.SX(0))
    up = sum((A[n] * (ca.cos(n * w * X) + ca.cos(n * w * Y)) for n in harmonics), start=ca.SX(0))
    return Field(along_x, along_y, up)
