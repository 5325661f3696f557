"""Safety proofs: an unsafe operation is refused with its place; a safe one is proved, if needed by bisection."""

import re
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import casadi as ca
import numpy as np
import pytest

from designs.maglev_5dof import control
from models import maglev_stage
from synth.block import Block, Constant, Fault, State, Step, build, clip
from synth.composition import compose
from synth.emit import pipeline, write
from synth.emit.program import lower
from synth.emit.proof import bisection, ranges, safe
from synth.emit.proof.ranges import Range
from synth.errors import EmitError
from synth.signals import Signal
from synth.timing import Discrete
from tests.emit.c_arithmetic import compute

TIME = Discrete(1e-3)
F32, F64 = np.float32, np.float64
U = Signal("u", "m", -1, 2)
V = Signal("v", "m", 0, 5)
W = Signal("w", "m", 0, 5)
Law = Callable[[Any], ca.SX]


def make(law: Law, *inputs: Signal, guarded: str = "", **fields: Any) -> Block:
    block = build(
        "made",
        TIME,
        lambda u, x, k: Step({"y": law(u)}),
        inputs=inputs or (U,),
        outputs=[Signal("y", "m", -1e6, 1e6)],
        tag="F(1)",
        **fields,
    )
    return replace(block, faults=(Fault(0, "y", guarded),)) if guarded else block


def prove(block: Block, scalar: type[np.floating] = F32) -> Mapping[str, Range]:
    block = block.rounded(scalar)
    program = lower.program(block)
    narrowed = safe.require_safe(program, ranges.analyse(program, ranges.bounds(block, scalar), scalar), block, scalar)
    return {n: narrowed[k] for n, k in (program.outputs | program.next).items()}


def refusal(block: Block, scalar: type[np.floating] = F32) -> str:
    with pytest.raises(EmitError) as caught:
        prove(block, scalar)
    return str(caught.value)


def place(text: str) -> dict[str, float]:
    """Return {signal: value in m} from an error message."""
    return {n: float(v) for n, v in re.findall(r"(\w+) = (-?[\d.]+(?:e[+-]?\d+)?)(?= m)", text)}


@pytest.mark.parametrize(
    ("law", "words"),
    [
        (lambda u: 3 / u["u"], ["the division by `u` in 'y' (block 'made', F(1))", "the denominator is 0 at u = 0 m"]),
        (lambda u: 1 / (u["u"] * u["u"]), ["the division by `(u * u)`", "the denominator is "]),
        (lambda u: ca.sqrt(u["u"]), ["the sqrt of `u`", "must not be negative", "the argument is -1 at u = -1 m"]),
        (lambda u: ca.sqrt(u["u"] + 0.5), ["the sqrt of `(u + 0.5)`", "the argument is -0.5 at u = -1 m"]),
        (lambda u: ca.log(u["u"]), ["the log of `u`", "must be positive", "the argument is -1 at u = -1 m"]),
        (lambda u: ca.log(1 + u["u"]), ["the argument is 0 at u = -1 m"]),
        (lambda u: ca.asin(u["u"]), ["the asin of `u`", "must lie in -1 .. 1", "1 - |argument| is -1 at u = 2 m"]),
        (lambda u: ca.acos(2 * u["u"]), ["the acos of", "1 - |argument| is -3 at u = 2 m"]),
        (
            lambda u: ca.tan(u["u"]),
            ["the tan of `u`", "away from the poles", "the cosine of the argument passes through 0"],
        ),
        (lambda u: ca.atan2(u["u"], u["u"]), ["the atan2 of `u`, `u`", "must not both be 0", "is 0 at u = 0 m"]),
        (lambda u: 1e30 / (1e-20 + u["u"] ** 2), ["leave the quotient finite", "violated"]),
        (
            lambda u: ca.exp(100 * u["u"]),
            ["output 'y' = `exp(100 * u)`", "must be a finite number", "violated", "at u = "],
        ),
        (lambda u: 1 + 2 * ca.exp(100 * u["u"]), ["output 'y' = ", "it begins at `exp(100 * u)`"]),
    ],
)
def test_a_violation_is_named_with_signal_argument_and_point(law: Law, words: list[str]) -> None:
    text = refusal(make(law))
    assert all(w in text for w in [*words, "violated", "narrow the ranges"]), text


