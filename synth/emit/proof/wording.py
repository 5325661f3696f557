"""Descriptions of a program's nodes for messages: the signal, the expression in C syntax, values with units."""

from collections.abc import Sequence

from synth.block import Block
from synth.emit.program.lower import Program
from synth.emit.proof.interval import Array

_INFIX = {"add": "+", "sub": "-", "mul": "*", "div": "/", "lt": "<", "le": "<=", "eq": "==", "ne": "!="}
_INFIX |= {"and": "&&", "or": "||", "sq": "*"}
_PREFIX = {"neg": "-", "not": "!", "twice": "2 * ", "inv": "1 / "}
_DEEPEST, _LONGEST, _SHORT = 8, 160, 40  # limits of nesting depth and of characters


def signal(program: Program, k: int) -> str:
    """Return the first signal, in the order of the composition, that depends on node k."""
    named = next((named for named, at in program.marks if k in _cone(program, at)), None)
    if named is None:
        return "the next states"
    return f"'{named.signal.name}' (block '{named.block}'" + (f", {named.tag})" if named.tag else ")")


def _cone(program: Program, k: int) -> set[int]:
    nodes, waiting = set[int](), [k]
    while waiting:
        k = waiting.pop()
        if k not in nodes:
            nodes.add(k)
            waiting += program.nodes[k].args
    return nodes


def expression(program: Program, k: int, spelled: bool = True) -> str:
    """Return node k as text, `spelled` out even if it has a name; deeply nested operands become (...)."""
    names = {at: named.signal.name for named, at in program.marks}
    names |= {at: node.name for at, node in enumerate(program.nodes) if node.name}
    if k in names and (not spelled or program.nodes[k].name):
        return names[k]
    names.pop(k, None)
    texts = (_text(program, names, k, depth) for depth in range(_DEEPEST, 0, -1))
    return next((t for t in texts if len(t) <= _LONGEST), _text(program, names, k, 1))


def function(program: Program, root: int, variable: int) -> str:
    """Return node `root` as a function of x, the node `variable`, "" where the text is long."""
    names = {at: node.name for at, node in enumerate(program.nodes) if node.op == "constant"} | {variable: "x"}
    text = _text(program, names, root, _DEEPEST)
    return "" if len(text) > _SHORT else text[1:-1] if text.startswith("(") else text


def _text(program: Program, names: dict[int, str], k: int, depth: int) -> str:
    node = program.nodes[k]
    if k in names:
        return names[k]
    if node.op == "literal":
        return f"{node.value:.9g}"
    if not depth:
        return "(...)"
    sides = [_text(program, names, a, depth - 1) for a in node.args]
    if node.op in _INFIX:
        return f"({sides[0]} {_INFIX[node.op]} {sides[-1]})"
    if node.op in ("choose", "when"):
        return f"({sides[0]} ? {sides[1]} : {sides[2] if node.op == 'choose' else '0'})"
    if node.op in _PREFIX:
        return f"({_PREFIX[node.op]}{sides[0]})"
    return f"{node.op}{sides[0]}" if len(sides) == 1 and sides[0][0] == "(" else f"{node.op}({', '.join(sides)})"


def values(block: Block, program: Program, leaves: Sequence[int], low: Array, high: Array) -> str:
    """Return the leaves' values, or ranges, with units."""
    units = {s.name: s.unit for s in (*block.inputs, *(s.signal for s in block.states))}
    units |= {named.signal.name: named.signal.unit for named, _ in program.marks}
    rows = []
    for leaf, first, last in zip(leaves, low, high, strict=True):
        name = expression(program, leaf, spelled=False)
        text = f"{first:.9g}" if first == last else f"{first:.9g} .. {last:.9g}"
        rows.append(f"{name} = {text}" + (f" {units[name]}" if name in units else ""))
    return ", ".join(rows)
