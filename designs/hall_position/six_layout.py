"""Where to put sensors for six degrees of freedom, so that the worst deviation over the pitch and over yaws is least.

    minimise over r_1 .. r_n in a square   max over poses of  max(s_X, s_Y, s_Z, lever times s of roll, pitch, yaw)

The lever says how far from the body's origin a turn counts as a displacement. Three sensors of two axes have as many
voltages as there are unknowns. Their determinant D(X, Y) = det H is continuous over the pitch, and where it takes both
signs it vanishes on curves between: rank is lost on these. `signs` shows it for a layout; the search for one with
a single sign finds none. Four sensors lose rank where three further equations hold: at isolated points of X, Y and yaw,
of which a layout may have none. Two axes each are enough: no sensor of three is called for. Of five, each four that are
left would have to be free of such points; one more than that leaves five, which are.

First differential evolution over a coarse grid of poses, then steps in drawn directions over a fine one. Places are
multiples of a thousandth of a pitch in the body's plane. Another machine's sines may lead the search elsewhere:
LAYOUTS holds what was found, as decimals.
"""

from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import differential_evolution

from designs.hall_position import figures, layout_search, six_field
from designs.hall_position.layout_search import GRID, Task
from designs.hall_position.six_parameters import FEWEST, Array
from synth.errors import ModelError
from synth.statespace import readonly

Numbers = NDArray[np.float64]
Pair = tuple[float, float]

COARSE, FINE = (20, 3), (40, 5)  # poses along a pitch and over the yaws
STEPS = (32, 16, 8, 4, 2, 1)  # of 1/GRID
LOST = 1e-9  # of the largest information, below which a deviation is not told from an infinite one

# By the number of sensors. Their cost for yaws within 5 degrees, on grids of 90 by 90 by 11: 4.9, 6.0 and 4.7 um. After
# the loss of any sensor five leave 224 um, though more than 20 um in a hundredth of the pitch only, and six 12.7 um.
LAYOUTS: dict[int, tuple[Pair, ...]] = {
    4: ((0.359, -0.581), (-0.420, -0.535), (-0.460, 0.236), (0.316, 0.196)),
    5: ((0.336, -0.636), (-0.330, -0.506), (-0.508, 0.302), (0.346, 0.186), (0.045, 0.322)),
    6: ((0.336, -0.636), (-0.330, -0.506), (-0.508, 0.302), (0.346, 0.186), (0.045, 0.322), (-0.530, -0.337)),
}


class Signs(NamedTuple):
    """The least and the largest determinant of three sensors over the pitch, in units of its mean size."""

    least: float
    largest: float


def placed(array: Array, places: tuple[Pair, ...]) -> Array:
    """Return an array with its sensors at places in the body's plane, in pitches; raise ModelError for no places."""
    found = figures.rows("places", places, 2)
    return replace(array, positions=tuple((x * array.pitch, y * array.pitch, 0.0) for x, y in found))


def poses(array: Array, yaw: float, points: tuple[int, int]) -> Numbers:
    """Return a grid (N, 6) of poses over the pitch and over yaws up to `yaw` to either side, level at the height.

    Raises ModelError for no points, or a yaw that is not finite.
    """
    yaw, points = figures.number("the yaw", yaw), layout_search.counted(points)
    along = array.pitch * np.arange(points[0]) / points[0]
    yaws = np.linspace(-yaw, yaw, points[1]) if points[1] > 1 else np.zeros(1)
    X, Y, turn = (each.ravel() for each in np.meshgrid(along, along, yaws, indexing="ij"))
    level = np.zeros_like(X)
    return readonly(np.column_stack([X, Y, level + array.height, level, level, turn]))


def sizes(lever: float) -> Numbers:
    """Return what a unit of each of POSE moves, m: 1 for places, the lever for angles; raise ModelError for none."""
    lever = figures.positive("the lever", lever)
    return np.array([1.0, 1.0, 1.0, lever, lever, lever])


def cost(array: Array, at: Numbers, lever: float, spare: bool = False) -> float:
    """Return the largest deviation over poses (N, 6), m, angles at the lever; with `spare` after any sensor's loss."""
    H = six_field.rows(array, at) / sizes(lever)
    each = [h.transpose(0, 2, 1) @ h for h in np.split(H, len(array.positions), axis=1)]
    whole = np.sum(each, axis=0)
    return max(_largest(whole - lost, array.deviation) for lost in (each if spare else [np.zeros(6)]))


def _largest(information: Numbers, deviation: float) -> float:
    kept = information + LOST * information.max() * np.eye(6)  # finite where rank is lost
    return float(deviation * np.sqrt(np.diagonal(np.linalg.inv(kept), axis1=1, axis2=2).max()))


def signs(array: Array, yaw: float = 0.0, points: int = 100) -> Signs:
    """Return between which determinants of H a pitch at one yaw in rad lies, of an array of three sensors.

    Raises ModelError for another number of sensors, whose H is not square.
    """
    if len(array.positions) != 3:
        raise ModelError(f"{len(array.positions)} sensors have no determinant: give three")
    turned = figures.number("the yaw", yaw)
    at = poses(array, 0.0, (points, 1)) + np.array([0.0, 0.0, 0.0, 0.0, 0.0, turned])
    D = np.linalg.det(six_field.rows(array, at) / sizes(array.pitch))
    mean = np.abs(D).mean()
    return Signs(float(D.min() / mean), float(D.max() / mean))


def search(array: Array, task: Task, seed: int = 0, generations: int = 60, tries: int = 40) -> tuple[Pair, ...]:
    """Return the places, in pitches, of sensors in the field of `array`; its own places are not looked at.

    `generations` of differential evolution, then `tries` steps of each length.

    Raises ModelError unless both are whole numbers of at least 0, and for a task that leaves fewer than three sensors.
    """
    generations, tries = (figures.whole(n, v, 0) for n, v in (("generations", generations), ("tries", tries)))
    coarse = _costs(array, task, COARSE)
    bounds = [(-task.reach, task.reach)] * (2 * task.sensors)
    found = differential_evolution(coarse, bounds, seed=seed, maxiter=generations, popsize=6, tol=1e-6, polish=False)
    return improved(array, task, _pairs(np.round(GRID * found.x) / GRID), seed, tries)


def improved(array: Array, task: Task, places: tuple[Pair, ...], seed: int = 0, tries: int = 40) -> tuple[Pair, ...]:
    """Return places, in pitches, that are no worse than those given, by `tries` steps of each length.

    Raises ModelError unless there is a place for each sensor of the task, of which three or more are left.
    """
    places, tries = layout_search.given(task, places), figures.whole("tries", tries, 0)
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


def _costs(array: Array, task: Task, points: tuple[int, int]) -> Callable[[Numbers], float]:
    if task.sensors - task.spare < FEWEST:
        raise ModelError(f"{task.sensors - task.spare} sensors have fewer than six voltages: leave {FEWEST} or more")
    at = poses(array, task.yaw, points)
    return lambda places: cost(placed(array, _pairs(places)), at, task.lever, task.spare)


def _pairs(places: Numbers) -> tuple[Pair, ...]:
    return tuple((float(x), float(y)) for x, y in places.reshape(-1, 2))
