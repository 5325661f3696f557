"""A sample of the shipped estimators minimises squared residuals and priors: SciPy is the oracle of its pose."""

from functools import cache
from math import sqrt

import numpy as np
import pytest
from scipy import optimize

from models.hall_two_waves import PlanarArray
from synth.statespace import Array
from tests.designs.hall_position.tracked import (
    ARRAYS,
    USUAL,
    Pose,
    W,
    by_input,
    centre,
    compile_c,
    known_state,
    noisy,
    places,
    state_records,
    volts,
)

BODIES, NEAR = 40, 1e-3  # of a deviation, by how far a converged sample may miss the minimum


def minimum(array: PlanarArray, start: Array, measured: Array, damping: float) -> Array:
    """Return the pose (3,) of the least cost, whose priors are about the pose `start`, by differences."""
    prior = array.deviation / (array.alpha * sqrt(damping))
    sigma = np.array([prior / W, prior / W, prior / (array.radius * USUAL.yaw_damping_ratio)])

    def about_centre(q: Array) -> Array:
        return np.array([*centre(array, Pose(*q)), q[2]])

    def residuals(q: Array) -> Array:
        e = (measured - volts(array, Pose(*q[:, None]))[0]) / array.deviation
        return np.array([*e.ravel(), *((about_centre(q) - about_centre(start)) / sigma)])

    return np.asarray(optimize.least_squares(residuals, start, x_scale=sigma, xtol=1e-14, ftol=1e-14).x)


@cache
def largest_miss(name: str, damping: float) -> float:
    """Return how far samples that converge are from the minimum, in deviations.

    The bodies leave the prediction by a deviation of the prior or so, along each unknown.
    """
    array, rng, start = ARRAYS[name], np.random.default_rng(2), places(BODIES, 2, 0.03)
    size = array.deviation / (array.alpha * sqrt(USUAL.damping)) / W
    by = size * rng.standard_normal((2, BODIES))
    turn = size * W / (array.radius * USUAL.yaw_damping_ratio) * rng.standard_normal(BODIES)
    measured = noisy(array, Pose(start.X + by[0], start.Y + by[1], start.yaw + turn), 2)
    out = compile_c(array).batch(state_records(array, known_state(array, start)), by_input(array, measured)).outputs
    sure = np.flatnonzero((out["valid"] > 0) & (out["converged"] > 0))
    assert len(sure) > BODIES / 2
    poses, starts = np.column_stack([out[n] for n in ("X", "Y", "yaw")]), np.column_stack([start.X, start.Y, start.yaw])
    sigmas = np.column_stack([out[f"deviation_{n}"] for n in ("X", "Y", "yaw")])
    misses = [np.abs(poses[i] - minimum(array, starts[i], measured[i], damping)) / sigmas[i] for i in sure]
    return float(np.max(misses))


@pytest.mark.parametrize("name", ARRAYS)
def test_a_sample_minimises_residuals_and_priors(name: str) -> None:
    assert largest_miss(name, USUAL.damping) < NEAR