def test_the_point_of_a_crossing_is_where_the_denominator_vanishes() -> None:
    text = refusal(make(lambda u: 1 / (u["u"] - 0.3)))
    assert "violated" in text and place(text)["u"] == pytest.approx(0.3, abs=1e-6)
    assert place(refusal(make(lambda u: ca.tan(u["u"]))))["u"] == pytest.approx(np.pi / 2, abs=1e-6)


def determinant(cross: float) -> Law:
    """1 / (a d - b c) with a = 1 + v, d = 1 + w, b = v, c = cross w."""
    return lambda u: 1 / ((1 + u["v"]) * (1 + u["w"]) - u["v"] * (cross * u["w"]))


@pytest.mark.parametrize("scalar", [F32, F64])
def test_a_determinant_is_proved_by_bisection_alone(scalar: type[np.floating]) -> None:
    block = make(determinant(1.0), V, W)
    program = lower.program(block)
    plain = ranges.analyse(program, ranges.bounds(block, scalar), scalar)
    assert not plain[program.outputs["y"]].finite
    y = prove(block, scalar)["y"]  # the determinant is 1 + v + w, from 1 to 11
    assert 0 < y.low <= 1 / 11 and 1 <= y.high < 1000


@pytest.mark.parametrize("scalar", [F32, F64])
def test_a_singular_determinant_is_refused_at_a_singular_point(scalar: type[np.floating]) -> None:
    text = refusal(make(determinant(1.5), V, W), scalar)
    at = place(text)
    assert "violated: the denominator " in text
    assert abs((1 + at["v"]) * (1 + at["w"]) - 1.5 * at["v"] * at["w"]) < 1e-5 and 0 <= min(at.values()) <= 5
    assert "violated" in refusal(make(determinant(1.45), V, W), scalar)  # 36 - 36.25 in one corner
    prove(make(determinant(1.42), V, W), scalar)  # 36 - 35.5 there


def test_an_undecided_claim_is_reported_as_not_proved() -> None:
    law: Law = lambda u: 1 / (u["v"] * u["v"] - 2 * u["v"] * u["w"] + u["w"] * u["w"] + 1e-9)  # noqa: E731
    text = refusal(make(law, V, W), F64)
    assert "not proved in" in text and "violated" not in text and "in the cell v = " in text


def test_a_jump_over_zero_is_not_a_zero() -> None:
    y = prove(make(lambda u: 1 / ca.if_else(u["u"] > 0, 1, -2)))["y"]
    assert (y.low, y.high) == (-0.5, 1)


def test_dependent_values_are_bisected_together() -> None:
    prove(make(lambda u: 1 / (1 + ca.fmax(u["u"], 0) - u["u"]), Signal("u", "m", -1, 1)))


def test_limited_values_are_leaves_if_there_are_too_many_loads() -> None:
    loads = [Signal(f"{n}{i}", "m", -1, 3) for n in "vw" for i in range(4)]

    def law(u: Any) -> ca.SX:
        v, w = (ca.fmax(ca.fmin(sum(u[f"{n}{i}"] for i in range(4)), 5), 0) for n in "vw")
        return determinant(1.0)({"v": v, "w": w})

    prove(make(law, *loads))
    singular: Law = lambda u: law(u) / (law(u) - 0.25)  # noqa: E731
    assert "v0 = " in refusal(make(singular, *loads))  # a refusal names loads


