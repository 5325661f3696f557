"""A new stage: what `synth new` writes builds, verifies and passes its tests at once, and nothing is overwritten."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from synth.app import commands
from synth.errors import SynthError

ROOT = Path(__file__).parents[2]


def run(folder: Path, *command: str) -> subprocess.CompletedProcess[str]:
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    return subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)


def synth(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    return run(folder, sys.executable, "-c", "from synth.app.cli import main; main()", *arguments)


@pytest.mark.slow
def test_two_new_stages_build_and_pass_their_own_tests(tmp_path: Path) -> None:
    """The first makes the workspace, the second joins it; their C differs in names alone."""
    made = synth(tmp_path, "new", "lens_focus")
    assert made.returncode == 0 and "Next: cd lens_focus && synth build" in made.stdout
    workspace = tmp_path / "lens_focus"
    assert "Next: synth build" in synth(workspace, "new", "mirror").stdout
    built = synth(workspace, "build", "--json")
    assert built.returncode == 0, built.stdout[-2000:] + built.stderr[-2000:]
    assert {d["design"]: d["failed"] for d in json.loads(built.stdout)} == {"lens_focus": [], "mirror": []}
    lens, mirror = ((workspace / f"generated_c/{n}/{n}.c").read_text().lower() for n in ("lens_focus", "mirror"))
    assert "".join(lens.replace("lens_focus", "mirror").split()) == "".join(mirror.split())
    tests = run(workspace, sys.executable, "-P", "-m", "pytest", "-q", "-p", "no:cacheprovider")
    assert tests.returncode == 0 and "10 passed" in tests.stdout, tests.stdout[-3000:]


def test_the_new_files_are_as_clean_as_this_repository(tmp_path: Path) -> None:
    folder, files = commands.create(tmp_path, "stage")
    assert all((folder / path).is_file() for path in files) and Path(".gitignore") in files
    settings = ("--config", str(ROOT / "pyproject.toml"), "--ignore", "I001")  # sorted as in a workspace of its own
    assert (ended := run(folder, sys.executable, "-m", "ruff", "check", *settings, ".")).returncode == 0, ended.stdout
    form = ("--config", str(ROOT / "pyproject.toml"), "--check")
    assert (ended := run(folder, sys.executable, "-m", "ruff", "format", *form, ".")).returncode == 0, ended.stdout


def test_the_new_workspace_installs_synth_from_a_clone(tmp_path: Path) -> None:
    """The package is on no index."""
    folder, _ = commands.create(tmp_path, "stage")
    for file, clone in (("README.md", "../synth"), (".github/workflows/ci.yml", "./.synth")):
        text = (folder / file).read_text()
        assert f"pip install {clone}\n" in text and "synth-stage" not in text


def test_the_gains_of_a_new_stage_know_a_damper(tmp_path: Path) -> None:
    """x'' = a x + c x' + b i under i = I - P x - D v, I' = -k x / T has its three poles at -W."""
    folder, _ = commands.create(tmp_path, "stage")
    model = folder / "models" / "stage.py"
    rate = '"vz": lift / p["M"] - p["g"]'
    assert rate in model.read_text()
    model.write_text(model.read_text().replace(rate, f'{rate} - 60.0 * x["vz"]'))
    script = (
        "import numpy as np\nfrom designs.stage import control\nfrom synth import analyse\n"
        "M = analyse.linearise(control.PLANT, analyse.trim(control.PLANT, {'z': 0.0}, ['i']))\n"
        "P, D, k = (c.value for c in control.gains()[:3])\n"
        "(a, c), b = M.A[1], M.B[1, 0]\nassert c == -60.0\n"
        "np.testing.assert_allclose([b * D - c, b * P - a, b * k / control.TIME.period_s], "
        "[3 * control.W, 3 * control.W**2, control.W**3])"
    )
    ended = run(folder, sys.executable, "-c", script)
    assert ended.returncode == 0, ended.stderr


@pytest.mark.parametrize("name", ["", "1a", "a-b", "../up", "My", "class", "int", "tests", "models", "é"])
def test_a_name_that_no_module_can_have_is_refused(tmp_path: Path, name: str) -> None:
    with pytest.raises(SynthError, match=r"cannot be the name of a module|no identifier of C"):
        commands.create(tmp_path, name)
    assert not list(tmp_path.iterdir())


def test_nothing_is_overwritten(tmp_path: Path) -> None:
    (tmp_path / "lens" / "models").mkdir(parents=True)
    mine = tmp_path / "lens" / "models" / "lens.py"
    mine.write_text("mine")
    with pytest.raises(SynthError, match=r"lens\.py exists already, and nothing was written"):
        commands.create(tmp_path, "lens")
    assert mine.read_text() == "mine" and [p.name for p in (tmp_path / "lens").rglob("*.*")] == ["lens.py"]


@pytest.mark.slow
def test_a_new_stage_starts_without_a_jolt(tmp_path: Path) -> None:
    """An integral that starts at 0 is the planted defect: P z of 3 A is asked for at once."""
    folder, _ = commands.create(tmp_path, "stage")
    script = (
        "import numpy as np\nfrom designs.stage.design import DESIGN\nfrom synth.app import standard_tasks\n"
        "rig = standard_tasks.rig(DESIGN, np.float32)\n"
        "print(abs(rig.run(0.01, {'z': 4e-4}).commands['i'][0]))"
    )
    asked = [float(run(folder, sys.executable, "-c", script).stdout)]
    law = folder / "designs" / "stage" / "control.py"
    text, start = law.read_text(), 'k["P"] * u[z.name])  # no jolt'
    assert text.count(start) == 1
    law.write_text(text.replace(start, "0.0)  # no jolt"))
    asked.append(float(run(folder, sys.executable, "-c", script).stdout))
    assert asked[0] < 1e-6 and asked[1] > 1.0
