"""The header tells how to call the step and serves C++; the C refuses what would remove its guards."""

import json
import re
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import pytest

from synth.emit.write import emit
from synth.errors import CompileError
from synth.execute import compile as compiler
from tests import tools
from tests.emit.c.test_manifest import stage
from tests.emit.passes.test_guards import F32

GENERATED = Path(__file__).parents[3] / "generated_c"
NAMES = sorted(path.parent.name for path in GENERATED.glob("*/manifest.json"))
LOCAL = re.compile(r"^ +(?:const )?(?:float|bool|uint32_t) (\w+)(?: = [^;]*)?;$", re.MULTILINE)


def committed(name: str) -> dict[str, str]:
    return {path.name: path.read_text() for path in (GENERATED / name).glob("*.[ch]")}


def test_the_header_states_the_notes_of_a_stage() -> None:
    text = emit(stage(), F32, header_notes=["y counts downwards."]).files["stage.h"]
    assert " *\n * y counts downwards.\n" in text and "downwards" not in emit(stage(), F32).files["stage.h"]


@pytest.mark.parametrize("name", NAMES)
def test_a_caller_reads_at_most_120_lines(name: str) -> None:
    before_the_state = committed(name)[f"{name}.h"].split("\n/* What follows is for init and step alone")[0]
    assert f"{name}_step(" in before_the_state and before_the_state.count("\n") <= 120


def test_a_warning_stands_in_the_first_line_of_header_and_manifest() -> None:
    warning = "one sensor has no fault protection."
    first, second = (emit(stage(), F32, warning=text).files for text in (warning, ""))
    assert first["stage.h"].splitlines()[0] == f"/* stage: {warning}"
    assert first["manifest.json"].splitlines()[0] == f'{{"warning": "{warning}",'
    assert json.loads(first["manifest.json"])["warning"] == warning and "warning" not in second["manifest.json"]
    assert first["stage.h"].split(" *\n * ", 1)[1] == second["stage.h"].split("/* ", 1)[1]


def test_the_header_states_what_a_caller_must_keep() -> None:
    text = emit(stage(), F32).files["stage.h"].replace("\n * ", " ")
    assert "Call stage_init once, then stage_step once every 0.00125 s" in text
    latch = "When a measurement is refused in 3 samples in a row, the step latches in the last of them until init"
    assert latch in text and "Keep calling the step while it is latched" in text
    assert "-ffast-math" in text and "-O2" in text and 'extern "C" {' in text


COMPILERS = {
    "gcc": ["gcc"],
    "clang": ["clang"],
    "zig": [sys.executable, "-m", "ziglang", "cc"],
    "arm-none-eabi-gcc": ["arm-none-eabi-gcc"],
}
WIDER = {"gcc": "-mfpmath=387", "zig": "-ffp-eval-method=extended"}  # the others have no such option: it is planted
UNDER = "-ffinite-math-only remove the tests"
PLANT = "#include <float.h>\n#undef FLT_EVAL_METHOD\n#define FLT_EVAL_METHOD 2\n"


@pytest.mark.parametrize(
    "name",
    ["zig", *(pytest.param(n, marks=tools.needs(n, shows=f"what {n} refuses")) for n in COMPILERS if n != "zig")],
)
@pytest.mark.parametrize(("flag", "why"), [("-ffast-math", UNDER), ("-ffinite-math-only", UNDER), ("", "wider type")])
def test_options_that_remove_the_guards_are_refused(flag: str, why: str, name: str, tmp_path: Path) -> None:
    """Each compiler accepts the C and stops at #error with an option that would change its results."""
    for file, text in emit(stage(), F32).files.items():
        (tmp_path / file).write_text(text)
        (tmp_path / f"planted_{file}").write_text(text.replace("#include <float.h>\n", PLANT))
    command = [*COMPILERS[name], "-std=c99", "-c", "-o", str(tmp_path / "stage.o"), "-I", str(tmp_path)]
    subprocess.run([*command, "-O2", str(tmp_path / "stage.c")], check=True, capture_output=True)
    source = "stage.c" if flag or name in WIDER else "planted_stage.c"
    option = flag or WIDER.get(name, "-O2")
    refused = subprocess.run([*command, option, str(tmp_path / source)], capture_output=True, text=True)
    assert refused.returncode and why in refused.stderr


@tools.needs("g++", shows="that C++ includes the header")
@pytest.mark.parametrize("name", NAMES)
def test_cplusplus_includes_the_header(name: str) -> None:
    command = ["g++", "-fsyntax-only", "-Wall", "-Werror", "-x", "c++", str(GENERATED / name / f"{name}.h")]
    subprocess.run(command, check=True, capture_output=True)


