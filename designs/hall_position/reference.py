"""GLSDC from the paper's equations in plain NumPy, for comparison; N bodies advance one sample at a time.

Kawato and Kim, "Multi-Degree-of-Freedom Precision Position Sensing", (2), section 3.B and Fig. 9. For each sensor, with
c, s of the yaw and d the derivative of its place P by the yaw, its two voltages and their Jacobian are

    [ a ]   [  c  s ] [ B_X ]        [  c g_X   s g_Y   -s B_X + c B_Y + c g_X d_X + s g_Y d_Y ]
    [ b ] = [ -s  c ] [ B_Y ]   H =  [ -s g_X   c g_Y   -c B_X - s B_Y - s g_X d_X + c g_Y d_Y ]    g = dB/dX, V/m

A correction is the least-squares solution of the weighted rows over those of the damping, by an orthogonal
factorisation, in m and rad about the middle of the sensors. Sines are NumPy's, of 5 w X as of w X.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import pi, sqrt
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]
Columns = Mapping[str, Array]

SLACK, ROUNDING = 0.01, 2e-6  # of deviation^2, of the cost
PATIENCE, SUSPECT = 5, 2  # samples
CONTRAST = 25  # of squared residuals
APART = 4.0  # deviations, rms
MORE = 4  # times setup.certain, of more than two sensors
CHANGE = 1e-9  # of a voltage, of alpha, and of a phase, rad, by which a step is tried
POSE, MOTION = ("phase_x", "phase_y", "yaw"), ("motion_x", "motion_y", "motion_yaw")
PLASTIC = 1.324717957244746  # g, g^3 = g + 1


@dataclass(frozen=True)
class Setup:
    """Sensors in the body, m, their weights, the field, V, and the numbers of the algorithm."""

    positions: tuple[tuple[float, float], ...]
    weights: tuple[float, ...]
    c: float
    alpha: float
    beta: float
    pitch: float
    deviation: float
    iterations: int
    scale: float
    damping: float
    firm: float
    reach: float
    follow: float
    settled: float
    leaning: float
    surprise: float
    residual: float
    pitches: int
    certain: float
    turn: float
    yaw: float

    @property
    def middle(self) -> Array:
        """Where the correction is made in the body, m."""
        return np.mean(self.positions, axis=0)

    @property
    def arms(self) -> Array:
        """From there to the sensors, m, (sensors, 2)."""
        return np.array(self.positions) - self.middle

    @property
    def stiffness(self) -> Array:
        """The damping's root by X, Y and yaw, V/m and V/rad, of a yaw that is held no more firmly than they are."""
        w = 2 * pi / self.pitch
        arm = w * sqrt((self.arms**2).sum() / len(self.positions))
        return sqrt(self.damping) * self.alpha * np.array([w, w, arm])

    @property
    def holding(self) -> Array:
        """The same of the yaw as it is held."""
        return self.stiffness * [1, 1, self.firm]

    @property
    def bounds(self) -> Array:
        """How far a sample may move X, Y and the yaw, m and rad: a sensor's phase by no more than the reach."""
        w = 2 * pi / self.pitch
        arm = w * np.abs(self.arms).sum(axis=1).max()
        half = self.reach / 2
        return np.array([half / w, half / w, (sqrt(arm**2 + 2 * arm * half) - arm) / arm])


@dataclass(frozen=True)
class Fit:
    """Rows H (N, m, 3) at a displacement, held and factorised: R (N, 3, 3) and z = Q'b (N, 3).

    `each` (N, sensors) are the squared residuals of sensors, V^2.
    """

    at: Array
    H: Array
    each: Array
    squares: Array
    cost: Array
    R: Array
    z: Array


def initial_state(setup: Setup) -> dict[str, Array]:
    """Return the state after init, by name."""
    reals = (*POSE, "yaw_known", "start_x", "start_y", "pitch_x", "pitch_y", *(MOTION if setup.follow else ()))
    counts = ("astray", "searching", "certain", "placed", "restarted")
    spare = ("without",) if len(setup.positions) > 2 else ()
    return {name: np.array([1.0 * (name == "searching")]) for name in (*reals, *counts, *spare)}


def begun(setup: Setup, state: Columns, refused: Array) -> tuple[Array, Array]:
    """Return the pose (N, 3) in m and rad with which a sample begins, and the weights (N, sensors)."""
    w = 2 * pi / setup.pitch
    start = np.stack([state[name] for name in POSE], axis=1)
    if setup.follow:
        start = start + np.stack([state[name] for name in MOTION], axis=1)
    good = np.ones(refused.shape[:2])
    if len(setup.positions) > 2:
        numbers = np.arange(1, len(setup.positions) + 1)
        good = 1.0 * (~np.any(refused, axis=2) & (numbers != state["without"][:, None]))
    return start / [w, w, 1], good * np.array(setup.weights)


