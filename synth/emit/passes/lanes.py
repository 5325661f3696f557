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
        for group in sorted(self.groups, key=lambda g: -len(g.lanes) * g.size):
            if len(group.lanes) > 1 and any(self._try(group, lower) for lower in self._edges(group)):
                return True
        return False

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
        before = dict(self.of)
        self.of |= {r: made for lane in lanes for r in lane}
        if not self._ordered(made):
            self.of = before
            return False
        self.groups = [g for g in self.groups if g not in (group, lower)] + [made]
        return True

    def _ordered(self, made: Group) -> bool:
        """Tell whether no lane of a group needs itself through others."""
        return all(not self._needs_itself({k for r in lane for k in self.tree[r].nodes}) for lane in made.lanes)

    def _needs_itself(self, lane: set[int]) -> bool:
        reached = set(lane)
        for k in range(min(lane), max(lane) + 1):
            if k not in lane and any(a in reached for a in self.p.nodes[k].args):
                reached.add(k)
        return any(a in reached - lane for k in lane for a in self.p.nodes[k].args)
