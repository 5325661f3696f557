"""The manifest describes the C correctly, and its text is JSON with one row a line."""

import hashlib
import json
import re
from collections.abc import Mapping
from dataclasses import replace
from itertools import accumulate, pairwise
from typing import Any

import casadi as ca
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from synth.block import Block, Step, build
from synth.blocks.guard import safe_output
from synth.blocks.guard.safety import LATCH_BIT, NO_SAFE_OUTPUT, GuardedInput, Safety, frozen, guard
from synth.composition import compose
from synth.emit.c.manifest import dumps
from synth.emit.write import EmittedCode, emit
from synth.errors import CompileError, EmitError, WiringError
from synth.execute import host
from synth.signals import Signal
from synth.timing import Discrete
from tests.emit import dyadic, hazards

TIME = Discrete(1.25e-3)
GAP = Signal("gap", "m", 0.01, 0.03, "air gap")


def emit_guard(scalar: type[np.floating]) -> EmittedCode:
    block = compose(
        "stage",
        [guard(TIME, [GuardedInput(GAP, 0.02, True), GuardedInput(Signal("wish", "m", 0, 1), 0, False)], 5)],
        inputs=["gap", "wish"],
        outputs=["gap_held"],
    )
    return emit(block, scalar)


@pytest.mark.slow
@pytest.mark.parametrize("scalar", [np.float32, np.float64])
def test_the_compiler_confirms_the_layout(scalar: type[np.floating]) -> None:
    made = emit_guard(scalar)
    controller = host.load(made.files, made.manifest)
    assert controller.scalar is scalar and controller.period_s == 1.25e-3
    state = controller.init()
    assert state["guard_last_gap"] == scalar(0.02)
    assert controller.step(state, {"gap": np.nan, "wish": 7}).faults == 0b11


@pytest.mark.slow
def test_a_layout_that_lies_is_refused_by_the_compiler() -> None:
    made = emit_guard(np.float64)
    manifest: Any = json.loads(made.files["manifest.json"])
    manifest["structs"]["state"]["fields"][0]["offset"] += 8
    with pytest.raises(CompileError, match="manifest_state"):
        host.load(made.files, manifest)


def test_every_entry_stands_as_declared() -> None:
    made = emit_guard(np.float32)
    manifest = made.manifest
    assert (manifest["design"], manifest["scalar"]) == ("stage", "float32")
    assert manifest["functions"] == {"init": "stage_init", "step": "stage_step"}
    assert manifest["faults"] == [{"bit": 0, "input": "gap"}, {"bit": 1, "input": "wish"}, {"bit": 31, "latched": True}]
    bounds = {"low": float(np.float32(0.01)), "high": float(np.float32(0.03))}
    gap = {"name": "gap", "offset": 0, "count": 1, "ctype": "float", "unit": "m"} | bounds
    assert manifest["structs"]["input"]["fields"][0] == gap
    assert [s["type"] for s in manifest["structs"].values()] == ["stage_input_t", "stage_output_t", "stage_state_t"]
    assert manifest["safety"] == {
        "bad_samples": 5,
        "safe_output": {},
        "slew_per_s": {},
        "safe_output_effect": NO_SAFE_OUTPUT,
    }
    assert manifest["sha256"] == {
        name: hashlib.sha256(made.files[name].encode()).hexdigest() for name in ("stage.c", "stage.h", "stage.md")
    }


def test_the_fault_bits_of_the_header_are_those_of_the_manifest() -> None:
    made = emit_guard(np.float32)
    for fault in made.manifest["faults"]:
        meaning = f"{fault['input']}: " if "input" in fault else "latched until init"
        assert f" *   bit {fault['bit']:2d}  {meaning}" in made.files["stage.h"]


# --- the trace: which lines compute which Block ---

STAGE = Safety(3, {"force": 0.0}, {"force": 5.0}, "at rest")


