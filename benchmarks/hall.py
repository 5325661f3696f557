"""Instructions of a sample of the Hall estimators on a Cortex-M4F: two sensors, three, and four.

    python -m benchmarks.hall

Two sensors with the five corrections and the descent check that ship, and with two corrections, as in tracking; three
and four over their test vectors. Two took 2,295 instructions while their normal equations were written out. The largest
of the samples each; not cycles, and no bound of the worst case.
"""

import sys
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from designs.hall_position import config
from designs.hall_position.glsdc import estimator
from designs.hall_position.glsdc.estimator import SURROGATE_ERROR
from designs.hall_position.glsdc.parameters import Tuning
from designs.hall_position.protected import config as protected
from models import hall_motions as motions
from models.hall_motions import Numbers, Pose
from synth.block import Block
from synth.emit import write
from synth.execute import cross
from synth.execute.target import load

SAMPLES, SEED = 400, 0


class Cost(NamedTuple):
    """The largest instructions of a sample of an estimator, over some samples."""

    estimator: str
    samples: int
    instructions: int


def count_instructions(block: Block, inputs: dict[str, Numbers]) -> list[int]:
    """Return the instructions of each sample of the float C."""
    emitted = write.emit(block, np.float32, error=SURROGATE_ERROR[np.float32])
    target = load(emitted.files, emitted.manifest, compiler="gcc" if "gcc" in cross.available() else "zig")
    return [int(n) for n in target.measure(inputs).cost.instructions]


def voltages() -> dict[str, Numbers]:
    """Return the voltages of two sensors in a small motion about the origin."""
    angle = 2 * np.pi * np.arange(SAMPLES) * config.TIME.period_s
    pose = Pose(0.004 * np.sin(2 * angle), 0.003 * np.cos(3 * angle) - 0.003, 0.02 * np.sin(angle))
    return motions.by_input(motions.noisy(config.array(), pose, SEED))


def costs() -> Iterator[Cost]:
    """Yield the cost of each estimator."""
    read, array = voltages(), config.array()
    for iterations in (config.TUNING.iterations, 2):
        block = estimator.guarded_estimator(array, config.TIME, Tuning(iterations))
        yield Cost(f"two sensors, {iterations} corrections", SAMPLES, max(count_instructions(block, read)))
    for name, what in ((protected.THREE, "three sensors"), (protected.NAME, "four sensors")):
        vectors = protected.vectors({"V_ax": np.zeros(1, np.float32)}, {}, name)
        counts = count_instructions(protected.block(name=name), vectors)
        tracking = counts[protected.REST : protected.REFUSED.start]
        yield Cost(f"{what}, tracking without a fault", len(tracking), max(tracking))
        yield Cost(f"{what}, sweep, tracking, and faults", len(counts), max(counts))


def lines() -> Iterator[str]:
    """Yield the costs as text."""
    yield "instructions of a sample, Cortex-M4F, the largest"
    for cost in costs():
        yield f"{cost.estimator:45} {cost.samples:5} samples {cost.instructions:6}"


if __name__ == "__main__":
    for line in lines():
        sys.stdout.write(f"{line}\n")
        sys.stdout.flush()
