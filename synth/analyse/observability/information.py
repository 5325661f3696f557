"""Fisher information and Cramér-Rao bound of a measurement y = h(q) + e of n unknowns, e white of deviation sigma.

With the Jacobian H = dh/dq (m, n) at a place,

    cov q >= sigma^2 (H'H)^-1 = sigma^2 V S^-2 V',    H diag(1/size) = U S V',

where size_j weights unknown j: for example a lever arm in m for an angle, to compare it with displacements in m. The
condition number is S_1 / S_n. Rank is lost where S_n is below the rounding of S_1, as in `numpy.linalg.matrix_rank`.

Source: Kay, "Fundamentals of Statistical Signal Processing: Estimation Theory", section 3.7.

Largest Cramér-Rao deviations over a box of places by branch and bound: an attained value and a proved bound.

Deviations s_i at q bound those in a cell about it. Let the columns H_j of the Jacobian change by at most d_j in length.
Then |H v + E v| >= |H v| - sum_j d_j |v_j| >= |H v| (1 - sum_j d_j s_j). As 1/s_i is the least |H v| with v_i = 1,

    s_i in the cell  <=  s_i(q) / (1 - sum_j d_j s_j(q)).

Cells whose bound exceeds the largest attained deviation are halved along each side until none remains.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import product
from math import ceil, prod

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


CHUNK_CELLS = 200_000  # cells, for memory
ROUNDING = 1e-9  # relative, added to bounds: far above the rounding error of a finite bound

Deviations = Callable[[Array], Array]
"""q (n, N) to deviations (n, N) for a measurement of deviation 1; inf where rank is lost."""
Changes = Callable[[Array, Array], Array]
"""q (n, N) and half sides (n, 1) to bounds (n, N) of the change of each column of the Jacobian in the cells."""


@dataclass(frozen=True, eq=False)
class LargestDeviation:
    """The largest deviations over the box: `attained` (n,) at `at` (n, n), row i for deviation i, and `bound` (n,).

    `cells` is the number of evaluated cells.
    """

    attained: Array
    bound: Array
    at: Array
    cells: int


@arguments.checked
def search(
    deviations: Deviations,
    changes: Changes,
    low: Sequence[float],
    high: Sequence[float],
    cells: Sequence[int],
    tolerance: float = 1e-3,
    max_cells: int = 30_000_000,
) -> LargestDeviation:
    """Return the largest deviations for q from `low` to `high` (n,), within a relative `tolerance` of their bound.

    `cells` (n,) are the initial numbers of cells along each side.

    Raises ModelError for invalid sides, a tolerance that is not positive, and if `max_cells` cells do not suffice, for
    example because rank is lost.
    """
    if not 0 < tolerance < np.inf:
        raise ModelError(f"the tolerance is {tolerance}: give a finite number above 0, relative to the bound")
    if (first := prod(cells)) > max_cells:
        raise ModelError(f"{first} cells to begin with are more than {max_cells}: give fewer, or a larger max_cells")
    q, half = _cells(low, high, cells)
    n = len(q)
    attained, at, count = np.zeros(n), np.zeros((n, n)), 0
    proved = np.zeros(n)  # the largest bound of cells that are done with
    while q.shape[1]:
        count += q.shape[1]
        kept = []
        for part in np.array_split(np.arange(q.shape[1]), ceil(q.shape[1] / CHUNK_CELLS)):
            s, bound = bound_cells(deviations, changes, q[:, part], half)
            for i in np.flatnonzero(s.max(axis=1) > attained):
                attained[i], at[i] = s[i].max(), q[:, part[s[i].argmax()]]
            undecided = (bound > (1 + tolerance) * attained[:, None]).any(axis=0)
            proved = np.maximum(proved, bound[:, ~undecided].max(axis=1, initial=0.0))
            kept.append(part[undecided])
        if count > max_cells or not np.isfinite(attained).all():
            raise ModelError(_no_bound_message(attained, at, count))
        q, half = _halve(q[:, np.concatenate(kept)], half)
    return LargestDeviation(readonly(attained), readonly(proved), readonly(at), count)


@arguments.checked
def bound_cells(deviations: Deviations, changes: Changes, q: ArrayLike, half: ArrayLike) -> tuple[Array, Array]:
    """Return deviations at the centres q (n, N) and bounds in the cells of half sides (n, 1), inf without a bound.

    Raises SignalError unless the arguments are matrices, ModelError for shapes that do not fit each other and
    for values below 0.
    """
    centres, sides = arguments.matrix("the centres", q), arguments.matrix("the half sides", half)
    s, column_changes = (
        arguments.matrix(name, f)
        for name, f in (("deviations", deviations(centres)), ("changes", changes(centres, sides)))
    )
    if (
        not (s.shape == column_changes.shape == centres.shape)
        or sides.shape != (len(centres), 1)
        or not np.isfinite([*centres.flat, *sides.flat]).all()
    ):
        raise ModelError(
            f"cells {centres.shape} with half sides {sides.shape} have deviations {s.shape} and changes "
            f"{column_changes.shape}: give (n, N) of each, half sides (n, 1), and finite places"
        )
    if (s < 0).any() or (column_changes < 0).any():
        least = min(float(np.nanmin(values)) for values in (s, column_changes))
        raise ModelError(f"a deviation or a change is {least:g}: both are bounds of sizes, give values from 0 on")
    with np.errstate(invalid="ignore"):
        denominators = 1 - (column_changes * s).sum(axis=0)
    is_bounded = denominators > 0  # False for NaN
    return s, np.where(is_bounded, s * (1 + ROUNDING) / np.where(is_bounded, denominators, 1.0), np.inf)


def _cells(low: Sequence[float], high: Sequence[float], counts: Sequence[int]) -> tuple[Array, Array]:
    """Return the centres (n, N) of cells, and half their sides (n, 1)."""
    if not len(low) == len(high) == len(counts) > 0 or min(counts) < 1:
        raise ModelError(f"{len(low)} low ends, {len(high)} high ends, cells {counts}: give one of each per unknown")
    if not all(a <= b for a, b in zip(low, high, strict=True)) or not np.isfinite([*low, *high]).all():
        raise ModelError(f"the box is from {list(low)} to {list(high)}: give finite ends, the lower ones first")
    steps = [(b - a) / n for a, b, n in zip(low, high, counts, strict=True)]
    sides = [a + step * (np.arange(n) + 0.5) for a, step, n in zip(low, steps, counts, strict=True)]
    grid = np.meshgrid(*sides, indexing="ij")
    return np.array([each.ravel() for each in grid]), np.array(steps)[:, None] / 2


def _halve(q: Array, half: Array) -> tuple[Array, Array]:
    """Return the cells halved along each side that is not 0."""
    signs = product(*((-0.5, 0.5) if side > 0 else (0.0,) for side in half.ravel()))
    return np.hstack([q + half * np.array(sign)[:, None] for sign in signs]), half / 2


def _no_bound_message(attained: Array, at: Array, cells: int) -> str:
    i = int(attained.argmax())
    place = ", ".join(f"{v:.6g}" for v in at[i])
    return (
        f"no bound of the deviations is found in {cells} cells; that of unknown {i} exceeds {attained[i]:.3g} times "
        f"the measurements' at q = ({place}), where rank seems to be lost: add a sensor, or allow a larger tolerance"
    )
