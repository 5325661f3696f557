"""Dead reckoning and braking in NumPy: reference of `blocks.dead_reckoning` and `blocks.braking`.

Each axis is the double integrator q'' = b d, sampled with d held over a period:

    (q, v) <- (q + T v + b d T^2/2, v + b d T)

A measured position corrects the prediction by a Luenberger observer whose two poles coincide, placed by the
characteristic polynomial (z - r)^2 with r = 1 - w T. A bridged one replaces it, but for an axis with a bias. d acts one
sample late. While it brakes, d is what leaves a part of the predicted rate.

Disturbance. An axis with one has its acceleration d as a third state, used one sample late, and a third pole:
(z - r)^2 (z - r_d).

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

    `mean` is the pole of the mean innovation, 0 without one, and `unmeasured` is n. `learns` is the bandwidth in rad/s
    of the disturbance, 0 without one, and `largest` the largest disturbance.
    """

    b: float
    w: float
    fastest: float
    farthest: float
    mean: float = 0.0
    unmeasured: int = 0
    learns: float = 0.0
    largest: float = 0.0


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


def initial_state(
    axes: Iterable[str], with_mean: Iterable[str] = (), with_disturbance: Iterable[str] = ()
) -> dict[str, Array]:
    """Return the state after init, by name, of axes, those with a mean innovation, and those with a disturbance."""
    parts = [(axis, part) for axis in axes for part in ("position", "rate")]
    parts += [*((axis, "mean") for axis in with_mean), *((axis, "disturbance") for axis in with_disturbance)]
    return {f"reckoning_{axis}_{part}": np.array(0.0) for axis, part in parts}


def predicted_pose(state: Columns, axes: Iterable[str]) -> dict[str, Array]:
    """Return the positions as predicted for this sample."""
    return {axis: state[f"reckoning_{axis}_position"] for axis in axes}


def correct(axis: str, state: Columns, now: Sample) -> tuple[Array, Array]:
    """Return position and rate after the measurement.

    At the first good sample, and where the sample is not complete, the position is that measured or bridged, and the
    rate stays as predicted. An axis with a mean innovation is bridged by its prediction, less what is added to it.
    """
    e, M = now.measured[axis] - state[f"reckoning_{axis}_position"], observer_gain(now.axes[axis], now.T)
    other = np.where(now.begun, 0.0, 1.0) if now.axes[axis].mean else np.array(1.0)
    position, rate = np.where(now.trusted, M[0], other), np.where(now.trusted, M[1], 0.0)
    return state[f"reckoning_{axis}_position"] + position * e, state[f"reckoning_{axis}_rate"] / now.T + rate * e


def observer_gain(axis: Axis, T: float) -> Array:
    """Return the gain M on position and rate (2,), and on the disturbance, if there is one (3,).

    The pair (A, C) is that of the errors of the prediction, and A M what an innovation adds to the next of them. The
    disturbance that is learnt in a sample acts in the next one, so there M is on the states without it.
    """
    n = 3 if axis.learns else 2
    A, C = np.array([[1.0, T, T**2 / 2], [0.0, 1.0, T], [0.0, 0.0, 1.0]])[:n, :n], np.eye(1, n)
    poles = [1 - axis.w * T, 1 - axis.w * T, 1 - axis.learns * T][:n]
    characteristic, observability = np.eye(n), np.vstack([C @ np.linalg.matrix_power(A, k) for k in range(n)])
    for pole in poles:
        characteristic = characteristic @ (A - pole * np.eye(n))
    added = characteristic @ np.linalg.solve(observability, np.eye(n)[-1])
    return np.array([added[0] - T * added[1], *added[1:]])


def rate_error(axis: Axis, T: float) -> float:
    """Return the error of the rate for an innovation of 1, `unmeasured` samples after it.

    The steady error (e, v) of the prediction is x = A (x - M e) + (T^2/2, T) a; its first row gives v.
    """
    M = observer_gain(axis, T)
    a = M[1] / T  # of the second row: the correction of the rate is what a adds in a sample
    v = (M[0] + T * M[1] - a * T**2 / 2) / T
    return float(v + axis.unmeasured * a * T)


def next_rates(state: Columns, now: Sample) -> dict[str, Array]:
    """Return the rates of the next sample, when the demands of this one begin to act, less their bias."""
    rates = {}
    for name, acting in now.acting.items():
        axis, (_, v) = now.axes[name], correct(name, state, now)
        bias = rate_error(axis, now.T) * state[f"reckoning_{name}_mean"] if axis.mean else 0.0
        rates[name] = v + (axis.b * acting + disturbance(name, state, now)) * now.T + bias
    return rates


def disturbance(name: str, state: Columns, now: Sample) -> Array:
    """Return the acceleration besides b d that an axis knows, 0 for one without a disturbance."""
    return np.asarray(state[f"reckoning_{name}_disturbance"] * 2 / now.T**2 if now.axes[name].learns else 0.0)


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
        acting = now.axes[axis].b * demand + disturbance(axis, state, now)
        values = {"position": at + T * v + acting * T**2 / 2, "rate": (v + acting * T) * T}
        bounds = {"position": now.axes[axis].farthest, "rate": now.axes[axis].fastest * T}
        after |= {f"reckoning_{axis}_{n}": np.clip(u, -bounds[n], bounds[n]) for n, u in values.items()}
        e = now.measured[axis] - state[f"reckoning_{axis}_position"]
        if now.axes[axis].learns:
            h, most = state[f"reckoning_{axis}_disturbance"], now.axes[axis].largest * T**2 / 2
            learnt = np.clip(h + observer_gain(now.axes[axis], T)[2] * T**2 / 2 * e, -most, most)
            after[f"reckoning_{axis}_disturbance"] = np.where(now.trusted, learnt, h)
        if r := now.axes[axis].mean:
            m = state[f"reckoning_{axis}_mean"]
            after[f"reckoning_{axis}_mean"] = np.where(now.trusted, r * m + (1 - r) * e, m)
    return after
