"""Univariate subexpressions: maximal functions found by dominators, and their evaluation on complex balls."""

import cmath
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import casadi as ca
import flint
import mpmath  # type: ignore[import-untyped]
import numpy as np
import pytest

from synth.block import Block, Constant, Fault, State, Step, build
from synth.emit.passes import univariate
from synth.emit.passes.univariate import Univariate
from synth.emit.program import lower
from synth.emit.program.lower import Node, Program
from synth.emit.proof import ranges
from synth.emit.proof.ranges import Range
from synth.errors import EmitError
from synth.signals import Signal
from synth.timing import Discrete

F64 = np.float64
TIME = Discrete(1e-3)
INPUTS = tuple(Signal(n, "1", 0.25, 2) for n in ("a", "b", "c"))
Analysis = tuple[Program, tuple[Range, ...], tuple[Univariate, ...]]


def analyse(law: Callable[[Any, Any], dict[str, ca.SX] | ca.SX], guarded: str = "") -> Analysis:
    """Return program, ranges and functions of a Block with inputs a, b, c in 0.25 .. 2 and a constant k = 3."""

    def step(u: Any, x: Any, k: Any) -> Step:
        made = law(u, k)
        return Step(made if isinstance(made, dict) else {"y": made, "z": 0, "w": 0})

    outputs = [Signal(n, "1", -1e9, 1e9) for n in ("y", "z", "w")]
    block = build("f", TIME, step, inputs=INPUTS, outputs=outputs, constants=[Constant("k", 3.0, "1", "test")])
    block = replace(block, faults=(Fault(0, "y", guarded),)) if guarded else block
    program = lower.program(block)
    analysed = ranges.analyse(program, ranges.bounds(block, F64), F64)
    return program, analysed, univariate.find(program, analysed)


def shapes(analysis: Analysis) -> list[tuple[str, str]]:
    """Return operation of the root, and operation or name of the variable."""
    nodes = analysis[0].nodes
    return [(nodes[f.root].op, nodes[f.variable].name or nodes[f.variable].op) for f in analysis[2]]


def gap(u: Any) -> ca.SX:
    return u["a"] - 0.1 * u["b"]


def force(g: ca.SX, k: Any) -> ca.SX:
    """K lambda(g) / (sinh(k (h + g)) K_c(g)) in the shape of a force law."""
    return 35 * (1 - 0.01 / (g + 0.1)) / (ca.sinh(k["k"] * (0.005 + g)) * (1 + g * ca.log(1 + g)))


def test_a_force_law_is_one_function_of_the_gap() -> None:
    program, analysed, functions = analyse(lambda u, k: u["c"] * force(gap(u), k))
    (f,) = functions
    assert program.nodes[f.variable].op == "sub"
    assert {program.nodes[u].op for u in program.users()[f.root]} == {"mul"}
    evaluate = univariate.function(univariate.key(program, analysed, f.root, f.variable))
    for g in (0.1, 0.7, 1.9):
        expected = 35 * (1 - 0.01 / (g + 0.1)) / (np.sinh(3 * (0.005 + g)) * (1 + g * np.log(1 + g)))
        assert float(evaluate(flint.acb(g)).real) == pytest.approx(expected, rel=1e-14)


