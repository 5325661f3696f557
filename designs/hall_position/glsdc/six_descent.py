"""Corrections of all six coordinates by one Jacobian, that of the pose with which a sample begins: n of them.

    minimise  J(d) = |V - h(begun + d)|^2 + d' damping d,     d = (U, V, W, roll, pitch, yaw)   phases and angles, rad

    d_0 = 0;   J(d_i) <= J(best) + slack ?    yes: best = d_i, d_i+1 = d_i + N^-1 (H'(V - h(begun + d_i)) - damping d_i)
                                              no:  d_i+1 = (best + d_i) / 2

The Jacobian H and the factors of N = H'H + damping are computed once: a body moves by little more in a sample than it
is expected to, so that corrections converge by a factor that is small, about that motion in rad of phase. Residuals are
computed n times. d_n is not tried any more: it counts only where it is settled, less than a part of its standard
deviation from d_n-1 in the metric of N, which that part is (gradient' N^-1 gradient)^(1/2) / deviation; else the best
one stands, and the next sample goes on from there.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import ceil, exp, hypot, log2, pi, sqrt

import casadi as ca

from designs.hall_position.glsdc import base, six_correction
from designs.hall_position.glsdc.correction import Wave
from designs.hall_position.glsdc.six_correction import Attitude, Sensor, Vector
from designs.hall_position.glsdc.six_parameters import Array, Tuning
from synth.block import clip
from synth.signals import Signal
from synth.synthesise import normal_equations
from synth.synthesise.normal_equations import Factors, total

POSE = ("phase_x", "phase_y", "rise", "roll", "pitch", "yaw")
SLACK = 0.01  # of deviation^2: so much a cost may rise, by rounding
PART = 1.2  # rad: angles whose sine and cosine become polynomials are smaller
STEP = 0.25  # of the ranges of rise and tilts: by no more do these change in a sample

Named = list[tuple[Signal, ca.SX]]


@dataclass(frozen=True)
class Problem:
    """What is minimised: `damping` (6,) in V^2, `bounds` (6,) of displacements in a sample, `ranges` of POSE, rad.

    A sensor's phase moves by no more than `turn` within a sample, rad; of what a column of the Jacobian may hold `most`
    is the square's bound, in units of its damping.
    """

    array: Array
    tuning: Tuning
    damping: tuple[float, ...]
    bounds: tuple[Signal, ...]
    ranges: tuple[Signal, ...]
    turn: float
    most: float
    halvings: int


@dataclass(frozen=True, eq=False)
class Start:
    """Where a sample begins: the pose, its yaw's wave and attitude, and the sensors with their places and phases."""

    pose: Mapping[str, ca.SX]
    heading: Wave
    body: Attitude
    sensors: Sequence[Sensor]
    places: Sequence[Vector]
    phases: Sequence[tuple[Wave, Wave]]


@dataclass(frozen=True, eq=False)
class Trial:
    """A displacement (6,) with its squared residuals and cost, V^2, and L^-1 times the gradient."""

    at: Sequence[ca.SX]
    squares: ca.SX
    cost: ca.SX
    gradient: Sequence[ca.SX]


@dataclass(frozen=True, eq=False)
class Found:
    """Where the corrections end (6,), the last trial, whether they have converged, and the factors of N."""

    at: Sequence[ca.SX]
    last: Trial
    converged: ca.SX
    factors: Factors


def problem(array: Array, tuning: Tuning) -> Problem:
    """Return the problem; phases and the yaw together move a sensor's phase by `tuning.reach`."""
    arm = max(abs(x) + abs(y) for x, y, _ in array.arms)
    half, rise = tuning.reach / 2, array.wave_number * tuning.gap
    yaw = sqrt(1 + 2 * half / arm) - 1  # arm (T + T^2/2) = half
    limits = (pi, pi, rise, tuning.tilt, tuning.tilt, pi)
    steps = (half, half, *(STEP * limit for limit in limits[2:5]), yaw)
    bounds, ranges = (
        tuple(Signal(name, "rad", -size, size) for name, size in zip(POSE, sizes, strict=True))
        for sizes in (steps, limits)
    )
    weight = tuning.damping * array.alpha**2
    damping = (weight,) * 3 + (weight * array.radius**2,) * 3
    high = max(abs(z) for _, _, z in array.arms)
    tilted = (1 + STEP) * tuning.tilt
    turn = tuning.reach + 2 * arm * tilted**2 + 2 * high * tilted
    return Problem(array, tuning, damping, bounds, ranges, turn, _most(array, tuning), _halvings(pi + half + arm))


def _halvings(angle: float) -> int:
    return max(1, ceil(log2(angle / PART)))


def _most(array: Array, tuning: Tuning) -> float:
    """Return a bound of a column's square over its damping: |B| and the gradient times an axis are below 2 slope."""
    lift = array.wave_number * tuning.gap + tuning.tilt * max(hypot(*r) for r in array.arms)
    slope = exp(lift) + 5 * abs(array.beta) / array.alpha * exp(5 * lift)
    turned = sum((2 * slope * (1 + hypot(*r))) ** 2 for r in array.arms) / array.radius**2
    return ceil(2 * max(len(array.arms) * (2 * slope) ** 2, turned) / tuning.damping)


