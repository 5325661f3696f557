"""The full model F(5)-(7) in NumPy, on the forces of the reference: an oracle without CasADi."""

import numpy as np
from numpy.typing import NDArray

from designs.maglev import reference_stage
from designs.maglev_5dof import reference

Array = NDArray[np.float64]


def motors(y: Array, phi: Array, theta: Array, p: reference_stage.Parameters) -> reference_stage.Motor:
    """Return the four motors (4, ...) at a pose. F(5)."""
    tilt, roll = p.r * np.sin(phi), p.r * np.sin(theta)
    return reference_stage.motor(np.stack([y - tilt, y + roll, y + tilt, y - roll]), p)


def plant(state: Array, currents: Array, p: reference_stage.Parameters) -> Array:
    """Return the derivative of x1..x10 (10, ...) under i_d1..i_d4, i_q1..i_q4 (8, ...). F(2), F(6)-(7), F table II."""
    y, v_y, _, v_x, _, v_z, phi, v_phi, theta, v_theta = state
    m, i_d, i_q = motors(y, phi, theta, p), currents[:4], currents[4:]
    F, thrust = -m.a + m.b * i_d - m.c * (i_d**2 + i_q**2), -m.h * i_q
    x, z = (thrust[1] + thrust[3]) / p.M_x, (thrust[0] + thrust[2]) / p.M_z
    tilt = p.r * (F[2] - F[0]) / p.I - p.k_s_phi * phi
    roll = p.r * (F[1] - F[3]) / p.I - p.k_s_theta * theta
    return np.stack([v_y, p.G + F.sum(axis=0) / p.M_y, v_x, x, v_z, z, v_phi, tilt, v_theta, roll])


def initial_state() -> dict[str, float]:
    """Return the state of the controller after init, by name."""
    initial = {"y_ref": 0.03098} | dict.fromkeys(("y1", "y2", "y3", "y4"), 0.031)
    state: dict[str, float] = {f"guard_last_{s}": initial.get(s, 0.0) for s in reference_stage.LIMITS}
    left = reference_stage.BAD_SAMPLES * reference_stage.GOOD_SAMPLES
    state |= {"guard_left": left, "guard_latched": 0.0, "guard_ready": 0.0}
    state |= dict.fromkeys(reference.MEMORY, 0.0)
    return state | {f"safe_output_last_{s}": value for s, value in reference_stage.SAFE.items()}
