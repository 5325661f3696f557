"""GLSDC of (X, Y, yaw): cost function over the model `hall_planar`, and the normal equations of one correction.

    minimise  J(d) = sum over sensors k |R(yaw) V_k - B(P_k)|^2 + lambda (U^2 + V^2 + radius^2 T^2),   d = (U, V, T)

for the displacement d from the predicted pose: U, V phases of the centre in rad, T the yaw. The Jacobian of
`hall_planar` is sparse, [g_X, 0, h_X] and [0, g_Y, h_Y]: U and V are eliminated one by one. With N_X = lambda +
sum g_X^2 the information on the yaw is a sum of squares by Lagrange's identity. It needs no difference of large numbers
and is never less than lambda radius^2. The radius is the sensors' rms arm times yaw_damping_ratio:

    N_T = lambda radius^2 + sum over X, Y of [sum over pairs (g_i h_j - g_j h_i)^2 + lambda sum h^2] / N

Source: Kawato, Kim, "A Novel Multi-DOF Precision Positioning Methodology Using Two-Axis Hall-Effect Sensors", section
3.B, Fig. 9.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from itertools import combinations
from math import hypot, pi, sqrt
from string import ascii_lowercase
from typing import NamedTuple

import casadi as ca

from designs.hall_position.glsdc.parameters import Tuning
from models import hall_planar
from models.hall_planar import Row, Sensor
from models.hall_two_waves import PlanarArray
from synth.block import Exprs
from synth.blocks import phasor
from synth.blocks.glsdc import Descent, LimitStep, NamedExpressions, Trial, Vector, total
from synth.blocks.phasor import Phasor
from synth.signals import Signal

AXES = ("x", "y")
COST_SLACK, ROUNDING = 0.01, 2e-6  # of deviation^2, and relative: the rise of the cost allowed for rounding


@dataclass(frozen=True)
class Problem:
    """The cost function with its `damping` in V^2, and how it is minimised.

    Phases are halved `halvings` times before sine and cosine are polynomials. Innovations of healthy sensors are within
    `innovation_bound` V rms.
    """

    array: PlanarArray
    tuning: Tuning
    descent: Descent
    damping: float
    halvings: int
    innovation_bound: float


class Axis(NamedTuple):
    """One axis of the normal equations, N U + coupling T = slope, with `inverse` = 1/N.

    `information` and `gain` are its contributions, times N, to N_T and to the right side after elimination of U.
    """

    inverse: ca.SX
    coupling: ca.SX
    slope: ca.SX
    information: ca.SX
    gain: ca.SX


@dataclass(frozen=True, eq=False)
class Normal:
    """Normal equations of the axes and of the yaw, N_T T = `right`, with `information` = N_T.

    `data_information` is N_T without the damping of the yaw.
    """

    axes: Sequence[Axis]
    information: ca.SX
    data_information: ca.SX
    right: ca.SX
    scale: float

    @property
    def decrease(self) -> ca.SX:
        """gradient' N^-1 gradient, V^2."""
        decrease = self.right**2 / self.information
        for n in self.axes:
            decrease += n.slope**2 * n.inverse
        return decrease

    def solve(self, choose: LimitStep) -> list[ca.SX]:
        """Return the end of a scaled correction: the yaw first, then the phases for the yaw as limited."""
        yaw, yaw_change = choose(2, self.scale * (self.right / self.information))
        ends = [
            choose(i, (self.scale * n.slope - n.coupling * yaw_change) * n.inverse)[0] for i, n in enumerate(self.axes)
        ]
        return [*ends, yaw]


def problem(array: PlanarArray, tuning: Tuning) -> Problem:
    """Return the problem; the yaw and U, V each move a sensor's phase by half of `tuning.max_phase_step` at most."""
    half = tuning.max_phase_step / 2
    sizes = zip((*AXES, "yaw"), (half, half, array.yaw_within(half)), strict=True)
    bounds = tuple(Signal(f"motion_{name}", "rad", -size, size) for name, size in sizes)
    variance = array.deviation**2
    descent = Descent(
        tuning.iterations, bounds, COST_SLACK * variance, (tuning.convergence_sigma * array.deviation) ** 2, ROUNDING
    )
    innovation_bound = hypot(
        tuning.residual_limit, tuning.innovation_gate_sigma * array.deviation / sqrt(tuning.damping)
    )
    halvings = phasor.halvings(pi + half + array.longest_arm)
    return Problem(array, tuning, descent, tuning.damping * array.alpha**2, halvings, innovation_bound)


