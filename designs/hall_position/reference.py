"""Reference of the estimator of (X, Y, yaw): the paper's equations in plain NumPy.

Kawato and Kim, "A Novel Multi-DOF Precision Positioning Methodology Using Two-Axis Hall-Effect Sensors", (2), section
3.B and Fig. 9. For each sensor, with c, s of the yaw and d the derivative of its place P by the yaw, its two voltages
and their Jacobian are

    [ a ]   [  c  s ] [ B_X ]        [  c g_X   s g_Y   -s B_X + c B_Y + c g_X d_X + s g_Y d_Y ]
    [ b ] = [ -s  c ] [ B_Y ]   H =  [ -s g_X   c g_Y   -c B_X - s B_Y - s g_X d_X + c g_Y d_Y ]    g = dB/dX, V/m

in m and rad of the sensors' centre. Both sin(w X) and sin(5 w X) are NumPy's sines.
"""

from dataclasses import dataclass
from functools import partial
from math import pi, sqrt

import numpy as np

from designs.hall_position import reference_glsdc as glsdc
from designs.hall_position.reference_glsdc import Array, Columns, Fit, Problem, Setup, wrap

ROUNDING = 2e-6  # of the cost
POSE, MOTION = ("phase_x", "phase_y", "yaw"), ("motion_x", "motion_y", "motion_yaw")


@dataclass(frozen=True)
class Integrity:
    """Flags of a sample (N,): residual fault, damped, or `good`.

    `unambiguous`: besides, no other pose in the yaw window has the same voltages.
    """

    fault: Array
    damped: Array
    good: Array
    unambiguous: Array


def centre(setup: Setup) -> Array:
    """Return the mean of the sensors' positions in the body, m: the point whose pose is estimated."""
    return np.asarray(np.mean(setup.positions, axis=0))


def damping(setup: Setup) -> Array:
    """Return the root of the damping of X, Y and yaw, V/m and V/rad, without yaw_damping_ratio."""
    w, arms = 2 * pi / setup.pitch, np.array(setup.positions) - centre(setup)
    arm = w * sqrt((arms**2).sum() / len(setup.positions))
    return np.asarray(sqrt(setup.damping) * setup.alpha * np.array([w, w, arm]))


def problem(setup: Setup) -> Problem:
    """Return the problem; a sample moves a sensor's phase by max_phase_step at most."""
    w, arms = 2 * pi / setup.pitch, np.array(setup.positions) - centre(setup)
    arm, half = w * np.abs(arms).sum(axis=1).max(), setup.max_phase_step / 2
    bounds = np.array([half / w, half / w, (sqrt(arm**2 + 2 * arm * half) - arm) / arm])
    return Problem(
        POSE,
        MOTION if setup.velocity_gain else (),
        partial(linearise, setup, arms),
        damping(setup) * [1, 1, setup.yaw_damping_ratio],
        bounds,
        np.array([w, w, 1]),
        (slice(2, 3), slice(0, 2)),
        setup.iterations,
        setup.deviation,
        setup.convergence_sigma,
        setup.scale,
        ROUNDING,
    )


def linearise(setup: Setup, arms: Array, pose: Array, volts: Array) -> tuple[Array, Array]:
    """Return residuals (N, m), V, and the Jacobian (N, m, 3) at poses of the centre."""
    w = 2 * pi / setup.pitch
    x, y, yaw = pose.T[:, :, None]
    c, s = np.cos(yaw), np.sin(yaw)
    rx, ry = arms.T
    dy, dx = c * rx - s * ry, -s * rx - c * ry
    P = np.stack([x + dy, y - dx])
    B = setup.c + setup.alpha * np.sin(w * P) + setup.beta * np.sin(5 * w * P)
    g = w * (setup.alpha * np.cos(w * P) + 5 * setup.beta * np.cos(5 * w * P))
    (bx, by), (gx, gy) = B, g
    first = [c * gx, s * gy, -s * bx + c * by + c * gx * dx + s * gy * dy]
    second = [-s * gx, c * gy, -c * bx - s * by - s * gx * dx + c * gy * dy]
    H = np.concatenate([np.stack(rows, axis=2) for rows in (first, second)], axis=1)
    return np.concatenate([volts[:, :, 0] - c * bx - s * by, volts[:, :, 1] + s * bx - c * by], axis=1), H


def initial_state(setup: Setup) -> dict[str, Array]:
    """Return the state after init, by name."""
    counts = ("residual_faults", "searching", "ambiguity_resolved", "acquired", "lock_lost")
    return glsdc.initial_state(
        [*POSE, "yaw_last_good", "start_x", "start_y", "pitch_x", "pitch_y", *problem(setup).motions, *counts]
    )


def predict(setup: Setup, state: Columns) -> Array:
    """Return the predicted pose (N, 3) in m and rad."""
    return glsdc.predict(problem(setup), state)


