"""Reference of the guarded estimators with protection levels in plain NumPy; N bodies advance one sample at a time.

    e = R(yaw) V - a B,   N = H'H + P,   d <- d + N^-1 (H'e - P (o + d)),   a the amplitude, P its prior

The Jacobian H is that of the prediction. Sensor k at fault: its two residuals are left out, by X = N^-1 H_k' and
S = 1 - H_k X. The test, the protection levels, the sweep of starts and the track follow from these. A hypothesis that
has passed during an exclusion counts in the levels until its own solution, not the linear one, has failed: while a
level is above its limit, every other sample solves for such a competing one, and the track goes on by its motion.

Sources: Kawato and Kim, "A Novel Multi-DOF Precision Positioning Methodology Using Two-Axis Hall-Effect Sensors",
section 3.B; Brown, "A Baseline GPS RAIM Scheme", Navigation 39 (1992).
"""

from dataclasses import dataclass
from functools import cache
from math import hypot, pi

import numpy as np
from scipy import optimize, stats

from designs.hall_position import reference_guard, reference_track
from designs.hall_position.reference_glsdc import Array, Columns, Setup, wrap

UNKNOWNS = ("phase_x", "phase_y", "yaw", "amplitude")
CONVERGENCE, WEAK, RANGE = 0.1, 1e-5, 500.0
DETECTABLE, ROUNDING, LEVEL_RANGE = 1e-3, 1e-5, 100.0
REFUTED = 2.0


@dataclass(frozen=True)
class Fit:
    """A fit of a sample: displacement d (N, 4), convergence, cost, deviations (N, 4), weakness."""

    at: Array
    converged: Array
    cost: Array
    deviations: Array
    weak: Array


@dataclass(frozen=True)
class Hypotheses:
    """Of all voltages: step, variances (N, 4) and cost; by sensor (N, sensors, ..): moves, added variances, costs."""

    step: Array
    variances: Array
    cost: Array
    moves: Array
    added: Array
    costs: Array
    detectable: Array
    in_range: Array


def scale(setup: Setup) -> float:
    """Return the standard deviation of a voltage."""
    return hypot(setup.deviation, setup.model_error)


def ranges(setup: Setup) -> tuple[Array, Array, Array]:
    """Return low and high ends of the unknowns, and their largest steps, (4,) each."""
    turn, spread = setup.yaw_range, setup.amplitude_range
    low, high = np.array([-pi, -pi, -turn, 1 - spread]), np.array([pi, pi, turn, 1 + spread])
    return low, high, np.array([setup.phase_step, setup.phase_step, setup.yaw_step, spread / 2])


def floors(setup: Setup) -> Array:
    """Return the least pivots (4,)."""
    largest = (setup.largest_phase, setup.largest_phase, setup.largest_yaw, setup.largest_amplitude)
    return np.asarray((scale(setup) / np.array(largest)) ** 2)


def prior(setup: Setup) -> Array:
    """Return the weights of the priors (4,)."""
    return np.array([0, 0, 0, (scale(setup) / setup.amplitude_prior) ** 2])


@cache
def thresholds(freedom: int, false_alarm: float, risk: float) -> tuple[float, float, float, float]:
    """Return T, L, k and T_1 of some degrees of freedom, two fewer without a sensor."""
    test = float(stats.chi2.isf(false_alarm, freedom))
    noncentrality = optimize.brentq(lambda v: stats.ncx2.cdf(test, freedom, v) - risk, 1e-9, 1e4)
    return test, float(noncentrality), float(stats.norm.isf(risk / 4)), float(stats.chi2.isf(risk / 2, freedom - 2))


def limits_of(setup: Setup) -> tuple[float, float, float, float]:
    """Return the thresholds of an estimator: its voltages and a prior, less four unknowns."""
    return thresholds(2 * len(setup.positions) + 1 - 4, setup.false_alarm, setup.risk)


