"""The manifest tells the truth about the C, and its text is JSON with one row a line."""

import hashlib
import json
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from synth.compose import compose
from synth.emit.manifest import dumps
from synth.emit.write import Emitted, emit
from synth.errors import CompileError
from synth.execute import host
from synth.signals import Signal
from synth.synthesise.safety import Guarded, Safety, guard, safe_output
from synth.timing import Discrete

TIME = Discrete(1.25e-3)
GAP = Signal("gap", "m", 0.01, 0.03, "air gap")
SAFETY = Safety(5, {"gap_held": 0.02}, {"gap_held": 0.5}, "it falls up")


def emitted(scalar: type[np.floating]) -> Emitted:
    block = compose(
        "stage",
        [guard(TIME, [Guarded(GAP, 0.02, True), Guarded(Signal("wish", "m", 0, 1), 0, False)], 5)],
        inputs=["gap", "wish"],
        outputs=["gap_held"],
    )
    return emit(block, scalar, SAFETY)


@pytest.mark.parametrize("scalar", [np.float32, np.float64])
def test_the_compiler_confirms_the_layout(scalar: type[np.floating]) -> None:
    made = emitted(scalar)
    controller = host.load(made.files, made.manifest)
    assert controller.scalar is scalar and controller.period_s == 1.25e-3
    state = controller.init()
    assert state["guard_last_gap"] == scalar(0.02)
    assert controller.step(state, {"gap": np.nan, "wish": 7}).faults == 0b11


def test_a_layout_that_lies_is_refused_by_the_compiler() -> None:
    made = emitted(np.float64)
    manifest: Any = json.loads(made.files["manifest.json"])
    manifest["structs"]["state"]["fields"][0]["offset"] += 8
    with pytest.raises(CompileError, match="manifest_state"):
        host.load(made.files, manifest)


def test_every_entry_stands_as_declared() -> None:
    made = emitted(np.float32)
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
        "safe_output": {"gap_held": 0.02},
        "slew_per_s": {"gap_held": 0.5},
        "reason": "it falls up",
    }
    assert manifest["sha256"] == {
        name: hashlib.sha256(made.files[name].encode()).hexdigest() for name in ("stage.c", "stage.h")
    }


def test_the_fault_bits_of_the_header_are_those_of_the_manifest() -> None:
    made = emitted(np.float32)
    for fault in made.manifest["faults"]:
        assert f" *   bit {fault['bit']:2d}  {fault.get('input', 'latched')}: " in made.files["stage.h"]


TREES = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False, allow_infinity=False) | st.text(),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(), inner, max_size=4),
    max_leaves=20,
)


@given(st.dictionaries(st.text(), TREES))
def test_the_text_reads_back_as_the_document(document: dict[str, Any]) -> None:
    text = dumps(document)
    assert json.loads(text) == document and text.endswith("\n")


def test_a_row_stands_in_one_line() -> None:
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


def test_a_block_without_safety_says_so() -> None:
    output = Signal("force", "N", -1, 1)
    block = safe_output(TIME, [output], Safety(1, {"force": 0}, {"force": 1}, "rest"))
    assert emit(block, np.float64).manifest["safety"] is None
