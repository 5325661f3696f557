"""Ranges against programs computed state by state: rounded, contracted, with a libm that errs."""

from collections.abc import Callable
from dataclasses import replace
from math import inf
from typing import Any

import casadi as ca
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from designs.maglev_5dof import control
from models import maglev_stage
from synth.block import Block, Constant, Fault, State, Step, build, clip
from synth.blocks.guard import safety
from synth.emit.passes import guards
from synth.emit.program import lower
from synth.emit.program.lower import Node, Program
from synth.emit.proof import ranges
from synth.emit.proof.ranges import Arithmetic, Range
from synth.errors import EmitError
from synth.signals import Signal
from synth.timing import Discrete
from tests.emit.c_arithmetic import compute, outside_range, programs, states

TIME = Discrete(1e-3)
F32, F64 = np.float32, np.float64


def signal(name: str, low: float = -10, high: float = 10) -> Signal:
    return Signal(name, "m", low, high)


def make(law: Callable[..., Step], inputs: tuple[Signal, ...], **fields: Any) -> Block:
    names = fields.pop("outputs", ("y",))
    return build("made", TIME, law, inputs=inputs, outputs=[signal(n, -1e6, 1e6) for n in names], **fields)


def analyse(block: Block, scalar: type[np.floating] = F32) -> tuple[Program, tuple[Range, ...]]:
    program = lower.program(block.rounded(scalar))
    return program, ranges.analyse(program, ranges.bounds(block, scalar), scalar)


def of_output(law: Callable[..., ca.SX], *inputs: Signal, guarded: str = "", scalar: type[np.floating] = F32) -> Range:
    block = make(lambda u, x, k: Step({"y": law(u)}), inputs)
    if guarded:
        block = replace(block, faults=(Fault(0, "y", guarded),))
    program, node_ranges = analyse(block, scalar)
    return node_ranges[program.outputs["y"]]


# --- every value lies in its range ---


@pytest.mark.slow
@pytest.mark.parametrize("scalar", [F32, F64])
@settings(max_examples=250, deadline=None, derandomize=True, suppress_health_check=list(HealthCheck))
@given(drawing=programs(), seed=st.integers(0, 2**32))
def test_no_value_leaves_its_range(
    scalar: type[np.floating], drawing: tuple[Program, dict[str, Range]], seed: int
) -> None:
    program, box = drawing
    box = {n: Range(float(scalar(r.low)), float(scalar(r.high)), r.nan) for n, r in box.items()}
    node_ranges, rng = ranges.analyse(program, box, scalar), np.random.default_rng(seed)
    same = guards.find_redundant(program, node_ranges)
    for loads in states(program, box, rng, 8):
        for choices in (None, rng):
            values = compute(program, loads, scalar, choices)
            assert not outside_range(values, node_ranges), (
                loads,
                [(k, values[k], node_ranges[k]) for k in outside_range(values, node_ranges)],
            )
        plain = compute(program, loads, scalar)
        for k, a in same.items():  # equal to the bit, signs of zeros included
            assert (np.isnan(plain[k]) and np.isnan(plain[a])) or plain[k].tobytes() == plain[a].tobytes(), (
                loads,
                k,
                a,
            )


# --- planted defects: each precaution, left out, is found out ---


def without(arithmetic: Arithmetic, program: Program, box: dict[str, Range]) -> list[Range]:
    """Return the ranges that an analysis without a precaution gives."""
    R = ranges.enclose(
        ranges.structure(program), arithmetic, ranges.loads(program, box, F32), range(len(program.nodes))
    )
    return [Range(float(R[k].low[0]), float(R[k].high[0]), bool(R[k].nan[0])) for k in range(len(R))]


def escapes_range(program: Program, box: dict[str, Range], node_ranges: Any, loads: dict[str, float]) -> bool:
    return any(outside_range(compute(program, loads, F32, np.random.default_rng(i)), node_ranges) for i in range(40))


