"""The workspace and the command line: designs found, refused with the mend, and driven as a user would."""

import json
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from synth import workspace
from synth.cli import app
from synth.errors import DesignError

ROOT = Path(__file__).parents[1]
RUNNER = CliRunner()


@pytest.fixture
def root(monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    monkeypatch.chdir(ROOT)
    yield ROOT


@pytest.mark.slow
def test_designs_are_found_by_name() -> None:
    known = ["hall_position", "maglev_5dof", "planar_6dof_leadlag", "planar_6dof_lqg"]
    assert [d.name for d in workspace.designs(ROOT)] == known
    with pytest.raises(DesignError, match=f"'other' is not here: there are {', '.join(known)}"):
        workspace.designs(ROOT, ["other"])


def test_a_folder_without_designs_is_refused(tmp_path: Path) -> None:
    with pytest.raises(DesignError, match="call synth in the root of a workspace"):
        workspace.designs(tmp_path)


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
    from designs.maglev_5dof import experiments

    monkeypatch.setattr(experiments, "Y_LIMITS", (0.01, np.inf, 4.0))
    result = RUNNER.invoke(app, ["simulate", "maglev_5dof", "--json"])
    assert result.exit_code == 1
    assert "Infinity" not in result.stdout
    failed = [c for e in json.loads(result.stdout)[0]["experiments"] for c in e["checks"] if not c["passed"]]
    assert {c["name"] for c in failed} == {"overshoot"}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["verify", "other"], "other"),
        (["emit", "maglev_5dof"], "--out"),
        (["emit", "maglev_5dof", "--out", "README.md"], "README"),
    ],
)
def test_wrong_usage_is_exit_status_2_in_one_line(arguments: list[str], told: str) -> None:
    command = [sys.executable, "-c", "from synth.cli import main; main()", *arguments]
    result = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert result.returncode == 2
    assert told in result.stderr and "Traceback" not in result.stderr


@pytest.mark.slow
def test_emit_writes_the_other_scalar_type(root: Path, tmp_path: Path) -> None:
    arguments = ["emit", "maglev_5dof", "--scalar", "float64", "--out", str(tmp_path)]
    assert RUNNER.invoke(app, arguments).exit_code == 0
    manifest = json.loads((tmp_path / "maglev_5dof" / "manifest.json").read_text())
    assert manifest["scalar"] == "float64" and manifest["structs"]["input"]["size"] == 88
    wrong = RUNNER.invoke(app, ["emit", "maglev_5dof", "--scalar", "float16", "--out", str(tmp_path)])
    assert wrong.exit_code == 2
