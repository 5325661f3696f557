"""Largest Cramér-Rao deviations over a box of places by branch and bound: an attained value and a proved bound.

Deviations s_i at q bound those in a cell about it. Let the columns H_j of the Jacobian change by at most d_j in length.
Then |H v + E v| >= |H v| - sum_j d_j |v_j| >= |H v| (1 - sum_j d_j s_j). As 1/s_i is the least |H v| with v_i = 1,

    s_i in the cell  <=  s_i(q) / (1 - sum_j d_j s_j(q)).

Cells whose bound exceeds the largest attained deviation are halved along each side until none remains.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import product
from math import ceil, prod

import numpy as np
from numpy.typing import ArrayLike

from synth import arguments
from synth.errors import ModelError
from synth.statespace import Array, readonly

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