def test_an_arm_is_checked_under_its_condition() -> None:
    prove(make(lambda u: ca.if_else(u["u"] > 0.1, 1 / u["u"], 0)))
    prove(make(lambda u: ca.if_else(u["u"] < 0, 2, ca.sqrt(u["u"]))))
    prove(make(lambda u: ca.if_else(ca.logic_and(u["u"] > 0, u["u"] <= 1), ca.sqrt(u["u"]), 0), guarded="u"))
    assert "violated" in refusal(make(lambda u: ca.if_else(u["u"] > -0.1, 1 / u["u"], 0)))
    assert "the sqrt of `u`" in refusal(make(lambda u: ca.if_else(u["u"] <= 0, 2, 1) * ca.sqrt(u["u"])))
    both: Law = lambda u: ca.if_else(u["u"] > 0.1, 1 / u["u"], 0) + ca.sin(1 / u["u"])  # noqa: E731
    assert "violated" in refusal(make(both))


GUARDED: list[Law] = [
    lambda u: ca.if_else(u["z"] > u["w"] + 1e-3, 1 / (u["z"] - u["w"]), 0),
    lambda u: ca.if_else(u["z"] > u["w"] + 1e-3, 1 / (u["w"] - u["z"]), 0),
    lambda u: ca.if_else(u["z"] - 1e-3 >= u["w"], 1 / (u["z"] - u["w"]), 0),
    lambda u: ca.if_else(u["z"] < u["w"] + 1e-3, 0, u["w"] / (u["z"] - u["w"])),
    lambda u: ca.if_else(u["z"] + 1e-3 < u["w"], ca.sqrt(u["w"] - u["z"]), 0),
    lambda u: ca.if_else(u["z"] - u["w"] > 1e-3, ca.log(u["z"] - u["w"]), 0),
    lambda u: ca.if_else(u["z"] > u["w"] + 1e-2, 1 / (u["z"] - u["w"]) ** 2, 0),
    lambda u: ca.if_else(u["z"] > u["w"] + 1e-2, 1 / ((u["z"] - u["w"]) * (2 + u["w"])), 0),
    lambda u: ca.if_else(u["z"] > u["w"] + 1e-2, 1 / ca.sqrt(u["z"] - u["w"]), 0),
    lambda u: ca.if_else(2 * u["z"] - 2 * u["w"] > 1e-3, 1 / (u["z"] - u["w"]), 0),
    lambda u: ca.if_else(3 * u["z"] > 3 * u["w"] + 1e-3, ca.log(u["z"] - u["w"]), 0),
    lambda u: ca.if_else(u["z"] - u["w"] > 1e-3, 1 / (2 * u["z"] - 2 * u["w"]), 0),
    lambda u: ca.if_else(3 * u["w"] - 2 * u["z"] < -1e-3, ca.sqrt(u["z"] - 1.5 * u["w"]), 0),
    lambda u: ca.if_else(2 * u["z"] + 2 * u["w"] + 0.5 > 0.501, u["w"] / (u["z"] + u["w"]), 0),
    lambda u: ca.if_else(2 * (u["z"] - u["w"]) > 0.5, 1 / (u["z"] - u["w"] - 0.2), 0),
    lambda u: ca.if_else(ca.fabs(2 * u["z"] - 2 * u["w"]) > 1e-2, 1 / (u["w"] - u["z"]), 0),
    lambda u: ca.if_else(u["z"] > 0.1, 1 / u["z"], 0) + ca.if_else(u["z"] > 0.2, 2 / u["z"], u["w"]),
    lambda u: ca.if_else(u["z"] > 0.1, 1 / u["z"], 0) + ca.if_else(u["z"] < -0.1, u["w"] / u["z"], u["w"]),
    lambda u: ca.if_else(u["z"] > 0.1, ca.log(u["z"]), 0) * ca.if_else(u["w"] + u["z"] > 2, ca.log(u["z"]), 1),
    lambda u: ca.if_else(ca.fabs(u["z"]) > 0.1, 1 / u["z"], 0) + ca.if_else(u["z"] <= 0.2, 0, 1 / u["z"]),
    lambda u: ca.if_else(u["w"] > 0, ca.if_else(u["z"] > 0.1, 1 / u["z"], 0), ca.if_else(u["z"] > 0.3, 1 / u["z"], 0)),
    lambda u: 1 / ca.if_else(u["z"] >= 0, 1, -1e-6),
    lambda u: 1 / (u["z"] + ca.if_else(u["z"] >= 0, 1e-6, -1e-6)),
    lambda u: 1 / (u["z"] + u["w"] + ca.if_else(u["z"] + u["w"] >= 0, 1e-3, -1e-3)),
    lambda u: u["w"] / (ca.if_else(u["z"] < 0.25, -3, u["z"])),
    lambda u: 1 / (ca.sign(u["z"]) - 0.5),
    lambda u: 1 / (ca.ceil(2 * (u["z"] + u["w"])) + 0.5),
    lambda u: ca.if_else(u["w"] < 0, 1 / (u["z"] + ca.copysign(1e-3, u["z"])), 0),
    lambda u: ca.if_else(u["w"] < 0, 1 / (u["z"] - u["w"] + ca.copysign(1e-3, u["z"] - u["w"])), 0),
    lambda u: ca.if_else(u["w"] + 0.1 < u["z"], u["z"] / (ca.floor(3 * u["z"]) - 0.25), 0),
    lambda u: ca.if_else(ca.fabs(u["z"]) > 0.1, 1 / u["z"], 0),
    lambda u: ca.if_else(ca.fabs(u["z"]) >= 1e-3, u["w"] / u["z"], 0),
    lambda u: ca.if_else(ca.fabs(u["z"]) < 0.1, 0, u["w"] / u["z"]),
    lambda u: ca.if_else(u["z"] * u["z"] > 0.01, 1 / u["z"], 0),
    lambda u: ca.if_else(ca.fabs(u["z"]) > 0.1, u["w"] / u["z"], ca.if_else(ca.fabs(u["w"]) > 0.1, 1 / u["w"], 0)),
    lambda u: u["w"] / (u["z"] + ca.if_else(u["z"] >= 0, 0.1, -0.1)),
]
UNGUARDED: list[Law] = [
    lambda u: ca.if_else(u["z"] > u["w"] - 1e-3, 1 / (u["z"] - u["w"]), 0),
    lambda u: ca.if_else(u["z"] >= u["w"], 1 / (u["z"] - u["w"]), 0),
    lambda u: ca.if_else(2 * u["z"] - 2 * u["w"] > -1e-3, 1 / (u["z"] - u["w"]), 0),
    lambda u: ca.if_else(2 * u["z"] - u["w"] > 1e-3, 1 / (u["z"] - u["w"]), 0),
    lambda u: ca.if_else(2 * u["z"] - 2 * u["w"] > 0.5, 1 / (u["z"] - u["w"] - 0.3), 0),
    lambda u: ca.if_else(ca.fabs(2 * u["z"] - 2 * u["w"]) > -1e-2, 1 / (u["w"] - u["z"]), 0),
    lambda u: ca.if_else(2 * u["w"] - 2 * u["z"] > 1e-3, ca.log(u["z"] - u["w"]), 0),
    lambda u: ca.if_else(u["z"] + 1e-3 > u["w"], 0, 1 / (u["z"] - u["w"] + 0.5)),
    lambda u: ca.if_else(u["z"] > u["w"] + 1e-3, 1 / (u["z"] + u["w"]), 0),
    lambda u: ca.if_else(u["z"] < u["w"] + 1e-3, ca.log(u["z"] - u["w"]), 0),
    lambda u: ca.if_else(u["z"] > 0.1, 1 / u["z"], 0) + ca.if_else(u["z"] < 0.2, 2 / u["z"], u["w"]),
    lambda u: ca.if_else(u["z"] > 0.1, 1 / u["z"], 0) + ca.if_else(u["w"] > 0.1, 1 / u["z"], u["w"]),
    lambda u: ca.if_else(u["z"] > 0.1, 1 / u["z"], 0) + ca.sin(1 / u["z"]),
    lambda u: ca.if_else(u["z"] > 0.1, ca.sqrt(u["z"]), 0) + ca.if_else(u["z"] > -0.1, ca.sqrt(u["z"]), 0),
    lambda u: ca.if_else(u["w"] > 0, ca.if_else(u["z"] > 0.1, 1 / u["z"], 0), ca.if_else(u["z"] < 1, 1 / u["z"], 0)),
    lambda u: 1 / ca.if_else(u["z"] > 0, u["z"], -1 - u["z"]),
    lambda u: 1 / (u["z"] + ca.if_else(u["z"] >= -0.5, 1e-6, -1e-6)),
    lambda u: 1 / (ca.sign(u["z"]) + ca.sign(u["w"])),
    lambda u: 1 / ca.copysign(u["w"], u["z"]),
    lambda u: 1 / (ca.sign(u["z"]) - 1),
    lambda u: ca.if_else(ca.fabs(u["z"]) >= 0, 1 / u["z"], 0),
    lambda u: ca.if_else(ca.fabs(u["z"]) < 0.1, 1 / u["z"], 0),
    lambda u: ca.if_else(u["z"] * u["z"] < 0.01, 1 / u["z"], 0),
    lambda u: ca.if_else(ca.fabs(u["w"]) > 0.1, 1 / u["z"], 0),
    lambda u: ca.if_else(ca.fabs(u["z"] - 0.5) > 0.1, 1 / u["z"], 0),
]
ROOTS: list[Law] = [
    lambda u: ca.sqrt(1 - u["z"] ** 2),
    lambda u: ca.sqrt(u["z"] ** 2 + u["w"] ** 2),
    lambda u: ca.sqrt(u["z"] ** 2 + 2 * u["w"] ** 2),
    lambda u: ca.sqrt(0.5 * (u["z"] * u["z"] + u["w"] * u["w"])),
    lambda u: ca.sqrt((u["z"] - u["w"]) ** 2 + u["w"] ** 2),
    lambda u: ca.sqrt(ca.fabs(u["z"]) * ca.fabs(u["w"]) + u["w"] ** 2),
]
NO_ROOTS: list[Law] = [
    lambda u: ca.sqrt(u["z"] ** 2 - u["w"] ** 2),
    lambda u: ca.sqrt(u["z"] ** 2 + u["z"] * u["w"]),
    lambda u: ca.sqrt(u["z"] * ca.fabs(u["w"]) + u["w"] ** 2),
]
BOTH_SIDES = (Signal("z", "m", -1, 1), Signal("w", "m", -1, 1))


