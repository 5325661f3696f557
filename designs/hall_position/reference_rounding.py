"""Sensitivity of a step of the reference to rounding: condition numbers, gradients by differences, decision margins."""

from collections.abc import Iterator
from math import pi

import numpy as np

from designs.hall_position import reference
from designs.hall_position import reference_glsdc as glsdc
from designs.hall_position.reference_glsdc import Array, Columns, Setup

CHANGE = 1e-9  # of the differences: of voltages, relative to alpha, and of phases, rad


def margin(setup: Setup, state: Columns, volts: Array) -> Array:
    """Return the least distance of a cost from the bound below which it counts as lower, (N,).

    It is the error of the voltages relative to alpha, and of the residuals, that would move the cost across the bound.
    """
    problem, start = reference.problem(setup), reference.predict(setup, state)
    costs = [fit.cost for fit in glsdc.descend(problem, start, volts)[0]]
    lowest, least = costs[0], np.full(len(start), np.inf)
    for cost in costs[1:]:
        bound = problem.threshold(lowest)
        least = np.minimum(least, np.abs(cost - bound) / (2 * np.sqrt(bound) * (setup.alpha + np.sqrt(bound))))
        lowest = np.where(cost <= bound, cost, lowest)
    return least


def magnification(setup: Setup, state: Columns, volts: Array, refused: Array) -> Array:
    """Return the factor by which a step magnifies rounding errors, (N,).

    It is the largest condition number of the corrections times the step's `amplification`: far from a solution, a
    correction magnifies the error of the one before it.
    """
    start = reference.predict(setup, state)
    fits, root = glsdc.descend(reference.problem(setup), start, volts)[0], reference.damping(setup)
    condition = np.max([np.linalg.cond(glsdc.augment(fit.H, root) / root) for fit in fits], axis=0)
    return np.asarray(condition * np.maximum(amplification(setup, state, volts, refused), 1))


def amplification(setup: Setup, state: Columns, volts: Array, refused: Array) -> Array:
    """Return the factor by which a step magnifies changes of its inputs and states, (N,).

    It is the largest gradient, by differences, of phases, yaw and residual / alpha by voltages / alpha, phases and yaw.
    """
    sizes = {"X": setup.pitch / (2 * pi), "Y": setup.pitch / (2 * pi), "yaw": 1.0, "residual": setup.alpha}
    before, _ = reference.step(setup, state, volts, refused)
    squares = {name: np.zeros(len(volts)) for name in sizes}
    for other, perturbed in _perturbations(setup, state, volts):
        after, _ = reference.step(setup, other, perturbed, refused)
        for name, size in sizes.items():
            squares[name] += ((after[name] - before[name]) / size / CHANGE) ** 2
    return np.sqrt(np.max([*squares.values()], axis=0))


def _perturbations(setup: Setup, state: Columns, volts: Array) -> Iterator[tuple[Columns, Array]]:
    """Yield states and voltages, each time with one of them perturbed."""
    for channel in np.ndindex(volts.shape[1:]):
        perturbed = volts.copy()
        perturbed[(slice(None), *channel)] += CHANGE * setup.alpha
        yield state, perturbed
    for name in reference.POSE:
        yield {**state, name: state[name] + CHANGE}, volts
