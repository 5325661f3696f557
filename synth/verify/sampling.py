"""Random stimuli (x, u) for single steps: uniform in the ranges, at range ends, and near recorded operation.

    anywhere      x and u uniform in their declared ranges; integer states uniform among their values
    at the edges  the same, with a quarter of the inputs at a range end, at the next number beyond, or SPECIAL
    in operation  recorded steps with x and u perturbed by various orders of magnitude, inside their ranges

The order of the random draws is part of the interface: a seed permanently gives the same steps.
"""

from collections.abc import Collection
from typing import Any

import numpy as np
from numpy.typing import NDArray

from synth.block import Block
from synth.signals import Signal
from synth.verify.steps import Steps

Columns = dict[str, NDArray[Any]]

SPECIAL = (np.nan, np.inf, -np.inf, 5e-324, -5e-324, 1e-40, -0.0, 0.0, 1e300, -1e300)
DISTANCES = (-6, -1.5)  # exponents of ten: size of the perturbation of recorded steps, relative to the range
MARGIN = 1e-6  # of a range, because its ends differ between single and double precision


def states_anywhere(
    block: Block, rng: np.random.Generator, n: int, margin: float = 0.0, whole: Collection[str] = ()
) -> Columns:
    """Draw states (n,) uniformly in their bounds, real ones a `margin` of their range inside them.

    Real states named in `whole` are drawn among whole numbers.
    """
    columns = {}
    for s in block.states:
        low, high = s.signal.low, s.signal.high
        if s.integer or s.name in whole:
            columns[s.name] = rng.integers(int(low), int(high) + 1, n).astype(float)
        else:
            columns[s.name] = limited_to_range(s.signal, rng.uniform(low, high, n), margin)
    return columns


def inputs_anywhere(block: Block, rng: np.random.Generator, n: int) -> Columns:
    """Draw inputs (n,) uniformly in their ranges."""
    return {s.name: rng.uniform(s.low, s.high, n) for s in block.inputs}


def anywhere(block: Block, rng: np.random.Generator, n: int, margin: float = 0.0) -> tuple[Columns, Columns]:
    """Draw n independent (states, inputs) uniformly in their ranges, states first."""
    return states_anywhere(block, rng, n, margin), inputs_anywhere(block, rng, n)


def edge_values(signal: Signal) -> tuple[float, ...]:
    """Return the ends of a range, the next numbers beyond them, and SPECIAL."""
    beyond = np.nextafter(signal.low, -np.inf), np.nextafter(signal.high, np.inf)
    return (signal.low, signal.high, *map(float, beyond), *SPECIAL)


def at_edges(
    signal: Signal, rng: np.random.Generator, n: int, others: NDArray[Any] | None = None
) -> NDArray[np.float64]:
    """Draw n values, a quarter of them edge values; the rest are `others`, or else uniform in the range."""
    values = edge_values(signal)
    chosen = rng.integers(0, 4 * len(values), n)
    between = rng.uniform(signal.low, signal.high, n) if others is None else others
    return np.where(chosen < len(values), np.take(values, chosen % len(values)), between)


def edge_steps(block: Block, rng: np.random.Generator, n: int) -> tuple[Columns, Columns]:
    """Draw n independent (states, inputs): states uniform in their bounds, a quarter of the inputs at edge values."""
    states, inputs = anywhere(block, rng, n)
    return states, inputs | {s.name: at_edges(s, rng, n, inputs[s.name]) for s in block.inputs}


def operating_steps(block: Block, rng: np.random.Generator, n: int, recorded: Steps) -> tuple[Columns, Columns]:
    """Draw n of the `recorded` steps; perturb real states and inputs by up to a few percent of their ranges.

    Integer states are as recorded; all values stay inside their ranges.
    """
    chosen = rng.integers(0, len(recorded), n)
    size = 10.0 ** rng.uniform(*DISTANCES, n)
    x, u = recorded.states[chosen], recorded.inputs[chosen]
    states = {
        s.name: x[s.name].astype(np.float64) if s.integer else _perturbed(s.signal, x[s.name], rng, size)
        for s in block.states
    }
    return states, {s.name: _perturbed(s, u[s.name], rng, size) for s in block.inputs}


def _perturbed(
    signal: Signal, values: NDArray[Any], rng: np.random.Generator, size: NDArray[np.float64]
) -> NDArray[np.float64]:
    by = size * (signal.high - signal.low) * rng.standard_normal(len(size))
    return limited_to_range(signal, np.nan_to_num(values.astype(np.float64)) + by, MARGIN)


def limited_to_range(signal: Signal, values: NDArray[Any], margin: float = MARGIN) -> NDArray[np.float64]:
    """Return values limited to the range of a signal, reduced by `margin` times its width on both sides."""
    margin_width = margin * (signal.high - signal.low)
    return np.clip(values, signal.low + margin_width, signal.high - margin_width)
