"""Convergence of GLSDC for the audit's formulas: remaining error of a step, basin, staircase under noise."""

from math import radians

import numpy as np

from designs.hall_position.paper import correction
from models import hall_chain
from models.hall_array import Array
from models.hall_stage import Stage, grid
from models.hall_two_waves import PlanarArray
from synth.timing import Discrete

STEP = 10e-6  # m, of Fig. 12: small enough for the field to be linear
DRAWS, CORRECTIONS, SEED = 400, 200, 0
CONVERGED = 1e-6  # m
STEPS, TREAD, ALONG, PERIOD = (
    4,
    40,
    10,
    1 / 800,
)  # of the staircase: steps, samples of each, grid points along the pitch, s
SCALE, INNER = 0.2, 5  # of a correction; corrections in a sample


def remaining_step(array: PlanarArray, scale: float, corrections: int) -> float:
    """Return the fraction of a step of X that remains after some corrections, median over the pitch."""
    q = grid(array, 20)
    start = q - np.array([[STEP], [0.0], [0.0]])
    end = correction.iterate(array, correction.volts(array, q), start, scale, corrections)
    return float(np.median(np.abs(end[0] - q[0]))) / STEP


def count_corrections(scale: float, samples: int, fraction: float) -> int:
    """Return the number of corrections a sample that leave less than a fraction of a step in a linear field."""
    return next(n for n in range(1, 50) if (1 - scale) ** (samples * n) < fraction)


def converged_share(array: PlanarArray, scale: float, distance: float, yaw: float) -> float:
    """Return the share of random starts, off by `distance` pitches and `yaw` degrees at most, that converge."""
    q, off = random_starts(array, distance, yaw)
    end = correction.iterate(array, correction.volts(array, q), q + off, scale, CORRECTIONS)
    return float(np.mean(np.hypot(*(end - q)[:2]) < CONVERGED))


def random_starts(array: PlanarArray, distance: float, yaw: float) -> tuple[Array, Array]:
    """Return random poses (3, N) at yaw 0 in the pitch, and the offsets of their starts."""
    rng = np.random.default_rng(SEED)
    q = np.vstack([rng.uniform(0, array.pitch, (2, DRAWS)), np.zeros(DRAWS)])
    sides = np.array([[distance * array.pitch], [distance * array.pitch], [radians(yaw)]])
    return q, sides * rng.uniform(-1, 1, (3, DRAWS))


def staircase_estimates(stage: Stage, step: float, yaw_known: bool) -> Array:
    """Return the estimates of X in m on a staircase, (stairs, samples, N), without the first half of each stair."""
    pair, time = stage.pair, Discrete(PERIOD)
    q = grid(pair, ALONG)
    size = 2 * len(pair.positions) * q.shape[1]
    noise = hall_chain.noise(stage.chain, time, (size, (STEPS + 1) * TREAD), SEED).T
    estimates, at = [], q
    for stair, more in enumerate(noise.reshape(STEPS + 1, TREAD, 2, -1, q.shape[1])):
        true = q + np.array([[step * stair], [0.0], [0.0]])
        clean = correction.volts(pair, true)
        for now in more:
            at = correction.iterate(pair, clean + now, at, SCALE, INNER, yaw_known)
            estimates.append(at[0])
    return np.array(estimates).reshape(STEPS + 1, TREAD, -1)[:, TREAD // 2 :]
