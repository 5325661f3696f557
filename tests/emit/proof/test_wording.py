"""Descriptions of nodes: expressions in C syntax, signals by name, values with units."""

import numpy as np

from synth.block import ComputedSignal, State, Step, build
from synth.emit.program import lower
from synth.emit.program.lower import Node, Program
from synth.emit.proof import conditions
from synth.signals import Signal
from synth.timing import Discrete

A, B = Node("input", name="a"), Node("input", name="b")


def text(*nodes: Node) -> str:
    return conditions.expression(Program((A, B, *nodes), (), {}, {}), len(nodes) + 1)


def test_operations_are_spelled_as_in_c() -> None:
    assert text(Node("add", (0, 1)), Node("sq", (2,))) == "((a + b) * (a + b))"
    assert text(Node("lt", (0, 1)), Node("not", (2,)), Node("choose", (3, 0, 1))) == "((!(a < b)) ? a : b)"
    assert text(Node("neg", (0,)), Node("when", (1, 2))) == "(b ? (-a) : 0)"
    assert text(Node("literal", value=0.1), Node("atan2", (0, 2)), Node("inv", (3,))) == "(1 / atan2(a, 0.1))"
    assert text(Node("polynomial", (0,), name="f")) == "f"


def test_a_long_expression_is_abbreviated() -> None:
    nodes = [A] + [Node("mul", (k, k)) for k in range(30)]
    text = conditions.expression(Program(tuple(nodes), (), {}, {}), 30)
    assert len(text) <= 160 and "(...)" in text and text.startswith("(")


def test_nodes_are_described_by_signals_and_units() -> None:
    block = build(
        "made",
        Discrete(1e-3),
        lambda u, x, k: Step({"y": u["a"] + x["s"]}, {"s": 3 * x["s"]}, [(Signal("twice", "m", -9, 9), 2 * u["a"])]),
        inputs=[Signal("a", "m", -1, 1)],
        outputs=[Signal("y", "m", -9, 9)],
        states=[State(Signal("s", "kg", -1, 1), 0)],
        tag="F(3)",
    )
    p = lower.program(block)
    y, kept = p.outputs["y"], p.next["s"]
    assert conditions.signal(p, y) == "'y' (block 'made', F(3))" and conditions.signal(p, kept) == "the next states"
    assert conditions.expression(p, y, spelled=False) == "y" and conditions.expression(p, y) in ("(a + s)", "(s + a)")
    loads = [k for k, node in enumerate(p.nodes) if node.name]
    values = conditions.values(block, p, [*loads, y], np.array([0.5, 2, 3]), np.array([0.5, 2.5, 3]))
    names = [p.nodes[k].name for k in loads]
    units = {"a": "m", "s": "kg"}
    assert values == f"{names[0]} = 0.5 {units[names[0]]}, {names[1]} = 2 .. 2.5 {units[names[1]]}, y = 3 m"
    plain = Program(p.nodes, ((ComputedSignal(Signal("y", "m", -9, 9), "made", ""), y),), p.outputs, p.next)
    assert conditions.signal(plain, y) == "'y' (block 'made')"