def stage() -> Block:
    """Return a guarded stage: a function of the gap, a law, and the safe output once latched."""
    force = Signal("force", "N", -1, 1)
    gap, wish = Signal("gap", "1", 0.25, 0.5), Signal("wish", "1", 0, 1)
    held = [Signal("gap_held", "1", 0.25, 0.5), Signal("wish_held", "1", 0, 1)]
    law = build(
        "law",
        TIME,
        lambda u, x, k: Step(
            {"force_computed": ca.exp(u["gap_held"]) * (u["wish_held"] - 0.5) / 2},
            named=[(Signal("gain", "1", 0, 9), ca.exp(u["gap_held"]))],
        ),
        inputs=held,
        outputs=[Signal("force_computed", "N", -9, 9)],
        tag="F(3), F(4)",
    )
    blocks = [
        guard(TIME, [GuardedInput(gap, 0.25, True), GuardedInput(wish, 0, False)], 3),
        law,
        safe_output.block(TIME, [force], STAGE),
    ]
    return compose("stage", blocks, inputs=["gap", "wish"], outputs=["force"])


# A Block that computes nothing has no line to trace.
BLOCKS = [stage(), *(b for b in hazards.BLOCKS if b.name != "never"), *(dyadic.random_block(seed) for seed in range(6))]
IDLE = re.compile(r"\s*(\(void\)\w+;|static const .*|return .*;|)")


def body(lines: list[str], name: str) -> range:
    """Return the numbers, from 1, of the lines inside the braces of the step."""
    head = next(i for i, line in enumerate(lines, 1) if line.startswith(f"uint32_t {name}_step("))
    return range(head + 2, len(lines))


def trace_defects(lines: list[str], trace: Mapping[str, list[list[int]]], name: str) -> list[str]:
    """Return the defects of a trace: lines outside the functions, runs out of order or shared, missing lines."""
    inside, defects, covered = body(lines, name), [], list[int]()
    depths = [*accumulate(line.count("{") - line.count("}") for line in lines)]
    for tag, runs in trace.items():
        if not all(first <= last for first, last in runs) or not all(a[1] < b[0] for a, b in pairwise(runs)):
            defects.append(f"{tag}: out of order")
        covered += [line for first, last in runs for line in range(first, last + 1)]
    defects += [f"{line} twice" for line in set(covered) if covered.count(line) > 1]
    defects += [f"{line} outside" for line in covered if line > len(lines) or depths[line - 1] < 1]
    left = [line for line in inside if line not in covered and not IDLE.fullmatch(lines[line - 1])]
    return defects + [f"{line} left out" for line in left]


@pytest.mark.parametrize("block", BLOCKS, ids=lambda b: b.name)
def test_every_line_of_the_step_belongs_to_one_block(block: Block) -> None:
    made = emit(block, np.float32, error=1e-5)
    lines = made.files[f"{block.name}.c"].splitlines()
    assert not trace_defects(lines, made.manifest["trace"], block.name)


def test_a_trace_that_is_wrong_is_found() -> None:
    made = emit(stage(), np.float32, error=1e-5)
    lines, trace = made.files["stage.c"].splitlines(), made.manifest["trace"]
    (tag, runs), other = next(iter(trace.items())), next(tag for tag in trace if tag.startswith("law"))
    (first, last), of_step = runs[0], runs[1:]
    for wrong in ([], [runs[0]], [[last, first], *of_step], [*of_step, runs[0]], [*runs, [first, len(lines) + 1]]):
        assert trace_defects(lines, trace | {tag: wrong}, "stage")
    assert trace_defects(lines, trace | {other: [*trace[other], [first, first]]}, "stage")
    assert trace_defects(lines, trace | {tag: [*runs[::-1], [1, 1]]}, "stage")


def test_lines_belong_to_the_block_that_computes_them() -> None:
    made = emit(stage(), np.float32, error=1e-5)
    lines, trace = made.files["stage.c"].splitlines(), made.manifest["trace"]
    titles = [
        "guard: range acceptance, hold, latch",
        "law: F(3), F(4)",
        "safe_output: slew to the safe output once latched",
    ]
    assert sorted(trace) == titles

    def of(text: str) -> list[str]:
        numbers = [i for i, line in enumerate(lines, 1) if text in line]
        return [tag for i in numbers for tag, runs in trace.items() if any(a <= i <= b for a, b in runs)]

    assert of("gain_polynomial(") == ["law: F(3), F(4)"]
    assert set(of("state->guard.")) == {titles[0]}
    assert of("stage_slew(") == [titles[2]]