@pytest.mark.parametrize(
    ("law", "expected"),
    [
        (lambda u, k: 2 * ca.sin(k["k"] * u["a"] + 1) - 3, [("sub", "a")]),
        (lambda u, k: ca.exp(u["a"]) + ca.sqrt(u["a"]) / (1 + u["a"]), [("add", "a")]),
        (lambda u, k: ca.exp(u["a"]) * ca.sin(u["b"]), [("exp", "a"), ("sin", "b")]),
        (lambda u, k: ca.exp(ca.sin(u["a"]) * u["b"]), [("sin", "a"), ("exp", "mul")]),
        (lambda u, k: ca.sqrt(u["a"]) + 1 / u["b"], []),
        (lambda u, k: ca.sin(k["k"]) * u["a"], []),
        (lambda u, k: ca.sin(ca.fmin(u["a"], 1)), [("sin", "min")]),
        (lambda u, k: ca.fmin(3 * ca.sin(u["a"]), 1), [("mul", "a")]),
        (lambda u, k: ca.fabs(ca.log(u["a"] / 3)), [("log", "a")]),
        (lambda u, k: ca.if_else(u["a"] < 1, ca.exp(u["a"]), 2), [("exp", "a")]),
        (lambda u, k: ca.sin(u["a"]) < 0.5, [("sin", "a")]),
        (lambda u, k: ca.atan2(ca.sin(u["a"]), u["a"]), [("sin", "a")]),
        (lambda u, k: ca.tan(u["a"]) + ca.sin(u["a"]), [("sin", "a")]),  # tan has a pole in the range
        (lambda u, k: 1 / (u["a"] - 1) + ca.sin(u["a"]), [("sin", "a")]),
    ],
)
def test_roots_and_variables(law: Callable[..., ca.SX], expected: list[tuple[str, str]]) -> None:
    assert sorted(shapes(analyse(law))) == sorted(expected)


def test_a_subexpression_that_is_read_elsewhere_is_a_root_of_its_own() -> None:
    def law(u: Any, k: Any) -> dict[str, ca.SX]:
        s = ca.sin(u["a"])
        return {"y": ca.exp(s) * u["b"], "z": s * u["c"], "w": 0}

    assert shapes(analyse(law)) == [("sin", "a"), ("exp", "a")]


def test_roots_that_are_multiples_of_one_node_become_that_node() -> None:
    def law(u: Any, k: Any) -> dict[str, ca.SX]:
        s = k["k"] * ca.exp(ca.sin(u["a"]))
        return {"y": 2 * s * u["b"], "z": (7 - s) * u["b"], "w": s * u["c"]}

    program, _, functions = analyse(law)
    assert shapes((program, (), functions)) == [("mul", "a")] and len(program.users()[functions[0].root]) == 3

    def multiple_and_square(u: Any, k: Any) -> dict[str, ca.SX]:
        s = ca.sin(u["a"])
        return {"y": 3 * s * u["b"], "z": s**2 * u["b"], "w": 0}

    assert sorted(shapes(analyse(multiple_and_square))) == [("mul", "a"), ("sq", "a")]


def test_a_value_that_may_be_nan_is_not_a_variable() -> None:
    assert shapes(analyse(lambda u, k: ca.sin(u["a"]), guarded="a")) == []
    held = analyse(lambda u, k: ca.sin(ca.fmax(ca.fmin(u["a"], 1), 0)), guarded="a")
    assert shapes(held) == [("sin", "max")]


def test_a_state_is_a_variable_too() -> None:
    states = [State(Signal("s", "1", 0, 1), 0)]
    block = build(
        "kept",
        TIME,
        lambda u, x, k: Step({"y": 2 * ca.cosh(x["s"])}, {"s": x["s"]}),
        inputs=INPUTS,
        outputs=[Signal("y", "1", 0, 9)],
        states=states,
    )
    program = lower.program(block)
    functions = univariate.find(program, ranges.analyse(program, ranges.bounds(block, F64), F64))
    assert shapes((program, (), functions)) == [(program.nodes[program.outputs["y"]].op, "s")]


def test_a_diamond_has_its_fork_as_dominator() -> None:
    nodes = [
        Node("input", name="a"),
        Node("input", name="b"),
        Node("sub", (0, 1)),
        Node("sin", (2,)),
        Node("cos", (2,)),
    ]
    nodes += [Node("mul", (3, 4)), Node("add", (5, 0))]
    program = Program(tuple(nodes), (), {"y": 6}, {})
    assert univariate.find(program, [Range(0, 1)] * 7) == (Univariate(5, 2),)


