"""Scheduling: a lowered program becomes statements, in the order in which a person would write them.

Signals of the composition come in its order; each next state is stored as soon as the signals that it needs stand, so
that little is kept alive. Choices on one condition become one `if`: what only one side needs is computed on that side
only, and a state that a side leaves as it is is not stored there.

A node is *sunk* into a side of a condition when every use of it is on that side: uses are followed from the end, so a
node's users are decided before the node itself. A choice that only leaves a state as it is does not use its load.

No state is loaded after it is stored: at a level of statements its load comes before its store, unless the load is sunk
into an `if`; that it is only where the store, if the level has one, waits for a choice of this `if`.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from heapq import heapify, heappop, heappush

from synth.emit.lower import Node, Program

INLINE = ("literal", "constant")
_COMPOSED = frozenset(("add", "sub", "mul", "div", "sq", "inv", "lt", "le", "eq", "ne", "and", "or", "bit"))


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
    """Choices on one condition: `declared` holds each choice's variable with the node that it starts from, or None."""

    condition: int
    declared: tuple[tuple[int, int | None], ...]
    then: tuple["Statement", ...]
    other: tuple["Statement", ...]


@dataclass(frozen=True)
class About:
    """What follows computes a named signal (by its place among the marks), or else the next state of this name."""

    mark: int | None
    state: str = ""


Statement = Let | Store | Assign | Branch | About


@dataclass(frozen=True)
class _Demand:
    """A node whose value goes to places: (struct, member), or ("choice", node)."""

    node: int
    place: tuple[str, str | int]


@dataclass(frozen=True)
class _Region:
    """The choices on one condition at one level, and what is sunk into either side."""

    condition: int
    choices: list[int]
    sides: tuple[set[int], set[int]]


@dataclass(frozen=True)
class _Written:
    """A region as a statement: its choices, the nodes of outside that it reads, and the demands that it meets."""

    choices: list[int]
    branch: Branch
    reads: dict[int, None]
    met: list[_Demand]


def statements(p: Program) -> tuple[Statement, ...]:
    """Return the statements that compute and store everything of a program."""
    demands = [_Demand(k, ("state", name)) for name, k in p.next.items() if p.nodes[k] != Node("state", name=name)]
    demands += [_Demand(k, ("out", name)) for name, k in p.outputs.items()]
    demands += [] if p.word is None else [_Demand(p.word, ("word", ""))]
    whole = {k for k, node in enumerate(p.nodes) if node.op not in INLINE}
    return tuple(_Level(p, p.users(), whole, demands).written())


