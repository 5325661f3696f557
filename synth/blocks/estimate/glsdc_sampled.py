"""Conditions on a measurement model that hold over the ranges of its unknowns, checked at sampled points.

    |a(q)| <= largest        each Phase is within the range that it declares
    |W de/dy_j| = |W_j|      an error of one channel of an Implicit model changes its residuals by as much
    column i of H not 0      each unknown acts on a channel
    largest deviation <= DYNAMIC_RANGE times that of the unknown with all others known

The points are those of Halton's sequence, and the channels are in the middle of their ranges.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.stats import qmc

from synth.block import Constant
from synth.blocks.estimate.glsdc_jacobian import Model
from synth.blocks.estimate.glsdc_solution import DYNAMIC_RANGE
from synth.errors import ModelError
from synth.statespace import Array

SAMPLES = 512
ROUNDING = 1e-6  # relative


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
        if (most := np.nanmax(values)) > phase.largest * (1 + ROUNDING):
            raise ModelError(
                f"phase '{phase.name}' is {most:.6g} rad within the ranges of the unknowns, and its largest value is "
                f"{phase.largest:g} rad: give {most:.6g} rad at least"
            )


def _check_directions(of: Model, at: Samples) -> None:
    norms = np.linalg.norm(at.directions, axis=0)
    for j, channel in enumerate(of.channels):
        if (wrong := np.nanmax(np.abs(norms[:, j] - 1))) > ROUNDING:
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