# --- the whole document ---

FIELD = {"name": str, "offset": int, "count": int, "ctype": str, "unit": str, "low": float, "high": float}
SURROGATE = {
    "tag": str,
    "function": str,
    "variable": str,
    "low": float,
    "high": float,
    "degree": int,
    "max_relative_error": float,
    "checked_values": int,
}
SCHEMA: dict[str, Any] = {
    "design": str,
    "period_s": float,
    "scalar": str,
    "functions": {"init": str, "step": str},
    "structs": {role: {"type": str, "size": int, "fields": [FIELD]} for role in ("input", "output", "state")},
    "faults": [dict],
    "safety": {"bad_samples": int, "safe_output": dict, "slew_per_s": dict, "safe_output_effect": str},
    "numbers": dict,
    "surrogates": [SURROGATE],
    "diagnostics": dict,
    "trace": dict,
    "sha256": {"stage.c": str, "stage.h": str, "stage.md": str},
}


def misfits(value: Any, schema: Any, where: str = "") -> list[str]:
    """Return the places at which a document has other keys or types of values than the schema."""
    if isinstance(schema, list):
        return [m for i, item in enumerate(value) for m in misfits(item, schema[0], f"{where}[{i}]")]
    if isinstance(schema, dict):
        if not isinstance(value, dict) or value.keys() != schema.keys():
            return [f"{where}: {value}"]
        return [m for key in schema for m in misfits(value[key], schema[key], f"{where}.{key}")]
    kinds = (int, float) if schema is float else (schema,)
    return [] if isinstance(value, kinds) and not isinstance(value, bool) else [f"{where}: {value}"]


def test_the_document_matches_its_schema() -> None:
    made = emit(stage(), np.float32, error=1e-5)
    document = json.loads(made.files["manifest.json"])
    assert document == made.manifest
    paths = [f.pop("path", None) for f in document["structs"]["state"]["fields"]]  # in the struct of its Block
    assert "guard.left" in paths and not misfits(document, SCHEMA) and document["surrogates"]
    assert document["faults"] == [{"bit": 0, "input": "gap"}, {"bit": 1, "input": "wish"}, {"bit": 31, "latched": True}]
    for wrong in ({"period_s": "1"}, {"surrogates": [{}]}, {"functions": {"init": "a"}}, {"more": 1}):
        assert misfits({**document, **wrong}, SCHEMA)


def test_surrogates_are_listed_as_they_are_in_the_c() -> None:
    made = emit(stage(), np.float32, error=1e-5)
    (surrogate,) = made.manifest["surrogates"]
    assert (surrogate["tag"], surrogate["function"], surrogate["variable"]) == ("gain", "gain_polynomial", "gap_held")
    assert (surrogate["low"], surrogate["high"]) == (0.25, 0.5) and 0 < surrogate["checked_values"] <= 2**23
    code = made.files["stage.c"]
    function = code[code.index("static inline float gain_polynomial(float t)") :].split("}")[0]
    assert function.count("* ") == surrogate["degree"]
    assert f"relative error at most {surrogate['max_relative_error']:.2g}. */" in code


# --- its text ---

TREES = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False, allow_infinity=False) | st.text(),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(), inner, max_size=4),
    max_leaves=20,
)


@pytest.mark.slow
@given(st.dictionaries(st.text(), TREES))
def test_the_text_reads_back_as_the_document(document: dict[str, Any]) -> None:
    text = dumps(document)
    assert json.loads(text) == document and text.endswith("\n")


def test_a_row_is_printed_on_one_line() -> None:
    text = dumps({"rows": [{"a": 1, "b": [1, 2]}, {"c": 3}], "empty": {}})
    assert text.splitlines() == [
        "{",
        ' "rows": [',
        "  {",
        '   "a": 1,',
        '   "b": [1, 2]',
        "  },",
        '  {"c": 3}',
        " ],",
        ' "empty": {}',
        "}",
    ]


