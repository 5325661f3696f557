"""From `init` to the place, anywhere in the pitch."""

from typing import Any

import numpy as np
import pytest

from designs.hall_position import shipped
from designs.hall_position.trust import cold_start, fleet
from designs.hall_position.trust.fleet import Kind
from designs.hall_position.trust.motions import Pose
from synth.errors import ModelError
from synth.execute import host

TWO, THREE = (Kind(shipped.array(name)) for name in (shipped.NAME, shipped.THREE))
YAWS = np.radians([-4.5, -2.0, 0.0, 2.0, 4.5])


def test_three_sensors_find_every_place_within_forty_samples() -> None:
    """A twentieth of a second. Over 8,000 poses it was 23 samples at most, and 6 in the middle."""
    found = cold_start.run(THREE, cold_start.grid(THREE, 24, YAWS), 60)
    assert found.valid == 1.0 and found.wrong == 0 and found.took.max() <= 40 and np.median(found.took) < 10
    assert found.found.all() and found.poses.shape == (24 * 24 * 5, 3)


def test_two_sensors_are_certain_at_rest_in_a_part_of_the_pitch_and_on_the_way_nearly_anywhere() -> None:
    pose = cold_start.grid(TWO, 16, YAWS / 2)
    rest, moving = cold_start.run(TWO, pose, 60), cold_start.run(TWO, pose, 400, speed=0.05)
    assert rest.found.mean() > 0.9 and 0.2 < rest.valid < 0.35 and rest.wrong == 0
    assert moving.valid > 0.9 and moving.wrong == 0


@pytest.mark.parametrize("kind", [TWO, THREE], ids=["two", "three"])
def test_a_body_that_moves_is_found(kind: Kind) -> None:
    """Its place is not certain before its motion is known, nor is a sound sensor left out as the motion is not."""
    speeds, pose = (0.15, 0.2, 0.25, 0.3), cold_start.grid(kind, 24, YAWS)
    for seed, speed in enumerate(speeds):
        found = cold_start.run(kind, pose, 120, speed, seed)
        assert found.wrong == 0 and found.found.mean() >= (0.999 if kind is THREE else 0.95)


@pytest.mark.parametrize("kind", [TWO, THREE], ids=["two", "three"])
def test_a_search_that_ends_wherever_it_converges_is_seen(kind: Kind, monkeypatch: pytest.MonkeyPatch) -> None:
    stepped = fleet.stepped

    def careless(kind: Kind, state: host.Records, volts: fleet.Numbers) -> host.Batch:
        batch = stepped(kind, state, volts)
        return batch._replace(outputs=batch.outputs | {"valid": batch.outputs["converged"]})

    monkeypatch.setattr(fleet, "stepped", careless)
    assert cold_start.run(kind, cold_start.grid(kind, 24, YAWS), 40).wrong > 0


def test_a_yaw_beyond_the_assumed_ones_is_not_valid() -> None:
    """By 40 degrees: what is found is a quarter turn off, or nothing."""
    found = cold_start.run(THREE, cold_start.grid(THREE, 12, np.radians([-40.0, 40.0])), 60)
    assert found.valid == 0 and found.wrong == 0


@pytest.mark.parametrize("number", [0, -1, 2.5, None, True])
def test_no_points_or_samples_are_refused(number: Any) -> None:
    with pytest.raises(ModelError, match="number of poses along the pitch is"):
        cold_start.grid(THREE, number, YAWS)
    with pytest.raises(ModelError, match="number of samples is"):
        cold_start.run(THREE, cold_start.grid(THREE, 1, YAWS), number)


@pytest.mark.parametrize(
    ("pose", "message"),
    [
        (Pose(np.zeros(0), np.zeros(0), np.zeros(0)), "a row or more"),
        (Pose(np.zeros(2), np.zeros(3), np.zeros(2)), "the shapes .*: give as many of each"),
        (Pose(0.0, 0.0, 0.0), "the shapes"),  # type: ignore[arg-type]
        (Pose(np.full(2, np.nan), np.zeros(2), np.zeros(2)), "not all finite"),
    ],
)
def test_poses_that_are_none_are_refused(pose: Pose, message: str) -> None:
    with pytest.raises(ModelError, match=message):
        cold_start.run(THREE, pose, 2)


def test_yaws_and_speeds_that_are_none_are_refused() -> None:
    for yaws in ([], [np.nan], ["a"]):
        with pytest.raises(ModelError, match="the yaws"):
            cold_start.grid(THREE, 2, yaws)  # type: ignore[arg-type]
    for speed in (float("nan"), "1", None):
        with pytest.raises(ModelError, match="the speed is"):
            cold_start.run(THREE, cold_start.grid(THREE, 1, YAWS), 2, speed)  # type: ignore[arg-type]
