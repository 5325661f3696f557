"""Sensor failures: detection and its delay, continued operation, undetected errors."""

from typing import Any

import pytest

from designs.hall_position import config
from models.hall_motions import Limits
from studies.hall.trust import endurance, failures
from studies.hall.trust.estimator_ensemble import EstimatorConfig
from studies.hall.trust.failures import FAILURES, MAX_DELAY
from synth.errors import ModelError

pytestmark = pytest.mark.whole

TWO = EstimatorConfig(config.array())
MOVING = Limits(0.5, 5.0)
BODIES = 500


@pytest.mark.parametrize("within", [None, MOVING], ids=["at rest", "moving"])
@pytest.mark.parametrize("failure", sorted(set(FAILURES) - {"none"}))
def test_a_residual_out_of_its_bound_is_flagged_at_once(failure: str, within: Limits | None) -> None:
    outcome = failures.run_failure(TWO, failure, 2, BODIES, within)
    assert outcome.delay == 0 <= MAX_DELAY
    assert outcome.residual_exceeded > 0.3 or (failure, within) == ("stuck", None) or failure == "NaN"


def test_without_a_failure_no_residual_is_exceeded() -> None:
    """Two sensors are not valid where they lose rank, which is flagged."""
    outcome = failures.run_failure(TWO, "none", 2, BODIES, MOVING)
    assert outcome.residual_exceeded == outcome.lock_lost == outcome.misleading == 0 and outcome.valid > 0.5


@pytest.mark.parametrize(
    ("failure", "sensor", "message"),
    [
        ("asleep", 1, "'asleep' is not a known failure: give one of none, dead, "),
        (["dead"], 1, "is not a known failure"),
        ("dead", 0, "the sensor that fails is 0: give a whole number of at least 1 and at most 2"),
        ("dead", 5, "the sensor that fails is 5"),
        ("dead", -1, "the sensor that fails is -1"),
        ("dead", 1.5, "the sensor that fails is 1.5"),
    ],
)
def test_a_failure_that_cannot_be_is_refused(failure: str, sensor: int, message: str) -> None:
    for within in (None, MOVING):
        with pytest.raises(ModelError, match=message):
            failures.run_failure(TWO, failure, sensor, 2, within)
    with pytest.raises(ModelError, match=message):
        failures.undetected_error(TWO, failure, sensor, 2)


@pytest.mark.parametrize("number", [0, -2, 2.5, None, True])
def test_no_bodies_points_or_samples_are_refused(number: Any) -> None:
    for within in (None, MOVING):
        with pytest.raises(ModelError, match="number of bodies is"):
            failures.run_failure(TWO, "dead", 1, number, within)
    with pytest.raises(ModelError, match="number of poses along the pitch is"):
        failures.undetected_error(TWO, "dead", 1, number)
    with pytest.raises(ModelError, match="number of bodies is"):
        endurance.run(TWO, number, 3, MOVING)
    with pytest.raises(ModelError, match="number of samples is"):
        endurance.run(TWO, 3, number, MOVING)


@pytest.mark.parametrize("value", [0.0, -1.0, float("nan"), float("inf"), None])
def test_limits_that_are_none_are_refused(value: Any) -> None:
    for within in (Limits(value, 5.0), Limits(0.5, value)):
        with pytest.raises(ModelError, match="that is the limit is"):
            endurance.run(TWO, 2, 2, within)
