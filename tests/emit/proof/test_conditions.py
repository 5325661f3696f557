"""Narrowing by conditions, against sampling: no value that satisfies the condition is lost, and the ends are tight."""

from math import inf, nan

import numpy as np
import pytest

from synth.emit.program.lower import Node, Program
from synth.emit.proof import conditions
from synth.emit.proof.interval import Interval, interval
from synth.emit.proof.libm import transfer
from tests.emit.c_arithmetic import compute

F32 = np.float32
X, Y, ONE = Node("input", name="x"), Node("input", name="y"), Node("literal", value=1.0)
Side = tuple[float, float, bool]
LOADS = (X, Y, ONE)  # nodes 0, 1, 2


def narrow(*nodes: Node, holds: bool, x: Side, y: Side = (0, 1, False), whole: bool = False) -> dict[int, Side]:
    """Return the narrowed interval of each node where the last node holds, or fails."""
    every = (*LOADS, *nodes)
    R: dict[int, Interval] = {0: interval(*x, F32), 1: interval(*y, F32), 2: interval(1, 1, False, F32)}
    for k, node in enumerate(nodes, 3):
        args = [R[a] for a in node.args]
        R[k] = transfer(node.op, args, 4)
    last = len(every) - 1
    narrowed = conditions.narrow(every, frozenset({0, 1, 2}) if whole else frozenset(), last, holds, R)
    assert set(narrowed) <= conditions.narrowable_nodes(every, last)
    return {k: (float(a.low[0]), float(a.high[0]), bool(a.nan[0])) for k, a in narrowed.items()}


BELOW, ABOVE = float(np.nextafter(F32(1), F32(0))), float(np.nextafter(F32(1), F32(2)))


@pytest.mark.parametrize(
    ("nodes", "holds", "expected"),
    [
        ([Node("le", (0, 2))], True, (-3, 1, False)),
        ([Node("le", (0, 2))], False, (ABOVE, 5, True)),
        ([Node("lt", (0, 2))], True, (-3, BELOW, False)),
        ([Node("lt", (0, 2))], False, (1, 5, True)),
        ([Node("le", (2, 0))], True, (1, 5, False)),
        ([Node("eq", (0, 2))], True, (1, 1, False)),
        ([Node("ne", (0, 2))], False, (1, 1, False)),
        ([Node("neg", (0,)), Node("le", (3, 2))], True, (-1, 5, False)),
        ([Node("neg", (0,)), Node("lt", (2, 3))], True, (-3, -ABOVE, False)),
        ([Node("fabs", (0,)), Node("le", (3, 2))], True, (-1, 1, False)),
        ([Node("sq", (0,)), Node("le", (3, 2))], True, (-ABOVE, ABOVE, False)),
        (
            [Node("mul", (0, 0)), Node("sq", (1,)), Node("add", (3, 4)), Node("le", (5, 2))],
            True,
            (-ABOVE, ABOVE, False),
        ),
        ([Node("sq", (0,)), Node("add", (3, 1)), Node("le", (4, 2))], True, (-3, 5, True)),  # y may be negative
        ([Node("mul", (0, 1)), Node("le", (3, 2))], True, (-3, 5, True)),
        ([Node("le", (0, 2)), Node("not", (3,))], True, (ABOVE, 5, True)),
        ([Node("le", (0, 2)), Node("le", (2, 0)), Node("and", (3, 4))], True, (1, 1, False)),
        ([Node("lt", (0, 2)), Node("lt", (2, 0)), Node("or", (3, 4))], False, (1, 1, True)),
        ([Node("eq", (0, 2)), Node("eq", (0, 1)), Node("or", (3, 4))], True, (0, 1, False)),
        ([Node("le", (0, 2)), Node("le", (0, 1)), Node("and", (3, 4))], False, (0, 5, True)),
    ],
)
def test_the_interval_of_x_is_narrowed(nodes: list[Node], holds: bool, expected: tuple[float, float, bool]) -> None:
    assert narrow(*nodes, holds=holds, x=(-3, 5, True)).get(0, (-3, 5, True)) == pytest.approx(expected, abs=1e-44)


SQUARES = (Node("sq", (0,)), Node("mul", (1, 1)), Node("add", (3, 4)))


def test_a_sum_of_squares_bounds_each_of_its_terms_tightly() -> None:
    bounds = conditions.bounds_of_squares((*LOADS, *SQUARES, Node("le", (5, 2))), 6, F32)
    assert bounds.keys() == {0, 1}
    assert 1 <= min(bounds.values()) <= max(bounds.values()) == ABOVE