class _Level:
    """One block of statements: the nodes that belong to it and what is demanded of it."""

    def __init__(self, p: Program, users: list[list[int]], members: set[int], demands: Sequence[_Demand]) -> None:
        self.p, self.users, self.members = p, users, members
        self.pending = dict.fromkeys(demands)
        self.demands: dict[int, list[_Demand]] = {}
        for d in demands:
            self.demands.setdefault(d.node, []).append(d)
        self.loads = {p.nodes[k].name: k for k in members if p.nodes[k].op == "state"}
        self.first_of: dict[int, int] = {}  # by choice, the first of its region
        self.written_of: dict[int, _Written] = {}  # by choice or sunk node
        self._write_regions()
        self.sunk = self.written_of.keys() - self.first_of.keys()
        self.done: set[int] = set()
        self.out: list[Statement] = []

    def written(self) -> list[Statement]:
        """Return the statements: signals in order, each demand as soon as the signals below it stand."""
        marked: dict[int, int] = {}
        for i, (_, k) in enumerate(self.p.marks):
            if k in self.members and k not in self.sunk:
                marked.setdefault(k, i)
        waiting = self._waiting(marked)
        for place, (k, i) in enumerate(marked.items()):
            if k not in self.done:
                self.out.append(About(i))
                self._compute(k)
            for d in waiting.get(place, ()):
                self._meet(d)
        for d in list(self.pending):
            self._meet(d)
        return self.out

    def _waiting(self, marked: dict[int, int]) -> dict[int, list[_Demand]]:
        """Return by the place of a marked node in the order the demands for which it is the last that they wait for.

        A next state waits for the signals that it needs, and for those of its own Block.
        """
        places = {k: place for place, k in enumerate(marked)}
        by_block = {self.p.marks[i][0].block: places[k] for k, i in marked.items()}
        last: dict[int, int] = {}
        waiting: dict[int, list[_Demand]] = {}
        for d in self.pending:
            own = by_block.get(self.p.owner(str(d.place[1])), -1) if d.place[0] == "state" else -1
            waiting.setdefault(max(own, self._last(d.node, places, last)), []).append(d)
        return waiting

    def _last(self, k: int, places: dict[int, int], known: dict[int, int]) -> int:
        """Return the place of the last marked node that node k needs or is, -1 for none; `known` has earlier ones."""
        first = self.first_of.get
        stack = [first(k, k)]
        while stack:
            n = stack[-1]
            needs = [first(a, a) for a in self._needs(n) if a in self.members] if n in self.members else []
            missing = [a for a in needs if a not in known]
            stack += missing
            if not missing:
                known[stack.pop()] = max([places.get(n, -1), *(known[a] for a in needs)])
        return known[first(k, k)]

    def _needs(self, k: int) -> Sequence[int]:
        """Return what must stand before node k is computed: for a choice, all that its `if` needs from outside."""
        if k not in self.first_of:
            return self.p.nodes[k].args
        written = self.written_of[k]
        stored = [self.loads.get(str(d.place[1])) for d in written.met if d.place[0] == "state"]
        return [*written.reads, *(load for load in stored if load is not None and load not in self.sunk)]

    def _compute(self, k: int) -> None:
        stack = [k]
        while stack:
            n = stack[-1]
            missing = (
                [a for a in self._needs(n) if a in self.members and a not in self.done] if n in self.members else []
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

    def _meet(self, d: _Demand) -> None:
        if d not in self.pending:
            return
        struct, name = d.place
        if struct == "state":
            if d.node not in self.done:
                self.out.append(About(None, str(name)))
            if (load := self.loads.get(str(name))) is not None and load not in self.sunk:
                self._compute(load)
        self._compute(d.node)
        if d in self.pending:  # a branch may have met it
            del self.pending[d]
            self.out.append(_stored(d))

    def _branch(self, region: _Region) -> _Written:
        """Write one `if`: demands that only a choice feeds, or that a side leaves as they are, are met inside."""
        inner: tuple[list[_Demand], list[_Demand]] = ([], [])
        declared: list[tuple[int, int | None]] = []
        met: list[_Demand] = []
        for c in region.choices:
            arms = self.p.nodes[c].args[1:]
            if self._read(c) or c == self.p.word:
                start = next((a for a, side in zip(arms, region.sides, strict=True) if a not in side), None)
                declared.append((c, start))
                for arm, found in zip(arms, inner, strict=True):
                    if arm != start:
                        found.append(_Demand(arm, ("choice", c)))
            for d in self.demands.get(c, ()):
                if d.place[0] == "word" or (self._read(c) and not any(self._is_load(a, d.place) for a in arms)):
                    continue
                met.append(d)
                for arm, found in zip(arms, inner, strict=True):
                    if not self._is_load(arm, d.place):
                        found.append(_Demand(arm, d.place))
        then, other = (
            tuple(_Level(self.p, self.users, members, demands).written())
            for members, demands in zip(region.sides, inner, strict=True)
        )
        branch = Branch(region.condition, tuple(declared), then, other)
        inside = region.sides[0].union(region.sides[1], region.choices)
        reads = dict.fromkeys(k for k in _reads(self.p, [branch]) if k not in inside)
        return _Written(region.choices, branch, reads, met)

    def _read(self, choice: int) -> bool:
        """Tell whether a node of this level reads the choice; what others read is a demand here."""
        return any(u in self.members for u in self.users[choice])

    def _is_load(self, k: int, place: tuple[str, str | int]) -> bool:
        node = self.p.nodes[k]
        return place == (node.op, node.name) and node.op == "state"

    def _write_regions(self) -> None:
        """Find and write the regions, later choices first: what one takes in is no region of this level."""
        by_condition: dict[int, list[int]] = {}
        for k in sorted(self.members):
            if self.p.nodes[k].op == "choose":
                by_condition.setdefault(self.p.nodes[k].args[0], []).append(k)
        for condition, group in sorted(by_condition.items(), key=lambda item: -item[1][-1]):
            choices = self._independent([c for c in group if c not in self.written_of])
            region = _Region(condition, choices, self._whole_sides(choices, by_condition))
            if self._circular(region):
                kept: list[int] = []
                for c in choices:
                    region = _Region(condition, [*kept, c], self._whole_sides([*kept, c], by_condition))
                    kept += [] if self._circular(region) else [c]
                region = _Region(condition, kept, self._whole_sides(kept, by_condition))
            if region.choices and self._worthwhile(region):
                written = self._branch(region)
                self.first_of |= dict.fromkeys(region.choices, region.choices[0])
                self.written_of |= dict.fromkeys([*region.choices, *region.sides[0], *region.sides[1]], written)

    def _circular(self, region: _Region) -> bool:
        """Tell whether one choice of a region needs another through regions, each of which is written as a whole."""
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
        """Sink into both sides, but take in the choices on another condition together or not at all."""
        kept = set(self.written_of)
        while True:
            sides = self._sides(choices, kept)
            split: set[int] = set()
            for side in sides:
                for k in side:
                    if self.p.nodes[k].op == "choose":
                        group = [c for c in by_condition[self.p.nodes[k].args[0]] if c not in self.written_of]
                        split.update(group if not side.issuperset(group) else ())
            if not split - kept:
                return sides
            kept |= split

    def _independent(self, choices: list[int]) -> list[int]:
        """Return the choices of which none needs another."""
        kept: list[int] = []
        reached: set[int] = set()
        for c in choices:
            if c in reached:
                continue
            kept.append(c)
            stack = [c]
            while stack:
                for u in self.users[stack.pop()]:
                    if u not in reached:
                        reached.add(u)
                        stack.append(u)
        return kept

    def _sides(self, choices: list[int], taken: set[int]) -> tuple[set[int], set[int]]:
        sides: tuple[set[int], set[int]] = (set(), set())
        chosen = set(choices)
        early = self._stored_elsewhere(choices)
        heap = [-a for c in choices for a in self.p.nodes[c].args[1:]]
        heapify(heap)
        seen: set[int] = set()
        while heap:
            k = -heappop(heap)
            node = self.p.nodes[k]
            if k in seen or k not in self.members or k in taken or k in chosen or k in self.demands:
                continue
            seen.add(k)
            if node.op == "state" and node.name in early:
                continue
            for side, own in enumerate(sides):
                users = [u for u in self.users[k] if u in self.members and not self._passes_over(u, k, chosen)]
                if all(u in own or (u in chosen and self._only(u, k, side)) for u in users):
                    own.add(k)
                    for a in node.args:
                        heappush(heap, -a)
        return sides

    def _stored_elsewhere(self, choices: list[int]) -> set[str | int]:
        """Return the states whose store at this level waits for none of the choices, so that it may come first."""
        reached, stack = set(choices), list(choices)
        while stack:
            for u in self.users[stack.pop()]:
                if u in self.members and u not in reached:
                    reached.add(u)
                    stack.append(u)
        return {d.place[1] for d in self.pending if d.place[0] == "state" and d.node not in reached}

    def _passes_over(self, user: int, k: int, chosen: set[int]) -> bool:
        """Tell whether a user of node k is written without reading it: it only leaves the state that k loads."""
        if user in self.written_of:
            return k not in self.written_of[user].reads
        return user in chosen and self._holds(user, k)

    def _holds(self, choice: int, k: int) -> bool:
        """Tell whether a choice reads node k only to leave the state that k loads as it is."""
        places = [d.place for d in self.demands.get(choice, ())]
        read = self.p.nodes[choice].args
        alone = read.count(k) == 1 and read[0] != k
        return not self._read(choice) and alone and all(self._is_load(k, q) for q in places)

    def _only(self, choice: int, k: int, side: int) -> bool:
        """Tell whether a choice reads node k on this side only."""
        args = self.p.nodes[choice].args
        return args[1 + side] == k and args[0] != k and args[2 - side] != k

    def _worthwhile(self, region: _Region) -> bool:
        """An `if` pays for more than two choices, and where a side has something to compute or leaves a state alone.

        A short one stays a choice unless its first arm is composed: cppcheck takes the parentheses away from that arm,
        and then misses them.
        """
        arms = {self.p.nodes[c].args[1] for c in region.choices} & region.sides[0]
        bare = any(self.p.nodes[a].op in _COMPOSED for a in arms)
        held = any(
            self._is_load(a, d.place)
            for c in region.choices
            for a in self.p.nodes[c].args[1:]
            for d in self.demands.get(c, [])
        )
        return held or bare or len(region.choices) > 2 or len(region.sides[0]) + len(region.sides[1]) > 2


def _stored(d: _Demand) -> Statement:
    struct, name = d.place
    if struct == "choice":
        assert isinstance(name, int)
        return Assign(name, d.node)
    return Store(struct, str(name), d.node)


def _reads(p: Program, block: Sequence[Statement]) -> Iterator[int]:
    """Yield the nodes that statements read."""
    for s in block:
        if isinstance(s, Let):
            yield from p.nodes[s.node].args
        elif isinstance(s, Assign | Store):
            yield s.node
        elif isinstance(s, Branch):
            yield s.condition
            yield from (start for _, start in s.declared if start is not None)
            yield from _reads(p, (*s.then, *s.other))
