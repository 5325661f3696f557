"""Grouping: the statements of one level in an order that keeps those of a Block together as far as data flow allows.

List scheduling: from what can be computed next, a statement of the present Block comes first. Behind it comes the
smallest Block whose statements can be completed, so that few values live long, or, where there is none, that of the
earliest statement. A load stands before the first statement that reads it. What an outer level has computed is stored
at the beginning. The order is taken where it has fewer sections.

Named numbers: a literal that a Block declares as a number of its law becomes a constant with name, unit and source.

    -10.6 w   ->   -M_x w        in the Block that declares M_x = 10.6

Numbers of geometry, such as pi/2, have names in every Block. A literal is replaced by a constant of the same value in
the scalar type, and by its negative where the sign differs, so the machine code stays the same.

    still_y1 >= 3   ->   repeated_samples <= still_y1      of a Block that declares repeated_samples = 3 of "still"

A whole number that a count is compared with, or becomes, remains a literal and gets a name: it is an integer in C.
"""

from collections import Counter, defaultdict
from collections.abc import Container, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from heapq import heapify, heappop, heappush
from itertools import groupby
from math import pi, sqrt

import numpy as np

from synth.block import Block, Constant
from synth.emit.passes import outline
from synth.emit.passes.outline import Branch, Let, Owners, Statement, Store, reads
from synth.emit.program import words
from synth.emit.program.lower import Node, Program
from synth.emit.proof.conditions import bounds_of_squares
from synth.emit.proof.ranges import kinds

GEOMETRY = {
    "pi": (pi, "pi"),
    "two_pi": (2 * pi, "2 pi"),
    "half_pi": (pi / 2, "pi / 2"),
    "two_thirds_pi": (2 * pi / 3, "2 pi / 3"),
    "three_quarters_pi": (3 * pi / 4, "3 pi / 4"),
    "root_2": (sqrt(2), "sqrt(2)"),
    "four_root_2": (4 * sqrt(2), "4 sqrt(2)"),
    "eight_root_2": (8 * sqrt(2), "8 sqrt(2)"),
    "half_root_3": (sqrt(3) / 2, "sqrt(3) / 2"),
}
# The operands that may become constants, by operation; the others are named elsewhere or count something.
_OPERANDS: dict[str, tuple[int, ...]] = dict.fromkeys(("add", "sub", "mul", "div", "lt", "le", "min", "max"), (0, 1))
_OPERANDS |= {"clamp": (2,), "slew": (1, 2), "choose": (1, 2), "neg": (0,)}
_OF_COUNTS = _OPERANDS | {"eq": (0, 1), "ne": (0, 1)}  # real numbers are never compared for equality
_LIMITING = {"lt", "le", "min", "max", "clamp", "slew", "choose"}
_CLOSE = 1e-12  # relative: folding rounds a product of numbers once


def with_numbers(
    p: Program, block: Block, scalar: type[np.floating], names: Container[str] | None = None
) -> tuple[Program, Block]:
    """Return the program that reads numbers by name, and the Block with the constants that it then reads.

    `names` are those that may be read, by default all.
    """
    known = _unique_names(p, block)
    if names is not None:
        known = {name: [e for equal in group if (e := equal.among(names))] for name, group in known.items()}
    first = _Namer(p, scalar, known, frozenset())
    first.program()
    namer = _Namer(p, scalar, known, frozenset(first.settled))
    program = namer.program()
    return program, replace(block, constants=(*namer.read.values(), *block.constants))


@dataclass(frozen=True)
class _Equal:
    """Numbers of one value: as one number, and each kind of them, which has a unit and a source of its own."""

    either: Constant
    kinds: tuple[Constant, ...]

    def among(self, names: Container[str]) -> "_Equal | None":
        """Return the numbers that have some of the names, None where there are none."""
        kept = tuple(c for c in self.kinds if c.name in names)
        either = self.either if self.either.name in names else kept[0] if kept else None
        return _Equal(either, kept or (either,)) if either else None


