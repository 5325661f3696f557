"""The header tells how to call the step and serves C++; the C refuses what would remove its guards."""

import json
import re
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import pytest

from synth.block import Constant
from synth.emit.c import header
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
    text = emit(stage(), F32, header_notes=["(n) is equation (n) of a paper."]).files["stage.h"]
    assert " *\n * (n) is equation (n) of a paper.\n" in text and "(n)" not in emit(stage(), F32).files["stage.h"]


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


@pytest.mark.parametrize("name", NAMES)
def test_the_header_states_the_initial_value_of_each_input(name: str) -> None:
    """They are those of init, which a value that differs would contradict."""
    text, fields = text_of(name), json.loads((GENERATED / name / "manifest.json").read_text())["structs"]
    source = committed(name)[f"{name}.c"]
    of_guard = re.search(r"\.guard = \{(.*?)\}", source, re.DOTALL)
    initial = dict(re.findall(r"\.(?:guard_)?last_(\w+) = ([-\d.e]+)f", of_guard[1] if of_guard else source))
    safety = json.loads((GENERATED / name / "manifest.json").read_text()).get("safety") or {}
    replaced = safety.get("judgement", {}).get("measurements", ())  # by what the others or a prediction say
    kept = [f["name"].removeprefix("guard_last_") for f in fields["state"]["fields"] if "guard_last_" in f["name"]]
    kept = [n for n in kept if n not in replaced]
    inputs = {f["name"]: f["name"].removesuffix("_commutation") for f in fields["input"]["fields"]}
    sentence = re.search(
        r"A refused input is replaced by its last good value, and before its first good value by (.*?)[;.] ", text
    )
    assert bool(sentence) == bool(kept)
    stated = {
        inputs[n]: float(value)
        for value, names in re.findall(r"([-\d.e]+) \S+ \(([^)]*)\)", sentence[1] if sentence else "")
        for n in names.split(", ")
    }
    assert {n: stated[n] for n in kept} == {n: float(initial.get(n, 0.0)) for n in kept}


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


def test_the_header_says_what_is_used_instead_of_a_voltage() -> None:
    rows = [r.split("|") for r in (GENERATED / "planar_6dof_lqg" / "planar_6dof_lqg.h").read_text().splitlines()]
    used = " ".join(r[2].strip() for r in rows if len(r) == 4)
    predicted = "none of the six voltages: x, y and yaw are predicted (dead reckoning)"
    assert used.count(predicted) == 2 and "initial value" not in used
    assert " by 0 V" not in text_of("planar_6dof_lqg")


def test_the_header_says_which_constants_follow_from_which_parameter() -> None:
    numbers = [
        Constant("half_M_y", 3.45, "kg", "M_y / 2", parameters=("M_y",)),
        Constant("M_x", 10.6, "kg", "Table I", parameters=("M_x",)),
        Constant("inverse_M_x", 1 / 10.6, "1/kg", "1 / M_x", parameters=("M_x",)),
        Constant("half_I", 0.5, "kg m", "I_x / 2; of x, z", parameters=("I_x", "I_z")),
        Constant("limit", 7.0, "A", "no parameter of the plant"),
    ]
    (note,) = header.by_parameter(numbers)
    assert "by parameter: M_x: M_x, inverse_M_x; I_x, I_z: half_I; M_y: half_M_y. " in note and "limit" not in note
    assert header.by_parameter(numbers[-1:]) == []


def test_a_constant_of_a_plant_knows_its_parameters_and_so_does_one_for_several() -> None:
    text = (GENERATED / "maglev_5dof" / "maglev_5dof.h").read_text().replace("\n *", "")
    assert "M_x: M_x, inverse_M_x" in text and "I_x, I_z: half_I_over_r" in text


def test_a_product_of_constants_has_the_parameters_of_both() -> None:
    shares = "allocation_front_share, allocation_rear_share, {}, loop_z_integral_input_times_allocation_z_share"
    text = text_of("planar_6dof_lqg").replace(" * ", " ")
    assert all(f"{arm}: {shares.format(arm)}" in text for arm in "bc")
