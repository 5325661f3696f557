"""Reduction refuses what is not proved, drops what is idle, and keeps what is needed."""

from collections.abc import Callable
from typing import Any

import casadi as ca
import numpy as np
import pytest

from synth.block import Block, Constant, State, Step, build, clip
from synth.emit import pipeline, write
from synth.emit.passes import fold, guards
from synth.emit.pipeline import Reduced
from synth.emit.program import lower
from synth.emit.proof import ranges
from synth.errors import EmitError
from synth.signals import Signal
from synth.timing import Discrete
from tests.emit import dyadic, hazards
from tests.emit.semantics import interpret

F32, F64 = np.float32, np.float64
LIMITS = ("min", "max", "clamp")


def signal(name: str, low: float = -10, high: float = 10) -> Signal:
    return Signal(name, "1", low, high)


def make(law: Callable[..., Step], outputs: str = "y", **fields: Any) -> Block:
    inputs = [signal("a", -2, 2), signal("b", 1, 3)]
    return build(
        "made", Discrete(1e-3), law, inputs=inputs, outputs=[signal(n, -1e3, 1e3) for n in outputs.split()], **fields
    )


def reduce(block: Block, scalar: type[np.floating] = F32, **options: Any) -> Reduced:
    return pipeline.reduce(block.rounded(scalar), scalar, **options)


def count(reduced: Reduced, *ops: str) -> int:
    return sum(n.op in ops for n in reduced.program.nodes)


@pytest.mark.parametrize(
    ("law", "what"),
    [
        (lambda u, x, k: Step({"y": 1 / u["a"]}), "the division by `a` .* is not safe.* the denominator is 0 at a = 0"),
        (lambda u, x, k: Step({"y": u["b"] / (u["a"] + u["b"] - 1.5)}), "the division by .* is not safe"),
        (lambda u, x, k: Step({"y": ca.sqrt(u["a"])}), "the sqrt of `a` .* is not safe"),
        (lambda u, x, k: Step({"y": ca.log(u["a"] + 2)}), "the log of .* is not safe"),
        (lambda u, x, k: Step({"y": ca.exp(300 * u["b"])}), "is not safe: it must be a finite number"),
    ],
)
def test_an_unsafe_operation_is_refused(law: Callable[..., Step], what: str) -> None:
    with pytest.raises(EmitError, match=what):
        reduce(make(law), libm=True)


def test_an_operation_that_a_choice_makes_safe_is_accepted() -> None:
    def law(u: Any, x: Any, k: Any) -> Step:
        a, b = u["a"], u["b"]
        return Step({"y": ca.if_else(a > 0.5, b / a, ca.if_else(a < -0.5, b * b / a, 0))})

    reduced = reduce(make(law))
    assert count(reduced, "div", "inv") == 2


def filter_block(width: float, gain: float = 0.5) -> Block:
    """Return x' = gain x + (1 - gain) a limited to -width .. width; the limit is idle for width >= 2."""
    return make(
        lambda u, x, k: Step({"y": x["x"]}, {"x": gain * x["x"] + (1 - gain) * u["a"]}),
        states=[State(signal("x", -width, width), 0)],
    )


def test_an_idle_limit_is_dropped_and_a_needed_one_stays() -> None:
    assert count(reduce(filter_block(2.5)), *LIMITS) == 0
    assert count(reduce(filter_block(1.5)), *LIMITS) == 1
    assert count(reduce(filter_block(2.5, gain=2.0)), *LIMITS) == 1


def test_nested_limits_are_reduced_to_the_narrowest() -> None:
    def law(u: Any, x: Any, k: Any) -> Step:
        y = u["a"] * 3
        for width in (5.0, 7.0, 9.0):
            y = clip(y, signal("y", -width, width))
        return Step({"y": y})

    reduced = reduce(make(law))
    limits = [n for n in reduced.program.nodes if n.op in LIMITS]
    assert [reduced.program.nodes[n.args[2]].value for n in limits] == [5.0]


def test_a_choice_that_is_always_taken_is_dropped() -> None:
    def law(u: Any, x: Any, k: Any) -> Step:
        return Step({"y": ca.if_else(u["b"] > 0, u["a"], ca.exp(u["a"])), "z": ca.if_else(u["a"] > 5, u["b"], 3)}, {})

    reduced = reduce(make(law, "y z"), libm=True)
    assert count(reduced, "choose", "exp", "lt") == 0


@pytest.mark.parametrize("width", [1.5, 1.75])
def test_dropping_a_needed_limit_is_detected(width: float, monkeypatch: pytest.MonkeyPatch) -> None:
    def all_idle(program: lower.Program, proved: Any) -> dict[int, int]:
        return {k: n.args[0] for k, n in enumerate(program.nodes) if n.op in LIMITS}

    monkeypatch.setattr(guards, "find_redundant", all_idle)
    with pytest.raises(EmitError, match=rf"state 'x' may become .* but its declared bounds are -{width} .. {width} 1"):
        reduce(filter_block(width))
    reduce(filter_block(2.5))