class _Namer:
    """Builds the program; `read` holds the constants that it reads, by name.

    Of equal numbers of several kinds, a node reads the one with a word of its own in the names of the node, else the
    only one that is not `settled`: read elsewhere for its words.
    """

    def __init__(
        self, p: Program, scalar: type[np.floating], known: Mapping[str, Sequence[_Equal]], settled: frozenset[str]
    ) -> None:
        self.p, self.scalar, self.kind, self.known = p, scalar, kinds(p), known
        self.settled = set(settled)
        self.owner, self.users = outline.by_node(p), p.users()
        self.named = _names_by_node(p)
        self.read: dict[str, Constant] = {}
        self.nodes: list[Node] = []
        self.places: dict[Node, int] = {}

    def program(self) -> Program:
        index: list[int] = []
        observed = {*self.p.ends(), *(k for _, k in self.p.marks)}
        negated: set[int] = set()  # products whose negative is computed
        for k, node in enumerate(self.p.nodes):
            args = [index[a] for a in node.args]
            for place in _OF_COUNTS.get(node.op, ()):
                if load := self._load(k, node.args[place]):
                    if load.value < 0 and load.op == "constant" and self._allows_subtraction(k) and k not in observed:
                        load = replace(load, value=0.0)
                        negated.add(k)
                    args[place] = self._put(load)
            if node.op in ("add", "sub") and node.args[1] in negated:
                node = replace(node, op="sub" if node.op == "add" else "add")
            index.append(self._append(replace(node, args=tuple(args))))
        return self.p.with_nodes(tuple(self.nodes), index)

    def _allows_subtraction(self, k: int) -> bool:
        """Tell whether a product is only the second operand of sums and differences, which can take its negative."""
        readers = [self.p.nodes[u] for u in self.users[k]]
        return self.p.nodes[k].op == "mul" and all(n.op in ("add", "sub") and n.args[0] != k for n in readers)

    def _load(self, k: int, operand: int) -> Node | None:
        """Return what node k reads in place of a literal: a constant or its negative, or a whole number with a name."""
        node, literal = self.p.nodes[k], self.p.nodes[operand]
        if literal.op != "literal" or literal.value == 0:
            return None
        around = [self.kind[k], *(self.kind[a] for a in node.args)]
        if literal.value == int(literal.value) and ("integer" in around or self._becomes_a_count(k)):
            return self._count(k, operand)
        return self._constant(k, literal.value) if operand in _operands(node) else None

    def _constant(self, k: int, literal: float) -> Node | None:
        if abs(literal) == 2 and self.p.nodes[k].op == "mul":
            return None  # a factor of a formula, as in 2 p v
        decides = any(self.p.nodes[u].op == "choose" and self.p.nodes[u].args[0] == k for u in self.users[k])
        if decides and bounds_of_squares(self.p.nodes, k, self.scalar):
            return None  # the C states what follows for each square, from the literal
        for equal in (*self.known.get(self.owner[k], ()), *self.known[""]):
            size = abs(equal.either.value)
            close = not equal.either.of and abs(abs(literal) - size) <= _CLOSE * size
            fits = self.p.nodes[k].op in _LIMITING or not equal.either.is_limit
            if close and fits and self._agrees(number := self._chosen(k, equal), literal):
                is_negative = literal * number.value < 0
                self.read.setdefault(number.name, replace(number, value=-literal if is_negative else literal))
                return Node("constant", name=number.name, value=-1.0 if is_negative else 0.0)
        return None

    def _chosen(self, k: int, equal: _Equal) -> Constant:
        """Return which of equal numbers node k reads."""
        if len(equal.kinds) == 1:
            return equal.kinds[0]
        split: list[set[str]] = [set(c.name.split("_")) for c in equal.kinds]
        around = {word for name in self._all_names(k) for word in name.split("_")} - split[0].intersection(*split[1:])
        meant = [c for c, words in zip(equal.kinds, split, strict=True) if words & around]
        if len(meant) == 1:
            self.settled.add(meant[0].name)
            return meant[0]
        left = [c for c in equal.kinds if c.name not in self.settled]
        return left[0] if len(left) == 1 else equal.either

    def _count(self, k: int, operand: int) -> Node | None:
        """Return the whole number with the name that it has for the counts that node k compares or chooses."""
        node, value = self.p.nodes[k], self.p.nodes[operand].value
        counts = {k} if node.op == "choose" else {*node.args} - {operand}
        words = {word for c in counts for name in self._all_names(c) for word in name.split("_")}
        for number in (equal.either for equal in self.known.get(self.owner[k], ())):
            if number.value == value and words.intersection(number.of):
                self.read.setdefault(number.name, number)
                return Node("literal", name=number.name, value=value)
        return None

    def _becomes_a_count(self, k: int) -> bool:
        """Tell whether a choice of numbers becomes the next value of a count."""
        return self.p.nodes[k].op == "choose" and not self.p.integers.isdisjoint(self._all_names(k))

    def _all_names(self, k: int) -> set[str]:
        """Return the names of a node and of the choices that have it as an arm."""
        choices = [u for u in self.users[k] if self.p.nodes[u].op == "choose" and k in self.p.nodes[u].args[1:]]
        return self.named.get(k, set()).union(*map(self._all_names, choices))

    def _agrees(self, number: Constant, literal: float) -> bool:
        """Tell whether a literal rounds to the value of the constant, as the first literal of this name has it."""
        first = self.read.get(number.name)
        return first is None or self.scalar(abs(literal)) == self.scalar(abs(first.value))

    def _put(self, load: Node) -> int:
        if load not in self.places:
            self.places[load] = self._append(load)
        return self.places[load]

    def _append(self, node: Node) -> int:
        self.nodes.append(node)
        return len(self.nodes) - 1


