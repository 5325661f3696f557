"""(X, Y, yaw) by GLSDC: what is minimised over the model `hall_planar`, and the normal equations of one correction.

    minimise  J(d) = sum over sensors k |R(yaw) V_k - B(P_k)|^2 + lambda (U^2 + V^2 + radius^2 T^2),   d = (U, V, T)

for the displacement d from the predicted pose: U, V phases of the centre in rad, T the yaw. By the sparse Jacobian of
`hall_planar`, [g_X, 0, h_X] and [0, g_Y, h_Y], U and V are eliminated one by one. With N_X = lambda + sum g_X^2 the
information on the yaw is, by Lagrange's identity, a sum of squares: no difference of large numbers, and never less than
lambda radius^2, the radius being the sensors' mean arm times the ratio by which the yaw is damped more:

    N_T = lambda radius^2 + sum over X, Y of [sum over pairs (g_i h_j - g_j h_i)^2 + lambda sum h^2] / N

Source: Kawato, Kim, "Multi-Degree-of-Freedom Precision Position Sensing", section 3.B, Fig. 9.
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
from synth.blocks.glsdc import Choose, Descent, Named, Trial, Vector, total
from synth.blocks.phasor import Phasor
from synth.signals import Signal

AXES = ("x", "y")
SLACK, ROUNDING = 0.01, 2e-6  # of deviation^2, and of itself: so much a cost may rise, by rounding


@dataclass(frozen=True)
class Problem:
    """What is minimised, `damping` in V^2, and how; phases are halved `halvings` times before they become polynomials.

    Voltages are within `expected` V rms of their prediction.
    """

    array: PlanarArray
    tuning: Tuning
    descent: Descent
    damping: float
    halvings: int
    expected: float


class Axis(NamedTuple):
    """One axis of the normal equations, N U + coupling T = slope, with 1/N.

    `information` and `gain` are its parts of N_T and of the right side when U is eliminated.
    """

    inverse: ca.SX
    coupling: ca.SX
    slope: ca.SX
    information: ca.SX
    gain: ca.SX


@dataclass(frozen=True, eq=False)
class Normal:
    """Normal equations: those of the axes, and `information` N_T, which leads T to `right` / N_T.

    `data_information` is the part of N_T that does not come of the yaw's own damping.
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

    def solve(self, choose: Choose) -> list[ca.SX]:
        """Return where a scaled correction leads: the yaw first, to which the phases fit where it is limited."""
        yaw, turn = choose(2, self.scale * (self.right / self.information))
        ends = [choose(i, (self.scale * n.slope - n.coupling * turn) * n.inverse)[0] for i, n in enumerate(self.axes)]
        return [*ends, yaw]


def problem(array: PlanarArray, tuning: Tuning) -> Problem:
    """Return the problem; a yaw moves the phase of a sensor as far as U and V do, together by `tuning.reach`."""
    half = tuning.reach / 2
    sizes = zip((*AXES, "yaw"), (half, half, array.yaw_within(half)), strict=True)
    bounds = tuple(Signal(f"motion_{name}", "rad", -size, size) for name, size in sizes)
    variance = array.deviation**2
    descent = Descent(tuning.iterations, bounds, SLACK * variance, (tuning.settled * array.deviation) ** 2, ROUNDING)
    expected = hypot(tuning.residual, tuning.surprise * array.deviation / sqrt(tuning.damping))
    halvings = phasor.halvings(pi + half + array.reach)
    return Problem(array, tuning, descent, tuning.damping * array.alpha**2, halvings, expected)


def sensors(
    u: Exprs, pose: Exprs, k: Exprs, heading: Phasor, left_out: Vector | None, of: Problem, named: Named
) -> list[Sensor]:
    """Return the sensors at the predicted pose; one that is left out reads 0 in no field.

    It does so by a product with 0: CasADi would pass a choice on into every correction.
    """

    def sensor(n: int) -> Sensor:
        letter, (ax, ay) = ascii_lowercase[n], of.array.arms[n]

        def kept(value: ca.SX) -> ca.SX:
            return value if left_out is None else (1 - left_out[n]) * value

        place = heading.times(Phasor(ca.SX(ax), ca.SX(ay)))
        at = pose["phase_x"] + place.cosine, pose["phase_y"] + place.sine
        x, y = (phasor.reduced(p, of.halvings, "phase_part", named) for p in at)
        vx, vy = (kept(u[f"V_{letter}{a}_held"]) for a in AXES)
        field = [kept(ca.SX(of.array.c)), *(kept(k[f"field_{i}"]) for i in hall_planar.POWERS)]
        slope = [kept(k[f"slope_{i - 1}"]) for i in hall_planar.POWERS]
        return Sensor((x, y), place, heading.times(Phasor(vx, vy)), field, slope)

    return [sensor(n) for n in range(len(of.array.positions))]


def weigh(sensors: Sequence[Sensor], of: Problem, named: Named) -> Callable[[int, Vector], Trial[Normal]]:
    """Return what makes the i-th trial at a displacement (U, V, T)."""
    damping, radius = of.damping, of.tuning.firm * of.array.radius

    def trial(i: int, at: Vector) -> Trial[Normal]:
        moved = hall_planar.displaced(sensors, at, named) if i else sensors
        by_axis = tuple(zip(*map(hall_planar.rows, moved), strict=True))
        residuals = [r.e for rows in by_axis for r in rows]
        squares = total(e**2 for e in residuals)
        cost = squares + damping * squared_motion(at, radius)
        named.append((Signal(f"cost_{i}", "V^2", 0, 1e9, "squared residuals and damping"), cost))
        return Trial(at, residuals, squares, cost, _normal(by_axis, at, damping, radius, of.tuning.scale))

    return trial


def squared_motion(at: Vector, radius: float) -> ca.SX:
    """Return the square of a displacement, rad^2, its yaw times a radius."""
    return at[0] ** 2 + at[1] ** 2 + radius**2 * at[2] ** 2


def _normal(by_axis: Iterable[Sequence[Row]], at: Vector, damping: float, radius: float, scale: float) -> Normal:
    axes = [_axis(rows, phase, damping) for rows, phase in zip(by_axis, at, strict=False)]
    stiffness = damping * radius**2
    data = total(n.information * n.inverse for n in axes)
    return Normal(axes, stiffness + data, data, total(n.gain * n.inverse for n in axes) - stiffness * at[2], scale)


def _axis(rows: Sequence[Row], phase: ca.SX, damping: float) -> Axis:
    coupling = total(r.g * r.h for r in rows)
    turn = total(r.h * r.e for r in rows)
    information, gain = damping * total(r.h**2 for r in rows), damping * (turn + phase * coupling)
    for a, b in combinations(rows, 2):
        across = a.g * b.h - b.g * a.h
        information, gain = information + across**2, gain + across * (a.g * b.e - b.g * a.e)
    slope = total(r.g * r.e for r in rows) - damping * phase
    return Axis(1 / (damping + total(r.g**2 for r in rows)), coupling, slope, information, gain)
