"""Polynomials of several variables in one vector: which are put together, their order, and the bits of the C."""

import ctypes

import numpy as np
import pytest

from synth.emit.program import lower
from synth.emit.program.lower import Node, Program
from synth.execute import compile as host_compiler
from synth.simulate.lanes import lane_code
from synth.simulate.lanes.lane_code import Rows

C = tuple(f"c{k}" for k in range(4))
RUN = """#include <math.h>
#include <stdint.h>
#define LANES {lanes}
{functions}
void run(const vd *x, const vd *p, vd *out) {{ f(x, x, p, out); }}
"""


def polynomials(dependent: bool) -> Program:
    """Three cubics with the same coefficients and one with others; `dependent`: the third is one of the first."""
    nodes = [Node("parameter", name=c) for c in C] + [Node("state", name=s) for s in ("a", "b", "d")]
    outputs = {}

    def place(variable: int, coefficients: tuple[int, ...]) -> int:
        *lower, value = coefficients
        for c in reversed(lower):
            nodes.append(Node("fma", (variable, value, c)))
            value = len(nodes) - 1
        return value

    outputs["p"], outputs["q"] = place(4, (0, 1, 2, 3)), place(5, (0, 1, 2, 3))
    outputs["r"] = place(outputs["p"] if dependent else 6, (0, 1, 2, 3))
    outputs["s"] = place(6, (3, 1, 2, 0))
    return Program(tuple(nodes), (), outputs, {})


def test_equal_polynomials_of_independent_variables_form_a_group() -> None:
    assert [len(group) for group in lane_code.groups(polynomials(False))] == [3]


def test_a_polynomial_of_another_one_is_not_in_its_group() -> None:
    program = polynomials(True)
    (group,) = lane_code.groups(program)
    assert {chain.value for chain in group} == {program.outputs["p"], program.outputs["q"]}


def test_a_chain_ends_where_its_value_is_read_twice() -> None:
    nodes = [Node("parameter", name=c) for c in C] + [Node("state", name=s) for s in "ab"]
    for t in (4, 5):
        nodes += [Node("fma", (t, 3, 2)), Node("fma", (t, len(nodes), 1)), Node("fma", (t, len(nodes) + 1, 0))]
    program = Program(tuple(nodes), (), {"p": 8, "q": 11, "inner": 7}, {})
    assert lane_code.groups(program) == []


@pytest.mark.parametrize("dependent", [False, True])
def test_every_node_comes_after_all_that_it_needs(dependent: bool) -> None:
    program = polynomials(dependent)
    done = set[int]()
    for item in lane_code.schedule(program):
        group = () if isinstance(item, int) else item
        needs = (
            program.nodes[item].args if isinstance(item, int) else [a for c in group for a in (c.variable, *c.terms)]
        )
        assert done.issuperset(needs)
        done |= {item} if isinstance(item, int) else {chain.value for chain in group}
    assert done.issuperset(program.outputs.values())


@pytest.mark.parametrize("dependent", [False, True])
def test_one_lane_has_the_bits_of_eight(dependent: bool) -> None:
    program, outputs = polynomials(dependent), ("p", "q", "r", "s")
    rng = np.random.default_rng(3)
    x, p = rng.uniform(-1, 1, 3), rng.uniform(-1, 1, 4)
    values = []
    for number in (1, 8):
        text = lane_code.function("f", program, Rows((), ("a", "b", "d"), (), C, outputs), number)
        assert ("vd4" in text) == (number == 1 and not dependent)
        source = RUN.format(lanes=number, functions=lane_code.SUPPORT + text)
        flags = ("-O2", "-march=native", "-std=c11", "-Wno-psabi")
        library = ctypes.CDLL(str(host_compiler.shared_library({"chains.c": source}, flags)))
        arrays = [np.repeat(a, number) for a in (x, p, np.zeros(4))]
        aligned = [_aligned(a) for a in arrays]
        library.run(*(ctypes.c_void_p(a.ctypes.data) for a in aligned))
        values.append(aligned[2][::number])
    assert values[0].tobytes() == values[1].tobytes()
    known = dict(enumerate((*p, *x)))
    exact = lower.evaluate(program, program.outputs.values(), {k: np.array(v) for k, v in known.items()})
    assert np.allclose(values[0], [exact[k] for k in program.outputs.values()], rtol=1e-13)


def _aligned(values: np.ndarray) -> np.ndarray:
    memory = np.zeros(values.size + 8)
    first = -memory.ctypes.data % 64 // 8
    memory[first : first + values.size] = values
    return memory[first : first + values.size]