@pytest.mark.parametrize("scalar", [F32, F64])
@pytest.mark.parametrize("law", [*GUARDED, *ROOTS])
def test_what_a_condition_a_square_or_a_jump_keeps_from_zero_is_accepted(law: Law, scalar: type[np.floating]) -> None:
    pipeline.reduce(make(law, *BOTH_SIDES).rounded(scalar), scalar)


@pytest.mark.parametrize("law", [*UNGUARDED, *NO_ROOTS])
def test_a_condition_that_leaves_zero_guards_nothing(law: Law) -> None:
    block = make(law, *BOTH_SIDES)
    with pytest.raises(EmitError, match="violated") as caught:
        pipeline.reduce(block.rounded(F32), F32)
    program, at = lower.program(block), {"z": 0.0, "w": 0.0} | place(str(caught.value))
    values = compute(program, at, F32)  # at a counterexample
    assert "passes through 0" in str(caught.value) or not np.isfinite(values[program.outputs["y"]]), caught.value


def test_an_arm_is_bisected_under_its_condition() -> None:
    def law(u: Any, limit: float) -> ca.SX:
        return ca.if_else(u["v"] * u["w"] < limit, 1 / (1 + u["v"] * u["w"] - 0.25 * u["v"] * u["w"] * u["w"]), 0)

    prove(make(lambda u: law(u, 0.5), V, W))  # 1 + p - 0.25 p w > 0.375 where p < 0.5, w <= 5
    assert "violated" in refusal(make(lambda u: law(u, 20.0), V, W))