@pytest.mark.parametrize("way", ["neg", "choose", "min", ""])
def test_contraction_of_sums_is_included_in_the_range(way: str) -> None:
    a, b = float(F32(1.1)), float(F32(1.3))
    nodes = [Node("input", name="a"), Node("input", name="b"), Node("mul", (0, 1)), Node("literal", value=a * b)]
    nodes.append(Node("literal", value=100.0))
    nodes += {"neg": [Node("neg", (2,))], "choose": [Node("choose", (0, 2, 1))], "min": [Node("min", (2, 4))]}.get(
        way, []
    )
    product = len(nodes) - 1 if way else 2
    program = Program((*nodes, Node("add" if way == "neg" else "sub", (product, 3))), (), {"y": len(nodes)}, {})
    box = {"a": Range(a, a), "b": Range(b, b)}
    assert not escapes_range(program, box, ranges.analyse(program, box, F32), {"a": a, "b": b})
    assert escapes_range(program, box, without(Arithmetic(F32, contracted=False), program, box), {"a": a, "b": b})


def test_the_error_of_libm_is_included_in_the_range() -> None:
    program = Program((Node("input", name="a"), Node("sinh", (0,))), (), {"y": 1}, {})
    box = {"a": Range(0.7, 0.7)}
    assert not escapes_range(program, box, ranges.analyse(program, box, F32), {"a": 0.7})
    assert escapes_range(program, box, without(Arithmetic(F32, ulps=0), program, box), {"a": 0.7})


def test_a_range_too_narrow_by_one_float_is_detected() -> None:
    program, node_ranges = analyse(make(lambda u, x, k: Step({"y": 3 * u["a"]}), (signal("a", -2, 1.7),)))
    values = compute(program, {"a": 1.7}, F32)
    k = program.outputs["y"]
    assert node_ranges[k].high == values[k] and not outside_range(values, node_ranges)
    assert outside_range(values, [replace(r, high=float(np.nextafter(F32(r.high), F32(-inf)))) for r in node_ranges])


# --- guards and conditions ---

U = signal("u", -0.25, 0.75)


def guard(u: Any) -> ca.SX:
    return ca.if_else(ca.logic_and(u["u"] >= -0.25, u["u"] <= 0.75), u["u"], u["last"])


@pytest.mark.parametrize(
    ("law", "expected"),
    [
        (guard, Range(-0.25, 0.75)),
        (lambda u: 2 - guard(u), Range(1.25, 2.25)),
        (lambda u: ca.if_else(ca.fabs(u["u"]) <= 0.5, u["u"], 0), Range(-0.5, 0.5)),
        (lambda u: ca.if_else(ca.fabs(-u["u"]) <= 0.5, 4 * u["u"], 0), Range(-2, 2)),
        (lambda u: ca.if_else(u["u"] == 3, u["u"], 0), Range(0, 3)),
        (lambda u: ca.if_else(ca.logic_not(u["u"] != 3), u["u"], 2), Range(2, 3)),
        (lambda u: ca.fmax(ca.fmin(u["u"], 0.75), -0.25), Range(-0.25, 0.75)),
        # Planted defects: a side that is not limited, a limit on another signal, a clamp that passes NaN,
        # and two comparisons that both fail for it.
        (lambda u: ca.if_else(u["u"] <= 0.75, u["u"], u["last"]), Range(-inf, 0.75)),
        (lambda u: ca.if_else(ca.logic_and(u["u"] >= -0.25, u["last"] <= 0.75), u["u"], 0), Range(-0.25, inf)),
        (lambda u: ca.fmax(-0.25, ca.fmin(0.75, u["u"])), Range(-0.25, 0.75, True)),
        (lambda u: ca.if_else(ca.logic_or(u["u"] < -0.25, u["u"] > 0.75), 2, u["u"]), Range(-0.25, 2, True)),
        # What is not below something that may be no number need not be above it.
        (lambda u: ca.if_else(u["last"] / 2 <= ca.fmax(0, ca.fmin(0.5, u["u"])), 1, u["last"] / 2), Range(-0.125, 1)),
    ],
)
def test_a_guard_bounds_any_bit_pattern(law: Callable[..., ca.SX], expected: Range) -> None:
    assert of_output(law, U, replace(U, name="last"), guarded="u") == expected


