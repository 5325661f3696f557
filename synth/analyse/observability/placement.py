"""Optimal sensor placement: coordinates x of sensors in a square with the least worst-case cost.

    minimise over |x_i| <= reach   cost(x),   x_i multiples of 1/grid

First differential evolution of a `coarse` cost (`scipy.optimize.differential_evolution`), then random steps on a `fine`
cost, with one step length after another. The random numbers have fixed seeds, but rounding of elementary functions on
another machine may lead a search elsewhere: write down the result as decimals, and prove it by `worst_deviation`.

Library: a search takes minutes; designs keep its result as numbers.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import ArrayLike
from scipy import optimize

from synth import arguments, kinds
from synth.errors import ModelError
from synth.statespace import Array, readonly

MAX_COUNT = 100_000  # tries, generations, population, coordinates
ROUNDING = 1e-12  # relative: a grid point this close to the side of the square is in it
STEPS = (32, 16, 8, 4, 2, 1)  # of 1/grid

Cost = Callable[[Array], float]


@arguments.checked
@dataclass(frozen=True)
class Square:
    """The allowed coordinates: |x_i| <= `half_width`, in steps of 1/`grid`.

    Raises ModelError for a reach that is not above 0, or a grid below 1.
    """

    half_width: float
    grid: int = 1000

    def __post_init__(self) -> None:
        if not 0 < self.half_width < np.inf or self.grid < 1:
            raise ModelError(f"the square reaches to {self.half_width} in steps of 1/{self.grid}: give both above 0")


@arguments.checked
@dataclass(frozen=True)
class SearchBudget:
    """The budget of a search: `generations` of a `population` per coordinate, then `tries` steps of each length.

    Raises ModelError for numbers below 0 or above MAX_COUNT, or no population.
    """

    generations: int = 200
    population: int = 8
    tries: int = 40
    seed: int = 0

    def __post_init__(self) -> None:
        numbers = (self.generations, self.population, self.tries, self.seed)
        if not (min(numbers) >= 0 and max(numbers) <= MAX_COUNT and self.population):
            raise ModelError(f"the search budget is {numbers}: give whole numbers up to {MAX_COUNT}, and a population")


@arguments.checked
def search(coarse: Cost, fine: Cost, coordinates: int, within: Square, budget: SearchBudget) -> Array:
    """Return coordinates x (coordinates,) of the least cost found within this budget.

    Raises ModelError for fewer than 1 or more than MAX_COUNT coordinates, and as `improve`.
    """
    if not 1 <= coordinates <= MAX_COUNT:
        raise ModelError(f"{coordinates} coordinates are searched for: give a number from 1 to {MAX_COUNT}")
    bounds = [(-within.half_width, within.half_width)] * coordinates
    best = optimize.differential_evolution(
        partial(_value, coarse),
        bounds,
        seed=budget.seed,
        maxiter=budget.generations,
        popsize=budget.population,
        tol=1e-6,
        polish=False,
    )
    return improve(fine, best.x, within, budget)


@arguments.checked
def improve(fine: Cost, start: ArrayLike, within: Square, budget: SearchBudget) -> Array:
    """Return coordinates with a cost at most that of the nearest grid point to `start` in the square.

    The search makes `budget.tries` steps of each length. `start` itself may cost less where it is no grid point.

    Raises ModelError for a start that is not finite or outside the square, or a cost that is not a number.
    """
    grid, x = within.grid, np.ravel(arguments.real("start", start))
    if not x.size or not np.isfinite(x).all():
        raise ModelError(f"the start is {x}: give finite coordinates, one or more")
    if np.abs(x).max() > within.half_width * (1 + ROUNDING):
        raise ModelError(
            f"the start reaches to {np.abs(x).max():g}, the square to {within.half_width:g}: give a start inside"
        )
    most = np.floor(grid * within.half_width * (1 + ROUNDING))
    best = np.clip(np.round(grid * x), -most, most)
    rng, least = np.random.default_rng(budget.seed), _value(fine, best / grid)
    for step in STEPS:
        for _ in range(budget.tries):
            direction = rng.normal(size=best.size) * (rng.random(best.size) < 0.5)
            candidate = np.clip(best + np.round(step * direction), -most, most)
            value = _value(fine, candidate / grid)
            if value < least:
                best, least = candidate, value
    return readonly(best / grid)


def _value(cost: Cost, x: Array) -> float:
    value = cost(x)
    if not kinds.is_number(value) or np.isnan(value):
        raise ModelError(f"the cost at {x.tolist()} is {value!r}: return a number")
    return float(value)
