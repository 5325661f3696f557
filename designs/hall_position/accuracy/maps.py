"""Accuracy of sensors over the pitch: Cramér-Rao deviations and condition numbers, and errors of what the field has.

For (X, Y, yaw) at a height, or for all six coordinates; of the model of two waves in closed form, or of sensors with
whatever errors in any waves. Turned by a quarter about a strong block's centre a matrix is as before: what holds of X
at a yaw holds of Y a quarter turn further, so that yaws of +-45 deg show all of a map of both.

Deviations are proportional to sigma: those here are of the array's own, 1 mV unless given.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import radians, sqrt

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike

from designs.hall_position.accuracy import layouts, six_field
from designs.hall_position.accuracy.layouts import Numbers
from designs.hall_position.glsdc.six_parameters import Array
from models import hall_array
from models.concentrated_field import Wave
from models.hall_array import HallArray, Prediction
from synth import numeric
from synth.analyse.observability import information
from synth.analyse.observability.information import Accuracy
from synth.errors import ModelError
from synth.statespace import readonly

LEVER = 25.4e-3  # m, half a pitch
POINTS = 64  # along a pitch
Condition = tuple[float, float, float, float]
# By name: how much the gap is larger, m, and roll, pitch and yaw, rad.
CONDITIONS: dict[str, Condition] = {
    "level at the height": (0.0, 0.0, 0.0, 0.0),
    "0.5 mm nearer": (-0.5e-3, 0.0, 0.0, 0.0),
    "0.5 mm further": (0.5e-3, 0.0, 0.0, 0.0),
    "rolled 10 mrad": (0.0, 10e-3, 0.0, 0.0),
    "pitched 10 mrad": (0.0, 0.0, 10e-3, 0.0),
    "turned 5 deg": (0.0, 0.0, 0.0, radians(5)),
    "turned -5 deg": (0.0, 0.0, 0.0, radians(-5)),
    "all of them": (0.5e-3, 10e-3, -10e-3, radians(5)),
}


@dataclass(frozen=True, eq=False)
class Map:
    """Over the pitch, by conditions or sensors lost: largest and median deviations (n, 6), m and rad, and condition."""

    names: tuple[str, ...]
    worst: Numbers
    median: Numbers
    condition: Numbers


def of_sensors(
    array: HallArray, waves: Sequence[Wave], poses: ArrayLike, lever: float, height: float = hall_array.HEIGHT
) -> Accuracy:
    """Return what sensors tell at poses (N, 3) of X, Y, yaw at a height in m, or (N, 6) of all, in m and rad.

    Raises ModelError for poses that are none, a lever that is not above 0, or a single sensor.
    """
    if len(array.sensors) < 2:
        raise ModelError("one sensor has two voltages for three coordinates: add another one")
    at = numeric.table("the poses", poses, np.shape(poses)[-1] if np.shape(poses)[-1:] in ((3,), (6,)) else 6)
    predicted = hall_array.planar(array, waves, height) if at.shape[1] == 3 else hall_array.spatial(array, waves)
    return information.accuracy(jacobians(predicted, at), array.chain.noise, layouts.sizes(at.shape[1], lever))


def jacobians(of: Prediction, poses: ArrayLike) -> Numbers:
    """Return the Jacobians (N, m, n) of predicted voltages, in V/m and V/rad, at poses (N, n)."""
    return information.jacobians(ca.Function("volts", [of.q], [of.volts]), poses)


def spread(array: HallArray) -> float:
    """Return the sensors' root mean square distance in the plane from their mean, m: a lever of the yaw."""
    places = np.array([s.position[:2] for s in array.sensors])
    return sqrt(((places - places.mean(axis=0)) ** 2).sum(axis=1).mean())


def spatial(array: Array, poses: ArrayLike, lever: float = LEVER) -> Accuracy:
    """Return what an array tells at poses (N, 6) in m and rad, by the model of two waves.

    Raises ModelError for poses that are none, or a lever that is not above 0.
    """
    return information.accuracy(six_field.rows(array, poses), array.deviation, layouts.sizes(6, lever))


def cell(array: Array, condition: Condition, points: int = POINTS) -> Numbers:
    """Return a grid of poses (points^2, 6) over the pitch, X changing slowest, under one of CONDITIONS."""
    further, *angles = numeric.rows("conditions", [condition], 4)[0]
    level = layouts.level(array, layouts.poses(array.pitch, points))
    return readonly(level + np.array([0.0, 0.0, further, *angles]))


def conditions(array: Array, points: int = POINTS) -> Map:
    """Return the map of an array under CONDITIONS."""
    return _map({name: spatial(array, cell(array, each, points)) for name, each in CONDITIONS.items()})


def losses(array: Array, condition: str = "level at the height", points: int = POINTS) -> Map:
    """Return the map of an array with all sensors, and after the loss of each.

    Raises ModelError for an array that has no sensor to spare, or a condition that is none of CONDITIONS.
    """
    if condition not in tuple(CONDITIONS):
        raise ModelError(f"'{condition}' is no condition: give one of {', '.join(CONDITIONS)}")
    places = array.positions
    if len(places) < 5:
        raise ModelError(f"{len(places)} sensors have none to spare: four are needed everywhere, give five or more")
    at = cell(array, CONDITIONS[condition], points)
    left = {chr(ord("a") + k): (*places[:k], *places[k + 1 :]) for k in range(len(places))}
    found = {f"without {name}": spatial(replace(array, positions=rest), at) for name, rest in left.items()}
    return _map({"all": spatial(array, at)} | found)


def _map(found: Mapping[str, Accuracy]) -> Map:
    worst = readonly([a.deviations.max(axis=0) for a in found.values()])
    median = readonly([np.median(a.deviations, axis=0) for a in found.values()])
    return Map(tuple(found), worst, median, readonly([a.condition.max() for a in found.values()]))


def misfit(array: Array, sensors: HallArray, waves: Sequence[Wave], poses: ArrayLike) -> Numbers:
    """Return the errors (N, 6), m and rad, at poses (N, 6) when `sensors` are in the field of `waves`, to first order.

    Raises ModelError for poses that are none, for unlike numbers of sensors, or where rank is lost.
    """
    at = six_field.checked(poses)
    if len(sensors.sensors) != len(array.positions):
        raise ModelError(
            f"{len(sensors.sensors)} sensors meet {len(array.positions)} of the model: give as many of each"
        )
    extra = voltages(sensors, waves, at) - voltages(*six_field.model(array), at)
    return information.bias(six_field.rows(array, at), extra, layouts.sizes(6, LEVER))


def voltages(array: HallArray, waves: Sequence[Wave], poses: Numbers) -> Numbers:
    """Return what sensors read (N, m) in V at poses (N, 6) in m and rad."""
    predicted = hall_array.spatial(array, waves)
    volts = ca.Function("volts", [predicted.q], [predicted.volts])
    return np.asarray(volts.map(len(poses))(poses.T).full().T)
