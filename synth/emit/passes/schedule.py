"""Instruction scheduling: a lowered program becomes statements in a readable order with short live ranges.

Signals of the composition are computed in its order. Each next state is stored as soon as the signals that it needs
are computed. Choices on one condition become one `if`: a value that only one side needs is computed on that side only,
and a side that leaves a state unchanged does not store it.

No state is loaded after it is stored. On each level of statements the load precedes the store, unless the load is sunk
into an `if`. It is sunk only if the store, where the level has one, depends on a choice of this `if`.

If-conversion regions: the choices on one condition that become one `if`, and code sinking into its sides.

A node is *sunk* into a side of a condition if every use of it is on that side. Nodes are visited backwards, so a node's
users are decided before the node itself. A choice that only leaves a state unchanged does not use the state's load.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from heapq import heapify, heappop, heappush

from synth.emit.program.lower import Node, Program


@dataclass(frozen=True)
class Let:
    """Compute a node."""

    node: int


@dataclass(frozen=True)
class Store:
    """Store a node's value into a member of `state` or `out`."""

    struct: str
    name: str
    node: int


@dataclass(frozen=True)
class Assign:
    """Give a choice's variable the value of a node."""

    choice: int
    node: int


@dataclass(frozen=True)
class Branch:
    """An `if` for choices on one condition; `choices` holds each choice and the node of its initial value, or None."""

    condition: int
    choices: tuple[tuple[int, int | None], ...]
    then: tuple["Statement", ...]
    other: tuple["Statement", ...]


Statement = Let | Store | Assign | Branch


def reads(p: Program, block: Sequence[Statement]) -> Iterator[int]:
    """Yield the nodes that statements read."""
    for s in block:
        if isinstance(s, Let):
            yield from p.nodes[s.node].args
        elif isinstance(s, Assign | Store):
            yield s.node
        elif isinstance(s, Branch):
            yield s.condition
            yield from (start for _, start in s.choices if start is not None)
            yield from reads(p, (*s.then, *s.other))


_COMPOSED = frozenset(("add", "sub", "mul", "div", "sq", "inv", "lt", "le", "eq", "ne", "and", "or", "bit"))


@dataclass(frozen=True)
class Demand:
    """A node and a destination of its value: (struct, member), or ("choice", node)."""

    node: int
    destination: tuple[str, str | int]


@dataclass(frozen=True)
class Region:
    """The choices on one condition at one level, and the nodes sunk into each side."""

    condition: int
    choices: list[int]
    sides: tuple[set[int], set[int]]


@dataclass(frozen=True)
class WrittenRegion:
    """A region as a statement: its choices, the outside nodes that it reads, and the demands that it meets."""

    choices: list[int]
    branch: Branch
    reads: dict[int, None]
    met: list[Demand]


