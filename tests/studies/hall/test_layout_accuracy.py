"""Accuracy maps of layouts: the sensor model, Monte Carlo, losses, errors of the field."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import casadi as ca
import numpy as np
import pytest
from scipy import optimize

from designs.hall_position.paper import sensor_accuracy
from models import concentrated_field as cf
from models import hall_array, hall_two_waves
from models.hall_array import HallArray
from models.hall_two_waves import SpatialArray as Array
from studies.hall import layout_accuracy
from synth.analyse.observability.information import Accuracy
from synth.errors import ModelError
from tests.models.posed import FIVE, FOUR, L, noisy, places, volts

SIZES = sensor_accuracy.sizes(6, layout_accuracy.LEVER)


def test_deviations_are_those_of_the_sensor_model() -> None:
    at = places(200, 0)
    in_body, of = (
        layout_accuracy.spatial(FOUR, at),
        sensor_accuracy.of_sensors(*hall_two_waves.model(FOUR), at, layout_accuracy.LEVER),
    )
    np.testing.assert_allclose(in_body.deviations, of.deviations, rtol=1e-9)
    np.testing.assert_allclose(in_body.condition, of.condition, rtol=1e-9)
    assert in_body.condition.max() < 12


def test_least_squares_scatter_as_much() -> None:
    """At one pose, 200 times: a ratio of rms is within 15 %, three of its standard deviations."""
    at = places(1, 1)[0]
    V = noisy(FOUR, np.tile(at, (200, 1)))
    expected = layout_accuracy.spatial(FOUR, at[np.newaxis]).deviations[0]
    off = [
        1e-5 * optimize.least_squares(lambda d, v=v: (volts(FOUR, at + 1e-5 * d / SIZES) - v).ravel(), np.zeros(6)).x
        for v in V
    ]
    ratio = np.sqrt(np.mean((np.array(off) / SIZES / expected) ** 2, axis=0))
    assert (np.abs(ratio - 1) < 0.15).all()


def worst(accuracy: Mapping[str, Accuracy]) -> np.ndarray:
    return np.array([each.deviations.max(axis=0) for each in accuracy.values()])


def median(accuracy: Mapping[str, Accuracy]) -> np.ndarray:
    return np.array([np.median(each.deviations, axis=0) for each in accuracy.values()])


def test_the_map_of_four_sensors() -> None:
    """At worst under all conditions 4.9 um in X and Y, 5.5 um in Z, 0.21 mrad; half of that is usual."""
    accuracy = layout_accuracy.conditions(FOUR, 40)
    assert tuple(accuracy) == tuple(layout_accuracy.CONDITIONS) and worst(accuracy).shape == (8, 6)
    assert (worst(accuracy)[:, :3] < 5.6e-6).all() and (worst(accuracy)[:, 3:] < 2.1e-4).all()
    assert (median(accuracy)[:, :3] < 2.6e-6).all() and (median(accuracy)[:, 3:] < 1.0e-4).all()
    assert all(each.condition.max() < 10 for each in accuracy.values())
    # Further away less is seen.
    near, far = (np.median(accuracy[f"0.5 mm {where}"].deviations, axis=0) for where in ("nearer", "further"))
    assert (near < far).all()


def test_the_map_after_the_loss_of_a_sensor() -> None:
    accuracy = layout_accuracy.losses(FIVE, points=40)
    assert tuple(accuracy) == ("all", *(f"without {k}" for k in "abcde"))
    assert np.isfinite(worst(accuracy)).all() and (worst(accuracy)[1:] > worst(accuracy)[0]).all()
    assert (median(accuracy)[1:, :3] < 5e-6).all() and (median(accuracy)[1:, 3:] < 3e-4).all()
    with pytest.raises(ModelError, match="4 sensors have no redundant one"):
        layout_accuracy.losses(FOUR)


def test_lost_rank_is_infinite() -> None:
    """Of sensors a half pitch apart where the fields of all are level or upright: none has a slope along X."""
    array = replace(FOUR, positions=((0.0, 0.0, 0.0), (L / 2, 0.0, 0.0), (0.0, L / 2, 0.0)), beta=0.0)
    accuracy = layout_accuracy.spatial(array, [[L / 4, L / 4, 3e-3, 0.0, 0.0, 0.0]])
    assert np.isinf(accuracy.deviations).all() and np.isinf(accuracy.condition).all()


def average_volume(sensors: HallArray, waves: Sequence[cf.Wave]) -> Array:
    """Return FOUR with the mean of the waves of number 1 and 5 over the sensors' volume."""
    of = {w.order: hall_array.average_over_volume(w, ca.SX.eye(3), sensors.volume) for w in waves}
    alpha, beta = (sensors.chain.gain * float(ca.DM(ca.evalf(cf.amplitude(of[n, 0], 3e-3)))) for n in (1, 5))
    return replace(FOUR, alpha=alpha, beta=beta)


