"""Experiments of failing sensors: what is measured and checked, with a planted defect for each check."""

from dataclasses import replace

import numpy as np
import pytest

from synth.simulate.faults import failure_experiments
from synth.simulate.faults.failure_experiments import NAN, Failure, Limits, Texts
from tests.simulate.faults import test_failure
from tests.verify.test_stimuli import STAGE

TEXTS = Texts("nan", "A sensor reads NaN", "each sensor", ("z",))
SLEW = max(a.slew_per_s for a in STAGE.interface.actuators) * (1 + 1e-9)
LIMITS = Limits(5, STAGE.interface.bad_samples, SLEW, "A/s", "as declared")


@pytest.fixture(scope="module")
def refused() -> Failure:
    return replace(test_failure.fail(np.nan), contradicted=0)


def failing(f: Failure, kind: str, limits: Limits = LIMITS, seen: bool = True) -> set[str]:
    return {c.name for c in failure_experiments.checks([f], kind, limits, seen) if not c.passed}


def test_each_check_fails_for_its_defect(refused: Failure) -> None:
    late, sticks = replace(refused, sample=refused.sample - 1), replace(test_failure.fail(None), contradicted=None)
    assert failing(refused, NAN) == failing(refused, "zero") == set()
    assert failing(late, NAN) == {"samples until the latch"}
    assert failing(replace(refused, sample=refused.sample + 1), NAN) == {"samples with a fault before the failure"}
    assert failing(sticks, "stuck") == {"channels whose failure is not noticed"}
    assert failing(sticks, "stuck", seen=False) == set()
    assert failing(refused, NAN, replace(LIMITS, slew=0.0)) <= {"change of a current from the latch on"}
    early = replace(refused, contradicted=-9)
    assert failing(early, "zero") == {
        "samples from a residual out of bounds to the channel's name, braking or the latch",
        "samples from a residual out of bounds to the latch",
    }


def test_figures_are_those_of_the_failures(refused: Failure) -> None:
    one = failure_experiments.by_sensor(TEXTS, [refused], (), lambda f: {"further": 1.0})
    assert one.figures[f"samples until {refused.sensor} is named"] == 0 and one.figures["further"] == 1
    assert one.about == f"each sensor; shown is {refused.sensor}" and one.trajectory is refused.run
    unseen = replace(test_failure.fail(None), contradicted=None)
    both = failure_experiments.survey(TEXTS, [refused, unseen], LIMITS)
    assert both.figures["runs"] == 2 and both.figures["with a residual out of its bound, %"] == 50
    assert both.figures["largest excursion of undetected failures, um"] == 1e6 * unseen.excursion
