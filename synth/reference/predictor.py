"""Observers of position, rate and disturbance that predict a sample ahead, in NumPy: reference of `blocks.predictor`.

    q'' = g a + d for each axis, with the innovation nu = q measured - q predicted:
    q + alpha nu, v + beta nu, d + gamma nu; triple pole p = exp(-w T), alpha = 1 - p^3,
    beta = 3/2 (1 - p)^2 (1 + p) / T, gamma = (1 - p)^3 / T^2

An axis that learns has the gain g of its actuator as a state. Once its measurement is found frozen, what the
corrections since the last change of its code have added to the rate is taken back.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import exp
from typing import Any

import numpy as np
from numpy.typing import NDArray

from synth.reference.guard import by_row, rows

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
Columns = Mapping[str, NDArray[Any]]

LEAK = 1 / 512  # of what a sample forgets of the corrections since the last change


@dataclass(frozen=True)
class Axis:
    """An axis: bandwidth in rad/s, bounds of position, rate and disturbance, and whether it learns."""

    bandwidth: float
    low: float
    high: float
    rate: float
    disturbance: float
    learns: bool = False


@dataclass(frozen=True)
class Observers:
    """The axes by name, the period in s, and rate in 1/s and bounds of the gains that are learnt."""

    axes: Mapping[str, Axis]
    T: float
    learning: float
    gains: tuple[float, float]

    def each(self, what: str, like: Array) -> Array:
        """Return a number of each axis as a column."""
        return by_row([getattr(axis, what) for axis in self.axes.values()], like)

    @property
    def learning_axes(self) -> list[str]:
        """The axes that learn."""
        return [name for name, axis in self.axes.items() if axis.learns]


def positions(state: Columns, axes: Sequence[str]) -> Array:
    """Return the positions that are predicted for this sample (m, n)."""
    return rows(state, [f"observer_{s}_q" for s in axes])


def observe(
    state: Columns, q: Array, demand: Array, trusted: Flags, frozen: Flags, still: Array, ready: Flags, of: Observers
) -> tuple[Array, Array, Array, dict[str, Array]]:
    """Return position, rate and disturbance (m, n) after the correction by the pose q, and the next states.

    `demand` (m, n) are the accelerations that act. `trusted`, `frozen` and the samples without a change are those of
    the axes that learn.
    """
    T, learning = of.T, of.learning_axes
    learns = [name in learning for name in of.axes]
    p = by_row([exp(-axis.bandwidth * T) for axis in of.axes.values()], q)
    before, v, d = (rows(state, [f"observer_{s}_{n}" for s in of.axes]) for n in "qvd")
    nu = q - before
    rate, most = of.each("rate", q), of.each("disturbance", q)
    position = np.where(ready, before + (1 - p**3) * nu, q)
    correction = 1.5 * (1 - p) ** 2 * (1 + p) / T * nu
    at_change, gained = (rows(state, [f"observer_{s}_{n}" for s in learning]) for n in ("d_at_change", "gained"))
    # A correction of the rate is that of d times 3/2 T (1 + p) / (1 - p).
    learnt = (1.5 * T * (1 + p) / (1 - p))[learns] * (d[learns] - at_change) + T * gained
    corrected = v + correction
    corrected[learns] = np.where(trusted, corrected[learns], v[learns] - np.where(frozen, learnt, 0.0))
    v = np.where(ready, corrected, 0.0)
    d = np.where(ready, np.clip(d + (1 - p) ** 3 / T**2 * nu, -most, most), 0.0)
    d[learns] = np.where(trusted, d[learns], 0.0)
    same = trusted & (still >= 1)
    gained = np.where(same, (1 - LEAK) * gained + d[learns] - at_change, 0.0)
    at_change = np.where(same, at_change, d[learns])
    g, acting = rows(state, [f"observer_{s}_g" for s in learning]), demand.copy()
    next_gain = np.clip(g + of.learning * T * demand[learns] * d[learns], *of.gains)
    acting[learns] *= g
    a = acting + d
    next_q = np.clip(position + T * (v + T / 2 * a), of.each("low", q), of.each("high", q))
    next_v = np.clip(v + T * a, -rate, rate)
    after = {"q": next_q, "v": next_v, "d": d}
    next = {f"observer_{s}_{n}": row for n, each in after.items() for s, row in zip(of.axes, each, strict=True)}
    after = {"g": next_gain, "gained": gained, "d_at_change": at_change}
    next |= {f"observer_{s}_{n}": row for n, each in after.items() for s, row in zip(learning, each, strict=True)}
    return position, v, d, next
