"""Jerk-limited motion to a target in NumPy: reference of `blocks.laws.jerk_limited`.

The acceleration of the next sample is the largest from which a stop ends at the target or before it, by one chord. The
stop is walked sample by sample: its acceleration is the one that brings the velocity to 0 soonest in whole samples.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]
LEAST = 1e-6  # of J T^3, in a denominator
RESTS = 1e-9  # of J T^2 and J T: a stop has ended
Columns = Mapping[str, Array]


@dataclass(frozen=True)
class Limits:
    """Limits V, A and J, the period T, and the width of the range of positions, by which the states are bounded."""

    V: float
    A: float
    J: float
    T: float
    width: float
    margin: float = 1e-3


def move(x: tuple[Array, Array, Array], j: Any, t: Array) -> tuple[Array, Array, Array]:
    """Return displacement, velocity and acceleration after the time t with the jerk j."""
    d, v, a = x
    return d + v * t + a * t**2 / 2 + j * t**3 / 6, v + a * t + j * t**2 / 2, a + j * t


def stop(v: Array, a: Array, of: Limits) -> Array:
    """Return the displacement of the stop."""
    x, one = (np.zeros_like(v), v, a), of.J * of.T
    while (np.abs(x[1]) > RESTS * one * of.T).any() or (np.abs(x[2]) > RESTS * one).any():
        to = np.clip(next_of_stop(x[1], x[2], of), -of.A, of.A)
        x = move(x, (to - x[2]) / of.T, np.asarray(of.T))
    return x[0]


def next_of_stop(v: Array, a: Array, of: Limits) -> Array:
    """Return the next acceleration of a stop without the limit A."""
    one = of.J * of.T
    return np.clip(one * fastest(-(v + a * of.T / 2) / (one * of.T)), a - one, a + one)


def fastest(y: Array) -> Array:
    """Return alpha for phi(alpha) + alpha/2 = y, phi linear between n^2/2 at whole n; both are odd."""
    n = np.floor((np.sqrt(1 + 8 * np.abs(y)) - 1) / 2)
    return np.sign(y) * (n + (np.abs(y) - n * (n + 1) / 2) / (n + 1))


def step(
    block: str, of: Limits, target: Array, measured: Array, ready: Array, state: Columns
) -> tuple[tuple[Array, Array, Array], dict[str, Array]]:
    """Return position, velocity and acceleration of the Block called `block`, and its next states."""
    goal, left, v, a = (state[f"{block}_{name}"] for name in ("goal", "left", "rate", "change"))
    now = np.where(ready, goal - left, measured), v, a
    left = np.where(ready, left + (target - goal), target - measured)
    step_of_a = of.J * of.T
    sign = np.where(left >= stop(v, a, of), 1.0, -1.0)
    r, v, a = sign * left, sign * v, sign * a  # towards a target that lies beyond the stop

    def ends_before(new: Array) -> Array:
        d, rate, _ = move((np.zeros_like(v), v, a), (new - a) / of.T, np.asarray(of.T))
        return np.asarray(r - d - stop(rate, new, of))

    braking = np.clip(next_of_stop(v, a, of), -of.A, of.A)
    limit = fastest((of.V - v) / (step_of_a * of.T) - a / step_of_a / 2) * step_of_a
    high = np.maximum(np.minimum(np.minimum(a + step_of_a, of.A), limit), a - step_of_a)
    left_over, short = r - stop(v, a, of), np.maximum(-ends_before(high), 0)
    chord = braking + (high - braking) * left_over / (left_over + short + LEAST * step_of_a * of.T**2)
    new = np.where(short <= 0, high, np.where(ends_before(chord) >= 0, chord, braking))
    new, v, a = sign * np.clip(new, -of.A, of.A), sign * v, sign * a
    d, rate, _ = move((np.zeros_like(v), v, a), (new - a) / of.T, np.asarray(of.T))
    distance = left - d
    arrived = (np.abs(distance) <= step_of_a * of.T**2) & (np.abs(rate) <= step_of_a * of.T) & (np.abs(a) <= step_of_a)
    bounds = {"left": of.width, "rate": of.V, "change": of.A}
    values = {
        "left": np.where(ready & arrived, 0.0, np.where(ready, distance, left)),
        "rate": np.where(ready & ~arrived, rate, 0.0),
        "change": np.where(ready & ~arrived, new, 0.0),
    }
    ends = {name: (1 + of.margin) * bound for name, bound in bounds.items()}
    clipped = {f"{block}_{name}": np.clip(v, -ends[name], ends[name]) for name, v in values.items()}
    return now, {f"{block}_goal": target} | clipped
