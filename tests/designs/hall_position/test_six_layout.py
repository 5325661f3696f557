"""Layouts for six degrees of freedom: why three sensors do not do, what four are worth, and the search."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from designs.hall_position import six_field, six_layout
from designs.hall_position.layout_search import Task
from synth.errors import ModelError
from tests.designs.hall_position.posed import ANY, FIVE, FOUR, SIX

LEVER = 25.4e-3
FINE = six_layout.poses(ANY, Task().yaw, (48, 7))


def test_four_sensors_tell_the_pose_everywhere() -> None:
    """Within 4.9 um, and a hundredth of that by half a pitch of angles, at yaws of 5 degrees to either side."""
    assert 4.4e-6 < six_layout.cost(FOUR, FINE, LEVER) < 4.9e-6
    moved = replace(FOUR, positions=(*FOUR.positions[:3], (0.0, 0.0, 0.0)))
    assert six_layout.cost(moved, FINE, LEVER) > 10e-6


@pytest.mark.parametrize("yaw", [0.0, 0.5])
def test_three_sensors_are_singular_on_curves(yaw: float) -> None:
    """Whatever their places, of 300 layouts: the determinant takes both signs, and by far more than rounding."""
    rng = np.random.default_rng(0)
    for places in rng.uniform(-0.64, 0.64, (300, 3, 2)):
        found = six_layout.signs(six_layout.placed(ANY, tuple(map(tuple, places))), yaw, points=16)
        assert found.least < -0.1 and found.largest > 0.1


def test_where_the_determinant_changes_its_sign_deviations_are_unbounded() -> None:
    three = replace(FOUR, positions=FOUR.positions[:3])
    at = six_layout.poses(three, 0.0, (200, 1))
    assert six_layout.cost(three, at, LEVER) > 1000 * six_layout.cost(FOUR, at, LEVER)
    with pytest.raises(ModelError, match="4 sensors have no determinant"):
        six_layout.signs(FOUR)


@pytest.mark.parametrize(
    ("places", "message"),
    [
        (six_layout.LAYOUTS[4], "4 places are given for 5 sensors"),
        (((0.0, 0.0, 0.0),) * 5, "has 3 numbers: give 2"),
        (None, "places are None"),
    ],
)
def test_places_that_are_none_are_refused(places: Any, message: str) -> None:
    with pytest.raises(ModelError, match=message):
        six_layout.improved(ANY, Task(sensors=5), places, tries=0)


def test_searches_that_cannot_be_are_refused() -> None:
    for task in (Task(sensors=2), Task(sensors=3, spare=True)):
        with pytest.raises(ModelError, match="2 sensors have fewer than six voltages"):
            six_layout.search(ANY, task, generations=1, tries=0)
    with pytest.raises(ModelError, match=r"generations is 1.5"):
        six_layout.search(ANY, Task(sensors=4), generations=1.5, tries=0)  # type: ignore[arg-type]
    with pytest.raises(ModelError, match="number of poses along the pitch is 0"):
        six_layout.signs(replace(FOUR, positions=FOUR.positions[:3]), points=0)
    with pytest.raises(ModelError, match="the yaw is nan"):
        six_layout.signs(replace(FOUR, positions=FOUR.positions[:3]), float("nan"), 3)


def test_any_sensor_may_be_lost_of_six_and_with_less_accuracy_of_five() -> None:
    """Four have none to spare. Of five the worst is at single points, of six nowhere above 12.7 um."""
    at = six_layout.poses(ANY, 0.0, (40, 1))
    assert six_layout.cost(FOUR, at, LEVER, spare=True) > 1e-3
    of_five = six_layout.cost(FIVE, at, LEVER, spare=True)
    left = [replace(FIVE, positions=FIVE.positions[:k] + FIVE.positions[k + 1 :]) for k in range(5)]
    assert of_five == pytest.approx(max(six_layout.cost(a, at, LEVER) for a in left), rel=1e-4)
    assert 20e-6 < of_five < 100e-6
    assert 9e-6 < six_layout.cost(SIX, FINE, LEVER, spare=True) < 13e-6


def test_the_search_improves_places() -> None:
    task = Task(sensors=4)
    found = six_layout.search(ANY, task, generations=2, tries=1)
    first = six_layout.placed(ANY, found)
    assert len(found) == 4 and all(abs(v) <= task.reach for place in found for v in place)
    better = six_layout.placed(ANY, six_layout.improved(ANY, task, found, tries=3))
    at = six_layout.poses(ANY, task.yaw, six_layout.FINE)
    assert six_layout.cost(better, at, LEVER) <= six_layout.cost(first, at, LEVER)


def test_the_cost_is_that_of_the_inverse() -> None:
    H = six_field.rows(FOUR, FINE[:50])
    bound = 1e-3 * np.sqrt(np.diagonal(np.linalg.inv(H.transpose(0, 2, 1) @ H), axis1=1, axis2=2))
    expected = (bound * six_layout.sizes(LEVER)).max()
    assert six_layout.cost(FOUR, FINE[:50], LEVER) == pytest.approx(expected, rel=1e-5)
