"""Jerk-limited motion to a target in NumPy: reference of `blocks.laws.jerk_limited`.

The acceleration of the next sample is the largest from which the fastest stop ends at the target or before it, by
bisection. The stop is three pieces of constant jerk -J, 0 and J, each integrated from the state in which the one before
it ends.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]
Columns = Mapping[str, Array]
HALVINGS = 10


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
    """Return the displacement of the fastest stop."""
    sign = np.where(v + a * np.abs(a) / (2 * of.J) >= 0, 1.0, -1.0)
    x = (np.zeros_like(v), sign * v, sign * a)
    peak = np.minimum(np.sqrt(np.maximum(of.J * x[1] + x[2] ** 2 / 2, 0)), of.A)
    braked = move(x, -of.J, (x[2] + peak) / of.J)
    excess = braked[1] - peak**2 / (2 * of.J)  # of velocity, beyond what the last piece takes
    held = move(braked, 0.0, np.where(peak < of.A, 0.0, np.maximum(excess, 0) / of.A))
    return sign * move(held, of.J, peak / of.J)[0]


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
    limits = [fastest((end - v) / (step_of_a * of.T) - a / step_of_a / 2) * step_of_a for end in (of.V, -of.V)]
    high = np.maximum(np.minimum(np.minimum(a + step_of_a, of.A), limits[0]), a - step_of_a)
    low = np.minimum(np.maximum(np.maximum(a - step_of_a, -of.A), limits[1]), a + step_of_a)

    def after(new: Array) -> tuple[Array, Array]:
        d, rate, _ = move((np.zeros_like(v), v, a), (new - a) / of.T, np.asarray(of.T))
        return left - d, rate

    def can_stop(new: Array) -> Array:
        distance, rate = after(new)
        return np.asarray(distance - stop(rate, new, of) >= 0)

    best = can_stop(high)
    top = high
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        low, high = np.where(can_stop(middle), middle, low), np.where(can_stop(middle), high, middle)
    new = np.where(best, top, low)
    distance, rate = after(new)
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
