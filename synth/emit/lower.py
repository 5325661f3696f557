"""Lowering: a Block becomes a straight-line program, one node a value, in the order in which CasADi computes it.

After common-subexpression elimination CasADi lists its instructions depth first in the order of the outputs asked for.
The intermediate signals of the composition are asked for first, in the order of computation, so the lines that compute
a signal stand directly before it and carry its Block's equation tag. CasADi's pair of `if_else_zero` and a negated
condition is read back as the choice that it was.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field

import casadi as ca

from synth.block import Block, Named, State
from synth.errors import EmitError

UNARY = {
    ca.OP_NEG: "neg",
    ca.OP_EXP: "exp",
    ca.OP_LOG: "log",
    ca.OP_SQRT: "sqrt",
    ca.OP_SQ: "sq",
    ca.OP_TWICE: "twice",
    ca.OP_SIN: "sin",
    ca.OP_COS: "cos",
    ca.OP_TAN: "tan",
    ca.OP_ASIN: "asin",
    ca.OP_ACOS: "acos",
    ca.OP_ATAN: "atan",
    ca.OP_SINH: "sinh",
    ca.OP_COSH: "cosh",
    ca.OP_TANH: "tanh",
    ca.OP_FABS: "fabs",
    ca.OP_INV: "inv",
    ca.OP_NOT: "not",
}
BINARY = {
    ca.OP_ADD: "add",
    ca.OP_SUB: "sub",
    ca.OP_MUL: "mul",
    ca.OP_DIV: "div",
    ca.OP_FMIN: "min",
    ca.OP_FMAX: "max",
    ca.OP_ATAN2: "atan2",
    ca.OP_LT: "lt",
    ca.OP_LE: "le",
    ca.OP_EQ: "eq",
    ca.OP_NE: "ne",
    ca.OP_AND: "and",
    ca.OP_OR: "or",
    ca.OP_IF_ELSE_ZERO: "when",
}
LOGICAL = frozenset({"lt", "le", "eq", "ne", "and", "or", "not"})


@dataclass(frozen=True)
class Node:
    """One value: an operation on earlier nodes, a literal (`value`), or a load (`name`)."""

    op: str
    args: tuple[int, ...] = ()
    value: float = 0.0
    name: str = ""


@dataclass(frozen=True)
class Program:
    """Nodes in the order of computation, and where each named signal, output, next state and fault bit is found.

    `marks` holds (nodes computed so far, signal, node): the signal is complete once that many nodes stand.
    """

    nodes: tuple[Node, ...]
    marks: tuple[tuple[int, Named, int], ...]
    outputs: dict[str, int]
    next: dict[str, int]
    integers: frozenset[str] = field(default=frozenset())

    def uses(self) -> list[int]:
        """Return how many times each node is read by other nodes, marks apart."""
        count = [0] * len(self.nodes)
        for node in self.nodes:
            for a in node.args:
                count[a] += 2 if node.op == "sq" else 1
        for a in (*self.outputs.values(), *self.next.values()):
            count[a] += 1
        return count


def program(block: Block) -> Program:
    """Lower a Block.

    Raises EmitError for an operation that C emission does not know, naming it.
    """
    loads = [*(("input", s.name) for s in block.inputs), *(("state", s.name) for s in block.states)]
    loads += [("constant", c.name) for c in block.constants]
    wanted = [e for _, e in block.inside] + list(block.output.values()) + list(block.next.values())
    shared = ca.cse(wanted)
    f = ca.Function("step", [ca.vcat([block.symbol[n] for _, n in loads])], [ca.vcat(shared)])
    nodes, results = _walk(f, loads)
    count = len(block.inside)
    marks = tuple((at, named, node) for (named, _), (at, node) in zip(block.inside, results[:count], strict=True))
    tail = [node for _, node in results[count:]]
    outputs = dict(zip(block.output, tail, strict=False))
    next = dict(zip(block.next, tail[len(outputs) :], strict=True))
    return _prune(Program(tuple(nodes), marks, outputs, next, frozenset(_integers(block.states))))


def _integers(states: Sequence[State]) -> list[str]:
    return [s.name for s in states if s.integer]


def _walk(f: ca.Function, loads: list[tuple[str, str]]) -> tuple[list[Node], list[tuple[int, int]]]:
    """Turn the instruction list into nodes in single-assignment form; return also (nodes so far, node) by output."""
    nodes: list[Node] = []
    slot: dict[int, int] = {}
    results: list[tuple[int, int]] = []
    known: dict[Node, int] = {}

    def add(node: Node) -> int:
        if node not in known:
            known[node] = len(nodes)
            nodes.append(node)
        return known[node]

    for k in range(f.n_instructions()):
        op, i, o = f.instruction_id(k), f.instruction_input(k), f.instruction_output(k)
        if op == ca.OP_OUTPUT:
            results.append((len(nodes), slot[i[0]]))
        elif op == ca.OP_INPUT:
            kind, name = loads[i[1]]
            slot[o[0]] = add(Node(kind, name=name))
        elif op == ca.OP_CONST:
            slot[o[0]] = add(Node("literal", value=f.instruction_constant(k)))
        else:
            slot[o[0]] = add(_operation(op, tuple(slot[a] for a in i), nodes))
    return nodes, results


def _operation(op: int, args: tuple[int, ...], nodes: list[Node]) -> Node:
    if op in UNARY:
        return Node(UNARY[op], args[:1])
    if op not in BINARY:
        known = ", ".join(sorted({*UNARY.values(), *BINARY.values()}))
        called = next((n for n, value in vars(ca).items() if n.startswith("OP_") and value == op), f"number {op}")
        raise EmitError(f"operation {called} of CasADi has no form in C here: write the expression with {known}")
    if op == ca.OP_ADD:
        first, second = nodes[args[0]], nodes[args[1]]
        if first.op == second.op == "when":
            if nodes[second.args[0]] == Node("not", (first.args[0],)):
                return Node("choose", (first.args[0], first.args[1], second.args[1]))
            if nodes[first.args[0]] == Node("not", (second.args[0],)):
                return Node("choose", (second.args[0], second.args[1], first.args[1]))
    return Node(BINARY[op], args)


def _prune(p: Program) -> Program:
    """Drop nodes that nothing needs any more, such as the halves of a choice."""
    live = set(p.outputs.values()) | set(p.next.values())
    for k in range(len(p.nodes) - 1, -1, -1):
        if k in live:
            live.update(p.nodes[k].args)
    index = {old: new for new, old in enumerate(sorted(live))}
    nodes = tuple(
        Node(n.op, tuple(index[a] for a in n.args), n.value, n.name) for k, n in enumerate(p.nodes) if k in live
    )
    marks = tuple((sum(1 for k in live if k < at), named, index[node]) for at, named, node in p.marks if node in live)
    outputs, next = ({name: index[k] for name, k in ends.items()} for ends in (p.outputs, p.next))
    return Program(nodes, marks, outputs, next, p.integers)
