"""Folding keeps what is computed: exactly on fractions, to rounding on floats, and also for NaN.

On fractions every rule is an identity, as long as the numbers folded are powers of two, whose products and reciprocals
a double holds.
"""

import itertools
import math
from collections.abc import Mapping
from dataclasses import replace
from fractions import Fraction
from math import inf, isnan, nan
from typing import Any

import casadi as ca
import numpy as np
import pytest

from synth.block import Step, build
from synth.emit.passes import fold
from synth.emit.program import lower
from synth.emit.program.lower import Node, Program
from synth.emit.program.operations import LOGICAL
from synth.signals import Signal
from synth.timing import Discrete
from tests.emit.passes.trees import LEAVES, A, B, C, K, L, fold_nodes, tree
from tests.emit.semantics import interpret

NUMBERS = (0.0, 1.0, -1.0, 2.0, -2.0, 0.5, -0.25, 4.0)
UNARY = ("neg", "fabs", "sq", "twice", "inv", "not")
BINARY = ("add", "sub", "mul", "div", "min", "max", "lt", "le", "eq", "ne", "and", "or", "when")
OFTEN = ("add", "sub", "mul", "mul", "div", "neg", "choose", "max", "min", "inv")
POSITIVE = ("add", "mul", "div", "inv", "sq", "twice", "choose", "max", "min")


def random_program(seed: int, operations: tuple[str, ...], numbers: tuple[float, ...], count: int = 24) -> Program:
    """Return a random program of which the last eight nodes are outputs."""
    rng = np.random.default_rng(seed)
    nodes = [*LEAVES, *(Node("literal", value=v) for v in numbers)]
    for _ in range(count):
        op = str(rng.choice(operations))
        recent = [len(nodes) - 1 - int(rng.integers(min(8, len(nodes)))) for _ in range(3)]
        args = [int(rng.integers(len(nodes))) if rng.random() < 0.6 else k for k in recent]
        logical = [k for k, n in enumerate(nodes) if n.op in LOGICAL]
        if op == "choose" and logical:
            args[0] = logical[-1 - int(rng.integers(min(3, len(logical))))]
        if op == "limit":  # as a Block's limit lowers
            nodes += [Node("min", (args[0], args[1])), Node("neg", (args[1],))]
            nodes.append(Node("max", (len(nodes) - 2, len(nodes) - 1)))
            continue
        nodes.append(Node(op, tuple(args[: 3 if op == "choose" else 1 if op in UNARY else 2])))
    ends = {f"y{i}": len(nodes) - 1 - i for i in range(8)}
    return Program(tuple(nodes), (), ends, {})


def outputs(program: Program, loads: Mapping[str, Any]) -> dict[str, Any]:
    values = interpret(program, loads)
    return {name: values[k] for name, k in program.outputs.items()}


def on_fractions(program: Program) -> Program:
    return replace(program, nodes=tuple(replace(n, value=Fraction(n.value)) for n in program.nodes))


def differing(count: int = 300) -> list[int]:
    """Return the seeds of programs whose results folding changes, on fractions without division by 0."""
    failures, tried = [], 0
    for seed in range(count):
        program = random_program(seed, (*OFTEN, *UNARY, *BINARY, "limit", "limit"), NUMBERS)
        folded = fold.folded(program)
        if not powers_of_two(folded):
            continue
        rng = np.random.default_rng(seed)
        for _ in range(4):
            loads = {n: Fraction(int(rng.integers(-6, 7)), int(rng.integers(1, 4))) for n in "abckl"}
            before, after = (on_fraction(p, loads) for p in (program, folded))
            tried += before is not None
            if before is not None and before != after:
                failures.append(seed)
                break
    assert tried > count / 3
    return failures


def powers_of_two(program: Program) -> bool:
    return all(n.value == 0 or abs(math.frexp(n.value)[0]) == 0.5 for n in program.nodes if n.op == "literal")


def on_fraction(program: Program, loads: Mapping[str, Any]) -> dict[str, Any] | None:
    """Return the outputs, None where something is divided by 0."""
    try:
        return outputs(on_fractions(program), loads)
    except ZeroDivisionError:
        return None


def test_folding_is_exact_on_fractions() -> None:
    assert not differing()


def test_folding_changes_floats_by_rounding_alone() -> None:
    for seed in range(200):
        program = random_program(seed, POSITIVE, (1.0, 3.0, 0.1, 7e-3))
        folded = fold.folded(program)
        rng = np.random.default_rng(seed)
        for _ in range(3):
            loads = {n: float(v) for n, v in zip("abckl", rng.uniform(0.5, 2, 5), strict=True)}
            before, after = (list(outputs(p, loads).values()) for p in (program, folded))
            # Sums, products and quotients of positive numbers: 24 operations, each off by half a unit, twice over.
            np.testing.assert_allclose(after, before, rtol=24 * 2.0**-52)


