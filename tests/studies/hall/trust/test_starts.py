"""Convergence near the position and from `init`; nothing is valid at a wrong position."""

from typing import Any

import numpy as np
import pytest

from designs.hall_position import config
from designs.hall_position.glsdc.parameters import Tuning
from models import hall_two_waves
from models.hall_motions import Pose
from studies.hall.trust import starts
from studies.hall.trust.estimator_ensemble import EstimatorConfig
from synth.errors import ModelError

pytestmark = pytest.mark.whole

TWO = EstimatorConfig(config.array())
YAW = np.radians(4.5)  # within the five degrees that a search assumes
BODIES = 10_000
YAWS = np.radians([-4.5, -2.0, 0.0, 2.0, 4.5])


def grid(points: int, yaws: np.ndarray = YAWS) -> Pose:
    return Pose(*hall_two_waves.poses(TWO.array.pitch, points, yaws))


def test_of_two_sensors_some_lead_elsewhere_and_none_is_valid_there() -> None:
    basin = starts.basin(TWO, BODIES, YAW)
    assert basin.misleading == 0 and 0.5 < basin.first[0, 0] < 0.7 and 0.9 < basin.last.mean() < 1


def test_a_map_over_the_pitch_shows_where_starts_must_be_nearer() -> None:
    loose = EstimatorConfig(TWO.array, Tuning(yaw_damping_ratio=1.0))
    two, other = (starts.capture_radius(kind, 16) for kind in (TWO, loose))
    assert two.shape == (16, 16) and two.min() > 3e-3
    # Near singular places the nearest start leads to the other way out, but for the yaw that is held.
    assert 0.01 < (other < 1e-3).mean() < 0.3 and np.median(other) > 3e-3


@pytest.mark.parametrize("number", [0, -1, 2.5, None, True])
def test_no_bodies_samples_or_points_are_refused(number: Any) -> None:
    with pytest.raises(ModelError, match="number of bodies is"):
        starts.basin(TWO, number, YAW, 1)
    with pytest.raises(ModelError, match="number of samples is"):
        starts.basin(TWO, 1, YAW, number)
    with pytest.raises(ModelError, match="number of points is"):
        starts.capture_radius(TWO, number)


@pytest.mark.parametrize("yaw", [float("nan"), None, "1"])
def test_a_yaw_that_is_none_is_refused(yaw: Any) -> None:
    with pytest.raises(ModelError, match="the yaw is"):
        starts.basin(TWO, 1, yaw, 1)
    with pytest.raises(ModelError, match=r"the yaw is -0.1 rad"):
        starts.basin(TWO, 1, -0.1, 1)


@pytest.mark.filterwarnings("error")
def test_where_no_start_was_drawn_there_is_no_share() -> None:
    basin = starts.basin(TWO, 4, YAW, 1)
    assert np.isnan(basin.first).sum() >= basin.first.size - 4 and np.isfinite(basin.first).any()


def test_two_sensors_are_unambiguous_in_a_part_of_the_pitch_at_rest_and_nearly_everywhere_in_motion() -> None:
    pose = grid(16, YAWS / 2)
    rest, moving = starts.cold_start(TWO, pose, 60), starts.cold_start(TWO, pose, 400, speed=0.05)
    at_rest, in_motion = ((each.first_valid > 0).mean() for each in (rest, moving))
    assert rest.is_correct[-1].mean() > 0.9 and 0.2 < at_rest < 0.35 and not rest.is_wrong.any()
    assert in_motion > 0.9 and not moving.is_wrong.any()


def test_no_cold_start_in_the_pitch_is_wrong_by_pitches() -> None:
    """A millimetre from its edge or more, the first sample of the search being anywhere."""
    start = starts.in_pitch(4000, 60)
    assert start.wrong == 0 and 0.2 < start.valid < 0.25 and start.misled == 0


def test_a_body_that_moves_is_found() -> None:
    """Its place is not certain before its motion is known."""
    speeds, pose = (0.15, 0.2, 0.25, 0.3), grid(24)
    for seed, speed in enumerate(speeds):
        scores = starts.cold_start(TWO, pose, 120, speed, seed)
        assert not scores.is_wrong.any() and scores.is_correct[-1].mean() >= 0.95


def test_a_yaw_beyond_the_assumed_ones_is_not_valid() -> None:
    """By 40 degrees: what is found is a quarter turn off, or nothing."""
    scores = starts.cold_start(TWO, grid(12, np.radians([-40.0, 40.0])), 60)
    assert not scores.valid.any() and not scores.is_wrong.any()


@pytest.mark.parametrize("number", [0, -1, 2.5, None, True])
def test_a_cold_start_of_no_samples_is_refused(number: Any) -> None:
    with pytest.raises(ModelError, match="number of samples is"):
        starts.cold_start(TWO, grid(1), number)
