"""A lowered program, interpreted node by node in NumPy, computes what CasADi computes."""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import casadi as ca
import numpy as np
import pytest

from synth.block import Block, Constant, Fault, State, Step, build
from synth.compose import compose
from synth.emit import lower
from synth.errors import EmitError
from synth.signals import Signal
from synth.timing import Discrete

TIME = Discrete(1e-3)
MEANING: dict[str, Callable[..., Any]] = {
    "neg": lambda a: -a,
    "sq": lambda a: a * a,
    "twice": lambda a: 2 * a,
    "inv": lambda a: 1 / a,
    "not": lambda a: not a,
    "add": lambda a, b: a + b,
    "sub": lambda a, b: a - b,
    "mul": lambda a, b: a * b,
    "div": lambda a, b: a / b,
    "min": min,
    "max": max,
    "lt": lambda a, b: a < b,
    "le": lambda a, b: a <= b,
    "eq": lambda a, b: a == b,
    "ne": lambda a, b: a != b,
    "and": lambda a, b: bool(a) and bool(b),
    "or": lambda a, b: bool(a) or bool(b),
    "when": lambda a, b: b if a else 0.0,
    "choose": lambda a, b, c: b if a else c,
}


def signal(name: str, low: float = -10) -> Signal:
    return Signal(name, "1", low, 10)


def make(law: Callable[..., Step], outputs: str = "y", **fields: Any) -> Block:
    inputs, named = [signal("a"), signal("b")], [signal(n) for n in outputs.split()]
    return build("lowered", TIME, law, inputs=inputs, outputs=named, **fields)


def interpret(program: lower.Program, loads: dict[str, float]) -> list[float]:
    values: list[Any] = []
    for node in program.nodes:
        args = [values[a] for a in node.args]
        if node.op in ("input", "state", "constant"):
            values.append(loads[node.name])
        elif node.op == "literal":
            values.append(node.value)
        else:
            values.append(MEANING.get(node.op, getattr(math, node.op, None))(*args))
    return [float(v) for v in values]


def everything(u: Any, x: Any, k: Any) -> Step:
    a, b = u["a"], u["b"]
    chosen = ca.if_else(a < b, ca.sin(a) * k["k"], ca.exp(b) - x["s"])
    gate = ca.if_else(ca.logic_or(a <= 0.5, ca.logic_and(b != 1, ca.logic_not(a == b))), ca.fmin(a, b), 0)
    return Step({"y": chosen + ca.sqrt(a**2 + 1), "z": gate / (2 * b + 7)}, {"s": ca.fmax(1 / (a + 11), -b)})


FULL = {"states": [State(signal("s"), 0.5)], "constants": [Constant("k", 0.3, "1", "test")]}


def test_the_program_computes_what_casadi_computes() -> None:
    block = make(everything, "y z", **FULL)
    program, f = lower.program(block), block.function()
    for a, b, s in np.random.default_rng(0).integers(-3, 4, (200, 3)) / 2:
        values = interpret(program, {"a": a, "b": b, "s": s, "k": 0.3})
        next, y = f([s], [a, b])
        computed = [values[program.outputs["y"]], values[program.outputs["z"]], values[program.next["s"]]]
        np.testing.assert_array_equal(computed, [*y.full().ravel(), float(next)])


def test_nodes_follow_their_arguments_and_stand_once() -> None:
    program = lower.program(make(everything, "y z", **FULL))
    assert all(a < k for k, node in enumerate(program.nodes) for a in node.args)
    assert len(set(program.nodes)) == len(program.nodes)
    live = {*program.outputs.values(), *program.next.values(), *(a for n in program.nodes for a in n.args)}
    assert live == set(range(len(program.nodes)))


@pytest.mark.parametrize("condition", [lambda a: a < 1, lambda a: ca.logic_not(a < 1), lambda a: a])
def test_a_choice_is_read_back(condition: Callable[[ca.SX], ca.SX]) -> None:
    program = lower.program(make(lambda u, x, k: Step({"y": ca.if_else(condition(u["a"]), 2 * u["b"], 3 / u["b"])})))
    assert [n.op for n in program.nodes if n.op in ("choose", "when")] == ["choose"]


def test_two_gates_of_unlike_conditions_are_no_choice() -> None:
    def law(u: Any, x: Any, k: Any) -> Step:
        return Step({"y": ca.if_else(u["a"] < 1, 3 * u["b"], 0) + ca.if_else(u["b"] < 1, 5 * u["a"], 0)})

    program = lower.program(make(law))
    assert sorted(n.op for n in program.nodes if n.op in ("choose", "when")) == ["when", "when"]


def test_common_expressions_are_computed_once() -> None:
    program = lower.program(
        make(lambda u, x, k: Step({"y": ca.sin(u["a"] * u["b"]), "z": 3 * ca.sin(u["a"] * u["b"])}), "y z")
    )
    assert [n.op for n in program.nodes].count("sin") == 1 == [n.name for n in program.nodes].count("a")


def test_marks_stand_in_the_order_of_computation() -> None:
    inner = make(lambda u, x, k: Step({"y": u["a"] * u["b"]}, named=[(signal("sum"), u["a"] + u["b"])]))
    outer = build("outer", TIME, lambda u, x, k: Step({"z": u["y"] * 3}), inputs=[signal("y")], outputs=[signal("z")])
    program = lower.program(compose("both", [outer, inner], inputs=["a", "b"], outputs=["z"]))
    assert [named.signal.name for named, _ in program.marks if named.signal.name != "sum"] == ["y", "z"]
    made = {named.signal.name: program.nodes[node].op for named, node in program.marks}
    assert made["y"] == "mul" and made["z"] == "mul" and program.titles == {"lowered": "lowered", "outer": "outer"}


def test_what_equals_an_earlier_node_is_read_as_it() -> None:
    program = lower.program(make(everything, "y z", **FULL))
    sine = next(k for k, n in enumerate(program.nodes) if n.op == "sin")
    a = program.nodes[sine].args[0]
    without = program.substituted({sine: a})
    assert not any(n.op == "sin" for n in without.nodes) and len(without.nodes) == len(program.nodes) - 1


def test_each_fault_sets_its_bit_of_the_word() -> None:
    block = make(lambda u, x, k: Step({"y": 2 * u["a"], "bad": u["a"] > 1}), "y bad")
    guarded = replace(block, faults=(Fault(3, "bad", "a"),))
    program = lower.program(guarded)
    word = program.nodes[program.word]
    assert word.op == "choose" and program.nodes[word.args[1]] == lower.Node("bit", (word.args[2],), 8.0)


@pytest.mark.parametrize(
    ("f", "name"), [(ca.erf, "OP_ERF"), (ca.floor, "OP_FLOOR"), (ca.sign, "OP_SIGN"), (lambda a: a**2.5, "POW")]
)
def test_an_operation_without_a_form_in_c_is_named(f: Callable[[ca.SX], ca.SX], name: str) -> None:
    with pytest.raises(EmitError, match=rf"operation \w*{name} of CasADi .*: write the expression with acos, "):
        lower.program(make(lambda u, x, k: Step({"y": f(u["a"])})))


def test_integer_states_are_marked() -> None:
    states = [State(signal("n", 0), 0, True), State(signal("s"), 0)]
    program = lower.program(make(lambda u, x, k: Step({"y": 0}, {"n": x["n"] + 1, "s": x["s"]}), states=states))
    assert program.integers == {"n"}
