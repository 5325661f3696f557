"""Accuracy maps of sensors: published figures, misaligned sensors, refusals."""

from dataclasses import replace
from math import radians

import numpy as np
import pytest

from designs.hall_position import layout
from designs.hall_position.parameters import Array
from models import concentrated_field as cf
from models import hall_array
from models.hall_array import HallArray, Sensor
from synth.errors import ModelError

l, ALPHA, BETA = 50.8e-3, 8.4 * 0.37502, -8.4 * 0.02146
P = cf.values()
PLACES = ((-0.375 * l, -0.375 * l), (0.375 * l, 0.375 * l), (0.640 * l, 0.613 * l))
FITTED = cf.fitted({1: ALPHA / 8.4, 5: BETA / 8.4}, 3e-3, P)
POINTS = (0.0, 0.0, 0.0)


def test_two_sensors_are_as_published() -> None:
    pair = replace(hall_array.sensors(PLACES[:2]), volume=POINTS)
    found = layout.accuracy(pair, FITTED, layout.cell(l, 60), lever=0.05)
    assert abs(found.condition.min() - 1.376) < 5e-4
    assert abs(np.median(found.condition) - 4.14) < 0.03  # a median moves with the grid by as much
    larger = found.deviations[:, :2].max(axis=1)
    assert abs(np.median(larger) - 4.22e-6) < 0.03e-6
    assert abs((larger > 10e-6).mean() - 0.111) < 0.01


@pytest.mark.parametrize("waves", ["9th", "cross"])
def test_waves_beyond_the_model_change_the_worst_little(waves: str) -> None:
    orders = cf.on_axes((1, 5, 9)) + (cf.CROSS if waves == "cross" else ())
    made = cf.waves(cf.fabricated(P["strong"], P["weak"]), orders, P)
    found = layout.accuracy(hall_array.sensors(PLACES), made, layout.cell(l, 60)).deviations.max(axis=0)
    assert (found < [5.3e-6, 5.3e-6, 200e-6]).all() and found[0] > 4.5e-6


def test_misaligned_sensors_are_seen() -> None:
    crooked = HallArray(tuple(Sensor((x, y, 0.0), 0.3, (0.5, 0.5)) for x, y in PLACES), volume=POINTS)
    straight = replace(hall_array.sensors(PLACES), volume=POINTS)
    cell = layout.cell(l, 8, 0.2)
    ours, theirs = (layout.accuracy(each, FITTED, cell).deviations for each in (crooked, straight))
    np.testing.assert_allclose(ours, 2 * theirs, rtol=1e-9)  # half the gain; turned axes see as much


def test_the_map_over_yaw_is_proved_and_printed() -> None:
    found = layout.over_yaw(Array(PLACES, 0.0, ALPHA, BETA), [0.0, radians(5.0)], 2e-2)
    for row, largest in zip(found.worst * 1e6, (5.308, 7.745), strict=True):
        assert 0.999 * largest <= max(row[:2]) <= 1.021 * largest
    assert "yaw [deg]" in repr(found)


def test_a_quarter_turn_exchanges_the_axes() -> None:
    array = replace(hall_array.sensors(PLACES), volume=POINTS)
    q = layout.cell(l, 7, 0.3)
    turned = np.column_stack([-q[:, 1], q[:, 0], q[:, 2] + np.pi / 2])
    ours, theirs = (layout.accuracy(array, FITTED, each) for each in (q, turned))
    np.testing.assert_allclose(theirs.deviations, ours.deviations[:, [1, 0, 2]], rtol=1e-9)


def test_refusals() -> None:
    array = hall_array.sensors(PLACES)
    with pytest.raises(ModelError, match=r"shape \(2,\)"):
        layout.accuracy(array, FITTED, [0.0, 1.0])
    with pytest.raises(ModelError, match="finite"):
        layout.accuracy(array, FITTED, [[0.0, 1.0, np.nan]])
    with pytest.raises(ModelError, match="two voltages for three"):
        layout.accuracy(hall_array.sensors(PLACES[:1]), FITTED, layout.cell(l, 2))
    with pytest.raises(ModelError, match="at different places"):
        layout.accuracy(hall_array.sensors((PLACES[0], PLACES[0])), FITTED, layout.cell(l, 2))
