"""Outlining: Blocks of a composition that are the same program but for numbers and names become calls of one function.

Two Blocks are the same when the expressions of their signals and next states have one canonical form, in which the
values from elsewhere, the states, the constants and the numbers are counted in the order in which they are met. A Block
whose next states depend on what others make of its signals, such as a regulator with anti-windup, becomes two
functions: one for its signals and one for its next states. So does one of whose signals some come before the rest. One
whose signals decide whether it keeps its states returns the next ones, and its caller stores them.

Statements: language-independent intermediate representation of a scheduled step.

Owners: the Block of a composition for which a node or a statement computes something.
"""

from collections import Counter, defaultdict
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from synth.blocks.guard import safety
from synth.emit.program.lower import Node, Program
from synth.emit.proof.ranges import kinds


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


LEAVES = ("input", "state", "constant", "literal", "accepted")
NOT_OUTLINED = ("table", "guard", "guarded")
FEWEST = 4  # operations of a function that is worth its name


@dataclass(frozen=True)
class Part:
    """What one Block computes: region of nodes, next states by local name, and the condition that holds its states.

    `held` is (condition, arm): the next state is the computed one on that arm of a choice outside the Block, 0 for the
    first. None for a Block whose states always advance.
    """

    block: str
    region: frozenset[int]
    next: Mapping[str, int]
    results: tuple[int, ...]
    held: tuple[int, int] | None
    local: Mapping[str, str]
    roots: tuple[int, ...]
    phase: str = ""

    @property
    def key(self) -> str:
        return f"{self.block}_{self.phase}" if self.phase else self.block


@dataclass(frozen=True)
class Form:
    """A Part in canonical form: `shape` is equal for equal parts; the lists hold what may differ, in one order."""

    shape: tuple[object, ...]
    arguments: tuple[int, ...]
    numbers: tuple[int, ...]
    results: tuple[int, ...]


def parts(p: Program) -> list[Part]:
    """Return a Part for each Block of the composition that computes something alone."""
    carriers, held = _carriers(p)
    owner: dict[int, str] = {}
    for named, k in p.marks:
        if p.nodes[k].op not in LEAVES:
            owner.setdefault(k, named.block)
    for state, k in carriers.items():
        if p.nodes[k].op not in LEAVES:
            owner.setdefault(k, p.owner(state))
    closures = _closures(p, owner)
    states: dict[str, list[str]] = defaultdict(list)
    for state in p.next:
        states[p.owner(state)].append(state)
    return [_part(p, block, region, states[block], carriers, held) for block, region in closures.items() if region]


def _carriers(p: Program) -> tuple[dict[str, int], dict[str, tuple[int, int]]]:
    """Return for each state the node of its next value, without the choice that a safe output holds it by."""
    carriers, held = dict(p.next), {}
    users, conditions = p.users(), hold_conditions(p)
    for state, k in p.next.items():
        node, load = p.nodes[k], Node("state", name=state)
        if node.op == "choose" and users[k] == [] and node.args[0] in conditions:
            arms = [p.nodes[a] == load for a in node.args[1:]]
            if sum(arms) == 1:
                carriers[state], held[state] = node.args[2 if arms[0] else 1], (node.args[0], arms.index(False))
    return carriers, held


def hold_conditions(p: Program) -> set[int]:
    """Return the conditions under which several states stay as they are: a latch, rather than one input's range."""
    counts = Counter(
        n.args[0]
        for s, k in p.next.items()
        if (n := p.nodes[k]).op == "choose" and Node("state", name=s) in [p.nodes[a] for a in n.args[1:]]
    )
    return {k for k, count in counts.items() if count > 1}


def _closures(p: Program, owner: Mapping[int, str]) -> dict[str, frozenset[int]]:
    """Return the nodes that each Block alone needs for its own signals and next states."""
    shared: set[int] = set()
    while True:
        regions: dict[str, set[int]] = {block: set() for block in p.titles}
        for root, block in owner.items():
            stack = [root]
            while stack:
                k = stack.pop()
                if k in regions.setdefault(block, set()) or k in shared or p.nodes[k].op in LEAVES:
                    continue
                if owner.get(k, block) == block:
                    regions[block].add(k)
                    stack += p.nodes[k].args
        counts: dict[int, int] = defaultdict(int)
        for region in regions.values():
            for k in region:
                counts[k] += 1
        more = {k for k, count in counts.items() if count > 1}
        if not more:
            return {block: frozenset(region) for block, region in regions.items()}
        shared |= more


def _part(
    p: Program,
    block: str,
    region: frozenset[int],
    states: Sequence[str],
    carriers: Mapping[str, int],
    held: Mapping[str, tuple[int, int]],
) -> Part:
    carried = {state: carriers[state] for state in states}
    holds = {held.get(state) for state in carried}
    stores = {p.next[state] for state in carried} - region
    local = {s: s.removeprefix(f"{block}_") for s in states}
    roots = tuple(k for _, k in p.marks if k in region)
    return Part(
        block, region, carried, _results(p, region, stores), holds.pop() if len(holds) == 1 else None, local, roots
    )


