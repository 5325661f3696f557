"""Local variables of a step: which values need one, their names, and which choices share one (variable coalescing).

A value that is read once is printed inside the expression that reads it; the others are locals. A signal of the
composition keeps its name, and a value that only becomes the next value of a state is named after the state. A choice
that starts from the value of another choice and replaces it uses the same variable.
"""

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from synth.block import Block
from synth.emit.c.expressions import INLINE, RESERVED, constant
from synth.emit.lower import Node, Program
from synth.emit.passes.statements import Assign, Branch, Let, Statement, Store

LOADS = ("input", "state")
WORD = "faults"


class Names:
    """Unique C identifiers: `taken` are those already in use."""

    def __init__(self, taken: set[str]) -> None:
        self.taken, self.count = taken, 0

    def free(self, stem: str) -> str:
        """Return an unused name that begins with `stem`, and reserve it."""
        name, n = stem, 2
        while name in self.taken:
            name, n = f"{stem}_{n}", n + 1
        self.taken.add(name)
        return name

    def next(self) -> str:
        """Return the next name t1, t2, ... of an unnamed value, and reserve it."""
        self.count += 1
        return self.free(f"t{self.count}")


@dataclass(frozen=True, eq=False)
class Locals:
    """By node: number of reads in the text, name, the choice whose variable it shares, its initial value.

    `direct_loads` are the loads that are assigned before any store: the expression may read the member itself.
    """

    reads: Counter[int]
    name: dict[int, str]
    shared: dict[int, int]
    starts: dict[int, int | None]
    direct_loads: set[int]
    identifiers: Names


def assign(block: Block, program: Program, statements: Sequence[Statement], kinds: Sequence[str]) -> Locals:
    """Return the locals of scheduled statements."""
    reads: Counter[int] = Counter()
    _count(program, statements, reads)
    starts = {c: start for b in _branches(statements) for c, start in b.choices}
    shared = _shared_variables(program, statements, kinds, starts)
    taken = {*RESERVED, *(constant(c.name) for c in block.constants)}
    taken |= {n.name for n in program.nodes if n.op == "polynomial"}
    taken |= {constant(n.name) for n in program.nodes if n.op == "table"}
    names = Names(taken)
    return Locals(
        reads, _name_nodes(program, names, shared), shared, starts, set(_direct_loads(program, statements)), names
    )


def _name_nodes(p: Program, names: Names, shared: dict[int, int]) -> dict[int, str]:
    """Return the names of the nodes that are signals, the fault word or next states."""
    named: dict[int, str] = {}
    roots = [(mark.signal.name, node) for mark, node in p.marks]
    roots += [] if p.word is None else [(WORD, p.word)]
    roots += [(f"{name}_next", _carrier(p, name, node)) for name, node in p.next.items()]
    for name, node in roots:
        if node not in named and p.nodes[node].op not in (*LOADS, *INLINE):
            named[node] = WORD if node == p.word else names.free(name)
    for node, root in shared.items():
        if node in named and root not in named:
            named[root] = named[node]
    return named


def _carrier(p: Program, state: str, k: int) -> int:
    """Return the new value of a state inside choices that otherwise leave it unchanged."""
    while p.nodes[k].op == "choose":
        changed = [a for a in p.nodes[k].args[1:] if p.nodes[a] != Node("state", name=state)]
        if len(changed) != 1:
            break
        k = changed[0]
    return k


def _shared_variables(
    p: Program, statements: Sequence[Statement], kinds: Sequence[str], starts: dict[int, int | None]
) -> dict[int, int]:
    """Map each choice to the choice whose variable it can overwrite.

    That is the choice whose value it starts from, if every other reader of this value only leads to the new choice.
    """
    shared: dict[int, int] = {}
    users, ends = p.users(), set(p.ends())
    for branch in _branches(statements):
        inside = set(_definitions((*branch.then, *branch.other)))
        for c, start in branch.choices:
            if start in starts and kinds[start] == kinds[c] and _leads_only_to(users, ends, start, c, inside):
                shared[c] = shared.get(start, start)
    return shared


def _leads_only_to(users: Sequence[Sequence[int]], ends: set[int], start: int, choice: int, inside: set[int]) -> bool:
    """Tell whether every use of node `start` leads to `choice`, through nodes inside its branch."""
    seen, stack = {choice}, [start]
    while stack:
        k = stack.pop()
        if k in ends:
            return False
        further = set(users[k]) - seen
        if not further <= inside:
            return False
        seen |= further
        stack += further
    return True


def _branches(block: Sequence[Statement]) -> Iterator[Branch]:
    for s in block:
        if isinstance(s, Branch):
            yield s
            yield from _branches(s.then)
            yield from _branches(s.other)


def _direct_loads(p: Program, block: Sequence[Statement]) -> Iterator[int]:
    """Yield the loads that are assigned before any store, for which the expression may read the member itself."""
    loaded: set[int] = set()
    for s in block:
        if isinstance(s, Let) and p.nodes[s.node].op in LOADS:
            loaded.add(s.node)
        elif isinstance(s, Assign) and s.node in loaded:
            yield s.node
        elif isinstance(s, Branch):
            yield from _direct_loads(p, s.then)
            yield from _direct_loads(p, s.other)
        if isinstance(s, Store | Branch):
            loaded.clear()


def _definitions(block: Sequence[Statement]) -> Iterator[int]:
    for s in block:
        if isinstance(s, Let):
            yield s.node
        elif isinstance(s, Branch):
            yield from (c for c, _ in s.choices)
            yield from _definitions((*s.then, *s.other))


def _count(p: Program, block: Sequence[Statement], reads: Counter[int]) -> None:
    """Count how often the text reads each node, backwards, because a node without readers is not printed."""
    for s in reversed(block):
        if isinstance(s, Let) and reads[s.node]:
            node = p.nodes[s.node]
            reads.update(_printed_operands(node))
        elif isinstance(s, Assign | Store):
            reads[s.node] += 1
        elif isinstance(s, Branch):
            _count(p, s.other, reads)
            _count(p, s.then, reads)
            reads.update([s.condition, *(start for _, start in s.choices if start is not None)])


def _printed_operands(node: Node) -> Sequence[int]:
    if node.op == "within":
        return node.args[:1]
    return node.args[::2] if node.op == "clamp" else node.args * (2 if node.op == "sq" else 1)
