"""The study in a report: which experiments it has, and how many machines."""

from dataclasses import dataclass, replace

import casadi as ca
import pytest

from synth.app import study_runs
from synth.base.progress import silent
from synth.report import sections as report
from synth.simulate.experiments import Experiment
from synth.simulate.rig import Rig
from tests import levitator

pytestmark = pytest.mark.slow


@dataclass(frozen=True)
class Disturbed:
    """A run under a disturbance, which lanes do not have."""

    name: str = "disturbed"

    def run(self, rig: Rig) -> Experiment:
        x, t = ca.SX.sym("x", len(rig.plant.states)), ca.SX.sym("t")
        disturbance = ca.Function("d", [x, t], [0 * x])
        return Experiment(self.name, "", "", replace(rig, disturbance=disturbance).run(0.01), (), {}, {})


def test_a_report_has_the_experiments_in_lanes_on_a_few_machines() -> None:
    stage = levitator.design().DESIGN
    disturbed = replace(stage, experiments=[*stage.experiments, Disturbed()])
    table = study_runs.brief(disturbed, silent)
    assert table is not None and len(table.rows) == study_runs.BRIEF
    assert {name.split(": ")[0] for name in table.checks} == {e.name for e in stage.experiments}
    text = report.page_text("levitator", table)
    assert f"of {study_runs.BRIEF} machines keep every limit" in text and "lower bound" in text
    assert study_runs.brief(replace(stage, experiments=[Disturbed()]), silent) is None
