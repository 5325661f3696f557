"""The estimator of (X, Y, yaw) from the paper's equations in plain NumPy, for comparison.

Kawato and Kim, "Multi-Degree-of-Freedom Precision Position Sensing", (2), section 3.B and Fig. 9. For each sensor, with
c, s of the yaw and d the derivative of its place P by the yaw, its two voltages and their Jacobian are

    [ a ]   [  c  s ] [ B_X ]        [  c g_X   s g_Y   -s B_X + c B_Y + c g_X d_X + s g_Y d_Y ]
    [ b ] = [ -s  c ] [ B_Y ]   H =  [ -s g_X   c g_Y   -c B_X - s B_Y - s g_X d_X + c g_Y d_Y ]    g = dB/dX, V/m

in m and rad about the middle of the sensors. Sines are NumPy's, of 5 w X as of w X.
"""

from dataclasses import dataclass
from functools import partial
from math import pi, sqrt

import numpy as np

from designs.hall_position import reference_glsdc as glsdc
from designs.hall_position.reference_glsdc import Array, Columns, Fit, Problem, Setup, wrap

ROUNDING = 2e-6  # of the cost
SUSPECT = 2  # samples
CONTRAST = 25  # of squared residuals
INCONSISTENT = 4.0  # deviations, rms
MORE = 4  # times setup.certain, of more than two sensors
POSE, MOTION = ("phase_x", "phase_y", "yaw"), ("motion_x", "motion_y", "motion_yaw")


@dataclass(frozen=True)
class Judgement:
    """Of a sample (N,): whether it has a residual fault, voltages that do not fit each other, is damped, or valid.

    `unambiguous`: no other place reads the same, so far as this sample says.
    """

    fault: Array
    inconsistent: Array
    damped: Array
    good: Array
    unambiguous: Array


def is_redundant(of: Setup) -> bool:
    """Return whether a sensor can be left out."""
    return len(of.positions) > 2


def middle(of: Setup) -> Array:
    """Return where the correction is made in the body, m."""
    return np.asarray(np.mean(of.positions, axis=0))


def damping(of: Setup) -> Array:
    """Return the damping's root by X, Y and yaw, V/m and V/rad, of a yaw that is damped no more than they are."""
    w, arms = 2 * pi / of.pitch, np.array(of.positions) - middle(of)
    arm = w * sqrt((arms**2).sum() / len(of.positions))
    return np.asarray(sqrt(of.damping) * of.alpha * np.array([w, w, arm]))


def problem(of: Setup) -> Problem:
    """Return the problem; a sample may move a sensor's phase by no more than the reach."""
    w, arms = 2 * pi / of.pitch, np.array(of.positions) - middle(of)
    arm, half = w * np.abs(arms).sum(axis=1).max(), of.reach / 2
    bounds = np.array([half / w, half / w, (sqrt(arm**2 + 2 * arm * half) - arm) / arm])
    return Problem(
        POSE,
        MOTION if of.follow else (),
        partial(linearise, of, arms),
        damping(of) * [1, 1, of.firm],
        bounds,
        np.array([w, w, 1]),
        (slice(2, 3), slice(0, 2)),
        of.iterations,
        of.deviation,
        of.settled,
        of.scale,
        ROUNDING,
    )


def linearise(of: Setup, arms: Array, pose: Array, volts: Array) -> tuple[Array, Array]:
    """Return residuals (N, m), V, and the Jacobian (N, m, 3) at poses of the middle."""
    w = 2 * pi / of.pitch
    x, y, yaw = pose.T[:, :, None]
    c, s = np.cos(yaw), np.sin(yaw)
    rx, ry = arms.T
    dy, dx = c * rx - s * ry, -s * rx - c * ry
    P = np.stack([x + dy, y - dx])
    B = of.c + of.alpha * np.sin(w * P) + of.beta * np.sin(5 * w * P)
    g = w * (of.alpha * np.cos(w * P) + 5 * of.beta * np.cos(5 * w * P))
    (bx, by), (gx, gy) = B, g
    first = [c * gx, s * gy, -s * bx + c * by + c * gx * dx + s * gy * dy]
    second = [-s * gx, c * gy, -c * bx - s * by - s * gx * dx + c * gy * dy]
    H = np.concatenate([np.stack(rows, axis=2) for rows in (first, second)], axis=1)
    return np.concatenate([volts[:, :, 0] - c * bx - s * by, volts[:, :, 1] + s * bx - c * by], axis=1), H


