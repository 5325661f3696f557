"""Errors of GLSDC that knows model (2) above blocks whose field has more: from the true place, without noise."""

from dataclasses import replace
from functools import lru_cache

import numpy as np

from designs.hall_position.paper import field
from designs.hall_position.paper.field import KEPT
from models import concentrated_field, hall_array, hall_correction
from models.hall_array import Array
from models.hall_stage import PER_PITCH, Stage, grid
from models.hall_two_waves import PlanarArray
from synth.statespace import readonly

CORRECTIONS, SCALE = 200, 0.2  # of GLSDC: what is left of a step is below any digit
WAVES = (*concentrated_field.orders_on_axes((1, 3, 5, 9)), *concentrated_field.CROSS)


@lru_cache(KEPT)
def errors(stage: Stage, yaw_known: bool) -> Array:
    """Return by how much GLSDC errs in X and Y (2, N) in m above six pitches of blocks, at yaw 0, X slowest."""
    of, fit = stage.truth, field.fit_above_blocks(stage).estimate
    model = replace(stage.pair, c=fit["c"], alpha=fit["alpha"], beta=fit["beta"])
    i, j = (v.ravel() for v in np.indices((of.count, of.count)))
    at = np.rint(np.array(model.positions) / of.spacing).astype(int)
    read = np.stack([of.at(i + x, j + y) for x, y in at], axis=1)
    q = of.spacing * np.vstack([i, j, np.zeros(i.size)]).astype(np.float64)
    return _error(model, read, q, yaw_known)


def error_after_calibration(off: Array, every: int) -> Array:
    """Return what a table of errors (n, n), periodic, leaves of them: linear between each so many of its places."""
    n = len(off)
    known = np.arange(0, n + 1, every)
    table = np.pad(off, (0, 1), mode="wrap")[np.ix_(known, known)]
    along = np.array([np.interp(np.arange(n), known, row) for row in table])
    return off - np.array([np.interp(np.arange(n), known, column) for column in along.T]).T


def true_motions(off: Array, spacing: float, step: float) -> Array:
    """Return by how much X changes in m where its estimate changes by a step in m, from places all over the pitch.

    Of errors of X (n, n) in m at places `spacing` apart along X and Y: X + error(X) is made to change by the step;
    between places the error is taken to be linear.
    """
    n = len(off)
    X = spacing * np.arange(-n, 2 * n)
    motions = []
    for column in np.tile(off, (3, 1)).T:
        seen = X + column
        for k in range(n, 2 * n):
            ahead = np.flatnonzero(seen[k:] >= seen[k] + step)[0] + k  # the first place where it is seen there
            part = (seen[k] + step - seen[ahead - 1]) / (seen[ahead] - seen[ahead - 1])
            motions.append(X[ahead - 1] + part * spacing - X[k])
    return np.array(motions)


@lru_cache(KEPT)
def by_waves(stage: Stage, of: PlanarArray, points: int = PER_PITCH) -> Array:
    """Return by how much GLSDC errs in X and Y (2, N) in m above the infinite matrix, the yaw free and 0."""
    q = grid(of, points)
    predicted = hall_array.planar(hall_array.point_sensors(of.positions, stage.chain), stage.waves(WAVES), stage.height)
    volts = predicted.function().map(q.shape[1])(q)[0].full()
    return _error(of, np.stack([volts[0::2], volts[1::2]]), q, False)


def _error(of: PlanarArray, read: Array, q: Array, yaw_known: bool) -> Array:
    return readonly(hall_correction.iterate(of, read, q, SCALE, CORRECTIONS, yaw_known)[:2] - q[:2])


def rms(values: Array) -> float:
    """Return the root mean square."""
    return float(np.sqrt(np.mean(values**2)))
