"""The studies as a whole: what they promise of calibrated units holds, and their document tells it all."""

import json
from dataclasses import replace
from math import inf
from pathlib import Path

import numpy as np
import pytest

from studies.hall import __main__ as command
from studies.hall import costs, page, results
from studies.hall.calibrated import survey
from studies.hall.costs import Row
from studies.hall.loop import experiments, four_experiments
from studies.hall.pages import integrity
from studies.hall.trust import endurance
from synth.base import progress
from synth.check import Check
from synth.simulate.experiments import Experiment
from synth.simulate.scenario import Trajectory

pytestmark = pytest.mark.whole

CHECK = Check("cold starts a pitch off", 0.0, 0.0, "1")
RUN = Experiment(
    "rest",
    "At rest",
    "",
    Trajectory(np.arange(2) / 800, {}, {}, {}, {}, {}, np.zeros(2, np.uint32), {}),
    (),
    figures={"true motion, mm": 4.0},
    checks=(replace(CHECK, at_least=True), replace(CHECK, name="shown", limit=inf)),
)
ROW = Row("3 sensors", "gcc -O2", 600, 3795, 7225)


def test_calibrated_units_keep_what_the_headers_promise() -> None:
    """Availability and wrong samples after a fault with gains that drift, deviations, and cold starts."""
    checks = survey.checks(progress.silent)
    assert len(checks) > 50 and [c.name for c in checks if not c.passed] == []


def test_the_document_has_each_figure_with_its_limit_and_no_verdict() -> None:
    document = results.document("2026-01-31", "abc1234", {"units": [CHECK]}, [RUN], [ROW])
    assert (document["date"], document["revision"]) == ("2026-01-31", "abc1234")
    assert document["figures"][:4] == [
        {"study": "units", "figure": CHECK.name, "value": 0.0, "unit": "1", "at_most": 0.0},
        {"study": "At rest", "figure": "true motion, mm", "value": 4.0, "unit": ""},
        {"study": "At rest", "figure": CHECK.name, "value": 0.0, "unit": "1", "at_least": 0.0},
        {"study": "At rest", "figure": "shown", "value": 0.0, "unit": "1"},
    ]
    assert [f["value"] for f in document["figures"][4:]] == [3795, 7225]


@pytest.mark.parametrize("value", [0.0, 1.0])
def test_a_check_that_fails_fails_the_command(
    value: float, monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The planted defect: a body a pitch off."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(command, "RESULTS", tmp_path / "results.json")
    monkeypatch.setattr(endurance, "checks", lambda *_: [])
    monkeypatch.setattr(survey, "checks", lambda _: [replace(CHECK, value=value)])
    for module, name in ((experiments, "run"), (experiments, "compare_sources"), (four_experiments, "run")):
        monkeypatch.setattr(module, name, lambda _: [])
    for module, name in ((integrity, "tables"), (costs, "measure")):
        monkeypatch.setattr(module, name, lambda _: ())
    monkeypatch.setattr(page, "report", lambda *_: "<html>")
    assert command.run("2026-01-31", "abc1234") == (value == 0)
    assert (CHECK.name in capsys.readouterr().out) == (value != 0)
    assert json.loads((tmp_path / "results.json").read_text())["revision"] == "abc1234"
    assert (tmp_path / command.PAGE).read_text() == "<html>"
