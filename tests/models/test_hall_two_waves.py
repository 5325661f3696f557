"""The field over the gap, and the sensors' accuracy in six coordinates, against the sensor model of `models`."""

from dataclasses import replace

import casadi as ca
import numpy as np
import pytest

from models import hall_array, hall_two_waves
from models.hall_two_waves import SpatialArray as Array
from synth.analyse.observability import information
from synth.errors import ModelError
from tests import tolerances
from tests.models.posed import ALPHA, BETA, FOUR, places, volts

EXACT = tolerances.of("double")
RAISED = Array(((0.02, 0.01, 2e-3), (-0.015, 0.024, -1e-3), (0.003, -0.02, 0.0)), ALPHA, BETA)


@pytest.mark.parametrize("array", [FOUR, RAISED])
def test_rows_are_the_derivatives_of_the_sensor_model(array: Array) -> None:
    at = places(200, 0, yaw=3.0)
    expected = information.jacobians(hall_array.spatial(*hall_two_waves.model(array)).measurement(), at)
    np.testing.assert_allclose(hall_two_waves.rows(array, at), expected, rtol=0, atol=EXACT * np.abs(expected).max())
    forgetful = replace(array, positions=tuple((x, y, z + 1e-4) for x, y, z in array.positions))
    assert np.abs(hall_two_waves.rows(forgetful, at) - expected).max() > 1e-4 * np.abs(expected).max()


@pytest.mark.parametrize("array", [FOUR, RAISED])
def test_the_voltages_of_these_tests_are_those_of_the_sensor_model(array: Array) -> None:
    sensors, waves = hall_two_waves.model(array)
    f = hall_array.spatial(sensors, waves).function()
    for pose in places(20, 1, yaw=3.0):
        expected = np.array(f(ca.DM(pose))[0]).ravel()
        np.testing.assert_allclose(volts(array, pose).ravel(), expected, rtol=0, atol=EXACT)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"positions": FOUR.positions[:2]}, "2 sensors have fewer"),
        ({"alpha": 0.0}, "alpha is 0.0"),
        ({"height": -1e-3}, "height is -0.001"),
        ({"beta": float("nan")}, "must be finite"),
        ({"positions": tuple((0.0, 0.0, 1e-3 * k) for k in range(6))}, "above one another: .* apart in x and y"),
        ({"positions": tuple((0.01, 0.02, 1e-2 * k) for k in range(6))}, "above one another"),
    ],
)
def test_an_array_that_cannot_be_is_refused(change: dict[str, object], message: str) -> None:
    with pytest.raises(ModelError, match=message):
        replace(FOUR, **change)  # type: ignore[arg-type]