def sensors(
    u: Exprs, pose: Exprs, k: Exprs, heading: Phasor, excluded: Vector | None, problem: Problem, named: NamedExpressions
) -> list[Sensor]:
    """Return the sensors at the predicted pose; an excluded one has zero voltages in a zero field.

    They are multiplied by 0: CasADi would copy a conditional into every correction.
    """

    def sensor(n: int) -> Sensor:
        letter, (ax, ay) = ascii_lowercase[n], problem.array.arms[n]

        def if_in_use(value: ca.SX) -> ca.SX:
            return value if excluded is None else (1 - excluded[n]) * value

        place = heading.times(Phasor(ca.SX(ax), ca.SX(ay)))
        at = pose["phase_x"] + place.cosine, pose["phase_y"] + place.sine
        x, y = (phasor.by_range_reduction(p, problem.halvings, "phase_fraction", named) for p in at)
        vx, vy = (if_in_use(u[f"V_{letter}{a}_held"]) for a in AXES)
        field = [if_in_use(ca.SX(problem.array.c)), *(if_in_use(k[f"field_{i}"]) for i in hall_planar.POWERS)]
        slope = [if_in_use(k[f"slope_{i - 1}"]) for i in hall_planar.POWERS]
        return Sensor((x, y), place, heading.times(Phasor(vx, vy)), field, slope)

    return [sensor(n) for n in range(len(problem.array.positions))]


def trial_function(
    sensors: Sequence[Sensor], problem: Problem, named: NamedExpressions
) -> Callable[[int, Vector], Trial[Normal]]:
    """Return the function that evaluates the i-th trial at a displacement (U, V, T)."""
    damping, radius = problem.damping, problem.tuning.yaw_damping_ratio * problem.array.radius

    def trial(i: int, at: Vector) -> Trial[Normal]:
        at_trial = hall_planar.displace(sensors, at, named) if i else sensors
        by_axis = tuple(zip(*map(hall_planar.residual_rows, at_trial), strict=True))
        residuals = [r.e for rows in by_axis for r in rows]
        squares = total(e**2 for e in residuals)
        cost = squares + damping * squared_motion(at, radius)
        named.append(
            (Signal(f"cost_{i}", "V^2", 0, 1e9, f"cost of correction {i}: squared residuals and damping"), cost)
        )
        return Trial(at, residuals, squares, cost, _normal(by_axis, at, damping, radius, problem.tuning.scale))

    return trial


def squared_motion(at: Vector, radius: float) -> ca.SX:
    """Return U^2 + V^2 + radius^2 T^2, rad^2."""
    return at[0] ** 2 + at[1] ** 2 + radius**2 * at[2] ** 2


def _normal(by_axis: Iterable[Sequence[Row]], at: Vector, damping: float, radius: float, scale: float) -> Normal:
    axes = [_axis(rows, phase, damping) for rows, phase in zip(by_axis, at, strict=False)]
    stiffness = damping * radius**2
    data = total(n.information * n.inverse for n in axes)
    return Normal(axes, stiffness + data, data, total(n.gain * n.inverse for n in axes) - stiffness * at[2], scale)


def _axis(rows: Sequence[Row], phase: ca.SX, damping: float) -> Axis:
    coupling = total(r.g * r.h for r in rows)
    moment = total(r.h * r.e for r in rows)
    information, gain = damping * total(r.h**2 for r in rows), damping * (moment + phase * coupling)
    for a, b in combinations(rows, 2):
        across = a.g * b.h - b.g * a.h
        information, gain = information + across**2, gain + across * (a.g * b.e - b.g * a.e)
    slope = total(r.g * r.e for r in rows) - damping * phase
    return Axis(1 / (damping + total(r.g**2 for r in rows)), coupling, slope, information, gain)
