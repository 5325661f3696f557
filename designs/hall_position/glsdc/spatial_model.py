"""Hall voltages in six degrees of freedom: measurement model and Jacobian of two-axis sensors anywhere in a body.

    V_k = [u v]' B(P_k),   P_k = (X, Y, Z) + R r_k,    q = (phase_x, phase_y, rise, roll, pitch, yaw) in rad

In units of phase, so that the gradient of B is that of `hall_two_waves` over w and places are o = w R r. With rows p of
the gradient turned into the body's axes, p_i = R' grad B R_i, b = R' B and a sensor at (x, y, z) rad in the body,

    u:  p_1 by phases,  t = (y p_13 - z p_12,  z p_11 - x p_13 - b_3,  x p_12 - y p_11 + b_2)    by turns in the body
    v:  p_2 by phases,  t = (y p_23 - z p_22 + b_3,  z p_12 - x p_23,  x p_22 - y p_12 - b_1)

    by roll t_1,  by pitch cos(roll) t_2 - sin(roll) t_3,  by yaw -sin(pitch) t_1 + cos(pitch) (sin(roll) t_2 + ..)

All corrections of a sample use one Jacobian, that of the predicted pose: a body moves by little more in a sample than
is predicted, so that they converge by a small factor, about that motion in rad of phase. A displaced phase is the
predicted one turned by a small angle.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil, exp, hypot, log2, pi, sqrt
from string import ascii_lowercase

import casadi as ca

from designs.hall_position.glsdc import phasor
from designs.hall_position.glsdc.parameters import SpatialTuning
from designs.hall_position.glsdc.phasor import Phasor
from models.hall_two_waves import SpatialArray
from synth.block import Exprs, clip
from synth.blocks import glsdc
from synth.blocks.glsdc import Descent, Factorised, Named, Solution, Vector, dot, total
from synth.signals import Signal

POSE = ("phase_x", "phase_y", "rise", "roll", "pitch", "yaw")
Waves = tuple[Phasor, Phasor]  # fundamental and 5th wave along an axis, times their decay
SLACK = 0.01  # of deviation^2: so much a cost may rise, by rounding
STEP = 0.25  # of the ranges of rise and tilts: by no more do these change in a sample


@dataclass(frozen=True)
class Problem:
    """What is minimised, `damping` (6,) in V^2, how, and the `ranges` of POSE, rad.

    A sensor's phase moves by no more than `turn` within a sample, rad. The square of a column of the Jacobian is at
    most `most` times its damping.
    """

    array: SpatialArray
    tuning: SpatialTuning
    descent: Descent
    damping: tuple[float, ...]
    ranges: tuple[Signal, ...]
    turn: Signal
    most: float
    halvings: int


@dataclass(frozen=True, eq=False)
class Attitude:
    """Roll as a phasor, and the body's axes in the field's."""

    roll: Phasor
    axes: tuple[Vector, Vector, Vector]


@dataclass(frozen=True, eq=False)
class Sensor:
    """Where a sensor is in the body, rad, its voltages, and the field's alpha and beta that it sees, V."""

    arm: tuple[float, float, float]
    volts: tuple[ca.SX, ca.SX]
    alpha: ca.SX
    beta: ca.SX


def problem(array: SpatialArray, tuning: SpatialTuning) -> Problem:
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
    weight, variance = tuning.damping * array.alpha**2, array.deviation**2
    damping = (weight,) * 3 + (weight * array.radius**2,) * 3
    descent = Descent(tuning.corrections, bounds, SLACK * variance, (tuning.settled * array.deviation) ** 2)
    high = max(abs(z) for _, _, z in array.arms)
    tilted = (1 + STEP) * tuning.tilt
    turn = tuning.reach + 2 * arm * tilted**2 + 2 * high * tilted
    halvings = max(1, ceil(log2((pi + half + arm) / phasor.PART)))
    turned = Signal("turn", "rad", -turn, turn)
    return Problem(array, tuning, descent, damping, ranges, turned, _most(array, tuning), halvings)


def _most(array: SpatialArray, tuning: SpatialTuning) -> float:
    """Return a bound of a column's square over its damping: |B| and the gradient times an axis are below 2 slope."""
    lift = array.wave_number * tuning.gap + tuning.tilt * max(hypot(*r) for r in array.arms)
    slope = exp(lift) + 5 * abs(array.beta) / array.alpha * exp(5 * lift)
    turned = sum((2 * slope * (1 + hypot(*r))) ** 2 for r in array.arms) / array.radius**2
    return ceil(2 * max(len(array.arms) * (2 * slope) ** 2, turned) / tuning.damping)


def sensors(array: SpatialArray, u: Exprs, k: Exprs, left_out: Vector | None) -> list[Sensor]:
    """Return the sensors; one that is left out reads 0 in no field, by a product with 0."""
    sensors = []
    for n, (letter, arm) in enumerate(zip(ascii_lowercase, array.arms, strict=False)):
        kept = ca.SX(1) if left_out is None else 1 - left_out[n]
        ux, uy, alpha, beta = (
            kept * v for v in (u[f"V_{letter}x_held"], u[f"V_{letter}y_held"], k["alpha"], k["beta"])
        )
        sensors.append(Sensor(arm, (ux, uy), alpha, beta))
    return sensors


