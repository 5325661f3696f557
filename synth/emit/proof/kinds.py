"""Type inference: the C type of each node of a program, a truth value, an unsigned integer or the scalar type."""

from collections.abc import Sequence

from synth.emit.program.lower import Node, Program
from synth.emit.program.operations import LOGICAL
from synth.emit.proof import ranges, wording
from synth.errors import EmitError


def kinds(p: Program) -> list[str]:
    """Return the kind of each node: "logical", "integer", "real", or "number" for a literal of either of the last two.

    A sum of truth values is an integer. A difference of integers may be negative. It is an integer only if integer
    states alone use it.
    """
    kind_of: list[str] = []
    counted = _only_in_counters(p)
    for k, node in enumerate(p.nodes):
        args = [kind_of[a] for a in node.args]
        whole = all(
            k in ("integer", "logical") or (k == "number" and is_whole(p.nodes[a]))
            for a, k in zip(node.args, args, strict=True)
        )
        kind = "real"
        if node.op in LOGICAL:
            kind = "logical"
        elif node.op == "literal":
            kind = "number"
        elif node.op == "accepted":
            kind = "logical"
        elif node.op in ("bit", "guarded") or (node.op == "state" and node.name in p.integers):
            kind = "integer"
        elif node.op in ("argument", "result"):
            kind = p.typed[node.name]
        elif node.op == "choose":
            kind = _kind_of_choice(p, node, args[1:])
        elif whole and (_is_sum(node, args) or (node.op == "sub" and "integer" in args and k in counted)):
            kind = "integer"
        kind_of.append(kind)
    return kind_of


def _is_sum(node: Node, kinds: Sequence[str]) -> bool:
    return node.op == "add" and ("integer" in kinds or "logical" in kinds)


def _only_in_counters(p: Program) -> set[int]:
    """Return the nodes that only integer states use, either directly or as arms of choices."""
    other = {*p.outputs.values(), *(k for name, k in p.next.items() if name not in p.integers)}
    for k in range(len(p.nodes) - 1, -1, -1):
        node = p.nodes[k]
        other.update(node.args[:1] if node.op == "choose" and k not in other else node.args)
    return set(range(len(p.nodes))) - other


def is_whole(node: Node) -> bool:
    return 0 <= node.value < 2**32 and node.value == int(node.value)


def _kind_of_choice(p: Program, node: Node, arms: Sequence[str]) -> str:
    literals = [p.nodes[a] for a, kind in zip(node.args[1:], arms, strict=True) if kind == "number"]
    flags = all(n.value in (0.0, 1.0) for n in literals)
    if set(arms) <= {"logical", "number"} and flags:
        return "logical"
    if "integer" in arms and "real" not in arms and all(is_whole(n) for n in literals):
        return "integer"
    return "real"


def require_whole(program: Program, proved: Sequence[ranges.Range]) -> None:
    """Raise EmitError for an unsigned 32-bit integer that may overflow.

    A possibly negative one is used only by an integer state through choices; the proof of that state's range covers it.
    """
    for k, kind in enumerate(kinds(program)):
        if kind == "integer" and not proved[k].high < 2**32:
            raise EmitError(
                f"{wording.signal(program, k)}: the count {wording.expression(program, k)} is {proved[k].low:.9g} .. "
                f"{proved[k].high:.9g}, but a uint32_t holds 0 .. 4294967295: limit it"
            )
