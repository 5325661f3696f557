"""The workspace and the command line: designs found, refused with the mend, and driven as a user would."""

import json
import re
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from typer.testing import CliRunner

from synth.app import builds, workspace
from synth.app.cli import app
from synth.base import slices, store
from synth.base.progress import Progress
from synth.declare.stage import Stage
from synth.errors import DesignError
from synth.verify.suite import Evidence
from tests import levitator

ROOT = Path(__file__).parents[2]
RUNNER = CliRunner()


@pytest.fixture
def root(monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    monkeypatch.chdir(ROOT)
    yield ROOT


@pytest.mark.slow
def test_designs_are_found_by_name() -> None:
    known = sorted(path.parent.name for path in (ROOT / "designs").glob("*/design.py"))
    assert known and [d.name for d in workspace.designs(ROOT)] == known
    assert [d.name for d in workspace.designs(ROOT, known[:1])] == known[:1]
    with pytest.raises(DesignError, match=f"'other' is not in this workspace: it has {', '.join(known)}"):
        workspace.designs(ROOT, ["other"])


def test_outside_a_workspace_one_sentence_says_what_to_do(tmp_path: Path) -> None:
    with pytest.raises(DesignError, match=r"is not a workspace, .*: run `cd WORKSPACE`, or make .* `synth new NAME`$"):
        workspace.designs(tmp_path)
    (tmp_path / "designs").mkdir()
    with pytest.raises(DesignError, match=r"has no design yet, no designs/NAME/design.py: add one with `synth new N"):
        workspace.designs(tmp_path)
    (tmp_path / "reports").mkdir()
    with pytest.raises(DesignError, match=f"run `cd {tmp_path}`, or make"):
        workspace.designs(tmp_path / "reports")


@pytest.mark.slow
@pytest.mark.parametrize("command", ["build", "verify", "simulate", "audit", "prove", "emit stage --out out"])
def test_each_command_says_so_in_one_line(tmp_path: Path, command: str) -> None:
    script = [sys.executable, "-c", "from synth.app.cli import main; main()", *command.split()]
    ended = subprocess.run(script, cwd=tmp_path, capture_output=True, text=True)
    assert ended.returncode == 2 and ended.stderr.count("\n") == 1 and "synth new NAME" in ended.stderr, ended.stderr


def verify_nothing(of: Stage, say: Progress, whole: bool) -> Evidence:
    say("witnesses")
    return Evidence(of.name, (), ())


def design(name: str) -> Stage:
    """Return a stage under a name, in double, whose cost is not measured, without experiments and loops."""
    made = levitator.design().DESIGN
    bare = replace(made, experiments=(), operating_points={}, require={}, verify=verify_nothing, scalar=np.float64)
    return replace(bare, controller=replace(made.controller, name=name))


def test_a_design_under_another_name_than_its_folder_is_refused_at_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "designs/stage").mkdir(parents=True)
    (tmp_path / "designs/stage/design.py").touch()
    module = ModuleType("designs.stage.design")
    module.DESIGN = design("other")  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "designs.stage.design", module)
    monkeypatch.setattr(sys, "path", [*sys.path])
    with pytest.raises(DesignError, match=r"designs/stage/design.py has the name 'other': give it the name of its f"):
        workspace.designs(tmp_path)


def verify_broken(root: Path, text: str) -> subprocess.CompletedProcess[str]:
    """Run `synth verify` in a workspace whose design has this text."""
    (root / "designs/broken").mkdir(parents=True)
    (root / "designs/broken/design.py").write_text(text, encoding="utf-8")
    script = [sys.executable, "-c", "from synth.app.cli import main; main()", "verify"]
    return subprocess.run(script, cwd=root, capture_output=True, text=True)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("from synth.stage import Actuator\n\nActuator('i', 0.0)\n", "3: TypeError: .*'slew_per_s'"),
        ("import numpy as np\nnp.linalg.inv(np.zeros((2, 2)))\n", "2: LinAlgError: Singular matrix"),
        ("DESIGN = (\n", "1: SyntaxError: '\\(' was never closed"),
        ("import designs.broken.control\n", "1: ModuleNotFoundError: No module named 'designs.broken.control'"),
    ],
)
def test_an_error_in_a_design_is_one_line_with_its_place(tmp_path: Path, text: str, message: str) -> None:
    ended = verify_broken(tmp_path, text)
    assert ended.returncode == 2 and ended.stderr.count("\n") == 1, ended.stderr
    assert re.search(
        f"design 'broken' stops at .*design.py:{message}.*; for the traceback run `python -m", ended.stderr
    )


def test_an_error_inside_the_toolkit_keeps_its_traceback(tmp_path: Path) -> None:
    ended = verify_broken(tmp_path, "from synth.stage import compose\ncompose.errors(None, None, [])\n")
    assert ended.returncode == 1 and ended.stderr.startswith("Traceback") and "AttributeError" in ended.stderr


