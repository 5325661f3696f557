"""The precise maglev controller, one step of 1 ms: NumPy reference for the generated C.

    observer   q'' = a + d, with a one sample old:  q + alpha nu, v + beta nu, d + gamma nu, nu = q measured - q
    servo      w = k_e (q' - r) + k_de (v' - r_rate) + K eta - 0.8 d,  q', v' one sample ahead
    inversion  f_1 + f_2 + f_3 + f_4 = n, f_3 - f_1 = d, f_2 - f_4 = e with the least sum of (f_j / b_j)^2, and then
               b_j i - c_j i^2 = f_j for each motor, at the gaps one sample ahead

Constants come from `reference_gains`. The fault handling is that of both controllers of the stage.
"""

from dataclasses import dataclass
from functools import cache, partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from designs.maglev import reference_faults
from designs.maglev.reference_faults import T
from designs.maglev.reference_stage import (
    AXES,
    COMPENSATED,
    CURRENT,
    EVEN,
    MAX_I_D,
    ODD,
    Array,
    Columns,
    Parameters,
    limit_thrust,
    motor,
)
from designs.maglev_5dof_precise import reference_gains
from synth.reference import gains
from synth.reference.fault_handling import Probe
from synth.reference.guard import by_row, rows

WEIGHTS = ((1e6, 1e4), (1e5, 800.0), (1e5, 800.0), (1e5, 5e3), (3e5, 5e3))  # of e, e', for y, x, z, phi, theta
SPEEDS = ((6, 4, 4, 4), (5, 4, 4, 4), (5, 4, 4, 4), (4, 2), (6, 4, 4, 4))  # 1/s
BANDWIDTH = (400.0, 400.0, 400.0, 400.0, 250.0)  # rad/s
ERROR, FASTEST = (3e-4, 1e-3, 1e-3, 1e-4, 3e-4), (0.1, 0.3, 0.3, 0.1, 0.1)  # m, rad; m/s, rad/s
CANCELLED, MEMORY, DEMAND = 0.8, 4.0, 1e4
PROBE = Probe(quiet=12, quarter=1, step=2.2e-6, attempts=8, T=T, both_sides=True)
ETA = ("sum", "p1", "q1", "p2", "q2", "p3", "q3")  # of an axis with four modes; phi has the first two


@dataclass(frozen=True)
class Constants:
    """K (5, 9) on (e, e', eta) by axis, c (3,) of the internal models, and alpha, beta, gamma (5,) of the observers.

    K is 0 where an axis has fewer internal models.
    """

    K: Array
    c: Array
    alpha: Array
    beta: Array
    gamma: Array


@cache
def constants() -> Constants:
    """Return the constants."""
    pairs = list(zip(WEIGHTS, SPEEDS, strict=True))
    by_pair = {pair: reference_gains.on_eta(*pair) for pair in pairs}
    K = np.zeros((len(AXES), 2 + len(ETA)))
    for row, pair in zip(K, pairs, strict=True):
        row[: len(by_pair[pair])] = by_pair[pair]
    alpha, beta, gamma = np.array([gains.triple_pole(w, T) for w in BANDWIDTH]).T
    return Constants(K, reference_gains.coordinates(), alpha, beta, gamma)


def observe(state: Columns, q: Array, ready: NDArray[np.bool_], k: Constants) -> tuple[Array, Array, Array]:
    """Return position and rate one sample ahead and the disturbance, each (5, n)."""
    before, v, d = (rows(state, [f"observer_{s}_fast_{n}" for s in AXES]) for n in "qvd")
    nu, most = q - before, reference_faults.OBSERVERS.each("disturbance", q)
    low, high, rate = (reference_faults.OBSERVERS.each(n, q) for n in ("low", "high", "rate"))
    position = np.where(ready, before + by_row(k.alpha, q) * nu, q)
    v = np.where(ready, v + by_row(k.beta, q) * nu, 0.0)
    d = np.where(ready, np.clip(d + by_row(k.gamma, q) * nu, -most, most), 0.0)
    a = rows(state, [f"delay_{reference_faults.DEMANDS[s]}_last" for s in AXES]) + d
    return np.clip(position + T * (v + T / 2 * a), low, high), np.clip(v + T * a, -rate, rate), d


