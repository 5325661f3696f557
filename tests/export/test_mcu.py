"""An exported project for a microcontroller: on QEMU's boards it passes its self-test and computes what the host does."""

import subprocess
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from synth.execute import host
from synth.export import project
from synth.simulate import closed_loop, rig
from tests import tools
from tests.export import harness

pytestmark = pytest.mark.slow

SAMPLES = 10000
CORES = ("cortex-m4", "cortex-m7")
REGULAR = ("levitator_2dof", "maglev_5dof")  # with and without a drive
WHOLE = ("maglev_5dof_precise", "planar_6dof_leadlag", "planar_6dof_lqg")
needs_board = tools.needs(
    tools.ARM_GCC, "qemu-system-arm", shows="that the exported image runs on QEMU's boards, bit for bit as on the host"
)


def export(name: str, folder: Path) -> Path:
    project.project(harness.stage(name), harness.emitted(name), "mcu").save(folder)
    return folder


def make(folder: Path, *words: str) -> str:
    """Run make in a project; return what it prints."""
    done = subprocess.run(["make", "-s", *words], cwd=folder, capture_output=True, text=True, timeout=1800)
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-4000:]
    return done.stdout + done.stderr


def boot(image: Path, *serial: str) -> subprocess.CompletedProcess[str]:
    """Run an image on the board of a Cortex-M4F to its end."""
    command = "qemu-system-arm -M mps2-an386 -nographic -monitor none -semihosting-config enable=on,target=native"
    words = [*command.split(), "-icount", "shift=0,sleep=off", "-serial", "stdio", *serial, "-kernel", str(image)]
    return subprocess.run(words, cwd=image.parent, capture_output=True, text=True, timeout=600)


@pytest.fixture(scope="session")
def image(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An image of the rehearsal of a few samples."""
    folder = export("levitator_2dof", tmp_path_factory.mktemp("mcu"))
    make(folder, "CFLAGS=-O2 -DSAMPLES=20u", "build/cortex-m4/rehearsal.elf")
    return folder / "build" / "cortex-m4" / "rehearsal.elf"


@needs_board
@pytest.mark.parametrize("core", CORES)
@pytest.mark.parametrize("name", [*REGULAR, *(pytest.param(n, marks=pytest.mark.whole) for n in WHOLE)])
def test_the_board_equals_the_simulation(name: str, core: str, tmp_path: Path) -> None:
    folder = export(name, tmp_path)
    printed = make(folder, f"CORE={core}", "WARNINGS=-Wall -Wextra -Wconversion -Wdouble-promotion -Werror", "all")
    printed += make(folder, f"CORE={core}", "rehearsal")
    assert "warning" not in printed and " 0 missed" in printed
    assert "self-test: 0 of " in printed and f"{SAMPLES} samples" in printed
    board = np.fromfile(folder / "rehearsal.bin", layout(name))
    assert len(board) == SAMPLES
    stage, code = harness.stage(name), harness.emitted(name)[name]
    # C libraries differ in the last bits of exp, sin, ...: the simulation takes those of the project, too.
    simulate = partial(closed_loop.simulate, flags=["-include", str(folder / "qemu" / "plant_math.h")])
    simulator = replace(rig.of_stage(stage, host.load(code.files, code.manifest)), simulate=simulate)
    noisy = [s for s in stage.interface.sensors if s.noise]
    normal = harness.normals(1, SAMPLES * len(noisy)).reshape(SAMPLES, len(noisy)).T
    noise = {s.name: s.noise * row for s, row in zip(noisy, normal, strict=True)}
    moved = {p.name: board["in"][p.name].astype(np.float64) for p in stage.interface.set_points}
    assert all(np.ptp(column) > 0 for column in moved.values())
    run = simulator.run(SAMPLES * simulator.period_s, references=moved, **({"noise": noise} if noise else {}))
    np.testing.assert_array_equal(board["faults"], run.faults | run.status)
    driven = run.driven or run.commands
    for column in board.dtype["out"].names or ():
        if column in driven:
            np.testing.assert_array_equal(board["out"][column], np.float32(driven[column]), column)
    for sensor in stage.interface.sensors:
        np.testing.assert_array_equal(board["in"][sensor.name], np.float32(run.measured[sensor.name]), sensor.name)


def layout(name: str) -> np.dtype[np.void]:
    """Return the record of a sample: the input of the controller, the output of the last step, the fault word."""
    drive = harness.stage(name).drive
    last = drive.blocks[-1].name if drive else name
    manifests = {folder: code.manifest for folder, code in harness.emitted(name).items()}
    parts = host.dtype("input", manifests[name]), host.dtype("output", manifests[last])
    return np.dtype([("in", parts[0]), ("out", parts[1]), ("faults", "<u4")])