def test_a_named_signal_separates_functions() -> None:
    def law(named: bool) -> Block:
        def step(u: Any, x: Any, k: Any) -> Step:
            s = ca.sin(u["a"])
            return Step({"y": ca.exp(s) * u["b"]}, named=[(Signal("s", "1", -1, 1), s)] if named else [])

        return build("named", TIME, step, inputs=INPUTS, outputs=[Signal("y", "1", -99, 99)])

    for named, expected in ((False, [("exp", "a")]), (True, [("sin", "a"), ("exp", "sin")])):
        program = lower.program(law(named))
        analysed = ranges.analyse(program, ranges.bounds(law(named), F64), F64)
        assert shapes((program, analysed, univariate.find(program, analysed))) == expected


COMPLEX: dict[str, Callable[[complex], complex]] = {
    "neg": lambda z: -z,
    "sq": lambda z: z * z,
    "twice": lambda z: 2 * z,
    "inv": lambda z: 1 / z,
    **{
        n: getattr(cmath, n)
        for n in ("sqrt", "log", "asin", "acos", "atan", "exp", "sin", "cos", "tan", "sinh", "cosh", "tanh", "asinh")
    },
    "erf": lambda z: complex(mpmath.erf(z)),
}


@pytest.mark.parametrize("op", COMPLEX)
@pytest.mark.parametrize("z", [0.5 + 0j, 0.3 - 0.2j, 0.7 + 1.5j])
def test_operations_on_complex_numbers(op: str, z: complex) -> None:
    f = univariate.function((("variable", (), 0.0), (op, (0,), 0.0)))
    y = f(flint.acb(z.real, z.imag))
    assert complex(y) == pytest.approx(COMPLEX[op](z), rel=1e-13)


@pytest.mark.parametrize(
    ("op", "ball"),
    [
        ("inv", flint.acb(flint.arb(0, 0.1))),
        ("sqrt", flint.acb(flint.arb(0.1, 0.2))),
        ("sqrt", flint.acb(-1, flint.arb(0, 0.1))),
        ("log", flint.acb(-1, flint.arb(0, 0.1))),
        ("asin", flint.acb(flint.arb(0.9, 0.2), flint.arb(0, 0.1))),
        ("acos", flint.acb(-1.5, flint.arb(0, 0.1))),
        ("atan", flint.acb(flint.arb(0, 0.1), flint.arb(0.9, 0.2))),
        ("asinh", flint.acb(flint.arb(0, 0.1), flint.arb(-1.1, 0.2))),
        ("tan", flint.acb(flint.arb(1.5, 0.1))),
        ("tanh", flint.acb(flint.arb(0, 0.1), flint.arb(1.5, 0.1))),
    ],
)
def test_a_ball_over_a_pole_or_a_branch_cut_is_not_finite(op: str, ball: flint.acb) -> None:
    f = univariate.function((("variable", (), 0.0), (op, (0,), 0.0)))
    assert not f(ball).is_finite()
    beside = flint.acb(ball.real.mid() + 0.25, ball.imag.mid() + 0.25)
    assert f(beside).is_finite()


def test_equal_functions_have_equal_keys_and_others_are_refused() -> None:
    program, analysed, functions = analyse(lambda u, k: force(u["a"], k) * force(u["b"], k) * ca.sin(u["c"]))
    assert len({f.variable for f in functions}) == 3
    keys = [univariate.key(program, analysed, f.root, f.variable) for f in functions]
    assert len(keys) == 3 and len(set(keys)) == 2
    with pytest.raises(EmitError, match=r"not an analytic function of node \d+: it needs 'b'"):
        univariate.key(program, analysed, program.outputs["y"], functions[0].variable)


def test_a_block_without_such_functions_has_none() -> None:
    block: Block = build(
        "linear", TIME, lambda u, x, k: Step({"y": 2 * u["a"]}), inputs=INPUTS, outputs=[Signal("y", "1", 0, 9)]
    )
    program = lower.program(block)
    assert univariate.find(program, ranges.analyse(program, ranges.bounds(block, F64), F64)) == ()
