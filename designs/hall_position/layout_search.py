"""Where to put sensors so that the worst deviation over the pitch and a range of yaws is least.

    minimise over r_1 .. r_n in a square   max over (X, Y) in the pitch, |yaw| <= range of  max(s_X, s_Y, lever s_yaw)

The lever says how far from the body's origin a yaw counts as a displacement. First differential evolution over a coarse
grid of poses, then steps in drawn directions over a fine one; `fisher.worst` proves what the result is worth, between
the points of the grid too. Places are multiples of a thousandth of a pitch. Draws are seeded, yet another machine's
sines may lead the search elsewhere: LAYOUTS holds what was found, as decimals.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from math import radians

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import differential_evolution

from designs.hall_position import figures, fisher, parameters
from synth.errors import ModelError

Array = NDArray[np.float64]
Pair = tuple[float, float]

GRID = 1000  # places to a pitch
COARSE, FINE = (20, 5), (64, 11)  # poses along a pitch and over the yaws
STEPS = (32, 16, 8, 4, 2, 1)  # of 1/GRID

PUBLISHED: tuple[Pair, ...] = ((-0.375, -0.375), (0.375, 0.375), (0.640, 0.613))  # pitches; the third was added to (3)
LAYOUTS: dict[int, tuple[Pair, ...]] = {  # by the yaws in degrees to either side; at worst, by proof, in um and urad:
    5: ((-0.132, 0.173), (0.106, -0.066), (0.385, -0.344)),  # 4.87, 5.14, 217, where PUBLISHED has 7.7, 7.0, 238
    15: ((0.269, -0.214), (-0.230, 0.285), (0.019, 0.035)),  # 4.83, 4.68, 258, where PUBLISHED has 199, 29, 4379
}

# Within 5 degrees, by proof, at worst 3.89, 4.21 um and 178 urad, and 10.83, 10.05, 366 after the loss of any one.
SPARE: tuple[Pair, ...] = ((0.281, -0.091), (-0.012, -0.404), (0.440, 0.215), (-0.244, 0.292))


@dataclass(frozen=True)
class Task:
    """How many sensors, yaws up to `yaw` in rad to either side, places up to `reach` pitches, a lever in m.

    With one to `spare` what counts is the worst after the loss of any sensor.

    Raises ModelError for less than two sensors that are left, or a figure that is no number or not positive.
    """

    sensors: int = 3
    yaw: float = radians(5)
    reach: float = 0.64  # as far as the published layout
    lever: float = 25.4e-3  # half a pitch
    spare: bool = False

    def __post_init__(self) -> None:
        figures.whole("the number of sensors", self.sensors, 1, figures.MOST_SENSORS)
        if not isinstance(self.spare, bool):
            raise ModelError(f"spare is {self.spare!r}: give True for one to spare, or False")
        if self.sensors - self.spare < 2:
            raise ModelError(f"{self.sensors - self.spare} sensors do not tell the yaw: leave two or more")
        for name in ("yaw", "reach", "lever"):
            figures.positive(name, getattr(self, name))


def placed(array: parameters.Array, places: tuple[Pair, ...]) -> parameters.Array:
    """Return an array with its sensors at places given in pitches; raise ModelError for what are none."""
    found = tuple((x * array.pitch, y * array.pitch) for x, y in figures.rows("places", places, 2))
    return replace(array, positions=found, weights=())


def cost(deviations: Array, lever: float) -> float:
    """Return the largest of s_X, s_Y and lever s_yaw in m, of deviations (3, N); raise ModelError for what are none."""
    if np.ndim(deviations) != 2 or len(deviations) != 3 or not deviations.size or np.isnan(deviations).any():
        raise ModelError(f"the deviations have the shape {np.shape(deviations)}: give numbers (3, N), a column or more")
    return float(max(deviations[0].max(), deviations[1].max(), lever * deviations[2].max()))


def remaining(task: Task, places: tuple[Pair, ...]) -> tuple[tuple[Pair, ...], ...]:
    """Return the places that may be left: all, or with one to spare all but each in turn."""
    if not task.spare:
        return (places,)
    return tuple((*places[:k], *places[k + 1 :]) for k in range(len(places)))


def poses(array: parameters.Array, yaw: float, points: tuple[int, int]) -> Array:
    """Return a grid (3, N) of poses over the pitch and over yaws up to `yaw` to either side, in m and rad.

    Raises ModelError for no points, or a yaw that is not finite.
    """
    yaw, points = figures.number("the yaw", yaw), counted(points)
    along = array.pitch * np.arange(points[0]) / points[0]
    grid = np.meshgrid(along, along, np.linspace(-yaw, yaw, points[1]), indexing="ij")
    return np.array([each.ravel() for each in grid])


def counted(points: tuple[int, int]) -> tuple[int, int]:
    """Return how many poses there are along the pitch and over the yaws; raise ModelError for none."""
    along, yaws = points
    return figures.whole("the number of poses along the pitch", along), figures.whole("the number of yaws", yaws)


def search(
    array: parameters.Array, task: Task, seed: int = 0, generations: int = 200, tries: int = 40
) -> tuple[Pair, ...]:
    """Return the places, in pitches, of sensors in the field of `array`; its own places are not looked at.

    `generations` of differential evolution, then `tries` steps of each length.

    Raises ModelError unless both are whole numbers of at least 0.
    """
    generations, tries = (figures.whole(n, v, 0) for n, v in (("generations", generations), ("tries", tries)))
    coarse = _costs(array, task, COARSE)
    bounds = [(-task.reach, task.reach)] * (2 * task.sensors)
    found = differential_evolution(coarse, bounds, seed=seed, maxiter=generations, popsize=8, tol=1e-6, polish=False)
    return improved(array, task, _pairs(np.round(GRID * found.x) / GRID), seed, tries)


def improved(
    array: parameters.Array, task: Task, places: tuple[Pair, ...], seed: int = 0, tries: int = 40
) -> tuple[Pair, ...]:
    """Return places, in pitches, that are no worse than those given, by `tries` steps of each length.

    Raises ModelError unless there is a place for each sensor of the task.
    """
    places, tries = given(task, places), figures.whole("tries", tries, 0)
    fine, rng = _costs(array, task, FINE), np.random.default_rng(seed)
    best, most = np.round(GRID * np.ravel(places)), round(GRID * task.reach)
    least = fine(best / GRID)
    for step in STEPS:
        for _ in range(tries):
            drawn = rng.normal(size=best.size) * (rng.random(best.size) < 0.5)
            other = np.clip(best + np.round(step * drawn), -most, most)
            value = fine(other / GRID)
            if value < least:
                best, least = other, value
    return _pairs(best / GRID)


def given(task: Task, places: tuple[Pair, ...]) -> tuple[Pair, ...]:
    """Return places; raise ModelError unless there is one for each sensor of the task."""
    found = tuple((x, y) for x, y in figures.rows("places", places, 2))
    if len(found) != task.sensors:
        raise ModelError(f"{len(found)} places are given for {task.sensors} sensors: give one for each")
    return found


def _costs(array: parameters.Array, task: Task, points: tuple[int, int]) -> Callable[[Array], float]:
    at = poses(array, task.yaw, points)

    def of(places: Array) -> float:
        return max(
            cost(fisher.deviations(placed(array, left), at), task.lever) for left in remaining(task, _pairs(places))
        )

    return of


def _pairs(places: Array) -> tuple[Pair, ...]:
    return tuple((float(x), float(y)) for x, y in places.reshape(-1, 2))
