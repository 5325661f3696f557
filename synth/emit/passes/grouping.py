"""Grouping: the statements of one level in an order that keeps those of a Block together as far as data flow allows.

List scheduling: from what can be computed next, a statement of the present Block comes first. Behind it comes the
smallest Block whose statements can be completed, so that few values live long, or, where there is none, that of the
earliest statement. A load stands before the first statement that reads it. What an outer level has computed is stored
at the beginning. The order is taken where it has fewer sections.
"""

from collections import defaultdict
from collections.abc import Iterator, Sequence
from heapq import heapify, heappop, heappush
from itertools import groupby

from synth.emit.passes.owners import Owners
from synth.emit.passes.statements import Branch, Let, Statement, Store, reads
from synth.emit.program.lower import Program

IN_FUNCTION = 4  # statements for which a call stands
_LOADS = ("input", "state")


def in_groups(p: Program, block: Sequence[Statement], owners: Owners) -> list[Statement]:
    """Return the statements of a level in an order that keeps those of a Block together."""
    grouping = _Grouping(p, block, owners)
    order = grouping.order()
    fewer = grouping.sections(order) < grouping.sections(range(len(block)))
    return [block[j] for j in order] if fewer else list(block)


class _Grouping:
    """What must precede each statement of a level, and those that are written so far.

    `left` has the number of statements left of each Block, those in branches included, and `changed` the Blocks of
    which another one has written an operand.
    """

    def __init__(self, p: Program, block: Sequence[Statement], owners: Owners) -> None:
        self.p, self.block = p, block
        self.made = {k: i for i, s in enumerate(block) for k in _made(s)}
        self.before = [self._operands(s) for s in block]
        for i, j in self._conflicts():
            self.before[j].add(i)
        self.loads = {i for i, s in enumerate(block) if isinstance(s, Let) and p.nodes[s.node].op in _LOADS}
        self.blocks = [owners.main(s) for s in block]
        self.sizes = [_count(p, s) for s in block]
        self.after: dict[int, list[int]] = defaultdict(list)
        self.missing = [0] * len(block)
        for j in range(len(block)):
            needed = self._before_all(j) if j not in self.loads else ()
            self.missing[j] = len(needed)
            for i in needed:
                self.after[i].append(j)
        self.of_block: dict[str, set[int]] = defaultdict(set)
        self.left: dict[str, int] = defaultdict(int)
        for j, owner in enumerate(self.blocks):
            if j not in self.loads:
                self.of_block[owner].add(j)
                self.left[owner] += self.sizes[j]
        self.ready: dict[str, list[int]] = defaultdict(list)
        self.earliest, self.done, self.changed = list[tuple[int, str]](), dict[int, None](), set[str]()

    def order(self) -> list[int]:
        """Return the places of the statements in their new order."""
        ready = [j for j in range(len(self.block)) if j not in self.loads and not self.missing[j]]
        ready += [k for j in ready if self._stores_outer(j) for k in self._write(j)]
        for j in sorted(set(ready) - self.done.keys()):
            self._make_ready(j)
        complete = [(self.left[name], min(js), name) for name, js in self.ready.items() if self._can_complete(name)]
        heapify(complete)
        while complete or self.earliest:
            name = heappop(complete)[-1] if complete else heappop(self.earliest)[-1]
            self.changed.clear()
            while self.ready[name]:
                for k in self._write(heappop(self.ready[name])):
                    self._make_ready(k)
            for other in sorted(self.changed - {name}):
                if self.ready[other] and self._can_complete(other):
                    heappush(complete, (self.left[other], self.ready[other][0], other))
        return [*self.done, *(j for j in range(len(self.block)) if j not in self.done)]

    def sections(self, order: Sequence[int]) -> int:
        """Return the number of runs of statements of one Block."""
        return len([*groupby(self.blocks[j] for j in order if j not in self.loads)])

    def _make_ready(self, j: int) -> None:
        heappush(self.ready[self.blocks[j]], j)
        heappush(self.earliest, (j, self.blocks[j]))

    def _can_complete(self, block: str) -> bool:
        """Tell whether all statements left of a Block can be computed without those of another one."""
        left = self.of_block[block] - self.done.keys()
        missing: dict[int, int] = {}
        stack, reached = [*self.ready[block]], set[int]()
        while stack:
            j = stack.pop()
            reached.add(j)
            for k in self.after[j]:
                missing[k] = missing.get(k, self.missing[k]) - 1
                if not missing[k] and self.blocks[k] == block:
                    stack.append(k)
        return left <= reached

    def _write(self, j: int) -> list[int]:
        """Write a statement behind the loads that it reads, and return those that nothing else holds back."""
        self.done |= dict.fromkeys([*sorted(self._loads_before(j) - self.done.keys()), j])
        self.left[self.blocks[j]] -= self.sizes[j]
        for k in self.after[j]:
            self.missing[k] -= 1
        self.changed.update(self.blocks[k] for k in self.after[j])
        return [k for k in self.after[j] if not self.missing[k]]

    def _operands(self, s: Statement) -> set[int]:
        return {self.made[k] for k in reads(self.p, [s]) if k in self.made}

    def _before_all(self, j: int) -> set[int]:
        """Return what is computed or stored before a statement and the loads that it reads."""
        direct = self.before[j]
        return {i for k in direct & self.loads for i in self.before[k]} | (direct - self.loads)

    def _loads_before(self, j: int) -> set[int]:
        return self.before[j] & self.loads

    def _stores_outer(self, j: int) -> bool:
        s = self.block[j]
        return isinstance(s, Store) and s.struct == "state" and not self.before[j]

    def _conflicts(self) -> Iterator[tuple[int, int]]:
        """Yield the pairs of statements that load and store one state, in their order."""
        last: dict[str, list[tuple[int, bool]]] = defaultdict(list)
        for j, s in enumerate(self.block):
            for state, stores in dict.fromkeys(_state_accesses(self.p, [s])):
                for i, stored in last[state]:
                    if i != j and (stores or stored):
                        yield i, j
                last[state].append((j, stores))


def _made(s: Statement) -> tuple[int, ...]:
    return (s.node,) if isinstance(s, Let) else tuple(c for c, _ in s.choices) if isinstance(s, Branch) else ()


def _count(p: Program, s: Statement) -> int:
    """Return the number of statements in a statement; a call stands for those of its function."""
    if isinstance(s, Branch):
        return 1 + sum(_count(p, t) for t in (*s.then, *s.other))
    return IN_FUNCTION if isinstance(s, Let) and p.nodes[s.node].op == "call" else 1


def _state_accesses(p: Program, block: Sequence[Statement]) -> Iterator[tuple[str, bool]]:
    """Yield the states that statements load or store, and whether they store."""
    for s in block:
        if isinstance(s, Branch):
            yield from _state_accesses(p, (*s.then, *s.other))
        elif isinstance(s, Store) and s.struct == "state":
            yield s.name, True
        elif isinstance(s, Let):
            node = p.nodes[s.node]
            if node.op == "state":
                yield node.name, False
            elif node.op == "guard" and node.name:
                yield node.name, True
            elif node.op == "call":
                call = p.calls[node.name]
                for state in (call.block, *call.states.values()):
                    yield state, True
