"""Solution of a weighted least-squares problem with priors by a fixed number of Gauss-Newton corrections.

    cost  J(d) = |e(d)|^2 + sum P_i (o_i + d_i)^2,    N = H'H + P = L D L',    d <- d + N^-1 (H'e - P (o + d))

for the displacement d from the prediction, with e, H, P in the scale s of `glsdc_jacobian` and o the offset of the
prediction from the prior's value. An excluded channel has weight 0 in H and e.

Limits that never act while the information is in the dynamic range r, N_ii <= r^2 f_i with the least pivots f:

    |L_ij| <= r (f_i / f_j)^(1/2),    |z_j| = |(L^-1 H'e)_j| <= r f_j^(1/2) |e|,    |d_i| <= |e| / f_i^(1/2)

Conditions on a measurement model that hold over the ranges of its unknowns, checked at sampled points.

    |a(q)| <= largest        each Phase is within the range that it declares
    |W de/dy_j| = |W_j|      an error of one channel of an Implicit model changes its residuals by as much
    column i of H not 0      each unknown acts on a channel
    largest deviation <= DYNAMIC_RANGE times that of the unknown with all others known

The points are those of Halton's sequence, and the channels are in the middle of their ranges.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from math import sqrt
from typing import TypeVar

import casadi as ca
import numpy as np
from scipy.stats import qmc

from synth import numeric
from synth.block import Constant
from synth.blocks.estimate import glsdc, glsdc_jacobian
from synth.blocks.estimate.glsdc import Descent, LdlFactors, LdlNormalEquations, Solution, Trial, Vector, dot, total
from synth.blocks.estimate.glsdc_jacobian import Linearisation, Model, Prediction
from synth.errors import ModelError
from synth.law import call, label
from synth.signals import Signal
from synth.statespace import Array

DYNAMIC_RANGE = 500.0  # of deviations: single precision resolves the pivots to 5 %
SLACK, ROUNDING = 0.01, 2e-6  # of s^2, and relative: the rise of the cost allowed for rounding


@dataclass(frozen=True)
class Iteration:
    """How the cost is minimised: corrections a sample, with the Jacobian of each trial or that of the first (`held`).

    With the `descent_check` the result has no higher cost than the prediction; a correction that raises the cost is
    halved. The result has converged when the next correction is below `convergence` standard deviations. `scale`
    multiplies each correction.

    Raises ModelError for a value out of its range.
    """

    corrections: int = numeric.between(1, 5, 20)
    held_jacobian: bool = False
    descent_check: bool = False
    convergence: float = numeric.between(0, 0.1, 1)
    scale: float = numeric.between(0, 1.0, 1)

    def __post_init__(self) -> None:
        numeric.check_fields(self)


@dataclass(frozen=True, eq=False)
class Normal(LdlNormalEquations):
    """Normal equations of a trial with what they are made of.

    The linearisation is of every channel, whatever its weight; the `pulls` P (o + d) (n,) are those of the priors.
    `in_range`: the information is in the dynamic range.
    """

    linear: Linearisation
    pulls: Vector
    in_range: ca.SX

    @property
    def variances(self) -> list[ca.SX]:
        """The diagonal of N^-1."""
        return glsdc.variances(self.factors)


T = TypeVar("T", bound=Normal)


@dataclass(frozen=True, eq=False)
class Problem:
    """The problem of a sample: prediction, offsets o (n,), and weights (m,) of the channels, 0 or 1, or None for 1."""

    model: Model
    prediction: Prediction
    offsets: Vector
    weights: Vector | None


def solve(of: Problem, iteration: Iteration) -> Solution[Normal]:
    """Return the solution of a sample."""
    factors: list[tuple[LdlFactors, ca.SX]] = []
    held: list[Linearisation] = []

    def evaluate(i: int, at: Vector) -> Trial[Normal]:
        linearisation = glsdc_jacobian.linearise(of.model, of.prediction, at)
        if not i or not iteration.held_jacobian:
            held.append(linearisation)
            factors.append(call("factors", _factors, of, linearisation.rows))
        return trial(of, at, replace(held[-1], residuals=linearisation.residuals), factors[-1])

    return iterate(of.model, iteration, evaluate)


def iterate(of: Model, iteration: Iteration, evaluate: Callable[[int, Vector], Trial[T]]) -> Solution[T]:
    """Return the result of the corrections, with the descent check if the iteration has it."""
    variance = of.scale**2
    bounds = tuple(Signal(f"step_{u.name}", u.signal.unit, -u.step, u.step) for u in of.unknowns)
    tolerance = iteration.convergence**2 * variance
    descent = Descent(iteration.corrections, bounds, SLACK * variance, tolerance, ROUNDING, iteration.scale)
    return (glsdc.descend if iteration.descent_check else glsdc.iterate)(evaluate, descent)


def trial(of: Problem, at: Vector, linear: Linearisation, factors: tuple[LdlFactors, ca.SX]) -> Trial[Normal]:
    """Return the trial at a displacement, with residuals of there and rows and factors of there or of the first."""
    residuals = linear.residuals
    used = weighted(of, residuals)
    offsets = [o + d for o, d in zip(of.offsets, at, strict=True)]
    pulls = [p * o for p, o in zip(of.model.prior_weights, offsets, strict=True)]
    squares = dot(used, residuals)
    gradient = gradient_of(linear.rows, used, pulls)
    forward = glsdc.substitute_forward(factors[0], gradient, forward_bounds(of.model))
    normal = Normal(factors[0], forward, linear, pulls, factors[1])
    label(residuals=residuals, gradient=gradient, forward=forward, squares=squares, offsets=offsets)
    return Trial(at, residuals, squares, squares + dot(pulls, offsets), normal)


def gradient_of(rows: Sequence[Vector], residuals: Vector, pulls: Vector) -> list[ca.SX]:
    """Return H'e - P (o + d) (n,)."""
    label(rows=rows)
    return [total(row[j] * e for row, e in zip(rows, residuals, strict=True)) - p for j, p in enumerate(pulls)]