def _results(p: Program, region: frozenset[int], stores: set[int]) -> tuple[int, ...]:
    """Return the nodes of a region that others read, other than the choices that hold its next states."""
    outside = {a for k, node in enumerate(p.nodes) if k not in region | stores for a in node.args}
    return tuple(sorted(region & (outside | set(p.outputs.values()))))


def split(p: Program, part: Part) -> list[Part]:
    """Return a Part whole where nothing that it needs depends on it, else in two that come one after the other.

    The first one has its signals, or else what others need for the values that the Part reads.
    """
    if not _depends_on_itself(p, part.region):
        return [_without_stores(p, part) if _decides_its_hold(p, part) else part]
    marks = {k for _, k in p.marks} & part.region
    for ends in (marks, _sources_of_inputs(p, part.region)):
        halves = _halves(p, part, frozenset(_ancestors(p, ends, part.region)))
        if all(h.region and not _depends_on_itself(p, h.region) for h in halves):
            return halves
    return []


def _decides_its_hold(p: Program, part: Part) -> bool:
    """Tell whether the condition that holds the states of a Part depends on its signals."""
    return part.held is not None and bool(_ancestors(p, {part.held[0]}, set(range(len(p.nodes)))) & part.region)


def _without_stores(p: Program, part: Part) -> Part:
    """Return a Part whose caller stores the next states: they are results like its signals."""
    following = part.region & {*part.next.values()}
    return replace(part, next={}, results=tuple(sorted({*part.results, *following})), held=None)


def _halves(p: Program, part: Part, first: frozenset[int]) -> list[Part]:
    """Return the Parts of some nodes, and of the others with the next states."""
    second = part.region - first
    stores = {p.next[state] for state in part.next} - part.region
    passed = {a for k in second for a in p.nodes[k].args} | set(part.next.values())
    signals = tuple(sorted(first & ({*_results(p, first, stores)} | passed)))
    return [
        replace(part, region=first, next={}, results=signals, held=None, phase="output"),
        replace(part, region=second, results=_results(p, second, stores), phase="update"),
    ]


def _sources_of_inputs(p: Program, region: frozenset[int]) -> set[int]:
    """Return the nodes of a region that values from outside are computed from, which the region reads."""
    leading = {a for k in region for a in p.nodes[k].args} - region
    for k in range(len(p.nodes) - 1, -1, -1):
        if k in leading:
            leading |= {a for a in p.nodes[k].args if a not in region}
    return {a for k in leading for a in p.nodes[k].args if a in region}


def _ancestors(p: Program, roots: set[int], region: Collection[int]) -> set[int]:
    seen, stack = set(), list(roots)
    while stack:
        k = stack.pop()
        if k in region and k not in seen:
            seen.add(k)
            stack += p.nodes[k].args
    return seen


def _depends_on_itself(p: Program, region: frozenset[int]) -> bool:
    """Tell whether a value that a region needs from outside depends on the region."""
    reached = set(region)
    for k in range(min(region), len(p.nodes)):
        if k not in region and not reached.isdisjoint(p.nodes[k].args):
            reached.add(k)
    outside = reached - region
    return any(not outside.isdisjoint(p.nodes[k].args) for k in region)


def form(p: Program, part: Part, kind: Sequence[str]) -> Form:
    """Return the canonical form of a Part; `kind` holds the kinds of all nodes."""
    places: dict[int, int] = {}
    shape: list[tuple[object, ...]] = []  # an entry a node, which refers to others by their places
    arguments: list[int] = []
    numbers: list[int] = []

    def leaf(k: int) -> tuple[object, ...]:
        node = p.nodes[k]
        if node.op in ("constant", "literal"):
            numbers.append(k)
            return (node.op, node.value if node.op == "constant" else 0.0)
        if node.op == "state" and node.name in part.local:
            return ("state", part.local[node.name])
        arguments.append(k)
        return ("argument", kind[k])

    def visit(k: int) -> int:
        if k not in places:
            node = p.nodes[k]
            if k in part.region:
                entry = (node.op, node.name, node.value, k in part.results, *(visit(a) for a in node.args))
            else:
                entry = leaf(k)
            places[k] = len(shape)
            shape.append(entry)
        return places[k]

    roots = [k for k in part.roots if k in part.region]
    ends = [visit(k) for k in (*roots, *(k for k in part.results if k not in roots))]
    stores = [(part.local[state], visit(k)) for state, k in part.next.items()]
    results = tuple(k for k in places if k in part.results)
    return Form((*shape, *ends, *stores), tuple(arguments), tuple(numbers), results)


def alike(p: Program) -> list[list[tuple[Part, Form]]]:
    """Return the Parts with one canonical form, where there are at least two of them with some operations.

    Blocks with integer states that become two functions are left out: behind a call Eva does not relate a flag, which
    the first one returns, to the count that it is from.
    """
    by_form: dict[tuple[object, ...], list[tuple[Part, Form]]] = defaultdict(list)
    kind = kinds(p)
    for whole in parts(p):
        pieces = split(p, whole)
        if len(pieces) > 1 and not whole.local.keys().isdisjoint(p.integers):
            continue
        for part in pieces:
            if len(part.region) >= FEWEST and not any(p.nodes[k].op in NOT_OUTLINED for k in part.region):
                made = form(p, part, kind)
                by_form[(part.phase, *made.shape)].append((part, made))
    return [group for group in by_form.values() if len(group) > 1]
