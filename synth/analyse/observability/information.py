"""Fisher information and Cramér-Rao bound of a measurement y = h(q) + e of n unknowns, e white of deviation sigma.

With the Jacobian H = dh/dq (m, n) at a place,

    cov q >= sigma^2 (H'H)^-1 = sigma^2 V S^-2 V',    H diag(1/size) = U S V',

where size_j weights unknown j: for example a lever arm in m for an angle, to compare it with displacements in m. The
condition number is S_1 / S_n. Rank is lost where S_n is below the rounding of S_1, as in `numpy.linalg.matrix_rank`.

Source: Kay, "Fundamentals of Statistical Signal Processing: Estimation Theory", section 3.7.
"""

from dataclasses import dataclass

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike

from synth import arguments
from synth.base import column_maps
from synth.errors import ModelError
from synth.statespace import Array, readonly


@dataclass(frozen=True, eq=False)
class Accuracy:
    """At N places: least standard deviations (N, n), inf where rank is lost, and condition numbers (N,)."""

    deviations: Array
    condition: Array


@arguments.checked
def jacobians(h: ca.Function, q: ArrayLike) -> Array:
    """Return dh/dq (N, m, n) at places q (N, n) of a measurement h: (n,) -> (m,) without further arguments.

    Raises ModelError unless h takes one column and returns one, the places are finite, (N, n), and h has a derivative
    at each of them.
    """
    if h.n_in() != 1 or h.n_out() != 1 or h.size2_in(0) != 1 or h.size2_out(0) != 1:
        raise ModelError(f"'{h.name()}' has {h.n_in()} inputs and {h.n_out()} outputs: give one column each")
    n, m = h.size1_in(0), h.size1_out(0)
    places = arguments.real("places", q)
    if places.ndim != 2 or places.shape[1] != n or not len(places) or not np.isfinite(places).all():
        raise ModelError(f"the places have the shape {places.shape}: give finite numbers, (N, {n}), at least one row")
    x = ca.SX.sym("q", n)
    (slopes,) = column_maps.map_columns(ca.Function("slopes", [x], [ca.jacobian(h(x), x)]), places.T)
    by_place = slopes.reshape(m, len(places), n).transpose(1, 0, 2)
    if (bad := ~np.isfinite(by_place).all(axis=(1, 2))).any():
        raise ModelError(f"'{h.name()}' has no finite derivative at {places[int(bad.argmax())]}: leave this place out")
    return readonly(by_place)


@arguments.checked
def accuracy(H: ArrayLike, sigma: float, sizes: ArrayLike) -> Accuracy:
    """Return the Cramér-Rao bounds of n unknowns, for Jacobians H (N, m, n), noise sigma and `sizes` (n,).

    Deviations are in the units of the unknowns. Raises ModelError for Jacobians or sizes of the wrong shape or not
    finite, sizes that are not positive, and a sigma that is not above 0.
    """
    _check_sigma(sigma)
    rows, size = _scale_columns(H, sizes)
    S = np.linalg.svd(rows, compute_uv=False)
    n = rows.shape[2]
    lost = (S[:, -1] <= S[:, 0] * np.finfo(np.float64).eps * rows.shape[1]) | (rows.shape[1] < n)
    condition = np.where(lost, np.inf, S[:, 0] / np.where(lost, 1.0, S[:, -1]))
    equal, norms = _equilibrate(rows)
    S, V = np.linalg.svd(equal, full_matrices=False)[1:]
    squares = ((V / np.where(lost[:, None], 1.0, S)[:, :, None]) ** 2).sum(axis=1)
    deviations = np.where(lost[:, None], np.inf, sigma * np.sqrt(squares) / norms / size)
    return Accuracy(readonly(deviations), readonly(condition))