def initial_state(of: Setup) -> dict[str, Array]:
    """Return the state after init, by name."""
    counts = ("astray", "searching", "certain", "placed", "restarted", *(("without",) if is_redundant(of) else ()))
    return glsdc.initial_state(
        [*POSE, "yaw_known", "start_x", "start_y", "pitch_x", "pitch_y", *problem(of).motions, *counts]
    )


def predict(of: Setup, state: Columns, refused: Array) -> tuple[Array, Array]:
    """Return the pose (N, 3) in m and rad with which a sample begins, and which sensors count (N, sensors), 0 or 1."""
    good = np.ones(refused.shape[:2])
    if is_redundant(of):
        numbers = np.arange(1, len(of.positions) + 1)
        good = 1.0 * (~np.any(refused, axis=2) & (numbers != state["without"][:, None]))
    return glsdc.predict(problem(of), state), good


def step(of: Setup, state: Columns, volts: Array, refused: Array) -> tuple[dict[str, Array], dict[str, Array]]:
    """Return outputs and next state for held voltages (N, sensors, 2), of which some are `refused`."""
    start, weights = predict(of, state, refused)
    fits, end, converged = glsdc.descend(problem(of), start, volts, weights)
    last, complete = fits[-1], ~np.any(refused, axis=(1, 2)) | is_redundant(of)
    freedom = 2 * len(of.positions) - 3 - 2 * np.any(weights == 0, axis=1)
    inverse = np.linalg.inv(np.linalg.qr(glsdc.damped(last.H, damping(of)))[1])
    judged = judge(of, state, last, start[:, 2] + end[:, 2], freedom, inverse, converged, (weights > 0).sum(axis=1))
    end = np.where((judged.fault & (state["searching"] == 0))[:, None], 0.0, end)
    pose = locate(of, state, start + end)
    counted = np.all([np.abs(pose[f"pitch_{a}"]) <= of.pitches for a in "xy"], axis=0)
    limit = of.yaw if is_redundant(of) else min(of.yaw, of.turn / 2)  # two sensors tell places apart within `turn`
    turned = np.abs(pose["yaw"])
    inside = counted & (turned <= limit)
    certain = (judged.unambiguous & complete & inside) | ((state["certain"] > 0) & ~judged.damped)
    next = advance(of, state, pose, judged, converged, certain, fits[0].each)
    left = ~(counted & (turned <= np.where(certain, limit, 2 * limit)))
    next["restarted"] = np.maximum(next["restarted"], (state["placed"] > 0) & left)
    if of.follow:
        w = 2 * pi / of.pitch
        by = np.array([of.follow * f for f in (w, w, 1 / of.firm)]) * end
        next |= glsdc.follow(problem(of), state, by, state["searching"] > 0)
    valid = judged.good & certain & inside & complete & (state["restarted"] == 0)
    out = position(of, pose) | deviations(of, inverse, pose["yaw"]) | {"residual": np.sqrt(last.squares / freedom)}
    out |= {"converged": converged, "damped": judged.damped, "valid": valid, "restarted": state["restarted"]}
    return out | ({"without": state["without"]} if is_redundant(of) else {}), next


