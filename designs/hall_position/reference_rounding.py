"""How rounding acts on a step of the reference: condition numbers, gradients by differences, margins of decisions."""

from collections.abc import Iterator
from math import pi

import numpy as np

from designs.hall_position import reference
from designs.hall_position import reference_glsdc as glsdc
from designs.hall_position.reference_glsdc import Array, Columns, Setup

CHANGE = 1e-9  # of a voltage, of alpha, and of a phase, rad, by which a step is tried


def margin(of: Setup, state: Columns, volts: Array, refused: Array) -> Array:
    """Return how far a cost is from the bound below which it counts as lower, at least, (N,).

    In relative errors of the voltages of alpha, and of residuals, that would make it cross.
    """
    problem, (start, weights) = reference.problem(of), reference.predict(of, state, refused)
    costs = [fit.cost for fit in glsdc.descend(problem, start, volts, weights)[0]]
    lowest, least = costs[0], np.full(len(start), np.inf)
    for cost in costs[1:]:
        bound = problem.threshold(lowest)
        least = np.minimum(least, np.abs(cost - bound) / (2 * np.sqrt(bound) * (of.alpha + np.sqrt(bound))))
        lowest = np.where(cost <= bound, cost, lowest)
    return least


def magnification(of: Setup, state: Columns, volts: Array, refused: Array) -> Array:
    """Return by how much a step magnifies errors of rounding, (N,).

    It is the largest condition number of the corrections, times that by which the step magnifies a change of the
    voltages: far from a solution one correction magnifies what the one before it has.
    """
    start, weights = reference.predict(of, state, refused)
    fits, root = glsdc.descend(reference.problem(of), start, volts, weights)[0], reference.damping(of)
    condition = np.max([np.linalg.cond(glsdc.damped(fit.H, root) / root) for fit in fits], axis=0)
    return np.asarray(condition * np.maximum(amplification(of, state, volts, refused), 1))


def amplification(of: Setup, state: Columns, volts: Array, refused: Array) -> Array:
    """Return by how much a step magnifies changes of what it is given, (N,).

    The largest gradient, by differences, of phases, yaw and residual, of alpha, by voltages, of alpha, phases and yaw.
    """
    sizes = {"X": of.pitch / (2 * pi), "Y": of.pitch / (2 * pi), "yaw": 1.0, "residual": of.alpha}
    before, _ = reference.step(of, state, volts, refused)
    squares = {name: np.zeros(len(volts)) for name in sizes}
    for other, read in _changed(of, state, volts):
        after, _ = reference.step(of, other, read, refused)
        for name, size in sizes.items():
            squares[name] += ((after[name] - before[name]) / size / CHANGE) ** 2
    return np.sqrt(np.max([*squares.values()], axis=0))


def _changed(of: Setup, state: Columns, volts: Array) -> Iterator[tuple[Columns, Array]]:
    """Yield states and voltages of which one is changed at a time."""
    for channel in np.ndindex(volts.shape[1:]):
        moved = volts.copy()
        moved[(slice(None), *channel)] += CHANGE * of.alpha
        yield state, moved
    for name in reference.POSE:
        yield {**state, name: state[name] + CHANGE}, volts
