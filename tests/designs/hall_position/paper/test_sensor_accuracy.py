"""Accuracy of sensors in any waves: published figures, waves beyond the model, misaligned sensors, symmetry."""

import numpy as np
import pytest

from designs.hall_position.paper import sensor_accuracy
from models import concentrated_field as cf
from models import hall_array, hall_two_waves
from models.hall_array import HallArray, Sensor
from synth.errors import ModelError

l, ALPHA, BETA = 50.8e-3, 8.4 * 0.37502, -8.4 * 0.02146
P = cf.values()
PLACES = ((-0.375 * l, -0.375 * l), (0.375 * l, 0.375 * l), (0.640 * l, 0.613 * l))
FITTED = cf.waves_from_amplitudes({1: ALPHA / 8.4, 5: BETA / 8.4}, 3e-3, P)
POINTS = (0.0, 0.0, 0.0)


def test_two_sensors_are_as_published() -> None:
    pair = hall_array.point_sensors(PLACES[:2])
    accuracy = sensor_accuracy.of_sensors(pair, FITTED, hall_two_waves.poses(l, 60).T, 0.05)
    assert abs(accuracy.condition.min() - 1.376) < 5e-4
    assert abs(np.median(accuracy.condition) - 4.14) < 0.03  # a median moves with the grid by as much
    larger = accuracy.deviations[:, :2].max(axis=1)
    assert abs(np.median(larger) - 4.22e-6) < 0.03e-6
    assert abs((larger > 10e-6).mean() - 0.111) < 0.01


@pytest.mark.parametrize("waves", ["9th", "cross"])
def test_waves_beyond_the_model_change_the_worst_little(waves: str) -> None:
    orders = cf.orders_on_axes((1, 5, 9)) + (cf.CROSS if waves == "cross" else ())
    fabricated = cf.waves(cf.fabricated_matrix(P["strong"], P["weak"]), orders, P)
    of = hall_array.sensors(PLACES)
    accuracy = sensor_accuracy.of_sensors(
        of, fabricated, hall_two_waves.poses(l, 60).T, sensor_accuracy.rms_radius(of)
    ).deviations.max(axis=0)
    assert (accuracy < [5.3e-6, 5.3e-6, 200e-6]).all() and accuracy[0] > 4.5e-6


def test_misaligned_sensors_are_seen() -> None:
    crooked = HallArray(tuple(Sensor((x, y, 0.0), 0.3, (0.5, 0.5)) for x, y in PLACES), volume=POINTS)
    straight = hall_array.point_sensors(PLACES)
    cell = hall_two_waves.poses(l, 8, 0.2).T
    ours, theirs = (sensor_accuracy.of_sensors(each, FITTED, cell, 0.01).deviations for each in (crooked, straight))
    np.testing.assert_allclose(ours, 2 * theirs, rtol=1e-9)  # half the gain; turned axes see as much


def test_a_quarter_turn_exchanges_the_axes() -> None:
    array = hall_array.point_sensors(PLACES)
    q = hall_two_waves.poses(l, 7, 0.3).T
    rotated = np.column_stack([-q[:, 1], q[:, 0], q[:, 2] + np.pi / 2])
    ours, theirs = (sensor_accuracy.of_sensors(array, FITTED, each, 0.01) for each in (q, rotated))
    np.testing.assert_allclose(theirs.deviations, ours.deviations[:, [1, 0, 2]], rtol=1e-9)


def test_places_and_sensors_that_are_none_are_refused() -> None:
    array, same = hall_array.sensors(PLACES), hall_array.sensors((PLACES[0], PLACES[0]))
    for poses in ([0.0, 1.0], [[0.0, 1.0, np.nan]]):
        with pytest.raises(ModelError, match="finite"):
            sensor_accuracy.of_sensors(array, FITTED, poses, 0.01)
    with pytest.raises(ModelError, match="two voltages for three"):
        sensor_accuracy.of_sensors(hall_array.sensors(PLACES[:1]), FITTED, hall_two_waves.poses(l, 2).T, 0.01)
    with pytest.raises(ModelError, match="the lever is 0"):
        sensor_accuracy.of_sensors(same, FITTED, hall_two_waves.poses(l, 2).T, sensor_accuracy.rms_radius(same))
