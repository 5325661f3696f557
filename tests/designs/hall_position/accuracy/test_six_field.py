"""The field over the gap, and what sensors tell of all six coordinates, against the sensor model of `models`."""

from dataclasses import replace
from math import exp

import casadi as ca
import numpy as np
import pytest

from designs.hall_position.accuracy import maps, six_field
from designs.hall_position.glsdc.six_parameters import Array, Tuning
from models import concentrated_field, hall_array, hall_scan
from models.concentrated_field import Wave
from synth.errors import ModelError
from tests import tolerances
from tests.designs.hall_position.posed import ALPHA, BETA, FOUR, L, places, volts

EXACT = tolerances.of("double")
RAISED = Array(((0.02, 0.01, 2e-3), (-0.015, 0.024, -1e-3), (0.003, -0.02, 0.0)), ALPHA, BETA)
HEIGHT = 3e-3


def fabricated() -> tuple[Wave, ...]:
    p = concentrated_field.values()
    cell = concentrated_field.fabricated(p["strong"], p["weak"])
    return concentrated_field.waves(cell, concentrated_field.on_axes((1, 5)), p)


@pytest.mark.parametrize("array", [FOUR, RAISED])
def test_rows_are_the_derivatives_of_the_sensor_model(array: Array) -> None:
    at = places(200, 0, yaw=3.0)
    expected = maps.jacobians(hall_array.spatial(*six_field.model(array)), at)
    np.testing.assert_allclose(six_field.rows(array, at), expected, rtol=0, atol=EXACT * np.abs(expected).max())


@pytest.mark.parametrize("part", ["tilted axes", "height of places", "5th wave"])
def test_a_part_that_is_forgotten_is_seen(part: str, monkeypatch: pytest.MonkeyPatch) -> None:
    at, of = places(200, 0), RAISED
    expected = maps.jacobians(hall_array.spatial(*six_field.model(RAISED)), at)
    if part == "tilted axes":
        monkeypatch.setattr(np, "cross", lambda a, b, axis: np.zeros_like(a))
    elif part == "height of places":
        of = replace(RAISED, positions=tuple((x, y, 0.0) for x, y, _ in RAISED.positions))
    else:
        monkeypatch.setattr(six_field, "NUMBERS", (1, 3))
    assert np.abs(six_field.rows(of, at) - expected).max() > 1e-2 * np.abs(expected).max()


@pytest.mark.parametrize("array", [FOUR, RAISED])
def test_the_voltages_of_these_tests_are_those_of_the_sensor_model(array: Array) -> None:
    sensors, waves = six_field.model(array)
    f = hall_array.spatial(sensors, waves).function()
    for pose in places(20, 1, yaw=3.0):
        expected = np.array(f(ca.DM(pose))[0]).ravel()
        np.testing.assert_allclose(volts(array, pose).ravel(), expected, rtol=0, atol=EXACT)


def test_sensors_see_the_mean_over_their_volume() -> None:
    """In alpha and beta, which a tilt of 8 mrad changes by less than a microvolt."""
    sensors = hall_array.HallArray(tuple(hall_array.Sensor(r) for r in FOUR.positions))
    found = six_field.seen(sensors, fabricated(), HEIGHT, L)
    assert found.alpha == pytest.approx(ALPHA, rel=2e-5) and found.alpha < ALPHA
    assert found.beta == pytest.approx(BETA, rel=1e-3) and found.positions == FOUR.positions
    f = hall_array.spatial(sensors, fabricated()).function()
    for pose in places(20, 2):
        off = volts(found, pose).ravel() - np.array(f(ca.DM(pose))[0]).ravel()
        assert np.abs(off).max() < 2e-6 < np.abs(volts(FOUR, pose).ravel() - volts(found, pose).ravel()).max()


def test_scans_over_the_gap_tell_the_field() -> None:
    """And its law of decay: 0.5 mm further away alpha is smaller by exp(-w 0.5 mm), beta by the fifth power of that."""
    sensors = replace(hall_array.sensors([(0.0, 0.0)]), volume=(0.0, 0.0, 0.0))
    heights = (2.5e-3, 3e-3, 3.5e-3)
    log = hall_scan.scanned(sensors, fabricated(), hall_scan.places(L, 16, heights), 0)
    found = six_field.scanned(hall_scan.fit_over_gap(log, "V_ax", L, HEIGHT), FOUR.positions, HEIGHT, L, 1e-3)
    assert found.alpha == pytest.approx(ALPHA, abs=5e-4) and found.beta == pytest.approx(BETA, abs=5e-4)
    at = np.array([[0.1 * L, 0.3 * L, z, 0.0, 0.0, 0.0] for z in heights])
    for n, of in ((1, replace(found, beta=0.0)), (5, replace(found, beta=found.alpha, alpha=1e-300))):
        V = volts(of, at)
        np.testing.assert_allclose(V[2], V[1] * exp(-n * of.wave_number * 0.5e-3), rtol=1e-9)


def test_a_field_without_the_5th_wave_is_refused() -> None:
    sensors = hall_array.HallArray(tuple(hall_array.Sensor(r) for r in FOUR.positions))
    with pytest.raises(ModelError, match="lack the number 5"):
        six_field.seen(sensors, fabricated()[:2], HEIGHT, L)
    turned = replace(sensors, sensors=(replace(sensors.sensors[0], angle=0.1), *sensors.sensors[1:]))
    for height in (0.0, "a"):
        with pytest.raises(ModelError, match="height is"):
            six_field.seen(sensors, fabricated(), height, L)  # type: ignore[arg-type]
    with pytest.raises(ModelError, match="turned in its body"):
        six_field.seen(turned, fabricated(), HEIGHT, L)


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


@pytest.mark.parametrize("change", [{"corrections": 0}, {"reach": 2.0}, {"tilt": 0.2}, {"gap": 0.0}, {"damping": -1.0}])
def test_a_tuning_that_cannot_be_is_refused(change: dict[str, float]) -> None:
    with pytest.raises(ModelError, match=f"{next(iter(change))} is"):
        Tuning(**change)  # type: ignore[arg-type]
