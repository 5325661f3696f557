"""Sensor failures: detection and its delay, continued operation, undetected errors."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from designs.hall_position import config
from designs.hall_position.accuracy import layouts
from designs.hall_position.glsdc.parameters import Tuning
from designs.hall_position.trust import endurance, estimator_ensemble, failures
from designs.hall_position.trust.estimator_ensemble import EstimatorConfig
from designs.hall_position.trust.failures import FAILURES, MAX_DELAY
from models import hall_accuracy, hall_fisher, hall_two_waves
from models.hall_motions import Limits
from synth.errors import ModelError
from synth.execute import host

THREE = EstimatorConfig(config.array(config.THREE))
# A residual limit of ten standard deviations of the noise.
FOUR = EstimatorConfig(hall_two_waves.with_positions(config.array(), layouts.REDUNDANT), Tuning(residual_limit=0.01))
MOVING = Limits(0.5, 5.0)
BODIES = 500


def test_the_layout_leaves_any_three_of_four_sensors_with_no_singular_place() -> None:
    q = hall_two_waves.poses(FOUR.array.pitch, 40, np.radians(np.linspace(-5, 5, 5)))
    assert hall_accuracy.cost(FOUR.array, q, after_loss=True) < 11e-6


@pytest.mark.parametrize("within", [None, MOVING], ids=["at rest", "moving"])
@pytest.mark.parametrize("failure", sorted(set(FAILURES) - {"none"}))
def test_a_residual_out_of_its_bound_is_flagged_at_once(failure: str, within: Limits | None) -> None:
    for kind in (THREE, FOUR):
        outcome = failures.run_failure(kind, failure, 2, BODIES, within)
        assert outcome.delay == 0 <= MAX_DELAY
        assert outcome.residual_exceeded > 0.6 or (failure, within) == ("stuck", None) or failure == "NaN"


@pytest.mark.parametrize("failure", ["dead", "saturated", "NaN"])
@pytest.mark.parametrize("sensor", [1, 2, 3, 4])
def test_of_four_sensors_any_one_may_be_lost(failure: str, sensor: int) -> None:
    """Within 10 deviations all of them, and rms as far as these say."""
    for within in (None, MOVING):
        outcome = failures.run_failure(FOUR, failure, sensor, BODIES, within)
        assert outcome.flagged == 1 and outcome.lock_lost == 0 and outcome.valid > 0.99
        assert 0.9 < outcome.rms_error_sigma < 1.1 and outcome.misleading < 0.005 and outcome.max_valid_error < 1.5e-4
        assert outcome.isolated == (failure != "NaN")


@pytest.mark.parametrize(("failure", "lost"), [("NaN", 0.0), ("dead", 0.015)])
@pytest.mark.parametrize("sensor", [1, 2, 3, 4])
def test_of_four_sensors_any_one_may_be_lost_at_the_limits_of_motion(
    failure: str, lost: float, sensor: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """For a quarter of a second after it, pitches counted as far as that leads."""
    monkeypatch.setattr(failures, "AFTER", 200)
    far = replace(FOUR, tuning=replace(FOUR.tuning, pitches=endurance.COUNTED_PITCHES))
    outcome = failures.run_failure(far, failure, sensor, 200, endurance.limits(far), sensor)
    assert (
        outcome.lock_lost <= lost
        and outcome.valid >= 1 - lost
        and outcome.misleading == 0
        and outcome.max_valid_error < 5e-5
    )


@pytest.mark.parametrize("failure", ["dead", "saturated"])
@pytest.mark.parametrize("sensor", [1, 2, 3])
def test_of_three_sensors_it_is_isolated_and_the_others_continue_until_they_lose_rank(
    failure: str, sensor: int
) -> None:
    outcome = failures.run_failure(THREE, failure, sensor, BODIES, None)
    assert outcome.isolated > 0.99 and outcome.lock_lost < 0.005 and outcome.valid > (0.5 if sensor == 2 else 0.9)
    assert outcome.misleading < 0.01 and outcome.max_valid_error < 5e-4


def test_undetected_failures_cause_small_errors() -> None:
    """One axis that is dead where it reads next to nothing, and whatever is stuck at rest."""
    dead, stuck = (failures.undetected_error(FOUR, name, 1, 32) for name in ("one axis", "stuck"))
    hidden = np.isfinite(dead)
    assert np.isfinite(stuck).all() and stuck.max() < 2e-5
    assert 0 < hidden.mean() < 0.1 and np.nanmax(dead) < 1e-4
    at = hall_two_waves.poses(FOUR.array.pitch, 32)[0] + FOUR.array.positions[0][0]
    read = hall_fisher.field(FOUR.array, FOUR.array.wave_number * at).reshape(32, 32)
    assert np.abs(read[hidden]).max() < 0.05  # V: a true zero
    assert np.isnan(failures.undetected_error(FOUR, "saturated", 1, 24)).all()


def test_without_a_failure_nothing_is_flagged() -> None:
    outcome = failures.run_failure(THREE, "none", 2, BODIES, MOVING)
    assert (
        outcome.residual_exceeded == outcome.flagged == outcome.isolated == outcome.lock_lost == outcome.misleading == 0
        and outcome.valid == 1
    )


def test_an_estimate_without_flags_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    stepped = estimator_ensemble.step

    def blind(kind: EstimatorConfig, state: host.Records, volts: estimator_ensemble.Numbers) -> host.Batch:
        """Goes on with all sensors and is always valid."""
        state["estimator_excluded_sensor"] = 0
        batch = stepped(kind, state, volts)
        always = np.ones(len(state))
        return batch._replace(
            outputs=batch.outputs | {"valid": always, "excluded_sensor": 0 * always}, faults=0 * batch.faults
        )

    monkeypatch.setattr(estimator_ensemble, "step", blind)
    outcome = failures.run_failure(FOUR, "dead", 1, BODIES, MOVING)
    assert outcome.delay > MAX_DELAY and outcome.flagged == 0 and outcome.misleading > 0.5


@pytest.mark.parametrize(
    ("failure", "sensor", "message"),
    [
        ("asleep", 1, "'asleep' is not a known failure: give one of none, dead, "),
        (["dead"], 1, "is not a known failure"),
        ("dead", 0, "the sensor that fails is 0: give a whole number of at least 1 and at most 4"),
        ("dead", 5, "the sensor that fails is 5"),
        ("dead", -1, "the sensor that fails is -1"),
        ("dead", 1.5, "the sensor that fails is 1.5"),
    ],
)
def test_a_failure_that_cannot_be_is_refused(failure: str, sensor: int, message: str) -> None:
    for within in (None, MOVING):
        with pytest.raises(ModelError, match=message):
            failures.run_failure(FOUR, failure, sensor, 2, within)
    with pytest.raises(ModelError, match=message):
        failures.undetected_error(FOUR, failure, sensor, 2)


@pytest.mark.parametrize("number", [0, -2, 2.5, None, True])
def test_no_bodies_points_or_samples_are_refused(number: Any) -> None:
    for within in (None, MOVING):
        with pytest.raises(ModelError, match="number of bodies is"):
            failures.run_failure(FOUR, "dead", 1, number, within)
    with pytest.raises(ModelError, match="number of poses along the pitch is"):
        failures.undetected_error(FOUR, "dead", 1, number)
    with pytest.raises(ModelError, match="number of bodies is"):
        endurance.run(FOUR, number, 3, MOVING)
    with pytest.raises(ModelError, match="number of samples is"):
        endurance.run(FOUR, 3, number, MOVING)


@pytest.mark.parametrize("value", [0.0, -1.0, float("nan"), float("inf"), None])
def test_limits_that_are_none_are_refused(value: Any) -> None:
    for within in (Limits(value, 5.0), Limits(0.5, value)):
        with pytest.raises(ModelError, match="that is the limit is"):
            endurance.run(FOUR, 2, 2, within)
