"""The loop closed by four sensors keeps its bars in a field it does not know; each planted defect fails a check."""

from dataclasses import replace
from functools import cache

import pytest

from studies.hall.loop import experiments, four_experiments
from studies.hall.loop.stage_loop import Loop
from synth.check import Check
from synth.simulate.experiments import Experiment

pytestmark = pytest.mark.whole


@cache
def results() -> dict[str, Experiment]:
    return {e.name: e for e in four_experiments.run(lambda part: None)}


def failed_names(checks: tuple[Check, ...]) -> set[str]:
    return {check.name for check in checks if not check.passed}


def test_figures_10_to_12_and_failures_keep_their_bars() -> None:
    assert {name: failed_names(e.checks) for name, e in results().items()} == {name: set() for name in results()}
    names = ("rest", "step_plain", "step_calibrated", "zigzag_plain", "zigzag_calibrated", "staircase", "loss")
    assert set(results()) == {f"{name}_four" for name in (*names, "failures")}


def test_each_experiment_in_which_the_estimate_is_trusted_says_so() -> None:
    trusted = {"not valid", "misleading", "beyond 4 sigma", "valid and wrong", "first valid sample"}
    for name, e in results().items():
        names = {check.name for check in e.checks}
        assert trusted <= names or name in ("failures_four", "loss_four")
        assert ("estimate differs from the shipped C" in names) == ("plain" in name)


def staircase(loop: Loop) -> Experiment:
    e = experiments.staircase(loop)
    return replace(e, checks=(*e.checks, *four_experiments.trusted_checks(e.trajectory)))
