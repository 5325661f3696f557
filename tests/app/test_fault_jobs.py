"""`synth faults` in a workspace: one document, the same for any number of processes, and its exit status."""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from synth.app import commands, fault_jobs, standard_tasks, workspace
from synth.base import jobs, store
from synth.base.progress import Lines
from synth.declare.fault_campaign import FaultCampaign, FaultLimit, read_safe_output
from synth.errors import DesignError, SignalError
from synth.simulate.faults import fault_table
from tests import levitator

NAME = "levitator_pid"
SHORT_RUNS = FaultCampaign(period_s=0.2, settle_s=0.1, watch_s=0.2, onsets=1)

pytestmark = pytest.mark.slow


def enter_workspace(monkeypatch: pytest.MonkeyPatch, *limits: FaultLimit, **fields: Any) -> None:
    """Enter the workspace of the levitator and shorten its fault campaign."""
    module = levitator.design(NAME)
    faulty = replace(module.DESIGN, faults=replace(SHORT_RUNS, limits=limits, **fields))
    monkeypatch.setattr(module, "DESIGN", faulty)
    monkeypatch.chdir(levitator.FOLDER)


def test_the_document_does_not_depend_on_the_number_of_processes(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    enter_workspace(monkeypatch)
    lines: list[str] = []
    documents = []
    for processes in (1, 3):
        monkeypatch.setenv("SYNTH_CACHE", str(tmp_path / str(processes)))
        (design,) = workspace.designs(levitator.FOLDER, [NAME])
        parts = fault_jobs.parts(design, 2)
        outcomes = jobs.run(fault_jobs.jobs(design, parts), Lines(lambda about, line: lines.append(line)), processes)
        documents.append(fault_jobs.result(design, parts, outcomes).document())
    assert documents[0] == documents[1] and documents[0]["can_tell"] and len(documents[0]["rows"]) == 107 * 2
    assert "faults of sensor z" in lines and "faults of actuator i2" in lines


@pytest.mark.parametrize(("most", "status"), [(2e-3, 0), (1e-4, 1)])
def test_the_exit_status_is_that_of_the_limits(
    most: float, status: int, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    enter_workspace(monkeypatch, FaultLimit("latch_s", most, kind="not finite", duration="permanent"))
    assert commands.faults([NAME], True, False, 1, False) == status
    (document,) = json.loads(capsys.readouterr().out)
    assert [check["passed"] for check in document["checks"]] == [status == 0, True, True]


def test_a_build_runs_the_basic_faults_and_judges_their_limits(monkeypatch: pytest.MonkeyPatch) -> None:
    def judge(*limits: FaultLimit) -> fault_table.Campaign:
        enter_workspace(monkeypatch, *limits)
        (design,) = workspace.designs(levitator.FOLDER, [NAME])
        return fault_jobs.result(design, fault_jobs.basic(design))

    latch, offset = FaultLimit("latch_s", 1e-4, kind="not finite"), FaultLimit("impact", 0.0, kind="offset")
    result = judge(latch, offset)
    faults = {(row.target, row.kind, row.duration) for row in result.rows}
    assert faults == {
        *((name, kind, "permanent") for name in "zx" for kind in ("not finite", "frozen")),
        *((name, "dead", "permanent") for name in ("i1", "i2")),
        ("calls", "missing", "permanent"),
    }
    assert [check.passed for check in result.checks] == [False, True, True]  # of the latch, and the negative control
    assert fault_table.notes(result)[0].startswith("faults: 7 of the 107 of the interface; `synth faults")
    with pytest.raises(SignalError, match="matches no fault"):
        judge(FaultLimit("impact", 0.0, kind="offsets"))


def test_the_table_has_the_worst_rows_and_the_control(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    enter_workspace(monkeypatch)
    assert commands.faults([NAME], False, False, 1, True) == 0
    printed = capsys.readouterr().out
    assert "worst of 1 plants" in printed and "calls missing" in printed and "negative control" in printed


def test_a_sweep_adds_tolerated_times_and_magnitudes(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    enter_workspace(monkeypatch)
    assert commands.faults([NAME], False, False, 1, True, True) == 0
    printed = capsys.readouterr().out
    assert "unlimited" in printed and "noticed from" in printed


def test_an_interrupted_campaign_continues_with_the_chunks_that_are_stored(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """The chunks of a first run are read; a changed limit changes none of them, a changed magnitude all."""
    monkeypatch.setenv("SYNTH_CACHE", str(tmp_path))
    monkeypatch.delenv(store.FRESH, raising=False)

    def chunks_computed(*limits: FaultLimit, **fields: Any) -> int:
        enter_workspace(monkeypatch, *limits, **fields)
        (design,) = workspace.designs(levitator.FOLDER, [NAME])
        lines: list[str] = []
        parts = fault_jobs.parts(design, 1)
        jobs.run(fault_jobs.jobs(design, parts), Lines(lambda about, line: lines.append(line)))
        return len([line for line in lines if line.startswith("faults of")])

    whole = chunks_computed()
    assert whole > 10 and chunks_computed(FaultLimit("false_alarms", 0.0)) == 0
    (tmp_path / "results").rename(tmp_path / "all")
    assert chunks_computed() == whole
    chunks = [path for path in (tmp_path / "results").glob("??/*") if b"FaultRun" in path.read_bytes()]
    chunks[0].unlink()
    assert 0 < chunks_computed() < whole / 2
    assert chunks_computed(offset=0.03) == whole
    with store.fresh_run():
        assert chunks_computed(offset=0.03) == whole


def test_a_design_without_a_loop_is_refused() -> None:
    (design,) = workspace.designs(Path(__file__).parents[2], ["hall_position"])
    with pytest.raises(DesignError, match="closes no loop"):
        fault_jobs.parts(design, 1)


def test_the_measured_safe_output_goes_to_datasheet_and_manifest(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Written, read and quoted; the runs do not depend on what is quoted."""
    enter_workspace(monkeypatch)
    (design,) = workspace.designs(levitator.FOLDER, [NAME])
    (tmp_path / "designs" / NAME).mkdir(parents=True)
    monkeypatch.setattr(workspace, "designs", lambda *_: [design])
    monkeypatch.chdir(tmp_path)
    assert commands.measure_safe_output([NAME], False, False, 2) == 0
    measured = read_safe_output(tmp_path / "designs" / NAME / commands.SAFE_OUTPUT)
    assert measured is not None and (measured.plants, measured.runs, measured.latched) == (2, 8, 8)
    assert 0.02 < measured.impacts["at rest"]["z"] < 0.06
    assert measured.text() in " ".join(capsys.readouterr().out.split())
    quoting = replace(design, safe_output=measured)
    files = standard_tasks.emit(quoting, design.scalar)[NAME]
    assert all(clause in files.files[f"{NAME}.md"] for clause in measured.text().split("; "))
    assert measured.text() in files.manifest["safety"]["safe_output_effect"]
    parts = fault_jobs.losses(design, 2)
    assert fault_jobs.safe_output(quoting, parts) == measured


def test_a_file_with_other_figures_is_refused(tmp_path: Path) -> None:
    path = tmp_path / commands.SAFE_OUTPUT
    assert read_safe_output(path) is None
    path.write_text('{"speed": 1}', encoding="utf-8")
    with pytest.raises(DesignError, match="need figures: write them by `synth faults NAME --write`"):
        read_safe_output(path)
