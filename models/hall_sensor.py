"""Two-axis Hall sensors: voltages from the flux density at a point of a moving platen.

    V_u = V_0 + S (cos(phi) B_X + sin(phi) B_Y)
    V_v = V_0 + S (cos(phi) B_Y - sin(phi) B_X)

for a sensor whose axes u, v rotate with the platen by phi about Z. S is the sensitivity of sensor and amplifier in V/T,
and V_0 the offset. Tilt about X and Y moves the sensor; the rotation of its axes by the tilt is neglected.

Source: Kawato, Kim, "A Novel Multi-DOF Precision Positioning Methodology Using Two-Axis Hall-Effect Sensors", the
measurement model; Yu, Kim, "Design of Precision Positioner with Hall-effect Sensors", section 3.
"""

from dataclasses import dataclass

import casadi as ca

from models.halbach import Field


@dataclass(frozen=True, eq=False)
class Voltages:
    """Voltages of a sensor's two axes, V."""

    u: ca.SX
    v: ca.SX


def voltages(field: Field, phi: ca.SX, sensitivity: ca.SX, offset: ca.SX) -> Voltages:
    """Return the voltages in V for a field in T, a yaw in rad, a sensitivity in V/T and an offset in V."""
    c, s = ca.cos(phi), ca.sin(phi)
    return Voltages(
        offset + sensitivity * (c * field.x + s * field.y), offset + sensitivity * (c * field.y - s * field.x)
    )
