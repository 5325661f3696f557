"""Two-dimensional lookup table with bilinear interpolation (Simulink "2-D Lookup Table").

    v(x, y) = v_00 + f (v_10 - v_00) + g (v_01 - v_00 + f (v_11 - v_01 - v_10 + v_00)),    f, g = 0 .. 1 in a cell

Beyond the grid's ends the values on its edge are used. `interpolate_samples` computes the grid's values from scattered
samples, linearly on their Delaunay triangles (SciPy `LinearNDInterpolator`).
"""

from collections.abc import Mapping
from dataclasses import dataclass

import casadi as ca
import numpy as np
from scipy import interpolate, spatial

from synth import arguments, numeric
from synth.block import clip
from synth.errors import ModelError
from synth.signals import Signal
from synth.statespace import Array, readonly

MAX_POINTS = 2**20  # single precision represents every index exactly, and a controller has no memory for more


@dataclass(frozen=True)
class Grid:
    """Points low + (i, j) spacing, i < n_x, j < n_y, in the unit of x and y; `size` = (n_x, n_y).

    Raises ModelError for ends that are not two finite numbers, a spacing that is not positive, sides that are not two,
    fewer than two points along one, or more than MAX_POINTS.
    """

    low: tuple[float, float]
    spacing: float
    size: tuple[int, int]

    def __post_init__(self) -> None:
        numeric.positive("the grid's spacing", self.spacing)
        if len(numeric.numbers("the low ends of the grid", self.low)) != 2 or len(self.size) != 2:
            raise ModelError(f"the grid has the low ends {self.low} and the size {self.size}: give two of each")
        for n in self.size:
            numeric.whole("the number of points along a side of the grid", n, 2)
        if self.size[0] * self.size[1] > MAX_POINTS:
            raise ModelError(f"the grid has {self.size} points: give a wider spacing, {MAX_POINTS} points are the most")

    @property
    def axes(self) -> tuple[Array, Array]:
        """Return the points (n_x,) and (n_y,) along x and y."""
        along = [low + self.spacing * np.arange(n) for low, n in zip(self.low, self.size, strict=True)]
        return readonly(along[0]), readonly(along[1])


@arguments.checked
def square(half_width: float, spacing: float) -> Grid:
    """Return a square grid that extends at least `half_width`, but for 1e-9 of a spacing, to each side of the origin.

    Raises ModelError for arguments that are not positive numbers, and as `Grid`.
    """
    half_width = numeric.positive("the half width", half_width)
    spacing = numeric.positive("the grid's spacing", spacing)
    n = int(np.ceil(half_width / spacing - 1e-9))
    return Grid((-n * spacing, -n * spacing), spacing, (2 * n + 1, 2 * n + 1))


def interpolate_samples(at: Array, values: Array, grid: Grid) -> Array:
    """Return values (n_x, n_y, m) on a grid from samples (N, m) at scattered positions (N, 2).

    Raises SignalError unless both are matrices of real numbers; ModelError for shapes that do not fit each other or
    values that are not finite, samples that form no triangle, or a grid that extends beyond them.
    """
    at, values = arguments.matrix("the positions of the samples", at), arguments.matrix("the samples", values)
    if (
        at.shape[1] != 2
        or len(values) != len(at)
        or not len(at)
        or not (np.isfinite(at).all() and np.isfinite(values).all())
    ):
        raise ModelError(
            f"the samples are {values.shape} at positions {at.shape}: give finite numbers (N, m) at places (N, 2)"
        )
    try:
        between = interpolate.LinearNDInterpolator(at, values)
    except spatial.QhullError as error:
        raise ModelError(
            f"{len(at)} samples make no triangle: measure at three places or more, not on a line"
        ) from error
    table = between(*np.meshgrid(*grid.axes, indexing="ij"))
    missing = np.argwhere(~np.isfinite(table).all(axis=2))
    if len(missing):
        x, y = (axis[k] for axis, k in zip(grid.axes, missing[0], strict=True))
        raise ModelError(f"no samples lie about ({x:.4g}, {y:.4g}): narrow the grid, or measure beyond its ends")
    return readonly(table)


def bilinear(tables: Mapping[str, ca.Function], grid: Grid, x: ca.SX, y: ca.SX) -> dict[str, ca.SX]:
    """Return the interpolated values of `block.table`s (n_x n_y values, y changing fastest) at a position, by name."""
    (i, f), (j, g) = (_cell(place, grid, side) for side, place in enumerate((x, y)))
    columns, looked_up = grid.size[1], {}
    corners = [i * columns + j + step for step in (0, 1, columns, columns + 1)]
    for name, table in tables.items():
        v_00, v_01, v_10, v_11 = (table(corner) for corner in corners)
        dy, dxdy = v_01 - v_00, (v_11 - v_10) - (v_01 - v_00)
        looked_up[name] = v_00 + f * (v_10 - v_00) + g * (dy + f * dxdy)
    return looked_up


def _cell(place: ca.SX, grid: Grid, side: int) -> tuple[ca.SX, ca.SX]:
    """Return the index of the cell that contains a coordinate, and its position inside the cell, 0 .. 1."""
    last = grid.size[side] - 1
    along = clip((place - grid.low[side]) / grid.spacing, Signal("along", "1", 0, last))
    cell = ca.floor(ca.fmin(along, last - 1))
    return cell, along - cell