@pytest.mark.parametrize(
    ("law", "expected"),
    [
        (lambda u: ca.if_else(u["u"] < 0, -u["u"], u["u"]), Range(0, 0.75)),
        (lambda u: ca.if_else(u["u"] > 0.5, 1 / u["u"], 0), Range(0, 2)),
        (lambda u: ca.if_else(ca.logic_or(u["u"] < -0.125, u["u"] > 0.5), 7, 2 * u["u"]), Range(-0.25, 7)),
        (lambda u: ca.if_else(ca.logic_and(u["u"] > -1, u["v"] < u["u"]), u["v"], 0), Range(-0.5, 0.75)),
        (lambda u: ca.if_else(u["u"] <= 1, 3, 1 / u["u"]), Range(3, 3)),
        (lambda u: ca.if_else(u["u"] > 0.75, 1 / u["u"], 3), Range(3, 3)),
        (lambda u: ca.if_else(u["v"] == 1, 7, u["v"]), Range(-0.5, 7)),
        (lambda u: ca.if_else(ca.logic_and(u["u"] < 0, u["u"] > 0.5), 100, 1), Range(1, 1)),
        (lambda u: ca.if_else(ca.logic_or(u["u"] <= 0.5, u["u"] >= 0.25), 1, 100), Range(1, 1)),
        (lambda u: u["u"] < 0.8, Range(1, 1)),
        (lambda u: u["u"] > 0.75, Range(0, 0)),
        (lambda u: u["u"] >= 0.75, Range(0, 1)),
        (lambda u: u["u"] * u["u"], Range(0, 0.5625)),
    ],
)
def test_conditions_narrow_what_they_compare(law: Callable[..., ca.SX], expected: Range) -> None:
    y = of_output(law, U, signal("v", -0.5, 2))
    # Contraction and the neighbours of a strict bound take a unit or two.
    assert [y.low, y.high] == pytest.approx([expected.low, expected.high], rel=1e-6) and not y.nan


def counter(law: Callable[..., ca.SX], high: float = 5) -> Range:
    block = make(
        lambda u, x, k: Step({"y": 0}, {"n": law(u, x["n"])}), (U,), states=[State(signal("n", 0, high), 0, True)]
    )
    program, node_ranges = analyse(block)
    return node_ranges[program.next["n"]]


def test_counters_are_whole() -> None:
    assert counter(lambda u, n: ca.if_else(u["u"] > 0, ca.fmin(n + 1, 5), 0)) == Range(0, 5)
    assert counter(lambda u, n: ca.if_else(n < 5, n + 1, n)) == Range(1, 5)
    assert counter(lambda u, n: ca.if_else(n, 7 - n, 3)) == Range(2, 6)
    assert counter(lambda u, n: ca.if_else(n / 2 < 2.5, n + 1, n)) == Range(0, 6)  # says nothing of n itself


# --- what follows for clamps, and for the states ---


def clamped_state(low: float, high: float, gain: float = 1.0) -> tuple[Block, Program, dict[int, int]]:
    """Return a Block whose state takes gain * u, u in -1 .. 1, clamped to low .. high."""
    block = make(
        lambda u, x, k: Step({"y": x["s"]}, {"s": gain * u["u"]}),
        (signal("u", -1, 1),),
        states=[State(signal("s", low, high), 0)],
    )
    program, node_ranges = analyse(block)
    ranges.require_inductive(program, node_ranges, block, F32)
    return block, program, guards.find_redundant(program, node_ranges)


def test_only_a_clamp_that_never_acts_is_redundant() -> None:
    for low, high, expected in ((-1, 1, "input"), (-2, 1.5, "input"), (-1, 0.99999, "min"), (-0.99, 3, None)):
        _, program, same = clamped_state(low, high)
        replacement = same.get(program.next["s"])
        assert (None if replacement is None else program.nodes[replacement].op) == expected
    _, program, same = clamped_state(-1, 3)
    assert {program.nodes[k].op for k in same} == {"min", "max"}
    _, program, same = clamped_state(-0.5, 3)
    assert {program.nodes[k].op for k in same} == {"min"}


def redundant_of(law: Callable[..., ca.SX], *inputs: Signal, guarded: str = "") -> list[str]:
    block = make(lambda u, x, k: Step({"y": law(u)}), inputs)
    block = replace(block, faults=(Fault(0, "y", guarded),)) if guarded else block
    program, node_ranges = analyse(block)
    return [program.nodes[k].op for k in guards.find_redundant(program, node_ranges)]