class Regions:
    """The regions of one level of statements, with the nodes that belong to it and its demands."""

    def __init__(
        self, p: Program, users: Sequence[Sequence[int]], members: set[int], demands: Sequence[Demand]
    ) -> None:
        self.p, self.users, self.members = p, users, members
        self.demands: dict[int, list[Demand]] = {}
        for d in demands:
            self.demands.setdefault(d.node, []).append(d)
        self.first_of: dict[int, int] = {}  # by choice, the first of its region
        self.written_of: dict[int, WrittenRegion] = {}  # by choice or sunk node

    def is_read(self, choice: int) -> bool:
        """Tell whether a node of this level reads the choice; reads by other levels are demands here."""
        return any(u in self.members for u in self.users[choice])

    def is_load(self, k: int, destination: tuple[str, str | int]) -> bool:
        """Tell whether `destination` is the state that node k loads."""
        node = self.p.nodes[k]
        return destination == (node.op, node.name) and node.op == "state"

    def write(self, write: Callable[[Region], WrittenRegion]) -> None:
        """Find and write the regions, later choices first; choices inside a region form no region of this level."""
        by_condition: dict[int, list[int]] = {}
        for k in sorted(self.members):
            if self.p.nodes[k].op == "choose":
                by_condition.setdefault(self.p.nodes[k].args[0], []).append(k)
        layers = [(condition, layer) for condition, group in by_condition.items() for layer in self._layers(group)]
        for condition, layer in sorted(layers, key=lambda item: -item[1][-1]):
            choices = [c for c in layer if c not in self.written_of]
            region = Region(condition, choices, self._whole_sides(choices, by_condition))
            if self._is_circular(region):
                acyclic: list[int] = []
                for c in choices:
                    region = Region(condition, [*acyclic, c], self._whole_sides([*acyclic, c], by_condition))
                    acyclic += [] if self._is_circular(region) else [c]
                region = Region(condition, acyclic, self._whole_sides(acyclic, by_condition))
            if region.choices and self._is_worthwhile(region):
                written = write(region)
                self.first_of |= dict.fromkeys(region.choices, region.choices[0])
                self.written_of |= dict.fromkeys([*region.choices, *region.sides[0], *region.sides[1]], written)

    def _is_circular(self, region: Region) -> bool:
        """Tell whether one choice of a region depends on another through other regions, each written as a whole."""
        first = min(region.choices, default=0)
        others = {(self.written_of[c].choices[-1], c) for c in self.first_of.values()}
        for last, low in sorted(others, reverse=True):
            first = min(first, low) if last > first else first
        inside = region.sides[0] | region.sides[1]
        stack = [region.condition, *(a for n in (*region.choices, *inside) for a in self.p.nodes[n].args)]
        seen = set(inside)
        while stack:
            k = stack.pop()
            if k in region.choices:
                return True
            if first <= k and k not in seen and k in self.members:
                seen.add(k)
                stack += self.written_of[k].reads if k in self.first_of else self.p.nodes[k].args
        return False

    def _whole_sides(self, choices: list[int], by_condition: dict[int, list[int]]) -> tuple[set[int], set[int]]:
        """Sink nodes into both sides, but the choices on another condition only all together."""
        excluded = set(self.written_of)
        while True:
            sides = self._sides(choices, excluded)
            split: set[int] = set()
            for side in sides:
                for k in side:
                    if self.p.nodes[k].op == "choose":
                        group = [c for c in by_condition[self.p.nodes[k].args[0]] if c not in self.written_of]
                        split.update(group if not side.issuperset(group) else ())
            if not split - excluded:
                return sides
            excluded |= split

    def _layers(self, choices: list[int]) -> Iterator[list[int]]:
        """Yield the choices that do not depend on one another, then those that depend on these only, and so on."""
        while choices:
            layer = self._independent(choices)
            yield layer
            choices = [c for c in choices if c not in layer]

    def _independent(self, choices: list[int]) -> list[int]:
        """Return the choices that do not depend on one of the earlier ones."""
        independent: list[int] = []
        reached: set[int] = set()
        for c in choices:
            if c in reached:
                continue
            independent.append(c)
            stack = [c]
            while stack:
                for u in self.users[stack.pop()]:
                    if u not in reached:
                        reached.add(u)
                        stack.append(u)
        return independent

    def _sides(self, choices: list[int], excluded: set[int]) -> tuple[set[int], set[int]]:
        sides: tuple[set[int], set[int]] = (set(), set())
        chosen = set(choices)
        early = self._states_stored_first(choices)
        heap = [-a for c in choices for a in self.p.nodes[c].args[1:]]
        heapify(heap)
        seen: set[int] = set()
        while heap:
            k = -heappop(heap)
            node = self.p.nodes[k]
            if k in seen or k not in self.members or k in excluded or k in chosen or k in self.demands:
                continue
            seen.add(k)
            if node.op == "state" and node.name in early:
                continue
            for side, sunk in enumerate(sides):
                users = [u for u in self.users[k] if u in self.members and not self._skips_operand(u, k, chosen)]
                if all(u in sunk or (u in chosen and self._reads_on_side_only(u, k, side)) for u in users):
                    sunk.add(k)
                    for a in node.args:
                        heappush(heap, -a)
        return sides

    def _states_stored_first(self, choices: list[int]) -> set[str | int]:
        """Return the states whose store at this level depends on none of the choices and may precede them."""
        reached, stack = set(choices), list(choices)
        while stack:
            for u in self.users[stack.pop()]:
                if u in self.members and u not in reached:
                    reached.add(u)
                    stack.append(u)
        stores = (d for group in self.demands.values() for d in group if d.destination[0] == "state")
        return {d.destination[1] for d in stores if d.node not in reached}

    def _skips_operand(self, user: int, k: int, chosen: set[int]) -> bool:
        """Tell whether a user of node k is written without reading it, because it only keeps the state that k loads."""
        if user in self.written_of:
            return k not in self.written_of[user].reads
        return user in chosen and self._only_keeps(user, k)

    def _only_keeps(self, choice: int, k: int) -> bool:
        """Tell whether a choice reads node k only to keep the state that k loads."""
        places = [d.destination for d in self.demands.get(choice, ())]
        read = self.p.nodes[choice].args
        alone = read.count(k) == 1 and read[0] != k
        return not self.is_read(choice) and alone and all(self.is_load(k, q) for q in places)

    def _reads_on_side_only(self, choice: int, k: int, side: int) -> bool:
        """Tell whether a choice reads node k on this side only."""
        args = self.p.nodes[choice].args
        return args[1 + side] == k and args[0] != k and args[2 - side] != k

    def _is_worthwhile(self, region: Region) -> bool:
        """Tell whether an `if` pays: for more than two choices or sunk nodes, or to avoid storing an unchanged state.

        Fewer choices stay conditional expressions, unless a first arm is a compound expression: cppcheck removes the
        parentheses of that arm and then reports them as missing.
        """
        arms = {self.p.nodes[c].args[1] for c in region.choices} & region.sides[0]
        bare = any(self.p.nodes[a].op in _COMPOSED for a in arms)
        held = any(
            self.is_load(a, d.destination)
            for c in region.choices
            for a in self.p.nodes[c].args[1:]
            for d in self.demands.get(c, [])
        )
        return held or bare or len(region.choices) > 2 or len(region.sides[0]) + len(region.sides[1]) > 2


INLINE = ("literal", "constant", "argument", "parameter")


def statements(p: Program) -> tuple[Statement, ...]:
    """Return the statements that compute and store everything of a program."""
    demands = [Demand(k, ("state", name)) for name, k in p.next.items() if p.nodes[k] != Node("state", name=name)]
    demands += [Demand(k, ("out", name)) for name, k in p.outputs.items()]
    demands += [Demand(k, ("word", "")) for k in dict.fromkeys(p.result_nodes())]
    whole = {k for k, node in enumerate(p.nodes) if node.op not in INLINE}
    return tuple(_Level(p, p.users(), whole, demands).statements())


class _Level:
    """One level of statements: the nodes that belong to it and its demands."""

    def __init__(self, p: Program, users: list[list[int]], members: set[int], demands: Sequence[Demand]) -> None:
        self.p, self.users, self.members = p, users, members
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
        return self.out

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
            tuple(_Level(self.p, self.users, members, demands).statements())
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
