"""Truth values are simplified exactly, and only where the condition decides nothing else and protects no division."""

from typing import Any

import numpy as np
import pytest

from synth.emit.passes import fault_flags, fold
from synth.emit.program.lower import Node, Program
from synth.emit.program.operations import LOGICAL
from tests.emit.passes.trees import tree
from tests.emit.semantics import interpret

LEAVES = (Node("input", name="a"), Node("input", name="b"), Node("state", name="n"), Node("state", name="m"))
A, B, N, M = range(4)
NUMBERS = (0.0, 1.0, 2.0)
OPERATIONS = ("lt", "lt", "le", "and", "or", "not", "add", "sub", "choose", "choose", "choose", "choose")


def program(*nodes: Node) -> Program:
    """Return a program whose output is the last node; n and m are whole numbers that are not negative."""
    ends = {"y": len(LEAVES) + len(nodes) - 1}
    return Program((*LEAVES, *nodes), (), ends, {}, integers=frozenset("nm"))


def number(value: float) -> Node:
    return Node("literal", value=value)


def random_program(seed: int) -> Program:
    rng = np.random.default_rng(seed)
    nodes = [*LEAVES, *map(number, NUMBERS)]
    for _ in range(20):
        op = str(rng.choice(OPERATIONS))
        args = [len(nodes) - 1 - int(rng.integers(min(9, len(nodes)))) for _ in range(3)]
        logical = [k for k, n in enumerate(nodes) if n.op in LOGICAL]
        if op == "choose" and logical:
            args[0] = logical[-1 - int(rng.integers(min(3, len(logical))))]
            args[1] = 4 + int(rng.integers(3)) if rng.random() < 0.5 else args[1]
        if op == "lt" and rng.random() < 0.5:
            args[0] = 4
        nodes.append(Node(op, tuple(args[: 3 if op == "choose" else 1 if op == "not" else 2])))
    ends = {f"y{i}": len(nodes) - 1 - i for i in range(6)}
    return Program(tuple(nodes), (), ends, {}, integers=frozenset("nm"))


def differing(count: int = 400) -> list[int]:
    """Return the seeds of programs whose results change; also for NaN."""
    failures, simpler = [], 0
    for seed in range(count):
        before = fold.folded(random_program(seed))
        after = fault_flags.simplified(before)
        simpler += before.nodes != after.nodes
        rng = np.random.default_rng(seed)
        for _ in range(6):
            reals = {name: float(rng.choice((-1.0, 0.0, 0.5, 1.0, np.nan))) for name in "ab"}
            loads = reals | {name: float(rng.integers(4)) for name in "nm"}
            values = [[interpret(p, loads)[k] for k in p.outputs.values()] for p in (before, after)]
            if not np.array_equal(*values, equal_nan=True):
                failures.append(seed)
    assert simpler > count / 4
    return failures


def test_simplification_is_exact() -> None:
    assert not differing()


DEFECTS: dict[str, Any] = {
    "_not": lambda self, k: k,
    "_reverse": lambda self, node: (
        self._place({"lt": "le", "le": "lt"}[node.op], *(self.index[a] for a in reversed(node.args)))
        if node.op in ("lt", "le")
        else None
    ),
    "_positive": lambda self, k: self.f.make(Node("lt", (self.f.literal(1.0), self.index[k]))),
    "_join": lambda self, c, inner: self._place(
        "choose", self.index[c], *(self.index[a] for a in self.p.nodes[inner].args[1:])
    ),
}


@pytest.mark.parametrize("name", DEFECTS)
def test_a_planted_defect_is_found(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """A reversed comparison of numbers that may be NaN is one of them."""
    monkeypatch.setattr(fault_flags.Flags, name, DEFECTS[name])
    assert differing()


LESS = Node("lt", (A, B))  # node 4
NOT_LESS = Node("le", (B, A))  # node 5


@pytest.mark.parametrize(
    ("nodes", "expected"),
    [
        ((LESS, number(1), number(0), Node("choose", (4, 5, 6))), "lt(a, b)"),
        ((LESS, number(1), number(0), Node("choose", (4, 6, 5))), "not(lt(a, b))"),
        ((LESS, NOT_LESS, number(1), Node("choose", (4, 6, 5))), "or(lt(a, b), le(b, a))"),
        ((LESS, NOT_LESS, number(0), Node("choose", (4, 5, 6))), "and(lt(a, b), le(b, a))"),
        ((LESS, NOT_LESS, number(2), Node("choose", (5, 6, N)), Node("choose", (4, 6, 7))),
         "choose(or(lt(a, b), le(b, a)), 2, n)"),
        ((LESS, number(0), Node("lt", (5, 4))), "lt(a, b)"),
        ((LESS, number(0), Node("choose", (4, N, 5)), Node("lt", (5, 6))), "choose(lt(a, b), lt(0, n), 0)"),
        ((Node("lt", (N, M)), Node("not", (4,))), "le(m, n)"),
    ],
)  # fmt: skip
def test_a_rule_rewrites(nodes: tuple[Node, ...], expected: str) -> None:
    assert tree(fault_flags.simplified(program(*nodes))) == expected


@pytest.mark.parametrize(
    "nodes",
    [
        (LESS, Node("not", (4,))),
        (LESS, number(1), Node("inv", (B,)), Node("lt", (6, A)), Node("choose", (4, 5, 7))),
        (LESS, NOT_LESS, number(1), Node("choose", (4, 6, 5)), Node("choose", (4, A, B)), Node("add", (7, 8))),
        (number(0), Node("lt", (4, A))),
        (number(0), Node("sub", (N, M)), Node("lt", (4, 5))),
    ],
    ids=["may be NaN", "protects a division", "decides another choice", "not whole", "may be negative"],
)
def test_what_stays(nodes: tuple[Node, ...]) -> None:
    assert (
        fault_flags.simplified(program(*nodes)).nodes
        == program(*nodes).with_nodes(program(*nodes).nodes, range(len(program(*nodes).nodes))).nodes
    )
