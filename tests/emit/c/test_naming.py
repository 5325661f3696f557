"""Names of values that have no signal."""

import pytest

from synth.emit.c.naming import Naming
from synth.emit.program.lower import Node, Program

COUNT = (Node("state", name="count"), Node("literal", value=3.0), Node("literal"), Node("literal", value=0.5))


def program(*nodes: Node) -> Program:
    return Program((*COUNT, *nodes), (), {"y": 3 + len(nodes)}, {}, integers=frozenset({"count"}))


@pytest.mark.parametrize(
    ("node", "expected"),
    [
        (Node("le", (1, 0)), "count_at_least_3"),
        (Node("lt", (1, 0)), "count_above_3"),
        (Node("le", (0, 1)), "count_at_most_3"),
        (Node("lt", (0, 1)), "count_below_3"),
        (Node("lt", (2, 0)), "count_positive"),
        (Node("lt", (3, 0)), "y_test"),
    ],
)
def test_a_comparison_with_a_whole_number_says_so(node: Node, expected: str) -> None:
    assert Naming(program(node), {}, {}).name(4) == expected


def test_choices_that_change_a_state_are_its_next_value() -> None:
    less, changed, held = Node("lt", (0, 1)), Node("choose", (4, 1, 2)), Node("choose", (4, 5, 0))
    p = Program((*COUNT, less, changed, held), (), {}, {"count": 6}, integers=frozenset({"count"}))
    assert [Naming(p, {}, {}).name(k) for k in (5, 6)] == ["count_next", "count_next"]


def test_choices_in_one_variable_have_the_name_of_the_last_that_has_one() -> None:
    """Without the choices that share its variable, the first would be named after what it serves."""
    less, first, second = Node("lt", (0, 1)), Node("choose", (4, 1, 3)), Node("choose", (4, 2, 5))
    p = Program((*COUNT, less, first, second), (), {"y": 6}, {}, labels={6: "direction"})
    assert Naming(p, {}, {6: 5}).name(5) == "direction"
    assert Naming(p, {}, {}).name(5) == "y_choice"


ARMS = (Node("state", name="ready"), Node("state", name="v"), Node("literal", value=0.5), Node("literal"))


@pytest.mark.parametrize(
    ("nodes", "expected"),
    [
        ((Node("mul", (1, 1)), Node("mul", (4, 1)), Node("choose", (0, 5, 3))), "y_if_ready"),
        ((Node("mul", (1, 1)), Node("add", (4, 2)), Node("sub", (5, 1))), "y_without_v"),
        ((Node("mul", (1, 1)), Node("add", (4, 2)), Node("sqrt", (5,))), "y_radicand"),
        ((Node("mul", (1, 1)), Node("add", (4, 2)), Node("div", (5, 1))), "y_numerator"),
        ((Node("mul", (1, 1)), Node("add", (4, 2)), Node("div", (1, 5))), "y_denominator"),
        ((Node("mul", (1, 1)), Node("add", (4, 2)), Node("min", (5, 1))), "y_unlimited"),
        ((Node("mul", (1, 1)), Node("add", (4, 2)), Node("add", (1, 5))), "y_change"),
        ((Node("mul", (1, 1)), Node("mul", (2, 4)), Node("mul", (1, 5))), "y_product"),
    ],
)
def test_a_value_on_the_way_to_a_signal_says_what_becomes_of_it(nodes: tuple[Node, ...], expected: str) -> None:
    p = Program((*ARMS, *nodes), (), {"y": 6}, {})
    assert Naming(p, {6: "y"}, {}).name(5) == expected
