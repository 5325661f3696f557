"""Programs of a few nodes, folded, and the text of the result."""

from synth.emit.passes import fold
from synth.emit.program.lower import Node, Program

LEAVES = [Node("input", name=n) for n in "abc"] + [Node("constant", name="k"), Node("constant", name="l")]

A, B, C, K, L = range(5)


def fold_nodes(*nodes: Node, leaves: list[Node] = LEAVES) -> Program:
    """Fold a program whose output is the last node."""
    return fold.folded(Program((*leaves, *nodes), (), {"y": len(leaves) + len(nodes) - 1}, {}))


def tree(program: Program, k: int | None = None) -> str:
    """Write a node as a text, operations before their arguments."""
    node = program.nodes[program.outputs["y"] if k is None else k]
    if node.op in ("input", "constant", "state"):
        return node.name
    if node.op == "literal":
        return f"{node.value:g}"
    return f"{node.op}({', '.join(tree(program, a) for a in node.args)})"
