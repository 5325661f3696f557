"""Disk margins compared with python-control and SLICOT: time, and the error of a frequency grid.

        L = g sum_k phi_k (a_k + b_k s) phi_k' / (s^2 + 2 zeta_k w_k s + w_k^2),        p channels, n/2 modes

of a flexible stage with fixed random modes phi_k. python-control computes mu at 400 frequencies with SLICOT's ab13md,
without a bound between them. The toolkit's margin is timed with its certificate for all frequencies and without. Times
are wall clock on one thread, medians of alternating runs; a ratio is the median of the ratios within a turn.
"""

import os
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from time import perf_counter

import control
import numpy as np

from synth.analyse.loops import disk
from synth.statespace import StateSpace, of

SIZES = ((2, 10), (4, 30), (6, 50))  # channels, states
POINTS = 400
TURNS = 7
SLOWEST, FASTEST = 0.5, 200.0  # rad/s
GAIN = 0.5


@dataclass(frozen=True)
class Comparison:
    """Times in ms and margins of one loop; `faster` and `faster_grid` are ratios with and without the certificate.

    `control_margin` is python-control's on its grid, `lower` and `upper` hold the margin between them.
    """

    channels: int
    states: int
    control_ms: float
    certified_ms: float
    grid_ms: float
    faster: float
    faster_grid: float
    control_margin: float
    lower: float
    upper: float
    certified: bool


def loop(channels: int, states: int) -> StateSpace:
    """Return the loop of a flexible stage with `channels` inputs and outputs."""
    rng = np.random.default_rng(1)
    count = states // 2
    w, zeta = np.geomspace(SLOWEST, FASTEST, count), rng.uniform(0.005, 0.05, count)
    shape, size = rng.standard_normal((count, channels)), rng.uniform(0.1, 0.3, count) * w**2
    skewed = np.eye(channels) + 0.1 * rng.standard_normal((channels, channels))
    A, B, C = np.zeros((states, states)), np.zeros((states, channels)), np.zeros((channels, states))
    even, odd = np.arange(0, states, 2), np.arange(1, states, 2)
    A[even, odd], A[odd, even], A[odd, odd] = 1.0, -(w**2), -2 * zeta * w
    B[odd], C[:, even], C[:, odd] = shape, skewed @ (shape * size[:, None]).T, 0.3 * skewed @ shape.T
    return of((A, B, GAIN * C, np.zeros((channels, channels))))


def compare(channels: int, states: int) -> Comparison:
    """Time python-control and this package on one loop, in turns."""
    L = loop(channels, states)
    theirs, w = L.to_control(), np.geomspace(SLOWEST / 10, FASTEST * 10, POINTS)
    turns = np.zeros((TURNS, 3))
    for turn in turns:
        start = perf_counter()
        margin = control.disk_margins(theirs, w)[0]
        one = perf_counter()
        certified = disk.of_loop(L)
        two = perf_counter()
        disk.of_loop(L, certify=False)
        turn[:] = one - start, two - one, perf_counter() - two
    theirs_ms, certified_ms, grid_ms = np.median(1e3 * turns, axis=0).tolist()
    faster, faster_grid = np.median(turns[:, :1] / turns[:, 1:], axis=0).tolist()
    return Comparison(
        channels,
        states,
        theirs_ms,
        certified_ms,
        grid_ms,
        faster,
        faster_grid,
        float(margin),
        certified.lower,
        certified.upper,
        certified.certified,
    )


def table() -> Iterator[str]:
    """Yield the table's lines, each when it has been measured."""
    times = ("python-control, ms", "certified, ms", "faster", "grid alone, ms", "faster")
    names = ("channels", "states", *times, "its margin", "lower", "upper", "certified")
    yield "  ".join(names)
    for channels, states in SIZES:
        c = compare(channels, states)
        cells = (
            *(str(c.channels), str(c.states), f"{c.control_ms:.1f}", f"{c.certified_ms:.1f}", f"{c.faster:.1f}"),
            *(f"{c.grid_ms:.1f}", f"{c.faster_grid:.1f}", f"{c.control_margin:.6f}", f"{c.lower:.6f}"),
            *(f"{c.upper:.6f}", "yes" if c.certified else "no"),
        )
        yield "  ".join(cell.rjust(len(name)) for cell, name in zip(cells, names, strict=True))


if __name__ == "__main__":
    # A second thread gains nothing on matrices of this size, and waits for a core where other work keeps both busy.
    if os.environ.get("OPENBLAS_NUM_THREADS") != "1":
        os.execve(
            sys.executable, [sys.executable, "-m", "benchmarks.disk"], {**os.environ, "OPENBLAS_NUM_THREADS": "1"}
        )
    for line in table():
        sys.stdout.write(f"{line}\n")
        sys.stdout.flush()