def step(setup: Setup, state: Columns, volts: Array, refused: Array) -> tuple[dict[str, Array], dict[str, Array]]:
    """Return outputs and next state for held voltages (N, sensors, 2), of which some are `refused`."""
    w, spare = 2 * pi / setup.pitch, len(setup.positions) > 2
    start, weights = begun(setup, state, refused)
    fits, end, converged = descend(setup, start, volts, weights)
    last = fits[-1]
    freedom = 2 * len(setup.positions) - 3 - 2 * np.any(weights == 0, axis=1)
    since = 1 + state["astray"] if spare else 1.0
    moved = ((setup.stiffness * last.at) ** 2).sum(axis=1)
    sudden = moved > (since * setup.surprise * setup.deviation) ** 2
    since_known = start[:, 2] + end[:, 2] - state["yaw_known"]
    if setup.yaw + setup.turn > pi:
        since_known = wrapped(wrapped(since_known)[0])[0]
    near = np.abs(since_known) <= setup.turn
    certain, searching = state["certain"] > 0, state["searching"] > 0
    astray = (last.squares > freedom * setup.residual**2) | np.where(certain, sudden, searching & ~near)
    inverse = np.linalg.inv(np.linalg.qr(held(last.H, setup.stiffness))[1])
    leaning = ((setup.stiffness[:, None] * inverse) ** 2).sum(axis=(1, 2))
    damped = leaning > setup.leaning
    good = converged & ~damped & ~astray & ~sudden
    two = (weights > 0).sum(axis=1) <= 2
    if spare:
        telling = good & ~searching & ~two & (leaning <= MORE * setup.certain)
    else:
        telling = good & near & ~searching & (leaning <= setup.certain) & ~np.any(refused, axis=(1, 2))
    end = np.where((astray & ~searching)[:, None], 0.0, end)
    counted, turned, most = extent(setup, state, start + end)
    inside = counted & (turned <= most)
    certain = (telling & inside) | (certain & ~damped)
    apart = last.squares > freedom * min(setup.residual, APART * setup.deviation) ** 2
    seen = (astray, apart, converged)
    found, next = advance(setup, state, start + end, seen, certain, fits[0].each)
    bound = np.where(certain, most, 2 * most)
    next["restarted"] = np.maximum(next["restarted"], (state["placed"] > 0) & ~(counted & (turned <= bound)))
    if setup.follow:
        moved = [
            state[name] + setup.follow * f * end[:, i]
            for i, (name, f) in enumerate(zip(MOTION, (w, w, 1 / setup.firm), strict=True))
        ]
        bounds = setup.bounds * [w, w, 1]
        lost = state["searching"] > 0
        next |= {name: np.where(lost, 0, np.clip(v, -b, b)) for name, v, b in zip(MOTION, moved, bounds, strict=True)}
    out = position(setup, found) | deviations(setup, inverse, found["yaw"])
    accepted = inside if spare else inside & ~np.any(refused, axis=(1, 2))
    out |= {"residual": np.sqrt(last.squares / freedom), "converged": converged, "damped": damped}
    out |= {"valid": good & certain & accepted & (state["restarted"] == 0), "restarted": state["restarted"]}
    return out | ({"without": state["without"]} if spare else {}), next


def descend(setup: Setup, start: Array, volts: Array, weights: Array) -> tuple[list[Fit], Array, Array]:
    """Return what was tried, the displacement (N, 3) after all corrections, and whether they have converged."""
    fit = fitted(setup, start, np.zeros_like(start), volts, weights)
    fits = [fit]
    best, lowest, better = fit.at, fit.cost, np.ones(len(start), bool)
    for _ in range(setup.iterations - 1):
        tried = np.where(better[:, None], corrected(setup, fit), (fit.at + best) / 2)
        fit = fitted(setup, start, tried, volts, weights)
        fits.append(fit)
        better = fit.cost <= (1 + ROUNDING) * lowest + SLACK * setup.deviation**2
        best, lowest = np.where(better[:, None], fit.at, best), np.where(better, fit.cost, lowest)
    ahead = corrected(setup, fit)
    settled = (fit.z**2).sum(axis=1) <= (setup.settled * setup.deviation) ** 2
    converged = better & settled
    return fits, np.where(converged[:, None], ahead, best), converged


