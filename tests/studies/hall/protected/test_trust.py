"""How often three and four sensors are valid and wrong, with planted defects."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from designs.hall_position.protected import config
from designs.hall_position.protected.parameters import Tuning
from studies.hall.protected import cold_start, faults, trust
from studies.hall.protected.trust import Outcome
from synth.errors import ModelError
from synth.execute import host

pytestmark = pytest.mark.whole

GENERATED = Path(__file__).parents[4] / "generated_c"
BODIES = 1500
BAR, BEYOND = 2e-3, 1e-3  # of samples that are valid and wrong, and of errors above four deviations
WRONG_OF_THREE, VALID_OF_THREE = 5e-3, 0.75


def committed(name: str) -> host.Controller:
    folder = GENERATED / name
    files = {p.name: p.read_text() for p in folder.glob("*.[ch]")}
    return host.load(files, json.loads((folder / "manifest.json").read_text()))


def holds(outcome: Outcome) -> bool:
    """Return whether errors are as large as the deviations say."""
    return 0.7 < outcome.ratio < 1.5 and 0.7 < outcome.yaw_ratio < 1.5 and outcome.beyond < BEYOND


@pytest.mark.parametrize("speed", [0.0, trust.SPEED])
@pytest.mark.parametrize("fault", faults.FAULTS)
def test_calibrated_no_fault_of_a_sensor_misleads(fault: str, speed: float) -> None:
    outcome = trust.run(config.CALIBRATED, "calibrated", fault, BODIES, speed).outcome()
    assert outcome.wrong < BAR and outcome.valid > (0.99 if fault == "none" else 0.75 if speed == 0 else 0.5)
    assert fault != "none" or holds(outcome)


@pytest.mark.parametrize("speed", [0.0, trust.SPEED])
@pytest.mark.parametrize("fault", faults.FAULTS)
def test_calibrated_no_fault_of_one_of_three_sensors_misleads(fault: str, speed: float) -> None:
    outcome = trust.run(config.CALIBRATED_THREE, "calibrated", fault, BODIES, speed, name=config.THREE).outcome()
    assert outcome.wrong < WRONG_OF_THREE and (fault != "none" or outcome.valid > VALID_OF_THREE)


@pytest.mark.parametrize("offset", [0.02, 0.05, 0.1, 0.2])
def test_no_size_of_an_offset_misleads_three_sensors(offset: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """The levels allow 1.5 mm; an offset that passes the test moves the estimate less, mostly."""
    monkeypatch.setattr(faults, "OFFSET", offset)
    outcome = trust.run(config.CALIBRATED_THREE, "calibrated", "offset", BODIES, name=config.THREE).outcome()
    assert outcome.wrong < WRONG_OF_THREE


@pytest.mark.parametrize("speed", [0.0, trust.SPEED])
def test_without_calibration_and_fault_the_deviations_hold(speed: float) -> None:
    outcome = trust.run(config.USUAL, "built", "none", BODIES, speed).outcome()
    assert outcome.valid > 0.99 and outcome.wrong < BAR and holds(outcome)


def test_what_is_not_calibrated_shows() -> None:
    """The deviations of a calibration do not hold without it, and most estimates are not valid."""
    outcome = trust.run(config.CALIBRATED, "built", "none", BODIES).outcome()
    assert outcome.valid < 0.5 and outcome.ratio > 3


def test_no_cold_start_is_wrong_by_pitches() -> None:
    start = cold_start.run(config.USUAL, "built", BODIES)
    assert start.wrong == 0 and start.tracked > 0.998 and start.valid > 0.99 and start.longest <= 120


@pytest.mark.parametrize("fault", ["dead voltage", "stuck sensor", "saturated"])
@pytest.mark.parametrize(
    ("name", "tuning"), [(config.NAME, config.CALIBRATED), (config.THREE, config.CALIBRATED_THREE)]
)
def test_a_sensor_that_fails_before_init_misleads_nobody(name: str, tuning: Tuning, fault: str) -> None:
    start = cold_start.run(tuning, "calibrated", BODIES, name=name, fault=fault)
    assert start.wrong == 0 and start.misled < BAR
    assert start.valid > 0.95 if name == config.NAME else start.valid < 0.02


@pytest.mark.parametrize("name", config.PLACES)
def test_a_body_beyond_the_declared_yaw_is_not_valid(name: str) -> None:
    """Only one that is turned by a quarter, within the range, shows voltages of a pose at a declared yaw."""
    rng, most = np.random.default_rng(3), config.TUNINGS[name].yaw_range
    pose = cold_start.in_pitch(BODIES, rng)
    for low, high, valid in ((1.25 * most, np.pi / 2 - 1.1 * most, False), (np.pi / 2 - 0.8 * most, np.pi / 2, True)):
        yaw = rng.uniform(low, high, BODIES) * rng.choice([-1, 1], BODIES)
        of = trust.world("own", BODIES, rng, name)
        start = cold_start.start(committed(name), of, replace(pose, yaw=yaw), 120, rng)
        assert (start.valid > 0.5) == valid and (valid or start.valid == 0)


def test_an_unknown_field_or_fault_is_refused() -> None:
    with pytest.raises(ModelError, match="'steel' is not a known field"):
        trust.run(config.USUAL, "steel", "none", 3)
    with pytest.raises(ModelError, match="'rust' is not a known fault"):
        trust.run(config.USUAL, "built", "rust", 3)
