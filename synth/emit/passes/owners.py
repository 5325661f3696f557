"""Owners: the Block of a composition for which a node or a statement computes something."""

from collections import Counter
from collections.abc import Iterator, Sequence

from synth.blocks.guard import safety
from synth.emit.passes.statements import Assign, Branch, Let, Statement, Store
from synth.emit.program.lower import Program

_SILENT = ("call", "result", "bit")  # a function says what it does, and a bit of the word is set where it is known


def by_node(p: Program) -> list[str]:
    """Return for each node the Block of the first signal or next state that it is computed for, "" for none."""
    ends = {k: p.owner(state) for state, k in p.next.items()} | {k: named.block for named, k in reversed(p.marks)}
    owner, nearest = [""] * len(p.nodes), [len(p.nodes)] * len(p.nodes)
    for k in range(len(p.nodes) - 1, -1, -1):
        if k in ends:
            nearest[k], owner[k] = k, ends[k]
        for a in p.nodes[k].args:
            if nearest[k] < nearest[a]:
                nearest[a], owner[a] = nearest[k], owner[k]
    return owner


class Owners:
    """The owner of each statement of a program; what only the fault word needs belongs to the guard.

    A node that several Blocks read belongs to the one whose section it is in.
    """

    def __init__(self, p: Program) -> None:
        self.p, self.nearest, self.all = p, by_node(p), _all_by_node(p)
        self.outputs = {named.signal.name: named.block for named, _ in p.marks}
        self.guard = safety.GUARD if safety.GUARD in p.titles else ""

    def of(self, s: Statement, current: str) -> str:
        """Return the owner of a statement in the section of the `current` owner, "" where it opens no other one."""
        if isinstance(s, Branch):
            parts = Counter(part for part in self._parts(s) if part)
            return current if current in parts or not parts else parts.most_common(1)[0][0]
        if isinstance(s, Store):
            silent = self.p.nodes[s.node].op != "literal" and current in self.all[s.node]
            owner = self.p.owner(s.name) if s.struct == "state" else self.outputs.get(s.name, "")
            return "" if silent else owner
        if isinstance(s, Let):
            silent = self.p.nodes[s.node].op in _SILENT or current in self.all[s.node]
            return "" if silent else self.nearest[s.node] or self.guard
        return ""

    def main(self, s: Statement) -> str:
        """Return the owner of a statement wherever it stands, "" for none."""
        if isinstance(s, Let | Assign):
            node = self.p.nodes[s.node]
            if node.op in ("call", "result"):
                return str(self.p.calls[node.name.split(".")[0]].block)
            return self.nearest[s.node] or self.guard
        return s.name if isinstance(s, Store) and s.name in self.p.titles else self.of(s, "")

    def together(self, branch: Branch) -> tuple[str, ...]:
        """Return the owners of a branch of which each has about two statements on a side, () for another branch."""
        owners = dict.fromkeys(part for part in self._parts(branch) if part)
        few = len(owners) > 1 and max(map(_count, (branch.then, branch.other))) <= 2 * len(owners)
        return tuple(owners) if few else ()

    def _parts(self, branch: Branch) -> Iterator[str]:
        yield from (self.nearest[c] or self.guard for c, _ in branch.choices)
        for s in (*branch.then, *branch.other):
            yield from self._parts(s) if isinstance(s, Branch) else (self.of(s, ""),)


def _count(side: Sequence[Statement]) -> int:
    return sum(_count((*s.then, *s.other)) if isinstance(s, Branch) else 1 for s in side)


def _all_by_node(p: Program) -> list[set[str]]:
    """Return for each node the Blocks of the signals and next states that it is computed for."""
    owners: list[set[str]] = [set() for _ in p.nodes]
    for named, k in p.marks:
        owners[k].add(named.block)
    for state, k in p.next.items():
        owners[k].add(p.owner(state))
    ends = {k for k, blocks in enumerate(owners) if blocks}
    for k in range(len(p.nodes) - 1, -1, -1):
        for a in p.nodes[k].args:
            if a not in ends:
                owners[a] |= owners[k]
    return owners
