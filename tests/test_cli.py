"""The commands that measure and prove, on a small design: what they print, and how they end."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from benchmarks import axes
from synth import cli, workspace
from synth.check import Check
from synth.emit.write import Emitted
from synth.execute import cross, host
from synth.verify import on_target, prove, steps
from synth.verify.cost import Cost
from synth.verify.evidence import Evidence
from synth.verify.steps import Steps

RUNNER = CliRunner()
EMITTED = {scalar: {"axes_2": axes.emitted(2, scalar)} for scalar in (np.float32, np.float64)}


def replay(controller: host.Controller) -> dict[str, Any]:
    q1 = np.where(np.arange(200) < 150, 0.001, np.nan)
    return {"q1": q1, "q2": 0.002 * np.sin(0.05 * np.arange(200)), "r1": 0.0, "r2": 0.0}


def sequences(controller: host.Controller, told: workspace.Told) -> list[Steps]:
    return [steps.recorded(controller, "loop", replay(controller), closed_loop=True), steps.drawn(controller, 2000)]


class Reports(list[Cost | None]):
    """The costs that were reported."""

    def report(self, files: Mapping[str, Emitted], evidence: Evidence, runs: Any, rows: Any, cost: Cost | None) -> str:
        self.append(cost)
        return "<html></html>"


@pytest.fixture
def reports(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Reports:
    """A workspace of one design, and a folder to write in."""
    found = Reports()
    design = workspace.Design(
        name="axes_2",
        scalar=np.float32,
        emit=EMITTED.__getitem__,
        verify=lambda told, whole: Evidence("axes_2", (), (Check("replay", 0, 0, "1"),)),
        simulate=lambda told: (),
        audit=lambda: iter(()),
        bench=workspace.Bench(lambda: axes.block(2), replay, sequences, 1.0),
        report=found.report,
    )
    monkeypatch.setattr(workspace, "designs", lambda root, wanted: [design])
    monkeypatch.chdir(tmp_path)
    return found


def printed(*arguments: str, status: int = 0) -> list[dict[str, Any]]:
    result = RUNNER.invoke(cli.app, [*arguments, "--json"])
    assert result.exit_code == status, (result.output, result.exception)
    return list(json.loads(result.stdout))


@pytest.mark.usefixtures("reports")
def test_cost_prints_one_document() -> None:
    (document,) = printed("cost")
    assert document["design"] == "axes_2" and "not cycles" in document["note"]
    assert {f["generator"] for f in document["compared"]} == {"synth", "casadi", "casadi, float"}
    assert {m["name"] for m in document["sequences"]} == {"loop", "random states and inputs"}
    assert document["coverage"] and document["operations"]["mul"] > 0 and document["absent"]


@pytest.mark.usefixtures("reports")
def test_cost_prints_tables() -> None:
    result = RUNNER.invoke(cli.app, ["cost"])
    assert result.exit_code == 0, result.output
    for said in ("Instructions, not cycles", "seen both ways", "casadi, float", "RAM in all", "not measured"):
        assert said in " ".join(result.stdout.split()), said


@pytest.mark.usefixtures("reports")
@pytest.mark.parametrize(("core", "scalar"), [("cortex-m4f", "float32"), ("cortex-m7", "float64")])
def test_verify_on_a_target(core: str, scalar: str) -> None:
    (document,) = printed("verify", "--target", core)
    assert document["target"] == core and all(c["passed"] for c in document["checks"])
    assert all(c["name"].startswith(core) for c in document["checks"]) and len(document["checks"]) >= 3
    assert (document["drift"] is None) == ("gcc" not in cross.available())


@pytest.mark.usefixtures("reports")
def test_a_core_that_differs_is_exit_status_1(monkeypatch: pytest.MonkeyPatch) -> None:
    def differs(emitted: Emitted, inputs: Any, core: str, told: workspace.Told) -> Sequence[Check]:
        return (Check("outputs with other bits", 3, 0, "values", "i1 3 times"),)

    monkeypatch.setattr(on_target, "verify", differs)
    (document,) = printed("verify", "--target", "cortex-m4f", status=1)
    assert [c["passed"] for c in document["checks"]] == [False]
    said = RUNNER.invoke(cli.app, ["verify", "--target", "cortex-m4f"]).stdout
    assert "FAILED" in said and "outputs with other bits: i1 3 times" in said


@pytest.mark.usefixtures("reports")
def test_verify_without_a_target_compares_the_witnesses() -> None:
    (document,) = printed("verify")
    assert [c["name"] for c in document["checks"]] == ["replay"] and "target" not in document


@pytest.mark.usefixtures("reports")
def test_an_unknown_core_is_wrong_usage() -> None:
    result = RUNNER.invoke(cli.app, ["verify", "--target", "cortex-m0"])
    assert result.exit_code == 2 and "cortex-m4f, cortex-m7" in " ".join(result.stderr.split())


@pytest.mark.usefixtures("reports")
@pytest.mark.parametrize(("arguments", "whole"), [((), False), (("--whole",), True)])
@pytest.mark.parametrize("found", [0, 1])
def test_prove_tells_the_depth_and_fails_with_a_check(
    monkeypatch: pytest.MonkeyPatch, arguments: tuple[str, ...], whole: bool, found: int
) -> None:
    """The proofs have tests of their own; here they are handed what was emitted."""

    def proofs(files: Mapping[str, str], manifest: Any, deep: bool, told: workspace.Told) -> tuple[Check, ...]:
        assert files["axes_2.c"] and manifest["design"] == "axes_2" and deep == whole
        return (Check("alarms", found, 0, "alarms"),)

    monkeypatch.setattr(prove, "prove", proofs)
    (document,) = printed("prove", *arguments, status=found)
    assert (document["design"], document["whole"]) == ("axes_2", whole)
    assert document["checks"][0]["found"] == found


@pytest.mark.usefixtures("reports")
@pytest.mark.parametrize("arguments", [("cost",), ("verify", "--target", "cortex-m7")])
def test_a_missing_emulator_is_named_with_the_mend(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], arguments: tuple[str, ...]
) -> None:
    monkeypatch.setattr(cli, "EMULATOR", ("unicorn", "no_such_package"))
    monkeypatch.setattr("sys.argv", ["synth", *arguments])
    with pytest.raises(SystemExit) as ended:
        cli.main()
    assert ended.value.code == 2
    assert "found no no_such_package" in (said := capsys.readouterr().err) and "synth-stage[target]" in said


def test_build_reports_the_cost(reports: Reports) -> None:
    result = RUNNER.invoke(cli.app, ["build"])
    assert result.exit_code == 0, result.output
    assert isinstance(reports[0], Cost) and reports[0].coverage and Path("generated_c/axes_2/axes_2.c").exists()


def test_build_goes_on_without_an_emulator(reports: Reports, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cli, "EMULATOR", ("no_such_package",))
    assert RUNNER.invoke(cli.app, ["build"]).exit_code == 0
    monkeypatch.undo()
    assert reports == [None]