@pytest.mark.slow
def test_a_reduced_program_computes_what_its_block_computes() -> None:
    for seed in range(40):
        block = dyadic.random_block(seed)
        reduced, x_u = reduce(block, F64), dyadic.samples(block, 8)
        plain = lower.program(block)
        constants = {c.name: c.value for c in reduced.block.constants}
        for x, u in zip(x_u[0].T, x_u[1].T, strict=True):
            loads = {
                s.name: float(v) for s, v in zip((*block.states, *block.inputs), (*x, *u), strict=True)
            } | constants
            before, after = interpret(plain, loads), interpret(reduced.program, loads)
            for ends in ("outputs", "next"):
                old, new = getattr(plain, ends), getattr(reduced.program, ends)
                assert [before[k] for k in old.values()] == [after[new[n]] for n in old]
            assert before[plain.word or 0] == after[reduced.program.word or 0]


GAINS = [Constant(n, v, "1/s", f"source of {n}") for n, v in (("k", 0.1), ("l", 0.3))]


@pytest.mark.parametrize("scalar", [F32, F64])
def test_products_of_constants_are_rounded_once_and_name_their_factors(scalar: type[np.floating]) -> None:
    reduced = reduce(make(lambda u, x, k: Step({"y": k["k"] * (k["l"] * u["a"])}), constants=GAINS), scalar)
    made = reduced.block.constants[-1]
    assert made.name == "k_times_l" and made.source == "source of k; times l"
    assert made.value == float(scalar(float(scalar(0.1)) * float(scalar(0.3))))
    assert [n.name for n in reduced.program.nodes if n.op == "constant"] == ["k_times_l"]


def test_dropping_a_limit_allows_products_of_constants() -> None:
    limited = make(lambda u, x, k: Step({"y": k["k"] * clip(k["l"] * u["a"], signal("v", -9, 9))}), constants=GAINS)
    assert [n.name for n in reduce(limited).program.nodes if n.op == "constant"] == ["k_times_l"]


def counters(law: Callable[..., Step], high: float = 7) -> Block:
    return make(law, states=[State(Signal(n, "1", 0, high), 0, True) for n in ("n", "m")])


def test_a_countdown_is_safe_by_its_condition_alone() -> None:
    def law(u: Any, x: Any, k: Any) -> Step:
        return Step({"y": u["a"]}, {"n": ca.if_else(x["n"] > 0, x["n"] - 1, 7), "m": x["m"]})

    reduce(counters(law))


def test_a_counter_that_may_overflow_32_bits_is_refused() -> None:
    def law(u: Any, x: Any, k: Any) -> Step:
        return Step({"y": ca.if_else(x["n"] + x["m"] < 3, u["a"], 0)}, {"n": ca.fmin(x["n"] + 1, 3e9), "m": x["m"]})

    with pytest.raises(EmitError, match=r"the count \(n \+ m\) is 0 .. 6e\+09, but a uint32_t holds"):
        reduce(counters(law, 3e9))


def test_an_operation_without_a_form_is_refused() -> None:
    with pytest.raises(EmitError, match="OP_ERFINV"):
        reduce(make(lambda u, x, k: Step({"y": ca.erfinv(u["a"])})))


def test_a_function_of_a_narrow_range_is_replaced_unless_libm_is_to_compute_it() -> None:
    block = make(lambda u, x, k: Step({"y": ca.exp(u["a"] / 8)}))
    reduced, kept = reduce(block, error=1e-5), reduce(block, libm=True)
    assert (
        [s.tags for s in reduced.surrogates] == [("y",)]
        and count(reduced, "polynomial") == 1
        and not count(reduced, "exp")
    )
    assert kept.surrogates == () and count(kept, "exp") == 1


def test_hazards_reduce_to_fewer_nodes() -> None:
    for block in hazards.BLOCKS:
        assert len(reduce(block).program.nodes) <= len(fold.folded(lower.program(block)).nodes)


def rotation_block(certificate: Any) -> Block:
    """Return a law whose output is within 1.5, which intervals cannot prove, with a certificate of this bound."""

    def law(u: Any, x: Any, k: Any) -> Step:
        y = clip(u["b"] * (0.4 * ca.cos(u["a"] / 2)) + u["b"] * (0.3 * ca.sin(u["a"] / 2)), signal("y", -1.51, 1.51))
        return Step({"y": y}, certified={"y": certificate})

    return make(law)


@pytest.mark.slow
def test_a_limit_that_a_certificate_proves_idle_is_not_printed() -> None:
    def proved(u: float, e: float) -> float:
        return 1.5 * (1 + e) * (1 + 6 * u)

    reduced = reduce(rotation_block(proved))
    assert count(reduced, "within") == 1 and count(reduced, "clamp") == 0
    text = write.emit(rotation_block(proved), F32).files["made.c"]
    assert "/*@ admit -1.51f <= y <= 1.51f; */" in text and "made_limit(" not in text
    assert (
        ranges.analyse(reduced.program, ranges.bounds(reduced.block, F32), F32)[reduced.program.outputs["y"]].high
        < 1.52
    )


def test_a_limit_stays_if_the_certificate_is_too_weak_or_libm_is_used() -> None:
    assert count(reduce(rotation_block(lambda u, e: 1.5101)), "clamp") == 1
    assert count(reduce(rotation_block(lambda u, e: 1.5 * (1 + e))), "clamp") == 0
    assert count(reduce(rotation_block(lambda u, e: 1.5 * (1 + e)), libm=True), "clamp") == 1