def judge(
    of: Setup, state: Columns, last: Fit, yaw: Array, freedom: Array, inverse: Array, converged: Array, sensors: Array
) -> Judgement:
    """Judge a sample that ends at a yaw, by R^-1 (N, 3, 3) without the yaw's own damping, and so many sensors."""
    redundant, searching = is_redundant(of), state["searching"] > 0
    moved = ((damping(of) * last.at) ** 2).sum(axis=1)
    sudden = moved > ((1 + state["astray"] if redundant else 1.0) * of.surprise * of.deviation) ** 2
    away = yaw - state["yaw_known"]
    near = np.abs(wrap(wrap(away)[0])[0] if of.yaw + of.turn > pi else away) <= of.turn
    lost = np.where(state["certain"] > 0, sudden, searching & ~near)
    fault = (last.squares > freedom * of.residual**2) | lost
    prior_weight = ((damping(of)[:, None] * inverse) ** 2).sum(axis=(1, 2))
    damped = prior_weight > of.leaning
    good = converged & ~damped & ~fault & ~sudden
    alone = (sensors > 2) & (prior_weight <= MORE * of.certain) if redundant else near & (prior_weight <= of.certain)
    inconsistent = last.squares > freedom * min(of.residual, INCONSISTENT * of.deviation) ** 2
    return Judgement(fault, inconsistent, damped, good, good & ~searching & alone)


def locate(of: Setup, state: Columns, at: Array) -> dict[str, Array]:
    """Return phases, pitches and yaws of bodies at (N, 3)."""
    pose = {"yaw": wrap(at[:, 2])[0]}
    for i, axis in enumerate("xy"):
        phase, turns = wrap(2 * pi / of.pitch * at[:, i])
        pose |= {f"phase_{axis}": phase, f"pitch_{axis}": state[f"pitch_{axis}"] + turns}
    return pose


def advance(
    of: Setup, state: Columns, pose: Columns, judged: Judgement, converged: Array, certain: Array, each: Array
) -> dict[str, Array]:
    """Return the next states of bodies at a pose."""
    fault = judged.fault
    restarted, again = glsdc.restart(state, fault, pose)
    next = dict(pose) | restarted
    if is_redundant(of):
        others, sensors = np.sort(each, axis=1)[:, :-1].sum(axis=1), each.shape[1] - 1
        expected = of.residual**2 + (of.surprise * of.deviation) ** 2 / of.damping
        suspected = (others <= 2 * sensors * expected) & (CONTRAST * others <= each.max(axis=1))
        suspected &= fault & judged.inconsistent & (state["certain"] > 0) & (state["astray"] >= SUSPECT - 1)
        next["without"] = np.where(again, 0, np.where(suspected, 1 + np.argmax(each, axis=1), state["without"]))
    next["searching"] = np.where(again, 1, np.where(converged & ~fault, 0, state["searching"]))
    next |= {"restarted": np.maximum(state["restarted"], again & (state["placed"] > 0))}
    next |= {"placed": np.maximum(certain, state["placed"]), "certain": certain & ~again}
    next |= {"yaw": np.where(again, state["yaw_known"], pose["yaw"])}
    next |= {"yaw_known": np.where(certain & ~fault, pose["yaw"], state["yaw_known"])}
    return next | {f"pitch_{a}": np.clip(pose[f"pitch_{a}"], -of.pitches, of.pitches) for a in "xy"}


def position(of: Setup, pose: Columns) -> dict[str, Array]:
    """Return X and Y of the body's origin, m, and the yaw."""
    (x, y), c, s = middle(of), np.cos(pose["yaw"]), np.sin(pose["yaw"])
    turned = {"x": c * x - s * y, "y": s * x + c * y}
    X, Y = ((pose[f"phase_{a}"] / (2 * pi) + pose[f"pitch_{a}"]) * of.pitch - turned[a] for a in "xy")
    return {"X": X, "Y": Y, "yaw": pose["yaw"]}


def deviations(of: Setup, inverse: Array, yaw: Array) -> dict[str, Array]:
    """Return the standard deviations of X, Y and yaw of the body's origin, from R^-1 (N, 3, 3)."""
    (x, y), c, s = middle(of), np.cos(yaw), np.sin(yaw)
    moved = inverse.copy()
    moved[:, 0] += (s * x + c * y)[:, None] * inverse[:, 2]
    moved[:, 1] -= (c * x - s * y)[:, None] * inverse[:, 2]
    found = of.deviation * np.sqrt((moved**2).sum(axis=2))
    return {f"deviation_{name}": found[:, i] for i, name in enumerate(("X", "Y", "yaw"))}
