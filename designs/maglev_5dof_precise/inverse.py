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

import casadi as ca

from models import maglev_stage, pmlsm
from models.maglev_stage import DirectCurrents, Exprs
from synth.law import label


def direct_currents(
    w: Exprs, x: Exprs, i_q: Sequence[ca.SX], motors: Sequence[pmlsm.ForceLaw], p: Exprs
) -> DirectCurrents:
    """Return i_d1..i_d4 in A for which y'', phi'', theta'' = `w` beside the quadrature currents `i_q` in A.

    `w` holds y, phi and theta in m/s^2 and rad/s^2, `x` holds phi and theta in rad; `i_q` and `motors` go by motor.
    """
    half = [m.half_a + m.half_c * i**2 for m, i in zip(motors, i_q, strict=True)]  # of the loads
    squares = [m.b**2 for m in motors]
    forces = maglev_stage.half_forces(w, x, half, [1 / b for b in squares], p)
    _, d, e, odd, even = forces.values()
    doubled = (odd - d, even + e, odd + d, even - e)  # the forces f_j themselves
    currents = {
        f"i_d{j}": _current(f, m, b) for j, (f, m, b) in enumerate(zip(doubled, motors, squares, strict=True), 1)
    }
    label(d=d, e=e, half=half, squares=squares, doubled=doubled)
    return DirectCurrents(currents, forces)


def _current(force: ca.SX, m: pmlsm.ForceLaw, b_squared: ca.SX) -> ca.SX:
    return 2 * force / (m.b + ca.sqrt(ca.fmax(b_squared - 8 * m.half_c * force, 0)))
