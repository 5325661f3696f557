"""Dead reckoning and braking in NumPy: reference of `blocks.dead_reckoning` and `blocks.braking`.

Each axis is the double integrator q'' = b d, sampled with d held over a period:

    (q, v) <- (q + T v + b d T^2/2, v + b d T)

A measured position corrects the prediction by a Luenberger observer whose two poles coincide, placed by the
characteristic polynomial (z - r)^2 with r = 1 - w T. A bridged one replaces it. d acts one sample late. While it
brakes, d is what leaves a part of the predicted rate.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]
Columns = Mapping[str, Array]


@dataclass(frozen=True)
class Axis:
    """The acceleration b per unit of demand, the bandwidth w in rad/s, and the bounds of rate and position."""

    b: float
    w: float
    fastest: float
    farthest: float


@dataclass(frozen=True)
class Sample:
    """What a sample tells about the motion: measured positions, whether to trust them, and the demands that act.

    `T` is the period in s, and `axes` has the model of each axis.
    """

    measured: Columns
    trusted: Array
    acting: Columns
    T: float
    axes: Mapping[str, Axis]


def initial_state(axes: Iterable[str]) -> dict[str, Array]:
    """Return the state after init, by name."""
    return {f"reckoning_{axis}_{part}": np.array(0.0) for axis in axes for part in ("position", "rate")}


def predicted_pose(state: Columns, axes: Iterable[str]) -> dict[str, Array]:
    """Return the positions as predicted for this sample."""
    return {axis: state[f"reckoning_{axis}_position"] for axis in axes}


def correct(axis: str, state: Columns, now: Sample) -> tuple[Array, Array]:
    """Return position and rate after the measurement.

    At the first good sample, and where the sample is not complete, the position is that measured or bridged, and the
    rate stays as predicted.
    """
    T, r, e = now.T, 1 - now.axes[axis].w * now.T, now.measured[axis] - state[f"reckoning_{axis}_position"]
    A, C = np.array([[1.0, T], [0.0, 1.0]]), np.array([[1.0, 0.0]])
    characteristic = A @ A - 2 * r * A + r * r * np.eye(2)
    M = np.linalg.solve(A, characteristic @ np.linalg.solve(np.vstack([C, C @ A]), [0.0, 1.0]))
    position, rate = (np.where(now.trusted, gain, first) for gain, first in zip(M, (1.0, 0.0), strict=True))
    return state[f"reckoning_{axis}_position"] + position * e, state[f"reckoning_{axis}_rate"] / T + rate * e


def next_rates(state: Columns, now: Sample) -> dict[str, Array]:
    """Return the rates of the next sample, when the demands of this one begin to act."""
    rates = {}
    for axis, acting in now.acting.items():
        _, v = correct(axis, state, now)
        rates[axis] = v + now.axes[axis].b * now.T * acting
    return rates


def brake(
    demands: Columns, rates: Columns, stops: Array, T: float, inertias: Mapping[str, float], remaining: float
) -> dict[str, Array]:
    """Return the demands as forces; while the machine brakes, those that leave the part `remaining` of the rates."""
    after: dict[str, Array] = {}
    for axis, d in demands.items():
        braking = (remaining - 1) * rates[axis] / T * inertias[axis]
        after[axis] = np.where(stops, braking, d)
    return after


def next_state(state: Columns, now: Sample) -> dict[str, Array]:
    """Return the next predictions; what the law achieved in the sample before acts until the next one."""
    T, after = now.T, dict[str, Array]()
    for axis, demand in now.acting.items():
        at, v = correct(axis, state, now)
        acting = now.axes[axis].b * demand
        values = {"position": at + T * v + acting * T**2 / 2, "rate": (v + acting * T) * T}
        bounds = {"position": now.axes[axis].farthest, "rate": now.axes[axis].fastest * T}
        after |= {f"reckoning_{axis}_{n}": np.clip(u, -bounds[n], bounds[n]) for n, u in values.items()}
    return after
