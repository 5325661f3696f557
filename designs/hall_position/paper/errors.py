"""Errors of GLSDC by what model (2) lacks of the field above real blocks, from the true position, without noise."""

from dataclasses import replace
from functools import lru_cache

import numpy as np

from designs.hall_position.paper import correction, field
from designs.hall_position.paper.field import CACHED_RESULTS
from models import concentrated_field, hall_array
from models.hall_array import Array
from models.hall_stage import PER_PITCH, Stage, grid
from models.hall_two_waves import PlanarArray
from synth.base import column_maps
from synth.statespace import readonly

CORRECTIONS, SCALE = 200, 0.2  # of GLSDC: the remaining step is below any printed digit
WAVES = (*concentrated_field.orders_on_axes((1, 3, 5, 9)), *concentrated_field.CROSS)


@lru_cache(CACHED_RESULTS)
def errors(stage: Stage, yaw_known: bool) -> Array:
    """Return the errors of GLSDC in X and Y (2, N) in m above six pitches of blocks, at yaw 0, X slowest."""
    truth, fit = stage.truth, field.fit_above_blocks(stage).estimate
    model = replace(stage.pair, c=fit["c"], alpha=fit["alpha"], beta=fit["beta"])
    i, j = (v.ravel() for v in np.indices((truth.count, truth.count)))
    at = np.rint(np.array(model.positions) / truth.spacing).astype(int)
    read = np.stack([truth.at(i + x, j + y) for x, y in at], axis=1)
    q = truth.spacing * np.vstack([i, j, np.zeros(i.size)]).astype(np.float64)
    return _error(model, read, q, yaw_known)


def error_after_calibration(off: Array, every: int) -> Array:
    """Return the errors (n, n), periodic, less their bilinear interpolation from every `every`-th place."""
    n = len(off)
    known = np.arange(0, n + 1, every)
    table = np.pad(off, (0, 1), mode="wrap")[np.ix_(known, known)]
    along = np.array([np.interp(np.arange(n), known, row) for row in table])
    return off - np.array([np.interp(np.arange(n), known, column) for column in along.T]).T


def true_motions(off: Array, spacing: float, step: float) -> Array:
    """Return the true motions of X in m where its estimate moves by a step in m, from all places of the pitch.

    `off` (n, n) are the errors of X in m at places `spacing` apart along X and Y, linear in between: the estimate is
    X + error(X).
    """
    n = len(off)
    X = spacing * np.arange(-n, 2 * n)
    motions = []
    for column in np.tile(off, (3, 1)).T:
        estimate = X + column
        for k in range(n, 2 * n):
            end = (
                np.flatnonzero(estimate[k:] >= estimate[k] + step)[0] + k
            )  # first place whose estimate is a step further
            fraction = (estimate[k] + step - estimate[end - 1]) / (estimate[end] - estimate[end - 1])
            motions.append(X[end - 1] + fraction * spacing - X[k])
    return np.array(motions)


@lru_cache(CACHED_RESULTS)
def by_waves(stage: Stage, array: PlanarArray, points: int = PER_PITCH) -> Array:
    """Return the errors of GLSDC in X and Y (2, N) in m above the infinite matrix at yaw 0, with the yaw estimated."""
    q = grid(array, points)
    predicted = hall_array.planar(
        hall_array.point_sensors(array.positions, stage.chain), stage.waves(WAVES), stage.height
    )
    volts = column_maps.map_columns(predicted.function(), q)[0]
    return _error(array, np.stack([volts[0::2], volts[1::2]]), q, False)


def _error(array: PlanarArray, read: Array, q: Array, yaw_known: bool) -> Array:
    return readonly(correction.iterate(array, read, q, SCALE, CORRECTIONS, yaw_known)[:2] - q[:2])


def rms(values: Array) -> float:
    """Return the root mean square."""
    return float(np.sqrt(np.mean(values**2)))
