"""The commands that measure and prove, on a small design: what they print, and how they end."""

import json
import os
import signal
import subprocess
import sys
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from synth.app import cli, standard_tasks, workspace
from synth.base.progress import Progress
from synth.check import Check
from synth.declare.stage import Stage
from synth.emit.c import manifest
from synth.emit.write import EmittedCode
from synth.errors import EmitError
from synth.execute import cross, host
from synth.simulate.experiments import Experiment
from synth.simulate.scenario import Trajectory
from synth.verify import replays
from synth.verify.agree import Agreement
from synth.verify.disagreement import Disagreement, Result
from synth.verify.proofs import prove
from synth.verify.suite import Evidence
from tests import levitator, tools

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[2]
RUNNER = CliRunner()
NAME = "levitator_pid"


def agree(of: Stage, report: Progress, whole: bool) -> Evidence:
    return Evidence(of.name, (), (Check("replay", 0, 0, "1"),))


# The cost and the proofs are measured on it; what it verifies and simulates is replaced, and has tests of its own.
PID = replace(levitator.design().DESIGN, verify=agree, experiments=(), operating_points={}, require={})
DOUBLES = replace(PID, scalar=np.float64)  # not measured, which takes most of the time of a build


def renamed(of: Stage, name: str) -> Stage:
    """Return a stage under another name."""
    return replace(of, controller=replace(of.controller, name=name))


