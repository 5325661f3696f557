"""The compiled step receives inputs bit for bit, and a wrong manifest is refused."""

from copy import deepcopy
from typing import Any

import numpy as np
import pytest

from synth.errors import CompileError, DesignError, SignalError
from synth.execute import host

HEADER = """#include <stdint.h>
typedef REAL real;
typedef struct { real u; real taps[3]; } blend_input_t;
typedef struct { real y, echo; } blend_output_t;
typedef struct { real xi; int32_t sign; uint32_t ticks; TAIL } blend_state_t;
void blend_init(blend_state_t *state);
uint32_t blend_step(blend_state_t *state, const blend_input_t *in, blend_output_t *out);
"""
SOURCE = """#include "blend.h"
void blend_init(blend_state_t *state) { state->xi = (real)0.25; state->sign = -1; state->ticks = 7u; }
uint32_t blend_step(blend_state_t *state, const blend_input_t *in, blend_output_t *out) {
    const real xi = (real)0.9 * state->xi + in->u;
    out->y = xi + in->taps[0] * in->taps[1] + in->taps[2];
    out->echo = in->u;
    state->xi = xi;
    state->sign = -state->sign;
    state->ticks = state->ticks + 1u;
    return state->ticks << 1;
}
"""
TAPS = (0.1, 0.2, 0.3)


def files(scalar: str) -> dict[str, str]:
    # Three words of float32 state need no filling up; neither do two words beside a double.
    header = HEADER.replace("REAL", "float" if scalar == "float32" else "double").replace(" TAIL", "")
    return {"blend.h": header, "blend.c": SOURCE}


def manifest(scalar: str) -> dict[str, Any]:
    n, real = (4, "float") if scalar == "float32" else (8, "double")
    layout = {
        "input": [("u", 0, 1, real), ("taps", n, 3, real)],
        "output": [("y", 0, 1, real), ("echo", n, 1, real)],
        "state": [("xi", 0, 1, real), ("sign", n, 1, "int32_t"), ("ticks", n + 4, 1, "uint32_t")],
    }
    structs = {
        role: {
            "type": f"blend_{role}_t",
            "size": size,
            "fields": [dict(zip(("name", "offset", "count", "ctype"), f, strict=True)) for f in layout[role]],
        }
        for role, size in (("input", 4 * n), ("output", 2 * n), ("state", n + 8))
    }
    functions = {"init": "blend_init", "step": "blend_step"}
    return {"design": "blend", "period_s": 0.002, "scalar": scalar, "functions": functions, "structs": structs}


@pytest.fixture(scope="module", params=["float32", "float64"])
def blend(request: pytest.FixtureRequest) -> host.Controller:
    return host.load(files(request.param), manifest(request.param))


def recursion(u: np.ndarray, xi: Any, real: type) -> np.ndarray:
    """The same step in NumPy, rounded after every operation, over the last axis of u."""
    rows, taps = [], [real(t) for t in TAPS]
    for sample in u.astype(real):
        xi = real(0.9) * xi + sample
        rows.append(xi + taps[0] * taps[1] + taps[2])
    return np.array(rows)


def test_init_and_step(blend: host.Controller) -> None:
    state = blend.init()
    assert (state["xi"], state["sign"], state["ticks"]) == (0.25, -1, 7)
    outputs, faults = blend.step(state, {"u": 2.0, "taps": TAPS})
    assert outputs["y"] == recursion(np.array([2.0]), blend.scalar(0.25), blend.scalar)[0]
    assert (state["sign"], state["ticks"], faults) == (1, 8, 16)
    assert outputs["y"].dtype == blend.scalar and blend.period_s == 0.002


def test_replay_is_the_recursion_bit_for_bit(blend: host.Controller) -> None:
    u = np.random.default_rng(1).normal(size=500)
    replay = blend.replay({"u": u, "taps": np.tile(TAPS, (500, 1))})
    expected = recursion(u, blend.scalar(0.25), blend.scalar)
    assert replay.outputs["y"].tobytes() == expected.tobytes()
    assert replay.outputs["y"].tobytes() != recursion(u, blend.scalar(0.26), blend.scalar).tobytes()
    assert np.array_equal(replay.faults, 2 * np.arange(8, 508))
    assert replay.state["ticks"] == 507


def test_replay_in_two_parts_leaves_the_given_state(blend: host.Controller) -> None:
    u = np.random.default_rng(2).normal(size=40)
    whole, first = blend.replay({"u": u, "taps": 0.5}), blend.replay({"u": u[:17], "taps": 0.5})
    second = blend.replay({"u": u[17:], "taps": 0.5}, first.state)
    assert np.array_equal(whole.outputs["y"], np.concatenate([first.outputs["y"], second.outputs["y"]]))
    assert first.state["ticks"] == 24 and second.state == whole.state