@pytest.mark.slow
def test_simulate_prints_one_document(root: Path) -> None:
    result = RUNNER.invoke(app, ["simulate", "maglev_5dof", "--json"])
    assert result.exit_code == 0, result.output
    (document,) = json.loads(result.stdout)
    names = {e["name"] for e in document["experiments"]}
    assert {"y_22_29", "x_30", "theta_10", "ellipse", "tracking", "lift_off", "set_down_18.1", "zero_current"} <= names
    assert all(c["passed"] for e in document["experiments"] for c in e["checks"])
    assert result.stderr.startswith("maglev_5dof: ")  # what is simulated, or that nothing has changed


@pytest.mark.slow
def test_a_failed_check_is_exit_status_1(root: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from designs.maglev import motions

    monkeypatch.setattr(motions, "BAND", 1e-9)  # m, rad: nothing settles into it
    result = RUNNER.invoke(app, ["simulate", "maglev_5dof", "--json"])
    assert result.exit_code == 1
    assert "Infinity" not in result.stdout
    failed = [c for e in json.loads(result.stdout)[0]["experiments"] for c in e["checks"] if not c["passed"]]
    assert {c["name"] for c in failed} == {"t_s", "true error in the last second"}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["verify", "other"], "other"),
        (["emit", "maglev_5dof"], "--out"),
        (["emit", "maglev_5dof", "--out", "README.md"], "README"),
    ],
)
def test_wrong_usage_is_exit_status_2_in_one_line(arguments: list[str], message: str) -> None:
    command = [sys.executable, "-c", "from synth.app.cli import main; main()", *arguments]
    result = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert result.returncode == 2
    assert message in result.stderr and "Traceback" not in result.stderr


@pytest.mark.slow
def test_emit_loads_nothing_that_draws_or_typesets(tmp_path: Path) -> None:
    """Nor python-control: all that is slow to import and not used for C."""
    script = (
        "import sys\nfrom synth.app import workspace\nfrom synth.app.cli import app\nfrom pathlib import Path\n"
        "heavy = {'matplotlib', 'sympy', 'control', 'rich.progress', 'markdown_it'}\n"
        "workspace.designs(Path.cwd())\nprint(heavy & set(sys.modules))\n"
        "app(['emit', 'maglev_5dof', '--out', sys.argv[1]], standalone_mode=False)\nprint(heavy & set(sys.modules))"
    )
    command = [sys.executable, "-c", script, str(tmp_path)]
    ended = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    before, *said, after = ended.stdout.splitlines()
    assert before == after == "set()" and (tmp_path / "maglev_5dof/maglev_5dof.c").exists()
    assert said[0].startswith("maglev_5dof: gains and C") and "maglev_5dof.c" in said[1]


@pytest.mark.slow
def test_emit_writes_the_other_scalar_type(root: Path, tmp_path: Path) -> None:
    arguments = ["emit", "maglev_5dof", "--scalar", "float64", "--out", str(tmp_path)]
    assert RUNNER.invoke(app, arguments).exit_code == 0
    manifest = json.loads((tmp_path / "maglev_5dof" / "manifest.json").read_text())
    assert manifest["scalar"] == "float64" and manifest["structs"]["input"]["size"] == 12 * 8
    wrong = RUNNER.invoke(app, ["emit", "maglev_5dof", "--scalar", "float16", "--out", str(tmp_path)])
    assert wrong.exit_code == 2


def test_a_fresh_build_runs_every_part_in_a_job_of_its_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Not all of them in the last job, unseen and one after the other, because older results are stored."""
    monkeypatch.setenv("SYNTH_CACHE", str(tmp_path / "cache"))
    monkeypatch.delenv(store.FRESH, raising=False)
    monkeypatch.chdir(tmp_path)

    made = design("stage")
    monkeypatch.setattr(workspace, "design_names", lambda *_: ["stage"])
    monkeypatch.setattr(workspace, "designs", lambda *_: [made])
    first, unchanged, fresh = (RUNNER.invoke(app, ["build", *option]).output for option in ((), (), ("--fresh",)))
    assert "stage: witnesses\n" in first and sorted(fresh.splitlines()) == sorted(first.splitlines())
    assert first.endswith(unchanged) and "stage: report" not in unchanged


def test_an_unchanged_build_imports_no_design_and_any_source_changes_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "models").mkdir()
    files = [tmp_path / "models/plant.py", tmp_path / "models/map.toml", tmp_path / "settings.json"]
    for file in files:
        file.write_text("x = 1\n")
    toolkit = tmp_path / "toolkit"
    toolkit.mkdir()
    monkeypatch.setattr(slices, "TOOLKIT", toolkit)
    files.append(toolkit / "emit.py")
    files[-1].write_text("y = 1\n")
    key = builds.source_key(tmp_path, "stage")
    for name in ("generated_c", "reports", "tests", ".git"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "written").write_text("z")
    assert builds.source_key(tmp_path, "stage") == key != builds.source_key(tmp_path, "other")
    for file in files:
        before = file.read_text()
        file.write_text(before + "# changed\n")
        assert builds.source_key(tmp_path, "stage") != key, file
        file.write_text(before)
    files[0].rename(tmp_path / "models/stage.py")
    assert builds.source_key(tmp_path, "stage") != key
