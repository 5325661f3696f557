"""Error map (2-D lookup table): corrections of estimated coordinates from a reference, over the first two of them.

    x_k estimates, X_k references, (m,),  k = 1 .. N                    scattered over the travel
    D(x) = X - x                                                        linear on the triangles between samples
    table_ij = D(low + i h, low + j h),   corrected = estimate + (bilinear between the nearest four of the table)

The estimate must be absolute and repeatable; then a map measured once stays valid. Values are rounded to a unit far
below the noise. The C then holds short numbers, which are the same on every machine.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from synth import numeric
from synth.block import Block, Exprs, Step, build, table
from synth.blocks.laws import lookup_table
from synth.blocks.laws.lookup_table import Grid
from synth.errors import ModelError
from synth.signals import Signal
from synth.statespace import Array, readonly
from synth.timing import Discrete


@dataclass(frozen=True, eq=False)
class ErrorMap:
    """Corrections of m coordinates at the points of a grid: `added` (m, n_x, n_y), in the coordinates' units.

    Raises ModelError for values of another shape or values that are not finite.
    """

    grid: Grid
    added: Array

    def __post_init__(self) -> None:
        shape = (*np.shape(self.added)[:1], *self.grid.size)
        if np.shape(self.added) != shape or not np.isfinite(self.added).all():
            raise ModelError(f"the map has values {np.shape(self.added)}: give finite ones for its points, {shape}")


def fit(estimated: Array, reference: Array, grid: Grid, units: ArrayLike) -> ErrorMap:
    """Return the map of estimates and references (N, m), rounded to `units` (m,).

    Raises ModelError for fewer than two units or one that is not positive, samples of the wrong shape or count, and as
    `lookup_table.interpolate_samples`.
    """
    units = np.atleast_1d(np.asarray(units, dtype=np.float64))
    if units.ndim > 1 or len(units) < 2 or not (units > 0).all():
        raise ModelError(f"the units are {units.tolist()}: give a positive one for each of two or more coordinates")
    estimated = numeric.table("the samples' estimates", estimated, len(units))
    reference = numeric.table("the samples' references", reference, len(units))
    if len(estimated) != len(reference):
        raise ModelError(f"{len(estimated)} estimates meet {len(reference)} references: give one for each")
    errors = lookup_table.interpolate_samples(estimated[:, :2], reference - estimated, grid)
    return ErrorMap(grid, readonly(np.moveaxis(np.rint(errors / units) * units, -1, 0)))


def block(of: ErrorMap, time: Discrete, signals: Sequence[Signal], tag: str = "") -> Block:
    """Return the Block ``error_map`` from m coordinates to each ``<name>_corrected``.

    Raises ModelError for another number of signals, or fewer than two.
    """
    if len(signals) != len(of.added) or len(signals) < 2:
        raise ModelError(
            f"the map is of {len(of.added)} coordinates: give as many signals, two or more, not {len(signals)}"
        )
    tables = {s.name: table(f"map_{s.name}", added.ravel()) for s, added in zip(signals, of.added, strict=True)}

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        added = lookup_table.bilinear(tables, of.grid, *(u[s.name] for s in signals[:2]))
        return Step({f"{name}_corrected": u[name] + added[name] for name in tables})

    corrected = [replace(s, name=f"{s.name}_corrected") for s in signals]
    return build("error_map", time, law, inputs=signals, outputs=corrected, tag=tag)