def currents(w: Array, ahead: Array) -> tuple[Array, Array]:
    """Return i_d1..i_d4, u_x, u_z (6, n) for the demands w at the pose `ahead`, and the accelerations of x and z."""
    p, (y, _, _, phi, theta) = Parameters(), ahead
    tilts = np.array([y - p.r * phi, y + p.r * theta, y + p.r * phi, y - p.r * theta])
    low, high = (by_row(ends, tilts) for ends in zip(ODD, EVEN, ODD, EVEN, strict=True))
    m = motor(np.clip(tilts, low, high), p)
    h = np.array([m.h[1] + m.h[3], m.h[0] + m.h[2]])
    masses = by_row((p.M_x, p.M_z), h)
    demanded = -masses * w[1:3] / h
    i_q = np.clip(demanded, -CURRENT, CURRENT)[[1, 0, 1, 0]]
    load = m.a + m.c * i_q**2
    n = p.M_y * (w[0] - p.G) + np.sum(load, axis=0)
    d = p.I / p.r * (w[3] + COMPENSATED["phi"] * p.k_s_phi * phi) + load[2] - load[0]
    e = p.I / p.r * (w[4] + COMPENSATED["theta"] * p.k_s_theta * theta) + load[1] - load[3]
    s1, s2, s3, s4 = 1 / m.b**2
    odd = ((s2 + s4) * n + (s2 - s4) * e - (s3 - s1) * d) / (s1 + s2 + s3 + s4)
    even = n - odd
    f = np.array([odd - d, even + e, odd + d, even - e]) / 2
    i_d = np.clip(2 * f / (m.b + np.sqrt(np.maximum(m.b**2 - 4 * m.c * f, 0))), -MAX_I_D, MAX_I_D)
    u = limit_thrust(demanded, i_d[[1, 0]], i_d[[3, 2]])
    return np.concatenate([i_d, u]), -u * h / masses


def law(
    state: Columns, q: Array, set_points: Array, ready: NDArray[np.bool_], k: Constants
) -> tuple[Array, reference_faults.Finish]:
    """Return the demands w (5, n) at a pose q, and the function that computes currents from the demands to use."""
    ahead, rate, d = observe(state, q, ready, k)
    error = by_row(ERROR, q)
    e = np.clip(q - set_points, -error, error)
    absent = np.zeros(np.shape(q)[1:])
    eta = np.array([[state.get(f"servo_{s}_fast_{n}", absent) for s in AXES] for n in ETA])
    moved = set_points - rows(state, [f"servo_{s}_fast_r" for s in AXES])
    step = np.where(np.abs(moved) <= by_row(FASTEST, q) * T, moved, 0.0)
    w = by_row(k.K[:, 0], q) * (ahead - set_points) + by_row(k.K[:, 1], q) * (rate - step / T) - CANCELLED * d
    w = w + sum(by_row(gain, q) * x for gain, x in zip(k.K[:, 2:].T, eta, strict=True))
    next_eta = [eta[0] + e]
    for j, (c, p, x) in enumerate(zip(k.c, eta[1::2], eta[2::2], strict=True), 1):
        next_eta += [p + c * x, x - (p + c * x) + by_row([j < len(of) for of in SPEEDS], q) * e]

    def finish(demands: Array, gaps: Array, last: Array) -> tuple[Array, Array, dict[str, Any]]:
        next = {"q": ahead, "v": rate, "d": d}
        after = {f"observer_{s}_fast_{n}": row for n, each in next.items() for s, row in zip(AXES, each, strict=True)}
        kept = np.where(np.sum(np.square(next_eta), axis=0) <= MEMORY**2, next_eta, eta)
        memory = zip((*ETA, "r"), (*kept, set_points), strict=True)
        after |= {f"servo_{s}_fast_{n}": row for n, each in memory for s, row in zip(AXES, each, strict=True)}
        return *currents(demands, ahead), {n: column for n, column in after.items() if n in state}

    return np.clip(w, -DEMAND, DEMAND), finish


def with_fault_handling(
    state: Columns, inputs: Columns, k: Constants | None = None
) -> tuple[dict[str, Array], dict[str, Array], NDArray[Any]]:
    """Return (next state, outputs, fault word) of one sample of the shipped controller, columns by name."""
    return reference_faults.step(state, inputs, partial(law, k=k or constants()), PROBE)
