"""From a Block to C: refusals, dropped limits, surrogates, and the order of loads and stores."""

import math
import re
from itertools import pairwise
from typing import Any

import casadi as ca
import numpy as np
import pytest

from synth.block import Block, Constant, State, Step, build
from synth.blocks.guard import safety
from synth.emit import pipeline
from synth.emit.proof import ranges
from synth.emit.write import EmittedCode, emit
from synth.errors import EmitError
from synth.execute import host
from synth.signals import Signal
from synth.timing import Discrete
from tests.c_code import without_comments

pytestmark = pytest.mark.slow

TIME = Discrete(1e-3)


def signal(name: str, low: float = -1.0, high: float = 1.0) -> Signal:
    return Signal(name, "1", low, high)


def make_block(law: Any, states: tuple[State, ...] = (), low: float = -1.0, **fields: Any) -> Block:
    return build("made", TIME, law, inputs=[signal("a", low)], outputs=[signal("y", -50, 50)], states=states, **fields)


def text(emitted: EmittedCode) -> str:
    return emitted.files["made.c"].partition("made_step(")[2]


def run(emitted: EmittedCode, a: np.ndarray) -> host.Replay:
    return host.load(emitted.files, emitted.manifest).replay({"a": a})


def test_swapped_states_are_loaded_before_they_are_stored() -> None:
    states = (State(signal("p"), 0.25), State(signal("q"), -0.5))
    block = make_block(lambda u, x, k: Step({"y": x["p"] - x["q"]}, {"p": x["q"], "q": x["p"]}), states)
    emitted = run(emit(block, np.float32), np.zeros(5))
    np.testing.assert_array_equal(emitted.outputs["y"], [0.75, -0.75, 0.75, -0.75, 0.75])


def test_a_state_held_on_one_side_is_stored_on_the_other_only() -> None:
    def law(u: Any, x: Any, k: Any) -> Step:
        total = x["s"] + u["a"]
        return Step({"y": x["s"]}, {"s": ca.if_else(ca.fabs(total) <= 2, total, x["s"])})

    emitted = emit(make_block(law, (State(signal("s", -2, 2), 0),)), np.float32)
    assert re.search(r"if \(fabsf\(total\) <= 2\.0f\) \{\s+state->s = total;\s+\}", text(emitted))
    assert "else" not in text(emitted) and "min(" not in text(emitted)
    y = run(emitted, np.full(6, 0.75)).outputs["y"]
    np.testing.assert_array_equal(y, [0, 0.75, 1.5, 1.5, 1.5, 1.5])


def test_a_value_that_one_side_needs_is_computed_there() -> None:
    def law(u: Any, x: Any, k: Any) -> Step:
        far = ca.sqrt(u["a"] + 2) * 3 - u["a"] ** 2
        return Step({"y": ca.if_else(x["s"] > 0, far, -u["a"])}, {"s": u["a"]})

    body = text(emit(make_block(law, (State(signal("s"), 0.5),)), np.float32))
    assert body.index("if (") < body.index("sqrtf")
    assert body.count("out->y = ") == 2


def test_a_limit_that_ranges_prove_idle_is_dropped_and_a_needed_one_stays() -> None:
    idle = make_block(
        lambda u, x, k: Step({"y": x["s"]}, {"s": 0.5 * x["s"] + 0.5 * u["a"]}), (State(signal("s", -2, 2), 0),)
    )
    assert "limit" not in text(emit(idle, np.float32))
    needed = make_block(lambda u, x, k: Step({"y": x["s"]}, {"s": x["s"] + u["a"]}), (State(signal("s", -2, 2), 0),))
    kept = pipeline.reduce(needed, np.float32)
    clamp = next(k for k, n in enumerate(kept.program.nodes) if n.op == "clamp")
    loose = kept.program.substituted({clamp: kept.program.nodes[clamp].args[0]})
    with pytest.raises(EmitError, match=r"state 's' may become -3 \.\. 3"):
        ranges.require_inductive(
            loose, ranges.analyse(loose, ranges.bounds(needed, np.float32), np.float32), needed, np.float32
        )