@pytest.mark.parametrize("standard", ["-std=c99", "-std=c11"])
@pytest.mark.parametrize("name", NAMES)
def test_committed_c_compares_no_floats_for_equality(name: str, standard: str) -> None:
    compiler.check(committed(name), [*compiler.STRICT_FLAGS, standard])


@pytest.mark.parametrize("name", NAMES)
def test_sizes_are_asserted(name: str) -> None:
    size = json.loads((GENERATED / name / "manifest.json").read_text())["structs"]["state"]["size"]
    files = {n: t.replace(f"== {size}u", f"== {size + 4}u") for n, t in committed(name).items()}
    for standard in ("-std=c99", "-std=c11"):
        with pytest.raises(CompileError, match="size"):
            compiler.check(files, [standard])


@pytest.mark.parametrize("name", NAMES)
def test_committed_c_has_no_unnamed_local_and_no_long_line(name: str) -> None:
    text = committed(name)[f"{name}.c"]
    names = LOCAL.findall(text)
    assert names and not [n for n in names if re.fullmatch(r"t\d+", n)]
    every = text.splitlines() + committed(name)[f"{name}.h"].splitlines()
    assert not [line for line in every if len(line) > 120]
    assert "(1.0f != 0.0f)" not in text


def test_the_header_says_when_a_law_decides_on_the_latch() -> None:
    said = {n: " ".join(committed(n)[f"{n}.h"].replace("\n * ", " ").split()) for n in NAMES}
    sentence = (
        "The step latches until init when the readings do not suffice in 5 samples in a row, or more than 1 in 5 for "
        "long, or when a landing is over"
    )
    assert [n for n, text in said.items() if sentence in text] == ["maglev_5dof", "maglev_5dof_precise"]
    assert "When a measurement is refused in 5 samples in a row" in said["planar_6dof_lqg"]


def unnamed_share(designs: Sequence[str]) -> float:
    """Return the share of the locals that are named after the signal that they serve."""
    names = [n for design in designs for n in LOCAL.findall(committed(design)[f"{design}.c"])]
    return len([n for n in names if re.search(r"_(part|test)(_\d+)?$|^value(_\d+)?$", n)]) / len(names)


def test_at_most_a_quarter_of_the_locals_is_named_after_the_signal_that_it_serves() -> None:
    """Others have the name of a signal, of a variable of the law, or one made from their operation."""
    assert unnamed_share(NAMES) > 0 and all(unnamed_share([design]) <= 0.25 for design in NAMES)
    for design in ("maglev_5dof_phase", "maglev_5dof_precise", "maglev_5dof_precise_phase"):
        assert unnamed_share([design]) <= 0.1
    for design in ("maglev_5dof", "planar_6dof_leadlag", "planar_6dof_lqg"):
        assert unnamed_share([design]) <= 0.05


def text_of(name: str) -> str:
    return " ".join(committed(name)[f"{name}.h"].replace("\n * ", " ").split())


def test_the_header_states_latency_and_what_init_assumes() -> None:
    at_once, late = (
        " ".join(emit(stage(), F32, latency=n).files["stage.h"].replace("\n * ", " ").split()) for n in (0, 2)
    )
    assert "use its outputs at once" in at_once and "Apply the outputs" not in at_once
    assert "Apply the outputs 2 samples, 0.0025 s, after the inputs" in late and "outputs at once" not in late
    rest = "At init the machine is at rest under the safe output, which acts until the first outputs of the step do."
    closed = [n for n in NAMES if not n.startswith("hall") and not n.endswith("_phase")]
    assert [n for n in NAMES if rest in text_of(n)] == closed
    assert all("Apply the outputs 1 sample" in text_of(n) for n in NAMES if not n.startswith("hall"))


def test_the_header_says_what_the_caller_does_about_missed_calls() -> None:
    sentence = "A number above 40 sets bit 18 of this sample and neither brakes nor latches"
    assert [n for n in NAMES if sentence in text_of(n)] == ["maglev_5dof", "maglev_5dof_precise"]


def test_the_header_says_when_braking_begins_and_ends() -> None:
    text = text_of("planar_6dof_lqg")
    assert (
        "brakes the machine in the 23 samples after the last of these, and latches in the next one until init" in text
    )
    bit = "bit 30 a latch is certain: after the first sample with this bit it brakes for 23 samples, then latches; set"
    assert f"{bit} until init" in text.replace("* ", "")
