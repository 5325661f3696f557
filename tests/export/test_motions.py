"""The motions of an exported loop: a hold or a stop keeps their path and their limits."""

import os
import shlex
import signal
import subprocess
import time
from pathlib import Path

import numpy as np
import pytest

from synth.export import records
from tests.export import harness
from tests.export.test_machine import PLANT

pytestmark = pytest.mark.slow


def test_missed_periods_hold_a_motion_where_that_is_asked_for(loop: Path) -> None:
    with harness.running(loop, "--stall", "5000", "--late", "hold", "--motion", "sine z_ref 1e-4 1 600") as running:
        running.wait("phase=running")
        os.kill(running.child, signal.SIGSTOP)
        time.sleep(0.3)
        os.kill(running.child, signal.SIGCONT)
        running.wait("phase=running moving=0")


def test_a_hold_stays_on_the_path(loop: Path) -> None:
    with harness.running(loop, *PLANT, "--record", "run.csv") as running:
        running.wait("phase=running moving=0")
        assert running.ask("circle z_ref x_ref 2e-4 2 100") == "ok"
        running.wait("moving=1")
        time.sleep(0.8)
        assert "needs a running machine at rest" in running.ask("move z_ref 0")
        assert running.ask("hold") == "ok"
        running.wait("phase=running moving=0")
        assert running.ask("move z_ref 0 x_ref 0") == "ok"
        running.wait("z_ref=0 x_ref=0", "position")
    log = records.read(loop / "run.csv")
    radius = (log.samples["z_ref"] ** 2 + log.samples["x_ref"] ** 2) ** 0.5
    assert radius[log.samples["phase"] == 3].max() == pytest.approx(2e-4, rel=1e-3)


def test_a_stop_in_motion_brakes_first(loop: Path) -> None:
    with harness.running(loop, *PLANT, "--record", "run.csv") as running:
        running.wait("phase=running moving=0")
        assert running.ask("sine x_ref 2e-4 5 1000") == "ok"
        time.sleep(0.5)
        assert running.ask("stop") == "ok"
        running.wait("phase=disabled")
    assert "levitator_2dof: braking: a client asked for it\nlevitator_2dof: stopping" in running.log
    log = records.read(loop / "run.csv")
    braking = log.samples["phase"] == 4
    assert 0.35 < 5e-4 * np.count_nonzero(braking) <= 0.4
    speed = np.abs(np.diff(log.samples["x_ref"][braking]))
    assert speed[0] > 0 and np.all(speed[250:] == 0), "the set-point is at rest after 0.1 s"


def test_a_stop_that_a_hold_follows_still_brakes(loop: Path) -> None:
    with harness.running(loop, *PLANT, "--record", "run.csv") as running:
        running.wait("phase=running moving=0")
        assert running.ask("sine x_ref 2e-4 5 1000") == "ok"
        time.sleep(0.5)
        assert running.ask("stop") == "ok" and running.ask("hold") == "ok"
        running.wait("phase=disabled")
    log = records.read(loop / "run.csv")
    speed = np.abs(np.diff(log.samples["x_ref"][log.samples["phase"] == 4]))
    assert speed[0] > 0 and np.all(speed[250:] == 0)


def test_two_steps_in_a_row_are_measured_from_where_the_machine_settled(loop: Path) -> None:
    with harness.running(loop, *PLANT, "--record", "run.csv") as running:
        running.wait("phase=running moving=0")
        with running.connect() as connection:
            assert harness.ask(connection, "step z_ref 1e-4") == "ok"
            assert "needs a running machine at rest" in harness.ask(connection, "step z_ref -1e-4")
            harness.ask(connection, "hold")
            assert "needs a running machine at rest" in harness.ask(connection, "step z_ref -1e-4")
        running.wait("moving=0")
        assert running.ask("step z_ref 0") == "ok"
        running.wait("moving=0")
    log = records.read(loop / "run.csv")
    steps = np.flatnonzero(np.abs(np.diff(log.samples["z_ref"])) > 5e-5)
    assert len(steps) == 2 and np.diff(steps)[0] >= 599, "0.3 s"


@pytest.fixture(scope="module")
def motions(built: Path) -> Path:
    """A program of the machine alone, with a stage of large ranges."""
    sources = [
        Path(__file__).with_name("motions.c"),
        *(built / "src" / f"{n}.c" for n in ("machine", "motion", "rest", "tuning")),
        built / "controller" / "levitator_2dof.c",
    ]
    flags = ["-std=c99", "-D_GNU_SOURCE", "-Wall", "-Wextra", "-Werror", "-I", "src", "-I", "controller"]
    command = [*shlex.split(harness.compiler()), *flags, *map(str, sources), "-o", "motions", "-lm"]
    subprocess.run(command, cwd=built, check=True)
    return built / "motions"


@pytest.mark.parametrize(
    "motion",
    [
        "sine x_ref 0.095 1.37 6",
        "circle z_ref x_ref 0.095 1.37 2",
        "sine x_ref 0.0001 42 20",
        "move x_ref 0.09",
        "ramp x_ref 0.09 0.37",
        "zigzag x_ref 0.09 0.7 2",
    ],
)
def test_a_hold_or_a_stop_keeps_the_limit_of_the_acceleration(motion: str, motions: Path) -> None:
    done = subprocess.run([motions, *motion.split()], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout
    used, longest = map(float, done.stdout.split())
    assert used <= 1.02, "of the limit, in finite differences"
    assert 0.099 < longest < 0.2


def test_set_points_that_are_no_numbers_stay(motions: Path) -> None:
    assert subprocess.run([motions], capture_output=True, text=True).stdout == "0.05 -0.05\n"
