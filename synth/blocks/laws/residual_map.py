"""Map of what a calibration left: a bilinear table fitted to scattered residuals by smoothed least squares.

    minimise  |A t - v|^2 + smoothing |D t|^2        A: weights of the four corners, D: second differences along x and y

v (N, m) are residuals at scattered places (N, 2), t (n_x n_y, m) the values at the points of a grid. The smoothing
fills points without samples nearby, and averages noise; a residual that varies within a cell stays. D t = 0 for the
surfaces 1, x, y and x y, which the samples themselves must determine: lines along x and y alone leave x y free. Values
are rounded to a unit far below the noise, and are then the same on every machine. The table is MATLAB's `gridfit`
(D'Errico, 2005) with second differences; in the C it is a `lookup_table`.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy import sparse
from scipy.sparse import linalg

from synth import arguments, numeric
from synth.blocks.laws.lookup_table import Grid
from synth.errors import ModelError
from synth.statespace import Array, readonly

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