def margin(setup: Setup, state: Columns, volts: Array, refused: Array) -> Array:
    """Return how far a cost is from the bound below which it counts as lower, at least, (N,).

    In relative errors of the voltages of alpha, and of residuals, that would make it cross.
    """
    start, weights = begun(setup, state, refused)
    costs = [fit.cost for fit in descend(setup, start, volts, weights)[0]]
    lowest, found = costs[0], np.full(len(start), np.inf)
    for cost in costs[1:]:
        bound = (1 + ROUNDING) * lowest + SLACK * setup.deviation**2
        found = np.minimum(found, np.abs(cost - bound) / (2 * np.sqrt(bound) * (setup.alpha + np.sqrt(bound))))
        lowest = np.where(cost <= bound, cost, lowest)
    return found


def fitted(setup: Setup, start: Array, at: Array, volts: Array, weights: Array) -> Fit:
    """Linearise at a displacement (N, 3)."""
    w = 2 * pi / setup.pitch
    x, y, yaw = (start + at).T[:, :, None]
    c, s = np.cos(yaw), np.sin(yaw)
    rx, ry = setup.arms.T
    dy, dx = c * rx - s * ry, -s * rx - c * ry
    P = np.stack([x + dy, y - dx])
    B = setup.c + setup.alpha * np.sin(w * P) + setup.beta * np.sin(5 * w * P)
    g = w * (setup.alpha * np.cos(w * P) + 5 * setup.beta * np.cos(5 * w * P))
    (bx, by), (gx, gy) = B, g
    first = [c * gx, s * gy, -s * bx + c * by + c * gx * dx + s * gy * dy]
    second = [-s * gx, c * gy, -c * bx - s * by - s * gx * dx + c * gy * dy]
    root = np.sqrt(weights)
    H = np.concatenate([np.stack([root * v for v in rows], axis=2) for rows in (first, second)], axis=1)
    e = np.concatenate([root * (volts[:, :, 0] - c * bx - s * by), root * (volts[:, :, 1] + s * bx - c * by)], axis=1)
    Q, R = np.linalg.qr(held(H, setup.holding))
    b = np.concatenate([e, -setup.holding * at], axis=1)
    each = (e**2).reshape(len(at), 2, -1).sum(axis=1)
    return Fit(at, H, each, each.sum(axis=1), (b**2).sum(axis=1), R, np.einsum("nmi,nm->ni", Q, b))


def held(H: Array, by: Array) -> Array:
    """Return rows (N, m, 3) over those of a damping whose root is `by`."""
    return np.concatenate([H, np.broadcast_to(np.diag(by), (len(H), 3, 3))], axis=1)


def corrected(setup: Setup, fit: Fit) -> Array:
    """Return the displacement (N, 3) that a scaled correction leads to; where the yaw is limited, X and Y fit it."""
    R, z, bound = fit.R, setup.scale * fit.z, setup.bounds
    yaw = np.clip(fit.at[:, 2] + z[:, 2] / R[:, 2, 2], -bound[2], bound[2])
    right = z[:, :2] - R[:, :2, 2] * (yaw - fit.at[:, 2])[:, None]
    move = np.linalg.solve(R[:, :2, :2], right[:, :, None])[:, :, 0]
    return np.column_stack([np.clip(fit.at[:, :2] + move, -bound[:2], bound[:2]), yaw])


def advance(
    setup: Setup, state: Columns, pose: Array, seen: tuple[Array, Array, Array], certain: Array, each: Array
) -> tuple[dict[str, Array], dict[str, Array]]:
    """Return where the bodies are, and the next states.

    `seen`: whether a body is astray, its voltages do not fit each other, and the estimate has converged.
    """
    astray, apart, converged = seen
    w, found = 2 * pi / setup.pitch, {"yaw": wrapped(pose[:, 2])[0]}
    for i, axis in enumerate("xy"):
        phase, turns = wrapped(w * pose[:, i])
        found |= {f"phase_{axis}": phase, f"pitch_{axis}": state[f"pitch_{axis}"] + turns}
    again = astray & (state["astray"] >= PATIENCE - 1)
    next = {"astray": np.where(astray & ~again, state["astray"] + 1, 0)}
    if len(setup.positions) > 2:
        others, sensors = np.sort(each, axis=1)[:, :-1].sum(axis=1), each.shape[1] - 1
        expected = setup.residual**2 + (setup.surprise * setup.deviation) ** 2 / setup.damping
        suspected = (others <= 2 * sensors * expected) & (CONTRAST * others <= each.max(axis=1))
        suspected &= astray & apart & (state["certain"] > 0) & (state["astray"] >= SUSPECT - 1)
        without = np.where(suspected, 1 + np.argmax(each, axis=1), state["without"])
        next["without"] = np.where(again, 0, without)
    next["searching"] = np.where(again, 1, np.where(converged & ~astray, 0, state["searching"]))
    next |= {"restarted": np.maximum(state["restarted"], again & (state["placed"] > 0))}
    next |= {"placed": np.maximum(certain, state["placed"])}
    next |= {"certain": certain & ~again, "yaw_known": np.where(certain & ~astray, found["yaw"], state["yaw_known"])}
    next |= found | {"yaw": np.where(again, state["yaw_known"], found["yaw"])}
    for axis, part in (("x", 1 / PLASTIC), ("y", 1 / PLASTIC**2)):
        start = wrapped(state[f"start_{axis}"] + 2 * pi * (part - 1))[0]
        next[f"start_{axis}"] = np.where(again, start, state[f"start_{axis}"])
        next[f"phase_{axis}"] = np.where(again, start, found[f"phase_{axis}"])
        next[f"pitch_{axis}"] = np.clip(found[f"pitch_{axis}"], -setup.pitches, setup.pitches)
    return found, next