def linearise(setup: Setup, q: Array, V: Array) -> tuple[Array, Array]:
    """Return residuals (N, m) and rows (N, m, 4) at unknowns (N, 4), of voltages (N, m / 2, 2)."""
    c, s, a = np.cos(q[:, 2]), np.sin(q[:, 2]), q[:, 3]
    e, H, zero = [], [], np.zeros(len(q))
    for k, place in enumerate(setup.positions):
        rx, ry = (setup.wave_number * v for v in place)
        Vx, Vy = c * V[:, k, 0] - s * V[:, k, 1], s * V[:, k, 0] + c * V[:, k, 1]
        px, py = q[:, 0] + rx * c - ry * s, q[:, 1] + ry * c + rx * s
        Bx, By, gx, gy = (f(setup, p) for f in (_field, _slope) for p in (px, py))
        e += [Vx - a * Bx, Vy - a * By]
        H += [np.stack([a * gx, zero, Vy + a * gx * (-rx * s - ry * c), Bx], axis=1)]
        H += [np.stack([zero, a * gy, -Vx + a * gy * (rx * c - ry * s), By], axis=1)]
    return np.stack(e, axis=1), np.stack(H, axis=1)


def _field(setup: Setup, phase: Array) -> Array:
    return np.asarray(setup.alpha * np.sin(phase) + setup.beta * np.sin(5 * phase))


def _slope(setup: Setup, phase: Array) -> Array:
    return np.asarray(setup.alpha * np.cos(phase) + 5 * setup.beta * np.cos(5 * phase))


def fit(setup: Setup, start: Array, V: Array, used: Array) -> Fit:
    """Return the fit from a prediction (N, 4); `used` (N, m) is 0 for the voltages that are left out."""
    low, high, steps = ranges(setup)
    P, o, at = prior(setup), start - [0, 0, 0, 1.0], np.zeros_like(start)
    e, rows = linearise(setup, start, V)
    H = used[:, :, None] * rows
    N = np.swapaxes(H, 1, 2) @ rows + np.diag(P)
    K = np.linalg.inv(N)
    for i in range(setup.corrections):
        if i:
            q = start + at
            q[:, 2:] = np.clip(q[:, 2:], low[2:], high[2:])
            e, _ = linearise(setup, q, V)
        gradient = np.einsum("nki,nk->ni", H, e) - P * (o + at)
        step = np.einsum("nij,nj->ni", K, gradient)
        decrease, cost = (gradient * step).sum(axis=1), (used * e**2).sum(axis=1) + (P * (o + at) ** 2).sum(axis=1)
        at = np.clip(at + step, -steps, steps)
    variances = np.diagonal(K, axis1=1, axis2=2)
    f, s = floors(setup), scale(setup)
    outside = ((rows**2).sum(axis=1) + P > RANGE**2 * f).any(axis=1)
    weak = outside | (variances >= (1 - WEAK) / f).any(axis=1)
    sigmas = np.minimum(s * np.sqrt(variances), s / np.sqrt(f))
    return Fit(
        at, np.asarray(decrease <= (CONVERGENCE * s) ** 2), np.maximum(cost - decrease, 0), sigmas, np.asarray(weak)
    )


