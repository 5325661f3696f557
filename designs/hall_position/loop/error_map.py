"""What a reference tells of the estimate's errors, tabulated: the calibration of Figs. 10 and 11.

    x_k, y_k, yaw_k estimated,  X_k, Y_k, Yaw_k by the laser,  k = 1 .. N     scattered over the travel
    D(x, y) = (X - x, Y - y, Yaw - yaw)                                       linear on the triangles between samples
    table_ij = D(low + i h, low + j h),   corrected = estimate + (bilinear between the nearest four of the table)

Beyond the table's ends the values on its edge count. The estimate is absolute and repeatable, so that what is mapped
once holds. It holds at the yaw at which it was mapped: a map of X and Y alone would leave the yaw to be wrong by as
much as before, and with it the places of the sensors. So the yaw is mapped, too.

Values are rounded to UNIT, a hundredth of the noise: the C then holds short numbers, alike on every machine.

Source: Kawato, Kim, "Multi-Degree-of-Freedom Precision Position Sensing", section 4, Figs. 10 and 11.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np
from numpy.typing import NDArray
from scipy import interpolate, spatial

from designs.hall_position.glsdc.parameters import Pair
from synth import numeric
from synth.block import Block, Exprs, Step, build, clip, table
from synth.errors import ModelError
from synth.signals import Signal
from synth.statespace import Array, readonly
from synth.timing import Discrete

COORDINATES = ("X", "Y", "yaw")
UNIT = {"X": 1e-8, "Y": 1e-8, "yaw": 1e-6}  # m, m, rad
MOST = 2**20  # points: whole numbers of single precision tell as many apart, and a controller holds no more
EDGE = 1e-9  # of a cell: so far outside of a triangle a point is still on its edge
FAR = 10.0  # m, rad: of what comes in and goes out


@dataclass(frozen=True)
class Grid:
    """Points low + (i, j) h, i < n_x, j < n_y, in m, with numbers `size` = (n_x, n_y).

    Raises ModelError for a spacing that is not positive, or fewer than two points along a side, or more than MOST.
    """

    low: Pair
    spacing: float
    size: tuple[int, int]

    def __post_init__(self) -> None:
        object.__setattr__(self, "low", numeric.rows("the grid's first points", [self.low], 2)[0])
        object.__setattr__(self, "size", numeric.rows("the grid's numbers of points", [self.size], 2)[0])
        if not numeric.number("the grid's spacing", self.spacing) > 0:
            raise ModelError(f"the grid's spacing is {self.spacing} m: give a step above 0")
        if min(self.size) < 2 or any(n != int(n) for n in self.size):
            raise ModelError(f"the grid has {self.size} points: two along each side make a cell, give whole numbers")
        object.__setattr__(self, "size", tuple(map(int, self.size)))
        if self.size[0] * self.size[1] > MOST:
            raise ModelError(f"the grid has {self.size} points: give a wider spacing, {MOST} points are the most")

    @property
    def axes(self) -> tuple[Array, Array]:
        """Return the points (n_x,) and (n_y,) along X and Y, m."""
        along = [low + self.spacing * np.arange(n) for low, n in zip(self.low, self.size, strict=True)]
        return readonly(along[0]), readonly(along[1])


def square(reach: float, spacing: float) -> Grid:
    """Return a grid of at least `reach` m to either side of the origin.

    Raises ModelError for figures that are no positive numbers, and as `Grid`.
    """
    reach, spacing = numeric.positive("the reach", reach), numeric.positive("the grid's spacing", spacing)
    n = int(np.ceil(reach / spacing - 1e-9))
    return Grid((-n * spacing, -n * spacing), spacing, (2 * n + 1, 2 * n + 1))


@dataclass(frozen=True, eq=False)
class Samples:
    """Estimates and references (N, 3) of X, Y in m and the yaw in rad."""

    estimated: Array
    reference: Array


@dataclass(frozen=True, eq=False)
class ErrorMap:
    """What is added to the estimate at the points of a grid, `added` (3, n_x, n_y), m, m and rad.

    Raises ModelError for values of another shape, or that are not finite.
    """

    grid: Grid
    added: Array

    def __post_init__(self) -> None:
        shape = (len(COORDINATES), *self.grid.size)
        if np.shape(self.added) != shape or not np.isfinite(self.added).all():
            raise ModelError(f"the map has values {np.shape(self.added)}: give finite ones for its points, {shape}")

    def correct(self, estimated: Array) -> Array:
        """Return corrected estimates (N, 3), as the Block does; raise ModelError unless they are finite."""
        estimated = numeric.table("the estimates", estimated, len(COORDINATES))
        points = [np.clip(estimated[:, k], axis[0], axis[-1]) for k, axis in enumerate(self.grid.axes)]
        between = interpolate.RegularGridInterpolator(self.grid.axes, np.moveaxis(self.added, 0, -1))
        return readonly(estimated + between(np.column_stack(points)))


@dataclass(frozen=True)
class Errors:
    """Of X, Y in m and the yaw in rad: root mean squares and largest values."""

    rms: tuple[float, float, float]
    peak: tuple[float, float, float]


def errors(samples: Samples) -> Errors:
    """Return how far estimates are from references; raise ModelError unless there are some, and finite."""
    estimated, reference = _pairs(samples)
    off = np.abs(estimated - reference)
    rms, peak = np.sqrt((off**2).mean(axis=0)), off.max(axis=0)
    return Errors(tuple(rms.tolist()), tuple(peak.tolist()))


def fit(samples: Samples, grid: Grid) -> ErrorMap:
    """Return the map of samples on a grid.

    Raises ModelError for samples that are not finite or all on one line, or a grid that reaches beyond them.
    """
    estimated, reference = _pairs(samples)
    found = _between(estimated[:, :2], reference - estimated, grid)
    if not np.isfinite(found).all():
        i, j = np.argwhere(~np.isfinite(found).all(axis=2))[0]
        X, Y = (1e3 * axis[k] for axis, k in zip(grid.axes, (i, j), strict=True))
        raise ModelError(
            f"no samples lie about X = {X:.4g} mm, Y = {Y:.4g} mm: narrow the grid, or measure beyond its ends"
        )
    units = np.array([UNIT[name] for name in COORDINATES])
    return ErrorMap(grid, readonly(np.moveaxis(np.rint(found / units) * units, -1, 0)))


def _pairs(samples: Samples) -> tuple[Array, Array]:
    """Return estimates and references (N, 3) that are finite, of one number."""
    estimated = numeric.table("the samples' estimates", samples.estimated, len(COORDINATES))
    reference = numeric.table("the samples' references", samples.reference, len(COORDINATES))
    if len(estimated) != len(reference):
        raise ModelError(f"{len(estimated)} estimates meet {len(reference)} references: give one for each")
    return estimated, reference


def _between(at: Array, values: Array, grid: Grid) -> Array:
    """Return values (n_x, n_y, m) on a grid, linear on the triangles of the places `at` (N, 2), NaN outside of all.

    Each triangle looks at the points of the grid in its box.
    """
    try:
        triangles = spatial.Delaunay(at).simplices
    except spatial.QhullError as error:
        raise ModelError(
            f"{len(at)} samples make no triangle: measure at three places or more, not on a line"
        ) from error
    corners = ((at - grid.low) / grid.spacing)[triangles]  # (T, 3, 2), in cells
    first = np.maximum(np.ceil(corners.min(axis=1) - EDGE), 0).astype(int)
    last = np.minimum(np.floor(corners.max(axis=1) + EDGE), np.array(grid.size) - 1).astype(int)
    sides = np.maximum(last - first + 1, 0)
    counts = sides.prod(axis=1)
    which = np.repeat(np.arange(len(counts)), counts)
    number = np.arange(len(which)) - np.repeat(np.cumsum(counts) - counts, counts)
    points = first[which] + np.column_stack(np.divmod(number, np.maximum(sides[which, 1], 1)))
    weights = _weights(corners[which], points)
    inside = (weights >= -EDGE).all(axis=1)
    found = np.full((*grid.size, values.shape[1]), np.nan)
    of = triangles[which[inside]]
    found[tuple(points[inside].T)] = (weights[inside, :, None] * values[of]).sum(axis=1)
    return found


def _weights(corners: Array, points: NDArray[np.int_]) -> Array:
    """Return of triangles (K, 3, 2) the weights (K, 3) that make each one's point (K, 2); NaN where it has no area."""
    a, b, c = corners.transpose(1, 2, 0)
    p = points.T

    def turned(u: Array, v: Array) -> Array:
        return np.asarray(u[0] * v[1] - u[1] * v[0])

    with np.errstate(invalid="ignore", divide="ignore"):
        area = turned(b - a, c - a)
        second, third = turned(p - a, c - a) / area, turned(b - a, p - a) / area
    return np.column_stack([1 - second - third, second, third])


