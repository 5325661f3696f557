"""Exact inverse of the maglev stage's force laws: direct currents for demanded accelerations, with least copper loss.

With the force of each motor without that of its magnets and its thrust current, f_j = F_Vj + a_j + c_j i_qj^2, (6) and
(7) demand

    f_1 + f_2 + f_3 + f_4 = n,    f_3 - f_1 = d,    f_2 - f_4 = e

Four currents make three accelerations. What is left, f_1 + f_3, is that of the least copper loss sum_j i_dj^2 for the
currents i_dj = f_j / b_j, of which the exact ones differ by little. Then each motor has one quadratic equation,

    b_j i - c_j i^2 = f_j,    i = 2 f_j / (b_j + sqrt(b_j^2 - 4 c_j f_j))

Beyond its largest force b^2 / (4 c), the current is that of the square root 0. Source: F(2), (6), (7).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca

from models import pmlsm
from models.maglev_stage import Exprs


@dataclass(frozen=True, eq=False)
class DirectCurrents:
    """The direct currents in A of motors 1 to 4, and halves of the forces in N: n, d, e, f_1 + f_3, f_2 + f_4."""

    currents: tuple[ca.SX, ...]
    half_forces: dict[str, ca.SX]


def direct_currents(
    w: Exprs, x: Exprs, i_q: Sequence[ca.SX], motors: Sequence[pmlsm.ForceLaw], p: Exprs
) -> DirectCurrents:
    """Return i_d1..i_d4 in A for which y'', phi'', theta'' = `w` beside the quadrature currents `i_q` in A.

    `w` holds y, phi and theta in m/s^2 and rad/s^2, `x` holds phi and theta in rad; `i_q` and `motors` go by motor.
    """
    half = [m.half_a + m.half_c * i**2 for m, i in zip(motors, i_q, strict=True)]  # of the loads
    squares = [m.b**2 for m in motors]
    s1, s2, s3, s4 = (1 / b for b in squares)
    n = p["M_y"] / 2 * (w["y"] - p["G"]) + (half[0] + half[1] + half[2] + half[3])
    d = p["I_x"] / (2 * p["r"]) * (w["phi"] + p["k_s_phi"] * x["phi"]) + (half[2] - half[0])
    e = p["I_z"] / (2 * p["r"]) * (w["theta"] + p["k_s_theta"] * x["theta"]) + (half[1] - half[3])
    odd = ((s2 + s4) * n + (s2 - s4) * e - (s3 - s1) * d) / (s1 + s3 + (s2 + s4))
    even = n - odd
    doubled = (odd - d, even + e, odd + d, even - e)  # the forces f_j themselves
    currents = tuple(_current(f, m, b) for f, m, b in zip(doubled, motors, squares, strict=True))
    forces = {
        "half_force": n,
        "half_force_phi": d,
        "half_force_theta": e,
        "half_force_1_3": odd,
        "half_force_2_4": even,
    }
    return DirectCurrents(currents, forces)


def _current(force: ca.SX, m: pmlsm.ForceLaw, b_squared: ca.SX) -> ca.SX:
    return 2 * force / (m.b + ca.sqrt(ca.fmax(b_squared - 8 * m.half_c * force, 0)))
