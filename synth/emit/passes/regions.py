"""If-conversion regions: the choices on one condition that become one `if`, and code sinking into its sides.

A node is *sunk* into a side of a condition if every use of it is on that side. Nodes are visited backwards, so a node's
users are decided before the node itself. A choice that only leaves a state unchanged does not use the state's load.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from heapq import heapify, heappop, heappush

from synth.emit.passes.statements import Branch
from synth.emit.program.lower import Program

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
