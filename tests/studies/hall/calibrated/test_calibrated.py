"""Calibrated units: what each stage leaves, the faults that they then withstand, and planted defects."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from designs.hall_position import config as hall
from designs.hall_position.protected import config
from studies.hall.calibrated import corrections, estimator, stages, survey
from studies.hall.calibrated import unit as units
from studies.hall.calibrated.stages import UnitCalibration
from studies.hall.calibrated.survey import Case
from studies.hall.pages import integrity
from studies.hall.protected import faults, trust
from studies.hall.protected.cold_start import ColdStart
from studies.hall.protected.trust import Samples
from synth.errors import ModelError

pytestmark = pytest.mark.whole

SEED, OTHER, BODIES = 12, 13, 1500
CASE = Case("built", SEED)
BAR = 2e-3  # of samples that are valid and wrong
VALID = {0.0: 0.75, trust.SPEED: 0.5}  # by speed: in motion more exclusions come into doubt


def of(stage: str, seed: int = SEED) -> UnitCalibration:
    return stages.of_unit("built", seed, stage)


@cache
def samples(fault: str, speed: float = 0.0, bodies: int = BODIES) -> Samples:
    return survey.run(CASE, fault, bodies, speed)


@pytest.mark.parametrize(
    ("changed", "failed"),
    [
        ({}, []),
        ({"valid": 0.0, "longest": 0}, ["never valid"]),
        ({"longest": 121}, ["samples from init"]),
        ({"wrong": 1}, ["a pitch off"]),
    ],
)
def test_a_cold_start_that_breaks_a_bar_fails_its_check(changed: dict[str, float], failed: list[str]) -> None:
    started = replace(ColdStart(tracked=1.0, valid=1.0, median=97.0, longest=98, wrong=0, misled=0.0), **changed)
    checks = survey._start_checks("unit", [started], 0.99)
    assert [
        what
        for c, what in zip(checks, ("a pitch off", "never valid", "samples from init"), strict=True)
        if not c.passed
    ] == failed


def test_each_stage_leaves_less() -> None:
    residuals = [of(stage).residual for stage in stages.STAGES]
    errors = [of(stage).position_error for stage in stages.STAGES]
    assert residuals == sorted(residuals, reverse=True) and errors == sorted(errors, reverse=True)
    assert residuals[0] > 0.045 and 0.02 < residuals[2] < 0.03 and residuals[3] < 4.5e-3
    assert errors[0] > 90e-6 and errors[3] < 11e-6


def test_the_parameters_are_those_of_the_unit() -> None:
    unit, last = units.draw("built", SEED), of("map")
    assert np.abs(last.places() - np.array(unit.bench.places)).max() < 4e-5 < trust.PLACE
    turn = np.arctan2(last.gains()[:, 1, 0], last.gains()[:, 0, 0])
    angles = [mounting.angle for mounting in unit.bench.mountings]
    assert np.abs(turn - angles).max() < 3e-3 < trust.ANGLE


def test_r_covers_what_was_held_out_and_the_drift_of_gains() -> None:
    last = of("map")
    assert 0.98 * last.residual < last.model_error(0) < 1.1 * last.residual  # less the noise, at its upper bound
    tuning = estimator.tuning(last)
    assert tuning.model_error == pytest.approx(np.hypot(last.model_error(0), 0.003 / 3**0.5 * 2.25), rel=0.03)
    assert 1 <= tuning.position_limit / trust.WRONG < 1.05 and 1 <= tuning.yaw_limit / trust.WRONG_YAW < 1.15


def test_an_unknown_stage_is_refused() -> None:
    with pytest.raises(ModelError, match="'polish' is not a stage"):
        stages.calibrate(units.draw("built", SEED), "polish")


@pytest.mark.parametrize("speed", [0.0, trust.SPEED])
def test_without_a_fault_the_deviations_hold(speed: float) -> None:
    outcome = samples("none", speed).outcome()
    assert outcome.valid > 0.99 and outcome.wrong == 0 and outcome.beyond < 1e-3
    assert 0.8 < outcome.ratio < 1.2 and 0.8 < outcome.yaw_ratio < 1.2


@pytest.mark.parametrize("speed", [0.0, trust.SPEED])
@pytest.mark.parametrize("fault", [f for f in faults.FAULTS if f != "none"])
def test_no_fault_of_a_sensor_misleads(fault: str, speed: float) -> None:
    outcome = samples(fault, speed).outcome()
    assert outcome.wrong < BAR and outcome.valid > VALID[speed]


def test_no_cold_start_is_wrong_by_pitches() -> None:
    start = survey.cold_start(CASE, BODIES)
    assert start.wrong == 0 and start.valid > 0.985 and start.longest <= 120


def test_every_subset_of_sensors_is_protected_or_not_valid() -> None:
    for refused in survey.subsets():
        each = survey.diagram(survey.run(CASE, "none", 100, refused=refused), trust.WRONG)
        assert each.misleading == each.hazardous == 0
        assert each.availability > 0.9 if len(refused) < 2 else each.availability == 0


def test_the_report_shows_what_is_measured(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(survey, "UNITS", {"as built": CASE})
    monkeypatch.setattr(survey, "BODIES", 40)
    blocks = integrity.blocks() | integrity.tables(lambda _: None)
    rows = {row[:2]: row for row in blocks["integrity.faults"]}  # type: ignore[union-attr,index,misc]
    bare, mapped = (rows["as built", stage] for stage in ("none", "map"))
    assert bare[2] == 1e3 * config.USUAL.model_error and bare[7] > mapped[7] and bare[4] > mapped[4]
    assert [row[1] for row in blocks["integrity.stages"]] == list(stages.STAGES)  # type: ignore[union-attr,index,misc]
    assert len(blocks["integrity.subsets"]) == 16  # type: ignore[arg-type]


def test_a_calibration_without_a_table_is_refused() -> None:
    of = stages.of_unit("fabricated", 0, "sensors")
    with pytest.raises(ModelError, match="stage 'sensors' has no table of the field: calibrate to"):
        corrections.corrections(of, hall.TIME, {})


def test_runs_and_voltages_that_are_kept_belong_to_their_arguments() -> None:
    """Another seed and other sensors are another run, and another unit's bench has its own voltages."""
    first, second = (survey.run(CASE, "none", 20, seed=seed) for seed in (0, 1))
    assert (first.errors != second.errors).any() and survey.run(CASE, "none", 20, refused=(0, 1)).valid.sum() == 0
    poses = np.array([[1e-3, -2e-3, 0.01]])
    assert (units.draw("built", SEED).read(poses) != units.draw("built", OTHER).read(poses)).all()
    assert len(units.scan(units.draw("built", SEED))) == len(units.scan(units.draw("built", OTHER)))
    scans = (units.scan(units.draw("built", seed)).columns(("V_ax",)) for seed in (SEED, OTHER))
    assert (next(scans) != next(scans)).all()


