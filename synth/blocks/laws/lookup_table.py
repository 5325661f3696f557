"""Two-dimensional lookup table with bilinear interpolation (Simulink "2-D Lookup Table").

    v(x, y) = v_00 + f (v_10 - v_00) + g (v_01 - v_00 + f (v_11 - v_01 - v_10 + v_00)),    f, g = 0 .. 1 in a cell

Beyond the grid's ends the values on its edge are used. `interpolate_samples` computes the grid's values from scattered
samples, linearly on their Delaunay triangles (SciPy `LinearNDInterpolator`).

Map of what a calibration left: a bilinear table fitted to scattered residuals by smoothed least squares.

    minimise  |A t - v|^2 + smoothing |D t|^2        A: weights of the four corners, D: second differences along x and y

v (N, m) are residuals at scattered places (N, 2), t (n_x n_y, m) the values at the points of a grid. The smoothing
fills points without samples nearby, and averages noise; a residual that varies within a cell stays. D t = 0 for the
surfaces 1, x, y and x y, which the samples themselves must determine: lines along x and y alone leave x y free. Values
are rounded to a unit far below the noise, and are then the same on every machine. The table is MATLAB's `gridfit`
(D'Errico, 2005) with second differences; in the C it is a `lookup_table`.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike
from scipy import interpolate, sparse, spatial
from scipy.sparse import linalg

from synth import arguments, numeric
from synth.block import clip
from synth.errors import ModelError
from synth.law import label
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
    label(i=i, f=f, j=j, g=g)
    corners = [i * columns + j + step for step in (0, 1, columns, columns + 1)]
    for name, table in tables.items():
        v_00, v_01, v_10, v_11 = (table(corner) for corner in corners)
        dy, dxdy = v_01 - v_00, (v_11 - v_10) - (v_01 - v_00)
        label(name, v_00=v_00, v_01=v_01, v_10=v_10, v_11=v_11, dy=dy, dxdy=dxdy)
        looked_up[name] = v_00 + f * (v_10 - v_00) + g * (dy + f * dxdy)
    return looked_up


def _cell(place: ca.SX, grid: Grid, side: int) -> tuple[ca.SX, ca.SX]:
    """Return the index of the cell that contains a coordinate, and its position inside the cell, 0 .. 1."""
    last = grid.size[side] - 1
    along = clip((place - grid.low[side]) / grid.spacing, Signal("along", "1", 0, last))
    cell = ca.floor(ca.fmin(along, last - 1))
    return cell, along - cell


DETERMINED = 1e-6  # least singular value of the surfaces at the samples, relative to the largest


@dataclass(frozen=True, eq=False)
class ResidualMap:
    """Values (n_x, n_y, m) at the points of a grid."""

    grid: Grid
    values: Array

    def at(self, places: ArrayLike) -> Array:
        """Return the interpolated values (N, m) at places (N, 2); beyond the grid those on its edge."""
        weights = _weights(self.grid, numeric.table("the places", places, 2))
        return readonly(np.asarray(weights @ self.values.reshape(-1, self.values.shape[2])))


@arguments.checked
def fit(places: ArrayLike, residuals: ArrayLike, grid: Grid, smoothing: float = 1e-2, unit: float = 0.0) -> ResidualMap:
    """Return the map of residuals (N, m) at places (N, 2), rounded to a `unit` if it is above 0.

    Raises ModelError for samples that do not match or are not finite, places beyond the grid or that do not determine
    the surfaces 1, x, y and x y, or a smoothing that is not positive.
    """
    places, residuals = numeric.table("the places", places, 2), arguments.matrix("residuals", residuals)
    residuals = numeric.table("the residuals", residuals, residuals.shape[1])
    smoothing = numeric.positive("the smoothing", smoothing)
    if len(places) != len(residuals):
        raise ModelError(f"{len(places)} places meet {len(residuals)} residuals: give one for each")
    for axis, along in zip(grid.axes, places.T, strict=True):
        if along.min() < axis[0] - 1e-9 * grid.spacing or along.max() > axis[-1] + 1e-9 * grid.spacing:
            raise ModelError(
                f"samples reach from {along.min():.4g} to {along.max():.4g}, the grid from {axis[0]:.4g} to "
                f"{axis[-1]:.4g}: widen the grid"
            )
    _check_surfaces(places, grid)
    A, D = _weights(grid, places), _second_differences(grid.size)
    values = linalg.splu((A.T @ A + smoothing * (D.T @ D)).tocsc()).solve(A.T @ residuals)
    if unit := numeric.number("the unit", unit):
        values = np.rint(values / unit) * unit
    return ResidualMap(grid, readonly(values.reshape(*grid.size, -1)))


def _check_surfaces(places: Array, grid: Grid) -> None:
    """Refuse places whose samples leave one of the surfaces 1, x, y and x y free, which no smoothing bounds."""
    x, y = (2 * (v - a[0]) / (a[-1] - a[0]) - 1 for v, a in zip(places.T, grid.axes, strict=True))
    surfaces = np.column_stack([np.ones(len(places)), x, y, x * y])
    sizes = np.linalg.svd(surfaces, compute_uv=False)
    if len(places) < 4 or sizes[-1] < DETERMINED * sizes[0]:
        raise ModelError(
            f"{len(places)} places determine {int((sizes >= DETERMINED * sizes[0]).sum())} of the surfaces 1, x, y and "
            "x y: add samples at other places; those on two lines, or on one diagonal, leave one free"
        )


def _weights(grid: Grid, places: Array) -> sparse.csr_array:
    """Return the bilinear weights (N, n_x n_y) of places (N, 2)."""
    n_x, n_y = grid.size
    along = [
        np.clip((v - low) / grid.spacing, 0, n - 1) for v, low, n in zip(places.T, grid.low, grid.size, strict=True)
    ]
    i, j = (np.minimum(np.floor(v), n - 2).astype(int) for v, n in zip(along, grid.size, strict=True))
    f, g = along[0] - i, along[1] - j
    columns = np.stack([i * n_y + j + step for step in (0, 1, n_y, n_y + 1)], axis=1)
    weights = np.stack([(1 - f) * (1 - g), (1 - f) * g, f * (1 - g), f * g], axis=1)
    rows = np.repeat(np.arange(len(places)), 4)
    return sparse.csr_array((weights.ravel(), (rows, columns.ravel())), shape=(len(places), n_x * n_y))


def _second_differences(size: tuple[int, int]) -> sparse.csr_array:
    """Return D of the points of a grid, and the first difference where a side has two points only."""

    def along(n: int) -> sparse.csr_array:
        D = np.diff(np.eye(n), n=min(2, n - 1), axis=0)
        return sparse.csr_array(D)

    (n_x, n_y), identity = size, [sparse.eye_array(n) for n in size]
    parts = sparse.kron(along(n_x), identity[1]), sparse.kron(identity[0], along(n_y))
    return sparse.csr_array(sparse.vstack(parts))