def test_nan_or_a_tie_of_zeros_keeps_a_clamp() -> None:
    assert redundant_of(lambda u: ca.fmin(u["u"], 3), U) == ["min"]
    assert redundant_of(lambda u: ca.fmin(u["u"], 3), U, guarded="u") == []
    assert redundant_of(lambda u: ca.fmax(u["u"], 0), signal("u", 0, 3)) == []  # of -0 and 0 it gives 0
    assert redundant_of(lambda u: ca.fmax(0, u["u"]), signal("u", 0, 3)) == ["max"]
    assert redundant_of(lambda u: ca.if_else(u["u"] < 1, u["u"], u["v"]), U, signal("v")) == ["choose"]
    assert redundant_of(lambda u: ca.if_else(u["u"] < 0.5, u["u"], u["v"]), U, signal("v")) == []


def test_a_state_that_leaves_its_bounds_is_named() -> None:
    block, _, _ = clamped_state(-0.5, 0.5)
    grown = replace(block, next={"s": clip(block.symbol["u"], signal("s", -0.5, 0.75))})
    with pytest.raises(
        EmitError, match=r"state 's' may become -0\.5 \.\. 0\.75 m, but its declared bounds are -0\.5 \.\. 0\.5 m"
    ):
        ranges.require_inductive(*analyse(grown), grown, F32)
    passing = replace(block, next={"s": ca.fmin(0.5, ca.fmax(-0.5, block.symbol["u"]))}, faults=(Fault(0, "y", "u"),))
    with pytest.raises(EmitError, match="or NaN"):
        ranges.require_inductive(*analyse(passing), passing, F32)
    many = make(lambda u, x, k: Step({"y": 0}, {"n": x["n"] + 1}), (U,), states=[State(signal("n", 0, 5), 0, True)])
    with pytest.raises(EmitError, match=r"state 'n' may become 1 \.\. 6"):
        ranges.require_inductive(*analyse(many), many, F32)


def test_bounds_are_those_of_the_layout() -> None:
    block = make(
        lambda u, x, k: Step({"y": k["k"] * u["u"]}, {"s": x["s"]}),
        (signal("u", -0.1, 0.1), signal("v")),
        states=[State(signal("s", -0.3, 0.7), 0)],
        constants=[Constant("k", 0.1, "1", "test")],
    )
    box = ranges.bounds(replace(block, faults=(Fault(3, "y", "v"),)), F32)
    tenth = float(F32(0.1))
    assert box["u"] == Range(-tenth, tenth) and box["k"] == Range(tenth, tenth) and box["v"] == Range(-inf, inf, True)
    assert box["s"] == Range(float(F32(-0.3)), float(F32(0.7)))
    huge = replace(block, constants=(Constant("k", 1e39, "1", "test"),))
    with pytest.raises(EmitError, match="constant 'k' is not finite in float"):
        ranges.bounds(huge, F32)


def test_unknown_loads_and_operations_are_refused() -> None:
    program = Program((Node("input", name="a"), Node("gamma", (0,))), (), {"y": 1}, {})
    with pytest.raises(EmitError, match="operation 'gamma' has no enclosure"):
        ranges.analyse(program, {"a": Range(0, 1)}, F32)
    with pytest.raises(EmitError, match="input 'a' has no range"):
        ranges.analyse(program, {}, F32)


# --- a whole controller ---


def test_a_guard_block_outputs_numbers_within_range() -> None:
    block = safety.guard(TIME, [safety.GuardedInput(signal("u", -1, 2), 0.5, True)], 4)
    program, node_ranges = analyse(block)
    assert node_ranges[program.outputs["u_held"]] == Range(-1, 2) == node_ranges[program.next["last_u"]]
    ranges.require_inductive(program, node_ranges, block, F32)


def test_the_values_of_a_controller_lie_in_its_ranges() -> None:
    block = control.controller(maglev_stage.plant()).block.rounded(F32)
    program = lower.program(block)
    box, rng = ranges.bounds(block, F32), np.random.default_rng(1)
    node_ranges = ranges.analyse(program, box, F32)
    ranges.require_inductive(program, node_ranges, block, F32)
    assert all(node_ranges[k].finite for k in program.outputs.values())
    for loads in states(program, box, rng, 25):
        assert not outside_range(compute(program, loads, F32, rng), node_ranges)
