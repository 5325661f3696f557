"""Accuracy of sensors over the pitch: Cramér-Rao deviations and condition numbers, and errors of what the field has.

For (X, Y, yaw) at a height, or for all six coordinates; of arrays in the field of two waves, or of sensors with
whatever errors in any waves. Turned by a quarter about a strong block's centre a matrix is as before: what holds of X
at a yaw holds of Y a quarter turn further, so that yaws of +-45 deg show all of a map of both.

Deviations are proportional to sigma: those here are of the array's own, 1 mV unless given.
"""

from collections.abc import Sequence
from dataclasses import replace
from math import radians

import numpy as np
from numpy.typing import ArrayLike

from designs.hall_position.accuracy import layouts, six_field
from designs.hall_position.accuracy.layouts import LEVER, Numbers
from designs.hall_position.glsdc.six_parameters import Array
from models import hall_accuracy, hall_array
from models.concentrated_field import Wave
from models.hall_array import HallArray
from synth.analyse.observability import information
from synth.analyse.observability.information import Accuracy
from synth.errors import ModelError
from synth.statespace import readonly

POINTS = 64  # along a pitch
Condition = tuple[float, float, float, float]
LEVEL = "level at the height"
# By name: how much the gap is larger, m, and roll, pitch and yaw, rad.
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


def spatial(array: Array, poses: ArrayLike, lever: float = LEVER) -> Accuracy:
    """Return what an array tells at poses (N, 6) in m and rad; raise ModelError as `of_sensors`."""
    return information.accuracy(six_field.rows(array, poses), array.deviation, hall_accuracy.sizes(6, lever))


def cell(array: Array, condition: Condition, points: int = POINTS) -> Numbers:
    """Return a grid of poses (points^2, 6) over the pitch, X changing slowest, under one of CONDITIONS."""
    further, *angles = condition
    level = layouts.level(array, layouts.poses(array.pitch, points))
    return readonly(level + np.array([0.0, 0.0, further, *angles]))


def conditions(array: Array, points: int = POINTS) -> dict[str, Accuracy]:
    """Return the accuracy of an array over the pitch under CONDITIONS."""
    return {name: spatial(array, cell(array, each, points)) for name, each in CONDITIONS.items()}


def losses(array: Array, points: int = POINTS) -> dict[str, Accuracy]:
    """Return the accuracy over the pitch with all sensors, and after the loss of each.

    Raises ModelError for an array that has no sensor to spare.
    """
    places = array.positions
    if len(places) < 5:
        raise ModelError(f"{len(places)} sensors have none to spare: four are needed everywhere, give five or more")
    at = cell(array, CONDITIONS[LEVEL], points)
    left = {f"without {'abcdefgh'[k]}": (*places[:k], *places[k + 1 :]) for k in range(len(places))}
    return {name: spatial(replace(array, positions=kept), at) for name, kept in {"all": places, **left}.items()}


def misfit(array: Array, sensors: HallArray, waves: Sequence[Wave], poses: ArrayLike) -> Numbers:
    """Return the errors (N, 6), m and rad, at poses (N, 6) when `sensors` are in the field of `waves`, to first order.

    Raises ModelError for poses that are none, for unlike numbers of sensors, or where rank is lost.
    """
    at = six_field.checked(poses)
    if len(sensors.sensors) != len(array.positions):
        raise ModelError(
            f"{len(sensors.sensors)} sensors meet {len(array.positions)} of the model: give as many of each"
        )
    true, known = hall_array.spatial(sensors, waves), hall_array.spatial(*six_field.model(array))
    return information.bias(six_field.rows(array, at), true.read(at) - known.read(at), hall_accuracy.sizes(6, LEVER))