def test_folding_twice_is_folding_once() -> None:
    for seed in range(100):
        once = fold.folded(random_program(seed, (*OFTEN, *UNARY, *BINARY), NUMBERS))
        assert len(fold.folded(once).nodes) <= len(once.nodes)


RULES: dict[str, Any] = {
    "_truth": lambda f, a: a,
    "times": lambda f, l, x: f.place(Node("mul", (f.literal(abs(l)), x))),
}
TABLED: dict[str, Any] = {
    "sub": fold._RULES["add"],
    "neg": lambda f, a: None if f.split_factor(a)[0] == 1 else f.split_factor(a)[1],
    "choose": lambda f, c, a, b: a if f.nodes[c].op == "not" else None,
    "inv": lambda f, a: a,
    "max": lambda f, a, b: f.place(Node("clamp", (a, b, b))) if f.nodes[a].op == "min" else None,
    "or": lambda f, a, b: b if f.number(a) is not None else None,
}


@pytest.mark.slow
@pytest.mark.parametrize("name", [*RULES, *TABLED])
def test_a_planted_defect_is_found(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    if name in RULES:
        monkeypatch.setattr(fold, name, RULES[name])
    else:
        monkeypatch.setitem(fold._RULES, name, TABLED[name])
    assert differing()


def number(value: float) -> Node:
    return Node("literal", value=value)


@pytest.mark.parametrize(
    ("nodes", "expected"),
    [
        ([number(2), number(3), Node("add", (5, 6))], "5"),
        ([number(2), number(3), Node("max", (5, 6))], "3"),
        ([number(2), Node("mul", (5, A)), number(3), Node("mul", (6, 7))], "mul(6, a)"),
        ([number(4), Node("div", (A, 5))], "mul(0.25, a)"),
        ([number(4), number(2), Node("mul", (6, A)), Node("div", (5, 7))], "div(2, a)"),
        ([number(0), Node("add", (A, 5))], "a"),
        ([number(0), Node("sub", (5, A))], "neg(a)"),
        ([number(1), Node("mul", (A, 5))], "a"),
        ([Node("twice", (A,)), Node("twice", (5,))], "mul(4, a)"),
        ([Node("neg", (B,)), Node("sub", (A, 5))], "add(a, b)"),
        ([Node("neg", (B,)), Node("add", (5, A))], "sub(a, b)"),
        ([number(2), Node("mul", (5, A)), Node("neg", (6,))], "mul(-2, a)"),
        ([Node("neg", (A,)), Node("neg", (5,))], "a"),
        ([Node("mul", (A, A))], "sq(a)"),
        ([Node("neg", (A,)), Node("neg", (B,)), Node("mul", (5, 6))], "mul(a, b)"),
        ([Node("inv", (A,)), number(3), Node("mul", (6, 5))], "div(3, a)"),
        ([Node("lt", (A, B)), Node("not", (5,)), Node("choose", (6, A, C))], "choose(lt(a, b), c, a)"),
        ([Node("lt", (A, B)), Node("choose", (5, B, C)), Node("choose", (5, A, 6))], "choose(lt(a, b), a, c)"),
        ([Node("lt", (A, B)), Node("choose", (5, B, C)), Node("choose", (5, 6, A))], "choose(lt(a, b), b, a)"),
        ([Node("lt", (A, B)), Node("when", (5, C))], "choose(lt(a, b), c, 0)"),
        ([number(1), Node("choose", (5, A, B))], "a"),
        ([Node("lt", (A, B)), Node("choose", (5, C, C))], "c"),
        ([Node("lt", (A, B)), Node("not", (5,)), Node("not", (6,))], "lt(a, b)"),
        ([Node("not", (A,)), Node("not", (5,))], "ne(a, 0)"),
        ([number(0), Node("or", (A, 5))], "ne(a, 0)"),
        ([number(3), Node("or", (A, 5))], "1"),
        ([number(2), number(-2), Node("min", (A, 5)), Node("max", (7, 6))], "clamp(a, -2, 2)"),
        ([Node("neg", (B,)), Node("min", (A, B)), Node("max", (6, 5))], "clamp(a, neg(b), b)"),
        ([number(2), number(-3), Node("min", (A, 5)), Node("max", (7, 6))], "max(min(a, 2), -3)"),
        ([number(0), Node("max", (A, 5)), Node("max", (6, 5))], "max(a, 0)"),
        ([number(0), Node("min", (A, 5)), Node("min", (5, 6))], "min(a, 0)"),
        ([number(0), number(1), Node("max", (A, 5)), Node("max", (7, 6))], "max(max(a, 0), 1)"),
        ([number(2), number(-2), Node("le", (6, A)), Node("le", (A, 5)), Node("and", (7, 8))], "le(fabs(a), 2)"),
        (
            [number(2), number(-2), Node("le", (6, A)), Node("le", (B, 5)), Node("and", (7, 8))],
            "and(le(-2, a), le(b, 2))",
        ),
        (
            [number(2), number(-1), Node("le", (6, A)), Node("le", (A, 5)), Node("and", (7, 8))],
            "and(le(-1, a), le(a, 2))",
        ),
    ],
)
def test_a_rule_rewrites(nodes: list[Node], expected: str) -> None:
    assert tree(fold_nodes(*nodes)) == expected


@pytest.mark.parametrize(
    "nodes",
    [
        [Node("mul", (K, A))],
        [Node("add", (K, L))],
        [Node("mul", (K, L))],
        [Node("div", (A, K))],
        [Node("neg", (K,))],
        [number(1), Node("div", (5, K))],
        [Node("min", (A, K))],
    ],
)
def test_named_constants_are_not_folded_away(nodes: list[Node]) -> None:
    names = {LEAVES[a].name for n in nodes for a in n.args if a < len(LEAVES)}
    assert {n.name for n in fold_nodes(*nodes).nodes if n.op != "literal" and not n.args} == names


SPECIAL = (nan, inf, -inf, 0.0, -0.0, 1.0, -1.0, 2.0, 2.5, -2.5, 1e308, 5e-324)


def same(a: float, b: float) -> bool:
    return (isnan(a) and isnan(b)) or a == b


@pytest.mark.parametrize("h", [2.0, 0.0, -1.0, inf])
def test_an_interval_test_equals_that_of_the_absolute_value_also_for_nan(h: float) -> None:
    program = fold_nodes(number(h), number(-h), Node("le", (6, A)), Node("le", (A, 5)), Node("and", (7, 8)))
    assert "fabs" in tree(program)
    for x in SPECIAL:
        assert outputs(program, {"a": x})["y"] == int(-h <= x and x <= h)


def limit(x: float, h: float) -> float:
    """Compute what the C of a limit computes."""
    return x if abs(x) <= h else -h if x < 0 else abs(h)


def test_a_clamp_equals_minimum_and_maximum_for_any_argument() -> None:
    for x, h in itertools.product(SPECIAL, SPECIAL):
        low = min(x, h) if not isnan(x) else h  # fmin gives the other argument for NaN
        low = nan if isnan(h) else low
        assert same(limit(x, h), nan if isnan(h) else max(low, -h)), (x, h)


def test_a_clamp_of_nan_is_its_upper_end() -> None:
    """As CasADi's fmin and fmax have it."""
    block = build(
        "limit",
        Discrete(1e-3),
        lambda u, x, k: Step({"y": ca.fmax(ca.fmin(u["a"], 2), -2)}),
        inputs=[Signal("a", "1", -9, 9)],
        outputs=[Signal("y", "1", -9, 9)],
    )
    program = fold.folded(lower.program(block))
    assert [n.op for n in program.nodes].count("clamp") == 1
    for x in SPECIAL:
        expected = float(block.function()([], [x])[1])
        assert same(limit(x, 2.0), expected) and (isnan(x) or outputs(program, {"a": x})["y"] == expected)


def divisions(program: Program) -> int:
    return sum(n.op in ("div", "inv") for n in program.nodes)


def test_a_divisor_used_twice_is_inverted_once() -> None:
    program = fold_nodes(Node("div", (A, C)), Node("div", (B, C)), Node("sub", (5, 6)))
    assert divisions(program) == 1 and tree(program) == "sub(mul(a, inv(c)), mul(b, inv(c)))"
    program = fold_nodes(Node("div", (A, C)), Node("inv", (C,)), Node("sub", (5, 6)))
    assert divisions(program) == 1 and tree(program) == "sub(mul(a, inv(c)), inv(c))"
    assert divisions(fold_nodes(Node("div", (A, C)), Node("div", (A, B)), Node("sub", (5, 6)))) == 2


def test_divisions_in_exclusive_arms_are_not_shared() -> None:
    sides = [Node("lt", (A, C)), Node("div", (A, C)), Node("div", (B, C)), Node("choose", (5, 6, 7))]
    assert divisions(fold_nodes(*sides)) == 2
    # One more that is made anyway, and the reciprocal costs nothing.
    assert divisions(fold_nodes(*sides, Node("inv", (C,)), Node("add", (8, 9)))) == 1