def _operands(node: Node) -> set[int]:
    return {node.args[place] for place in _OPERANDS.get(node.op, ())}


def _names_by_node(p: Program) -> dict[int, set[str]]:
    """Return by node the names of the signals, states, next states and variables of a law that it is."""
    named: dict[int, set[str]] = {}
    pairs = [(k, n.name) for k, n in enumerate(p.nodes) if n.name] + [(k, n.signal.name) for n, k in p.marks]
    for k, name in (*pairs, *p.labels.items(), *((k, name) for name, k in p.next.items())):
        named.setdefault(k, set()).add(name)
    return named


def _unique_names(p: Program, block: Block) -> Mapping[str, Sequence[_Equal]]:
    """Return the numbers by Block, "" for those of all; a name that means something else gets its Block's as prefix."""
    used = {*block.symbol, *p.outputs, *(named.signal.name for named, _ in p.marks)}
    declared: dict[str, set[float]] = {}
    for _, number in block.numbers:
        declared.setdefault(number.name, set()).add(number.value)
    known = {"": [c for c in _geometry() if c.name not in used | declared.keys()]}
    for name, number in block.numbers:
        is_own = number.name not in used and len(declared[number.name]) == 1
        known.setdefault(name, []).append(number if is_own else replace(number, name=f"{name}_{number.name}"))
    return {name: _merge(numbers, used | declared.keys()) for name, numbers in known.items()}


def _merge(numbers: Sequence[Constant], used: Container[str]) -> list[_Equal]:
    """Return the numbers with one for those of equal value, under the words that their names have in common."""
    by_value: dict[tuple[bool, float], list[Constant]] = {}
    for number in sorted((n for n in numbers if not n.of), key=lambda n: not n.is_limit):
        by_value.setdefault((number.is_limit, abs(number.value)), []).append(number)
    merged = [_Equal(n, (n,)) for n in dict.fromkeys(n for n in numbers if n.of)]
    commons = {key: words.common([n.name for n in equal]) for key, equal in by_value.items()}
    counts = Counter(commons.values())
    for key, equal in by_value.items():
        common = commons[key]
        if common and counts[common] > 1:
            common = words.combine([n.name for n in equal])
        either = _as_one(equal, common if common and common not in used else equal[0].name)
        kinds: dict[tuple[str, str], list[Constant]] = {}
        for number in equal:
            kinds.setdefault((number.unit, number.source), []).append(number)
        each = [_as_one(alike, _free_common(alike, used)) for alike in kinds.values()] if len(kinds) > 1 else [either]
        are_distinct = len({c.name for c in each}) == len(each)
        merged.append(_Equal(either, tuple(each) if are_distinct else (either,)))
    return merged


def _free_common(numbers: Sequence[Constant], used: Container[str]) -> str:
    common = words.common([n.name for n in numbers])
    return common if common and common not in used else numbers[0].name


def _as_one(numbers: Sequence[Constant], name: str) -> Constant:
    """Return equal numbers as one, under a name."""
    value = numbers[0].value if len({n.value for n in numbers}) == 1 else abs(numbers[0].value)
    parameters = tuple(dict.fromkeys(p for number in numbers for p in number.parameters))
    unit = " or ".join(dict.fromkeys(n.unit for n in numbers))
    source = "; ".join(dict.fromkeys(n.source for n in numbers)) + _of_others(name, numbers)
    return replace(numbers[0], name=name, value=value, unit=unit, source=source, parameters=parameters)


def _of_others(name: str, equal: Sequence[Constant]) -> str:
    """Return which numbers a name stands for: by the words that it lacks where it is the words in common."""
    others = [n.name for n in equal if n.name != name]
    if len(equal) == 1 or not others:
        return ""
    if len(others) < len(equal):
        return f"; also {', '.join(others)}"
    kept = name.split("_")
    lacking = [" ".join(w for w in n.split("_") if w not in kept) for n in others]
    return f"; of {', '.join(lacking)}" if any(lacking) else ""


def _geometry() -> Iterator[Constant]:
    for name, (value, text) in GEOMETRY.items():
        yield Constant(name, value, "1", text)


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
