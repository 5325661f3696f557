"""Probe of the encoders of x and z at rest: NumPy reference for the generated C.

+a for n samples, -a for 2 n, +a for n;   a = step / (n T)^2 times k + 1, or (-1)^k (1 + k/2) to both sides
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from designs.maglev import reference_stage

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
Columns = Mapping[str, NDArray[Any]]

T = 1e-3  # s
MEMORY = ("sample", "attempt", "towards")


@dataclass(frozen=True)
class Probe:
    """Samples of waiting and of a quarter, first displacement in m, pairs, and whether they go to both sides."""

    quiet: int = 40
    quarter: int = 3
    step: float = 4.2e-6
    attempts: int = 5
    both_sides: bool = False


PROBE = Probe()


def probe(w: Array, e: Array, state: Columns, still: Array, free: Flags, by: Probe) -> tuple[Array, dict[str, Array]]:
    """Return the demands of x and z (2, n) with the pairs of the probe, and its next states."""
    sample, attempt, towards = (reference_stage.rows(state, [f"probe_{s}_{n}" for s in "xz"]) for n in MEMORY)
    pair, acceleration = 4 * by.quarter + 3, by.step / (by.quarter * T) ** 2
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
        rows = np.where(runs | waits, value, unprobed)
        next |= {f"probe_{s}_{n}": row for s, row in zip("xz", rows, strict=True)}
    push = towards * ((attempt / 2 if by.both_sides else attempt) + 1)
    inner = (sample > by.quarter) & (sample <= 3 * by.quarter)
    pulse = np.where(sample <= 4 * by.quarter, np.where(inner, -push, push), 0.0)
    return np.where(runs, np.clip(w + pulse, -1e4, 1e4), w), next