def test_batch_steps_each_state_once(blend: host.Controller) -> None:
    states = np.repeat(blend.init()[None], 3)
    states["xi"], states["ticks"] = [1.0, 2.0, 3.0], [1, 2, 3]
    batch = blend.batch(states, {"u": np.array([0.0, 0.5, -0.5]), "taps": 0.0})
    assert np.array_equal(batch.outputs["y"], blend.scalar(0.9) * states["xi"] + np.array([0, 0.5, -0.5], blend.scalar))
    assert batch.faults.tolist() == [4, 6, 8] and batch.states["ticks"].tolist() == [2, 3, 4]
    assert states["ticks"].tolist() == [1, 2, 3]
    assert blend.batch(states[:0], {"u": 0.0, "taps": 0.0}).faults.size == 0


def test_any_bit_pattern_passes(blend: host.Controller) -> None:
    word = np.dtype(f"u{blend.scalar().itemsize}")
    bits = np.random.default_rng(3).integers(0, np.iinfo(word).max, 2000, word, endpoint=True)
    signalling = {4: 0x7F812345, 8: 0x7FF0000000012345}[word.itemsize]
    bits[:3] = signalling, np.iinfo(word).max, 1
    replay = blend.replay({"u": bits.view(blend.scalar), "taps": 0.0})
    assert np.array_equal(replay.outputs["echo"].view(word), bits)
    with np.errstate(all="ignore"):
        rounded = bits.view(blend.scalar) + blend.scalar(0)  # what a stray operation on the way would do
    assert not np.array_equal(rounded.view(word), bits)


def test_a_number_too_large_becomes_infinite() -> None:
    controller = host.load(files("float32"), manifest("float32"))
    assert np.isposinf(controller.step(controller.init(), {"u": 1e300, "taps": 0.0}).outputs["echo"])


def test_flags_reach_the_compiler() -> None:
    tripled = files("float64") | {"blend.c": SOURCE.replace("(real)0.9", "(real)FACTOR")}
    controller = host.load(tripled, manifest("float64"), ["-DFACTOR=3"])
    assert controller.step(controller.init(), {"u": 0.0, "taps": 0.0}).outputs["y"] == 0.75


def broken(role: str, field: int | None, key: str, value: Any) -> dict[str, Any]:
    document = deepcopy(manifest("float32"))
    struct = document["structs"][role]
    (struct if field is None else struct["fields"][field])[key] = value
    return document


@pytest.mark.parametrize(
    ("document", "says"),
    [
        (broken("input", None, "size", 20), "manifest_input_has_20_bytes"),
        (broken("output", 0, "offset", 4), "manifest_output_y_at_4"),
        (broken("input", 1, "count", 2), "manifest_input_taps_has_2"),
        (broken("state", 0, "ctype", "uint32_t"), "manifest_state_xi_is_uint32_t"),
        (broken("state", 1, "ctype", "uint32_t"), "manifest_state_sign_is_uint32_t"),
        (broken("output", 1, "name", "ghost"), "ghost"),
    ],
)
def test_a_manifest_that_disagrees_with_the_struct_is_refused(document: dict[str, Any], says: str) -> None:
    with pytest.raises(CompileError, match=says):
        host.load(files("float32"), document)


@pytest.mark.parametrize(
    ("document", "says"),
    [
        (broken("input", 0, "ctype", "half"), r"struct 'input'.*'half'"),
        (broken("state", None, "size", 4), "struct 'state'"),
        ({**manifest("float32"), "structs": {}}, "struct 'input'"),
    ],
)
def test_an_incomplete_manifest_is_refused(document: dict[str, Any], says: str) -> None:
    with pytest.raises(DesignError, match=says):
        host.load(files("float32"), document)


def test_a_missing_header_is_named() -> None:
    with pytest.raises(DesignError, match="need the header"):
        host.load({"blend.c": SOURCE}, manifest("float32"))


@pytest.mark.parametrize(
    ("inputs", "says"),
    [
        ({"u": np.zeros(4)}, r"missing \['taps'\]"),
        ({"u": np.zeros(4), "taps": 0.0, "w": 1.0}, r"not known \['w'\]"),
        ({"u": np.zeros(4), "taps": np.zeros((5, 3))}, "lengths"),
        ({"u": 0.0, "taps": 0.0}, "lengths"),
        ({"u": np.zeros(4), "taps": np.zeros((4, 2))}, r"'taps': found the shape \(4, 2\), need \(4, 3\)"),
    ],
)
def test_inputs_that_do_not_fit_are_named(blend: host.Controller, inputs: dict[str, Any], says: str) -> None:
    with pytest.raises(SignalError, match=says):
        blend.replay(inputs)


def test_states_that_do_not_fit_are_refused(blend: host.Controller) -> None:
    inputs, states = {"u": 0.0, "taps": 0.0}, np.repeat(blend.init()[None], 4)
    for wrong in (states, states[0], np.zeros(()), None):
        with pytest.raises(SignalError, match=r"state of 'blend'"):
            blend.step(wrong, inputs)  # type: ignore[arg-type]
    for wrong in (states[::2], blend.init(), np.zeros(4)):
        with pytest.raises(SignalError, match=r"state of 'blend'"):
            blend.batch(wrong, inputs)