@pytest.fixture(scope="module")
def cache(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A cache for these tests alone, empty at first: the same C is compiled once."""
    return tmp_path_factory.mktemp("cache")


@pytest.fixture
def one_design(monkeypatch: pytest.MonkeyPatch, tmp_path: Path, cache: Path) -> None:
    """A workspace of one design, and a folder to write in."""
    monkeypatch.setattr(workspace, "design_names", lambda root, selected: [PID.name])
    monkeypatch.setattr(workspace, "designs", lambda root, selected: [PID])
    monkeypatch.setenv("SYNTH_CACHE", str(cache))
    monkeypatch.chdir(tmp_path)
    Path("source").write_text(str(tmp_path))  # a build of this workspace is that of no other one in the cache


def printed(*arguments: str, status: int = 0) -> list[dict[str, Any]]:
    result = RUNNER.invoke(cli.app, [*arguments, "--json"])
    assert result.exit_code == status, (result.output, result.exception)
    return list(json.loads(result.stdout))


@pytest.mark.usefixtures("one_design")
def test_verify_prints_where_a_witness_differs(monkeypatch: pytest.MonkeyPatch) -> None:
    values, place = {"z": 1e-4}, "no variable of the reference equals 'i1_demand' of Block 'pid_z'"
    results = (Result("i1", 0.25, 0.25, -0.5),)
    where = Disagreement("random steps", "reference", 7, values, {"pid_z_v": 2.5}, results, (), (), (place,))
    agreement = Agreement("reference", "c64", "random steps", 9, 0.75, "i1", 7, 1.0, 0, 0.0, "", None, where)
    check = Check("random steps: reference against c64", 0.75, 1e-12, "1")

    def differs(of: Stage, report: Progress, whole: bool) -> Evidence:
        return Evidence(of.name, (agreement,), (check,))

    monkeypatch.setattr(workspace, "designs", lambda root, selected: [replace(PID, verify=differs)])
    said = RUNNER.invoke(cli.app, ["verify"])
    assert said.exit_code == 1
    assert all(text in said.stdout for text in (place, "sample 7", "pid_z_v", "-0.5", "0.0001"))
    (document,) = printed("verify", status=1)
    assert document["agreements"][0]["disagreement"]["states"] == {"pid_z_v": 2.5}


@pytest.mark.usefixtures("one_design")
@pytest.mark.parametrize("scalar", ["float32", "float64"])
def test_emit_writes_the_c_of_casadi_behind_the_same_header(tmp_path: Path, scalar: str) -> None:
    for folder, option in (("ours", []), ("theirs", ["--casadi"])):
        words = ["emit", "levitator_pid", "--out", str(tmp_path / folder), "--scalar", scalar, *option]
        assert RUNNER.invoke(cli.app, words).exit_code == 0
    ours, theirs = ({p.name: p.read_text() for p in (tmp_path / f / NAME).iterdir()} for f in ("ours", "theirs"))
    differing = {name for name in ours | theirs if ours.get(name) != theirs.get(name)}
    assert differing == {f"{NAME}.c", "manifest.json"}
    vectors, codes = (
        manifest.inputs(ours["vectors.json"]),
        [(c, json.loads(c["manifest.json"])) for c in (ours, theirs)],
    )
    first, second = (
        host.load({n: t for n, t in c.items() if n[-2:] in (".c", ".h")}, m).replay(vectors) for c, m in codes
    )
    assert (first.faults == second.faults).all() and first.faults.any()
    np.testing.assert_allclose(second.outputs["i1"], first.outputs["i1"], atol=1e-4)


@pytest.mark.usefixtures("one_design")
def test_emit_says_what_the_scalar_type_changes(tmp_path: Path) -> None:
    said = " ".join(RUNNER.invoke(cli.app, ["emit", NAME, "--out", str(tmp_path)]).output.split())
    assert "float32 changes DC gains by at most " in said
    assert "pid_z_integral: no z_held below 1.4e-08 m is integrated at the bound of pid_z_integral" in said


def test_a_stage_declares_how_far_a_dc_gain_may_change() -> None:
    with pytest.raises(EmitError, match=r"a change of 9\.9e-09 where 1e-12 is allowed"):
        standard_tasks.emit(replace(PID, gain_error=1e-12), np.float32)


@pytest.mark.usefixtures("one_design")
def test_cost_prints_one_document() -> None:
    (document,) = printed("cost")
    assert document["design"] == "levitator_pid" and "not cycles" in document["note"]
    assert {f["generator"] for f in document["compared"]} == {"synth", "casadi", "casadi, float"}
    assert {"faults in motion", "random states and inputs"} <= {m["name"] for m in document["sequences"]}
    assert document["coverage"] and document["operations"]["mul"] > 0 and document["absent"]


@pytest.mark.usefixtures("one_design")
def test_cost_prints_tables() -> None:
    result = RUNNER.invoke(cli.app, ["cost"])
    assert result.exit_code == 0, result.output
    for said in ("Instructions, not cycles", "seen both ways", "casadi, float", "RAM in all", "not measured"):
        assert said in " ".join(result.stdout.split()), said


@pytest.mark.usefixtures("one_design")
@tools.sees_more_with_tools
@pytest.mark.parametrize(("core", "scalar"), [("cortex-m4f", "float32"), ("cortex-m7", "float64")])
def test_verify_on_a_target(core: str, scalar: str) -> None:
    (document,) = printed("verify", "--target", core)
    assert document["target"] == core and all(c["passed"] for c in document["checks"])
    assert all(c["name"].startswith(core) for c in document["checks"]) and len(document["checks"]) >= 3
    assert (document["drift"] is None) == ("gcc" not in cross.available())


@pytest.mark.usefixtures("one_design")
def test_a_core_that_differs_is_exit_status_1(monkeypatch: pytest.MonkeyPatch) -> None:
    def differs(emitted: EmittedCode, inputs: Any, core: str, report: Progress) -> Sequence[Check]:
        return (Check("outputs that differ", 3, 0, "values", "i1 3 times"),)

    monkeypatch.setattr(replays, "verify", differs)
    (document,) = printed("verify", "--target", "cortex-m4f", status=1)
    assert [c["passed"] for c in document["checks"]] == [False]
    said = RUNNER.invoke(cli.app, ["verify", "--target", "cortex-m4f"]).stdout
    assert "FAILED" in said and "outputs that differ: i1 3 times" in said


@pytest.mark.usefixtures("one_design")
def test_verify_without_a_target_compares_the_witnesses() -> None:
    (document,) = printed("verify")
    assert [c["name"] for c in document["checks"]] == ["margins", "replay"] and "target" not in document


@pytest.mark.parametrize("option", ["--sweep", "--every"])
def test_measuring_the_safe_output_refuses_the_options_of_a_campaign(option: str) -> None:
    result = RUNNER.invoke(cli.app, ["faults", option, "--write"])
    assert result.exit_code == 2 and "leave out --every" in " ".join(result.stderr.split())


@pytest.mark.usefixtures("one_design")
def test_an_unknown_core_is_wrong_usage() -> None:
    result = RUNNER.invoke(cli.app, ["verify", "--target", "cortex-m0"])
    assert result.exit_code == 2 and "'cortex-m4f', 'cortex-m7'" in " ".join(result.stderr.split())


@pytest.mark.usefixtures("one_design")
def test_the_progress_of_prove_names_the_design_once(monkeypatch: pytest.MonkeyPatch) -> None:
    def proofs(files: Any, manifest: Any, deep: bool, report: Progress) -> tuple[Check, ...]:
        report("Eva")
        return ()

    monkeypatch.setattr(prove, "prove", proofs)
    emitted = standard_tasks.emit(PID, np.float32)[NAME]
    monkeypatch.setattr(standard_tasks, "emit", lambda of, scalar: dict.fromkeys((NAME, "currents"), emitted))
    lines = RUNNER.invoke(cli.app, ["prove", "--json"]).stderr.splitlines()
    assert [line for line in lines if "Eva" in line] == ["levitator_pid: Eva", "levitator_pid: currents: Eva"]


@pytest.mark.usefixtures("one_design")
@pytest.mark.parametrize(("arguments", "whole"), [((), False), (("--whole",), True)])
@pytest.mark.parametrize("alarms", [0, 1])
def test_prove_tells_the_depth_and_fails_with_a_check(
    monkeypatch: pytest.MonkeyPatch, arguments: tuple[str, ...], whole: bool, alarms: int
) -> None:
    """The proofs have tests of their own; here they are handed what was emitted."""

    def proofs(files: Mapping[str, str], manifest: Any, deep: bool, report: Progress) -> tuple[Check, ...]:
        assert files["levitator_pid.c"] and manifest["design"] == "levitator_pid" and deep == whole
        return (Check("alarms", alarms, 0, "alarms"),)

    monkeypatch.setattr(prove, "prove", proofs)
    (document,) = printed("prove", *arguments, status=alarms)
    assert (document["design"], document["whole"]) == ("levitator_pid", whole)
    assert document["checks"][0]["found"] == alarms


@pytest.mark.usefixtures("one_design")
def test_build_reports_the_cost() -> None:
    result = RUNNER.invoke(cli.app, ["build"])
    assert result.exit_code == 0, result.output
    assert "Not measured" not in Path("reports/levitator_pid.html").read_text()
    assert Path("generated_c/levitator_pid/levitator_pid.c").exists()


@pytest.mark.usefixtures("one_design")
def test_build_measures_no_cost_of_doubles(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(workspace, "designs", lambda root, selected: [DOUBLES])
    assert RUNNER.invoke(cli.app, ["build"]).exit_code == 0
    assert "Not measured" in Path("reports/levitator_pid.html").read_text()


def fail(of: Stage, report: Progress, whole: bool) -> Evidence:
    return Evidence("levitator_pid", (), (Check("replay", 2e-3, 1e-12, "A", "at step 7"), Check("latch", 0, 0, "1")))


@pytest.mark.usefixtures("one_design")
def test_build_prints_the_failed_checks_first_and_counts_them_last(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(workspace, "designs", lambda root, selected: [replace(DOUBLES, verify=fail)])
    result = RUNNER.invoke(cli.app, ["build"])
    lines = result.stdout.splitlines()
    (failed,) = (line for line in lines if "replay" in line)
    assert result.exit_code == 1 and "0.002 A" in failed and "missed" in failed
    assert result.stdout.index("replay") < result.stdout.index("latch") and "at step 7" in result.stdout
    last = " ".join(result.stdout.split())
    assert (
        "levitator_pid: 1 of 2 requirements missed; 9 values without a limit; report in reports/levitator_pid.html"
        in last
    )


def miss(of: Stage, report: Progress) -> list[Experiment]:
    zero = np.zeros(1)
    still = Trajectory(zero, {"z": zero}, {}, {}, {}, {}, zero.astype(np.uint32), {})
    return [
        Experiment("step", "z steps", "", still, ("z",), checks=(Check("overshoot", 0.3, 0.05, "1", "of the step"),))
    ]


@pytest.mark.usefixtures("one_design")
def test_the_evidence_file_does_not_pass_where_an_experiment_failed(monkeypatch: pytest.MonkeyPatch) -> None:
    """The file must say what the exit status and the last line say."""
    monkeypatch.setattr(standard_tasks, "simulate", miss)
    monkeypatch.setattr(standard_tasks, "with_headroom", lambda of, run: run)
    monkeypatch.setattr(workspace, "designs", lambda root, selected: [DOUBLES])
    result = RUNNER.invoke(cli.app, ["build"])
    evidence = json.loads(Path("reports/levitator_pid.evidence.json").read_text())
    failed = [c["about"] for c in evidence["checks"] if not c["passed"]]
    assert result.exit_code == 1 and evidence["passed"] is False and failed == ["z steps: of the step"]
    limited = [c for c in evidence["checks"] if c["limit"] is not None]
    assert f"levitator_pid: 1 of {len(limited)} requirements missed" in result.stdout


def crash(of: Stage, report: Progress, whole: bool) -> Evidence:
    raise ZeroDivisionError("planted")


def die(of: Stage, report: Progress, whole: bool) -> Evidence:
    os.kill(os.getpid(), signal.SIGKILL)
    raise AssertionError


@pytest.mark.usefixtures("one_design")
@pytest.mark.parametrize(("verify", "status", "message"), [(crash, 1, "planted"), (die, 2, "status -9")])
def test_a_crash_in_one_design_is_reported_and_the_others_finish(
    monkeypatch: pytest.MonkeyPatch, verify: Any, status: int, message: str
) -> None:
    """An error of a part is a failed check; a process that dies leaves none."""
    designs = [replace(renamed(PID, "levitator_other"), verify=verify), PID]
    monkeypatch.setattr(workspace, "designs", lambda root, selected: designs)
    result = RUNNER.invoke(cli.app, ["verify", "--json"])
    documents = {document["design"]: document for document in json.loads(result.stdout)}
    assert result.exit_code == status and documents["levitator_pid"]["passed"]
    assert message in json.dumps(documents["levitator_other"]) and not documents["levitator_other"].get("passed")


@pytest.mark.usefixtures("one_design")
def test_lines_of_progress_are_whole_and_named(monkeypatch: pytest.MonkeyPatch) -> None:
    def verify(of: Stage, report: Progress, whole: bool) -> Evidence:
        for k in range(50):
            report(f"step {k} of a long line that another process must not cut")
        return Evidence(of.name, (), ())

    names = ("levitator_other", "levitator_pid")
    designs = [replace(renamed(PID, name), verify=verify) for name in names]
    monkeypatch.setattr(workspace, "designs", lambda root, selected: designs)
    said = RUNNER.invoke(cli.app, ["verify", "--json"]).stderr.splitlines()
    lines = [line for line in said if not line.endswith(": margins: unchanged")]  # there are none
    expected = [
        f"{name}: step {k} of a long line that another process must not cut" for name in names for k in range(50)
    ]
    assert sorted(lines) == sorted(expected)


def test_help_and_completion_load_nothing_heavy() -> None:
    """The help answers at once: what a command needs is imported when it runs."""
    script = (
        "import sys\nfrom typer.testing import CliRunner\nfrom synth.app import cli\n"
        "assert CliRunner().invoke(cli.app, ['build', '--help']).exit_code == 0\n"
        "assert cli._complete('no_such') == []\n"
        "print(sorted({'numpy', 'scipy', 'casadi', 'matplotlib', 'control', 'sympy'} & set(sys.modules)))"
    )
    run = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert run.stdout.strip() == "[]"


def test_every_command_has_an_example_in_its_help() -> None:
    assert cli.app.registered_commands
    for command in cli.app.registered_commands:
        assert command.callback is not None
        result = RUNNER.invoke(cli.app, [command.callback.__name__, "--help"])
        assert f"Example: synth {command.callback.__name__} my_stage" in " ".join(result.stdout.split())
    assert "Example: synth new my_stage" in RUNNER.invoke(cli.app, ["--help"]).stdout


@pytest.mark.parametrize(("words", "completed"), [("synth emit le", ["lens", "lever"]), ("synth sim", ["simulate"])])
def test_the_shell_completes_commands_and_designs(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, words: str, completed: list[str]
) -> None:
    for name in ("lens", "lever", "mirror"):
        (tmp_path / "designs" / name).mkdir(parents=True)
        (tmp_path / "designs" / name / "design.py").touch()
    script = "import sys; sys.argv = ['synth']; from synth.app.cli import main; main()"
    asked = {"_SYNTH_COMPLETE": "complete_bash", "COMP_WORDS": words, "COMP_CWORD": str(words.count(" "))}
    environment = {**os.environ, **asked, "PYTHONPATH": str(ROOT)}
    command = [sys.executable, "-c", script]
    ended = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=True)
    assert ended.stdout.split() == completed


def test_names_are_completed_from_the_workspace(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    for name in ("lens", "lever", "mirror"):
        (tmp_path / "designs" / name).mkdir(parents=True)
        (tmp_path / "designs" / name / "design.py").touch()
    monkeypatch.chdir(tmp_path)
    assert cli._complete("le") == ["lens", "lever"] and cli._complete("") == ["lens", "lever", "mirror"]
