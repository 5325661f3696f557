"""The maglev controller, one step of 1 ms, from F(1)-(17): NumPy reference for the generated C.

    motor   F_V = -a + b i_d - c (i_d^2 + i_q^2), F_H = -h i_q, with a, b, c, h > 0 functions of the gap     F(1)-(4)
    stage   M_y y'' = M_y G + sum_j F_Vj;  M_x x'' = F_H2 + F_H4;  M_z z'' = F_H1 + F_H3                     F(5)-(7)
            I phi'' = r (F_V3 - F_V1) - I k_phi phi;  I theta'' = r (F_V2 - F_V4) - I k_theta theta
    loop    xi' = Phi xi + N e + E (u_limited - u), w = K (e, e', xi), one copy an axis                      F(14)-(17)
    law     the currents for which y'', x'', z'', phi'', theta'' = w, by F(8) and F(12), each motor at its measured gap

The controller keeps eta, xi = T eta: after one sample sum+ = sum + e and, a rotation, p+ = p + c q, q+ = q - p+ + e.

Constants come from `reference_gains` and are rounded once. `step` takes scalars or columns (n,) of n independent
controllers; internally, axes, motors or currents are rows of one array. Lengths in m, angles in rad, currents
in A rms.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cache
from math import pi, sin, sqrt
from typing import Any

import numpy as np
from numpy.typing import NDArray

from designs.maglev_5dof import reference_gains

Array = NDArray[np.float64]
Columns = Mapping[str, NDArray[Any]]

AXES = ("y", "x", "z", "phi", "theta")
CURRENT = 7 / sqrt(2)  # A rms, 7 A peak, F section II
MAX_I_D = CURRENT * (1 - 1e-4)  # A rms: keeps sqrt(CURRENT^2 - i_d^2) away from 0
BAD_SAMPLES = 5
SLEW = 100.0 / 1000  # A in a sample
COMPENSATED = {"phi": 0.75, "theta": 0.95}  # the fraction of each guide spring that the corrected law compensates
BOX = {"y": (0.018, 0.031), "phi": (-0.003, 0.003), "theta": (-0.014, 0.014)}
ODD, EVEN = (0.0168, 0.0322), (0.0124, 0.0366)  # gaps of motors 1, 3 and 2, 4
LIMITS = {"y1": ODD, "y2": EVEN, "y3": ODD, "y4": EVEN, "x": (-0.1, 0.1), "z": (-0.1, 0.1)}
SENSORS = len(LIMITS)
LIMITS |= {f"{s}_ref": BOX.get(s, (-0.05, 0.05)) for s in AXES}
LOW, HIGH = np.array([*LIMITS.values()]).T
BITS = 1 << np.arange(len(LIMITS))
HELD = tuple(f"guard_last_{s}" for s in LIMITS)
ETA = ("sum", "p1", "q1")
ETA_BOUNDS = (600.0, 3.0, 600.0)
STATES = (*(f"filter_{{}}_{n}" for n in ("q_prev", "s", "r")), *(f"regulator_{{}}_{n}" for n in ETA))  # of an axis
MEMORY = tuple(name.format(s) for name in STATES for s in AXES)
SAFE = {"i_d1": 2.5, "i_d2": 2.5, "i_d3": 2.5, "i_d4": 2.5, "u_x": 0.0, "u_z": 0.0}
LAST = tuple(f"safe_output_last_{s}" for s in SAFE)
QUADRATURE = [5, 4, 5, 4]  # of SAFE: the thrust currents of motors 1 to 4
OUTPUTS = tuple(f"i_{axis}{j}" for axis in "dq" for j in (1, 2, 3, 4))
WEIGHTS = {"y": (3e4, 3e4, 2.5e9, 2.5e7, 2.5e7)}
WEIGHTS |= dict.fromkeys(("x", "z"), (1500.0, 1500.0, 4.5e8, 2.25e6, 2.25e6))
WEIGHTS |= dict.fromkeys(("phi", "theta"), (4e4, 4e4, 4e9, 4e7, 4e7))


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


@dataclass(frozen=True)
class Constants:
    """K (5, 5) on (e, e', eta) by axis; c and E (3,) of eta; fade, rho and h of the filter.

    `corrected` includes the squares of i_d that F(11) neglects.
    """

    parameters: Parameters
    K: Array
    c: float
    E: Array
    filter: tuple[float, float, float]
    corrected: bool = True


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


@cache
def constants(corrected: bool = True) -> Constants:
    """Return the constants; `corrected=False` is F(12) as printed."""
    model, filter = reference_gains.internal_model(), reference_gains.derivative_filter()
    K = np.array([model.in_eta(reference_gains.gain(WEIGHTS[s])) for s in AXES])
    return Constants(Parameters(), K, float(model.c), np.array([float(v) for v in model.E]), filter, corrected)


def rows(columns: Columns, names: Iterable[str]) -> Array:
    """Return some columns (n,) as the rows of one array (m, n)."""
    return np.array([columns[name] for name in names], dtype=np.float64)


def guard(state: Columns, inputs: Columns) -> tuple[Array, dict[str, Array], NDArray[Any]]:
    """Return the values to use (11, n), the guard's next state and the fault word. NaN is outside every range."""
    u = rows(inputs, LIMITS)
    with np.errstate(invalid="ignore"):
        good = ((u.T >= LOW) & (u.T <= HIGH)).T
    values = np.where(good, u, rows(state, HELD))
    complete = good[:SENSORS].all(axis=0)
    left = np.where(complete, BAD_SAMPLES, np.asarray(state["guard_left"]) - 1)
    after = dict(zip(HELD, values, strict=True))
    after["guard_left"] = np.maximum(left, 1)
    after["guard_latched"] = np.where(left < 1, 1, state["guard_latched"])
    after["guard_ready"] = np.where(complete, 1, state["guard_ready"])
    return values, after, np.asarray(BITS @ ~good + (1 << 31) * (after["guard_latched"] > 0)).astype(np.uint32)


def pose(values: Array, r: float) -> Array:
    """Return y, x, z, phi and theta (5, n) from six encoders (6, n). F(5) inverted."""
    y1, y2, y3, y4, x, z = values
    phi, theta = np.arcsin((y3 - y1) / (2 * r)), np.arcsin((y2 - y4) / (2 * r))
    return np.array([(y1 + y2 + y3 + y4) / 4, x, z, phi, theta])


def rate(e: Array, memory: Array, ready: NDArray[np.bool_], k: Constants) -> tuple[Array, list[Array]]:
    """Return the filtered derivatives of the errors e (5, n) and the next (q_prev, s, r), at rest until ready."""
    (fade, rho, h), (q_prev, before, r) = k.filter, memory
    faded = fade * before + np.where(ready, e - q_prev, 0.0)
    r = fade * r + faded + rho * before
    return h * r, [e, faded, r]


def demand(e: Array, v: Array, eta: Array, k: Constants) -> Array:
    """Return the demanded accelerations w = K (e, e', eta) (5, n). F(16)."""
    on_e, on_v, *on_eta = (gain * x.T for gain, x in zip(k.K.T, (e, v, *eta), strict=True))
    return np.asarray(on_e + on_v + sum(on_eta)).T


def model_step(e: Array, excess: Array, eta: Array, k: Constants) -> list[Array]:
    """Return the next eta, each (5, n); an entry that would leave its bounds is kept. F(14), (17)."""
    total = eta[0] + e + k.E[0] * excess
    p = eta[1] + k.c * eta[2] + k.E[1] * excess
    q = eta[2] - p + e + k.E[2] * excess
    return [np.where(np.abs(v) <= b, v, old) for v, old, b in zip((total, p, q), eta, ETA_BOUNDS, strict=True)]


def direct_currents(w: Array, pose: Array, m: Motor, load: Array, k: Constants) -> Array:
    """Return i_d1..i_d4 for the demands w at a pose, with `load` the upward forces in N that do not depend on them.

    The forces f_j = b_j i_dj have a given sum f, differences f3 - f1 = d and f2 - f4 = c, and the currents obey
    i_d1 + i_d3 = i_d2 + i_d4, which is F(8): one linear equation in f1 + f3. F(12).
    """
    p, (fraction_phi, fraction_theta) = k.parameters, COMPENSATED.values() if k.corrected else (1.0, 1.0)
    (w_y, _, _, w_phi, w_theta), (_, _, _, phi, theta) = w, pose
    f = p.M_y * (w_y - p.G) + sum(load)
    d = p.I / p.r * (w_phi + fraction_phi * p.k_s_phi * phi) + load[2] - load[0]
    c = p.I / p.r * (w_theta + fraction_theta * p.k_s_theta * theta) + load[1] - load[3]
    s1, s2, s3, s4 = 1 / m.b
    odd = ((s2 + s4) * f + (s2 - s4) * c - (s3 - s1) * d) / (s1 + s2 + s3 + s4)
    even = f - odd
    return np.array([s1 * (odd - d) / 2, s2 * (even + c) / 2, s3 * (odd + d) / 2, s4 * (even - c) / 2])


def limit_thrust(u: Array, first: Array, second: Array) -> Array:
    """Return thrust currents limited to sqrt(CURRENT^2 - i_d^2) of both of their motors. F section III."""
    limit = np.sqrt(CURRENT**2 - np.maximum(first**2, second**2))
    return np.clip(u, -limit, limit)


def currents(w: Array, q: Array, gaps: Array, before: Array, k: Constants) -> tuple[Array, Array]:
    """Return i_d1..i_d4, u_x, u_z (6, n) and by axis (5, n) u limited less u demanded. F(12), (17), levitation first.

    The attraction by i_q^2 and, for a `corrected` law, by i_d^2 is that of the currents `before`, one sample ago.
    """
    p, m = k.parameters, motor(gaps, k.parameters)
    squares = before[QUADRATURE] ** 2
    if k.corrected:
        squares = squares + before[:4] ** 2
    i_d = np.clip(direct_currents(w, q, m, m.a + m.c * squares, k), -MAX_I_D, MAX_I_D)
    first, second = [1, 0], [3, 2]  # motors 2 and 4 along x, 1 and 3 along z
    demanded = (-np.array([p.M_x, p.M_z]) * w[1:3].T).T / (m.h[first] + m.h[second])
    u = limit_thrust(demanded, i_d[first], i_d[second])
    excess = np.zeros_like(w)
    excess[1:3] = u - demanded
    return np.concatenate([i_d, u]), excess


def step(
    state: Columns, inputs: Columns, k: Constants | None = None
) -> tuple[dict[str, Array], dict[str, Array], NDArray[Any]]:
    """Return (next state, outputs, fault word) of one sample, columns by name. F(5), (8), (12), (14)-(17)."""
    k = k or constants()
    values, after, word = guard(state, inputs)
    ready, latched = np.asarray(state["guard_ready"]) > 0, after["guard_latched"] > 0
    memory, last = rows(state, MEMORY), rows(state, LAST)
    filters, eta = np.split(memory.reshape(len(STATES), len(AXES), *memory.shape[1:]), 2)
    q = pose(values[:SENSORS], k.parameters.r)
    e = q - values[SENSORS:]
    v, filtered = rate(e, filters, ready, k)
    w = demand(e, v, eta, k)
    computed, excess = currents(w, q, values[:4], last, k)
    next_memory = np.array([*filtered, *model_step(e, excess, eta, k)])
    after |= zip(MEMORY, np.where(latched, memory, next_memory.reshape(memory.shape)), strict=True)
    out = np.where(latched, np.clip([*SAFE.values()], last.T - SLEW, last.T + SLEW).T, computed)
    after |= zip(LAST, out, strict=True)
    return after, dict(zip(OUTPUTS, np.concatenate([out[:4], out[QUADRATURE]]), strict=True)), word
