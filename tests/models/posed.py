"""Sensors in six degrees of freedom over known poses: layouts, and voltages in closed form."""

import numpy as np

from designs.hall_position.paper import layouts
from models import hall_two_waves
from models.hall_two_waves import SpatialArray as Array
from synth.statespace import Array as Numbers

L = 0.0508
ALPHA, BETA = 8.4 * 0.37502, -8.4 * 0.02146  # V: fabricated, 3 mm
ANY = Array(((0.0, 0.0, 0.0), (L, 0.0, 0.0), (0.0, L, 0.0)), ALPHA, BETA)
FOUR = hall_two_waves.with_positions(ANY, layouts.SPATIAL[4])
FIVE = hall_two_waves.with_positions(ANY, layouts.SPATIAL[5])
SIX = hall_two_waves.with_positions(ANY, layouts.SPATIAL[6])


def volts(array: Array, pose: Numbers) -> Numbers:
    """Return what sensors read at poses (.., 6) of X, Y, Z, roll, pitch, yaw, (.., sensors, 2), wave by wave."""
    X, Y, Z, roll, pitch, yaw = np.moveaxis(pose, -1, 0)
    (a, b, c), (s, t, u) = (f([roll, pitch, yaw]) for f in (np.cos, np.sin))
    axes = np.array(
        [
            [c * b, u * b, -t],
            [c * t * s - u * a, u * t * s + c * a, b * s],
            [c * t * a + u * s, u * t * a - c * s, b * a],
        ]
    )
    w, sensor_volts = 2 * np.pi / array.pitch, []
    for r in array.positions:
        x, y, z = np.array([X, Y, Z - array.height]) + np.tensordot(r, axes, 1)
        B = np.zeros((3, *X.shape))
        for n, size in ((1, array.alpha), (5, array.beta)):
            E = size * np.exp(-n * w * z)
            B += E * np.array([np.sin(n * w * x), np.sin(n * w * y), np.cos(n * w * x) + np.cos(n * w * y)])
        sensor_volts.append(np.stack([(axes[0] * B).sum(axis=0), (axes[1] * B).sum(axis=0)], axis=-1))
    return np.stack(sensor_volts, axis=-2)


def noisy(array: Array, pose: Numbers, seed: int = 0) -> Numbers:
    exact = volts(array, pose)
    return exact + array.deviation * np.random.default_rng(seed).standard_normal(exact.shape)


def places(n: int, seed: int, yaw: float = 0.09, gap: float = 4e-4, tilt: float = 8e-3) -> Numbers:
    """Return n poses (n, 6) anywhere in the pitch, within a yaw, a gap and a tilt."""
    rng = np.random.default_rng(seed)
    low = np.array([0, 0, 3e-3 - gap, -tilt, -tilt, -yaw])
    return rng.uniform(low, np.array([L, L, 3e-3 + gap, tilt, tilt, yaw]), (n, 6))
