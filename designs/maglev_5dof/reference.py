"""The maglev controller, one step of 1 ms, in NumPy from F(1)-(17): the witness against which generated C is held.

    motor   F_V = -a + b i_d - c (i_d^2 + i_q^2), F_H = -h i_q, with a, b, c, h > 0 functions of the gap     F(1)-(4)
    stage   M_y y'' = M_y G + sum_j F_Vj;  M_x x'' = F_H2 + F_H4;  M_z z'' = F_H1 + F_H3                     F(5)-(7)
            I phi'' = r (F_V3 - F_V1) - I k_phi phi;  I theta'' = r (F_V2 - F_V4) - I k_theta theta
    loop    xi' = Phi xi + N e + E (u_limited - u), w = K (e, e', xi), one copy an axis                      F(14)-(17)
    law     the currents for which y'', x'', z'', phi'', theta'' = w, by F(8) and F(12), each motor at its measured gap

The controller keeps xi = T eta, where one sample is sum' = sum + e and a rotation p' = p + c q, q' = q - p' + e.

Gains solve the Riccati equation in exact arithmetic and are rounded once. Every step function takes scalars or arrays
(n,) of n independent controllers. Lengths in m, angles in rad, currents in A rms.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from math import pi, sin, sqrt
from typing import Any

import mpmath  # type: ignore[import-untyped]
import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import linalg

Array = NDArray[np.float64]
Columns = Mapping[str, NDArray[Any]]
Rational = NDArray[np.object_]

PERIOD = Fraction(1, 1000)  # s
AXES = ("y", "x", "z", "phi", "theta")
MOTORS = (1, 2, 3, 4)
CURRENT = 7 / sqrt(2)  # A rms, 7 A peak, F section II
DIRECT = CURRENT * (1 - 1e-4)  # the limit of i_d
FILTER = 1000  # rad/s
OMEGA0 = 1.5 * pi  # rad/s, F section IV-B
ANTI_WINDUP = 7e-5  # each entry of E_x = E_z, F section IV-A
BAD_SAMPLES = 5
SLEW = 100.0  # A/s
COMPENSATED = {"phi": 0.75, "theta": 0.95}  # the part of each guide spring that the restored law cancels
BOX = {"y": (0.018, 0.031), "phi": (-0.003, 0.003), "theta": (-0.014, 0.014)}
ODD, EVEN = (0.0168, 0.0322), (0.0124, 0.0366)  # gaps of motors 1, 3 and 2, 4
LIMITS = {"y1": ODD, "y2": EVEN, "y3": ODD, "y4": EVEN, "x": (-0.1, 0.1), "z": (-0.1, 0.1)}
MEASUREMENTS = tuple(LIMITS)
LIMITS |= {f"{s}_ref": BOX.get(s, (-0.05, 0.05)) for s in AXES}
ETA = ("sum", "p1", "q1")
ETA_BOUNDS = (600.0, 3.0, 600.0)
SAFE = {"i_d1": 2.5, "i_d2": 2.5, "i_d3": 2.5, "i_d4": 2.5, "u_x": 0.0, "u_z": 0.0}
THRUSTS = ("u_z", "u_x", "u_z", "u_x")  # of motors 1 to 4
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

    def vertical(self, i_d: Array, i_q: Array) -> Array:
        """Return F_V in N, downwards positive. F(2)."""
        return -self.a + self.b * i_d - self.c * (i_d**2 + i_q**2)


@dataclass(frozen=True)
class Constants:
    """What is rounded once: K (5,) on (e, e', eta) an axis; c and E (3,) of eta; fade, rho and h of the filter; the
    ranges of the inputs. `restored` puts back the squares of i_d that F(11) drops.
    """

    parameters: Parameters
    K: Mapping[str, Array]
    c: float
    E: Array
    filter: Array
    limits: Mapping[str, Array]
    restored: bool = True


def motor(g: Array, p: Parameters) -> Motor:
    """Return the force coefficients at a gap g in m. F(2)-(4), with csch^2 in L_v3."""
    k = pi / p.tau
    s, c = np.sinh(k * (p.h_m + g)), np.cosh(k * (p.h_m + g))
    slot = p.b0 / (2 * g)
    gamma = 4 / pi * (slot * np.arctan(slot) - 0.5 * np.log1p(slot**2))
    inverse_carter = 1 - g * gamma / p.t1
    leak = 1 - p.b0**2 / (4 * p.t1 * (g + p.b0 / 2 + p.h_m / p.mu_rec))
    sheet = 4 / pi * p.mu0 * p.H_c * sin(pi * p.tau_p / (2 * p.tau)) * np.sinh(k * p.h_m)  # B_pmy1 sinh(k (h_m + g))
    area, turns = p.L_A * p.p_m, p.W * p.k_w1 / p.p
    return Motor(
        a=area * p.tau / (4 * p.mu0) * leak * (sheet / s) ** 2,
        b=3 * sqrt(2) * area * turns * leak * inverse_carter * sheet * c / s**2,
        c=18 * area * turns**2 * p.mu0 / p.tau * leak * (inverse_carter / s) ** 2,
        h=3 * sqrt(2) * area * turns * leak * inverse_carter * sheet / s,
    )


def motors(y: Array, phi: Array, theta: Array, p: Parameters) -> list[Motor]:
    """Return the four motors at a pose. F(5)."""
    tilt, roll = p.r * np.sin(phi), p.r * np.sin(theta)
    return [motor(g, p) for g in (y - tilt, y + roll, y + tilt, y - roll)]


def plant(state: Array, currents: Array, p: Parameters) -> Array:
    """Return the derivative of x1..x10 (10, ...) under i_d1..i_d4, i_q1..i_q4 (8, ...). F(6)-(7), F table II."""
    y, v_y, _, v_x, _, v_z, phi, v_phi, theta, v_theta = state
    m, i_q = motors(y, phi, theta, p), currents[4:]
    F = [m[j].vertical(currents[j], i_q[j]) for j in range(4)]
    x = -(m[1].h * i_q[1] + m[3].h * i_q[3]) / p.M_x
    z = -(m[0].h * i_q[0] + m[2].h * i_q[2]) / p.M_z
    tilt = p.r * (F[2] - F[0]) / p.I - p.k_s_phi * phi
    roll = p.r * (F[1] - F[3]) / p.I - p.k_s_theta * theta
    return np.stack([v_y, p.G + sum(F) / p.M_y, v_x, x, v_z, z, v_phi, tilt, v_theta, roll])


def rational(rows: Iterable[Iterable[float | Fraction]]) -> Rational:
    """Return a matrix of exact fractions from rows of floats or fractions."""
    return np.array([[Fraction(v) for v in row] for row in rows], dtype=object)


def _float(A: Rational) -> Array:
    return A.astype(np.float64)


def internal_model() -> Rational:
    """Return Phi (3, 3). F(15)."""
    return rational([[0, 1, 0], [0, 0, 1], [0, -(Fraction(OMEGA0) ** 2), 0]])


def regulated() -> tuple[Rational, Rational]:
    """Return (A, B) of (e, e', xi1, xi2, xi3) under w. F(13)-(15)."""
    A = rational(np.zeros((5, 5)))
    A[0, 1] = A[4, 0] = Fraction(1)
    A[2:, 2:] = internal_model()
    return A, rational([[0], [1], [0], [0], [0]])


def riccati(A: Rational, B: Rational, Q: Rational) -> Rational:
    """Return X of A'X + XA - XBB'X + Q = 0, from SciPy's by defect correction with exact residuals.

    Each pass is a Newton-Kleinman step: (A - BB'X)' D + D (A - BB'X) = -residual(X), X <- X + D.
    """
    X = rational(linalg.solve_continuous_are(_float(A), _float(B), _float(Q), np.eye(B.shape[1])))
    X = (X + X.T) / 2
    for _ in range(4):
        XB = X.dot(B)
        defect = A.T.dot(X) + X.dot(A) - XB.dot(XB.T) + Q
        closed = _float(A - B.dot(XB.T))
        D = rational(linalg.solve_continuous_lyapunov(closed.T, -_float(defect)))
        X = X + (D + D.T) / 2
    return X


def gain(weights: Sequence[float]) -> Array:
    """Return K (5,) of w = K (e, e', xi) that minimises the integral of z' diag(weights) z + w^2. F(16)."""
    A, B = regulated()
    return -_float(B.T.dot(riccati(A, B, rational(np.diag(weights)))))[0]


@dataclass(frozen=True)
class Turning:
    """One sample of the internal model in eta = (sum, p, q), T of xi = T eta, and what E adds to eta; 60 digits."""

    c: mpmath.mpf
    T: mpmath.matrix
    E: mpmath.matrix


def turning() -> Turning:
    """Return the internal model of one period in eta. F(14), (15), (17).

    Both forms are driven by e alone, so that (N, Phi N, Phi^2 N) = T (B, A B, A^2 B). The anti-windup enters p before
    q is computed from it.
    """
    with mpmath.workdps(60):
        M = mpmath.zeros(5)
        for i, row in enumerate(internal_model()):
            M[i, 4] = mpmath.mpf(ANTI_WINDUP)
            for j, entry in enumerate(row):
                M[i, j] = mpmath.mpf(entry.numerator) / entry.denominator
        M[2, 3] = 1
        held = mpmath.expm(M * mpmath.mpf(PERIOD.numerator) / PERIOD.denominator)
        c = 3 - held[0, 0] - held[1, 1] - held[2, 2]  # the trace of a rotation by w T is 2 cos(w T)
        A = mpmath.matrix([[1, 0, 0], [0, 1, c], [0, -1, 1 - c]])
        T = _driven(held[:3, :3], held[:3, 3]) * mpmath.inverse(_driven(A, mpmath.matrix([1, 0, 1])))
        E = mpmath.lu_solve(T, held[:3, 4])
        E[2] += E[1]
        return Turning(c, T, E)


def _driven(A: mpmath.matrix, B: mpmath.matrix) -> mpmath.matrix:
    columns = [B, A * B, A * A * B]
    return mpmath.matrix([[column[i] for column in columns] for i in range(3)])


def derivative_filter() -> tuple[float, float, float]:
    """Return fade, rho, h of s <- fade s + d, r <- fade r + s + rho s_before, v = h r, d = q - q_prev. F section III.

    It is v = s w^2/(s+w)^2 q with q a ramp between samples, exactly. A unit step of q answers with w^2 t exp(-w t); the
    ramp from 0 to 1 over one period T with 1/T times the integral of it, and the sum over all samples of v is 1/T.
    """
    with mpmath.workdps(60):
        T = mpmath.mpf(PERIOD.numerator) / PERIOD.denominator
        wT = FILTER * T
        fade = mpmath.exp(-wT)
        h = (1 - (1 + wT) * fade) / T
        return float(fade), float((1 - fade) ** 2 / (h * T) - 1), float(h)


@cache
def constants(
    scalar: type[np.floating] = np.float64, restored: bool = True, parameters: Parameters | None = None
) -> Constants:
    """Return the constants, rounded to `scalar` and held in double; `restored=False` is F(12) as printed."""

    def rounded(A: ArrayLike) -> Array:
        out = np.asarray(A, dtype=scalar).astype(np.float64)
        out.flags.writeable = False
        return out

    model = turning()
    by_weights = {q: rounded(in_eta(gain(q), model)) for q in set(WEIGHTS.values())}
    K = {s: by_weights[WEIGHTS[s]] for s in AXES}
    limits = {s: rounded(bounds) for s, bounds in LIMITS.items()}
    c, E, filter = float(rounded(float(model.c))), rounded([float(v) for v in model.E]), rounded(derivative_filter())
    return Constants(parameters or Parameters(), K, c, E, filter, limits, restored)


def in_eta(K: Array, model: Turning) -> Array:
    """Return K (5,) on (e, e', eta) from K on (e, e', xi)."""
    with mpmath.workdps(60):
        turned = mpmath.matrix([K[2:].tolist()]) * model.T
        return np.array([K[0], K[1], *(float(turned[0, j]) for j in range(3))])


def initial_state() -> dict[str, Array]:
    """Return the state after init, by name."""
    state: dict[str, float] = {f"guard_last_{s}": 0.031 if s[0] == "y" else 0.0 for s in LIMITS}
    state |= {"guard_left": BAD_SAMPLES, "guard_latched": 0, "guard_ready": 0}
    for s in AXES:
        state |= dict.fromkeys([f"filter_{s}_{n}" for n in ("q_prev", "s", "r")], 0.0)
        state |= dict.fromkeys([f"regulator_{s}_{n}" for n in ETA], 0.0)
    state |= {f"safe_output_last_{s}": value for s, value in SAFE.items()}
    return {name: np.array(value, dtype=np.float64) for name, value in state.items()}


def guard(state: Columns, inputs: Columns, limits: Columns) -> tuple[dict[str, Array], dict[str, Array], NDArray[Any]]:
    """Return the values to use, the guard's next state and the fault word. A value that is no number is in no range."""
    with np.errstate(invalid="ignore"):
        given = {s: np.asarray(inputs[s], dtype=np.float64) for s in limits}
        good = {s: (given[s] >= low) & (given[s] <= high) for s, (low, high) in limits.items()}
    values = {s: np.where(good[s], given[s], state[f"guard_last_{s}"]) for s in limits}
    after = {f"guard_last_{s}": value for s, value in values.items()}
    word = np.sum([np.where(good[s], 0, 1 << bit) for bit, s in enumerate(limits)], axis=0)
    complete = np.all([good[s] for s in MEASUREMENTS], axis=0)
    left = np.where(complete, BAD_SAMPLES, np.asarray(state["guard_left"]) - 1)
    after["guard_left"] = np.maximum(left, 1)
    after["guard_latched"] = np.where(left < 1, 1, state["guard_latched"])
    after["guard_ready"] = np.where(complete, 1, state["guard_ready"])
    return values, after, np.asarray(word + (1 << 31) * (after["guard_latched"] > 0)).astype(np.uint32)


def pose(v: Columns, r: float) -> dict[str, Array]:
    """Return y, x, z, phi and theta from six encoders. F(5) inverted."""
    phi, theta = np.arcsin((v["y3"] - v["y1"]) / (2 * r)), np.arcsin((v["y2"] - v["y4"]) / (2 * r))
    return {"y": (v["y1"] + v["y2"] + v["y3"] + v["y4"]) / 4, "x": v["x"], "z": v["z"], "phi": phi, "theta": theta}


def rate(s: str, e: Array, state: Columns, k: Constants) -> tuple[Array, dict[str, Array]]:
    """Return the filtered derivative of the error e of axis s and the filter's next state, at rest until ready."""
    fade, rho, h = k.filter
    before = state[f"filter_{s}_s"]
    faded = fade * before + np.where(np.asarray(state["guard_ready"]) > 0, e - state[f"filter_{s}_q_prev"], 0.0)
    r = fade * state[f"filter_{s}_r"] + faded + rho * before
    return h * r, {f"filter_{s}_{name}": value for name, value in (("q_prev", e), ("s", faded), ("r", r))}


def demand(s: str, e: Array, v: Array, state: Columns, k: Constants) -> Array:
    """Return the demanded acceleration w = K (e, e', eta) of axis s. F(16)."""
    K = k.K[s]
    return K[0] * e + K[1] * v + sum(K[2 + n] * state[f"regulator_{s}_{name}"] for n, name in enumerate(ETA))


def model_step(s: str, e: Array, excess: Array | float, state: Columns, k: Constants) -> dict[str, Array]:
    """Return the next eta of axis s; an entry that would leave its bounds stays as it is. F(14), (17)."""
    now = [np.asarray(state[f"regulator_{s}_{name}"], dtype=np.float64) for name in ETA]
    total = now[0] + e + k.E[0] * excess
    p = now[1] + k.c * now[2] + k.E[1] * excess
    q = now[2] - p + e + k.E[2] * excess
    kept = [np.where(np.abs(v) <= b, v, old) for v, old, b in zip((total, p, q), now, ETA_BOUNDS, strict=True)]
    return {f"regulator_{s}_{name}": v for name, v in zip(ETA, kept, strict=True)}


def direct_currents(w: Columns, at: Columns, m: list[Motor], load: list[Array], k: Constants) -> list[Array]:
    """Return i_d1..i_d4 for the demands w at a pose, with `load` the upward forces in N that do not depend on them.

    The forces f_j = b_j i_dj have a given sum f, differences f3 - f1 = d and f2 - f4 = c, and the currents obey
    i_d1 + i_d3 = i_d2 + i_d4, which is F(8): one linear equation in f1 + f3. F(12).
    """
    p, part = k.parameters, COMPENSATED if k.restored else {"phi": 1.0, "theta": 1.0}
    f = p.M_y * (w["y"] - p.G) + sum(load)
    d = p.I / p.r * (w["phi"] + part["phi"] * p.k_s_phi * at["phi"]) + load[2] - load[0]
    c = p.I / p.r * (w["theta"] + part["theta"] * p.k_s_theta * at["theta"]) + load[1] - load[3]
    s1, s2, s3, s4 = (1 / one.b for one in m)
    odd = ((s2 + s4) * f + (s2 - s4) * c - (s3 - s1) * d) / (s1 + s2 + s3 + s4)
    even = f - odd
    return [s1 * (odd - d) / 2, s2 * (even + c) / 2, s3 * (odd + d) / 2, s4 * (even - c) / 2]


def limited(u: Array, first: Array, second: Array) -> Array:
    """Return a thrust current within what the direct currents of its two motors leave of CURRENT. F section III."""
    room = np.sqrt(CURRENT**2 - np.maximum(first**2, second**2))
    return np.clip(u, -room, room)


def currents(
    w: Columns, q: Columns, gaps: list[Array], before: Columns, k: Constants
) -> tuple[dict[str, Array], dict[str, Array]]:
    """Return i_d1..i_d4, u_x, u_z and, of x and z, u limited less u demanded. F(12), (17), levitation first.

    The attraction by i_q^2 and, where the law is `restored`, by i_d^2 is that of the currents `before`, one sample ago.
    """
    p = k.parameters
    m = [motor(g, p) for g in gaps]
    squares = [before[u] ** 2 for u in THRUSTS]
    if k.restored:
        squares = [i_q + before[f"i_d{j}"] ** 2 for j, i_q in zip(MOTORS, squares, strict=True)]
    load = [one.a + one.c * square for one, square in zip(m, squares, strict=True)]
    i_d = [np.clip(i, -DIRECT, DIRECT) for i in direct_currents(w, q, m, load, k)]
    demanded = {"x": -p.M_x * w["x"] / (m[1].h + m[3].h), "z": -p.M_z * w["z"] / (m[0].h + m[2].h)}
    u = {"x": limited(demanded["x"], i_d[1], i_d[3]), "z": limited(demanded["z"], i_d[0], i_d[2])}
    out = {f"i_d{j}": i for j, i in zip(MOTORS, i_d, strict=True)} | {f"u_{s}": value for s, value in u.items()}
    return out, {s: u[s] - demanded[s] for s in u}


def slewed(computed: Columns, state: Columns, latched: Array) -> dict[str, Array]:
    """Return the currents: as computed, or once latched on a slew from the last ones to the safe ones."""
    out, reach = {}, SLEW * float(PERIOD)
    for s, target in SAFE.items():
        last = state[f"safe_output_last_{s}"]
        out[s] = np.where(latched > 0, np.clip(target, last - reach, last + reach), computed[s])
    return out


def step(
    state: Columns, inputs: Columns, k: Constants | None = None
) -> tuple[dict[str, Array], dict[str, Array], NDArray[Any]]:
    """Return (next state, outputs, fault word) of one sample, columns by name. F(5), (8), (12), (14)-(17)."""
    k = k or constants()
    values, after, word = guard(state, inputs, k.limits)
    q = pose(values, k.parameters.r)
    e = {s: q[s] - values[f"{s}_ref"] for s in AXES}
    w = {}
    for s in AXES:
        v, filtered = rate(s, e[s], state, k)
        after |= filtered
        w[s] = demand(s, e[s], v, state, k)
    gaps = [values[f"y{j}"] for j in MOTORS]
    before = {s: state[f"safe_output_last_{s}"] for s in SAFE}
    computed, excess = currents(w, q, gaps, before, k)
    for s in AXES:
        after |= model_step(s, e[s], excess.get(s, 0.0), state, k)
    latched = after["guard_latched"]
    still = [name for name in after if not name.startswith("guard_")]
    after |= {name: np.where(latched > 0, state[name], after[name]) for name in still}
    out = slewed(computed, state, latched)
    after |= {f"safe_output_last_{s}": i for s, i in out.items()}
    motors = {f"i_d{j}": out[f"i_d{j}"] for j in MOTORS} | {f"i_q{j}": out[THRUSTS[j - 1]] for j in MOTORS}
    return after, motors, word