def started(pose: Mapping[str, ca.SX], sensors: Sequence[Sensor], of: Problem, named: Named) -> Start:
    """Return what a sample begins with."""
    heading = base.heading(pose["yaw"], named)
    # A bound that rounding makes as wide below as above: X and Y then share their polynomials.
    heading = Wave(heading.sine, ca.fmax(heading.cosine, -1))
    body = six_correction.attitude(heading, *(_wave(pose[name]) for name in ("roll", "pitch")))
    places = [six_correction.place(s, body) for s in sensors]
    phases = [
        tuple(base.wave(pose[f"phase_{a}"] + o[i], of.halvings, "phase_part", named) for i, a in enumerate("xy"))
        for o in places
    ]
    return Start(pose, heading, body, sensors, places, [(x, y) for x, y in phases])


def corrected(start: Start, of: Problem, named: Named) -> Found:
    """Return what n corrections find; signals that are worth a name are added to `named`."""
    e, rows = _base(start)
    N = normal_equations.factors(rows, of.damping, of.most)
    trial = _weighed([ca.SX(0)] * 6, e, rows, N, of, named)
    best, lowest, better = trial.at, trial.cost, ca.SX(1)
    for _ in range(1, of.tuning.corrections):
        at = _next(trial, better, best, N, of)
        trial = _weighed(at, _moved(start, at, of, named), rows, N, of, named)
        better = trial.cost <= lowest + SLACK * of.array.deviation**2
        best, lowest = _chosen(better, at, best), ca.if_else(better, trial.cost, lowest)
    ahead = _next(trial, ca.SX(1), best, N, of)
    left = total(z**2 * d for z, d in zip(trial.gradient, N.inverse, strict=True))
    converged = ca.logic_and(better, left <= (of.tuning.settled * of.array.deviation) ** 2)
    return Found(_chosen(converged, ahead, best), trial, converged, N)


def _next(trial: Trial, better: ca.SX, best: Sequence[ca.SX], N: Factors, of: Problem) -> list[ca.SX]:
    """Return the next displacement to try, within its bounds: from a better one a correction, else halfway back."""

    def chosen(i: int, step: ca.SX) -> tuple[ca.SX, ca.SX]:
        end = clip(ca.if_else(better, trial.at[i] + step, (trial.at[i] + best[i]) / 2), of.bounds[i])
        return end, end - trial.at[i]

    return normal_equations.backward(N, trial.gradient, chosen)


def _base(start: Start) -> tuple[list[ca.SX], list[Sequence[ca.SX]]]:
    """Return residuals (m,), V, and the Jacobian's rows (m, 6) at the start."""
    residuals: list[ca.SX] = []
    rows: list[Sequence[ca.SX]] = []
    for s, o, phases in zip(start.sensors, start.places, start.phases, strict=True):
        decay = ca.exp(-(start.pose["rise"] + o[2]))
        x, y = (six_correction.waves(p, decay) for p in phases)
        residuals += six_correction.residuals(s, six_correction.flux(s, x, y), start.body)
        rows += six_correction.rows(s, x, y, start.body)
    return residuals, rows


def _moved(start: Start, at: Sequence[ca.SX], of: Problem, named: Named) -> list[ca.SX]:
    """Return residuals (m,) at a displacement: phases are the start's turned by a small angle."""
    moved = dict(zip(POSE, at, strict=True))
    t = _wave(moved["yaw"])
    h = start.heading
    yaw = Wave(h.sine * t.cosine + h.cosine * t.sine, h.cosine * t.cosine - h.sine * t.sine)
    body = six_correction.attitude(yaw, *(_wave(start.pose[n] + moved[n]) for n in ("roll", "pitch")))
    bound = Signal("turn", "rad", -of.turn, of.turn)
    found: list[ca.SX] = []
    for s, begun, phases in zip(start.sensors, start.places, start.phases, strict=True):
        o = six_correction.place(s, body)
        decay = ca.exp(-(start.pose["rise"] + moved["rise"] + o[2]))
        x, y = (
            six_correction.waves(_turned(p, clip(at[i] + (o[i] - begun[i]), bound)), decay)
            for i, p in enumerate(phases)
        )
        found += six_correction.residuals(s, six_correction.flux(s, x, y), body)
    return found


def _weighed(
    at: Sequence[ca.SX], e: Sequence[ca.SX], rows: Sequence[Sequence[ca.SX]], N: Factors, of: Problem, named: Named
) -> Trial:
    squares = total(v**2 for v in e)
    held = [d * v for d, v in zip(of.damping, at, strict=True)]
    cost = squares + total(h * v for h, v in zip(held, at, strict=True))
    named.append((Signal("cost", "V^2", 0, 1e9, "squared residuals and damping"), cost))
    right = [total(r[i] * v for r, v in zip(rows, e, strict=True)) - held[i] for i in range(6)]
    return Trial(at, squares, cost, normal_equations.forward(N, right))


def _chosen(condition: ca.SX, then: Sequence[ca.SX], other: Sequence[ca.SX]) -> list[ca.SX]:
    return [ca.if_else(condition, a, b) for a, b in zip(then, other, strict=True)]


def _wave(angle: ca.SX) -> Wave:
    return Wave(ca.sin(angle), ca.cos(angle))


def _turned(phase: Wave, by: ca.SX) -> Wave:
    t = _wave(by)
    return Wave(phase.sine * t.cosine + phase.cosine * t.sine, phase.cosine * t.cosine - phase.sine * t.sine)
