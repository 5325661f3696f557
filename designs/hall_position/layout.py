"""What sensors tell of (X, Y, yaw) at each pose: Cramer-Rao deviations and condition numbers, for any array and field.

With the Jacobian H (m, 3) of the voltages and noise of the standard deviation sigma in each, independent,

    cov (X, Y, yaw) >= sigma^2 (H'H)^-1 = sigma^2 V S^-2 V',    H = U S V',

and the condition number is that of H with the yaw counted at a lever, S_1 / S_3 of H diag(1, 1, 1/lever).

Turned by a quarter about a strong block's centre, a matrix is as before: what holds of X at a yaw holds of Y a quarter
turn further, so that yaws of +-45 deg show all of a map of both. For model (2), `fisher` has this in closed form, and
proofs of what is largest.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import sqrt

import numpy as np
from numpy.typing import ArrayLike, NDArray

from designs.hall_position import fisher, parameters
from models import hall_array
from models.concentrated_field import Wave
from models.hall_array import HallArray
from synth import show
from synth.errors import ModelError
from synth.statespace import readonly

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Accuracy:
    """At poses (n, 3) of X, Y in m and yaw in rad: deviations (n, 3), inf where rank is lost, and condition (n,)."""

    poses: Array
    deviations: Array
    condition: Array


@show.printed
@dataclass(frozen=True, eq=False, repr=False)
class OverYaw:
    """The largest deviations (n, 3) of X, Y in m and yaw in rad over the pitch, at each yaw (n,) in rad."""

    yaws: Array
    worst: Array

    def sheet(self) -> show.Sheet:
        """Return a row for each yaw, in degrees, um and urad."""
        rows = np.column_stack([np.degrees(self.yaws), 1e6 * self.worst])
        names = tuple(str(k) for k in range(len(rows)))
        table = show.matrix("row", rows, names, ("yaw [deg]", "X [um]", "Y [um]", "yaw [urad]"))
        return show.Sheet("Largest standard deviations over the pitch", tables=(table,))


def accuracy(
    array: HallArray,
    waves: Sequence[Wave],
    poses: ArrayLike,
    height: float = hall_array.HEIGHT,
    lever: float | None = None,
) -> Accuracy:
    """Return what an array tells at poses (n, 3) in m and rad, in waves without symbols, a height in m above them.

    The lever in m is the sensors' root mean square distance from their mean unless given.

    Raises ModelError for a single sensor, poses of another shape or that are not finite, or a lever not above 0.
    """
    if len(array.sensors) < 2:
        raise ModelError("one sensor has two voltages for three coordinates: add another one")
    at = np.asarray(poses, dtype=np.float64)
    if at.ndim != 2 or at.shape[1] != 3 or not np.isfinite(at).all():
        raise ModelError(f"the poses have the shape {at.shape}: give finite X, Y and yaw in each row, (n, 3)")
    lever = spread(array) if lever is None else lever
    if not lever > 0:
        raise ModelError(f"the lever is {lever} m: give one above 0, or sensors at different places")
    H = jacobians(array, waves, at, height) / np.array([1.0, 1.0, lever])
    S, V = np.linalg.svd(H, full_matrices=False)[1:]
    with np.errstate(divide="ignore", invalid="ignore"):
        squares = ((V / S[:, :, None]) ** 2).sum(axis=1)
        condition = np.where(S[:, 2] > 0, S[:, 0] / S[:, 2], np.inf)
    found = np.sqrt(np.where(np.isfinite(squares), squares, np.inf)) * array.chain.noise / np.array([1.0, 1.0, lever])
    return Accuracy(readonly(at), readonly(found), readonly(condition))


def jacobians(array: HallArray, waves: Sequence[Wave], poses: Array, height: float = hall_array.HEIGHT) -> Array:
    """Return the Jacobians (n, m, 3) of the voltages, in V/m and V/rad, at poses (n, 3)."""
    f = hall_array.planar(array, waves, height).function()
    m = 2 * len(array.sensors)
    return f.map(len(poses))(poses.T)[1].full().reshape(m, len(poses), 3).transpose(1, 0, 2)


def spread(array: HallArray) -> float:
    """Return the sensors' root mean square distance in the plane from their mean, m."""
    places = np.array([s.position[:2] for s in array.sensors])
    return sqrt(((places - places.mean(axis=0)) ** 2).sum(axis=1).mean())


def cell(pitch: float, points: int, yaw: float = 0.0) -> Array:
    """Return a grid of poses (points^2, 3) over a pitch in m at one yaw in rad, X changing slowest."""
    along = pitch * np.arange(points) / points
    X, Y = np.meshgrid(along, along, indexing="ij")
    return readonly(np.column_stack([X.ravel(), Y.ravel(), np.full(X.size, yaw)]))


def over_yaw(array: parameters.Array, yaws: ArrayLike, tolerance: float = 1e-2) -> OverYaw:
    """Return the largest deviations over the pitch at yaws (n,) in rad, by model (2), proved to a relative tolerance.

    Raises ModelError as `fisher.worst`.
    """
    at = np.atleast_1d(np.asarray(yaws, dtype=np.float64))
    return OverYaw(readonly(at), readonly([fisher.worst(array, (yaw, yaw), tolerance).bound for yaw in at.tolist()]))