def hypotheses(setup: Setup, start: Array, V: Array) -> Hypotheses:
    """Return the hypotheses that each sensor is at fault, linear about the prediction (N, 4)."""
    P, o = prior(setup), start - [0, 0, 0, 1.0]
    e, H = linearise(setup, start, V)
    N = np.swapaxes(H, 1, 2) @ H + np.diag(P)
    K = np.linalg.inv(N)
    gradient = np.einsum("nki,nk->ni", H, e) - P * o
    step = np.einsum("nij,nj->ni", K, gradient)
    cost = np.maximum((e**2).sum(axis=1) + (P * o**2).sum(axis=1) - np.einsum("ni,ni->n", gradient, step), 0)
    u, moves, added, costs, detectable = e - np.einsum("nki,ni->nk", H, step), [], [], [], np.ones(len(e), bool)
    for k in range(len(setup.positions)):
        pair = slice(2 * k, 2 * k + 2)
        X = K @ np.swapaxes(H[:, pair], 1, 2)
        S = np.eye(2) - H[:, pair] @ X
        first = np.maximum(S[:, 0, 0], DETECTABLE)
        mixing = S[:, 0, 1] / first
        second = np.maximum(S[:, 1, 1] - mixing * S[:, 0, 1], DETECTABLE)
        detectable &= np.minimum(first, second) * (1 - ROUNDING) > DETECTABLE
        x = np.stack([X[:, :, 0], X[:, :, 1] - mixing[:, None] * X[:, :, 0]], axis=2)
        v = np.stack([u[:, pair][:, 0], u[:, pair][:, 1] - mixing * u[:, pair][:, 0]], axis=1)
        d = np.stack([first, second], axis=1)
        moves.append(np.einsum("nij,nj->ni", x, v / d))
        added.append((x**2 / d[:, None]).sum(axis=2))
        costs.append(cost - (v**2 / d).sum(axis=1))
    diagonal = np.diagonal(N, axis1=1, axis2=2)
    return Hypotheses(
        step,
        np.diagonal(K, axis1=1, axis2=2),
        cost,
        np.stack(moves, axis=1),
        np.stack(added, axis=1),
        np.stack(costs, axis=1),
        detectable,
        np.asarray((diagonal <= RANGE**2 * floors(setup)).all(axis=1)),
    )


def passes(setup: Setup, of: Hypotheses, excluded: Array) -> Array:
    """Return which hypotheses (N, sensors) pass their test, or are in use."""
    in_use = excluded[:, None] == np.arange(1, len(setup.positions) + 1)
    passing = of.costs <= limits_of(setup)[3] * scale(setup) ** 2 + ROUNDING * of.cost[:, None]
    return np.asarray(passing | in_use)


def levels(setup: Setup, of: Hypotheses, fitted: Fit, excluded: Array, plausible: Array) -> Array:
    """Return the protection levels (N, 3) of both phases and the yaw, over `plausible` hypotheses (N, sensors)."""
    _, noncentrality, k, _ = limits_of(setup)
    s, three = scale(setup), slice(0, 3)
    detected = s * np.sqrt(noncentrality * of.added.max(axis=1)) + k * fitted.deviations
    counts = plausible[:, :, None]
    difference = np.where(counts, np.abs(of.step[:, None] - of.moves - fitted.at[:, None]), 0).max(axis=1)
    separated = difference + k * s * np.sqrt(of.variances + np.where(counts, of.added, 0).max(axis=1))
    separated *= setup.overbound
    level = np.where(excluded[:, None] == 0, detected, separated)[:, three]
    high = LEVEL_RANGE * limits(setup)
    return np.minimum(np.where(of.detectable[:, None], level, high), high)


def limits(setup: Setup) -> Array:
    """Return the limits of the protection levels (3,)."""
    along = setup.wave_number * setup.position_limit
    return np.array([along, along, setup.yaw_limit])