def extent(setup: Setup, state: Columns, pose: Array) -> tuple[Array, Array, float]:
    """Return whether the pitches of poses (N, 3) are counted, how far they are turned, and may be where they are valid.

    Two sensors tell places apart within `turn`.
    """
    counted = np.ones(len(pose), bool)
    for i, axis in enumerate("xy"):
        _, turns = wrapped(2 * pi / setup.pitch * pose[:, i])
        counted &= np.abs(state[f"pitch_{axis}"] + turns) <= setup.pitches
    most = setup.yaw if len(setup.positions) > 2 else min(setup.yaw, setup.turn / 2)
    return counted, np.abs(wrapped(pose[:, 2])[0]), most


def wrapped(angle: Array) -> tuple[Array, Array]:
    """Return angles within half a turn, and the turns taken off."""
    turns = np.where(angle > pi, 1.0, np.where(angle < -pi, -1.0, 0.0))
    return angle - 2 * pi * turns, turns


def position(setup: Setup, found: Columns) -> dict[str, Array]:
    """Return X and Y of the body's origin, m, and the yaw."""
    (x, y), c, s = setup.middle, np.cos(found["yaw"]), np.sin(found["yaw"])
    turned = {"x": c * x - s * y, "y": s * x + c * y}
    at = {a: (found[f"phase_{a}"] / (2 * pi) + found[f"pitch_{a}"]) * setup.pitch - turned[a] for a in "xy"}
    return {"X": at["x"], "Y": at["y"], "yaw": found["yaw"]}


def deviations(setup: Setup, inverse: Array, yaw: Array) -> dict[str, Array]:
    """Return the standard deviations of X, Y and yaw of the body's origin, from R^-1 (N, 3, 3)."""
    (x, y), c, s = setup.middle, np.cos(yaw), np.sin(yaw)
    moved = inverse.copy()
    moved[:, 0] += (s * x + c * y)[:, None] * inverse[:, 2]
    moved[:, 1] -= (c * x - s * y)[:, None] * inverse[:, 2]
    found = setup.deviation * np.sqrt((moved**2).sum(axis=2))
    return {f"deviation_{name}": found[:, i] for i, name in enumerate(("X", "Y", "yaw"))}


def magnification(setup: Setup, state: Columns, volts: Array, refused: Array) -> Array:
    """Return by how much a step magnifies errors of rounding, (N,).

    It is the largest condition number of the corrections, times that by which the step magnifies a change of the
    voltages: far from a solution one correction magnifies what the one before it has.
    """
    fits, _, _ = descend(setup, begun(setup, state, refused)[0], volts, begun(setup, state, refused)[1])
    condition = np.max([np.linalg.cond(held(fit.H, setup.stiffness) / setup.stiffness) for fit in fits], axis=0)
    return condition * np.maximum(amplification(setup, state, volts, refused), 1)


def amplification(setup: Setup, state: Columns, volts: Array, refused: Array) -> Array:
    """Return by how much a step magnifies changes of what it is given, (N,).

    The largest gradient, by differences, of phases, yaw and residual, of alpha, by voltages, of alpha, phases and yaw.
    """
    sizes = {"X": setup.pitch / (2 * pi), "Y": setup.pitch / (2 * pi), "yaw": 1.0, "residual": setup.alpha}
    before, _ = step(setup, state, volts, refused)
    squares = {name: np.zeros(len(volts)) for name in sizes}
    for other, read in _changed(setup, state, volts):
        after, _ = step(setup, other, read, refused)
        for name, size in sizes.items():
            squares[name] += ((after[name] - before[name]) / size / CHANGE) ** 2
    return np.sqrt(np.max([*squares.values()], axis=0))


def _changed(setup: Setup, state: Columns, volts: Array) -> Iterator[tuple[Columns, Array]]:
    """Yield states and voltages of which one is changed at a time."""
    for channel in np.ndindex(volts.shape[1:]):
        moved = volts.copy()
        moved[(slice(None), *channel)] += CHANGE * setup.alpha
        yield state, moved
    for name in POSE:
        yield {**state, name: state[name] + CHANGE}, volts
