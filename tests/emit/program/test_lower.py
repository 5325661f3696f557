"""A lowered program, interpreted node by node, computes what CasADi computes."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import casadi as ca
import numpy as np
import pytest

from synth.block import Block, Constant, Fault, State, Step, build
from synth.composition import compose
from synth.emit.program import lower
from synth.errors import EmitError
from synth.signals import Signal
from synth.timing import Discrete
from tests.emit.semantics import interpret

TIME = Discrete(1e-3)


def signal(name: str, low: float = -10) -> Signal:
    return Signal(name, "1", low, 10)


def make(law: Callable[..., Step], outputs: str = "y", **fields: Any) -> Block:
    inputs, named = [signal("a"), signal("b")], [signal(n) for n in outputs.split()]
    return build("lowered", TIME, law, inputs=inputs, outputs=named, **fields)


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


def test_nodes_follow_their_arguments_and_are_unique() -> None:
    program = lower.program(make(everything, "y z", **FULL))
    assert all(a < k for k, node in enumerate(program.nodes) for a in node.args)
    assert len(set(program.nodes)) == len(program.nodes)
    live = {*program.outputs.values(), *program.next.values(), *(a for n in program.nodes for a in n.args)}
    assert live == set(range(len(program.nodes)))


@pytest.mark.parametrize("condition", [lambda a: a < 1, lambda a: ca.logic_not(a < 1), lambda a: a])
def test_a_choice_is_read_back(condition: Callable[[ca.SX], ca.SX]) -> None:
    program = lower.program(make(lambda u, x, k: Step({"y": ca.if_else(condition(u["a"]), 2 * u["b"], 3 / u["b"])})))
    assert [n.op for n in program.nodes if n.op in ("choose", "when")] == ["choose"]


def test_two_gates_of_different_conditions_are_not_a_choice() -> None:
    def law(u: Any, x: Any, k: Any) -> Step:
        return Step({"y": ca.if_else(u["a"] < 1, 3 * u["b"], 0) + ca.if_else(u["b"] < 1, 5 * u["a"], 0)})

    program = lower.program(make(law))
    assert sorted(n.op for n in program.nodes if n.op in ("choose", "when")) == ["when", "when"]


def test_common_expressions_are_computed_once() -> None:
    program = lower.program(
        make(lambda u, x, k: Step({"y": ca.sin(u["a"] * u["b"]), "z": 3 * ca.sin(u["a"] * u["b"])}), "y z")
    )
    assert [n.op for n in program.nodes].count("sin") == 1 == [n.name for n in program.nodes].count("a")


def test_marks_are_in_the_order_of_computation() -> None:
    inner = make(lambda u, x, k: Step({"y": u["a"] * u["b"]}, named=[(signal("sum"), u["a"] + u["b"])]))
    outer = build("outer", TIME, lambda u, x, k: Step({"z": u["y"] * 3}), inputs=[signal("y")], outputs=[signal("z")])
    program = lower.program(compose("both", [outer, inner], inputs=["a", "b"], outputs=["z"]))
    assert [named.signal.name for named, _ in program.marks if named.signal.name != "sum"] == ["y", "z"]
    made = {named.signal.name: program.nodes[node].op for named, node in program.marks}
    assert made["y"] == "mul" and made["z"] == "mul" and program.titles == {"lowered": "lowered", "outer": "outer"}


def test_substitution_reads_the_earlier_of_equal_nodes() -> None:
    program = lower.program(make(everything, "y z", **FULL))
    sine = next(k for k, n in enumerate(program.nodes) if n.op == "sin")
    a = program.nodes[sine].args[0]
    without = program.substituted({sine: a})
    assert not any(n.op == "sin" for n in without.nodes) and len(without.nodes) == len(program.nodes) - 1


def marked_nodes(program: lower.Program) -> dict[str, lower.Node]:
    return {named.signal.name: program.nodes[k] for named, k in program.marks}


def test_dead_nodes_are_dropped_with_their_marks() -> None:
    def law(u: Any, x: Any, k: Any) -> Step:
        e = ca.exp(u["b"])
        return Step({"y": ca.sin(e)}, named=[(signal("e"), e)])

    program = lower.program(make(law))
    e, y = next(k for k, n in enumerate(program.nodes) if n.op == "exp"), program.outputs["y"]
    assert marked_nodes(program) == {"e": program.nodes[e], "y": program.nodes[y]}
    shortened, emptied = program.substituted({e: program.nodes[e].args[0]}), program.substituted({y: 0})
    assert [n.op for n in shortened.nodes] == ["input", "sin"] and marked_nodes(shortened)["e"].name == "b"
    assert [n.op for n in emptied.nodes] == ["input"] and list(marked_nodes(emptied)) == ["y"]


def test_users_count_each_operand() -> None:
    program = lower.program(make(lambda u, x, k: Step({"y": u["a"] * u["a"] + u["a"]})))
    a = next(k for k, n in enumerate(program.nodes) if n.name == "a")
    assert len(program.users()[a]) == sum(n.args.count(a) for n in program.nodes) >= 2


@pytest.mark.parametrize(
    ("state", "owner"),
    [("lag_x", "lag"), ("lag_filter_x", "lag_filter"), ("lag_filters_x", "lag"), ("lagging_x", ""), ("x", "")],
)
def test_a_state_belongs_to_the_longest_block_name_that_prefixes_its_name(state: str, owner: str) -> None:
    titles = dict.fromkeys(("lag", "lag_filter", "other"), "")
    assert lower.Program((), (), {}, {}, titles=titles).owner(state) == owner


def test_each_fault_sets_its_bit_of_the_word() -> None:
    law = lambda u, x, k: Step({"y": 2 * u["a"], "high": u["a"] > 1, "low": u["b"] < 0})  # noqa: E731
    block = make(law, "y high low")
    faults = [Fault(3, "high", "a"), Fault(31, "low", None), Fault(0, "high", None)]
    program = lower.program(replace(block, faults=tuple(faults), outputs=block.outputs[:1]))
    assert program.word is not None and list(program.outputs) == ["y"]
    for a, b in ((0, 0), (2, 0), (0, -1), (2, -1)):
        word = interpret(program, {"a": a, "b": b})[program.word]
        assert word == (a > 1) * 0b1001 | (b < 0) << 31


def grouped_faults() -> tuple[lower.Program, int]:
    """Return a program with consecutive bits 1, 2 under a < 1, bit 3 alone, bit 4 under a < 1; and that condition."""

    def law(u: Any, x: Any, k: Any) -> Step:
        flag, b = u["a"] < 1, u["b"]
        return Step({n: ca.logic_and(flag, b < i) for i, n in enumerate("pqr")} | {"s": ca.logic_or(flag, b < 0)})

    block = make(law, "p q r s")
    faults = [Fault(bit, name) for bit, name in ((1, "p"), (2, "q"), (3, "s"), (4, "r"))]
    program = lower.program(replace(block, faults=tuple(faults), outputs=()))
    one = next(k for k, n in enumerate(program.nodes) if n.op == "literal" and n.value == 1)
    return program, next(k for k, n in enumerate(program.nodes) if n.op == "lt" and n.args[1] == one)


def wrong_words(program: lower.Program) -> int:
    assert program.word is not None
    right = {
        (a, b): (a < 1) * ((b < 0) << 1 | (b < 1) << 2 | (b < 2) << 4) | (a < 1 or b < 0) << 3
        for a in (0, 2)
        for b in (-1, 0.5, 1.5, 3)
    }
    return sum(interpret(program, {"a": a, "b": b})[program.word] != word for (a, b), word in right.items())


def test_consecutive_faults_under_one_condition_share_a_branch() -> None:
    program, condition = grouped_faults()
    assert wrong_words(program) == 0
    under = [n for n in program.nodes if n.op == "choose" and n.args[0] == condition]
    assert len(under) == 2 and not any(n.op == "and" for n in program.nodes)


def test_a_group_of_faults_under_a_wrong_condition_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(lower, "_condition", lambda flag: flag.args[0])
    assert wrong_words(grouped_faults()[0]) > 0


def unfollowed(latch: Any) -> lower.Program:
    """Return a program whose fault p is `latch` of a and b, and whose status q is set for b < 0 unless p is."""

    def law(u: Any, x: Any, k: Any) -> Step:
        p = latch(u["a"], u["b"])
        return Step({"p": p, "q": ca.if_else(p, 0, u["b"] < 0)})

    faults = Fault(31, "p"), Fault(3, "q", about="late", status=True)
    return lower.program(replace(make(law, "p q"), faults=faults, outputs=()))


LATCHES = [lambda a, b: a < 1, lambda a, b: ca.logic_and(a < 1, b < 2)]


@pytest.mark.parametrize("latch", LATCHES)
def test_a_status_that_is_0_with_a_fault_is_tested_without_it(latch: Any) -> None:
    program = unfollowed(latch)
    assert program.word is not None
    for a, b in ((0, -1), (2, -1), (0, 1), (2, 1), (0, 3), (2, 3)):
        word = interpret(program, {"a": a, "b": b})[program.word]
        assert word == (1 << 31 if latch(a, b) else (b < 0) << 3), (a, b)
    single = latch is LATCHES[0]
    assert any(n.op in ("when", "and") for n in program.nodes) != single


def test_a_status_that_is_tested_with_the_fault_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    """The planted defect: a status that is taken for a flag which another fault excludes."""
    monkeypatch.setattr(lower, "_unless", lambda nodes, flag: nodes[flag].args[0] if nodes[flag].args else None)
    law = lambda u, x, k: Step({"p": u["a"] < 1, "q": ca.logic_and(u["a"] < 1, u["b"] < 0)})  # noqa: E731
    faults = Fault(31, "p"), Fault(3, "q", about="late", status=True)
    program = lower.program(replace(make(law, "p q"), faults=faults, outputs=()))
    assert program.word is not None
    assert interpret(program, {"a": 0, "b": -1})[program.word] != 1 << 31 | 1 << 3


def test_a_block_without_faults_has_no_word() -> None:
    assert lower.program(make(lambda u, x, k: Step({"y": u["a"]}))).word is None


@pytest.mark.parametrize(("f", "name"), [(ca.erfinv, "OP_ERFINV"), (ca.acosh, "ACOSH"), (ca.atanh, "ATANH")])
def test_an_operation_without_a_form_in_c_is_named(f: Callable[[ca.SX], ca.SX], name: str) -> None:
    with pytest.raises(EmitError, match=rf"operation \w*{name} of CasADi .*: write the expression with acos, "):
        lower.program(make(lambda u, x, k: Step({"y": f(u["a"])})))


def test_integer_states_are_marked() -> None:
    states = [State(signal("n", 0), 0, True), State(signal("s"), 0)]
    program = lower.program(make(lambda u, x, k: Step({"y": 0}, {"n": x["n"] + 1, "s": x["s"]}), states=states))
    assert program.integers == {"n"}