def test_what_the_field_has_beyond_the_model_moves_the_pose() -> None:
    """By a tenth of a millimetre and 4 mrad, rms, of the fabricated blocks: thirty times the noise of a sample."""
    p = cf.values()
    cell = cf.fabricated_matrix(p["strong"], p["weak"])
    orders = cf.orders_on_axes((1, 3, 5, 7, 9)) + cf.CROSS
    waves = cf.waves(cell, orders, p)
    sensors = hall_array.HallArray(tuple(hall_array.Sensor(r) for r in FOUR.positions))
    array, at = average_volume(sensors, waves), places(200, 2)
    rms = np.sqrt((layout_accuracy.misfit(array, sensors, waves, at) ** 2).mean(axis=0))
    assert (rms[:3] > 3e-5).all() and (rms[:3] < 1.5e-4).all() and (rms[3:] > 1e-3).all() and (rms[3:] < 6e-3).all()
    model = [w for w in waves if w.order in ((1, 0), (0, 1), (5, 0), (0, 5))]
    none = layout_accuracy.misfit(array, sensors, model, at)
    assert np.abs(none[:, :3]).max() < 1e-7 and np.abs(none[:, 3:]).max() < 1e-5


@pytest.mark.parametrize("poses", [[0.0] * 6, [[0.0] * 3], [[np.nan] * 6], [["a"] * 6], np.zeros((0, 6)), None])
def test_poses_that_are_none_are_refused(poses: Any) -> None:
    by_waves = hall_two_waves.model(FOUR)
    for asked in (
        lambda: layout_accuracy.spatial(FOUR, poses),
        lambda: hall_two_waves.rows(FOUR, poses),
        lambda: layout_accuracy.misfit(FOUR, *by_waves, poses),
    ):
        with pytest.raises(ModelError, match=r"poses of X, Y, Z, roll, pitch, yaw .*: give finite numbers"):
            asked()


def test_a_lever_of_nothing_is_refused() -> None:
    with pytest.raises(ModelError, match="the lever is 0"):
        layout_accuracy.spatial(FOUR, places(1, 0), 0.0)
    for lever in (None, "a", float("nan"), True):
        with pytest.raises(ModelError, match="the lever is"):
            layout_accuracy.spatial(FOUR, places(1, 0), lever)  # type: ignore[arg-type]
        with pytest.raises(ModelError, match="the lever is"):
            sensor_accuracy.sizes(6, lever)  # type: ignore[arg-type]


@pytest.mark.parametrize("points", [0, 2.5, -1, True])
def test_maps_of_no_points_are_refused(points: Any) -> None:
    for asked in (
        lambda: layout_accuracy.conditions(FOUR, points),
        lambda: layout_accuracy.losses(FIVE, points=points),
    ):
        with pytest.raises(ModelError, match="number of poses along the pitch is"):
            asked()


def test_an_error_of_other_sensors_or_without_rank_is_refused() -> None:
    with pytest.raises(ModelError, match="5 sensors and 4 of the model"):
        layout_accuracy.misfit(FOUR, *hall_two_waves.model(FIVE), places(1, 0))
    still = replace(FOUR, positions=((0.0, 0.0, 0.0), (L, 0.0, 0.0), (0.0, L, 0.0)))
    with pytest.raises(ModelError, match="rank is lost at 1 of the places"):
        layout_accuracy.misfit(still, *hall_two_waves.model(still), [[0.0, 0.0, 3e-3, 0.0, 0.0, 0.0]])
