"""The sensor model of `models` for an array in the field of two waves each way, and its Jacobian by the pose.

Source: Kawato, Kim, "Multi-Degree-of-Freedom Precision Position Sensing", section 3.A.
"""

from functools import cache

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike, NDArray

from designs.hall_position.glsdc.six_parameters import Array
from models import concentrated_field, hall_array
from models.concentrated_field import Wave
from models.hall_array import HallArray
from synth import numeric
from synth.statespace import readonly

Numbers = NDArray[np.float64]


def model(array: Array) -> tuple[HallArray, tuple[Wave, ...]]:
    """Return the sensors and waves of `models` that read as `array`: sensors of no volume and two waves each way."""
    sensors = HallArray(tuple(hall_array.Sensor(r) for r in array.positions), volume=(0.0, 0.0, 0.0))
    gain = sensors.chain.gain
    amplitudes = {1: array.alpha / gain, 5: array.beta / gain}
    return sensors, concentrated_field.fitted(amplitudes, array.height, {"l": ca.SX(array.pitch)})


def checked(poses: ArrayLike) -> Numbers:
    """Return poses (N, 6) of X, Y, Z and angles; raise ModelError for another shape, none, or what is not finite."""
    return numeric.table("the poses of X, Y, Z, roll, pitch, yaw", poses, len(hall_array.SPATIAL))


def rows(array: Array, poses: ArrayLike) -> Numbers:
    """Return the Jacobians (N, 2 sensors, 6) in V/m and V/rad at poses (N, 6) in m and rad; raise as `checked`."""
    q = checked(poses).T
    slopes = _one().map(q.shape[1])
    field = (array.alpha, array.beta, array.height, array.pitch)
    found = [slopes(q, ca.DM(r), ca.DM(field)).full().reshape(2, -1, len(q)) for r in array.positions]
    return readonly(np.concatenate(found).transpose(1, 0, 2))


@cache
def _one() -> ca.Function:
    """Return the Jacobian (2, 6) of a sensor by the pose, its place in the body and (alpha, beta, height, pitch)."""
    q, r, field = (ca.SX.sym(name, n) for name, n in (("q", len(hall_array.SPATIAL)), ("r", 3), ("field", 4)))
    pose, (alpha, beta, height, pitch) = hall_array.spatial_pose(q), ca.vertsplit(field)
    waves = concentrated_field.fitted({1: alpha, 5: beta}, height, {"l": pitch})
    B = concentrated_field.field(waves, *ca.vertsplit(pose.at + pose.turn @ r))
    volts = (pose.turn.T @ ca.vertcat(B.x, B.y, B.z))[:2]
    return ca.Function("sensor", [q, r, field], [ca.jacobian(volts, q)])
