"""Lanes: parts of one region of a program that are the same but for numbers and names, side by side.

A region is cut into trees: a root is a named signal, a next state, or a value that is read more than once. Trees of one
template, whose leaves are anonymous, are the first lanes. Two groups of lanes become one, lane by lane, where each lane
of the first reads just one lane of the second in the same place, and where no lane then needs itself.
"""

from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

from synth.emit.lower import Program

LOADS = ("input", "state", "constant", "literal")
Lane = tuple[int, ...]  # its roots, in the order of the group's columns


@dataclass
class Tree:
    """The nodes of a tree and its leaves, both in the order of its template."""

    template: tuple[object, ...]
    nodes: list[int]
    leaves: list[int]


@dataclass(eq=False)
class Group:
    """Lanes with one template a column."""

    lanes: list[Lane]
    size: int = field(default=0)  # nodes of a lane
    trees: dict[int, Tree] = field(default_factory=dict)

    def regions(self) -> list[tuple[Lane, frozenset[int]]]:
        """Return each lane with its nodes."""
        return [(lane, frozenset(k for r in lane for k in self.trees[r].nodes)) for lane in self.lanes]


class Forest:
    """The trees of a region and the groups that they are in."""

    def __init__(self, p: Program, region: frozenset[int], roots: set[int]) -> None:
        self.p, self.region, self.roots = p, region, roots
        users: dict[int, int] = defaultdict(int)
        for k in region:
            for a in p.nodes[k].args:
                users[a] += 1
        self.roots |= {k for k in region if users[k] != 1}
        self.tree = {r: self._tree(r) for r in sorted(self.roots)}
        self.root_of = {k: r for r, t in self.tree.items() for k in t.nodes}
        by_template: dict[tuple[object, ...], list[int]] = defaultdict(list)
        for r, t in self.tree.items():
            by_template[t.template].append(r)
        self.groups = [Group([(r,) for r in rs], len(self.tree[rs[0]].nodes)) for rs in by_template.values()]
        self.of = {r: g for g in self.groups for lane in g.lanes for r in lane}
        self.needs = {r: sorted({k for k in t.leaves if k in self.tree}) for r, t in self.tree.items()}
        self.outer = self._through_outside()
        self.refused: set[tuple[int, int]] = set()
        self.kept: list[Group] = []

    def _through_outside(self) -> dict[int, set[int]]:
        """Return for each root the other roots that it needs through nodes outside the region."""
        passed: dict[int, set[int]] = {}
        for k, node in enumerate(self.p.nodes):
            if k not in self.region:
                passed[k] = set().union(*(passed.get(a, {self.root_of.get(a, a)}) for a in node.args))
        return {r: set().union(*(passed.get(a, set()) for a in t.leaves)) & self.tree.keys() for r, t in self.tree.items()}

    def _tree(self, root: int) -> Tree:
        nodes: list[int] = []
        leaves: list[int] = []

        def visit(k: int) -> object:
            node = self.p.nodes[k]
            if k != root and (k in self.roots or k not in self.region):
                leaves.append(k)
                return node.op if node.op in LOADS else "value"
            nodes.append(k)
            name = node.name if node.op in ("polynomial", "table") else ""
            return (node.op, name, *(visit(a) for a in node.args))

        template = visit(root)
        assert isinstance(template, tuple)
        return Tree(template, nodes, leaves)

    def grow(self) -> list[Group]:
        """Merge groups until no more can be; return those of two lanes or more."""
        while self._merge_once() or self._split_once():
            pass
        for g in self.groups:
            g.trees = self.tree
        return [g for g in self.groups if len(g.lanes) > 1]

    def _merge_once(self) -> bool:
        merged = False
        for first in sorted(self.groups, key=lambda g: -len(g.lanes) * g.size):
            group = first
            while len(group.lanes) > 1 and self.of[group.lanes[0][0]] is group:
                if not any(self._try(group, read) for read in self._edges(group)):
                    break
                merged, group = True, self.of[group.lanes[0][0]]
        return merged

    def _split_once(self) -> bool:
        """Split a group whose lanes read whole groups of others, each lane one, in one place."""
        for group in self.groups:
            for read in self._edges(group) if len(group.lanes) > 2 else ():
                by_lower: dict[int, list[int]] = defaultdict(list)
                for i, k in enumerate(read):
                    by_lower[id(self.of[k])].append(i)
                whole = all(len(self.of[read[some[0]]].lanes) == len(some) > 1 for some in by_lower.values())
                if len(by_lower) > 1 and whole and group not in (self.of[k] for k in read):
                    self._replace(group, [[group.lanes[i] for i in some] for some in by_lower.values()])
                    return True
        return False

    def _replace(self, group: Group, parts: Sequence[list[Lane]]) -> None:
        made = [Group(lanes, group.size) for lanes in parts]
        self.groups = [g for g in self.groups if g is not group] + made
        self.of |= {r: g for g in made for lane in g.lanes for r in lane}

    def _edges(self, group: Group) -> Iterator[list[int]]:
        """Yield for each place of the lanes where all read a root the roots that they read there, by lane."""
        for column in range(len(group.lanes[0])):
            trees = [self.tree[lane[column]] for lane in group.lanes]
            for place in range(len(trees[0].leaves)):
                read = [t.leaves[place] for t in trees]
                if all(k in self.of for k in read) and len(set(read)) == len(read):
                    yield read

    def _try(self, group: Group, read: Sequence[int]) -> bool:
        """Merge the groups of the roots that lanes read into the lanes, where that is one lane for each."""
        lower = self.of[read[0]]
        if lower is group or any(self.of[k] is not lower for k in read):
            return False
        by_root = {r: lane for lane in lower.lanes for r in lane}
        columns = {by_root[k].index(k) for k in read}
        chosen = [by_root[k] for k in read]
        if len(columns) > 1 or len(set(chosen)) < len(chosen) or len(lower.lanes) != len(chosen):
            return False
        return self._merged(group, lower, [(*a, *b) for a, b in zip(group.lanes, chosen, strict=True)])

    def _merged(self, group: Group, lower: Group, lanes: list[Lane]) -> bool:
        made = Group(lanes, group.size + lower.size)
        if (id(group), id(lower)) in self.refused or not self._ordered(made):
            self.refused.add((id(group), id(lower)))
            return False
        self.kept += [group, lower]  # an id names one group for ever
        self.of |= {r: made for lane in lanes for r in lane}
        self.groups = [g for g in self.groups if g not in (group, lower)] + [made]
        return True

    def _ordered(self, made: Group) -> bool:
        """Tell whether no lane of a group needs itself through others."""
        return not any(self._needs_itself(lane) for lane in made.lanes)

    def _needs_itself(self, lane: Lane) -> bool:
        """Tell whether a root of a lane needs another one of it through roots that are not in it."""
        inside, low = set(lane), min(lane)
        stack = [k for r in lane for k in (*self.needs[r], *self.outer[r]) if k not in inside]
        stack += []
        if any(k in inside for r in lane for k in self.outer[r]):
            return True
        seen = set(stack)
        while stack:
            for k in (*self.needs[r := stack.pop()], *self.outer[r]):
                if k in inside:
                    return True
                if k > low and k not in seen:
                    seen.add(k)
                    stack.append(k)
        return False
