"""Audit of the Kalman filter (6)-(16) of one axis: bandwidth, noise gain, and the recursion as printed.

The axes are decoupled in (7)-(13). Each has position, rate and acceleration, driven by a jerk of variance q through
Gamma of (11), and a position measured with the variance (5e-5)^2, m^2 or rad^2. The filter is the steady-state current
estimator, which uses the measurement of the same sample. Its bandwidth is the frequency at which the power gain from
the measured to the estimated position falls below a half. Noise is white, with the stage at rest.
"""

from functools import cache

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import brentq

from designs.planar_6dof import filtering
from synth.statespace import Array, StateSpace
from synth.synthesise.observers import kalman, square_root_kalman
from synth.timing import Discrete, period

SECONDS = 1.0  # after which the recursions are compared
NEAR = 1e-2  # relative: a gain this close to the steady one has converged


@cache
def steady(q: float, period_s: float, deviation: float) -> kalman.Estimator:
    """Return the steady-state filter of one axis."""
    return kalman.discrete(filtering.model("x", Discrete(period_s)), np.array([q]), np.array([deviation**2]), ("jerk",))


def half_power(form: StateSpace) -> float:
    """Return the frequency in Hz at which the power gain from measured to estimated position falls below a half."""
    T = period(form.time)

    def excess(frequency: ArrayLike) -> Array:
        return np.asarray(np.abs(form.response(np.exp(2j * np.pi * np.asarray(frequency) * T))[:, 0, 0]) ** 2 - 0.5)

    def excess_at(frequency: float) -> float:
        return float(excess(frequency)[0])

    grid = np.linspace(0, 0.5 / T, 400)[1:]
    last = int(np.flatnonzero(excess(grid) > 0)[-1])
    return float(brentq(excess_at, grid[last], grid[last + 1], xtol=1e-10)) if last + 1 < len(grid) else np.inf


def noise_gain(form: StateSpace) -> float:
    """Return the standard deviation of the estimated position over that of a white measurement."""
    X = kalman.stationary(form.A, form.B @ form.B.T, form.time)
    return float(np.sqrt((form.C @ X @ form.C.T + form.D @ form.D.T)[0, 0]))


@cache
def position_gains(q: float, period_s: float, deviation: float, p0: float, update: bool) -> Array:
    """Return the gain of the position (N,) over a second from P_0 = p0 I, with or without an update of P."""
    axis, V = filtering.model("x", Discrete(period_s)), deviation**2
    W = q * axis.B @ axis.B.T
    now, history = square_root_kalman.initial(axis, p0 * np.ones(3)), []
    for _ in range(round(SECONDS / period_s)):
        history.append(now.P[0, 0] / (now.P[0, 0] + V))
        now = square_root_kalman.update(now, axis, np.array([V]), np.zeros(1)) if update else now
        now = square_root_kalman.predict(now, axis, (W + W.T) / 2)
    return np.array(history)


def samples_to_converge(gains: Array, final: float) -> int:
    """Return the number of samples after which gains (N,) stay near the final one."""
    return int(np.flatnonzero(np.abs(gains / final - 1) > NEAR)[-1]) + 1


@cache
def deviation(q: float, period_s: float, bandwidth: float) -> float:
    """Return the measurement noise, a standard deviation, for which the filter has a given bandwidth in Hz."""

    def excess(log_deviation: float) -> float:
        return half_power(steady(q, period_s, float(np.exp(log_deviation))).current()) - bandwidth

    return float(np.exp(brentq(excess, np.log(1e-6), np.log(1e-3), xtol=1e-10)))
