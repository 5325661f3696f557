"""The estimator of six degrees of freedom in plain NumPy, for comparison; N bodies advance one sample at a time.

The potential of the field, V m, of which the sensors' axes e see -e.grad at their places P = (X, Y, Z) + R r:

    Phi = sum over n = 1, 5 of a_n / (n w) exp(-n w (Z - height)) (cos(n w X) + cos(n w Y))

A coordinate q moves what is read by e'(q).B + e.(grad B P'(q)), with the derivatives of R = R_z R_y R_x as products of
matrices. Rows are factorised once, where the sample begins. Sines are NumPy's, of 5 w X as of w X.
"""

from functools import partial
from math import pi, sqrt

import numpy as np

from designs.hall_position import reference_glsdc as glsdc
from designs.hall_position.reference_glsdc import Array, Columns, Problem, Setup, wrap

PART = 0.25  # of the ranges of height and tilts, in a sample
POSE = ("phase_x", "phase_y", "rise", "roll", "pitch", "yaw")
MOTION = tuple(f"motion_{name}" for name in POSE)
OUTPUTS = ("X", "Y", "Z", "roll", "pitch", "yaw")
WAVES = (1, 5)
# Unit turns about x, y and z.
GENERATORS = np.array([[[0, 0, 0], [0, 0, -1], [0, 1, 0]], [[0, 0, 1], [0, 0, 0], [-1, 0, 0]]], dtype=float)
ABOUT_Z = np.array([[0, -1.0, 0], [1.0, 0, 0], [0, 0, 0]])


def is_redundant(of: Setup) -> bool:
    """Return whether a sensor can be left out."""
    return len(of.positions) > 4


def ranges(of: Setup) -> Array:
    """Return within what the height, roll and pitch are, m and rad."""
    return np.array([of.gap, of.tilt, of.tilt])


def problem(of: Setup) -> Problem:
    """Return the problem; phases and the yaw together move a sensor's phase by the reach."""
    flat, w, half = np.array(of.positions)[:, :2], 2 * pi / of.pitch, of.max_phase_step / 2
    mean, arm = sqrt((flat**2).sum() / len(flat)), w * np.abs(flat).sum(axis=1).max()
    yaw = (sqrt(arm**2 + 2 * arm * half) - arm) / arm
    return Problem(
        POSE,
        MOTION,
        partial(linearise, of),
        sqrt(of.damping) * of.alpha * w * np.array([1, 1, 1, mean, mean, mean]),
        np.array([half / w, half / w, *(PART * ranges(of)), yaw]),
        np.array([w] * 3 + [1.0] * 3),
        [slice(i, i + 1) for i in reversed(range(6))],
        of.corrections,
        of.deviation,
        of.convergence_sigma,
        once=True,
    )


def initial_state(of: Setup) -> dict[str, Array]:
    """Return the state after init, by name."""
    names = [*POSE, "yaw_last_good", "count_x", "count_y", "start_x", "start_y", *MOTION]
    return glsdc.initial_state([*names, "residual_faults", "searching", "lock_lost"])


def predict(of: Setup, state: Columns) -> Array:
    """Return the pose (N, 6) with which a sample begins, m and rad."""
    start = glsdc.predict(problem(of), state)
    start[:, 2:5] = np.clip(start[:, 2:5], -ranges(of), ranges(of))
    return start


def step(of: Setup, state: Columns, volts: Array, refused: Array) -> tuple[dict[str, Array], dict[str, Array]]:
    """Return outputs and next state for held voltages (N, sensors, 2), of which some are `refused`."""
    bad, minimised = np.any(refused, axis=2), problem(of)
    weights = 1.0 * ~bad if is_redundant(of) else np.ones(bad.shape)
    freedom = 2 * len(of.positions) - 6 - 2 * np.any(weights == 0, axis=1)
    start = predict(of, state)
    fits, end, converged = glsdc.descend(minimised, start, volts, weights)
    last, inverse = fits[-1], np.linalg.inv(fits[-1].R)
    fault, searching = last.squares > freedom * of.residual_limit**2, state["searching"] > 0
    end = np.where((fault & ~searching)[:, None], 0.0, end)
    pose, next, inside = advance(of, state, start + end, fault)
    next |= glsdc.update_motion(minimised, state, of.velocity_gain * minimised.units * end, fault & searching)
    spread = of.deviation * np.sqrt((inverse**2).sum(axis=2))
    out = {name: pose[:, i] for i, name in enumerate(OUTPUTS)}
    out |= {f"deviation_{name}": spread[:, i] for i, name in enumerate(OUTPUTS)}
    damped = ((minimised.damping[:, None] * inverse) ** 2).sum(axis=(1, 2)) > of.max_prior_weight
    sudden = last.cost - last.squares > (of.innovation_gate_sigma * of.deviation) ** 2
    accepted = inside if is_redundant(of) else inside & ~bad.any(axis=1)
    out |= {"residual": np.sqrt(last.squares / freedom), "converged": converged, "damped": damped}
    return out | {"valid": converged & ~damped & ~fault & ~sudden & accepted, "lock_lost": state["lock_lost"]}, next