def step(setup: Setup, states: Columns, inputs: Columns) -> tuple[dict[str, Array], dict[str, Array], Array]:
    """Return next states, outputs and fault words (N,), states by their names in the C."""
    held, refused = reference_guard.hold_voltages(setup, states, inputs)
    next, word = reference_guard.advance(setup, states, held, refused)
    screened, rejected, counts = reference_track.screen(setup, states, held, refused)
    x = reference_guard.estimator_states(states)
    trial = (x["competing"] > 0) & (rejected == 0)
    excluded = np.where(rejected > 0, rejected, np.where(trial, x["competing"], x["excluded"]))
    start = np.stack([x[n] for n in UNKNOWNS], axis=1)
    start[:, :3] += np.stack([x[f"motion_{n}"] for n in UNKNOWNS[:3]], axis=1)
    start[:, :2] = wrap(start[:, :2])[0]
    start[:, 2] = np.clip(start[:, 2], -setup.yaw_range, setup.yaw_range)
    sensors = np.arange(1, len(setup.positions) + 1)
    used = np.repeat(excluded[:, None] != sensors, 2, axis=1).astype(float)
    fitted, of = fit(setup, start, held, used), hypotheses(setup, start, held)
    test, _, _, limit = limits_of(setup)
    s = scale(setup)
    passing = passes(setup, of, excluded)
    remembered = np.stack([x[f"plausible_{n}"] for n in sensors], axis=1) > 0
    level = levels(setup, of, fitted, excluded, passing | remembered)
    share = np.where(excluded == 0, 1.0, setup.excluded_limits)[:, None]
    within = of.detectable & (level <= share * limits(setup)).all(axis=1)
    passed = screened & ~fitted.weak & of.in_range & (fitted.cost <= np.where(excluded == 0, test, limit) * s**2)
    best = np.where(of.cost <= test * s**2, 0, 1 + of.costs.argmin(axis=1))
    contested = (excluded > 0) & (rejected == 0) & ((passing | remembered).sum(axis=1) > 1) & ~within
    doubted = trial | contested
    low, high, _ = ranges(setup)
    pose = start + fitted.at
    pose[:, :2] = wrap(pose[:, :2])[0]
    pose[:, 2:] = np.clip(pose[:, 2:], low[2:], high[2:])
    pose = np.where(trial[:, None], start, pose)
    complete = (excluded == 0) | (not setup.all_sensors)
    accepted = passed & ~trial
    watched = np.where(trial, x["excluded"], best)
    sample = reference_track.Sample(start, pose, fitted.at, fitted.converged, accepted, complete, watched)
    after, tracking, lost = reference_track.advance(setup, x, sample)
    valid = fitted.converged & accepted & within & tracking & ~lost
    refuted = trial & (fitted.cost > REFUTED * limit * s**2)
    keeps = tracking & (watched > 0) & (excluded > 0) & (rejected == 0)
    for j, n in enumerate(sensors):
        kept = np.where(trial, remembered[:, j] & ~(refuted & (x["competing"] == n)), passing[:, j] | remembered[:, j])
        after[f"plausible_{n}"] = keeps & kept
    competing_costs = np.where(remembered & ~passing, of.costs, 0.0)
    after["competing"] = (
        keeps * (contested & ~trial & (competing_costs > 0).any(axis=1)) * (1 + competing_costs.argmax(axis=1))
    )
    position, after_metres = reference_track.metres(setup, states, pose, tracking)
    valid &= (np.abs(np.stack([after_metres[f"metres_pitch_{a}"] for a in "xy"])) <= setup.pitches).all(axis=0)
    output = position | {"yaw": pose[:, 2], "amplitude": pose[:, 3], "protection_yaw": level[:, 2]}
    for i, axis in enumerate("XY"):
        output |= {f"deviation_{axis}": fitted.deviations[:, i], f"protection_{axis}": level[:, i]}
        output |= {n: output[n] / setup.wave_number for n in (f"deviation_{axis}", f"protection_{axis}")}
    output |= {f"deviation_{n}": fitted.deviations[:, i] for i, n in ((2, "yaw"), (3, "amplitude"))}
    output |= {"chi_square": fitted.cost / s**2, "converged": fitted.converged, "weak": fitted.weak, "valid": valid}
    output |= {
        "excluded": np.where(trial, x["excluded"], excluded),
        "doubted": doubted,
        "tracking": tracking,
        "lost": lost,
    }
    next |= counts | after_metres | {f"{reference_guard.PREFIX}{n}": v for n, v in after.items()}
    return next, {n: 1.0 * v for n, v in output.items()}, word
