"""Bits of the fault word are set on the side of a condition that sets them, with the same word for any flags."""

from dataclasses import replace
from itertools import product

import pytest

from synth.block import ComputedSignal
from synth.emit.passes import fault_flags
from synth.emit.program.lower import Node, Program
from synth.signals import Signal
from tests.emit.passes.trees import tree
from tests.emit.semantics import interpret

NAMES = ("c", "d", "e", "f")  # a condition, and what sets a bit
C, FIRST, ZERO, ONE = 0, 1, 4, 5
LEAVES = (*(Node("input", name=n) for n in NAMES), Node("literal"), Node("literal", value=1.0))


def program(flags: tuple[Node, ...], word_read: int | None = None) -> Program:
    """Return a program whose word has a bit for each flag; an output y reads the word after bit `word_read`."""
    nodes, words = [*LEAVES, *flags], [ZERO]
    for i in range(len(flags)):
        nodes.append(Node("bit", (words[-1],), value=2.0**i))
        nodes.append(Node("choose", (len(LEAVES) + i, len(nodes) - 1, words[-1])))
        words.append(len(nodes) - 1)
    outputs = {} if word_read is None else {"y": words[word_read]}
    return Program(tuple(nodes), (), outputs, {}, word=words[-1])


def choice(k: int, zero: int = 1) -> Node:
    """Return the flag of input k where the condition does not hold, or, with `zero` 2, where it does."""
    return Node("choose", (C, ZERO, k) if zero == 1 else (C, k, ZERO))


ALIKE = (choice(FIRST), choice(FIRST + 1), choice(FIRST + 2))


SIGNALS = tuple(ComputedSignal(Signal(f"s{i}", "1", 0, 1), "law", "") for i in range(3))


def word(p: Program, values: tuple[float, ...]) -> float:
    assert p.word is not None
    return float(interpret(p, dict(zip(NAMES, values, strict=True)))[p.word])


def word_tree(p: Program) -> str:
    assert p.word is not None
    return tree(p, p.word)


@pytest.mark.parametrize(
    "flags",
    [
        ALIKE,
        tuple(choice(FIRST + i, 2) for i in range(3)),
        (choice(FIRST), choice(FIRST + 1, 2), choice(FIRST + 2, 2)),
        (Node("not", (FIRST,)), choice(FIRST), choice(FIRST + 1)),
        (choice(FIRST), Node("not", (FIRST,)), choice(FIRST + 1)),
    ],
)
def test_the_word_is_the_same(flags: tuple[Node, ...]) -> None:
    before = program(flags)
    after = fault_flags.gather(before)
    assert all(word(before, v) == word(after, v) for v in product((0.0, 1.0), repeat=4))


def test_a_run_of_flags_becomes_one_choice() -> None:
    after = fault_flags.gather(program(ALIKE))
    top = after.nodes[after.word or 0]
    assert top.op == "choose" and after.nodes[top.args[0]].name == "c" and after.nodes[top.args[1]] == Node("literal")
    assert word_tree(after).startswith("choose(c, 0, choose(f, bit(choose(e, bit(choose(d, bit(0), 0))")
    assert word_tree(program(ALIKE)).startswith("choose(choose(c, 0, f), bit(")
    assert [n.op for n in after.nodes].count("choose") == 4


def test_the_signal_of_a_flag_that_nothing_else_reads_is_what_sets_it() -> None:
    before = program(ALIKE)
    flags = {named.signal.name: len(LEAVES) + i for i, named in enumerate(SIGNALS)}
    before = replace(before, marks=tuple(zip(SIGNALS, flags.values(), strict=True)), outputs={"y": flags["s1"]})
    after = fault_flags.gather(before)
    named = {mark.signal.name: tree(after, k) for mark, k in after.marks}
    assert named == {"s0": "d", "s1": "choose(c, 0, e)", "s2": "f"}  # s1 is an output


@pytest.mark.parametrize(
    "p",
    [
        program((*ALIKE[:2], choice(FIRST + 2, 2))),  # 0 on different sides
        program(ALIKE[: fault_flags.LEAST - 1]),
        program(ALIKE, word_read=1),
        program((Node("not", (FIRST,)), Node("not", (FIRST + 1,)))),
    ],
)
def test_what_is_no_run_stays(p: Program) -> None:
    assert word_tree(fault_flags.gather(p)) == word_tree(p)


def test_what_decides_another_choice_keeps_its_flag() -> None:
    p = program((*ALIKE, Node("choose", (FIRST + 1, ONE, FIRST))))
    assert word_tree(fault_flags.gather(p)) == word_tree(p)


def test_a_state_that_decides_another_choice_is_tested_by_a_condition_of_its_own() -> None:
    p = program((*ALIKE, Node("choose", (FIRST + 1, ONE, FIRST))))
    nodes = list(p.nodes)
    nodes[FIRST + 1] = Node("state", name="e")
    p = replace(p, nodes=tuple(nodes))
    after = fault_flags.gather(p)
    assert "choose(c, 0, choose(f, bit(choose(ne(e, 0), bit(choose(d, bit(0), 0))" in word_tree(after)
    assert all(word(p, v) == word(after, v) for v in product((0.0, 1.0), repeat=4))