def test_r_of_the_residuals_suits_the_yaw_of_each_field_and_the_shipped_one_does_not() -> None:
    """The planted defect: the R of matrices as built, in the better field of the fabricated one."""
    for field, seed in (("fabricated", 0), ("built", SEED)):
        tuned = survey.tune_without_corrections(Case(field, seed))
        outcomes = [trust.run(tuned, field, "none", BODIES, speed).outcome() for speed in survey.SPEEDS]
        assert survey.yaw_check(field, outcomes).passed
        assert all(o.valid > 0.99 and o.beyond < 1e-3 and 0.7 < o.ratio < 1.5 for o in outcomes)
    shipped = trust.run(config.USUAL, "fabricated", "none", BODIES).outcome()
    assert not survey.yaw_check("fabricated", [shipped]).passed


@pytest.mark.parametrize("speed", [0.0, trust.SPEED])
@pytest.mark.parametrize("fault", faults.FAULTS)
def test_three_calibrated_sensors_are_available_and_seldom_mislead(fault: str, speed: float) -> None:
    wrong, valid = survey.BARS[config.THREE]
    outcome = survey.run(Case("built", SEED, name=config.THREE), fault, BODIES, speed).outcome()
    assert outcome.wrong < wrong and (fault != "none" or (outcome.valid > valid and 0.8 < outcome.ratio < 1.2))
