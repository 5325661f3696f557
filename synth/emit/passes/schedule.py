"""Instruction scheduling: a lowered program becomes statements in a readable order with short live ranges.

Signals of the composition are computed in its order. Each next state is stored as soon as the signals that it needs
are computed. Choices on one condition become one `if`: a value that only one side needs is computed on that side only,
and a side that leaves a state unchanged does not store it.

No state is loaded after it is stored. On each level of statements the load precedes the store, unless the load is sunk
into an `if`. It is sunk only if the store, where the level has one, depends on a choice of this `if`.
"""

from collections.abc import Sequence

from synth.emit.passes.grouping import in_groups
from synth.emit.passes.owners import Owners
from synth.emit.passes.regions import Demand, Region, Regions, WrittenRegion
from synth.emit.passes.statements import Assign, Branch, Let, Statement, Store, reads
from synth.emit.program.lower import Node, Program

INLINE = ("literal", "constant", "argument", "parameter")


def statements(p: Program) -> tuple[Statement, ...]:
    """Return the statements that compute and store everything of a program."""
    demands = [Demand(k, ("state", name)) for name, k in p.next.items() if p.nodes[k] != Node("state", name=name)]
    demands += [Demand(k, ("out", name)) for name, k in p.outputs.items()]
    demands += [Demand(k, ("word", "")) for k in dict.fromkeys(p.result_nodes())]
    whole = {k for k, node in enumerate(p.nodes) if node.op not in INLINE}
    return tuple(_Level(p, p.users(), whole, demands, Owners(p)).statements())


