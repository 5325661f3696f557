"""Levitated platen driven by the phase currents of its four motors, at the true electrical angle of each.

    th_j = pi s_j/tau + pi/2,   s_j = x for motors 2 and 4, z for motors 1 and 3
    (i_d, i_q)_j = Park(i_aj, i_bj, i_cj; th_j),   then (6), (7) as in `maglev_stage`

Phase currents for a wrong angle turn the direct current into thrust and the thrust current into levitation: a motor
whose direct current repels the platen pushes it away along the motion, further from the angle that was assumed.
"""

import casadi as ca

from models import maglev_stage, windings
from models.maglev_stage import Exprs
from synth.plant import Plant, build
from synth.signals import Signal

MOTORS = (1, 2, 3, 4)
PHASES = tuple(
    Signal(f"i_{phase}{j}", "A", -2 * maglev_stage.PEAK, 2 * maglev_stage.PEAK, f"phase {phase} of motor {j}")
    for j in MOTORS
    for phase in "abc"
)
ALONG = tuple(thrust[-1] for thrust in maglev_stage.QUADRATURE)  # the coordinate of each motor's motion


def plant(lv3: str = "csch2") -> Plant:
    """Return the full model (5)-(7) with the twelve phase currents in A as inputs; `lv3` is as for `maglev_stage`.

    Raises ModelError for another `lv3`.
    """
    variant = maglev_stage.force_variant(lv3)

    def physics(x: Exprs, u: Exprs, p: Exprs) -> tuple[dict[str, ca.SX], dict[str, ca.SX]]:
        angles = [windings.electrical_angle(x[along], p["tau"]) for along in ALONG]
        phases = [[u[f"i_{phase}{j}"] for phase in "abc"] for j in MOTORS]
        currents = [windings.rotor_currents(i, angle) for i, angle in zip(phases, angles, strict=True)]
        return maglev_stage.motion(x, maglev_stage.motor_accelerations(x, currents, p, variant), p)

    of = maglev_stage
    return build("maglev_stage_phases", of.STATES, PHASES, of.OUTPUTS, of.PARAMETERS, physics)
