"""Probe of sensors at rest, in NumPy: reference of `blocks.probe`.

+a for n samples, -a for 2 n, +a for n;   a = step / (n T)^2 times k + 1, or (-1)^k (1 + k/2) to both sides
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from synth.reference.guard import rows

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
Columns = Mapping[str, NDArray[Any]]

MEMORY = ("sample", "attempt", "towards")


@dataclass(frozen=True)
class Probe:
    """Samples of waiting and of a quarter, first displacement in m, pairs, whether to both sides, period and bound."""

    quiet: int
    quarter: int
    step: float
    attempts: int
    T: float
    both_sides: bool = False
    most: float = 1e4  # of a demand


def probe(
    axes: Sequence[str], w: Array, e: Array, state: Columns, still: Array, free: Flags, by: Probe
) -> tuple[Array, dict[str, Array]]:
    """Return the demands of some axes (m, n) with the pairs of the probe, and its next states."""
    sample, attempt, towards = (rows(state, [f"probe_{s}_{n}" for s in axes]) for n in MEMORY)
    pair, acceleration = 4 * by.quarter + 3, by.step / (by.quarter * by.T) ** 2
    runs, waits = sample > 0, still >= by.quiet
    ends, failures = sample >= pair, np.minimum(attempt + 1, by.attempts)
    starts = waits & free
    after = np.where(ends, np.where(still >= pair, failures, 0), attempt)
    other = np.where(ends, -towards, towards) if by.both_sides else towards
    first = np.where(e > 0, -acceleration, acceleration)
    first = np.where(attempt >= 1, towards, first) if by.both_sides else first
    new = (
        np.where(runs, np.where(ends, 0, sample + 1), starts),
        np.where(runs, after, attempt),
        np.where(runs, other, first),
    )
    idle, next = (np.zeros_like(sample), np.zeros_like(sample), towards), dict[str, Array]()
    for n, value, unprobed in zip(MEMORY, new, idle, strict=True):
        each = np.where(runs | waits, value, unprobed)
        next |= {f"probe_{s}_{n}": row for s, row in zip(axes, each, strict=True)}
    push = towards * ((attempt / 2 if by.both_sides else attempt) + 1)
    inner = (sample > by.quarter) & (sample <= 3 * by.quarter)
    pulse = np.where(sample <= 4 * by.quarter, np.where(inner, -push, push), 0.0)
    return np.where(runs, np.clip(w + pulse, -by.most, by.most), w), next
