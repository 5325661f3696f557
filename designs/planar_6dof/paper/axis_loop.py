"""Stability margins and step responses of one axis under a lead-lag compensator, with ideal sensing.

An inertia m with a spring k, q'' = (f - k q) / m, under f = K(s) (r - q), K(s) = g (s - z1) (s - z2) / ((s - p) s).

    continuous   the loop K(s) / (m s^2 + k)
    held         the continuous loop times (1 - exp(-sT)) / (sT), and exp(-s tau) for a computation delay tau
    sampled      the exactly sampled plant, without delay. K is sampled by Tustin's rule for a step, and for margins by
                 the rule prewarped at the continuous crossover, where both agree

Steps start from rest at t = 0 and are relative to their size. The rise time is from 10 to 90 %. A time is infinite when
the record of RECORD_LENGTH seconds does not contain the event.

Source: Yu, Kim, section 5.2, (19)-(25).
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache
from math import pi

import numpy as np
from numpy.typing import NDArray

from synth import timing
from synth.analyse import time_response
from synth.analyse.loops import feedback_loop, loop, stability_margins, transfer
from synth.statespace import StateSpace
from synth.synthesise.classical import lead_lag
from synth.timing import Continuous

Array = NDArray[np.float64]

TIME_STEP, RECORD_LENGTH = 1e-5, 1.2  # s: the time step of continuous responses, and the length of all records
SETTLING_BAND = 0.02


@dataclass(frozen=True)
class Axis:
    """An inertia (kg, kg m^2) with a spring (N/m, N m/rad) under a compensator given by gain, zeros and poles."""

    inertia: float
    spring: float
    gain: float
    zeros: tuple[float, ...]
    poles: tuple[float, ...]

    @property
    def compensator(self) -> lead_lag.Compensator:
        """K(s)."""
        return lead_lag.Compensator(self.gain, self.zeros, self.poles)

    @property
    def plant(self) -> StateSpace:
        """1 / (m s^2 + k)."""
        A, B = np.array([[0.0, 1.0], [-self.spring / self.inertia, 0.0]]), np.array([[0.0], [1 / self.inertia]])
        return StateSpace(A, B, np.eye(2)[:1], np.zeros((1, 1)), ("q", "v"), ("f",), ("q",), Continuous())


@dataclass(frozen=True)
class Margin:
    """The crossover in Hz, phase margin in degrees and delay margin in s of a loop, and whether it is stable."""

    crossover: float
    phase: float
    delay: float
    stable: bool


@dataclass(frozen=True)
class Step:
    """Rise time in s, overshoot in % and settling time in s, the last time at which a step is outside its band."""

    rise: float
    overshoot: float
    settling: float


def vertical(inertia: float, spring: float, gain: float, lead: float, lag: float, reset: float) -> Axis:
    """Return an axis from the gain, zeros and pole of (23)-(25), in 1/s."""
    return Axis(inertia, spring, gain, (-lead, -reset), (-lag, 0.0))


def horizontal(inertia: float, gain: float, lead: float, lag: float, reset: float) -> Axis:
    """Return an axis from the gain and time constants of (21), (22), in s."""
    return vertical(inertia, 0.0, gain * lead * reset / lag, 1 / lead, 1 / lag, 1 / reset)


def scaled(axis: Axis, factor: float) -> Axis:
    """Return the axis with its gain times a factor."""
    return replace(axis, gain=factor * axis.gain)


def stable(axes: Sequence[Axis], hold_s: float, delay_s: float = 0.0) -> int:
    """Return how many axes are stable with a hold and a delay."""
    return sum(margin(axis, hold_s, delay_s).stable for axis in axes)


def integrating(axes: Sequence[Axis], order: float) -> int:
    """Return how many axes have a compensator of this order with exactly one integrator."""
    return sum(len(a.poles) == order and a.poles.count(0.0) == 1 for a in axes)


@cache
def margin(axis: Axis, hold_s: float = 0.0, delay_s: float = 0.0) -> Margin:
    """Return the margins of the continuous loop, or with `hold_s` of the held loop with a delay."""
    L = feedback_loop.close(axis.plant, axis.compensator.model).L
    return _margin(transfer.with_delay_and_hold(L, delay_s, hold_s) if hold_s else L)


@cache
def sampled_margin(axis: Axis, period_s: float) -> Margin:
    """Return the margins of the sampled loop."""
    rule = lead_lag.prewarped(axis.compensator, period_s, 2 * pi * margin(axis).crossover)
    return _margin(_sampled_loop(axis, rule).L)


@cache
def step(axis: Axis) -> Step:
    """Return the step response figures of the continuous loop."""
    T = feedback_loop.close(axis.plant, axis.compensator.model).T
    poles, V = np.linalg.eig(T.A)
    time: Array = np.arange(round(RECORD_LENGTH / TIME_STEP), dtype=np.float64) * TIME_STEP
    residues = (T.C @ V)[0] * np.linalg.solve(V, T.B)[:, 0] / poles
    return of_response(time, 1 + (np.exp(np.outer(time, poles)) @ residues).real)


@cache
def sampled_step(axis: Axis, period_s: float) -> Step:
    """Return the step response figures of the sampled loop."""
    response = time_response.step_response(
        _sampled_loop(axis, lead_lag.tustin(axis.compensator, period_s, 1 / period_s)).T, RECORD_LENGTH - period_s
    )
    return of_response(response.time, response.outputs[:, 0, 0])


def of_response(time: Array, y: Array, band: float = SETTLING_BAND) -> Step:
    """Return rise, overshoot and settling of a record y (N,) of a step from 0 to 1 at time[0], s."""
    outside = np.flatnonzero(np.abs(y - 1) > band)
    settling = 0.0 if not len(outside) else time[outside[-1]] - time[0] if outside[-1] + 1 < len(y) else np.inf
    return Step(
        _first_time_above(time, y, 0.9) - _first_time_above(time, y, 0.1), 100 * (float(y.max()) - 1), float(settling)
    )


def gain_at(axis: Axis, frequency: float) -> float:
    """Return |L| of the continuous loop at a frequency in Hz."""
    s = 2j * pi * frequency
    return float(abs(axis.plant.response(s)[0, 0, 0] * axis.compensator.model.response(s)[0, 0, 0]))


def _sampled_loop(axis: Axis, rule: lead_lag.LeadLag) -> feedback_loop.ClosedLoop:
    return feedback_loop.close(loop.sampled(axis.plant, timing.period(rule.discrete.time)), rule.discrete)


def _margin(L: transfer.Loop) -> Margin:
    of_loop = stability_margins.of_loop(L)
    last = max(of_loop.gain_crossings, key=lambda c: c.frequency)
    return Margin(last.frequency / (2 * pi), last.phase_margin, last.delay_margin, of_loop.stable)


def _first_time_above(time: Array, y: Array, level: float) -> float:
    """Return the first time of a sample at or above a level."""
    return float(time[np.argmax(y >= level)]) if (y >= level).any() else np.inf