@pytest.mark.parametrize(
    "condition",
    [
        (*SQUARES, Node("le", (2, 5))),  # a lower bound
        (*SQUARES, Node("le", (5, 1))),  # the limit is not a number
        (*SQUARES, Node("not", (5,))),
        (Node("sq", (0,)), Node("add", (3, 1)), Node("le", (4, 2))),  # y may be negative
    ],
)
def test_another_condition_bounds_nothing(condition: tuple[Node, ...]) -> None:
    assert conditions.bounds_of_squares((*LOADS, *condition), len(condition) + 2, F32) == {}


@pytest.mark.parametrize(("op", "holds"), [("eq", False), ("ne", True)])
def test_inequality_of_values_narrows_nothing(op: str, holds: bool) -> None:
    assert set(narrow(Node(op, (0, 2)), holds=holds, x=(-3, 5, True))) == {3}


def test_both_sides_are_narrowed() -> None:
    narrowed = narrow(Node("lt", (0, 1)), holds=True, x=(0.5, 5, False), y=(-1, 2, True))
    assert narrowed[0][1] < 2 and narrowed[1][0] > 0.5 and not narrowed[1][2]


def test_a_failed_comparison_with_nan_narrows_nothing() -> None:
    narrowed = narrow(Node("le", (0, 1)), holds=False, x=(-3, 5, False), y=(0, 1, True))
    assert narrowed[0] == (-3, 5, False) and narrowed[1] == (0, 1, True)


def test_strict_bounds_of_whole_numbers_move_by_one() -> None:
    assert narrow(Node("lt", (0, 2)), holds=True, x=(-3, 5, False), whole=True)[0] == (-3, 0, False)
    assert narrow(Node("le", (0, 2)), holds=False, x=(-3, 5, False), whole=True)[0] == (2, 5, False)
    for x, expected in (
        ((0, 5, False), (1, 5, False)),
        ((-4, 0, False), (-4, -1, False)),
        ((-4, 5, False), (-4, 5, False)),
    ):
        R = {0: interval(*x, F32)}
        narrowed = conditions.narrow(LOADS, frozenset({0}), 0, True, R)[0]
        assert (narrowed.low[0], narrowed.high[0], narrowed.nan[0]) == expected
        zero = conditions.narrow(LOADS, frozenset({0}), 0, False, R)[0]
        assert zero.low[0] == zero.high[0] == 0
    assert conditions.narrow(LOADS, frozenset(), 0, True, {0: interval(0, 5, True, F32)}) == {}


def test_an_impossible_condition_gives_an_empty_interval() -> None:
    assert narrow(Node("le", (0, 2)), holds=True, x=(2, 5, False))[0][0] > 1
    narrowed = narrow(Node("le", (0, 2)), holds=True, x=(2, 5, True))
    assert narrowed[0][0] > narrowed[0][1] and not narrowed[0][2]
    assert narrowed[3][0] > narrowed[3][1]  # the condition itself


@pytest.mark.parametrize("holds", [True, False])
def test_no_value_that_meets_a_random_condition_is_lost(holds: bool) -> None:
    rng = np.random.default_rng(7)
    grid = [-2.0, -1.0, -0.5, 0.0, 0.5, 1.0, 2.0, nan, inf]
    for _ in range(300):
        nodes: list[Node] = list(LOADS)
        for _ in range(rng.integers(1, 6)):
            op = str(rng.choice(["le", "lt", "eq", "ne", "and", "or", "not", "fabs", "neg", "sq", "add"]))
            count = 1 if op in ("not", "fabs", "neg", "sq") else 2
            nodes.append(Node(op, tuple(int(rng.integers(len(nodes))) for _ in range(count))))
        program = Program(tuple(nodes), (), {}, {})
        R = {0: interval(-2, inf, True, F32), 1: interval(-2, inf, True, F32)}
        for k, node in enumerate(nodes[2:], 2):
            R[k] = interval(1, 1, False, F32) if k == 2 else transfer(node.op, [R[a] for a in node.args], 4)
        last = len(nodes) - 1
        narrowed = conditions.narrow(nodes, frozenset(), last, holds, R)
        for x in grid:
            for y in grid:
                values = compute(program, {"x": x, "y": y}, F32)
                for k, a in narrowed.items() if bool(values[last] != 0) == holds else ():
                    inside = a.nan[0] if np.isnan(values[k]) else a.low[0] <= values[k] <= a.high[0]
                    assert inside, (nodes, x, y, k)