def block(of: ErrorMap, time: Discrete) -> Block:
    """Return the Block ``error_map`` from X, Y and yaw to X_corrected, Y_corrected and yaw_corrected."""
    looked_up = {name: table(f"map_{name}", added.ravel()) for name, added in zip(COORDINATES, of.added, strict=True)}

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        (i, fx), (j, fy) = (_cell(u[name], of.grid, side) for side, name in enumerate("XY"))
        columns = of.grid.size[1]
        at = [i * columns + j + step for step in (0, 1, columns, columns + 1)]
        output = {}
        for name, f in looked_up.items():
            here, above, right, across = (f(index) for index in at)
            rise, turn = above - here, (across - right) - (above - here)
            output[f"{name}_corrected"] = u[name] + (here + fx * (right - here) + fy * (rise + fx * turn))
        return Step(output)

    return build("error_map", time, law, inputs=_signals(""), outputs=_signals("_corrected"), tag="Figs. 10, 11")


def _cell(place: ca.SX, grid: Grid, side: int) -> tuple[ca.SX, ca.SX]:
    """Return the number of the cell at a place, and how far in it the place lies, 0 .. 1."""
    last = grid.size[side] - 1
    along = clip((place - grid.low[side]) / grid.spacing, Signal("along", "1", 0, last))
    cell = ca.floor(ca.fmin(along, last - 1))
    return cell, along - cell


def _signals(suffix: str) -> Sequence[Signal]:
    units = dict(zip(COORDINATES, ("m", "m", "rad"), strict=True))
    return [Signal(f"{name}{suffix}", unit, -FAR, FAR) for name, unit in units.items()]