@pytest.mark.parametrize(
    ("law", "named"),
    [
        (lambda u, x, k: Step({"y": 1 / u["a"]}), "division by `a`"),
        (lambda u, x, k: Step({"y": ca.sqrt(u["a"])}), "sqrt"),
        (lambda u, x, k: Step({"y": ca.log(u["a"] + 0.5)}), "log"),
    ],
)
def test_an_operation_not_safe_everywhere_is_refused(law: Any, named: str) -> None:
    with pytest.raises(EmitError) as error:
        emit(make_block(law), np.float32)
    assert named in str(error.value) and "'y' (block 'made')" in str(error.value)


@pytest.mark.parametrize(("scalar", "bound"), [(np.float32, 2e-7), (np.float64, 1e-14)])
def test_a_function_of_one_variable_becomes_a_polynomial_that_keeps_its_certificate(scalar: Any, bound: float) -> None:
    block = make_block(lambda u, x, k: Step({"y": ca.exp(-u["a"]) / (u["a"] + 1)}), low=0.25)
    emitted = emit(block, scalar)
    (surrogate,) = emitted.manifest["surrogates"]
    code = without_comments(text(emitted))
    assert surrogate["max_relative_error"] <= bound and "exp" not in code
    a = np.linspace(0.25, 1, 4001).astype(scalar)
    y = run(emitted, a).outputs["y"].astype(np.float64)
    true = np.array([math.exp(-v) / (v + 1) for v in a.astype(np.float64)])
    assert np.max(np.abs(y / true - 1)) <= surrogate["max_relative_error"] + 4e-16
    with_libm = emit(block, scalar, libm=True)
    assert not with_libm.manifest["surrogates"] and "exp" in text(with_libm)


def test_a_named_function_stays_separate_and_equal_ones_share_a_polynomial() -> None:
    def law(u: Any, x: Any, k: Any) -> Step:
        h = [ca.exp(v) for v in (u["a"], x["s"])]
        named = [(signal(f"h{i}", 0, 3), v) for i, v in enumerate(h)]
        return Step({"y": h[0] ** 2 * h[1]}, {"s": u["a"]}, named)

    emitted = emit(make_block(law, (State(signal("s"), 0),)), np.float32)
    assert [s["tag"] for s in emitted.manifest["surrogates"]] == ["h0, h1"]
    assert text(emitted).count("h0_polynomial(") == 2 and "h0 * h0" in text(emitted)


def test_constants_are_folded_but_keep_their_meaning() -> None:
    constants = [Constant("k", 3.0, "1", "gain"), Constant("h", 0.1, "1", "filter")]
    block = make_block(lambda u, x, k: Step({"y": 2 * (k["k"] * (k["h"] * u["a"])) / 4}), constants=constants)
    emitted = emit(block, np.float32)
    assert "k_times_h = 0.3" in text(emitted) and "gain; times h" in text(emitted)
    assert run(emitted, np.array([1.0])).outputs["y"][0] == pytest.approx(0.15, rel=1e-6)


def test_every_line_of_the_step_has_a_tag_and_every_tag_its_lines() -> None:
    guard = safety.guard(TIME, [safety.GuardedInput(signal("u"), 0.0, True)], 3)
    emitted = emit(guard, np.float32)
    lines = emitted.files["guard.c"].split("\n")
    start = next(i for i, line in enumerate(lines, 1) if "guard_step(" in line)
    runs = sorted(r for rs in emitted.manifest["trace"].values() for r in rs)
    assert all(first <= last for first, last in runs)
    assert all(a[1] < b[0] for a, b in pairwise(runs)) and runs[0][0] > start
    traced = {n for first, last in runs for n in range(first, last + 1)}
    statements = {n for n, line in enumerate(lines, 1) if n > start + 1 and line.strip() not in ("", "}")}
    assert {n for n in statements if "return" not in lines[n - 1]} <= traced
