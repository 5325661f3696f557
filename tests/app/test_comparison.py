"""`synth compare`: two laws of one plant on the same machines, and designs that do not compare."""

import json
import shutil
from dataclasses import replace
from pathlib import Path

import pytest

from synth.app import comparison, workspace
from synth.app.comparison import CompareChoice
from synth.base import jobs
from synth.base.progress import Lines
from synth.declare.stage import MARGINS, Stage
from synth.errors import DesignError
from synth.report import comparison as report
from synth.report import page
from synth.simulate.sampling import Sampling
from tests import levitator

pytestmark = pytest.mark.slow
NAMES = ("levitator_pid", "levitator_slow")
PLAN = Sampling(5, 3)


@pytest.fixture
def laws(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Path:
    """A workspace with the two PID laws and with them again, of a tenth of the integral gain of z."""
    for name in NAMES:
        folder = tmp_path / "designs" / name
        shutil.copytree(levitator.FOLDER / "designs" / NAMES[0], folder)
        for path in folder.glob("*.py"):
            text = path.read_text(encoding="utf-8").replace(NAMES[0], name)
            path.write_text(text.replace("3.4e4", "3.4e4" if name == NAMES[0] else "3.4e3"), encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_two_laws_run_on_the_same_machines(laws: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = laws / "comparison.html"
    assert comparison.compare(NAMES, True, False, CompareChoice(PLAN, ("z_*",), file)) == 0
    first, second = json.loads(capsys.readouterr().out)
    assert [first["design"], second["design"]] == [*NAMES] and first["rows"] == 5
    settled, slow = ({s["name"]: s for s in side["summaries"]}["z_ref: settles"] for side in (first, second))
    assert settled["worst"] < 0.3 and settled["passed"] == 1 and slow["passed"] == 0
    assert first["yield"]["share"] == 1 and second["yield"]["share"] == 0
    assert set(first["margins"]) == set(MARGINS)
    assert second["margins"]["gain_reduction"] > first["margins"]["gain_reduction"] > 1  # less integral action
    text = file.read_text(encoding="utf-8")
    assert not page.external_addresses(text)
    assert "z_ref: settles" in text and "disk margin" in text and "Mean instructions of a step" in text


def test_the_tables_fit_a_terminal(laws: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert comparison.compare(NAMES, False, False, CompareChoice(PLAN, ("z_*",), None)) == 0
    shown = capsys.readouterr().out
    assert "levitator_slow: 0 of 5 machines keep every limit" in shown and "x_ref: settles" not in shown


def loaded(*names: str) -> tuple[Stage, Stage]:
    first, second = (levitator.design(name).DESIGN for name in names)
    return first, second


def test_what_does_not_compare_is_refused() -> None:
    with pytest.raises(DesignError, match="with itself: name another design"):
        comparison.plan_of(loaded(NAMES[0], NAMES[0]), PLAN, ())
    first, second = loaded("levitator_2dof", NAMES[0])
    same_sensors = replace(first, tuning=None, controller=replace(second.controller, name="levitator_other"))
    with pytest.raises(DesignError, match="no experiment of the same name"):
        comparison.plan_of((same_sensors, second), PLAN, ())


def test_designs_of_other_machines_are_refused() -> None:
    first, second = loaded("levitator_2dof", NAMES[0])
    plant = first.plant
    for changed, reason in (({"tolerance": 0.0}, r"K = 20 \(\+- 0\)"), ({"value": 21.0}, r"K = 21 \(\+- 0.1\)")):
        parameters = tuple(replace(p, **changed) if p.name == "K" else p for p in plant.parameters)
        other = replace(first, plant=replace(plant, parameters=parameters))
        with pytest.raises(DesignError, match=rf"one has {reason} where the other has K = 20 \(\+- 0.1\)"):
            comparison.plan_of((other, second), PLAN, ())


def test_machines_drawn_in_another_order_are_refused() -> None:
    first, second = loaded("levitator_2dof", NAMES[0])
    plant = first.plant
    other = replace(first, plant=replace(plant, parameters=plant.parameters[::-1]))
    with pytest.raises(DesignError, match="do not run on the same machines: one has s = 400"):
        comparison.plan_of((other, second), PLAN, ())


def test_a_stage_without_operating_points_has_no_margins(laws: Path) -> None:
    first, second = (replace(d, operating_points={}) for d in (workspace.designs(laws, [n])[0] for n in NAMES))
    plan = comparison.plan_of((first, second), PLAN, ("z_*",))
    outcomes = jobs.run(comparison.jobs((first, second), plan), Lines(lambda about, line: None), 2)
    sides = comparison.sides_of((first, second), plan, outcomes)
    assert [side.margins for side in sides] == [{}, {}]
    assert "Least margins" in report.page_text(sides)