def test_an_input_that_is_not_guarded_is_seen_at_the_output() -> None:
    text = refusal(make(lambda u: u["u"] + 1, guarded="u"))
    assert "output 'y'" in text and "it begins at `u`" in text and "its operands are unbounded" in text


def test_next_states_and_counters_are_checked() -> None:
    def kept(next: Callable[[ca.SX], ca.SX], integer: bool) -> Block:
        states = [State(Signal("s", "1", 0, 5), 0, integer)]
        law = lambda u, x, k: Step({"y": 0}, {"s": next(x["s"])})  # noqa: E731
        return build("kept", TIME, law, inputs=[U], outputs=[Signal("y", "m", -1, 1)], states=states)

    prove(kept(lambda s: ca.fmin(s + 1, 5), True))
    prove(kept(lambda s: s > 2, True))
    assert "not always whole" in refusal(kept(lambda s: 0.5 * s, True))
    assert "may become -1 .. 4" in refusal(kept(lambda s: s - 1, True))
    assert "may become 5e+09 .. 5e+09" in refusal(kept(lambda s: s + 5e9, True), F64)
    block = kept(lambda s: s, False)
    endless = replace(block, next={"s": ca.exp(50 * block.symbol["s"])})
    assert "next state 's'" in refusal(endless)


def test_a_signal_inside_a_composition_is_named_with_its_block() -> None:
    inner = build(
        "inner",
        TIME,
        lambda u, x, k: Step({"gap": u["u"] * k["gain"]}),
        inputs=[U],
        outputs=[Signal("gap", "m", -2, 4)],
        constants=[Constant("gain", 2.0, "1", "test")],
    )
    outer = build(
        "outer",
        TIME,
        lambda u, x, k: Step({"y": 1 / (1 + u["gap"])}),
        inputs=[Signal("gap", "m", -2, 4)],
        outputs=[Signal("y", "1/m", -9, 9)],
        tag="F(7)",
    )
    text = refusal(compose("whole", [inner, outer], inputs=["u"], outputs=["y"]))
    assert "the division by `(1 + gap)` in 'y' (block 'outer', F(7))" in text and "at u = -0.5 m" in text


