"""A user's own stage in a bare workspace outside the repository: every command works on what a declaration gives."""

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import pytest

from tests import tools

ROOT = Path(__file__).parents[1]
NAME = "levitator_2dof"
MOST = 120  # lines of design and experiments

pytestmark = [pytest.mark.slow, pytest.mark.whole]


@pytest.fixture(scope="module")
def workspace(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the physics and this one design."""
    root = tmp_path_factory.mktemp("workspace")
    (root / "models").mkdir()
    shutil.copy(ROOT / "models" / "levitator.py", root / "models")
    shutil.copytree(ROOT / "designs" / NAME, root / "designs" / NAME)
    return root


def synth(workspace: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Run a command of the toolkit in a process of its own, in the workspace."""
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    command = [sys.executable, "-c", "from synth.app.cli import main; main()", *arguments]
    return subprocess.run(command, cwd=workspace, env=environment, capture_output=True, text=True, check=False)


def documents(workspace: Path, *arguments: str) -> list[dict]:
    ended = synth(workspace, *arguments, "--json")
    assert ended.returncode == 0, ended.stderr[-2000:] + ended.stdout[-2000:]
    return json.loads(ended.stdout)


def test_design_and_experiments_are_short() -> None:
    files = (ROOT / "designs" / NAME).glob("*.py")
    lines = {path.name: len(path.read_text(encoding="utf-8").splitlines()) for path in files}
    assert sum(n for name, n in lines.items() if name != "reference.py") <= MOST


def test_build_writes_c_evidence_and_report(workspace: Path) -> None:
    (built,) = documents(workspace, "build")
    assert built["design"] == NAME and built["checks"] > 50 and built["failed"] == []
    folder = workspace / "generated_c" / NAME
    assert {p.name for p in folder.iterdir()} == {
        *(f"{NAME}.c", f"{NAME}.h", f"{NAME}.md"),
        *("manifest.json", "gains.json", "vectors.json"),
    }
    page = (workspace / "reports" / f"{NAME}.html").read_text(encoding="utf-8")
    assert "<math" in page and "Loops and margins" in page
    gains = json.loads((folder / "gains.json").read_text())
    assert set(gains["design"]) >= {"z", "x"}


def test_simulate_tells_how_near_each_state_came_to_its_bound(workspace: Path) -> None:
    (document,) = documents(workspace, "simulate")
    for experiment in document["experiments"]:
        names = {c["name"]: c["passed"] for c in experiment["checks"]}
        assert names["largest |state| / bound"] is True, experiment["name"]


def test_verify_compares_all_witnesses_and_margins(workspace: Path) -> None:
    (document,) = documents(workspace, "verify")
    names = [c["name"] for c in document["checks"]]
    assert any("reference against c64" in n for n in names) and any("phase margin" in n for n in names)


PROVE = pytest.param(["prove"], marks=tools.needs(*tools.PROVERS, shows="that a user's own C is proved"))


@tools.sees_more_with_tools
@pytest.mark.parametrize("arguments", [["cost"], ["audit"], ["verify", "--target", "cortex-m4f"], PROVE])
def test_the_other_commands_work(workspace: Path, arguments: Sequence[str]) -> None:
    printed = documents(workspace, *arguments)
    assert isinstance(printed, list) and (printed or arguments == ["audit"])


def test_emit_writes_the_other_scalar_type(workspace: Path, tmp_path: Path) -> None:
    ended = synth(workspace, "emit", NAME, "--scalar", "float64", "--out", str(tmp_path))
    assert ended.returncode == 0, ended.stderr
    assert json.loads((tmp_path / NAME / "manifest.json").read_text())["scalar"] == "float64"


def test_its_own_tests_pass_once_it_is_committed(workspace: Path) -> None:
    """Three lines of pytest: regeneration, evidence, planted defects."""
    tests = workspace / "tests"
    tests.mkdir()
    (tests / "test_design.py").write_text(
        "import pytest\n"
        f"from designs.{NAME}.design import DESIGN\n"
        "from synth.testing import *\n\n"
        "@pytest.fixture(scope='session')\n"
        "def design():\n    return DESIGN\n",
        encoding="utf-8",
    )
    environment = {**os.environ, "PYTHONPATH": f"{ROOT}{os.pathsep}{workspace}"}
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "tests"]
    ended = subprocess.run(command, cwd=workspace, env=environment, capture_output=True, text=True, check=False)
    assert ended.returncode == 0, ended.stdout[-3000:]
    assert "5 passed" in ended.stdout
