"""No verdict of a build can be lost: planted defects of every part are failed checks, and the exit status is 1."""

import json
import shutil
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any, NoReturn

import numpy as np
import pytest

from synth.app import builds, commands, verdicts, workspace
from synth.app.tasks import attempt
from synth.base import store
from synth.base.progress import silent
from synth.declare.experiments import Run
from synth.declare.fault_campaign import FaultCampaign, StudyLimits
from synth.declare.stage import Stage
from synth.errors import DesignError
from synth.report.audit import Printed, Published, Row, Verdict
from synth.simulate.experiments import Experiment
from synth.simulate.faults import campaign
from synth.simulate.integration import Integration
from synth.simulate.rig import Rig
from synth.simulate.study import StudyTable
from synth.stage import consistency
from synth.verify import standard
from synth.verify.suite import Evidence
from tests import levitator

ROOT = Path(__file__).parents[2]
NAME = "levitator_pid"
DESIGNS = sorted(path.parent.name for path in (ROOT / "designs").glob("*/design.py"))
SHORT = FaultCampaign(period_s=0.2, settle_s=0.1, watch_s=0.2, onsets=1)
PUBLISHED = Published("P-1", "P", "p. 1", "1.0", {"value": Printed("1.0", "1")})


@dataclass(frozen=True)
class Planted:
    """An experiment with a defect."""

    name: str

    def run(self, rig: Rig) -> Experiment:
        """Raise, raise on other machines than the nominal one, or return an empty run."""
        run = rig.run(0.02)
        nominal = rig.plant.parameters == levitator.design(NAME).PLANT.parameters
        if self.name == "raises" or (self.name == "raises_elsewhere" and not nominal):
            raise ZeroDivisionError("planted")
        if self.name == "empty":
            fields = {n: {k: v[:0] for k, v in getattr(run, n).items()} for n in ("states", "outputs", "measured")}
            run = replace(run, time=run.time[:0], faults=run.faults[:0], **fields)
        return Experiment(self.name, self.name, "", run, ("z",))


def cheap_evidence(stage: Any, say: Any, whole: bool) -> Evidence:
    """Verify as a design does whose own task checks nothing."""
    return Evidence(stage.name, (), ())


def crash(*_: Any, **__: Any) -> NoReturn:
    raise ZeroDivisionError("planted")


def audit_row(why: str = "a reason") -> Row:
    return Row(PUBLISHED, (), Verdict.FAILS, why)


def rows_then_crash(of: Stage) -> Iterator[Row]:
    yield audit_row()
    crash()


def variant(**fields: Any) -> Stage:
    """Return the design, in double, whose own verification checks nothing, for other declarations."""
    made = levitator.design(NAME).DESIGN  # in double its cost is not measured
    return replace(made, **{"faults": SHORT, "scalar": np.float64, "verify": cheap_evidence, **fields})


