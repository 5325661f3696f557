"""The pose in six degrees of freedom by GLSDC: what is minimised over the model `hall_spatial`, and the corrections.

    q = (phase_x, phase_y, rise, roll, pitch, yaw) in rad

All corrections of a sample use one Jacobian, that of the predicted pose: a body moves by little more in a sample than
is predicted, so that they converge by a small factor, about that motion in rad of phase. A displaced phase is the
predicted one turned by a small angle.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil, exp, hypot, pi
from string import ascii_lowercase

import casadi as ca

from designs.hall_position.glsdc.parameters import SpatialTuning
from models import hall_spatial
from models.hall_spatial import Sensor
from models.hall_two_waves import SpatialArray
from synth.block import Exprs, clip
from synth.blocks import glsdc, phasor
from synth.blocks.glsdc import Descent, Factorised, Named, Solution, Vector
from synth.blocks.phasor import Phasor
from synth.signals import Signal

POSE = ("phase_x", "phase_y", "rise", "roll", "pitch", "yaw")
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


def problem(array: SpatialArray, tuning: SpatialTuning) -> Problem:
    """Return the problem; phases and the yaw together move a sensor's phase by `tuning.reach`."""
    half, rise = tuning.reach / 2, array.wave_number * tuning.gap
    limits = (pi, pi, rise, tuning.tilt, tuning.tilt, pi)
    steps = (half, half, *(STEP * limit for limit in limits[2:5]), array.yaw_within(half))
    bounds, ranges = (
        tuple(Signal(name, "rad", -size, size) for name, size in zip(POSE, sizes, strict=True))
        for sizes in (steps, limits)
    )
    weight, variance = tuning.damping * array.alpha**2, array.deviation**2
    damping = (weight,) * 3 + (weight * array.radius**2,) * 3
    descent = Descent(tuning.corrections, bounds, SLACK * variance, (tuning.settled * array.deviation) ** 2)
    high = max(abs(z) for _, _, z in array.arms)
    tilted = (1 + STEP) * tuning.tilt
    turn = tuning.reach + 2 * array.reach * tilted**2 + 2 * high * tilted
    halvings = phasor.halvings(pi + half + array.reach)
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
    body = hall_spatial.attitude(heading, pose["roll"], pose["pitch"])
    places = [hall_spatial.place(s, body) for s in sensors]
    phases = [[phasor.reduced(pose[POSE[i]] + o[i], of.halvings, "phase_part", named) for i in (0, 1)] for o in places]
    seen = [hall_spatial.seen(*each, pose["rise"]) for each in zip(sensors, places, phases, strict=True)]
    first = [e for each in seen for e in hall_spatial.residuals(each, body)]
    rows = [row for each in seen for row in hall_spatial.rows(each, body)]

    def residuals(i: int, at: Vector) -> Vector:
        if not i:
            return first
        by = dict(zip(POSE, at, strict=True))
        turned = hall_spatial.attitude(heading.times(phasor.of(by["yaw"])), *(pose[n] + by[n] for n in POSE[3:5]))
        moved = [hall_spatial.place(s, turned) for s in sensors]
        displaced = [
            [p.times(phasor.of(clip(at[i] + (o[i] - begun[i]), of.turn))) for i, p in enumerate(along)]
            for o, begun, along in zip(moved, places, phases, strict=True)
        ]
        rise = pose["rise"] + by["rise"]
        seen = [hall_spatial.seen(*each, rise) for each in zip(sensors, moved, displaced, strict=True)]
        return [e for each in seen for e in hall_spatial.residuals(each, turned)]

    factors = glsdc.factorise(rows, of.damping, of.most)
    return glsdc.descend(glsdc.fixed_jacobian(factors, rows, residuals, of.damping, named), of.descent)