def test_numbers_that_json_does_not_know_are_refused() -> None:
    with pytest.raises(ValueError, match="JSON"):
        dumps({"x": float("nan")})


def test_a_block_that_does_not_latch_has_no_safety() -> None:
    output = Signal("force", "N", -1, 1)
    block = safe_output.block(TIME, [output], Safety(1, {"force": 0}, {"force": 1}, "rest"))
    assert emit(block, np.float64).manifest["safety"] is None
    assert emit(guard(TIME, [GuardedInput(GAP, 0.02, False)], 3), np.float64).manifest["safety"] is None


def test_the_safety_is_that_of_the_blocks_and_the_c_keeps_it() -> None:
    made = emit(frozen(stage()), np.float64, error=1e-5)
    safety = made.manifest["safety"]
    assert safety == {
        "bad_samples": 3,
        "safe_output": {"force": 0.0},
        "slew_per_s": {"force": 5.0},
        "safe_output_effect": "at rest",
    }
    replay = host.load(made.files, made.manifest).replay({"gap": [0.5] * 4 + [9.0] * 400, "wish": [1.0] * 404})
    latched, force = np.flatnonzero(replay.faults >> LATCH_BIT)[0], replay.outputs["force"]
    assert latched == 4 + safety["bad_samples"] - 1
    steps = np.abs(np.diff(force[latched - 1 :]))
    assert force[-1] == safety["safe_output"]["force"]
    assert steps.max() == pytest.approx(safety["slew_per_s"]["force"] * TIME.period_s)


def test_a_guard_behind_which_a_law_decides_declares_the_flags_that_latch() -> None:
    """Its measurements keep their names through renaming and composition; an ordinary guard declares none."""
    judging = guard(
        TIME, [GuardedInput(GAP, 0.02, True), GuardedInput(Signal("wish", "m", 0, 1), 0, False)], 5, redundant=True
    )
    block = compose(
        "decided",
        [judging.renamed({"gap": "lift"})],
        inputs=["lift", "wish", "sufficient", "landed"],
        outputs=["gap_held"],
    )
    judgement = emit(block, np.float64).manifest["safety"]["judgement"]
    assert judgement == {"counts": "sufficient", "at_once": "landed", "measurements": ["lift"]}
    assert "judgement" not in emit_guard(np.float32).manifest["safety"]


def test_an_output_that_passes_a_safe_one_on_has_its_safety() -> None:
    """An output that is computed from the safe one has no safety."""
    force = Signal("force", "N", -1, 1)
    both = [Signal("left", "N", -1, 1), Signal("right", "N", -1, 1), Signal("half", "N", -0.5, 0.5)]
    shared = build(
        "shared",
        TIME,
        lambda u, x, k: Step({"left": u["force"], "right": u["force"], "half": u["force"] / 2}),
        inputs=[force],
        outputs=both,
    )
    parts = [
        guard(TIME, [GuardedInput(GAP, 0.02, True)], 2),
        safe_output.block(TIME, [force], replace(STAGE, bad_samples=2)),
    ]
    block = compose("two", [*parts, shared], inputs=["gap", "force_computed"], outputs=["right", "left", "half"])
    assert block.safety == Safety(2, {"right": 0.0, "left": 0.0}, {"right": 5.0, "left": 5.0}, "at rest")


def test_a_latch_that_contradicts_its_safety_is_refused() -> None:
    force = Signal("force", "N", -1, 1)
    parts = [guard(TIME, [GuardedInput(GAP, 0.02, True)], 2), safe_output.block(TIME, [force], STAGE)]
    with pytest.raises(WiringError, match="'guard' latches after 2 bad samples, 'safe_output' after 3: declare one"):
        compose("two", parts, inputs=["gap", "force_computed"], outputs=["force"])
    untold = replace(guard(TIME, [GuardedInput(GAP, 0.02, True)], 2), safety=None)
    with pytest.raises(EmitError, match=r"block 'guard' latches \(fault bit 31\) but does not say what it does then"):
        emit(untold, np.float64)
