"""Properties of a program that the proofs need: what depends on what, what is whole, what may stay unrounded."""

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import reduce

import numpy as np

from synth.emit.program.lower import Node, Program
from synth.emit.program.operations import LOGICAL
from synth.emit.proof import conditions

SELECTIONS = frozenset({"choose", "when"})
LOADS = frozenset({"input", "state", "constant"})
_PRODUCTS = frozenset({"mul", "sq", "twice", "polynomial"})
# Operations that pass an unrounded product on to a sum.
_PASSING = frozenset({"neg", "choose", "when", "min", "max", "clamp", "within"})
_KEEPING_WHOLE = frozenset({"neg", "fabs", "add", "sub", "mul", "sq", "twice", "min", "max", "clamp"})
_SMALL = 40  # largest number of nodes of an arm that are recomputed under its condition


@dataclass(frozen=True, eq=False)
class Structure:
    """A program with properties of its graph.

    Bit j of `ancestors[k]`, and bit k of `descendants[j]`, means that node k is node j or depends on it. `products` may
    enter a sum unrounded. `whole` are the nodes with whole values only. `recomputed` maps (selection, position of an
    arm) to the nodes that are recomputed under the condition, none where they are many; the last is the arm itself.
    """

    program: Program
    ancestors: tuple[int, ...]
    descendants: tuple[int, ...]
    products: frozenset[int]
    whole: frozenset[int]
    recomputed: Mapping[tuple[int, int], tuple[int, ...]]


def structure(program: Program) -> Structure:
    """Return the properties of a program's graph that the analysis needs."""
    nodes = program.nodes
    ancestors: list[int] = []
    products: set[int] = set()
    whole: set[int] = set()
    for k, node in enumerate(nodes):
        ancestors.append(reduce(int.__or__, (ancestors[a] for a in node.args), 1 << k))
        if _may_stay_unrounded(nodes, node) or (node.op in _PASSING and not products.isdisjoint(node.args)):
            products.add(k)
        if _is_whole(program, node, whole):
            whole.add(k)
    descendants = [1 << k for k in range(len(nodes))]
    for k in range(len(nodes) - 1, -1, -1):
        for a in nodes[k].args:
            descendants[a] |= descendants[k]
    s = Structure(program, tuple(ancestors), tuple(descendants), frozenset(products), frozenset(whole), {})
    recomputed: dict[tuple[int, int], tuple[int, ...]] = {}
    for k, node in enumerate(nodes):
        if node.op in SELECTIONS:
            narrowed = conditions.narrowable_nodes(nodes, node.args[0])
            for position, arm in enumerate(node.args[1:], 1):
                between = _between(s, narrowed, (arm,))
                recomputed[k, position] = _places(between) if between.bit_count() <= _SMALL else ()
    return replace(s, recomputed=recomputed)


def _may_stay_unrounded(nodes: Sequence[Node], node: Node) -> bool:
    """Return whether a compiler may leave a value unrounded inside a sum; a division may become a multiplication."""
    return node.op in _PRODUCTS or (node.op == "div" and nodes[node.args[1]].op in ("literal", "constant"))


def _is_whole(program: Program, node: Node, whole: set[int]) -> bool:
    """Return whether a value is whole, as are floating-point sums and products of whole numbers, and floors."""
    if node.op == "literal":
        return float(node.value).is_integer()
    if node.op in SELECTIONS:
        return whole.issuperset(node.args[1:])
    preserved = node.op in LOGICAL or node.op == "floor" or (node.op in _KEEPING_WHOLE and whole.issuperset(node.args))
    return preserved or (node.op == "state" and node.name in program.integers)


def nodes_between(s: Structure, sources: Collection[int], ends: Iterable[int]) -> tuple[int, ...]:
    """Return the nodes on the paths from `sources`, which are excluded, to `ends`, in order."""
    return _places(_between(s, sources, ends))


def _between(s: Structure, sources: Collection[int], ends: Iterable[int]) -> int:
    """Return the nodes between `sources` and `ends` as bits."""
    reached = reduce(int.__or__, (s.ancestors[k] for k in ends), 0)
    depending = reduce(int.__or__, (s.descendants[k] for k in sources), 0)
    return reached & depending & ~reduce(int.__or__, (1 << k for k in sources), 0)


def _places(bits: int) -> tuple[int, ...]:
    """Return the places of the bits that are set, in order."""
    octets = np.frombuffer(bits.to_bytes(bits.bit_length() // 8 + 1, "little"), np.uint8)
    return tuple(np.flatnonzero(np.unpackbits(octets, bitorder="little")).tolist())
