"""Layouts that were found, proved better than the published one over the yaws they are made for; the search itself."""

from dataclasses import replace
from math import radians
from typing import Any

import numpy as np
import pytest

from designs.hall_position import fisher, layout_search
from designs.hall_position.layout_search import LAYOUTS, PUBLISHED, Task
from designs.hall_position.parameters import Array
from synth.errors import ModelError

l = 50.8e-3
FIELD = Array(((0.0, 0.0), (l, 0.0)), 0.0, 8.4 * 0.37502, -8.4 * 0.02146)
LEVER = Task().lever


def test_the_published_layout_gets_worse_between_the_yaws_that_were_looked_at() -> None:
    array = layout_search.placed(FIELD, PUBLISHED)
    near = fisher.deviations(array, np.array([[0.49712 * l], [0.09771 * l], [radians(9.385)]])).ravel()
    assert near[0] > 190e-6 and near[2] > 4e-3
    for yaw in (0.0, 5.0, 15.0):
        at = layout_search.poses(array, radians(yaw) or 1e-9, (60, 2))
        assert layout_search.cost(fisher.deviations(array, at), LEVER) < 25e-6


@pytest.mark.parametrize(("yaw", "tolerance", "bounds"), [(5, 0.1, (5.3, 5.6, 232)), (15, 0.25, (5.9, 5.7, 313))])
def test_a_layout_is_proved_better(yaw: int, tolerance: float, bounds: tuple[float, float, float]) -> None:
    proved = fisher.worst(layout_search.placed(FIELD, LAYOUTS[yaw]), (-radians(yaw), radians(yaw)), tolerance)
    assert (proved.bound * [1e6, 1e6, 1e6] < bounds).all()
    at = layout_search.poses(FIELD, radians(yaw), (60, 17))
    published = fisher.deviations(layout_search.placed(FIELD, PUBLISHED), at).max(axis=1)
    assert (published[:2] > 1.2 * proved.bound[:2]).all() and published[2] > proved.bound[2]
    assert np.abs(LAYOUTS[yaw]).max() <= Task().reach


@pytest.mark.parametrize("yaw", [5, 15])
def test_no_small_step_betters_a_layout_much(yaw: int) -> None:
    task = Task(yaw=radians(yaw))
    cost = layout_search._costs(FIELD, task, (48, 9))
    ours = cost(np.ravel(LAYOUTS[yaw]))
    for seed in range(20):
        step = np.random.default_rng(seed).normal(size=6) * 0.01
        assert cost(np.ravel(LAYOUTS[yaw]) + step) > 0.98 * ours


def test_a_short_search_betters_the_published_layout(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(layout_search, "COARSE", (12, 3))
    monkeypatch.setattr(layout_search, "FINE", (32, 5))
    task = Task()
    assert layout_search.search(FIELD, task, 1, 2, 1) == layout_search.search(FIELD, task, 1, 2, 1)
    found = [layout_search.search(FIELD, task, seed, 60, 15) for seed in (0, 2)]
    fine = layout_search._costs(FIELD, task, (60, 9))
    assert min(fine(np.ravel(places)) for places in found) < 0.9 * fine(np.ravel(PUBLISHED))
    np.testing.assert_allclose(np.array(found) * 1000, np.round(np.array(found) * 1000), rtol=0, atol=1e-9)


def test_steps_better_a_layout() -> None:
    start = LAYOUTS[15]
    task = Task(yaw=radians(5))
    cost = layout_search._costs(FIELD, task, layout_search.FINE)
    better = layout_search.improved(FIELD, task, start, 0, 1)
    assert cost(np.ravel(better)) < cost(np.ravel(start))


def test_a_spare_sensor_counts_as_lost() -> None:
    task = Task(sensors=4, spare=True)
    four = (*PUBLISHED, (0.1, -0.3))
    assert layout_search.remaining(task, four)[-1] == PUBLISHED and len(layout_search.remaining(task, four)) == 4
    with_all, with_loss = (
        layout_search._costs(FIELD, replace(task, spare=spare), (16, 3))(np.ravel(four)) for spare in (False, True)
    )
    alone = layout_search._costs(FIELD, Task(), (16, 3))(np.ravel(PUBLISHED))
    assert with_all < alone <= with_loss


def test_refusals() -> None:
    with pytest.raises(ModelError, match="1 sensors do not tell the yaw"):
        Task(sensors=2, spare=True)
    with pytest.raises(ModelError, match="lever is 0"):
        Task(lever=0.0)
    with pytest.raises(ModelError, match="yaw is nan"):
        Task(yaw=float("nan"))


@pytest.mark.parametrize("value", [2.5, "3", None, True, 0, 27])
def test_the_number_of_sensors_is_whole(value: Any) -> None:
    with pytest.raises(ModelError, match="the number of sensors is"):
        Task(sensors=value)


@pytest.mark.parametrize("value", ["1", None, True, float("inf")])
def test_figures_of_a_task_are_numbers(value: Any) -> None:
    for name in ("yaw", "reach", "lever"):
        with pytest.raises(ModelError, match=f"{name} is"):
            Task(**{name: value})
    with pytest.raises(ModelError, match="spare is 1: give True"):
        Task(spare=1)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("places", "message"),
    [
        (((0.0, 0.0), (0.1, 0.2)), "2 places are given for 3 sensors"),
        (((0.0, 0.0), (0.1, 0.2), (0.1, 0.2, 0.3)), "has 3 numbers: give 2"),
        (((0.0, 0.0), (0.1, 0.2), (0.1, float("nan"))), "one of places is nan"),
        ((), "0 places"),
        (None, "places are None"),
    ],
)
def test_places_that_are_none_are_refused(places: Any, message: str) -> None:
    with pytest.raises(ModelError, match=message):
        layout_search.improved(FIELD, Task(), places, tries=0)


@pytest.mark.parametrize("value", [-1, 1.5, None, True])
def test_steps_of_a_search_are_counted(value: Any) -> None:
    for name in ("generations", "tries"):
        with pytest.raises(ModelError, match=f"{name} is"):
            layout_search.search(FIELD, Task(), **{"generations": 0, "tries": 0, name: value})


def test_no_poses_and_no_deviations_are_refused() -> None:
    for points in ((0, 1), (2, 0), (2.5, 1)):
        with pytest.raises(ModelError, match=r"number of .* is"):
            layout_search.poses(FIELD, 0.1, points)  # type: ignore[arg-type]
    with pytest.raises(ModelError, match="the yaw is nan"):
        layout_search.poses(FIELD, float("nan"), (2, 1))
    for deviations in (np.zeros((3, 0)), np.zeros((2, 4)), np.full((3, 4), np.nan)):
        with pytest.raises(ModelError, match="deviations have the shape"):
            layout_search.cost(deviations, 0.1)