def step(setup: Setup, state: Columns, volts: Array, refused: Array) -> tuple[dict[str, Array], dict[str, Array]]:
    """Return outputs and next state for held voltages (N, sensors, 2), some of them `refused`."""
    start = predict(setup, state)
    fits, end, converged = glsdc.descend(problem(setup), start, volts)
    last, complete = fits[-1], ~np.any(refused, axis=(1, 2))
    freedom = 2 * len(setup.positions) - 3
    inverse = np.linalg.inv(np.linalg.qr(glsdc.augment(last.H, damping(setup)))[1])
    yaw = start[:, 2] + end[:, 2]
    integrity = check_integrity(setup, state, last, yaw, freedom, inverse, converged)
    end = np.where((integrity.fault & (state["searching"] == 0))[:, None], 0.0, end)
    pose = locate(setup, state, start + end)
    counted = np.all([np.abs(pose[f"pitch_{a}"]) <= setup.pitches for a in "xy"], axis=0)
    limit = min(setup.yaw_limit, setup.yaw_window / 2)
    size = np.abs(pose["yaw"])
    inside = counted & (size <= limit)
    resolved = (integrity.unambiguous & complete & inside) | ((state["ambiguity_resolved"] > 0) & ~integrity.damped)
    next = advance(setup, state, pose, integrity, converged, resolved)
    outside = ~(counted & (size <= np.where(resolved, limit, 2 * limit)))
    next["lock_lost"] = np.maximum(next["lock_lost"], (state["acquired"] > 0) & outside)
    if setup.velocity_gain:
        w = 2 * pi / setup.pitch
        steps = np.array([setup.velocity_gain * f for f in (w, w, 1 / setup.yaw_damping_ratio)]) * end
        next |= glsdc.update_motion(problem(setup), state, steps, state["searching"] > 0)
    valid = integrity.good & resolved & inside & complete & (state["lock_lost"] == 0)
    out = (
        position(setup, pose) | deviations(setup, inverse, pose["yaw"]) | {"residual": np.sqrt(last.squares / freedom)}
    )
    out |= {"converged": converged, "damped": integrity.damped, "valid": valid, "lock_lost": state["lock_lost"]}
    return out, next


def check_integrity(
    setup: Setup,
    state: Columns,
    last: Fit,
    yaw: Array,
    freedom: int,
    inverse: Array,
    converged: Array,
) -> Integrity:
    """Return the flags of a sample that ends at a yaw, from R^-1 (N, 3, 3) without yaw_damping_ratio."""
    searching = state["searching"] > 0
    innovation = ((damping(setup) * last.at) ** 2).sum(axis=1)
    gate_exceeded = innovation > (setup.innovation_gate_sigma * setup.deviation) ** 2
    change = yaw - state["yaw_last_good"]
    in_window = (
        np.abs(wrap(wrap(change)[0])[0] if setup.yaw_limit + setup.yaw_window > pi else change) <= setup.yaw_window
    )
    lost = np.where(state["ambiguity_resolved"] > 0, gate_exceeded, searching & ~in_window)
    fault = (last.squares > freedom * setup.residual_limit**2) | lost
    prior_weight = ((damping(setup)[:, None] * inverse) ** 2).sum(axis=(1, 2))
    damped = prior_weight > setup.max_prior_weight
    good = converged & ~damped & ~fault & ~gate_exceeded
    single = in_window & (prior_weight <= setup.ambiguity_threshold)
    return Integrity(fault, damped, good, good & ~searching & single)


def locate(setup: Setup, state: Columns, at: Array) -> dict[str, Array]:
    """Return phases, pitches and yaw of poses (N, 3); pitches are counted once position lock has been acquired."""
    pose = {"yaw": wrap(at[:, 2])[0]}
    for i, axis in enumerate("xy"):
        phase, turns = wrap(2 * pi / setup.pitch * at[:, i])
        pose |= {f"phase_{axis}": phase, f"pitch_{axis}": state[f"pitch_{axis}"] + turns * (state["acquired"] > 0)}
    return pose


def advance(
    setup: Setup, state: Columns, pose: Columns, integrity: Integrity, converged: Array, resolved: Array
) -> dict[str, Array]:
    """Return the next states from the pose and the flags of a sample."""
    fault = integrity.fault
    changes, restart = glsdc.restart(state, fault, pose)
    next = dict(pose) | changes
    next["searching"] = np.where(restart, 1, np.where(converged & ~fault, 0, state["searching"]))
    next |= {"lock_lost": np.maximum(state["lock_lost"], restart & (state["acquired"] > 0))}
    next |= {"acquired": np.maximum(resolved, state["acquired"]), "ambiguity_resolved": resolved & ~restart}
    next |= {"yaw": np.where(restart, state["yaw_last_good"], pose["yaw"])}
    next |= {"yaw_last_good": np.where(resolved & ~fault, pose["yaw"], state["yaw_last_good"])}
    return next | {f"pitch_{a}": np.clip(pose[f"pitch_{a}"], -setup.pitches, setup.pitches) for a in "xy"}


def position(setup: Setup, pose: Columns) -> dict[str, Array]:
    """Return X and Y of the body's origin, m, and the yaw."""
    (x, y), c, s = centre(setup), np.cos(pose["yaw"]), np.sin(pose["yaw"])
    arm = {"x": c * x - s * y, "y": s * x + c * y}
    X, Y = ((pose[f"phase_{a}"] / (2 * pi) + pose[f"pitch_{a}"]) * setup.pitch - arm[a] for a in "xy")
    return {"X": X, "Y": Y, "yaw": pose["yaw"]}


def deviations(setup: Setup, inverse: Array, yaw: Array) -> dict[str, Array]:
    """Return the standard deviations of X, Y and yaw of the body's origin, from R^-1 (N, 3, 3)."""
    (x, y), c, s = centre(setup), np.cos(yaw), np.sin(yaw)
    origin = inverse.copy()
    origin[:, 0] += (s * x + c * y)[:, None] * inverse[:, 2]
    origin[:, 1] -= (c * x - s * y)[:, None] * inverse[:, 2]
    sigma = setup.deviation * np.sqrt((origin**2).sum(axis=2))
    return {f"deviation_{name}": sigma[:, i] for i, name in enumerate(("X", "Y", "yaw"))}