class _Level:
    """One level of statements: the nodes that belong to it and its demands."""

    def __init__(
        self, p: Program, users: list[list[int]], members: set[int], demands: Sequence[Demand], owners: Owners
    ) -> None:
        self.p, self.users, self.members, self.owners = p, users, members, owners
        self.pending = dict.fromkeys(demands)
        self.loads = {p.nodes[k].name: k for k in members if p.nodes[k].op == "state"}
        self.regions = Regions(p, users, members, demands)
        self.regions.write(self._branch)
        self.first_of, self.written_of = self.regions.first_of, self.regions.written_of
        self.sunk = self.written_of.keys() - self.first_of.keys()
        self.done: set[int] = set()
        self.out: list[Statement] = []

    def statements(self) -> list[Statement]:
        """Return the statements: signals in order, each demand as soon as the signals that it needs are computed."""
        marked: dict[int, int] = {}
        for i, (_, k) in enumerate(self.p.marks):
            if k in self.members and k not in self.sunk:
                marked.setdefault(k, i)
        waiting = self._demands_by_last_signal(marked)
        for place, k in enumerate(marked):
            self._compute(k)
            for d in waiting.get(place, ()):
                self._meet(d)
        for d in list(self.pending):
            self._meet(d)
        return in_groups(self.p, self.out, self.owners) if self.p.titles else self.out

    def _demands_by_last_signal(self, marked: dict[int, int]) -> dict[int, list[Demand]]:
        """Group the demands by the last marked node, counted in order, for which each of them waits.

        A next state waits for the signals that it needs, for those of its own Block, and for the end of the section.
        """
        places = {k: place for place, k in enumerate(marked)}
        blocks = [self.p.marks[i][0].block for i in marked.values()]
        by_block = {block: place for place, block in enumerate(blocks)}
        last: dict[int, int] = {}
        waiting: dict[int, list[Demand]] = {}
        for d in self.pending:
            owner = self.p.owner(str(d.destination[1])) if d.destination[0] == "state" else ""
            place = max(by_block.get(owner, -1), self._last_signal(d.node, places, last))
            waiting.setdefault(_end_of_section(blocks, place) if owner else place, []).append(d)
        return waiting

    def _last_signal(self, k: int, places: dict[int, int], known: dict[int, int]) -> int:
        """Return the place of the last marked node among node k and its operands, -1 for none; `known` is a memo."""
        first = self.first_of.get
        stack = [first(k, k)]
        while stack:
            n = stack[-1]
            needs = [first(a, a) for a in self._dependencies(n) if a in self.members] if n in self.members else []
            missing = [a for a in needs if a not in known]
            stack += missing
            if not missing:
                known[stack.pop()] = max([places.get(n, -1), *(known[a] for a in needs)])
        return known[first(k, k)]

    def _dependencies(self, k: int) -> Sequence[int]:
        """Return the nodes to compute before node k; for a choice, all that its `if` needs from outside."""
        if k not in self.first_of:
            return self.p.nodes[k].args
        written = self.written_of[k]
        stored = [self.loads.get(str(d.destination[1])) for d in written.met if d.destination[0] == "state"]
        return [*written.reads, *(load for load in stored if load is not None and load not in self.sunk)]

    def _compute(self, k: int) -> None:
        stack = [k]
        while stack:
            n = stack[-1]
            missing = (
                [a for a in self._dependencies(n) if a in self.members and a not in self.done]
                if n in self.members
                else []
            )
            if n in self.done or n not in self.members:
                stack.pop()
            elif missing:
                stack.extend(reversed(missing))
            else:
                stack.pop()
                self._write(n)

    def _write(self, k: int) -> None:
        if k in self.first_of:
            written = self.written_of[k]
            self.done.update(written.choices)
            self.out.append(written.branch)
            for d in written.met:
                del self.pending[d]
        else:
            self.done.add(k)
            self.out.append(Let(k))

    def _meet(self, d: Demand) -> None:
        if d not in self.pending:
            return
        struct, name = d.destination
        if struct == "state" and (load := self.loads.get(str(name))) is not None and load not in self.sunk:
            self._compute(load)
        self._compute(d.node)
        if d in self.pending:  # a branch may have met it
            del self.pending[d]
            self.out.append(_store_statement(d))

    def _branch(self, region: Region) -> WrittenRegion:
        """Write one `if`; demands that only a choice supplies, or that a side leaves unchanged, are met inside it."""
        inner: tuple[list[Demand], list[Demand]] = ([], [])
        declared: list[tuple[int, int | None]] = []
        met: list[Demand] = []
        for c in region.choices:
            arms = self.p.nodes[c].args[1:]
            if self.regions.is_read(c) or c in self.p.result_nodes():
                start = next((a for a, side in zip(arms, region.sides, strict=True) if a not in side), None)
                declared.append((c, start))
                for arm, arm_demands in zip(arms, inner, strict=True):
                    if arm != start:
                        arm_demands.append(Demand(arm, ("choice", c)))
            for d in self.regions.demands.get(c, ()):
                held = any(self.regions.is_load(a, d.destination) for a in arms)
                if d.destination[0] == "word" or (self.regions.is_read(c) and not held):
                    continue
                met.append(d)
                for arm, arm_demands in zip(arms, inner, strict=True):
                    if not self.regions.is_load(arm, d.destination):
                        arm_demands.append(Demand(arm, d.destination))
        then, other = (
            tuple(_Level(self.p, self.users, members, demands, self.owners).statements())
            for members, demands in zip(region.sides, inner, strict=True)
        )
        branch = Branch(region.condition, tuple(declared), then, other)
        inside = region.sides[0].union(region.sides[1], region.choices)
        outside = dict.fromkeys(k for k in reads(self.p, [branch]) if k not in inside)
        return WrittenRegion(region.choices, branch, outside, met)


def _store_statement(d: Demand) -> Statement:
    struct, name = d.destination
    if struct == "choice":
        assert isinstance(name, int)
        return Assign(name, d.node)
    return Store(struct, str(name), d.node)


def _end_of_section(blocks: Sequence[str], place: int) -> int:
    """Return the last place of a run of signals of one Block."""
    while 0 <= place < len(blocks) - 1 and blocks[place + 1] == blocks[place]:
        place += 1
    return place
