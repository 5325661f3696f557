"""An exported project for a microcontroller passes its self-test on QEMU and computes what the host does, bitwise."""

import subprocess
from dataclasses import replace
from functools import partial
from itertools import product
from pathlib import Path

import numpy as np
import pytest

from synth.execute import host
from synth.export import project
from synth.simulate import closed_loop, rig
from tests import tools
from tests.export import harness, test_page

pytestmark = pytest.mark.slow

SAMPLES = 10000
CORES = ("cortex-m4", "cortex-m7")
NAMES = (
    "levitator_2dof", "maglev_5dof", "maglev_5dof_precise", "planar_6dof_leadlag", "planar_6dof_lqg", "hall_position",
)  # fmt: skip
REGULAR = (("levitator_2dof", "cortex-m4"), ("levitator_2dof", "cortex-m7"), ("maglev_5dof", "cortex-m7"))
needs_board = tools.needs(
    tools.ARM_GCC, "qemu-system-arm", shows="that the exported image runs on QEMU's boards, bit for bit as on the host"
)


def export(name: str, folder: Path) -> Path:
    project.project(harness.stage(name), harness.emitted(name), "mcu").save(folder)
    return folder


def boot(image: Path, *serial: str) -> subprocess.CompletedProcess[str]:
    """Run an image on the board of a Cortex-M4F to its end."""
    command = "qemu-system-arm -M mps2-an386 -nographic -monitor none -semihosting-config enable=on,target=native"
    words = [*command.split(), "-icount", "shift=0,sleep=off", "-serial", "stdio", *serial, "-kernel", str(image)]
    return subprocess.run(words, cwd=image.parent, capture_output=True, text=True, timeout=600)


@pytest.fixture(scope="session")
def image(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An image of the rehearsal of a few samples."""
    folder = export("levitator_2dof", tmp_path_factory.mktemp("mcu"))
    harness.make(folder, "-s", "CFLAGS=-O2 -DSAMPLES=20u", "build/cortex-m4/rehearsal.elf")
    return folder / "build" / "cortex-m4" / "rehearsal.elf"


@needs_board
@pytest.mark.parametrize(
    ("name", "core"),
    [p if p in REGULAR else pytest.param(*p, marks=pytest.mark.whole) for p in product(NAMES, CORES)],
)
def test_the_board_equals_the_simulation(name: str, core: str, tmp_path: Path) -> None:
    folder = export(name, tmp_path)
    printed = harness.make(
        folder, "-s", f"CORE={core}", "WARNINGS=-Wall -Wextra -Wconversion -Wdouble-promotion -Werror", "all"
    )
    printed += harness.make(folder, "-s", f"CORE={core}", "rehearsal")
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


@needs_board
@pytest.mark.parametrize("where", ["vectors_levitator_2dof", "levitator_2dof_step", "PLANT_PARAMETERS", "loop_sample"])
def test_a_flipped_bit_in_flash_is_found_at_boot(where: str, image: Path, tmp_path: Path) -> None:
    """In a vector, in the code of the step, in a constant of the plant, and in the code of the loop."""
    assert boot(image, "-serial", "null").returncode == 0
    content = bytearray(image.read_bytes())
    content[offset(image, symbol(image, where)) + 5] ^= 0x10
    (tmp_path / "flipped.elf").write_bytes(content)
    done = boot(tmp_path / "flipped.elf", "-serial", "null")
    assert done.returncode == 1 and "self-test: failed, the loop does not start" in done.stdout
    checksum, needed = done.stdout.splitlines()[0].removeprefix("flash: found ").split(", needs ")
    assert checksum != needed


@needs_board
def test_a_wrong_step_is_found_at_boot(tmp_path: Path) -> None:
    """A step that was changed before the checksum was made: the vectors find it."""
    folder = export("levitator_2dof", tmp_path)
    plant_wrong_step(folder)
    harness.make(folder, "-s", "build/cortex-m4/rehearsal.elf")
    done = boot(folder / "build" / "cortex-m4" / "rehearsal.elf", "-serial", "null")
    assert done.returncode == 1 and "self-test: the first is sample 700 of levitator_2dof" in done.stdout


def plant_wrong_step(folder: Path) -> None:
    """Let the step of the levitator add a bit to its first output from sample 700 on."""
    path = folder / "controller" / "levitator_2dof.c"
    wrong = (
        "\n#undef levitator_2dof_step\n"
        "uint32_t levitator_2dof_step(levitator_2dof_state_t *s, const levitator_2dof_input_t *in,"
        " levitator_2dof_output_t *out)\n"
        "{\n    static uint32_t k;\n    const uint32_t faults = levitator_2dof_right(s, in, out);\n"
        "    if (k++ >= 700u) out->i1 += 1e-6f;\n    return faults;\n}\n"
    )
    path.write_text("#define levitator_2dof_step levitator_2dof_right\n" + path.read_text() + wrong)


def symbol(image: Path, name: str) -> int:
    """Return the address of a symbol."""
    done = subprocess.run(["arm-none-eabi-nm", image], capture_output=True, text=True, check=True)
    return next(int(line.split()[0], 16) for line in done.stdout.splitlines() if line.split()[-1] == name)


def offset(image: Path, address: int) -> int:
    """Return where an address of the flash is in the file."""
    done = subprocess.run(["arm-none-eabi-objdump", "-h", image], capture_output=True, text=True, check=True)
    rows = [line.split() for line in done.stdout.splitlines()]
    size, start, at = next([int(v, 16) for v in (r[2], r[4], r[5])] for r in rows if len(r) > 5 and r[1] == ".text")
    assert start <= address < start + size
    return at + address - start


PAGE = (harness.ROOT / "docs" / "howto" / "export-mcu.md").read_text(encoding="utf-8")


@needs_board
@pytest.mark.whole
def test_the_commands_of_the_page_lead_to_a_rehearsed_image(tmp_path: Path) -> None:
    script, shown = (PAGE.split(f"```{kind}\n")[1].split("```", 1)[0] for kind in ("sh", "text"))
    environ = test_page.environment(tmp_path)
    done = subprocess.run(["bash", "-e", "-c", script], cwd=tmp_path, env=environ, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout[-3000:] + done.stderr[-3000:]
    assert script.startswith("synth new my_stage\n") and "needs 0x" in done.stdout
    assert [line for line in shown.splitlines()[1:] if line not in done.stdout.splitlines()] == []
