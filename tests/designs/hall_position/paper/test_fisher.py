"""Deviations in closed form against the sensor model's Jacobians, and proofs of the largest against points between."""

from dataclasses import replace
from functools import partial
from math import radians

import numpy as np
import pytest

from designs.hall_position.paper import fisher, sensor_accuracy
from models import concentrated_field, hall_array
from models.hall_two_waves import PlanarArray as Array
from synth.analyse.observability import information
from synth.errors import ModelError

l, ALPHA, BETA = 50.8e-3, 8.4 * 0.37502, -8.4 * 0.02146
PLACES = ((-0.375 * l, -0.375 * l), (0.375 * l, 0.375 * l), (0.640 * l, 0.613 * l))
THREE = Array(PLACES, 0.0, ALPHA, BETA)
WAVES = concentrated_field.waves_from_amplitudes({1: ALPHA / 8.4, 5: BETA / 8.4}, 3e-3, concentrated_field.values())


def poses(count: int, seed: int = 3) -> np.ndarray:
    rng = np.random.default_rng(seed)
    return np.vstack([rng.uniform(0, l, (2, count)), rng.uniform(-np.pi, np.pi, count)])


def test_deviations_are_those_of_the_sensor_model() -> None:
    q = poses(500)
    sensors = hall_array.point_sensors(PLACES)
    expected = sensor_accuracy.of_sensors(sensors, WAVES, q.T, sensor_accuracy.rms_radius(sensors))
    sound = expected.condition < 1e3
    np.testing.assert_allclose(fisher.deviations(THREE, q).T[sound], expected.deviations[sound], rtol=1e-8)
    assert sound.sum() > 450


def test_the_constant_counts() -> None:
    array = Array(PLACES, 0.3, ALPHA, BETA)
    q, d = poses(1)[:, 0], 1e-7

    def volts(at: np.ndarray) -> np.ndarray:
        c, s = np.cos(at[2]), np.sin(at[2])
        rows = []
        for x, y in PLACES:
            p = 2 * np.pi / l * np.array([at[0] + c * x - s * y, at[1] + s * x + c * y])
            B = 0.3 + ALPHA * np.sin(p) + BETA * np.sin(5 * p)
            rows += [c * B[0] + s * B[1], c * B[1] - s * B[0]]
        return np.array(rows)

    H = np.column_stack([(volts(q + step) - volts(q - step)) / (2 * d) for step in d * np.eye(3)])
    expected = 1e-3 * np.sqrt(np.diag(np.linalg.inv(H.T @ H)))
    np.testing.assert_allclose(fisher.deviations(array, q[:, None]).ravel(), expected, rtol=1e-5)


def test_the_worst_without_yaw_is_that_of_the_added_sensor() -> None:
    worst = fisher.worst(THREE)
    np.testing.assert_allclose(worst.attained * 1e6, [5.2803, 5.3084, 198.002], rtol=2e-5)
    assert (worst.attained <= worst.bound).all() and (worst.bound <= 1.0011 * worst.attained).all()
    at = fisher.deviations(THREE, worst.at.T)
    np.testing.assert_allclose(np.diag(at), worst.attained, rtol=1e-9)


@pytest.mark.parametrize(("yaw", "largest"), [(5.0, 7.745), (15.0, 22.82), (45.0, 119.6)])
def test_the_worst_over_yaw(yaw: float, largest: float) -> None:
    worst = fisher.worst(THREE, (radians(yaw), radians(yaw)), 1e-2)
    assert max(worst.attained[:2]) * 1e6 <= largest * 1.001
    assert max(worst.bound[:2]) * 1e6 >= largest * 0.999
    assert (worst.bound <= 1.011 * worst.attained).all()


def count_exceeding(array: Array, half: np.ndarray, count: int = 4000) -> int:
    """Return how many random poses in random cells exceed the cell's bound."""
    rng = np.random.default_rng(5)
    q = rng.uniform(0, 2 * np.pi, (3, count))
    _, bound = information.bound_cells(partial(fisher.of_phases, array), partial(fisher.column_changes, array), q, half)
    s = fisher.of_phases(array, q + half * np.sign(rng.uniform(-1, 1, q.shape)))
    assert np.isfinite(bound).all(axis=0).sum() > count / 10
    return int((s > bound).sum())


@pytest.mark.parametrize("array", [THREE, replace(THREE, c=0.5)])
@pytest.mark.parametrize("half", [(0.01, 0.01, 0.002), (0.001, 0.001, 0.001), (0.02, 0.0, 0.0), (0.0, 0.0, 0.01)])
def test_no_pose_in_a_cell_exceeds_its_bound(array: Array, half: tuple[float, float, float]) -> None:
    assert count_exceeding(array, np.array(half)[:, None]) == 0


def test_two_sensors_have_no_bound(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(fisher, "MAX_CELLS", 200_000)
    with pytest.raises(ModelError, match="rank seems to be lost: add a sensor"):
        fisher.worst(Array(PLACES[:2], 0.0, ALPHA, BETA))


def test_lost_rank_is_infinite() -> None:
    array = Array(((0.0, 0.0), (l / 2, 0.0)), 0.0, ALPHA, 0.0)
    assert np.isinf(fisher.of_phases(array, np.array([[np.pi / 2], [0.0], [0.0]]))[0]) or (
        fisher.deviations(array, np.array([[l / 4], [0.0], [0.0]]))[0] > 1e3
    )


def test_yaws_in_the_wrong_order_are_refused() -> None:
    with pytest.raises(ModelError, match="give the lower first"):
        fisher.worst(THREE, (0.1, -0.1))
