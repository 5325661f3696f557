"""Corrections in a row, of which none may raise the cost: n of them, whatever the voltages.

    d_0 = 0;   J(d_i) <= J(best) + slack ?     yes: best = d_i, d_i+1 = d_i + scale * correction, in reach
                                               no:  d_i+1 = (best + d_i) / 2

i = 0 .. n-1: the Jacobian and the cost are computed n times. d_n is not tried any more: it counts only where it is
settled, less than a part of its standard deviation from d_n-1; else the best one stands. The distance in standard
deviations is that in the metric of the normal equations, (gradient' N^-1 gradient)^(1/2) / deviation.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil, hypot, log2, pi, sqrt

import casadi as ca

from designs.hall_position.glsdc import correction
from designs.hall_position.glsdc.correction import AXES, Displacement, Equations, Sensor, Wave
from designs.hall_position.glsdc.parameters import Array, Tuning
from synth.block import clip
from synth.signals import Signal

SLACK, ROUNDING = 0.01, 2e-6  # of deviation^2, and of itself: so much a cost may rise, by rounding
PART = 1.2  # rad: angles whose sine and cosine become polynomials are smaller
NONE = Displacement(dict.fromkeys(AXES, ca.SX(0)), ca.SX(0))

Named = list[tuple[Signal, ca.SX]]


@dataclass(frozen=True)
class Problem:
    """What is minimised, and within which displacement: `damping` in V^2, U and V up to `phase`, T up to `yaw`, rad.

    Phases are halved `halvings` times before they become polynomials. A voltage is within `expected` V rms of what the
    last motion leads to.
    """

    array: Array
    tuning: Tuning
    damping: float
    phase: float
    yaw: float
    halvings: int
    expected: float


@dataclass(frozen=True, eq=False)
class Trial:
    """A displacement with its squared residuals, of each sensor and in all, its cost, V^2, and the equations there.

    `moved` is the square of the displacement, rad^2, its yaw times the mean arm.
    """

    at: Displacement
    by_sensor: Sequence[ca.SX]
    squares: ca.SX
    moved: ca.SX
    cost: ca.SX
    equations: Equations


@dataclass(frozen=True, eq=False)
class Found:
    """Where the corrections end, the first and the last displacement tried, and whether they have converged."""

    at: Displacement
    first: Trial
    last: Trial
    converged: ca.SX


def problem(array: Array, tuning: Tuning) -> Problem:
    """Return the problem; a yaw moves the phase of a sensor as far as U and V do, together by `tuning.reach`."""
    arm = max(abs(x) + abs(y) for x, y in array.arms)
    half = tuning.reach / 2
    yaw = sqrt(1 + 2 * half / arm) - 1  # arm (T + T^2/2) = half
    expected = hypot(tuning.residual, tuning.surprise * array.deviation / sqrt(tuning.damping))
    return Problem(array, tuning, tuning.damping * array.alpha**2, half, yaw, _halvings(pi + half + arm), expected)


def _halvings(angle: float) -> int:
    return max(1, ceil(log2(angle / PART)))


def corrected(sensors: Sequence[Sensor], of: Problem, named: Named) -> Found:
    """Return what n corrections find from the base on; signals that are worth a name are added to `named`."""
    trial = first = _tried(sensors, NONE, 0, of, named)
    best, lowest, better = trial.at, trial.cost, ca.SX(1)
    for i in range(1, of.tuning.iterations):
        trial = _tried(sensors, _next(trial, better, best, of), i, of, named)
        better = trial.cost <= (1 + ROUNDING) * lowest + SLACK * of.array.deviation**2
        best, lowest = _chosen(better, trial.at, best), ca.if_else(better, trial.cost, lowest)
    ahead = _next(trial, ca.SX(1), best, of)
    settled = _decrease(trial.equations) <= (of.tuning.settled * of.array.deviation) ** 2
    converged = ca.logic_and(better, settled)
    return Found(_chosen(converged, ahead, best), first, trial, converged)


def turned(yaw: ca.SX, named: Named) -> tuple[Wave, ca.SX]:
    """Return the wave of a small yaw, and 1 - cos, which is 2 sin^2 of its half."""
    sine, half = ca.sin(yaw), sqrt(2) * ca.sin(yaw / 2)
    named.append((Signal("turn_sine", "1", -1, 1, "of the yaw since the sample began"), sine))
    named.append((Signal("half_sine", "1", -2, 2, "of half of it, times sqrt(2)"), half))
    return Wave(sine, 1 - half**2), half**2


def _tried(sensors: Sequence[Sensor], at: Displacement, i: int, of: Problem, named: Named) -> Trial:
    damping, radius = of.damping, of.array.radius
    firm = of.tuning.firm * radius
    rows = correction.rows(sensors, at, *turned(at.yaw, named)) if i else correction.base_rows(sensors)
    squares = correction.squares(rows)
    along = at.phase["x"] ** 2 + at.phase["y"] ** 2
    moved = along + radius**2 * at.yaw**2
    cost = squares + damping * (along + firm**2 * at.yaw**2) if i else squares
    named.append((Signal(f"cost_{i}", "V^2", 0, 1e9, "squared residuals and damping"), cost))
    by_sensor = correction.squares_by_sensor(rows)
    equations = correction.equations(rows, at, damping, firm)
    return Trial(at, by_sensor, squares, moved, cost, equations)


def _next(trial: Trial, better: ca.SX, best: Displacement, of: Problem) -> Displacement:
    """Return the next displacement to try: from a better one where the equations lead to, else halfway back.

    Where the yaw comes to the end of its reach, the phases fit the yaw there.
    """
    at, e, scale = trial.at, trial.equations, of.tuning.scale
    ahead = at.yaw + scale * (e.right / e.information)
    yaw = clip(ca.if_else(better, ahead, (at.yaw + best.yaw) / 2), Signal("yaw", "rad", -of.yaw, of.yaw))
    turn, phase = yaw - at.yaw, {}
    for axis, n in e.axes.items():
        ahead = at.phase[axis] + (scale * n.slope - n.coupling * turn) * n.inverse
        wanted = ca.if_else(better, ahead, (at.phase[axis] + best.phase[axis]) / 2)
        phase[axis] = clip(wanted, Signal("phase", "rad", -of.phase, of.phase))
    return Displacement(phase, yaw)


def _decrease(e: Equations) -> ca.SX:
    """Return gradient' N^-1 gradient, V^2: what a whole correction takes off the cost, to first order."""
    total = e.right**2 / e.information
    for n in e.axes.values():
        total += n.slope**2 * n.inverse
    return total


def _chosen(condition: ca.SX, then: Displacement, other: Displacement) -> Displacement:
    phase = {axis: ca.if_else(condition, then.phase[axis], other.phase[axis]) for axis in AXES}
    return Displacement(phase, ca.if_else(condition, then.yaw, other.yaw))
