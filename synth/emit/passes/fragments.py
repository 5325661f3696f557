"""Fragments: what a program computes several times in the same way becomes a function that is called each time.

Nodes with equal expressions but for their leaves are a seed. From it several equal fragments grow in lockstep, first to
operands, then to users. Each stays convex: nothing outside lies between two of its nodes. A fragment holds no state and
lies in one branch of the program as it is scheduled, so that a call computes nothing that was skipped before.
"""

from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import replace

from synth.emit.lower import Program
from synth.emit.passes import routine, words
from synth.emit.passes.outline import Form, Part, form
from synth.emit.passes.routine import Group, Names
from synth.emit.passes.surroundings import Graph

DEPTHS = (8, 5, 3)  # of the expressions that are compared
MOST_ARGUMENTS = 9
MOST_RESULTS = 5
LINES = 0.5  # lines of an operation, about, and of a choice
LINES_OF_CHOICE = 1.5

Instances = list[tuple[int, ...]]  # by place in the fragment the nodes, one an instance


def fragments(p: Program, taken: frozenset[int]) -> list[Group]:
    """Return groups of equal fragments without the nodes `taken`, those that promise to save most lines first."""
    graph = Graph.of(p, taken)
    groups: list[Group] = []
    names = Names(set())
    grown = {seed: _grow(graph, seed) for seed in _seeds(graph)}
    while best := max((made for made in grown.values() if made), key=lambda made: made[0], default=None):
        groups.append(_with_names(p, best[1], names))
        used = frozenset(k for part, _ in best[1] for k in part.region)
        graph = replace(graph, free=graph.free - used)
        stale = [seed for seed, made in grown.items() if made and any(part.region & used for part, _ in made[1])]
        grown |= {seed: _grow(graph, seed) for seed in stale}
    return groups


def _with_names(p: Program, group: Group, names: Names) -> Group:
    """Return a group whose Parts have a name and a number each, from the variables of the laws."""
    common = words.common([_name(p, part, form) for part, form in group])
    name = common if common[:1].isalpha() else _name(p, *group[0])
    return [(replace(part, block=names.free(f"{name}_{n}")), form) for n, (part, form) in enumerate(group, 1)]


def _name(p: Program, part: Part, form: Form) -> str:
    """Return the words that the results of a fragment begin with, else the name of its last one."""
    labels = [routine.name(p, k) for k in form.results]
    first = "_".join(a for a, *others in zip(*(label.split("_") for label in labels), strict=False) if {a} == {*others})
    inner = [p.labels[k] for k in sorted(part.region, reverse=True) if k in p.labels]
    return next((name for name in [first, *labels[::-1], *inner] if name[:1].isalpha()), "part")


def _seeds(graph: Graph) -> Iterator[tuple[int, ...]]:
    """Yield nodes with equal expressions to some depth, each set of nodes once."""
    seen: set[tuple[int, ...]] = set()
    labels: list[object] = [graph.leaf(k) for k in range(len(graph.p.nodes))]
    by_depth = {0: labels}
    numbers: dict[object, int] = {}
    for depth in range(1, max(DEPTHS) + 1):
        last = by_depth[depth - 1]
        by_depth[depth] = [
            numbers.setdefault(
                (graph.signature(k), tuple(last[a] for a in graph.p.nodes[k].args)) if k in graph.free else last[k],
                len(numbers),
            )
            for k in range(len(graph.p.nodes))
        ]
    for depth in DEPTHS:
        classes: dict[object, list[int]] = defaultdict(list)
        for k in sorted(graph.free):
            classes[by_depth[depth][k]].append(k)
        for members in classes.values():
            seed = tuple(members)
            if 1 < len(seed) <= 16 and seed not in seen:
                seen.add(seed)
                yield seed


def _grow(graph: Graph, seed: tuple[int, ...]) -> tuple[float, Group] | None:
    """Return the score and the group of the best fragments on the way of growing from a seed."""
    growing = _Growing(graph, len(seed))
    if not growing.add(seed):
        return None
    best: tuple[float, Group] | None = None
    for candidate in growing.neighbours():
        if growing.add(candidate):
            made = _score(graph, growing.places, best[0] if best else 0.0)
            best = made or best
    return best


