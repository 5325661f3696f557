"""GLSDC over samples for the audit's formulas: what is left of a step, from where it converges, steps under noise."""

from math import radians

import numpy as np

from models import hall_chain, hall_correction
from models.hall_array import Array
from models.hall_stage import Stage, grid
from models.hall_two_waves import PlanarArray
from synth.timing import Discrete

STEP = 10e-6  # m, of Fig. 12: small, so that the corrections are those of a line
DRAWS, CORRECTIONS, SEED = 400, 200, 0
CONVERGED = 1e-6  # m
STEPS, TREAD, ALONG, PERIOD = 4, 40, 10, 1 / 800  # of the staircase; samples of a stair, s
SCALE, INNER = 0.2, 5  # of a correction, and how many a sample


def remaining_step(of: PlanarArray, scale: float, corrections: int) -> float:
    """Return the median part of a step of X that is left after so many corrections, over the pitch."""
    q = grid(of, 20)
    start = q - np.array([[STEP], [0.0], [0.0]])
    end = hall_correction.iterate(of, hall_correction.volts(of, q), start, scale, corrections)
    return float(np.median(np.abs(end[0] - q[0]))) / STEP


def corrections_needed(scale: float, samples: int, part: float) -> int:
    """Return how many corrections in each of some samples leave less than a part of a step of a line."""
    return next(n for n in range(1, 50) if (1 - scale) ** (samples * n) < part)


def converged_share(of: PlanarArray, scale: float, reach: float, turn: float) -> float:
    """Return the part of drawn starts, within `reach` pitches and `turn` degrees, that end where the body is."""
    q, off = random_starts(of, reach, turn)
    end = hall_correction.iterate(of, hall_correction.volts(of, q), q + off, scale, CORRECTIONS)
    return float(np.mean(np.hypot(*(end - q)[:2]) < CONVERGED))


def random_starts(of: PlanarArray, reach: float, turn: float) -> tuple[Array, Array]:
    """Return poses (3, N) at yaw 0 in the pitch, and by how much the starts are off."""
    rng = np.random.default_rng(SEED)
    q = np.vstack([rng.uniform(0, of.pitch, (2, DRAWS)), np.zeros(DRAWS)])
    sides = np.array([[reach * of.pitch], [reach * of.pitch], [radians(turn)]])
    return q, sides * rng.uniform(-1, 1, (3, DRAWS))


def staircase_estimates(stage: Stage, step: float, yaw_known: bool) -> Array:
    """Return the estimates of X in m of bodies that climb stairs, (stairs, samples, N), the first ones left out."""
    of, time = stage.pair, Discrete(PERIOD)
    q = grid(of, ALONG)
    size = 2 * len(of.positions) * q.shape[1]
    noise = hall_chain.noise(stage.chain, time, (size, (STEPS + 1) * TREAD), SEED).T
    estimates, at = [], q
    for stair, more in enumerate(noise.reshape(STEPS + 1, TREAD, 2, -1, q.shape[1])):
        true = q + np.array([[step * stair], [0.0], [0.0]])
        clean = hall_correction.volts(of, true)
        for now in more:
            at = hall_correction.iterate(of, clean + now, at, SCALE, INNER, yaw_known)
            estimates.append(at[0])
    return np.array(estimates).reshape(STEPS + 1, TREAD, -1)[:, TREAD // 2 :]
