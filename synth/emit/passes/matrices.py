"""Matrices of constants: dot products of constant rows with the same values become one product with a matrix.

    dot(k_1 .. k_n, x_1 .. x_n),  rows of one Block that have the values x in common
    y = product(x_1 .. x_n)       the node that stands for M x, whose matrix has the name of the node
    y_i = row(y)                  M_i1 x_1 + M_i2 x_2 + ..., rounded from left to right

Outputs and next states have a matrix each: what is computed from outputs may come back as one of the values.
A dot product with other coefficients becomes products and sums in the same order.
"""

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import reduce
from itertools import chain, count
from typing import NamedTuple

from synth.emit.program.lower import Matrix, Node, Program

OUTPUT, STATE = "output", "state"


class _End(NamedTuple):
    """The first signal or next state that a node is computed for: its Block, OUTPUT or STATE, and its name."""

    block: str
    kind: str
    name: str


_Key = tuple[str, str, tuple[int, ...]]  # of a product: Block, OUTPUT or STATE, and the nodes that it multiplies


def with_matrices(p: Program, block: str, constants: Mapping[str, float]) -> Program:
    """Return the program of a `block` without dot products; `constants` are the values by name."""
    if not any(node.op == "dot" for node in p.nodes):
        return p
    ends, rows = _ends(p, block), defaultdict[_Key, list[int]](list)
    for k, node in enumerate(p.nodes):
        n = len(node.args) // 2
        if node.op == "dot" and all(p.nodes[a].op in ("constant", "literal") for a in node.args[:n]):
            rows[ends[k].block, ends[k].kind, node.args[n:]].append(k)
    places = {k: (key, i) for key, of_key in rows.items() for i, k in enumerate(of_key)}
    nodes, index = list[Node](), list[int]()
    taken = {node.name for node in p.nodes}
    products, matrices = dict[_Key, int](), dict[str, Matrix]()

    def put(op: str, args: Sequence[int], value: float = 0.0, name: str = "") -> int:
        nodes.append(Node(op, tuple(args), value, name))
        return len(nodes) - 1

    for k, node in enumerate(p.nodes):
        args, n = node.renumbered(index).args, len(node.args) // 2
        if k in places:
            key, i = places[k]
            if key not in products:
                name = f"{key[1]}_matrix" if key[0] == block else f"{key[0]}_{key[1]}_matrix"
                name = next(n for n in chain([name], (f"{name}_{i}" for i in count(2))) if n not in taken)
                taken.add(name)
                products[key] = put("product", args[n:], name=name)
                matrices[name] = _matrix(p, rows[key], ends, constants)
            index.append(put("row", [products[key]], float(i)))
        elif node.op == "dot":
            terms = [put("mul", pair) for pair in zip(args[:n], args[n:], strict=True)]
            index.append(reduce(lambda total, term: put("add", (total, term)), terms))
        else:
            index.append(put(node.op, args, node.value, node.name))
    return replace(p.with_nodes(tuple(nodes), index), matrices=matrices)


def _matrix(p: Program, rows: Sequence[int], ends: Sequence[_End], constants: Mapping[str, float]) -> Matrix:
    """Return the matrix whose rows are dot products with the same values."""
    n = len(p.nodes[rows[0]].args) // 2
    coefficients = tuple(tuple(p.nodes[a] for a in p.nodes[k].args[:n]) for k in rows)
    values = tuple(tuple(constants.get(c.name, c.value) for c in row) for row in coefficients)
    signals = {k: named.signal.name for named, k in reversed(p.marks)}
    columns = (signals.get(a, p.nodes[a].name or ends[a].name) for a in p.nodes[rows[0]].args[n:])
    return Matrix(coefficients, values, tuple(ends[k].name for k in rows), tuple(columns))


def _ends(p: Program, block: str) -> list[_End]:
    at = {k: _End(p.owner(state) or block, STATE, state) for state, k in p.next.items()}
    at |= {k: _End(named.block, OUTPUT, named.signal.name) for named, k in reversed(p.marks)}
    ends, nearest = [_End(block, OUTPUT, "")] * len(p.nodes), [len(p.nodes)] * len(p.nodes)
    for k in range(len(p.nodes) - 1, -1, -1):
        if k in at:
            nearest[k], ends[k] = k, at[k]
        for a in p.nodes[k].args:
            if nearest[k] < nearest[a]:
                nearest[a], ends[a] = nearest[k], ends[k]
    return ends
