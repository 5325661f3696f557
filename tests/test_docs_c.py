"""The loops in C that the documentation shows compile, and the one for Linux runs."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from docs import pages
from synth.app import commands
from synth.execute import compile as host_compiler
from tests import tools

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[1]
STUBS = """
float read_position(void);
float read_position(void) { return 1e-4f; }
void write_current(float current);
void write_current(float current) { (void)current; }
int is_running(void);
int is_running(void) { static int left = 10; return left-- > 0; }
"""
PAGE = (ROOT / "docs" / "howto" / "call-the-c.md").read_text(encoding="utf-8")
SHOWN = dict(pages.blocks(PAGE))
ARM = next(line for line in PAGE.splitlines() if line.startswith("arm-none-eabi-gcc")).split()
LINUX = next(line for line in PAGE.splitlines() if line.startswith("gcc ")).split()


@pytest.fixture(scope="module")
def emitted(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """The C of a new stage."""
    folder, _ = commands.create(tmp_path_factory.mktemp("workspace"), "my_stage")
    environment = {**os.environ, "PYTHONPATH": f"{ROOT}{os.pathsep}{folder}"}
    emit = ["-c", "from synth.app.cli import main; main()", "emit", "my_stage", "--out", str(folder / "out")]
    subprocess.run([sys.executable, *emit], cwd=folder, env=environment, check=True)
    return {name: (folder / "out" / "my_stage" / name).read_text() for name in ("my_stage.c", "my_stage.h")}


@pytest.mark.parametrize("name", sorted(SHOWN))
def test_a_loop_compiles_without_a_warning(name: str, emitted: dict[str, str]) -> None:
    host_compiler.check({**emitted, "loop.c": SHOWN[name]})


def test_the_loop_for_linux_runs_with_the_flags_of_the_page(emitted: dict[str, str]) -> None:
    """Without the right to a real-time priority it says so, and goes on."""
    flags = [word for word in LINUX[1:] if word.startswith(("-std", "-O", "-f"))]
    files = {**emitted, "loop.c": SHOWN["linux.c"], "stubs.c": STUBS}
    program = host_compiler.build(files, flags, "loop", host_compiler.find_compiler(), libraries=("-lm",))
    done = subprocess.run([str(program)], capture_output=True, text=True, timeout=600)
    assert done.returncode == 0 and "samples were late" in done.stdout


@pytest.mark.parametrize("compiler", tools.CROSS_COMPILERS)
def test_the_loop_for_bare_metal_compiles_with_the_flags_of_the_page(
    compiler: str, emitted: dict[str, str], tmp_path: Path
) -> None:
    """By gcc for Arm, and by clang of the ziglang wheel, which takes the core in its own way."""
    for name, text in {**emitted, "interrupt.c": SHOWN["interrupt.c"]}.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    flags = ["-std=c99", "-O2", "-fno-math-errno", "-ffp-contract=off", "-c"]
    zig = [sys.executable, "-m", "ziglang", "cc", "-target", "thumb-freestanding-eabihf", "-mcpu=cortex_m4"]
    command = ARM if compiler == "gcc" else [*zig, *flags, "interrupt.c"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
