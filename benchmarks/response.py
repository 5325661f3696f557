"""Frequency responses compared with python-control and SLICOT: time and memory.

A frequency response has 1,000 points on the axis (python-control: tb05ad, one at a time from the Hessenberg form). The
models are dense with random entries, and flexible stages of n/2 lightly damped modes, with two inputs and outputs.

Growth with the size of a loop: N masses between springs, each driven and measured, under LQG, with 4 N states in the
loop L = P K, N inputs and N outputs.

    response         L at 1,000 points                              python-control
    H-infinity norm  of one entry of S, certified here              SLICOT's ab13dd
    margins          of L closed but for one channel, verified here python-control
    disk margin      of all channels, certified here                python-control at 400 points
    Riccati          the regulator's, 2 N states, certified here    SciPy

Times are processor times on one thread, which depend little on other load. Each is the median of alternating runs, and
a ratio is the median of the ratios within a turn. Memory is the peak of allocated memory.
"""

import os
import sys
import tracemalloc
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from inspect import unwrap
from time import process_time
from typing import Any

import control
import numpy as np
import scipy.linalg

from benchmarks import disk
from synth.analyse.loops import disk as disk_margins
from synth.analyse.loops import feedback_loop, stability_margins, structured_peak
from synth.statespace import Array, StateSpace, of
from synth.synthesise.riccati import riccati

SIZES = (6, 20, 60, 200)
MASSES = (2, 5, 10, 15, 20)
POINTS = 1000
STIFFNESS, DAMPING, NOISE = 1.0, 0.01, 0.01  # of each spring in N/m and of the stiffness in s; of a sensor in m^2/Hz
CHANNELS = 2
TURNS, ENOUGH_S = 9, 2.0
TOLERANCE = 1e-6  # of the norm, that of its certificate; with less, ab13dd returns 1 instead of 1.8 for 3 masses


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
    """Return the times in ms (turns, calls) of calls that take TURNS turns, or fewer if they take ENOUGH_S."""
    turns: list[list[float]] = []
    while len(turns) < TURNS and sum(map(sum, turns)) < ENOUGH_S:
        turns.append([])
        for call in calls:
            start = process_time()
            call()
            turns[-1].append(process_time() - start)
    return 1e3 * np.array(turns)


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


@dataclass(frozen=True, eq=False)
class Chain:
    """N driven masses between springs, A (2 N, 2 N), B, C, with the weights Q of the regulator, and the LQG loop L."""

    A: Array
    B: Array
    C: Array
    Q: Array
    L: StateSpace

    @property
    def S(self) -> StateSpace:
        """The sensitivity (N, N)."""
        return feedback_loop.close(self.L, _unit(len(self.C))).S


def _unit(n: int) -> StateSpace:
    return of((np.zeros((0, 0)), np.zeros((0, n)), np.zeros((n, 0)), np.eye(n)))


def chain(masses: int) -> Chain:
    """Return the chain with SciPy's regulator and Kalman filter."""
    one, zero = np.eye(masses), np.zeros((masses, masses))
    K = STIFFNESS * (2 * one - np.eye(masses, k=1) - np.eye(masses, k=-1))
    A, B, C = np.block([[zero, one], [-K, -DAMPING * K]]), np.vstack([zero, one]), np.hstack([one, zero])
    Q = 100 * C.T @ C
    F = B.T @ scipy.linalg.solve_continuous_are(A, B, Q, one)
    H = scipy.linalg.solve_continuous_are(A.T, C.T, B @ B.T, NOISE * one) @ C.T / NOISE
    empty = np.zeros((2 * masses, masses))
    whole = np.block([[A, B @ F], [np.zeros_like(A), A - B @ F - H @ C]])
    return Chain(A, B, C, Q, of((whole, np.vstack([empty, H]), np.hstack([C, empty.T]), zero)))


def pairs(masses: int) -> dict[str, tuple[Callable[[], Any], Callable[[], Any]]]:
    """Return what is timed for a chain: the peer's call, and the call here."""
    c = chain(masses)
    theirs, s, w = c.L.to_control(), 1j * np.geomspace(1e-2, 1e3, POINTS), np.geomspace(1e-2, 1e3, disk.POINTS)
    channel = c.S.select(c.S.outputs[:1], c.S.inputs[:1])
    scalar, R, ends = channel.to_control(), np.eye(masses), np.arange(masses) > 0
    rest = c.L.B[:, ends] @ c.L.C[ends]  # all channels but the first are closed
    opened = of((c.L.A - rest, c.L.B[:, :1], c.L.C[:1], np.zeros((1, 1))))
    loop, margins, of_disk = opened.to_control(), unwrap(stability_margins.of_loop), unwrap(disk_margins.of_loop)
    return {
        "response": (lambda: theirs(s), lambda: c.L.response(s)),
        "H-infinity norm": (
            lambda: control.linfnorm(scalar, TOLERANCE),
            lambda: structured_peak.over_frequency(channel),
        ),
        "margins": (lambda: control.stability_margins(loop), lambda: margins(opened)),
        "disk margin": (lambda: control.disk_margins(theirs, w), lambda: of_disk(c.L)),
        "Riccati": (
            lambda: scipy.linalg.solve_continuous_are(c.A, c.B, c.Q, R),
            lambda: riccati.solve((c.A, c.B), c.Q, R),
        ),
    }


def growth() -> Iterator[str]:
    """Yield the lines of the table of growth, each when it has been measured."""
    names = ("states", "quantity       ", "peer, ms", "here, ms", "here / peer")
    yield "  ".join(names)
    for masses in MASSES:
        for name, calls in pairs(masses).items():
            times = in_turns(*calls)
            cells = *(f"{v:.2f}" for v in np.median(times, axis=0)), f"{np.median(times[:, 1] / times[:, 0]):.2f}"
            ends = [v.rjust(len(n)) for v, n in zip(cells, names[2:], strict=True)]
            yield "  ".join([str(4 * masses).rjust(len(names[0])), name.ljust(len(names[1])), *ends])


if __name__ == "__main__":
    # A second thread gains nothing on most of these sizes, and waits for a core where other work keeps both busy.
    if os.environ.get("OPENBLAS_NUM_THREADS") != "1":
        os.execve(
            sys.executable, [sys.executable, "-m", "benchmarks.response"], {**os.environ, "OPENBLAS_NUM_THREADS": "1"}
        )
    for line in (*responses(), "", *growth()):
        sys.stdout.write(f"{line}\n")
        sys.stdout.flush()
