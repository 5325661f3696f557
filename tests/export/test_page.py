"""The pages on Linux and on the bench, from the empty folder on: their commands and examples run as they stand."""

import os
import subprocess
import sys
from pathlib import Path
from time import monotonic

import pytest

from docs import pages
from tests.export import harness

PAGE, BENCH = (
    (harness.ROOT / "docs" / "howto" / name).read_text(encoding="utf-8")
    for name in ("export-linux.md", "tune-on-the-bench.md")
)


def scripts(page: str) -> list[str]:
    """Return the commands of a page, block by block."""
    return [part.split("```\n", 1)[0] for part in page.split("```sh\n")[1:]]


def run(script: str, folder: Path, environ: dict[str, str]) -> subprocess.CompletedProcess[str]:
    command = ["bash", "-e", "-m", "-c", script]
    done = subprocess.run(command, cwd=folder, env=environ, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout[-3000:] + done.stderr[-3000:]
    return done


def look(page: str, loop: Path) -> str:
    """Run the example of a page beside its record; return what it prints."""
    ((name, text),) = pages.blocks(page, "python")
    (loop / name).write_text(text)
    environ = {**os.environ, "PYTHONPATH": str(harness.ROOT)}
    done = subprocess.run([sys.executable, name], cwd=loop, env=environ, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout


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
    script = "".join(scripts(PAGE))
    assert script.startswith("synth new my_stage\n") and "kill %1" in script
    done = run(script, tmp_path, environment(tmp_path))
    shown = PAGE.split("```text\n")[1].split("```", 1)[0].splitlines()
    printed = [line for line in (done.stdout + done.stderr).splitlines() if line in shown]
    assert sorted(printed) == sorted(shown)
    units, reach = look(PAGE, tmp_path / "my_stage" / "loop").splitlines()
    assert units.startswith("{'t': 's', 'z': 'm', 'z_ref': 'm', 'i': 'A'")
    assert 140 < float(reach.split()[-2]) < 160, "the move to 100 um and the sine of 50 um"


@pytest.mark.slow
@pytest.mark.whole
def test_the_commands_lead_to_a_gain_that_is_tuned_on_the_running_loop(tmp_path: Path) -> None:
    new, *others = scripts(BENCH)
    environ, begun = environment(tmp_path), monotonic()
    run(new, tmp_path, environ)
    workspace = tmp_path / "my_stage"
    pages.apply(BENCH, workspace)
    done = run("".join(others), workspace, environ)
    assert monotonic() - begun < 300, "of the 15 minutes, most are for reading"
    shown = BENCH.split("```text\n")[1].split("```", 1)[0]
    assert shown in done.stdout
    assert look(BENCH, workspace / "loop") == "3 sets, changes of 200 samples\n"
    refused = subprocess.run(
        ["synth", "tune", "my_stage", "--set", "bandwidth=140", "--write", "no.txt"], cwd=workspace, env=environ
    )
    assert refused.returncode == 1 and not (workspace / "no.txt").exists()
