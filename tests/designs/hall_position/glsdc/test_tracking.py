"""Tracking and integrity: motion, refused voltages, loss of position lock, search."""

import numpy as np
import pytest

from designs.hall_position.glsdc import tracking
from designs.hall_position.glsdc.parameters import Tuning
from tests.designs.hall_position.tracked import (
    THREE,
    TWO,
    L,
    Pose,
    at_rest,
    before_start,
    by_input,
    compile_c,
    motion,
    noisy,
    places,
    position_error,
    replay,
    wrap_angle,
)


def test_it_follows_over_many_pitches_and_turns_of_the_yaw() -> None:
    pose = motion(800, 100, 2, travel=0.3, yaw=0.5, turn=6.5)
    outputs = replay(THREE, before_start(pose), noisy(THREE, pose), Tuning(yaw_limit=np.pi))
    assert np.ptp(pose.X, axis=0).max() > 4 * L and np.ptp(pose.yaw, axis=0).min() > 2 * np.pi - 1.5
    assert outputs["converged"][20:].mean() > 0.98 and position_error(outputs, pose).max() < 1e-3
    assert np.abs(wrap_angle(outputs["yaw"] - pose.yaw)).max() < 0.02


def test_without_prediction_of_motion_rotating_bodies_lose_lock() -> None:
    pose, tuning = motion(800, 100, 2, travel=0.3, yaw=0.5, turn=6.5), Tuning(velocity_gain=0.0, yaw_limit=np.pi)
    outputs = replay(THREE, before_start(pose), noisy(THREE, pose), tuning)
    assert (position_error(outputs, pose).max(axis=0) > 1e-3).mean() > 0.1


def test_of_two_sensors_none_may_be_refused() -> None:
    rest = places(30, 9, 0.02)
    pose = at_rest(rest, 60)
    V = noisy(TWO, pose)
    V[30:33, :, 1, 0] = np.nan
    outputs = replay(TWO, rest, V)
    assert not outputs["valid"][30:33].any() and (outputs["valid"][33:].mean() > 0.8)
    assert (np.abs(outputs["X"][30:33] - outputs["X"][29]) < 5 * outputs["deviation_X"][29]).all()


def test_a_leap_loses_position_lock() -> None:
    """A leap of 3 mm in a sample: position lock is lost, and nothing is valid until `init`."""
    pose = at_rest(places(200, 15, 0.02), 100)
    leap = Pose(pose.X.copy(), pose.Y, pose.yaw)
    leap.X[50:] += 0.003
    outputs = replay(THREE, before_start(pose), noisy(THREE, leap))
    lost = outputs["lock_lost"][-1] > 0
    assert outputs["valid"][:50].all() and lost.mean() > 0.8
    assert not outputs["valid"][55:, lost].any()


@pytest.mark.parametrize("residual", [0.1, 0.01])
def test_the_search_converges_from_anywhere_in_the_pitch(residual: float) -> None:
    """From `init`, at a yaw within 2 degrees of the assumed one."""
    rest = places(300, 13, 0.035)
    pose, tuning = at_rest(rest, 40), Tuning(residual_limit=residual)
    state, outputs = np.repeat(compile_c(THREE, tuning).init()[np.newaxis], 300), []
    for now in noisy(THREE, pose):
        batch = compile_c(THREE, tuning).batch(state, by_input(THREE, now))
        state = batch.states
        outputs.append(batch.outputs)
    within = np.array([np.hypot(*((f[a] - getattr(rest, a) + L / 2) % L - L / 2 for a in "XY")) for f in outputs])
    sure = np.array([f["valid"] for f in outputs]) > 0
    assert sure[-1].mean() > 0.7 and within[sure].max() < 1e-4 and not sure[0].all()
    assert np.median(np.argmax(sure, axis=0)) < 10


def test_a_body_that_leaves_the_pitches_is_not_valid_again() -> None:
    t = np.arange(1200)[:, np.newaxis] / 800
    pose = Pose(0.03 + 0.08 * np.sin(4 * t), 0 * t + 0.01, 0 * t)
    outputs = replay(THREE, before_start(pose), noisy(THREE, pose), Tuning(pitches=1))
    crossing = np.argmax(pose.X + THREE.centre[0] > 1.55 * L)
    assert outputs["valid"][20 : crossing - 50].all() and not outputs["valid"][crossing + 50 :].any()
    assert crossing < 400 and pose.X[crossing + 50 :].min() < 0


def test_beyond_the_yaw_limit_nothing_is_valid_any_more() -> None:
    t = np.arange(800)[:, np.newaxis] / 800
    pose = Pose(0 * t + 0.01, 0 * t + 0.02, 0.3 * np.sin(5 * t))
    outputs = replay(THREE, before_start(pose), noisy(THREE, pose))
    crossing = np.argmax(pose.yaw > tracking.valid_yaw_limit(Tuning()))
    assert outputs["valid"][20 : crossing - 2].all() and not outputs["valid"][crossing + 2 :].any()
    assert (np.abs(pose.yaw[crossing + 2 :]) < 0.02).any() and outputs["lock_lost"][-1].all()
