"""GLSDC in six degrees of freedom: cost function over the model `hall_spatial`, and its corrections.

    q = (phase_x, phase_y, rise, roll, pitch, yaw) in rad

All corrections of a sample use the Jacobian of the predicted pose. The body moves little from its prediction within a
sample, and each correction reduces the error by about that motion in rad of phase. Phasors of a displaced pose are
those of the predicted pose rotated by small angles.
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
from synth.blocks.glsdc import Descent, LdlNormalEquations, NamedExpressions, Solution, Vector
from synth.blocks.phasor import Phasor
from synth.signals import Signal

POSE = ("phase_x", "phase_y", "rise", "roll", "pitch", "yaw")
COST_SLACK = 0.01  # of deviation^2: the rise of the cost allowed for rounding
MAX_STEP_FRACTION = 0.25  # of the ranges of rise and tilts: their largest change in a sample


@dataclass(frozen=True)
class Problem:
    """The cost function with its `damping` (6,) in V^2, how it is minimised, and the `ranges` of POSE, rad.

    `phase_change` bounds how far a sensor's phase moves in a sample, rad; `column_bound` bounds the square of a column
    of the Jacobian over its damping.
    """

    array: SpatialArray
    tuning: SpatialTuning
    descent: Descent
    damping: tuple[float, ...]
    ranges: tuple[Signal, ...]
    phase_change: Signal
    column_bound: float
    halvings: int


def problem(array: SpatialArray, tuning: SpatialTuning) -> Problem:
    """Return the problem; phases and the yaw together move a sensor's phase by `tuning.max_phase_step`."""
    half, rise = tuning.max_phase_step / 2, array.wave_number * tuning.gap
    limits = (pi, pi, rise, tuning.tilt, tuning.tilt, pi)
    steps = (half, half, *(MAX_STEP_FRACTION * limit for limit in limits[2:5]), array.yaw_within(half))
    bounds, ranges = (
        tuple(Signal(name, "rad", -size, size) for name, size in zip(POSE, sizes, strict=True))
        for sizes in (steps, limits)
    )
    weight, variance = tuning.damping * array.alpha**2, array.deviation**2
    damping = (weight,) * 3 + (weight * array.radius**2,) * 3
    descent = Descent(
        tuning.corrections, bounds, COST_SLACK * variance, (tuning.convergence_sigma * array.deviation) ** 2
    )
    max_height = max(abs(z) for _, _, z in array.arms)
    tilted = (1 + MAX_STEP_FRACTION) * tuning.tilt
    largest = tuning.max_phase_step + 2 * array.longest_arm * tilted**2 + 2 * max_height * tilted
    halvings = phasor.halvings(pi + half + array.longest_arm)
    phase_change = Signal("phase_change", "rad", -largest, largest)
    return Problem(array, tuning, descent, damping, ranges, phase_change, _column_bound(array, tuning), halvings)


def _column_bound(array: SpatialArray, tuning: SpatialTuning) -> float:
    """Return a bound of a column's square over its damping: |B| and the gradient times an axis are below 2 slope."""
    lift = array.wave_number * tuning.gap + tuning.tilt * max(hypot(*r) for r in array.arms)
    slope = exp(lift) + 5 * abs(array.beta) / array.alpha * exp(5 * lift)
    column = sum((2 * slope * (1 + hypot(*r))) ** 2 for r in array.arms) / array.radius**2
    return ceil(2 * max(len(array.arms) * (2 * slope) ** 2, column) / tuning.damping)


def sensors(array: SpatialArray, u: Exprs, k: Exprs, excluded: Vector | None) -> list[Sensor]:
    """Return the sensors; an excluded one has zero voltages in a zero field, by a product with 0."""
    sensors = []
    for n, (letter, arm) in enumerate(zip(ascii_lowercase, array.arms, strict=False)):
        weight = ca.SX(1) if excluded is None else 1 - excluded[n]
        ux, uy, alpha, beta = (
            weight * v for v in (u[f"V_{letter}x_held"], u[f"V_{letter}y_held"], k["alpha"], k["beta"])
        )
        sensors.append(Sensor(arm, (ux, uy), alpha, beta))
    return sensors


def correct(
    pose: Exprs, sensors: Sequence[Sensor], setup: Problem, named: NamedExpressions
) -> Solution[LdlNormalEquations]:
    """Return the solution of the corrections of a predicted pose."""
    heading = phasor.by_range_reduction(pose["yaw"], 2, "yaw_fraction", named)
    # Makes the rounded bound symmetric: X and Y then share their polynomials.
    heading = Phasor(ca.fmax(heading.cosine, -1), heading.sine)
    body = hall_spatial.attitude(heading, pose["roll"], pose["pitch"])
    places = [hall_spatial.place(s, body) for s in sensors]
    phases = [
        [phasor.by_range_reduction(pose[POSE[i]] + o[i], setup.halvings, "phase_fraction", named) for i in (0, 1)]
        for o in places
    ]
    observations = [hall_spatial.observe(*each, pose["rise"]) for each in zip(sensors, places, phases, strict=True)]
    first = [e for each in observations for e in hall_spatial.residuals(each, body)]
    rows = [row for each in observations for row in hall_spatial.rows(each, body)]

    def residuals(i: int, at: Vector) -> Vector:
        if not i:
            return first
        change = dict(zip(POSE, at, strict=True))
        body_at_trial = hall_spatial.attitude(
            heading.times(phasor.of(change["yaw"])), *(pose[n] + change[n] for n in POSE[3:5])
        )
        places_at_trial = [hall_spatial.place(s, body_at_trial) for s in sensors]
        displaced = [
            [p.times(phasor.of(clip(at[i] + (o[i] - predicted[i]), setup.phase_change))) for i, p in enumerate(along)]
            for o, predicted, along in zip(places_at_trial, places, phases, strict=True)
        ]
        rise = pose["rise"] + change["rise"]
        observations = [
            hall_spatial.observe(*each, rise) for each in zip(sensors, places_at_trial, displaced, strict=True)
        ]
        return [e for each in observations for e in hall_spatial.residuals(each, body_at_trial)]

    factors = glsdc.factorise(rows, setup.damping, setup.column_bound)
    return glsdc.descend(glsdc.fixed_jacobian(factors, rows, residuals, setup.damping, named), setup.descent)
