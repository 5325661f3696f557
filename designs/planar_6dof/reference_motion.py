"""NumPy reference of the planar controllers' dead reckoning and braking.

Each axis is the double integrator q'' = b d, sampled with d held over a period:

    (q, v) <- (q + T v + b d T^2/2, v + b d T)

A measured position corrects the prediction by a Luenberger observer whose two poles coincide, placed by the
characteristic polynomial (z - r)^2 with r = 1 - w T. A bridged one replaces it. d acts one sample late. While it
brakes, d is what halves the predicted rate.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from designs.planar_6dof import reference_control as control

Array = NDArray[Any]
Columns = Mapping[str, Array]

MASS, INERTIA = 1.52, 0.0022  # kg, kg m^2
INERTIAS = {"x": MASS, "y": MASS, "phi": INERTIA}
FASTEST = {"x": 2.0, "y": 2.0, "phi": 40.0}  # m/s, rad/s
FARTHEST = {"x": 0.2, "y": 0.2, "phi": 0.05}  # m, rad
BRAKING = 24  # samples
REMAINING = 0.5  # of the rate, after a braking sample


@dataclass(frozen=True)
class Sample:
    """What a sample tells about the motion: positions (m, rad), whether to trust them, the demands in A that act.

    `T` is the period in s, and `w` has the bandwidth of each axis in rad/s.
    """

    measured: Columns
    trusted: Array
    acting: Columns
    T: float
    w: Mapping[str, float]


def initial_state() -> dict[str, Array]:
    """Return the state after init, by name."""
    names = [f"reckoning_{axis}_{part}" for axis in INERTIAS for part in ("position", "rate")]
    return {name: np.array(0.0) for name in names}


def predicted_pose(state: Columns) -> dict[str, Array]:
    """Return x, y and phi as predicted for this sample, m and rad."""
    return {axis: state[f"reckoning_{axis}_position"] for axis in INERTIAS}


def acceleration(axis: str) -> float:
    """Return b of an axis in m/s^2 or rad/s^2 per A of demand."""
    return control.scales()[axis] / INERTIAS[axis]


def correct(axis: str, state: Columns, now: Sample) -> tuple[Array, Array]:
    """Return position and rate (m and m/s, rad and rad/s) after the measurement.

    At the first good sample, and where the sample is not complete, the position is that measured or bridged, and the
    rate stays as predicted.
    """
    T, r, e = now.T, 1 - now.w[axis] * now.T, now.measured[axis] - state[f"reckoning_{axis}_position"]
    A, C = np.array([[1.0, T], [0.0, 1.0]]), np.array([[1.0, 0.0]])
    characteristic = A @ A - 2 * r * A + r * r * np.eye(2)
    M = np.linalg.solve(A, characteristic @ np.linalg.solve(np.vstack([C, C @ A]), [0.0, 1.0]))
    position, rate = (np.where(now.trusted, gain, first) for gain, first in zip(M, (1.0, 0.0), strict=True))
    return state[f"reckoning_{axis}_position"] + position * e, state[f"reckoning_{axis}_rate"] / T + rate * e


def next_rates(state: Columns, now: Sample) -> dict[str, Array]:
    """Return the rates of the next sample, when the demands of this one begin to act, m/s and rad/s."""
    rates = {}
    for axis, acting in now.acting.items():
        _, v = correct(axis, state, now)
        rates[axis] = v + acceleration(axis) * now.T * acting
    return rates


def brake(demands: Columns, rates: Columns, stops: Array, T: float) -> dict[str, Array]:
    """Return the demands in N and N m; while the platen brakes, those that leave a part of the rates."""
    after: dict[str, Array] = {}
    for axis, d in demands.items():
        braking = (REMAINING - 1) * rates[axis] / T * INERTIAS[axis]
        after[axis] = np.where(stops, braking, d)
    return after


def next_state(state: Columns, now: Sample) -> dict[str, Array]:
    """Return the next predictions; what the law achieved in the sample before acts until the next one."""
    T, after = now.T, dict[str, Array]()
    for axis, demand in now.acting.items():
        at, v = correct(axis, state, now)
        acting = acceleration(axis) * demand
        values = {"position": at + T * v + acting * T**2 / 2, "rate": (v + acting * T) * T}
        bounds = {"position": FARTHEST[axis], "rate": FASTEST[axis] * T}
        after |= {f"reckoning_{axis}_{n}": np.clip(u, -bounds[n], bounds[n]) for n, u in values.items()}
    return after
