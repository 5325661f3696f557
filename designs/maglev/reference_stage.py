"""The maglev stage for both controllers, one step of 1 ms: NumPy reference for the generated C.

    motor   F_V = -a + b i_d - c (i_d^2 + i_q^2), F_H = -h i_q, with a, b, c, h > 0 functions of the gap     F(1)-(4)
    stage   M_y y'' = M_y G + sum_j F_Vj;  M_x x'' = F_H2 + F_H4;  M_z z'' = F_H1 + F_H3                     F(5)-(7)
            I phi'' = r (F_V3 - F_V1) - I k_phi phi;  I theta'' = r (F_V2 - F_V4) - I k_theta theta

Guard, pose, force coefficients and the limit of the thrust. Columns are (n,) for n independent controllers; internally,
axes, motors or currents are rows of one array. Lengths in m, angles in rad, currents in A rms.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from math import pi, sin, sqrt
from typing import Any

import numpy as np
from numpy.typing import NDArray

from synth.reference import guard

Array = NDArray[np.float64]
Columns = Mapping[str, NDArray[Any]]
AXES = ("y", "x", "z", "phi", "theta")
CURRENT = 7 / sqrt(2)  # A rms, 7 A peak, F section II
MAX_I_D = CURRENT * (1 - 1e-4)  # A rms: keeps sqrt(CURRENT^2 - i_d^2) away from 0
BAD_SAMPLES, GOOD_SAMPLES = 5, 4  # four good samples make up for a bad one
SLEW = 100.0 / 1000  # A in a sample
COMPENSATED = {"phi": 0.75, "theta": 0.95}  # the fraction of each guide spring that the corrected law compensates
BOX = {"y": (0.018, 0.031), "phi": (-0.003, 0.003), "theta": (-0.014, 0.014)}
ODD, EVEN = (0.0168, 0.0322), (0.0124, 0.0366)  # gaps of motors 1, 3 and 2, 4
LIMITS = {"y1": ODD, "y2": EVEN, "y3": ODD, "y4": EVEN, "x": (-0.1, 0.1), "z": (-0.1, 0.1)}
SENSORS = len(LIMITS)
NAMES = tuple(LIMITS)
for s in AXES:
    low, high = BOX.get(s, (-0.05, 0.05))
    margin = 50e-6 / (0.397 if s in ("phi", "theta") else 1.0)  # m, rad: 50 um at a motor
    LIMITS |= {f"{s}_ref": (low + margin, high - margin)}
LOW, HIGH = np.array([*LIMITS.values()]).T
SAFE = {"i_d1": 2.5, "i_d2": 2.5, "i_d3": 2.5, "i_d4": 2.5, "u_x": 0.0, "u_z": 0.0}
LAST = tuple(f"safe_output_last_{s}" for s in SAFE)
QUADRATURE = [5, 4, 5, 4]  # of SAFE: the thrust currents of motors 1 to 4
OUTPUTS = tuple(f"i_{axis}{j}" for axis in "dq" for j in (1, 2, 3, 4))


@dataclass(frozen=True)
class Parameters:
    """F table I; p counts poles, H_c stands for sigma_m, and the springs are torque over inertia."""

    t1: float = 0.01905  # m
    b0: float = 0.0127  # m
    W: float = 900.0
    k_w1: float = 1.0
    p: float = 6.0
    h_m: float = 0.005  # m
    L_A: float = 0.05  # m
    p_m: float = 4.0
    tau: float = 0.05715  # m
    tau_p: float = 0.02858  # m
    H_c: float = 875400.0  # A/m
    mu0: float = 4e-7 * pi  # H/m
    mu_rec: float = 1.0
    M_x: float = 10.6  # kg
    M_y: float = 6.9  # kg
    M_z: float = 8.6  # kg
    r: float = 0.397  # m
    I: float = 0.5268  # kg m^2
    k_s_phi: float = 15000.0  # 1/s^2
    k_s_theta: float = 3000.0  # 1/s^2
    G: float = 9.81  # m/s^2


@dataclass(frozen=True)
class Motor:
    """Coefficients of one motor's forces at its gap: a in N, b and h in N/A, c in N/A^2."""

    a: Array
    b: Array
    c: Array
    h: Array


def motor(g: Array, p: Parameters) -> Motor:
    """Return the force coefficients at a gap g in m. F(2)-(4), with csch^2 in L_v3."""
    k = pi / p.tau
    s, c = np.sinh(k * (p.h_m + g)), np.cosh(k * (p.h_m + g))
    slot = p.b0 / (2 * g)
    gamma = 4 / pi * (slot * np.arctan(slot) - 0.5 * np.log1p(slot**2))
    inverse_carter = 1 - g * gamma / p.t1
    leakage = 1 - p.b0**2 / (4 * p.t1 * (g + p.b0 / 2 + p.h_m / p.mu_rec))
    sheet = 4 / pi * p.mu0 * p.H_c * sin(pi * p.tau_p / (2 * p.tau)) * np.sinh(k * p.h_m)  # B_pmy1 sinh(k (h_m + g))
    area, turns = p.L_A * p.p_m, p.W * p.k_w1 / p.p
    return Motor(
        a=area * p.tau / (4 * p.mu0) * leakage * (sheet / s) ** 2,
        b=3 * sqrt(2) * area * turns * leakage * inverse_carter * sheet * c / s**2,
        c=18 * area * turns**2 * p.mu0 / p.tau * leakage * (inverse_carter / s) ** 2,
        h=3 * sqrt(2) * area * turns * leakage * inverse_carter * sheet / s,
    )


def guard_inputs(state: Columns, inputs: Columns) -> tuple[Array, dict[str, Array], NDArray[Any]]:
    """Return the values to use (11, n), the guard's next state and the fault word."""
    values, after, word = guard.standard(state, inputs, LIMITS, NAMES, BAD_SAMPLES, GOOD_SAMPLES)
    return np.array([*values.values()]), after, word


def safe_outputs(
    state: Columns, computed: Array, latched: NDArray[np.bool_], rests: NDArray[np.bool_] | bool = False
) -> tuple[dict[str, Array], dict[str, Array]]:
    """Return the currents of the motors and the last ones as next states; once latched they slew to SAFE, or to 0."""
    safe = {n: np.where(rests, 0.0, value) for n, value in SAFE.items()}
    out, after = guard.slew(state, dict(zip(SAFE, computed, strict=True)), latched, SLEW, safe)
    i_d, i_q = [out[f"i_d{j}"] for j in (1, 2, 3, 4)], [[*out.values()][k] for k in QUADRATURE]
    return dict(zip(OUTPUTS, (*i_d, *i_q), strict=True)), after


def pose(values: Array, r: float) -> Array:
    """Return y, x, z, phi and theta (5, n) from six encoders (6, n). F(5) inverted."""
    y1, y2, y3, y4, x, z = values
    phi, theta = np.arcsin((y3 - y1) / (2 * r)), np.arcsin((y2 - y4) / (2 * r))
    return np.array([(y1 + y2 + y3 + y4) / 4, x, z, phi, theta])


def limit_thrust(u: Array, first: Array, second: Array) -> Array:
    """Return thrust currents limited to sqrt(CURRENT^2 - i_d^2) of both of their motors. F section III."""
    limit = np.sqrt(CURRENT**2 - np.maximum(first**2, second**2))
    return np.clip(u, -limit, limit)
