"""Accuracy of two and three sensors for the audit's formulas: deviations, lost rank, ambiguities.

Deviations are Cramér-Rao bounds by model (2), for white noise of the chain's standard deviation in each voltage. alpha
and beta are those above the infinite matrix unless a figure states otherwise. `fisher.worst` proves the largest
deviations over the pitch.
"""

from functools import lru_cache
from math import radians

import numpy as np

from designs.hall_position.paper import correction, fisher, layouts, sensor_accuracy
from designs.hall_position.paper.field import CACHED_RESULTS
from models import concentrated_field, hall_array, hall_two_waves
from models.hall_array import Array
from models.hall_stage import NUMBERS, Stage, grid
from models.hall_two_waves import PlanarArray
from synth.analyse.observability.information import LargestDeviation
from synth.base.cache import cached

POINTS = 240  # of a map, along a pitch
FINE = 120  # places along a pitch of a map with more harmonics
TOLERANCES = {0: 1e-3, 5: 0.1, 15: 0.25}  # relative, of proofs over yaws in degrees
LEVER = 50e-3  # m: lever that converts a yaw to a displacement


def deviations(array: PlanarArray) -> Array:
    """Return the deviations (3, N) of X, Y in m and yaw in rad over the pitch at yaw 0."""
    return fisher.deviations(array, grid(array, POINTS))


def deviation_at_known_yaw(array: PlanarArray, points: int = 4096) -> Array:
    """Return the deviation of X in m at a known yaw of 0, over a pitch (points,)."""
    q = np.zeros((3, points))
    q[0] = 2 * np.pi * np.arange(points) / points
    slopes = fisher.rows(array, q).g[0]
    return np.asarray(array.deviation / array.wave_number / np.sqrt((slopes**2).sum(axis=0)))


@lru_cache(CACHED_RESULTS)
@cached
def worst(array: PlanarArray, low: float, high: float, tolerance: float = TOLERANCES[0]) -> LargestDeviation:
    """Return the largest deviations over the pitch and yaws in degrees, with their bounds, as `fisher.worst`."""
    return fisher.worst(array, (radians(low), radians(high)), tolerance)


def worst_of_optimised_layout(stage: Stage, yaw: int) -> LargestDeviation:
    """Return the largest deviations of the layout that is optimised for yaws up to `yaw` degrees."""
    return worst(stage.array(layouts.LAYOUTS[yaw]), -yaw, yaw, TOLERANCES[yaw])


def distance_from_eighths(stage: Stage, places: Array) -> float:
    """Return the distance of the nearest of some places (n, 2) from (1/8, 3/8) pitch, m."""
    l = stage.pitch
    return float(np.abs(places - [l / 8, 3 * l / 8]).max(axis=1).min(initial=np.inf))


def conditions(stage: Stage) -> Array:
    """Return the condition numbers (N,) of two sensors over the pitch."""
    sizes = dict(zip(NUMBERS, stage.amplitudes(NUMBERS).tolist(), strict=True))
    waves = concentrated_field.waves_from_amplitudes(sizes, stage.height, concentrated_field.values())
    pair, at = hall_array.point_sensors(stage.pair.positions, stage.chain), hall_two_waves.poses(stage.pitch, 60).T
    return sensor_accuracy.of_sensors(pair, waves, at, LEVER).condition


def deviations_with_ninth_harmonic(stage: Stage) -> Array:
    """Return the largest deviations of X, Y and yaw of three sensors at yaw 0, with the 9th harmonic."""
    waves = stage.waves(concentrated_field.orders_on_axes((1, 5, 9)))
    sensors = hall_array.point_sensors(stage.three.positions, stage.chain)
    at = hall_two_waves.poses(stage.pitch, FINE).T
    return sensor_accuracy.of_sensors(
        sensors, waves, at, sensor_accuracy.rms_radius(sensors), stage.height
    ).deviations.max(axis=0)


def deviation_at(array: PlanarArray, x: float, y: float, yaw: float) -> float:
    """Return the deviation of X in m at a place in pitches and a yaw in degrees."""
    return float(fisher.deviations(array, np.array([[x * array.pitch], [y * array.pitch], [radians(yaw)]]))[0, 0])


def voltage_changes(array: PlanarArray) -> tuple[float, ...]:
    """Return the largest changes of the voltages, V, of four motions of random poses.

    They are a displacement by a pitch; rotations of body and position by a quarter and by half a turn about the origin;
    and a rotation of the body alone by an eighth of a turn.
    """
    rng = np.random.default_rng(0)
    q = np.vstack([rng.uniform(0, array.pitch, (2, 200)), rng.uniform(-np.pi, np.pi, 200)])
    moves = (
        q + np.array([[array.pitch], [0.0], [0.0]]),
        np.vstack([-q[1], q[0], q[2] + np.pi / 2]),
        np.vstack([-q[0], -q[1], q[2] + np.pi]),
        q + np.array([[0.0], [0.0], [np.pi / 4]]),
    )
    return tuple(float(np.abs(_body_voltages(array, at) - _body_voltages(array, q)).max()) for at in moves)


def _body_voltages(array: PlanarArray, q: Array) -> Array:
    """Return the voltages in the body's axes (2, sensors, N) at q (3, N), V."""
    return correction.rotate_voltages(correction.volts(array, q), -q[2])
