"""The cold start that the header asks for, and what its checks must find."""

from dataclasses import replace

import pytest

from designs.hall_position import config, experiments
from designs.hall_position.design import DESIGN
from synth.app import standard_tasks
from synth.simulate.experiments import Experiment
from synth.simulate.rig import Rig


@pytest.fixture(scope="module")
def rig() -> Rig:
    return standard_tasks.rig(DESIGN, DESIGN.scalar)


def failed(of: Experiment) -> set[str]:
    return {c.name for c in of.checks if not c.passed}


def test_the_motion_of_the_header_leads_to_valid_and_rest_does_not(rig: Rig) -> None:
    (declared,) = DESIGN.all_experiments
    run = declared.run(rig)
    valid, at_rest, wrong = run.checks
    assert failed(run) == set() and valid.limit == config.COLD_START.valid == 0.95
    assert valid.value > 0.96 and 0.15 < at_rest.value < 0.3 and wrong.value == 0
    first = run.figures["median time to the first valid sample on the circle, s"]
    assert 0 < first < run.figures["largest, s"] <= config.COLD_START.longest_s
    assert run.trajectory["valid"].max() == 1


@pytest.mark.parametrize(
    ("asked", "check"),
    [
        ({"radius": 1e-3}, "starts on the circle that are valid within a revolution"),
        ({"yaw": 6.0}, "starts on the circle that are valid within a revolution"),
    ],
)
def test_a_circle_that_is_too_small_and_a_yaw_that_is_too_large_are_found(
    rig: Rig, asked: dict[str, float], check: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The planted defects: requests with which fewer starts are valid."""
    monkeypatch.setattr(config, "COLD_START", replace(config.COLD_START, **asked))
    monkeypatch.setattr(experiments, "STARTS", 500)
    assert check in failed(experiments.cold_start(rig, "planted"))


def test_an_error_that_counts_as_wrong_is_found(rig: Rig, monkeypatch: pytest.MonkeyPatch) -> None:
    """The planted defect: an error as small as the noise."""
    monkeypatch.setattr(experiments, "STARTS", 500)
    monkeypatch.setattr(experiments, "WRONG", 1e-6)
    assert "starts that are valid at a wrong place" in failed(experiments.cold_start(rig, "planted"))
