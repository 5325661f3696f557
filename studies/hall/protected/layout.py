"""Search for a layout of sensors by its protection levels: `python -m studies.hall.protected.layout`.

    level of unknown i at a pose:   s (L max over sensors of x_i' S^-1 x_i)^(1/2) + k sigma_i      `glsdc_integrity`
    maximise over layouts           the share of poses at which every level is within its limit

Poses are anywhere in the pitch, at yaws of `trust`. Random layouts come first, then perturbations of the best ones. An
argument is the number of sensors, 3 without it; a second one is the number of random layouts, 1,500 without it. The
result for the layout that ships is printed first.
"""

import sys
from collections.abc import Sequence

import numpy as np

from designs.hall_position.paper.layouts import SEARCH_RADIUS
from designs.hall_position.protected import config
from designs.hall_position.protected.parameters import Tuning
from models.hall_motions import Numbers
from studies.hall.protected import trust
from synth.blocks.estimate import glsdc_integrity

COARSE, FINE, EXACT = 300, 1000, 10_000  # poses of a random layout, of a perturbed one, and of a result
BEST, PERTURBATIONS, SIZES = 5, 150, (0.01, 0.03, 0.1)  # layouts kept, tries of each, deviations in pitches
DRAWS, SEED = 1500, 1
NAMES = {len(places): name for name, places in config.PLACES.items()}


def jacobian(places: Numbers, poses: Numbers) -> Numbers:
    """Return the derivatives (N, 2 sensors, 4) of voltages in the field's axes by w X, w Y, the yaw and the amplitude.

    `places` (sensors, 2) are in pitches, `poses` (N, 3) in pitches and rad; the amplitude is 1.
    """
    of, turn = config.array(), 2 * np.pi
    (X, Y, yaw), rows = poses.T, []
    c, s, zero = np.cos(yaw), np.sin(yaw), np.zeros(len(poses))
    for x, y in places:
        arm = turn * (c * x - s * y), turn * (s * x + c * y)
        phases = [turn * v + a for v, a in zip((X, Y), arm, strict=True)]
        B = [of.alpha * np.sin(p) + of.beta * np.sin(5 * p) for p in phases]
        slope = [of.alpha * np.cos(p) + 5 * of.beta * np.cos(5 * p) for p in phases]
        rows.append(np.stack([slope[0], zero, B[1] - arm[1] * slope[0], B[0]], axis=-1))
        rows.append(np.stack([zero, slope[1], arm[0] * slope[1] - B[0], B[1]], axis=-1))
    return np.stack(rows, axis=1)


def levels(places: Numbers, poses: Numbers, tuning: Tuning) -> Numbers:
    """Return the protection levels (N, 3) of X, Y in m and of the yaw, infinite where a fault is not detectable."""
    H, variance = jacobian(places, poses), config.array().deviation ** 2 + tuning.model_error**2
    prior = np.diag([0, 0, 0, variance / tuning.amplitude_prior**2])
    covariance = np.linalg.inv(np.swapaxes(H, 1, 2) @ H + prior)
    moves = covariance @ np.swapaxes(H, 1, 2)
    hat, added, detectable = H @ moves, np.zeros((len(poses), 4)), np.ones(len(poses), bool)
    for k in range(0, H.shape[1], 2):
        x, S = moves[:, :, k : k + 2], np.eye(2) - hat[:, k : k + 2, k : k + 2]
        known = np.linalg.eigvalsh(S)[:, 0] > glsdc_integrity.DETECTABLE
        inverse = np.linalg.inv(np.where(known[:, None, None], S, np.eye(2)))
        added = np.maximum(added, np.einsum("nij,njk,nik->ni", x, inverse, x))
        detectable &= known
    thresholds = glsdc_integrity.thresholds(H.shape[1] - 3, tuning.false_alarm, tuning.risk, 2)
    sigmas = np.sqrt(np.diagonal(covariance, axis1=1, axis2=2))
    size = np.sqrt(variance) * (np.sqrt(thresholds.noncentrality * added) + thresholds.deviations * sigmas)
    w = config.array().wave_number
    return np.where(detectable[:, None], size[:, :3] / [w, w, 1], np.inf)


def availability(places: Sequence[Sequence[float]] | Numbers, tuning: Tuning, poses: int = EXACT) -> float:
    """Return the share of random poses at which the levels of a layout (sensors, 2), in pitches, are within limits."""
    rng = np.random.default_rng(SEED)
    at = rng.uniform(-1, 1, (poses, 3)) * [0.5, 0.5, trust.YAW]
    limits = [tuning.position_limit, tuning.position_limit, tuning.yaw_limit]
    return float((levels(np.asarray(places), at, tuning) <= limits).all(axis=1).mean())


def search(sensors: int, tuning: Tuning, draws: int) -> Numbers:
    """Return the best layout (sensors, 2) of random ones and of perturbations of the best of these, in pitches."""
    rng = np.random.default_rng(SEED)
    random = rng.uniform(-SEARCH_RADIUS, SEARCH_RADIUS, (draws, sensors, 2))
    order = np.argsort([availability(places, tuning, COARSE) for places in random])[::-1]
    candidates = [_improve(places, tuning, rng) for places in random[order[:BEST]]]
    return max(candidates, key=lambda places: availability(places, tuning))


def _improve(places: Numbers, tuning: Tuning, rng: np.random.Generator) -> Numbers:
    best = availability(places, tuning, FINE)
    for _ in range(PERTURBATIONS):
        moved = places + rng.choice(SIZES) * rng.standard_normal(places.shape)
        moved = np.clip(moved, -SEARCH_RADIUS, SEARCH_RADIUS)
        share = availability(moved, tuning, FINE)
        if share > best:
            places, best = moved, share
    return places


def main(sensors: int, draws: int) -> None:
    """Print the share of poses of the layout that ships, and the best layout of a search with its share."""
    name = NAMES[sensors]
    tuning = config.TUNINGS[name]
    for what, places in (("ships", np.array(config.PLACES[name])), ("found", search(sensors, tuning, draws))):
        share = 100 * availability(places, tuning)
        sys.stdout.write(f"{what}: {np.round(places, 3).tolist()} has {share:.1f} % of the poses\n")


if __name__ == "__main__":
    numbers = [int(v) for v in sys.argv[1:]]
    main(*(numbers + [3, DRAWS][len(numbers) :]))
