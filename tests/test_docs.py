"""What the documentation shows runs as it stands."""

import ast
import importlib
import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from synth import new
from synth.execute import compile as host_compiler

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"
FILE = re.compile(r"^```{code-block} \w+\n:caption: (\S+)\n\n(.*?^)```$", re.MULTILINE | re.DOTALL)
FENCE = re.compile(r"^```python\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def run(text: str) -> dict[str, Any]:
    """Run the examples of a page, one after the other, in one namespace; each last expression prints itself."""
    session: dict[str, Any] = {}
    for code in FENCE.findall(text):
        for node in ast.parse(code).body:
            if isinstance(node, ast.Expr):
                shown = eval(compile(ast.Expression(node.value), "example", "eval"), session)
                assert "object at 0x" not in repr(shown), f"{ast.unparse(node)} prints as {shown!r}"
            else:
                exec(compile(ast.Module([node], []), "example", "exec"), session)
    return session


def test_the_examples_of_the_library_run() -> None:
    session = run((DOCS / "library.md").read_text(encoding="utf-8"))
    assert session["gain"].K[0, 1] == pytest.approx(-507.24, abs=0.005)


def test_the_signs_are_those_that_are_told() -> None:
    """The page holds itself against python-control; what it names is there."""
    text = (DOCS / "coming-from.md").read_text(encoding="utf-8")
    run(text)
    for module, function in re.findall(r"`((?:analyse|synthesise)\.[a-z_.]+)\.([a-z_0-9]+)`", text):
        assert callable(getattr(importlib.import_module(f"synth.{module}"), function)), (module, function)


def test_the_tutorial_leads_to_a_verified_bearing(tmp_path: Path) -> None:
    """Its files replace those of a new stage; that it shows all of them is what lets a reader follow it."""
    folder, written = new.create(tmp_path, "bearing")
    shown = dict(FILE.findall((DOCS / "tutorial.md").read_text(encoding="utf-8")))
    assert {Path(path) for path in shown} == {p for p in written if p.parts[0] in ("models", "designs")}
    for path, text in shown.items():
        (folder / path).write_text(text, encoding="utf-8")
    environment = {**os.environ, "PYTHONPATH": f"{ROOT}{os.pathsep}{folder}"}
    for command in (
        ["-c", "from synth.cli import main; main()", "build"],
        ["-m", "pytest", "-q", "-p", "no:cacheprovider"],
    ):
        done = subprocess.run([sys.executable, *command], cwd=folder, env=environment, capture_output=True, text=True)
        assert done.returncode == 0, done.stdout[-3000:] + done.stderr[-3000:]


STUBS = """
float read_position(void);
float read_position(void) { return 1e-4f; }
void write_current(float current);
void write_current(float current) { (void)current; }
int is_running(void);
int is_running(void) { static int left = 10; return left-- > 0; }
"""


def test_the_loops_in_c_compile_and_the_one_for_linux_runs(tmp_path: Path) -> None:
    folder, _ = new.create(tmp_path, "my_stage")
    environment = {**os.environ, "PYTHONPATH": f"{ROOT}{os.pathsep}{folder}"}
    emit = ["-c", "from synth.cli import main; main()", "emit", "my_stage", "--out", str(tmp_path)]
    subprocess.run([sys.executable, *emit], cwd=folder, env=environment, check=True)
    files = {name: (tmp_path / "my_stage" / name).read_text() for name in ("my_stage.c", "my_stage.h")}
    shown = dict(FILE.findall((DOCS / "howto" / "call-the-c.md").read_text(encoding="utf-8")))
    for text in shown.values():
        host_compiler.check({**files, "loop.c": text})
    program = {**files, "loop.c": shown["linux.c"], "stubs.c": STUBS}
    run = host_compiler.build(program, ["-std=c99", "-O2"], "loop", host_compiler.find_compiler(), libraries=("-lm",))
    assert subprocess.run([str(run)], check=False, timeout=600).returncode == 0


def test_a_broken_example_is_noticed() -> None:
    with pytest.raises(NameError):
        run("text\n\n```python\nx = missing\n```\n")
