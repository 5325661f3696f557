"""The page on Linux, from the empty folder to a moving stage: its commands and its example run as they stand."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from docs import pages
from tests.export import harness

PAGE = (harness.ROOT / "docs" / "howto" / "export-linux.md").read_text(encoding="utf-8")
SCRIPT = "".join(part.split("```\n", 1)[0] for part in PAGE.split("```sh\n")[1:])


def environment(folder: Path) -> dict[str, str]:
    """Return an environment in which `synth` is that of this repository."""
    (folder / "bin").mkdir()
    command = folder / "bin" / "synth"
    command.write_text(f"#!/bin/sh\nexec {sys.executable} -c 'from synth.app.cli import main; main()' \"$@\"\n")
    command.chmod(0o755)
    path = {"PATH": f"{command.parent}{os.pathsep}{os.environ['PATH']}", "PYTHONPATH": f"{harness.ROOT}{os.pathsep}."}
    return {**os.environ, **path, "CC": harness.compiler(), "ZIG_GLOBAL_CACHE_DIR": harness.zig()}


@pytest.mark.slow
@pytest.mark.whole
def test_the_commands_lead_to_a_moving_stage(tmp_path: Path) -> None:
    assert SCRIPT.startswith("synth new my_stage\n") and "kill %1" in SCRIPT
    command = ["bash", "-e", "-m", "-c", SCRIPT]
    done = subprocess.run(command, cwd=tmp_path, env=environment(tmp_path), capture_output=True, text=True)
    assert done.returncode == 0, done.stdout[-3000:] + done.stderr[-3000:]
    shown = PAGE.split("```text\n")[1].split("```", 1)[0].splitlines()
    printed = [line for line in (done.stdout + done.stderr).splitlines() if line in shown]
    assert sorted(printed) == sorted(shown)
    ((name, text),) = pages.blocks(PAGE, "python")
    loop = tmp_path / "my_stage" / "loop"
    (loop / name).write_text(text)
    environ = {**os.environ, "PYTHONPATH": str(harness.ROOT)}
    done = subprocess.run([sys.executable, name], cwd=loop, env=environ, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    units, reach = done.stdout.splitlines()
    assert units.startswith("{'t': 's', 'z': 'm', 'z_ref': 'm', 'i': 'A'")
    assert 140 < float(reach.split()[-2]) < 160, "the move to 100 um and the sine of 50 um"
