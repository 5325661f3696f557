"""Tests that need a tool, where it is missing: one with a mark skips and says what it shows, another fails by its name.

All of them have marks, so that `pytest -m tools` runs them: no test looks for a command by itself.
"""

import re
import subprocess
import sys
from pathlib import Path

import pytest

from synth.verify import meter
from tests import ceilings, tools

ROOT = Path(__file__).parents[1]
SKIPS = re.compile(r"\b(?:skipif|skip|importorskip)\(")
# What a test may lack besides commands: a flag or a kernel of the processor, a package that a cluster needs, a compiler
# of the version that was measured.
OTHER_SKIPS = {
    "tests/ceilings.py",
    "tests/conftest.py",
    "tests/designs/maglev_5dof/test_faults.py",
    "tests/execute/test_compile.py",
    "tests/test_kernels.py",
    "tests/app/test_study_jobs.py",
    "tests/export/test_linuxcnc.py",  # namespaces of root
    "tests/export/harness.py",  # Linux, another user, glibc
    "tests/export/test_machine.py",
    "tests/export/test_protocol.py",
}
PLANTED = """
import pytest
from benchmarks import axes
from tests import ceilings, tools
from synth.verify import meter, steps
from synth.execute import cross

SOURCE = {"f.c": "float f(float x); float f(float x) { return x; }"}

def test_without_a_mark():
    cross.link(SOURCE, ["f"], "cortex-m4f", "gcc")

def test_ceiling():
    ceilings.of("planar_6dof_lqg", ceilings.BUILDS[ceilings.O2])

@tools.needs_arm_gcc
def test_with_a_mark():
    cross.link(SOURCE, ["f"], "cortex-m4f", "gcc")

@pytest.mark.parametrize("compiler", tools.CROSS_COMPILERS)
def test_parameters(compiler):
    cross.objects(SOURCE, "cortex-m4f", compiler)
"""


@pytest.mark.slow
def test_a_planted_test_that_needs_gcc_for_arm_fails_with_its_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    planted = tmp_path / "test_planted.py"
    planted.write_text(PLANTED)
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setenv("COLUMNS", "300")
    command = [sys.executable, "-m", "pytest", "-rfs", "-p", "tests.conftest", "-p", "no:cacheprovider"]
    done = subprocess.run([*command, str(planted), "-c", "pyproject.toml"], cwd=ROOT, capture_output=True, text=True)
    failed = re.findall(r"^FAILED \S*::(\w+) - .*found no 'gcc'", done.stdout, re.M)
    assert failed == ["test_without_a_mark", "test_ceiling"], done.stdout
    assert f"arm-none-eabi-gcc not on the PATH, would show {tools.BY_GCC}" in done.stdout
    assert "2 failed, 1 passed, 2 skipped" in done.stdout


def test_another_version_of_a_compiler_skips_a_ceiling(monkeypatch: pytest.MonkeyPatch) -> None:
    zig = ceilings.BUILDS[ceilings.ZIG]
    monkeypatch.setitem(ceilings.VERSIONS, "zig", "clang version 9.0.1")
    with pytest.raises(pytest.skip.Exception, match=r"those of zig clang version 9\.0\.1, found clang version"):
        ceilings.of("sensing, predicted", zig)


def test_every_ceiling_is_of_a_build() -> None:
    assert set().union(*ceilings.CEILINGS.values()) <= {build.name for build in meter.BUILDS}


def test_tests_skip_by_their_marks() -> None:
    files = {path.relative_to(ROOT).as_posix(): path.read_text(encoding="utf-8") for path in ROOT.glob("tests/**/*.py")}
    skipping = {name for name, text in files.items() if name != "tests/test_tools.py" and SKIPS.search(text)}
    assert skipping == OTHER_SKIPS