def _factors(of: Problem, rows: Sequence[Vector]) -> tuple[LdlFactors, ca.SX]:
    used = [list(row) for row in rows]
    if of.weights is not None:
        used = [[weight * entry for entry in row] for weight, row in zip(of.weights, rows, strict=True)]
    return factorise(of.model, used, rows)


def factorise(of: Model, rows: Sequence[Vector], others: Sequence[Vector]) -> tuple[LdlFactors, ca.SX]:
    """Return the factors of H'G + P from rows H and G (m, n), and whether its diagonal is in the dynamic range."""
    return glsdc.factorise_information(glsdc.information(rows, others, of.prior_weights), of.floors, DYNAMIC_RANGE)


def weighted(of: Problem, values: Vector) -> list[ca.SX]:
    """Return values of the channels times their weights."""
    return (
        list(values) if of.weights is None else [ca.if_else(w, v, 0) for w, v in zip(of.weights, values, strict=True)]
    )


def residual_bound(of: Model) -> float:
    """Return the largest size of (e, P^(1/2) o) for channels and models in twice the ranges of the channels."""
    widths = np.array([s.high - s.low for s in of.channels])
    pulls = [p * u.width**2 for p, u in zip(of.prior_weights, of.unknowns, strict=True)]
    return sqrt(float(np.sum((2 * np.abs(of.whitening) @ widths) ** 2)) + sum(pulls))


def forward_bounds(of: Model) -> list[float]:
    """Return the bounds of L^-1 H'e (n,)."""
    return [DYNAMIC_RANGE * residual_bound(of) * sqrt(floor) for floor in of.floors]


SAMPLES = 512
SAMPLE_ROUNDING = 1e-6  # relative


@dataclass(frozen=True, eq=False)
class Samples:
    """Phases (p, N), Jacobians H (m, N, n) and directions W de/dy_j over |W_j| (m, N, m) at N points."""

    phases: Array
    rows: Array
    directions: Array


def check(of: Model, constants: Sequence[Constant]) -> None:
    """Raise ModelError for a model that breaks one of the conditions."""
    at = _sample(of, constants)
    _check_phases(of, at)
    if of.is_implicit:
        _check_directions(of, at)
    _check_resolution(of, at)


def _sample(of: Model, constants: Sequence[Constant]) -> Samples:
    low, high = ([getattr(u.signal, end) for u in of.unknowns] for end in ("low", "high"))
    points = qmc.scale(qmc.Halton(len(low), scramble=False).random(SAMPLES), low, high).T
    turns = np.array([u.rate * p for u, p in zip(of.unknowns, points, strict=True) if u.rate])
    turns = turns.reshape(-1, SAMPLES)
    values = np.tile(np.reshape([c.value for c in constants], (-1, 1)), SAMPLES)
    phases = of.phase_function.map(SAMPLES)(points, np.cos(turns), np.sin(turns), values).full()
    middle = np.tile([[(s.low + s.high) / 2] for s in of.channels], SAMPLES)
    pairs = np.cos(turns), np.sin(turns), np.cos(phases), np.sin(phases)
    _, rows, directions = of.function.map(SAMPLES)(points, *pairs, values, middle)
    m = len(of.channels)
    return Samples(phases, rows.full().reshape(m, SAMPLES, -1), directions.full().reshape(m, SAMPLES, m))


def _check_phases(of: Model, at: Samples) -> None:
    for phase, values in zip(of.phases, np.abs(at.phases), strict=True):
        if (most := np.nanmax(values)) > phase.largest * (1 + SAMPLE_ROUNDING):
            raise ModelError(
                f"phase '{phase.name}' is {most:.6g} rad within the ranges of the unknowns, and its largest value is "
                f"{phase.largest:g} rad: give {most:.6g} rad at least"
            )


def _check_directions(of: Model, at: Samples) -> None:
    norms = np.linalg.norm(at.directions, axis=0)
    for j, channel in enumerate(of.channels):
        if (wrong := np.nanmax(np.abs(norms[:, j] - 1))) > SAMPLE_ROUNDING:
            raise ModelError(
                f"an error of 1 {channel.unit} in '{channel.name}' changes the residuals of the Implicit model by "
                f"{norms[np.nanargmax(np.abs(norms[:, j] - 1)), j]:.4g} {channel.unit}, which is off by {wrong:.2g}: "
                "give residuals that are the channels' errors up to signs and rotations, or h"
            )


def _check_resolution(of: Model, at: Samples) -> None:
    columns = np.nan_to_num(at.rows, posinf=0, neginf=0)
    information = (columns**2).sum(axis=0).max(axis=0) + of.prior_weights
    for u, most in zip(of.unknowns, information, strict=True):
        if most == 0:
            raise ModelError(f"no channel and no prior depends on '{u.name}': leave it out, or correct h")
        if u.largest_deviation**2 * most > (DYNAMIC_RANGE * of.scale) ** 2:
            least = of.scale / most**0.5
            raise ModelError(
                f"the largest deviation of '{u.name}' is {u.largest_deviation:g} {u.signal.unit}, and the channels "
                f"resolve {least:.3g}: single precision allows a ratio of {DYNAMIC_RANGE:g}, give "
                f"{DYNAMIC_RANGE * least:.3g} {u.signal.unit} at most"
            )