def test_a_controller_is_safe() -> None:
    block = control.controller(maglev_stage.plant()).block
    assert all(r.finite for r in prove(block).values())


# --- planted defects of the proof itself ---


def test_a_proof_at_points_alone_would_accept_a_singular_law(monkeypatch: pytest.MonkeyPatch) -> None:
    """The refusals above rest on bisection: with a bisection that looks at the middle alone they fall silent."""
    whole = bisection.prove

    def middle_only(low: Any, high: Any, is_whole: Any, judge: Any, signed: bool, budget: int = 0) -> bisection.Verdict:
        middle = low + (high - low) / 2
        return whole(middle, middle, is_whole, judge, signed)

    block = make(lambda u: 1 / (u["u"] - 0.3))
    assert "violated" in refusal(block)
    monkeypatch.setattr(bisection, "prove", middle_only)
    prove(block)


def test_a_divisor_clamped_between_numbers_is_refused_where_it_is_zero() -> None:
    """The clamp's limits are single numbers while its argument is bisected."""
    signals = [Signal(name, "1", -1, 1) for name in "abc"]

    def law(u: Any) -> ca.SX:
        held = clip(u["a"] * u["b"] + 0.3 * u["a"] - u["b"] * u["c"], Signal("held", "1", -0.5, 0.5))
        return 1 / (held * u["a"] - 0.2 + 0.01 * u["b"])

    with pytest.raises(EmitError, match=r"clamp\(.*denominator must exclude 0"):
        write.emit(make(law, *signals), F32)
