"""What the search for fragments knows of a program: kinds, users, branches, and the nodes before and after each."""

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from synth.emit.c.kinds import kinds
from synth.emit.lower import Node, Program
from synth.emit.passes import schedule
from synth.emit.passes.outline import LEAVES, NOT_OUTLINED
from synth.emit.passes.statements import Branch, Let, Statement

EXCLUDED = (*NOT_OUTLINED, "bit", "call", "result")

Context = tuple[tuple[int, int], ...]  # branches around a node, each (condition, side)


@dataclass(frozen=True)
class Graph:
    """What the search knows of a program: kinds, users, branches, and the nodes before and after each as bit sets."""

    p: Program
    kind: Sequence[str]
    users: Sequence[Sequence[int]]
    readers: Sequence[frozenset[int]]
    before: Sequence[int]
    after: Sequence[int]
    context: dict[int, Context]
    choices: dict[int, frozenset[int]]  # by choice those of its branch
    fixed: frozenset[int]  # nodes that are a fragment's result where they are in one
    free: frozenset[int]

    @classmethod
    def of(cls, p: Program, taken: frozenset[int]) -> "Graph":
        """Return it for a program whose nodes `taken` are in no fragment."""
        kind, users = kinds(p), p.users()
        before, after = [0] * len(p.nodes), [0] * len(p.nodes)
        for k, node in enumerate(p.nodes):
            for a in node.args:
                before[k] |= before[a] | 1 << a
        for k in range(len(p.nodes) - 1, -1, -1):
            for u in users[k]:
                after[k] |= after[u] | 1 << u
        context = _contexts(schedule.statements(p), ())
        _place_choices(p, users, context)
        choices = _choices(p, context)
        held = {k for name, k in p.next.items() if Node("state", name=name) in [p.nodes[a] for a in p.nodes[k].args]}
        free = {k for k, n in enumerate(p.nodes) if n.op not in (*LEAVES, *EXCLUDED) and k in context}
        fixed = frozenset({*p.ends(), *(k for mark, k in p.marks if not mark.is_internal)})
        limited = {k for _, k in p.marks if p.nodes[k].op == "clamp"}  # whose saturation the diagnostics tell
        return cls(
            p,
            kind,
            users,
            [frozenset(u) for u in users],
            before,
            after,
            context,
            choices,
            fixed,
            frozenset(free - taken - held - limited),
        )

    def signature(self, k: int) -> tuple[object, ...]:
        """Return what equal nodes have in common beside their operands."""
        node = self.p.nodes[k]
        numbers = [self.p.nodes[a].value for a in node.args if self.p.nodes[a].op == "literal"]
        values = tuple(numbers) if node.op == "clamp" or self.kind[k] != "real" else ()
        return node.op, node.name, node.value, self.kind[k], values, tuple(self.leaf(a) for a in node.args)

    def leaf(self, k: int) -> object:
        """Return what an operand is seen as from outside: a number, or a value of some kind."""
        node = self.p.nodes[k]
        return node.op if node.op in ("literal", "constant") else self.kind[k]

    def is_convex(self, region: int, nodes: Sequence[int]) -> bool:
        """Tell whether no node outside a region, given as a bit set too, lies between two nodes inside."""
        before = after = 0
        for k in nodes:
            before, after = before | self.before[k], after | self.after[k]
        return before & after & ~region == 0


def _contexts(block: Sequence[Statement], around: Context) -> dict[int, Context]:
    """Return the branches around each node of a block of statements."""
    context: dict[int, Context] = {}
    for s in block:
        if isinstance(s, Let):
            context[s.node] = around
        elif isinstance(s, Branch):
            context |= {c: around for c, _ in s.choices}
            context |= _contexts(s.then, (*around, (s.condition, 0)))
            context |= _contexts(s.other, (*around, (s.condition, 1)))
    return context


def _place_choices(p: Program, users: Sequence[Sequence[int]], context: dict[int, Context]) -> None:
    """Add the choices that are arms of another one, whose variable they share."""
    for k in range(len(p.nodes) - 1, -1, -1):
        outer = users[k][0] if len(set(users[k])) == 1 else -1
        if k not in context and outer in context and p.nodes[k].op == p.nodes[outer].op == "choose":
            condition, *arms = p.nodes[outer].args
            context[k] = (*context[outer], (condition, arms.index(k))) if k in arms else context[outer]


def _choices(p: Program, context: Mapping[int, Context]) -> dict[int, frozenset[int]]:
    """Return by choice those on the same condition in the same place."""
    groups: dict[tuple[int, Context], set[int]] = defaultdict(set)
    for k in context:
        if p.nodes[k].op == "choose":
            groups[p.nodes[k].args[0], context[k]].add(k)
    return {k: frozenset(group) for group in groups.values() for k in group}