def linearise(of: Setup, pose: Array, volts: Array) -> tuple[Array, Array]:
    """Return residuals (N, m), V, and derivatives (N, m, 6) at poses (N, 6), Z from the height on."""
    turns = rotations(*pose[:, 3:].T)
    residuals, slopes = [], []
    seen = [(r, *field(of, pose[:, :3] + turns[0] @ r)) for r in of.positions]
    for axis in (0, 1):
        e = turns[0][:, :, axis]
        for k, (r, B, gradient) in enumerate(seen):
            p = np.einsum("nij,nj->ni", gradient, e)
            by = [(d[:, :, axis] * B).sum(axis=1) + (p * (d @ r)).sum(axis=1) for d in turns[1:]]
            residuals.append(volts[:, k, axis] - (e * B).sum(axis=1))
            slopes.append(np.column_stack([p, *by]))
    return np.stack(residuals, axis=1), np.stack(slopes, axis=1)


def rotations(roll: Array, pitch: Array, yaw: Array) -> list[Array]:
    """Return R (N, 3, 3) and its derivatives by roll, pitch and yaw."""
    K, L = GENERATORS
    x, y, z = (
        np.eye(3) + np.sin(a)[:, None, None] * G + (1 - np.cos(a))[:, None, None] * (G @ G)
        for a, G in ((roll, K), (pitch, L), (yaw, ABOUT_Z))
    )
    return [z @ y @ x, z @ y @ x @ K, z @ y @ L @ x, ABOUT_Z @ z @ y @ x]


def field(of: Setup, at: Array) -> tuple[Array, Array]:
    """Return B (N, 3) in V and its gradient (N, 3, 3) in V/m, places (N, 3) in m from the height on."""
    w, B, gradient = 2 * pi / of.pitch, np.zeros((len(at), 3)), np.zeros((len(at), 3, 3))
    for n, a in zip(WAVES, (of.alpha, of.beta), strict=True):
        k, size = n * w, a * np.exp(-n * w * at[:, 2])
        for i in (0, 1):
            s, c = size * np.sin(k * at[:, i]), size * np.cos(k * at[:, i])
            B[:, i] += s
            B[:, 2] += c
            gradient[:, i, i] += k * c
            gradient[:, 2, 2] -= k * c
            gradient[:, i, 2] -= k * s
            gradient[:, 2, i] -= k * s
    return B, gradient


def advance(of: Setup, state: Columns, pose: Array, fault: Array) -> tuple[Array, dict[str, Array], Array]:
    """Return the poses (N, 6) of the outputs, the next states, and which are within their ranges."""
    outputs, units, limits = pose.copy(), problem(of).units, ranges(of)
    inside = np.all(np.abs(pose[:, 2:5]) < limits, axis=1)
    located: dict[str, Array] = {}
    for i, axis in enumerate("xy"):
        phase, turns = wrap(units[i] * pose[:, i])
        counted = np.abs(state[f"count_{axis}"]) < of.pitches
        located |= {f"phase_{axis}": phase, f"count_{axis}": state[f"count_{axis}"] + np.where(counted, turns, 0)}
        outputs[:, i] = (phase / (2 * pi) + located[f"count_{axis}"]) * of.pitch
        inside &= counted
    outputs[:, 2] += of.height
    outputs[:, 5] = wrap(pose[:, 5])[0]
    changes, restart = glsdc.restart(state, fault, located)
    level = np.clip(pose[:, 2:5], -limits, limits) * units[2:5]
    located |= {name: level[:, i] for i, name in enumerate(POSE[2:5])}
    next = {name: np.where(restart, 0.0, v) for name, v in located.items()} | changes
    next |= {"yaw": np.where(restart, state["yaw_last_good"], outputs[:, 5])}
    next |= {"yaw_last_good": np.where(fault, state["yaw_last_good"], outputs[:, 5])}
    next |= {"searching": np.where(restart, 1, np.where(fault, state["searching"], 0))}
    return outputs, next | {"lock_lost": np.maximum(state["lock_lost"], restart)}, inside
