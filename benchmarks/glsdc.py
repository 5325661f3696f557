"""Weighted least squares of beacon problems: instructions of a sample on a Cortex-M4F, and Stanford diagrams.

    python -m benchmarks.glsdc [--samples 100000]

The instructions are the largest over samples with and without faults. For the diagrams each body has a fault of a
random size, from 0 to LARGEST deviations, in one of its channels. Its estimator runs three samples from nearby, so that
exclusion, which acts from the next sample on, shows.
"""

import argparse
import sys
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from benchmarks import beacons
from benchmarks.beacons import Problem
from synth.block import Block
from synth.blocks.estimate.glsdc_integrity import Integrity
from synth.blocks.estimate.glsdc_solution import Iteration
from synth.emit import write
from synth.execute import cross, host
from synth.execute.host import Controller, compile_block
from synth.execute.target import load
from synth.simulate import worst_case
from synth.simulate.worst_case import Diagram
from synth.statespace import Array

LARGEST, SAMPLES, COUNTED, SEED = 15.0, 100_000, 100, 7
FALSE_ALARM, RISK = 1e-3, 1e-3
LIMITS = {"ranges": {"x": 0.3, "y": 0.3}, "bearings": {"x": 0.3, "y": 0.3, "heading": 0.03}}
PROBLEMS = (
    beacons.ranges(3),
    beacons.ranges(4),
    beacons.ranges(6),
    beacons.ranges(5, bias=True),
    beacons.ranges(6, bias=True),
    beacons.bearings(4),
    beacons.bearings(6),
)


class Cost(NamedTuple):
    """Largest instructions of a sample with a number of corrections, with a monitor or without."""

    problem: str
    corrections: int
    monitor: str
    instructions: int


class Trial(NamedTuple):
    """Errors (N, n), protection levels (N, n) and validity (N,) of a problem with faults."""

    errors: Array
    levels: Array
    valid: Array


def title(of: Problem) -> str:
    """Return the problem in a few words."""
    return f"{of.kind} to {of.beacons} beacons: {', '.join(of.unknowns)}"


def monitors(of: Problem) -> dict[str, Integrity | None]:
    """Return the monitors that the redundancy of a problem allows, by name."""
    spare, limits = of.beacons - len(of.unknowns), LIMITS[of.kind]
    named: dict[str, Integrity | None] = {"none": None}
    named |= {"test": Integrity(limits, FALSE_ALARM, RISK)} if spare > 0 else {}
    return named | ({"exclusion": Integrity(limits, FALSE_ALARM, RISK, exclude=True)} if spare > 1 else {})


def count_instructions(block: Block, of: Problem) -> int:
    """Return the largest number of instructions of a step of the float C over COUNTED samples."""
    emitted = write.emit(block, np.float32)
    controller = host.load(emitted.files, emitted.manifest)
    target = load(emitted.files, emitted.manifest, compiler="gcc" if "gcc" in cross.available() else "zig")
    rng = np.random.default_rng(SEED)
    q = beacons.draw(of, COUNTED, rng)
    y = measurements(of, q, np.where(np.arange(COUNTED) < COUNTED // 2, 0.0, LARGEST), rng)
    inputs = {s.name: y[:, i] for i, s in enumerate(of.channels)}
    return int(target.measure(inputs, nearby_states(of, controller, q[:1], rng).reshape(())).cost.instructions.max())


def measurements(of: Problem, q: Array, sizes: Array, rng: np.random.Generator) -> Array:
    """Return channels (N, m) with noise, and with a fault of sizes (N,) deviations in a random channel of each row."""
    y = beacons.values(of, q) + of.sigma * rng.standard_normal((len(q), of.beacons))
    y[np.arange(len(q)), rng.integers(of.beacons, size=len(q))] += sizes * of.sigma
    return beacons.wrap(y) if of.kind == "bearings" else y


def nearby_states(of: Problem, controller: Controller, q: Array, rng: np.random.Generator) -> host.Records:
    """Return states (N,) with estimates near unknowns (N, n)."""
    states = np.repeat(controller.init()[None], len(q))
    for name, values in zip(of.unknowns, q.T, strict=True):
        states[f"estimator_{name}"] = values + (0.01 if name == "heading" else 0.05) * rng.uniform(-1, 1, len(q))
    return states


def trial(of: Problem, monitor: Integrity, samples: int) -> Trial:
    """Return what the float C estimates in the last of three samples of each body."""
    controller, rng = compile_block(beacons.block(of, monitor)), np.random.default_rng(SEED)
    q, sizes = beacons.draw(of, samples, rng), rng.uniform(0, LARGEST, samples)
    channel, states = rng.integers(of.beacons, size=samples), nearby_states(of, controller, q, rng)
    for _ in range(3):
        y = measurements(of, q, np.zeros(samples), rng)
        y[np.arange(samples), channel] += sizes * of.sigma
        batch = controller.batch(states, {s.name: y[:, i] for i, s in enumerate(of.channels)})
        states = batch.states
    limited = [i for i, name in enumerate(of.unknowns) if name in monitor.limits]
    errors, levels = (
        np.column_stack([batch.outputs[prefix + of.unknowns[i]] for i in limited]) for prefix in ("", "protection_")
    )
    errors = errors - q[:, limited]
    return Trial(beacons.wrap(errors) if of.kind == "bearings" else errors, levels, batch.outputs["valid"])


def costs() -> Iterator[Cost]:
    """Yield the cost of each problem, with each monitor, and with two corrections as in tracking."""
    for of in PROBLEMS:
        for corrections in (2, 5):
            for name, monitor in monitors(of).items():
                block = beacons.block(of, monitor, iteration=Iteration(corrections))
                yield Cost(title(of), corrections, name, count_instructions(block, of))


def diagrams(samples: int) -> Iterator[tuple[str, Diagram]]:
    """Yield the diagram of the first unknown of each problem with each monitor."""
    for of in PROBLEMS:
        for name, monitor in monitors(of).items():
            if monitor:
                t = trial(of, monitor, samples)
                first = worst_case.diagram(t.errors[:, 0], t.levels[:, 0], t.valid, monitor.limits[of.unknowns[0]], "m")
                yield f"{title(of)}, {name}", first


def lines(samples: int) -> Iterator[str]:
    """Yield the costs and the diagrams as text."""
    yield "instructions of a sample, Cortex-M4F, the largest; not cycles, and no bound of the worst case"
    for cost in costs():
        yield f"{cost.problem:45} {cost.corrections} corrections, {cost.monitor:10} {cost.instructions:6}"
    for name, diagram in diagrams(samples):
        yield f"\n{name}\n{diagram}"


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--samples", type=int, default=SAMPLES)
    for line in lines(parser.parse_args().samples):
        sys.stdout.write(f"{line}\n")
        sys.stdout.flush()