class _Growing:
    """Equal fragments that grow in lockstep."""

    def __init__(self, graph: Graph, count: int) -> None:
        self.graph, self.count = graph, count
        self.places: Instances = []
        self.place: list[dict[int, int]] = [{} for _ in range(count)]
        self.regions = [0] * count
        self.refused: set[tuple[int, ...]] = set()

    def neighbours(self) -> Iterator[tuple[int, ...]]:
        """Yield nodes next to the fragments as they grow, operands before users."""
        operands = users = 0
        while users < len(self.places):
            if operands < len(self.places):
                yield from zip(*(self.graph.p.nodes[k].args for k in self.places[operands]), strict=True)
                operands += 1
                continue
            column = self.places[users]
            users += 1
            for user in dict.fromkeys(self.graph.users[column[0]]):
                if user in self.graph.free and user not in self.place[0]:
                    yield from self._matching(user, column)
                    if operands < len(self.places):
                        users -= 1
                        break

    def _matching(self, user: int, column: tuple[int, ...]) -> Iterator[tuple[int, ...]]:
        """Yield the users of a column of nodes that are like the given one of its first node."""
        at = [i for i, a in enumerate(self.graph.p.nodes[user].args) if a == column[0]]
        matching = [user]
        for k in column[1:]:
            like = [
                u
                for u in self.graph.users[k]
                if u in self.graph.free
                and [i for i, a in enumerate(self.graph.p.nodes[u].args) if a == k] == at
                and self.graph.signature(u) == self.graph.signature(user)
            ]
            if len(set(like)) != 1:
                return
            matching.append(like[0])
        yield tuple(matching)

    def add(self, column: tuple[int, ...]) -> bool:
        """Add a node to each fragment where the fragments stay equal, apart and convex; tell whether it was added."""
        if column in self.refused or not self._fits(column):
            self.refused.add(column)
            return False
        regions = [region | 1 << k for region, k in zip(self.regions, column, strict=True)]
        inside = [[*place, k] for place, k in zip(self.place, column, strict=True)]
        if not all(self.graph.is_convex(r, nodes) for r, nodes in zip(regions, inside, strict=True)):
            return False
        for place, k in zip(self.place, column, strict=True):
            place[k] = len(self.places)
        self.places.append(column)
        self.regions = regions
        return True

    def _fits(self, column: tuple[int, ...]) -> bool:
        graph = self.graph
        if len(set(column)) < self.count or not graph.free.issuperset(column):
            return False
        if any(k in place for k in column for place in self.place):
            return False
        if len({graph.signature(k) for k in column}) > 1 or len({self._wires(i, k) for i, k in enumerate(column)}) > 1:
            return False
        return all(self._in_branch(i, k) for i, k in enumerate(column))

    def _wires(self, i: int, k: int) -> tuple[object, ...]:
        """Return how a node is joined to the fragment of instance i: the places of its operands and users in it."""
        place = self.place[i]
        operands = tuple(place.get(a, -1) for a in self.graph.p.nodes[k].args)
        users = {
            (place[u], j)
            for u in self.graph.users[k]
            if u in place
            for j, a in enumerate(self.graph.p.nodes[u].args)
            if a == k
        }
        return operands, tuple(sorted(users))

    def _in_branch(self, i: int, k: int) -> bool:
        """Tell whether a node lies in the branch of its fragment, or in a branch inside it."""
        if not self.places:
            return True
        around, root = self.graph.context[k], self.graph.context[self.places[0][i]]
        nodes = self.graph.p.nodes
        conditions = {nodes[n].args[0] for n in self.place[i] if nodes[n].op == "choose"}
        return around[: len(root)] == root and all(condition in conditions for condition, _ in around[len(root) :])


def _score(graph: Graph, places: Instances, least: float) -> tuple[float, Group] | None:
    """Return about how many lines fragments save, and their group; None for unequal or wide ones, or few lines."""
    regions = [frozenset(nodes) for nodes in zip(*places, strict=True)]
    results = [
        n
        for n, column in enumerate(places)
        if any(k in graph.fixed or not graph.readers[k] <= nodes for k, nodes in zip(column, regions, strict=True))
    ]
    if len(results) > MOST_RESULTS or not all(_is_whole(graph, nodes) for nodes in regions):
        return None
    count, several = len(places[0]), len(results) + 3 if len(results) > 1 else 0
    body = sum(LINES_OF_CHOICE if graph.p.nodes[column[0]].op == "choose" else LINES for column in places)
    saved = (count - 1) * body - 5 - several - count
    if saved <= least:
        return None
    group = [_part(graph, places, i, results) for i in range(len(places[0]))]
    first = group[0][1]
    if len({f.shape for _, f in group}) > 1 or len(first.arguments) > MOST_ARGUMENTS:
        return None
    return saved - 0.15 * len(group) * len(first.arguments), group


def _is_whole(graph: Graph, inside: frozenset[int]) -> bool:
    """Tell whether each branch of which a fragment has a choice is in it with all its choices."""
    return all(graph.choices.get(k, inside) <= inside for k in inside)


def _part(graph: Graph, places: Instances, i: int, results: Sequence[int]) -> tuple[Part, Form]:
    column = [place[i] for place in places]
    ends = tuple(column[n] for n in results)
    part = Part("", frozenset(column), {}, ends, None, {}, ())
    return part, form(graph.p, part, graph.kind)
