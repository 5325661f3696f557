"""Products of named constants are computed once; constants that are read elsewhere remain."""

from synth.block import Constant, Step, build
from synth.emit.passes import fold
from synth.emit.program import lower
from synth.emit.program.lower import Node, Program
from synth.signals import Signal
from synth.timing import Discrete
from tests.emit.passes.trees import LEAVES, A, B, K, L, fold_nodes, tree


def merge_constants(*nodes: Node) -> Program:
    return fold.with_constant_products(fold_nodes(*nodes, leaves=[*LEAVES, Node("constant", name="m")]))


M = 5


def test_two_constants_become_one() -> None:
    program = merge_constants(Node("mul", (L, A)), Node("mul", (K, 6)))
    assert tree(program) == "mul(k_times_l, a)" and program.products == {"k_times_l": ("k", "l")}


def test_three_constants_become_two() -> None:
    """The third constant remains a factor."""
    program = merge_constants(Node("mul", (M, A)), Node("mul", (L, 6)), Node("mul", (K, 7)))
    assert tree(program) == "mul(k, mul(l_times_m, a))" and program.products == {"l_times_m": ("l", "m")}
    assert fold.with_constant_products(program).products == {
        "l_times_m": ("l", "m"),
        "k_times_l_times_m": ("k", "l_times_m"),
    }


def test_a_product_that_is_read_elsewhere_is_not_merged() -> None:
    program = merge_constants(Node("mul", (L, A)), Node("mul", (K, 6)), Node("add", (6, 7)))
    assert not program.products


def test_a_used_name_is_not_used_again() -> None:
    leaves = [*LEAVES, Node("constant", name="k_times_l")]
    nodes = [Node("mul", (L, A)), Node("mul", (K, 6)), Node("mul", (5, B)), Node("add", (7, 8))]
    assert not fold.with_constant_products(fold_nodes(*nodes, leaves=leaves)).products


def test_a_block_keeps_its_constants() -> None:
    block = build(
        "kept",
        Discrete(1e-3),
        lambda u, x, k: Step({"y": 2 * (k["k"] * (3 * u["a"])) + k["l"] / 4}),
        inputs=[Signal("a", "1", -1, 1)],
        outputs=[Signal("y", "1", -99, 99)],
        constants=[Constant("k", 0.1, "1", "test"), Constant("l", 0.3, "1", "test")],
    )
    program = fold.folded(lower.program(block))
    assert {n.name for n in program.nodes if n.op == "constant"} == {"k", "l"}