def build(
    design: Stage, folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> tuple[int, dict[str, dict[str, Any]], str]:
    """Return the exit status of `synth build`, the checks of the evidence by name, and the page."""
    shutil.copytree(levitator.FOLDER, folder / "workspace")
    monkeypatch.chdir(folder / "workspace")
    monkeypatch.setenv("SYNTH_CACHE", str(folder / "cache"))
    monkeypatch.delenv(store.FRESH, raising=False)
    monkeypatch.setattr(levitator.design(NAME), "DESIGN", design)
    status = commands.build([NAME], True, False)
    capsys.readouterr()
    evidence = json.loads((folder / f"workspace/reports/{NAME}.evidence.json").read_text())
    html = (folder / f"workspace/reports/{NAME}.html").read_text()
    return status, {c["name"]: c for c in evidence["checks"]}, html


def failed(checks: Mapping[str, Mapping[str, Any]]) -> dict[str, str]:
    return {name: c["about"] for name, c in checks.items() if not c["passed"]}


@pytest.mark.slow
def test_a_sound_design_passes_and_says_what_has_no_limit(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    status, checks, _ = build(variant(study=StudyLimits(0.5)), tmp_path, monkeypatch, capsys)
    assert status == 0 and not failed(checks)
    verdict = {name: c["verdict"] for name, c in checks.items()}
    assert verdict["phase margin"] == verdict["modulus margin"] == verdict[verdicts.YIELD] == "ok"
    assert verdict["disk margin"] == verdict["impact: every fault"] == verdict[verdicts.INSTRUCTIONS] == "no limit"
    assert checks["disk margin"]["limit"] is None and checks["disk margin"]["found"] > 0
    assert checks["largest |state| / bound"]["found"] > 0 and checks[verdicts.WITHOUT_RESULT]["found"] == 0


@pytest.mark.slow
def test_each_part_that_raises_is_a_failed_check_and_the_others_go_on(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    inject = campaign.inject

    def fail_for_x(rig: Any, plant: Any, condition: Any, injection: Any, *others: Any) -> Any:
        return crash() if injection.target == "x" else inject(rig, plant, condition, injection, *others)

    monkeypatch.setattr(campaign, "inject", fail_for_x)
    experiments = levitator.design(NAME).DESIGN.experiments
    planted = [*experiments, *map(Planted, ("raises", "raises_elsewhere", "empty"))]
    design = variant(experiments=planted, require={"phase_margin": 89.0, "disk_margin": 1.5})
    design = replace(design, verify=crash, audit=rows_then_crash, contents=crash)
    status, checks, html = build(design, tmp_path, monkeypatch, capsys)
    errors = failed(checks)
    assert status == 1
    assert "ZeroDivisionError: planted" in errors["errors of verification"]
    assert "ZeroDivisionError: planted" in errors["errors of experiment raises"]
    assert "raises_elsewhere on machine 1: ZeroDivisionError: planted" in errors[verdicts.WITHOUT_RESULT]
    assert errors["samples of empty"] == "the run is empty"
    assert "after row P-1; ZeroDivisionError" in errors["errors of audit"]
    assert {"errors of the contents of the report", "phase margin", "disk margin"} <= errors.keys()
    of_faults = [about for name, about in errors.items() if name.startswith("errors of faults ")]
    assert of_faults and all(about.startswith("x ") for about in of_faults)
    assert checks["settles"]["passed"] and checks[verdicts.UNEXPLAINED]["passed"], "the others did not go on"
    assert "errors of experiment raises" in html and "errors of the contents of the report" in html


def test_what_raised_an_error_is_not_cached(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SYNTH_CACHE", str(tmp_path / "cache"))
    monkeypatch.delenv(store.FRESH, raising=False)
    calls: list[str] = []

    def unlucky(of: Stage, say: Any, whole: bool) -> Evidence:
        calls.append("")
        return crash() if len(calls) == 1 else Evidence(NAME, (), ())

    design = replace(variant(operating_points={}, require={}), verify=unlucky)
    for lost in (True, False):
        evidence, errors = attempt(partial(builds.verify, design, False, silent), "verification", None)
        assert bool(errors) is lost and evidence.passed is not lost


@pytest.mark.whole
@pytest.mark.slow
@pytest.mark.parametrize("name", DESIGNS)
def test_no_design_loses_a_requirement(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Planted: an impossible margin in each design, whatever it does for its own verification."""
    monkeypatch.chdir(ROOT)
    (design,) = workspace.designs(ROOT, [name])
    points, loops = dict([*design.operating_points.items()][:1]), design.loops
    stage = replace(
        design,
        require={"phase_margin": 179.0, "delay_margin": 1.0},
        operating_points=points,
        loops=(lambda stage: loops(stage)[:1]) if loops else None,
    )
    evidence = builds.verify(replace(stage, verify=cheap_evidence), False, silent)
    checks = {c.name: c for c in evidence.checks}
    assert not evidence.passed and not checks["phase margin"].passed and not checks["delay margin"].passed
    free = verdicts.margins(replace(stage, require={}), evidence.loops)
    assert all(c.verdict == "no limit" for c in free if c.name != standard.LOST), "a margin without a limit has none"


@pytest.mark.slow
def test_the_commands_fail_where_a_requirement_does(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """`synth verify`, `margins`, `simulate`, `faults` and `audit`, each for its part."""
    monkeypatch.chdir(levitator.FOLDER)
    monkeypatch.setenv("SYNTH_CACHE", str(tmp_path / "cache"))
    design = variant(experiments=[Planted("raises")], require={"phase_margin": 89.0})
    monkeypatch.setattr(levitator.design(NAME), "DESIGN", replace(design, audit=rows_then_crash))
    monkeypatch.setattr(campaign, "inject", crash)
    for command, arguments, word in (
        (commands.verify, (None,), "phase margin"),
        (commands.margins, (), "phase margin"),
        (commands.simulate, (), "errors of experiment raises"),
        (commands.audit, (), "errors of audit"),
        (commands.faults, (1, False), "errors of faults at rest"),
    ):
        assert command([NAME], True, False, *arguments) == 1, command.__name__  # type: ignore[operator]
        assert word in capsys.readouterr().out


@pytest.mark.slow
def test_margins_need_no_reference_and_say_first_that_a_loop_is_unstable(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(levitator.FOLDER)
    monkeypatch.setenv("SYNTH_CACHE", str(tmp_path / "cache"))
    sound = variant(reference=None)
    K = sound.plant.parameter("K").value
    unstable = variant(reference=None, plant=sound.plant.with_parameters(K=10 * K))
    for design, status, first in ((sound, 0, f"{NAME}: stable in "), (unstable, 1, f"{NAME}: UNSTABLE at ")):
        monkeypatch.setattr(levitator.design(NAME), "DESIGN", design)
        assert commands.margins([NAME], False, False) == status
        assert capsys.readouterr().out.startswith(first)
    assert commands.simulate([NAME], False, False) in (1, 2)
    assert capsys.readouterr().out.startswith(f"{NAME}: UNSTABLE at ")
    monkeypatch.setattr(verdicts, "closed_loops", crash)
    assert commands.simulate([NAME], True, False) == 1
    assert "errors of stability" in capsys.readouterr().out


def test_a_figure_that_differs_without_a_reason_fails() -> None:
    assert not verdicts.audit([audit_row(), audit_row(" ")])[0].passed and verdicts.audit([audit_row()])[0].passed
    assert not verdicts.audit([])


def test_a_limit_of_the_study_takes_the_place_of_the_nominal_one() -> None:
    stage = variant(study=StudyLimits(0.9, {"step_z_ref: *": 2.0}))
    table = studied([0.1, 1.5, 1.6])
    assert verdicts.study(stage, table)[-1].value == 0.0, "with the nominal limits no machine passes"
    limited = verdicts.with_limits(stage, table)
    assert [c.passed for c in verdicts.study(stage, limited)] == [True, True, True]
    crashed = replace(limited, errors=((2, "step_z_ref", "planted"),))
    assert [c.passed for c in verdicts.study(stage, crashed)] == [True, False, False]
    coarse = replace(limited, integration=Integration(1, 1e-3))
    assert [c.passed for c in verdicts.study(stage, coarse)] == [False, True, True]
    assert "or give first an experiment whose loop settles" in verdicts.study(stage, coarse)[0].about
    assert not verdicts.study(stage, None)[0].passed, "a declared yield needs a study"
    with pytest.raises(DesignError, match=r"for 'step_z_ref: stl\*', but its checks are step_z_ref: settles"):
        verdicts.with_limits(variant(study=StudyLimits(limits={"step_z_ref: stl*": 1.0})), table)
    with pytest.raises(DesignError, match=r"study: 'stp: \*' names no experiment: .* one of z_ref, x_ref"):
        consistency.require_consistent(variant(study=StudyLimits(limits={"stp: *": 1.0})))


@pytest.mark.parametrize("study", [StudyLimits(experiments=("drfit*",)), StudyLimits(limits={"drfit*: reach": 1.0})])
def test_a_pattern_of_the_study_that_names_no_run_is_refused(study: StudyLimits) -> None:
    drift = Run("drift", lambda rig, name: None)
    known = variant(study=StudyLimits(limits={"drift: *": 1.0}, experiments=("z_*",)), runs=lambda: [drift])
    assert drift in known.all_experiments
    with pytest.raises(DesignError, match=r"study: 'drfit\*.*' names no experiment: .* one of z_ref, x_ref, drift"):
        replace(known, study=study).all_experiments  # noqa: B018


def studied(values: Sequence[float]) -> StudyTable:
    checks = {"step_z_ref: settles": np.array(values)}
    limits, units = {"step_z_ref: settles": 0.3}, {"step_z_ref: settles": "s"}
    return StudyTable(np.arange(len(values)), {}, {}, checks, limits, units, Integration(1, 0.0))


def test_instructions_have_a_ceiling_where_one_is_declared() -> None:
    class Measured:
        core, most, compared = "cortex-m4f", {"zig": 900, "gcc": 1100}, ()

    free, limited = variant(), variant(most_instructions=1000.0)
    assert verdicts.cost(free, Measured())[0].verdict == "no limit"  # type: ignore[arg-type]
    assert verdicts.cost(limited, Measured())[0].verdict == "FAILED"  # type: ignore[arg-type]
