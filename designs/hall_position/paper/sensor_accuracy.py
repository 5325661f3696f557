"""Accuracy of a pose from sensors with any errors in any waves: Cramér-Rao deviations and condition numbers.

Poses are (X, Y, yaw) at a height, or all six coordinates. Deviations are proportional to the noise of the array, 1 mV
by default.
"""

from collections.abc import Sequence
from math import sqrt

import numpy as np
from numpy.typing import ArrayLike

from models import hall_array
from models.concentrated_field import Wave
from models.hall_array import Array, HallArray
from synth import numeric
from synth.analyse.observability import information
from synth.analyse.observability.information import Accuracy
from synth.errors import ModelError


def of_sensors(
    array: HallArray, waves: Sequence[Wave], poses: ArrayLike, lever: float, height: float = hall_array.HEIGHT
) -> Accuracy:
    """Return the accuracy at poses (N, 3) of X, Y, yaw at a height in m, or (N, 6) of all, in m and rad.

    These are Cramér-Rao deviations and condition numbers, with angles times the lever in m.

    Raises ModelError for invalid poses, a lever that is not above 0, or a single sensor.
    """
    if len(array.sensors) < 2:
        raise ModelError("one sensor has two voltages for three coordinates: add another one")
    at = numeric.table("the poses", poses, np.shape(poses)[-1] if np.shape(poses)[-1:] in ((3,), (6,)) else 6)
    predicted = hall_array.planar(array, waves, height) if at.shape[1] == 3 else hall_array.spatial(array, waves)
    H = information.jacobians(predicted.measurement(), at)
    return information.accuracy(H, array.chain.noise, sizes(at.shape[1], lever))


def sizes(unknowns: int, lever: float) -> Array:
    """Return the displacement by a unit of each unknown, m: 1, or the lever for angles; raise ModelError for 0."""
    lever = numeric.positive("the lever", lever)
    return np.array([1.0, 1.0, lever] if unknowns == len(hall_array.PLANAR) else [1.0, 1.0, 1.0, lever, lever, lever])


def rms_radius(array: HallArray) -> float:
    """Return the sensors' rms distance in the plane from their mean, m: a lever of the yaw."""
    places = np.array([s.position[:2] for s in array.sensors])
    return sqrt(((places - places.mean(axis=0)) ** 2).sum(axis=1).mean())
