"""Dead reckoning and braking in NumPy: reference of `blocks.dead_reckoning` and `blocks.braking`.

Each axis is the double integrator q'' = b d, sampled with d held over a period:

    (q, v) <- (q + T v + b d T^2/2, v + b d T)

A measured position corrects the prediction by a Luenberger observer whose two poles coincide, placed by the
characteristic polynomial (z - r)^2 with r = 1 - w T. A bridged one replaces it, but for an axis with a bias. d acts one
sample late. While it brakes, d is what leaves a part of the predicted rate.

Bias. A constant acceleration a besides b d leaves a steady error (e, v) of position and rate. It is (e, v) - M e after
the correction and (e, v) again after the prediction, which gives a and v for an e. The mean of e estimates it, and n
samples later, none of them measured, the rate is in error by v + n a T.
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
    """The acceleration b per unit of demand, the bandwidth w in rad/s, and the bounds of rate and position.

    `mean` is the pole of the mean innovation, 0 without one, and `unmeasured` is n.
    """

    b: float
    w: float
    fastest: float
    farthest: float
    mean: float = 0.0
    unmeasured: int = 0


@dataclass(frozen=True)
class Sample:
    """What a sample tells about the motion: measured positions, whether to trust them, and the demands that act.

    `begun` says whether a sample before was complete. `T` is the period in s, and `axes` has the model of each axis.
    """

    measured: Columns
    begun: Array
    trusted: Array
    acting: Columns
    T: float
    axes: Mapping[str, Axis]


def initial_state(axes: Iterable[str], with_mean: Iterable[str] = ()) -> dict[str, Array]:
    """Return the state after init, by name; axes `with_mean` know the mean of their innovation."""
    means = {f"reckoning_{axis}_mean": np.array(0.0) for axis in with_mean}
    return {f"reckoning_{axis}_{part}": np.array(0.0) for axis in axes for part in ("position", "rate")} | means


def predicted_pose(state: Columns, axes: Iterable[str]) -> dict[str, Array]:
    """Return the positions as predicted for this sample."""
    return {axis: state[f"reckoning_{axis}_position"] for axis in axes}


def correct(axis: str, state: Columns, now: Sample) -> tuple[Array, Array]:
    """Return position and rate after the measurement.

    At the first good sample, and where the sample is not complete, the position is that measured or bridged, and the
    rate stays as predicted. An axis with a mean innovation is bridged by its prediction, less what is added to it.
    """
    e, M = now.measured[axis] - state[f"reckoning_{axis}_position"], observer_gain(now.axes[axis].w, now.T)
    other = np.where(now.begun, 0.0, 1.0) if now.axes[axis].mean else np.array(1.0)
    position, rate = np.where(now.trusted, M[0], other), np.where(now.trusted, M[1], 0.0)
    return state[f"reckoning_{axis}_position"] + position * e, state[f"reckoning_{axis}_rate"] / now.T + rate * e


def observer_gain(w: float, T: float) -> Array:
    """Return the gain M (2,) on position and rate."""
    r = 1 - w * T
    A, C = np.array([[1.0, T], [0.0, 1.0]]), np.array([[1.0, 0.0]])
    characteristic = A @ A - 2 * r * A + r * r * np.eye(2)
    return np.asarray(np.linalg.solve(A, characteristic @ np.linalg.solve(np.vstack([C, C @ A]), [0.0, 1.0])))


def rate_error(axis: Axis, T: float) -> float:
    """Return the error of the rate for an innovation of 1, `unmeasured` samples after it.

    The steady error (e, v) of the prediction is x = A (x - M e) + (T^2/2, T) a; its first row gives v.
    """
    M = observer_gain(axis.w, T)
    a = M[1] / T  # of the second row: the correction of the rate is what a adds in a sample
    v = (M[0] + T * M[1] - a * T**2 / 2) / T
    return float(v + axis.unmeasured * a * T)


def next_rates(state: Columns, now: Sample) -> dict[str, Array]:
    """Return the rates of the next sample, when the demands of this one begin to act, less their bias."""
    rates = {}
    for name, acting in now.acting.items():
        axis, (_, v) = now.axes[name], correct(name, state, now)
        bias = rate_error(axis, now.T) * state[f"reckoning_{name}_mean"] if axis.mean else 0.0
        rates[name] = v + axis.b * now.T * acting + bias
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
        if r := now.axes[axis].mean:
            m, e = state[f"reckoning_{axis}_mean"], now.measured[axis] - state[f"reckoning_{axis}_position"]
            after[f"reckoning_{axis}_mean"] = np.where(now.trusted, r * m + (1 - r) * e, m)
    return after