@arguments.checked
def bias(H: ArrayLike, extra: ArrayLike, sizes: ArrayLike) -> Array:
    """Return the bias (N, n) of least squares if the measurements have an unmodelled part `extra` (N, m).

    To first order, (H'H)^-1 H' extra. Raises ModelError for arguments that do not fit each other, and at the first
    place where rank is lost.
    """
    rows, size = _scale_columns(H, sizes)
    unmodelled = arguments.real("measurements", extra)
    if unmodelled.shape != rows.shape[:2] or not np.isfinite(unmodelled).all():
        raise ModelError(f"the measurements have the shape {unmodelled.shape}: give finite ones, {rows.shape[:2]}")
    lost = np.flatnonzero(~np.isfinite(accuracy(H, 1.0, sizes).condition))
    if lost.size:
        raise ModelError(f"rank is lost at {lost.size} of the places, the first is number {lost[0]}: leave it out")
    # Not by H'H, whose condition is the square of that of H.
    equal, norms = _equilibrate(rows)
    U, S, V = np.linalg.svd(equal, full_matrices=False)
    parts = (U.transpose(0, 2, 1) @ unmodelled[:, :, None])[:, :, 0] / S
    return readonly((V.transpose(0, 2, 1) @ parts[:, :, None])[:, :, 0] / norms / size)


@arguments.checked
def largest_deviation(H: ArrayLike, sigma: float, sizes: ArrayLike, lost: int = 0) -> float:
    """Return the largest deviation over N places, times its size; with `lost`, after the loss of that many rows.

    Rows are lost in consecutive groups, for example the two axes of one sensor; the worst group counts. The information
    is at least REGULARISATION of the largest of its place, which keeps the value finite for a search even where rank is
    lost: it is at most some 3e4 sigma over the root of that information, and up to condition / 3e4 times too small
    above.

    Raises ModelError for invalid Jacobians or sizes, and unless the rows make whole groups.
    """
    _check_sigma(sigma)
    rows, _ = _scale_columns(H, sizes)
    m, n = rows.shape[1:]
    if lost < 0 or (lost and m % lost):
        raise ModelError(f"{m} rows do not make groups of {lost}: give the number of rows of a sensor, or 0")
    parts = [h.transpose(0, 2, 1) @ h for h in np.split(rows, m // lost if lost else 1, axis=1)]
    total = np.sum(parts, axis=0)
    return max(_largest_finite_deviation(total - removed, sigma) for removed in (parts if lost else [np.zeros((n, n))]))


REGULARISATION = 1e-9  # of the largest information of a place, added to the diagonal to keep deviations finite


def _largest_finite_deviation(information: Array, sigma: float) -> float:
    n = information.shape[1]
    largest = information.max(axis=(1, 2), keepdims=True)
    regularised = information + np.maximum(REGULARISATION * largest, np.finfo(np.float64).tiny) * np.eye(n)
    return float(sigma * np.sqrt(np.diagonal(np.linalg.inv(regularised), axis1=1, axis2=2).max()))


def _equilibrate(rows: Array) -> tuple[Array, Array]:
    """Return Jacobians (N, m, n) with columns of norm 1 and the norms (N, n): small columns keep their digits."""
    norms = np.linalg.norm(rows, axis=1)
    norms = np.where(norms > 0, norms, 1.0)
    return rows / norms[:, None, :], norms


def _scale_columns(H: ArrayLike, sizes: ArrayLike) -> tuple[Array, Array]:
    """Return H (N, m, n) over sizes, and the sizes (n,); raise ModelError unless all are finite and sizes above 0."""
    rows, size = arguments.real("Jacobians", H), arguments.real("sizes", sizes)
    if rows.ndim != 3 or not rows.size or not np.isfinite(rows).all():
        raise ModelError(f"the Jacobians have the shape {rows.shape}: give finite numbers (N, m, n), one or more")
    if size.shape != rows.shape[2:] or not ((arguments.SIZES[0] < size) & (size < arguments.SIZES[1])).all():
        raise ModelError(f"the sizes are {size.tolist()}: give one above 0 for each of {rows.shape[2]} unknowns")
    arguments.check_sizes("the Jacobian", np.abs(rows / size).max(keepdims=True).reshape(1, 1), ["H"])
    return rows / size, size


def _check_sigma(sigma: float) -> None:
    if not 0 < sigma < np.inf:
        raise ModelError(f"the deviation of the measurements is {sigma}: give a finite one above 0")
