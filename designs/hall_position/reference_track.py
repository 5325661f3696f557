"""Reference of screening, sweep of starts, track and count of pitches, in plain NumPy."""

from dataclasses import dataclass
from math import pi

import numpy as np
from scipy import optimize

from designs.hall_position import reference_guard
from designs.hall_position.reference_glsdc import Array, Columns, Setup, wrap

SEARCHED = ("phase_x", "phase_y", "yaw")


@dataclass(frozen=True)
class Sample:
    """A sample: prediction, pose and displacement (N, 4), whether it has converged and is accepted, next exclusion.

    `complete`: with all the sensors that a sweep needs.
    """

    start: Array
    pose: Array
    at: Array
    converged: Array
    accepted: Array
    complete: Array
    best: Array


def screen(setup: Setup, states: Columns, held: Array, refused: Array) -> tuple[Array, Array, dict[str, Array]]:
    """Return whether one sensor is faulty at most, its number or 0, and the next states."""
    names, flat = reference_guard.channels(setup), held.reshape(len(held), -1)
    numbers = np.arange(1, len(setup.positions) + 1)
    last = np.stack([np.asarray(states[f"screen_last_{n}"], dtype=np.float64) for n in names], axis=1)
    repeats = np.stack([np.asarray(states[f"screen_repeats_{k}"], dtype=np.int64) for k in numbers], axis=1)
    same = (held == last.reshape(held.shape)).any(axis=2)
    counts = np.where(same, np.minimum(repeats + 1, setup.repeats), 0)
    faulty = refused.any(axis=2) | (counts >= setup.repeats)
    single = faulty.sum(axis=1) <= 1
    next = {f"screen_last_{n}": v for n, v in zip(names, flat.T, strict=True)}
    next |= {f"screen_repeats_{k}": v for k, v in enumerate(counts.T, 1)}
    return single, np.where(single, faulty @ numbers, 0), next


def increments(setup: Setup) -> Array:
    """Return the increments of the starts (3,): Roberts' sequence in three dimensions."""
    g = optimize.brentq(lambda v: v**4 - v - 1, 1.0, 2.0, xtol=1e-16)
    return np.array([2 * pi, 2 * pi, 2 * setup.yaw_range]) * g ** -np.arange(1.0, 4.0)


def advance(setup: Setup, x: Columns, sample: Sample) -> tuple[dict[str, Array], Array, Array]:
    """Return the next states of the estimator, whether it tracks, and whether the track is lost."""
    tracking, lost = x["start_number"] >= setup.starts, x["missed"] >= setup.patience
    solves, first = sample.converged & sample.accepted & sample.complete, x["candidates"] == 0
    difference = np.abs(np.stack([sample.pose[:, i] - x[f"candidate_{n}"] for i, n in enumerate(SEARCHED)], axis=1))
    difference[:, :2] = np.minimum(difference[:, :2], np.abs(difference[:, :2] - 2 * pi))
    agrees = (difference <= [setup.agreement, setup.agreement, setup.yaw_agreement]).all(axis=1)
    count = np.maximum(x["candidates"], solves * np.where(first | agrees, 1, 2))
    ends = sample.converged | (x["age"] >= setup.dwell - 1)
    last = ends & (x["start_number"] >= setup.starts - 1)
    unique = last & (count == 1)
    next = _unknowns(setup, x, sample, tracking, ends, unique, first & solves)
    for i, n in enumerate(SEARCHED):
        step = (setup.phase_step, setup.phase_step, setup.yaw_step)[i]
        d, motion = sample.at[:, i], x[f"motion_{n}"]
        moved = np.where(np.abs(d) < step, motion + setup.velocity_gain * d, 0)
        next[f"motion_{n}"] = np.clip(tracking * np.where(sample.accepted, moved, motion), -step, step)
    following = np.where(last, setup.starts * unique, np.minimum(x["start_number"] + ends, setup.starts - 1))
    missed = np.minimum(x["missed"] + 1, setup.patience)
    next |= {
        "excluded": tracking * sample.best,
        "start_number": np.where(tracking, setup.starts, following),
        "candidates": (~tracking & (~last | unique)) * count,
        "age": (~tracking & ~ends) * np.minimum(x["age"] + 1, setup.dwell - 1),
        "missed": (tracking & (lost | ~sample.accepted)) * missed,
    }
    return next, tracking, lost


def _unknowns(
    setup: Setup, x: Columns, sample: Sample, tracking: Array, ends: Array, unique: Array, adopt: Array
) -> dict[str, Array]:
    next: dict[str, Array] = {}
    step = increments(setup)
    for i, n in enumerate((*SEARCHED, "amplitude")):
        candidate = np.where(adopt, sample.pose[:, i], x[f"candidate_{n}"])
        start = np.ones(len(candidate))
        if n in SEARCHED:
            half = setup.yaw_range if n == "yaw" else pi
            start = x[f"begin_{n}"] + step[i]
            start = np.clip(np.where(start > half, start - 2 * half, start), -half, half)
            next[f"begin_{n}"] = np.where(ends & ~tracking, start, x[f"begin_{n}"])
        sweep = np.where(unique, candidate, np.where(ends, start, sample.pose[:, i]))
        track = np.where(sample.accepted, sample.pose[:, i], sample.start[:, i])
        next |= {f"candidate_{n}": np.where(tracking, x[f"candidate_{n}"], candidate)}
        next[n] = np.where(tracking, track, sweep)
    return next


def metres(setup: Setup, states: Columns, pose: Array, tracking: Array) -> tuple[dict[str, Array], dict[str, Array]]:
    """Return X and Y in m, and the next states: pitches are counted while it tracks."""
    outputs: dict[str, Array] = {}
    next: dict[str, Array] = {}
    for i, a in enumerate("xy"):
        before = np.asarray(states[f"metres_pitch_{a}"], dtype=np.float64)
        _, turns = wrap(pose[:, i] - np.asarray(states[f"metres_last_{a}"], dtype=np.float64))
        inside = (np.abs(before) <= setup.pitches) & (np.asarray(states["metres_counting"]) > 0)
        count = np.clip((before - inside * turns) * tracking, -setup.pitches - 1, setup.pitches + 1)
        outputs[a.upper()] = pose[:, i] / setup.wave_number + setup.pitch * count
        next |= {f"metres_last_{a}": pose[:, i], f"metres_pitch_{a}": count}
    return outputs, next | {"metres_counting": tracking}