def correct(pose: Exprs, sensors: Sequence[Sensor], of: Problem, named: Named) -> Solution[Factorised]:
    """Return what the corrections of a predicted pose lead to."""
    heading = phasor.reduced(pose["yaw"], 2, "yaw_part", named)
    # A bound that rounding makes as wide below as above: X and Y then share their polynomials.
    heading = Phasor(ca.fmax(heading.cosine, -1), heading.sine)
    body = attitude(heading, pose["roll"], pose["pitch"])
    places = [_place(s, body) for s in sensors]
    phases = [[phasor.reduced(pose[POSE[i]] + o[i], of.halvings, "phase_part", named) for i in (0, 1)] for o in places]
    seen = _waves_at(sensors, places, phases, pose["rise"])
    first = [e for s, x, y in seen for e in _residuals(s, _flux(s, x, y), body)]
    rows = [row for s, x, y in seen for row in _rows(s, x, y, body)]

    def residuals(i: int, at: Vector) -> Vector:
        if not i:
            return first
        by = dict(zip(POSE, at, strict=True))
        turned = attitude(heading.times(phasor.of(by["yaw"])), *(pose[n] + by[n] for n in ("roll", "pitch")))
        moved = [_place(s, turned) for s in sensors]
        displaced = [
            [p.times(phasor.of(clip(at[i] + (o[i] - begun[i]), of.turn))) for i, p in enumerate(along)]
            for o, begun, along in zip(moved, places, phases, strict=True)
        ]
        seen = _waves_at(sensors, moved, displaced, pose["rise"] + by["rise"])
        return [e for s, x, y in seen for e in _residuals(s, _flux(s, x, y), turned)]

    factors = glsdc.factorise(rows, of.damping, of.most)
    return glsdc.descend(glsdc.fixed_jacobian(factors, rows, residuals, of.damping, named), of.descent)


def _waves_at(
    sensors: Sequence[Sensor], places: Sequence[Vector], phases: Sequence[Sequence[Phasor]], rise: ca.SX
) -> list[tuple[Sensor, Waves, Waves]]:
    """Return the sensors with the waves along X and Y that they see."""
    seen = []
    for s, o, (x, y) in zip(sensors, places, phases, strict=True):
        decay = ca.exp(-(rise + o[2]))
        seen.append((s, _waves(x, decay), _waves(y, decay)))
    return seen


def attitude(yaw: Phasor, by_x: ca.SX, by_y: ca.SX) -> Attitude:
    """Return R_z(yaw) R_y(pitch) R_x(roll)."""
    roll, pitch = phasor.of(by_x), phasor.of(by_y)
    across = pitch.sine * roll.sine, pitch.sine * roll.cosine
    x = yaw.cosine * pitch.cosine, yaw.sine * pitch.cosine, -pitch.sine
    y = (
        yaw.cosine * across[0] - yaw.sine * roll.cosine,
        yaw.sine * across[0] + yaw.cosine * roll.cosine,
        pitch.cosine * roll.sine,
    )
    z = (
        yaw.cosine * across[1] + yaw.sine * roll.sine,
        yaw.sine * across[1] - yaw.cosine * roll.sine,
        pitch.cosine * roll.cosine,
    )
    return Attitude(roll, (x, y, z))


def _place(of: Sensor, body: Attitude) -> Vector:
    """Return where a sensor is about the body's origin, rad."""
    return [total(r * e[i] for r, e in zip(of.arm, body.axes, strict=True) if r) for i in range(3)]


def _waves(of: Phasor, decay: ca.SX) -> Waves:
    """Return the waves along an axis; the fifth power of decay (cosine + i sine) is the 5th wave."""
    s, c = decay * of.sine, decay * of.cosine
    p, q = s**2, c**2
    both = 10 * p * q
    return Phasor(c, s), Phasor(c * (q**2 - both + 5 * p**2), s * (p**2 - both + 5 * q**2))


def _flux(of: Sensor, x: Waves, y: Waves) -> Vector:
    """Return B, V."""
    along = [of.alpha * first.sine + of.beta * fifth.sine for first, fifth in (x, y)]
    up = of.alpha * (x[0].cosine + y[0].cosine) + of.beta * (x[1].cosine + y[1].cosine)
    return *along, up


def _residuals(of: Sensor, B: Vector, body: Attitude) -> list[ca.SX]:
    """Return what u and v read beyond the model, V."""
    return [volts - dot(e, B) for volts, e in zip(of.volts, body.axes[:2], strict=True)]


def _rows(of: Sensor, x: Waves, y: Waves, body: Attitude) -> tuple[Vector, Vector]:
    """Return the Jacobian's rows of u and v, (6,) each, V by rad."""
    B, fifth = _flux(of, x, y), 5 * of.beta
    f = [of.alpha * w[0].sine + fifth * w[1].sine for w in (x, y)]
    g = [of.alpha * w[0].cosine + fifth * w[1].cosine for w in (x, y)]
    first, second, _ = body.axes
    p, r = (
        (g[0] * e[0] - f[0] * e[2], g[1] * e[1] - f[1] * e[2], -f[0] * e[0] - f[1] * e[1] - (g[0] + g[1]) * e[2])
        for e in (first, second)
    )
    p11, p12, p13 = (dot(p, e) for e in body.axes)
    p22, p23 = (dot(r, e) for e in body.axes[1:])
    b, (a, d, h) = [dot(B, e) for e in body.axes], of.arm
    turn_u = d * p13 - h * p12, h * p11 - a * p13 - b[2], a * p12 - d * p11 + b[1]
    turn_v = d * p23 - h * p22 + b[2], h * p12 - a * p23, a * p22 - d * p12 - b[0]
    return (*p, *_angles(turn_u, body)), (*r, *_angles(turn_v, body))


def _angles(t: Vector, body: Attitude) -> Vector:
    """Return by roll, pitch and yaw what is `t` by turns about the body's axes."""
    roll = body.roll
    return t[0], roll.cosine * t[1] - roll.sine * t[2], total(e[2] * each for e, each in zip(body.axes, t, strict=True))
