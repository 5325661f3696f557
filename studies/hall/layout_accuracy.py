"""Accuracy of layouts of two-axis Hall sensors over the pitch: their maps, losses of sensors, errors of the model.

Poses are (X, Y, yaw) at a height, or all six coordinates, of arrays in the field of two waves. A quarter turn about a
strong block's centre leaves the matrix unchanged: the accuracy of X at a yaw is that of Y a quarter turn further, and
yaws of +-45 deg show the whole map of both. The cost of a layout is

    cost = max over poses of max(s_places, lever s_angles)    in m

of (X, Y, yaw), or of all six coordinates of a level body. The lever converts angles to displacements.
"""

from collections.abc import Sequence
from dataclasses import replace
from math import radians
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from designs.hall_position.paper import fisher
from designs.hall_position.paper.sensor_accuracy import sizes
from models import hall_array, hall_two_waves
from models.concentrated_field import Wave
from models.hall_array import Array, HallArray
from models.hall_two_waves import PlanarArray, SpatialArray
from synth.analyse.observability import information
from synth.analyse.observability.information import Accuracy
from synth.errors import ModelError
from synth.statespace import readonly

LEVER = 25.4e-3  # m, half a pitch
POINTS = 64  # along a pitch
Condition = tuple[float, float, float, float]
LEVEL = "level at the height"
# By name: increase of the gap, m, and roll, pitch and yaw, rad.
CONDITIONS: dict[str, Condition] = {
    LEVEL: (0.0, 0.0, 0.0, 0.0),
    "0.5 mm nearer": (-0.5e-3, 0.0, 0.0, 0.0),
    "0.5 mm further": (0.5e-3, 0.0, 0.0, 0.0),
    "rolled 10 mrad": (0.0, 10e-3, 0.0, 0.0),
    "pitched 10 mrad": (0.0, 0.0, 10e-3, 0.0),
    "turned 5 deg": (0.0, 0.0, 0.0, radians(5)),
    "turned -5 deg": (0.0, 0.0, 0.0, radians(-5)),
    "all of them": (0.5e-3, 10e-3, -10e-3, radians(5)),
}


class Signs(NamedTuple):
    """The least and the largest determinant of three sensors over the pitch, relative to its mean size."""

    least: float
    largest: float


def spatial(array: SpatialArray, poses: ArrayLike, lever: float = LEVER) -> Accuracy:
    """Return the accuracy of an array at poses (N, 6) in m and rad; raise ModelError as `sizes`."""
    return information.accuracy(hall_two_waves.rows(array, poses), array.deviation, sizes(6, lever))


def cell(array: SpatialArray, condition: Condition, points: int = POINTS) -> Array:
    """Return a grid of poses (points^2, 6) over the pitch, X changing slowest, under one of CONDITIONS."""
    further, *angles = condition
    level = hall_two_waves.level(array, hall_two_waves.poses(array.pitch, points))
    return readonly(level + np.array([0.0, 0.0, further, *angles]))


def conditions(array: SpatialArray, points: int = POINTS) -> dict[str, Accuracy]:
    """Return the accuracy of an array over the pitch under CONDITIONS."""
    return {name: spatial(array, cell(array, each, points)) for name, each in CONDITIONS.items()}


def losses(array: SpatialArray, points: int = POINTS) -> dict[str, Accuracy]:
    """Return the accuracy over the pitch with all sensors, and after the loss of each.

    Raises ModelError for an array without a redundant sensor.
    """
    places = array.positions
    if len(places) < 5:
        raise ModelError(f"{len(places)} sensors have no redundant one: four are needed everywhere, give five or more")
    at = cell(array, CONDITIONS[LEVEL], points)
    left = {f"without {'abcdefgh'[k]}": (*places[:k], *places[k + 1 :]) for k in range(len(places))}
    return {name: spatial(replace(array, positions=kept), at) for name, kept in {"all": places, **left}.items()}


def misfit(array: SpatialArray, sensors: HallArray, waves: Sequence[Wave], poses: ArrayLike) -> Array:
    """Return the errors (N, 6), m and rad, at poses (N, 6) of `sensors` in the field of `waves`, to first order.

    Raises ModelError for invalid poses, for different numbers of sensors, or where rank is lost.
    """
    at = hall_two_waves.check_poses(poses)
    if len(sensors.sensors) != len(array.positions):
        raise ModelError(
            f"{len(sensors.sensors)} sensors and {len(array.positions)} of the model: give as many of each"
        )
    true, known = hall_array.spatial(sensors, waves), hall_array.spatial(*hall_two_waves.model(array))
    return information.bias(hall_two_waves.rows(array, at), true.evaluate(at) - known.evaluate(at), sizes(6, LEVER))


def jacobians(array: PlanarArray | SpatialArray, q: Array) -> Array:
    """Return the Jacobians (N, 2 sensors, 3 or 6) in V/m and V/rad at q (3, N), rows sensor by sensor."""
    if isinstance(array, SpatialArray):
        return hall_two_waves.rows(array, hall_two_waves.level(array, q))
    w, n = array.wave_number, len(array.positions)
    H = fisher.rows(array, np.array([w * q[0], w * q[1], q[2]])).jacobian / fisher.units(array)[:, None, None]
    return H.reshape(3, 2, n, -1).transpose(3, 2, 1, 0).reshape(-1, 2 * n, 3)


def cost(array: PlanarArray | SpatialArray, q: Array, lever: float = LEVER, after_loss: bool = False) -> float:
    """Return the largest deviation over q (3, N), m, angles at the lever; with `after_loss` after any sensor's loss."""
    H = jacobians(array, q)
    return information.largest_deviation(H, array.deviation, sizes(H.shape[2], lever), 2 if after_loss else 0)


def signs(array: SpatialArray, yaw: float = 0.0, points: int = 100) -> Signs:
    """Return the range of det H over the pitch at a yaw in rad, of an array of three sensors.

    Raises ModelError for another number of sensors, whose H is not square.
    """
    if len(array.positions) != 3:
        raise ModelError(f"{len(array.positions)} sensors have no determinant: give three")
    D = np.linalg.det(jacobians(array, hall_two_waves.poses(array.pitch, points, yaw)) / sizes(6, array.pitch))
    mean = np.abs(D).mean()
    return Signs(float(D.min() / mean), float(D.max() / mean))
