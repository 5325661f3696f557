"""What a reference tells of the estimate's errors, tabulated: the calibration of Figs. 10 and 11.

    x_k, y_k, yaw_k estimated,  X_k, Y_k, Yaw_k by the laser,  k = 1 .. N     scattered over the travel
    D(x, y) = (X - x, Y - y, Yaw - yaw)                                       linear on the triangles between samples
    table_ij = D(low + i h, low + j h),   corrected = estimate + (bilinear between the nearest four of the table)

The estimate is absolute and repeatable, so that what is mapped once holds. It holds at the yaw at which it was mapped:
a map of X and Y alone would leave the yaw to be wrong by as much as before, and with it the places of the sensors. So
the yaw is mapped, too.

Values are rounded to UNIT, a hundredth of the noise: the C then holds short numbers, alike on every machine.

Source: Kawato, Kim, "Multi-Degree-of-Freedom Precision Position Sensing", section 4, Figs. 10 and 11.
"""

from dataclasses import dataclass

import numpy as np

from synth import numeric
from synth.block import Block, Exprs, Step, build, table
from synth.blocks import lookup_table
from synth.blocks.lookup_table import Grid
from synth.errors import ModelError
from synth.signals import Signal
from synth.statespace import Array, readonly
from synth.timing import Discrete

COORDINATES = ("X", "Y", "yaw")
UNIT = {"X": 1e-8, "Y": 1e-8, "yaw": 1e-6}  # m, m, rad
FAR = 10.0  # m, rad: of what comes in and goes out


@dataclass(frozen=True, eq=False)
class ErrorMap:
    """What is added to the estimate at the points of a grid in m, `added` (3, n_x, n_y), m, m and rad.

    Raises ModelError for values of another shape, or that are not finite.
    """

    grid: Grid
    added: Array

    def __post_init__(self) -> None:
        shape = (len(COORDINATES), *self.grid.size)
        if np.shape(self.added) != shape or not np.isfinite(self.added).all():
            raise ModelError(f"the map has values {np.shape(self.added)}: give finite ones for its points, {shape}")


def fit(estimated: Array, reference: Array, grid: Grid) -> ErrorMap:
    """Return the map on a grid of estimates and references (N, 3) of X, Y in m and the yaw in rad.

    Raises ModelError for samples that are none, and as `lookup_table.fitted`.
    """
    estimated = numeric.table("the samples' estimates", estimated, len(COORDINATES))
    reference = numeric.table("the samples' references", reference, len(COORDINATES))
    if len(estimated) != len(reference):
        raise ModelError(f"{len(estimated)} estimates meet {len(reference)} references: give one for each")
    errors = lookup_table.fitted(estimated[:, :2], reference - estimated, grid)
    units = np.array([UNIT[name] for name in COORDINATES])
    return ErrorMap(grid, readonly(np.moveaxis(np.rint(errors / units) * units, -1, 0)))


def block(of: ErrorMap, time: Discrete) -> Block:
    """Return the Block ``error_map`` from X, Y and yaw to X_corrected, Y_corrected and yaw_corrected."""
    tables = {name: table(f"map_{name}", added.ravel()) for name, added in zip(COORDINATES, of.added, strict=True)}

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        added = lookup_table.bilinear(tables, of.grid, u["X"], u["Y"])
        return Step({f"{name}_corrected": u[name] + added[name] for name in COORDINATES})

    return build("error_map", time, law, inputs=_signals(""), outputs=_signals("_corrected"), tag="Figs. 10, 11")


def _signals(suffix: str) -> list[Signal]:
    units = dict(zip(COORDINATES, ("m", "m", "rad"), strict=True))
    return [Signal(f"{name}{suffix}", unit, -FAR, FAR) for name, unit in units.items()]
