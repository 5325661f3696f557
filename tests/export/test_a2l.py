"""The A2L of a loop on a microcontroller: read by an independent parser, and every symbol is a member of the loop."""

import ctypes
import json
import re
import subprocess
from pathlib import Path

import numpy as np
import pytest

from tests import tools
from tests.export import harness
from tests.export.test_mcu import export
from tests.export.test_tuning import GAIN, set_text, values

pytestmark = pytest.mark.slow

NAME = "levitator_2dof"
SIZES = {"FLOAT32_IEEE": ("float", 4), "ULONG": ("uint32_t", 4)}


@pytest.fixture(scope="module")
def firmware(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return export(NAME, tmp_path_factory.mktemp("mcu"))


def test_a_law_without_a_bench_has_none(tmp_path: Path) -> None:
    assert not list(export("maglev_5dof", tmp_path).glob("*.a2l"))


def compiled(folder: Path, source: str, *flags: str) -> subprocess.CompletedProcess[str]:
    (folder / "probe.c").write_text(source)
    chosen = harness.host_compiler.find_compiler()
    words = [*chosen.command, *chosen.machine_flags, "-std=c11", "-Isrc", "-Icontroller", *flags, "probe.c"]
    return subprocess.run(words, cwd=folder, capture_output=True, text=True)


def links(text: str) -> list[tuple[str, str]]:
    """Return symbol and type of each object."""
    layouts = dict(re.findall(r"RECORD_LAYOUT (\w+)\n\s*FNC_VALUES 1 (\w+)", text))
    tuned = re.findall(r'CHARACTERISTIC .*\n\s*VALUE 0x0 (\w+) .*\n\s*SYMBOL_LINK "(.*)" 0', text)
    measured = re.findall(r'MEASUREMENT .*\n\s*(\w+) .*\n\s*ECU_ADDRESS 0x0\n\s*SYMBOL_LINK "(.*)" 0', text)
    return [*((symbol, layouts[layout]) for layout, symbol in tuned), *((symbol, t) for t, symbol in measured)]


@pytest.mark.parametrize(
    ("before", "after", "fits"), [("", "", True), ("in.z_ref", "in.z_reff", False), ("FLOAT32_IEEE", "ULONG", False)]
)
def test_every_symbol_is_a_member_of_the_loop(before: str, after: str, fits: bool, firmware: Path) -> None:
    """And a symbol of another name, and one of another type, is seen."""
    text = (firmware / f"{NAME}.a2l").read_text().replace(before, after)
    pairs = links(text)
    assert len(pairs) == text.count("SYMBOL_LINK") > 40
    tests = [f'_Static_assert(_Generic(({s}), {SIZES[t][0]}: 1, default: 0), "{s}");' for s, t in pairs]
    source = "\n".join(['#include "loop.h"', "static loop_t loop;", "int main(void)", "{", *tests, "}"])
    assert (compiled(firmware, source, "-c", "-o", "probe.o").returncode == 0) == fits


@tools.needs("pya2l", shows="that an independent parser reads the A2L, with the ranges of the constants")
def test_an_independent_parser_reads_it(firmware: Path, tmp_path: Path) -> None:
    file = tmp_path / "read.json"
    command = ["pya2l", "-c", str(firmware / f"{NAME}.a2l"), "to_json", "-o", str(file)]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    (module,) = json.loads(file.read_text())["PROJECT"]["MODULE"]
    fields = {f["name"]: f for f in harness.emitted(NAME)[NAME].manifest["structs"]["parameters"]["fields"]}
    tuned = {c["Name"]["Value"].removeprefix("parameters."): c for c in module["CHARACTERISTIC"]}
    assert tuned.keys() == {*fields} - {"check"} | {"commit"}
    units = {m["Name"]["Value"]: m["Unit"]["Value"] for m in module["COMPU_METHOD"]}
    for name, read in tuned.items():
        if name != "commit":
            ends = float(read["LowerLimit"]["Value"]), float(read["UpperLimit"]["Value"])
            assert ends == (fields[name]["low"], fields[name]["high"])
            assert units[read["Conversion"]["Value"]] == fields[name]["unit"]


IMAGE = """
unsigned int flash_begin, flash_end;
int start(unsigned int core_hz);
void _start(void);
void _start(void) { (void)start(168000000u); }
"""


@tools.needs("a2ltool", tools.ARM_GCC, shows="that the tool finds each object of the A2L in an image with the example")
@pytest.mark.parametrize(
    ("before", "after", "lost"), [("", "", 0), ('"loop.controller_in.z_ref"', '"loop.controller_in.z_reff"', 1)]
)
def test_the_addresses_are_found_in_an_image(before: str, after: str, lost: int, firmware: Path) -> None:
    """And an object whose symbol the image does not have is left out."""
    text = (firmware / f"{NAME}.a2l").read_text().replace(before, after)
    (firmware / "image.c").write_text(IMAGE)
    (firmware / "asked.a2l").write_text(text)
    core = ["-g", "-O1", "-mcpu=cortex-m4", "-mthumb", "-mfloat-abi=hard", "-mfpu=fpv4-sp-d16", "-Isrc", "-Icontroller"]
    sources = [*sorted(firmware.glob("src/*.c")), *sorted(firmware.glob("controller/*.c"))]
    sources += [firmware / n for n in ("example.c", "board_user.c", "image.c")]
    link = ["-nostartfiles", "--specs=nosys.specs", "-lm", "-o", "image.elf"]
    subprocess.run([tools.ARM_GCC, *core, *map(str, sources), *link], cwd=firmware, check=True, capture_output=True)
    asked = ["a2ltool", "asked.a2l", "--elffile", "image.elf", "--update", "--output", "found.a2l"]
    subprocess.run(asked, cwd=firmware, check=True, capture_output=True)
    result = (firmware / "found.a2l").read_text()
    addresses = re.findall(r"(?:VALUE|ECU_ADDRESS) (0x[0-9A-F]+)", result)
    assert len(addresses) == text.count("SYMBOL_LINK") - lost and len({*addresses}) == len(addresses)
    assert "0x0" not in addresses


PROBE = """
#include <stdint.h>
#define CYCLES_H
static inline uint32_t cycles_now(void) { return 0u; }
#include "src/loop.c"
#include "controller/levitator_2dof.c"
loop_t loop;
void io_read(board_input_t *in) { in->z = 0.0f; in->x = 0.0f; }
void io_write(const board_output_t *out) { (void)out; }
uint32_t now(void) { return loop.samples * (LOOP_PERIOD_NS / 1000u); }
void begin(void) { loop_init(&loop); }
float *value(void) { return &loop.parameters.%s; }
float held(void) { return loop.controller.%s; }
float *last(void) { return &loop.parameters.%s; }
void sample(uint32_t commit) { loop.commit |= commit; (void)loop_sample(&loop); }
uint32_t refused(void) { return loop.refused; }
uint32_t left(void) { return loop.left; }
"""


@pytest.fixture
def board(firmware: Path, tmp_path: Path) -> ctypes.CDLL:
    """The loop as a library whose tool is the test."""
    code = harness.emitted(NAME)[NAME]
    fields = {f["name"]: f.get("path", f["name"]) for f in code.manifest["structs"]["state"]["fields"]}
    last = list(code.manifest["tuning"]["default"])[-1]
    library = tmp_path / "loop.so"
    done = compiled(firmware, PROBE % (GAIN, fields[GAIN], last), "-shared", "-fPIC", "-O1", "-I.", "-o", str(library))
    assert done.returncode == 0, done.stderr
    loaded = ctypes.CDLL(str(library))
    for name, kind in (("value", ctypes.POINTER(ctypes.c_float)), ("last", ctypes.POINTER(ctypes.c_float))):
        getattr(loaded, name).restype = kind
    loaded.held.restype = ctypes.c_float
    loaded.begin()
    return loaded


def test_parameters_are_taken_when_the_tool_commits_and_not_before(board: ctypes.CDLL) -> None:
    calls = harness.emitted(NAME)[NAME].manifest["tuning"]["calls"]
    declared, new = board.held(), float(np.float32(values(set_text(1500.0))[GAIN]))
    board.value()[0] = new
    for _ in range(3):
        board.sample(0)
    assert board.held() == declared != new
    board.sample(1)
    assert board.refused() == 0 and board.left() == calls - 1
    for _ in range(calls - 1):
        assert board.held() != new
        board.sample(0)
    assert board.held() == new and board.left() == 0


@pytest.mark.parametrize("bad", [float("nan"), float("inf"), 0.0])
def test_a_refused_change_leaves_the_one_before_under_way(bad: float, board: ctypes.CDLL) -> None:
    calls = harness.emitted(NAME)[NAME].manifest["tuning"]["calls"]
    new = float(np.float32(values(set_text(1500.0))[GAIN]))
    board.value()[0] = new
    board.sample(1)
    board.last()[0] = bad
    board.sample(1)
    assert board.refused() == 2
    for _ in range(calls):
        board.sample(0)
    assert board.held() == new
