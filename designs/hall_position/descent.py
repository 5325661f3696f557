"""Corrections in a row, of which none may raise the cost: n of them, whatever the voltages.

    d_0 = 0;   J(d_i) <= J(best) + slack ?     yes: best = d_i, d_i+1 = d_i + scale * correction, in reach
                                               no:  d_i+1 = best + (d_i - best) / 4

The last one is not tried any more: it counts only where it is settled, less than a part of its standard deviation. Its
length in standard deviations is that in the metric of the normal equations, (correction' gradient)^(1/2) / deviation.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil, log2, pi, sqrt

import casadi as ca

from designs.hall_position import correction
from designs.hall_position.correction import AXES, Displacement, Equations, Sensor, Wave
from designs.hall_position.parameters import Array, Tuning
from synth.block import clip
from synth.signals import Signal

BACK = 0.25  # of a correction that has raised the cost
SLACK = 0.01  # of deviation^2: so much a cost may rise, by rounding
PART = 1.2  # rad: angles whose sine and cosine become polynomials are smaller
NONE = Displacement(dict.fromkeys(AXES, ca.SX(0)), ca.SX(0))

Named = list[tuple[Signal, ca.SX]]


@dataclass(frozen=True)
class Problem:
    """What is minimised, and within which displacement: `damping` in V^2, U and V up to `phase`, T up to `yaw`, rad.

    Phases are halved `halvings` times before they become polynomials.
    """

    array: Array
    tuning: Tuning
    damping: float
    phase: float
    yaw: float
    halvings: int


@dataclass(frozen=True, eq=False)
class Trial:
    """A displacement with its squared residuals and cost, V^2, and the equations there."""

    at: Displacement
    squares: ca.SX
    cost: ca.SX
    equations: Equations


@dataclass(frozen=True, eq=False)
class Found:
    """Where the corrections end, the last displacement that was tried, and whether they have converged."""

    at: Displacement
    last: Trial
    converged: ca.SX


def problem(array: Array, tuning: Tuning) -> Problem:
    """Return the problem; a yaw moves the phase of a sensor as far as U and V do, together by `tuning.reach`."""
    arm = max(abs(x) + abs(y) for x, y in array.arms)
    half = tuning.reach / 2
    yaw = sqrt(1 + 2 * half / arm) - 1  # arm (T + T^2/2) = half
    return Problem(array, tuning, tuning.damping * array.alpha**2, half, yaw, max(1, ceil(log2((pi + arm) / PART))))


def corrected(sensors: Sequence[Sensor], of: Problem, named: Named) -> Found:
    """Return what n corrections find from the base on; signals that are worth a name are added to `named`."""
    trial = _tried(sensors, NONE, 0, of, named)
    best, lowest, better = trial.at, trial.cost, ca.SX(1)
    for i in range(1, of.tuning.iterations):
        ahead = _towards(trial.at, _goal(trial, of), of.tuning.scale)
        at = _chosen(better, ahead, _towards(best, trial.at, BACK)) if i > 1 else ahead
        trial = _tried(sensors, at, i, of, named)
        better = trial.cost <= lowest + SLACK * of.array.deviation**2
        best, lowest = _chosen(better, trial.at, best), ca.if_else(better, trial.cost, lowest)
    goal = _goal(trial, of)
    settled = _decrease(trial, goal) <= (of.tuning.settled * of.array.deviation) ** 2
    converged = ca.logic_and(better, settled)
    return Found(_chosen(converged, _towards(trial.at, goal, of.tuning.scale), best), trial, converged)
