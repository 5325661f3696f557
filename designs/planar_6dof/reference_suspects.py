"""NumPy reference of the suspected Hall voltages: from the first contradiction of `reference_sensing`."""

import numpy as np

from designs.planar_6dof.reference_sensing import EXCESS_BOUND, FIRST, HALL, RESIDUAL_BOUND, Array, Columns

NEARLY_ZERO, SMALL_CHANGE = 0.1, 0.3  # of A^2
SIGNIFICANT_M, SIGNIFICANT_R, JUMP, MAX_KNOWN_YAW = 0.2, 0.3, 1.5, 0.01  # of the bounds, of rho, rad
MAX_SPREAD = 0.25  # of the sum of m_x and m_y


def suspects(state: Columns, A: float, from_forces: bool = False) -> dict[str, Array]:
    """Return whether each voltage may be wrong, from the first contradiction; of motion alone all may."""
    first = {name: np.asarray(state[f"sensing_first_{name}"]) for name in FIRST}
    least_r, least_m, nearly, small = (
        SIGNIFICANT_R * RESIDUAL_BOUND * A,
        SIGNIFICANT_M * EXCESS_BOUND * A**2,
        NEARLY_ZERO * A**2,
        SMALL_CHANGE * A**2,
    )
    m, r = (np.abs([first["m_x"], first["m_y"]]), np.array([first["r_2"], first["r_1"]]))
    m_exceeds, r_exceeds = m > least_m, np.abs(r) > least_r
    rho = np.sqrt(np.sum((r / (RESIDUAL_BOUND * A)) ** 2 + (m / (EXCESS_BOUND * A**2)) ** 2, axis=0))
    is_jump = rho > JUMP
    is_ambiguous = (np.abs(first["phi"]) > MAX_KNOWN_YAW) | (~is_jump & np.all(m_exceeds, axis=0))
    any_r_exceeds, wrong = np.any(r_exceeds, axis=0), {}
    for i, (s, c, other) in enumerate((("V_ax", "V_bx", "V_cx"), ("V_ay", "V_cy", "V_by"))):
        before = first["s_x" if i == 0 else "s_y"]
        change = np.abs((before + r[i]) ** 2 - before**2)
        wrong[s] = np.where(is_jump, r_exceeds[i] & ((change < small) | (m[i] >= nearly)), any_r_exceeds | m_exceeds[i])
        wrong[c] = np.where(is_jump, m[i] > change + nearly, m_exceeds[i])
        wrong[other] = np.where(is_jump, r_exceeds[i] & (m[i] < nearly), any_r_exceeds)
    is_any = is_ambiguous | is_amplitude(state, A) | (from_forces & (rho <= 1))
    frozen = np.asarray(state["sensing_frozen"]) if from_forces else np.zeros_like(rho)
    numbers = {name: k for k, name in enumerate(HALL, 1)}
    return {name: np.where(frozen > 0, frozen == numbers[name], flag | is_any) for name, flag in wrong.items()}


def is_amplitude(state: Columns, A: float) -> Array:
    """Return whether the amplitude of all voltages explains the first contradiction; then all are wrong."""
    m_x, m_y, r_1, r_2 = (np.asarray(state[f"sensing_first_{name}"]) for name in ("m_x", "m_y", "r_1", "r_2"))
    is_large = np.minimum(np.abs(m_x), np.abs(m_y)) > SIGNIFICANT_M * EXCESS_BOUND * A**2
    is_yaw = np.maximum(np.abs(r_1), np.abs(r_2)) > SIGNIFICANT_R * RESIDUAL_BOUND * A
    return np.asarray(is_large & ~is_yaw & (np.abs(m_x - m_y) < MAX_SPREAD * np.abs(m_x + m_y)))
