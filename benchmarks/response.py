"""Frequency responses compared with python-control and SLICOT: time and memory.

A frequency response has 1,000 points on the axis (python-control: tb05ad, one at a time from the Hessenberg form). The
models are dense with random entries, and flexible stages of n/2 lightly damped modes, with two inputs and outputs.

Times are processor times on one thread, which depend little on other load. Each is the median of alternating runs, and
a ratio is the median of the ratios within a turn. Memory is the peak of allocated memory.
"""

import os
import sys
import tracemalloc
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from time import process_time

import numpy as np

from benchmarks import disk
from synth.statespace import Array, StateSpace, of

SIZES = (6, 20, 60, 200)
POINTS = 1000
CHANNELS = 2
TURNS = 9


@dataclass(frozen=True)
class Comparison:
    """Times in ms, and how many times as long python-control takes; `memory_MB` is the peak of this package."""

    name: str
    control_ms: float
    ms: float
    faster: float
    memory_MB: float


def dense(states: int, seed: int = 1) -> StateSpace:
    """Return a stable model with random entries and `CHANNELS` inputs and outputs."""
    rng = np.random.default_rng(seed)
    A = rng.standard_normal((states, states)) / np.sqrt(states)
    A -= (np.linalg.eigvals(A).real.max() + 0.1) * np.eye(states)
    D = rng.standard_normal((CHANNELS, CHANNELS))
    return of((A, rng.standard_normal((states, CHANNELS)), rng.standard_normal((CHANNELS, states)), D))


def in_turns(*calls: Callable[[], object]) -> Array:
    """Return the times in ms (TURNS, calls) of calls that take turns."""
    times = np.zeros((TURNS, len(calls)))
    for turn in times:
        for k, call in enumerate(calls):
            start = process_time()
            call()
            turn[k] = process_time() - start
    return 1e3 * times


def compare(name: str, model: StateSpace) -> Comparison:
    """Time the response of one model at 1,000 points of the axis."""
    theirs, s = model.to_control(), 1j * np.geomspace(1e-2, 1e3, POINTS)
    times = in_turns(lambda: theirs(s), lambda: model.response(s))
    tracemalloc.start()
    model.response(s)
    memory = tracemalloc.get_traced_memory()[1] / 1e6
    tracemalloc.stop()
    one, two = np.median(times, axis=0).tolist()
    return Comparison(name, one, two, float(np.median(times[:, 0] / times[:, 1])), memory)


def responses() -> Iterator[str]:
    """Yield the lines of the table of responses, each when it has been measured."""
    names = ("model           ", "python-control, ms", "here, ms", "faster", "memory, MB")
    yield "  ".join(names)
    for states in SIZES:
        for name, model in ((f"dense {states}", dense(states)), (f"flexible {states}", disk.loop(CHANNELS, states))):
            c = compare(name, model)
            cells = f"{c.control_ms:.1f}", f"{c.ms:.1f}", f"{c.faster:.1f}", f"{c.memory_MB:.1f}"
            yield "  ".join(
                [c.name.ljust(len(names[0])), *(v.rjust(len(n)) for v, n in zip(cells, names[1:], strict=True))]
            )


if __name__ == "__main__":
    # A second thread gains nothing on most of these sizes, and waits for a core where other work keeps both busy.
    if os.environ.get("OPENBLAS_NUM_THREADS") != "1":
        os.execve(
            sys.executable, [sys.executable, "-m", "benchmarks.response"], {**os.environ, "OPENBLAS_NUM_THREADS": "1"}
        )
    for line in responses():
        sys.stdout.write(f"{line}\n")
        sys.stdout.flush()
