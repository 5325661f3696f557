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

from dataclasses import dataclass
from functools import cache, partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from designs.maglev import reference_faults
from designs.maglev.reference_stage import (
    AXES,
    COMPENSATED,
    LAST,
    MAX_I_D,
    QUADRATURE,
    SENSORS,
    Array,
    Columns,
    Motor,
    Parameters,
    guard_inputs,
    limit_thrust,
    motor,
    pose,
    safe_outputs,
)
from designs.maglev_5dof import reference_gains
from synth.reference.guard import frozen, rows

ETA = ("sum", "p1", "q1")
ETA_BOUNDS = (600.0, 3.0, 600.0)
STATES = (*(f"filter_{{}}_{n}" for n in ("q_prev", "s", "r")), *(f"regulator_{{}}_{n}" for n in ETA))  # of an axis
MEMORY = tuple(name.format(s) for name in STATES for s in AXES)
WEIGHTS = {"y": (3e4, 3e4, 2.5e9, 2.5e7, 2.5e7)}
WEIGHTS |= dict.fromkeys(("x", "z"), (1500.0, 1500.0, 4.5e8, 2.25e6, 2.25e6))
WEIGHTS |= dict.fromkeys(("phi", "theta"), (4e4, 4e4, 4e9, 4e7, 4e7))


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


@cache
def constants(corrected: bool = True) -> Constants:
    """Return the constants; `corrected=False` is F(12) as printed."""
    model, filter = reference_gains.internal_model(), reference_gains.derivative_filter()
    K = np.array([reference_gains.on_eta(WEIGHTS[s]) for s in AXES])
    return Constants(Parameters(), K, float(model.c), np.array([float(v) for v in model.E]), filter, corrected)


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


def law(
    state: Columns, q: Array, set_points: Array, ready: NDArray[np.bool_], k: Constants
) -> tuple[Array, reference_faults.Finish]:
    """Return the demands w (5, n) at a pose q, and the function that computes currents from the demands to use."""
    memory = rows(state, MEMORY)
    filters, eta = np.split(memory.reshape(len(STATES), len(AXES), *memory.shape[1:]), 2)
    e = q - set_points
    v, filtered = rate(e, filters, ready, k)

    def finish(w: Array, gaps: Array, last: Array) -> tuple[Array, Array, dict[str, Any]]:
        computed, excess = currents(w, q, gaps, last, k)
        p, h = k.parameters, motor(gaps, k.parameters).h
        thrust = np.array([-computed[4] * (h[1] + h[3]) / p.M_x, -computed[5] * (h[0] + h[2]) / p.M_z])
        next_memory = np.array([*filtered, *model_step(e, excess, eta, k)])
        return computed, thrust, dict(zip(MEMORY, next_memory.reshape(memory.shape), strict=True))

    return demand(e, v, eta, k), finish


def with_fault_handling(
    state: Columns, inputs: Columns, k: Constants | None = None
) -> tuple[dict[str, Array], dict[str, Array], NDArray[Any]]:
    """Return (next state, outputs, fault word) of one sample of the shipped controller, columns by name."""
    return reference_faults.step(state, inputs, partial(law, k=k or constants()))


def step(
    state: Columns, inputs: Columns, k: Constants | None = None
) -> tuple[dict[str, Array], dict[str, Array], NDArray[Any]]:
    """Return (next state, outputs, fault word) of one sample, columns by name. F(5), (8), (12), (14)-(17)."""
    k = k or constants()
    values, after, word = guard_inputs(state, inputs)
    ready, latched = np.asarray(state["guard_ready"]) > 0, after["guard_latched"] > 0
    last = rows(state, LAST)
    w, finish = law(state, pose(values[:SENSORS], k.parameters.r), values[SENSORS:], ready, k)
    computed, _, next_memory = finish(w, values[:4], last)
    outputs, slewed = safe_outputs(state, computed, latched)
    return after | frozen(state, next_memory, latched) | slewed, outputs, word
