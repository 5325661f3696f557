"""Named numbers: a literal that a Block declares as a number of its law becomes a constant with name, unit and source.

    -10.6 w   ->   -M_x w        in the Block that declares M_x = 10.6

Numbers of geometry, such as pi/2, have names in every Block. A literal is replaced by a constant of the same value in
the scalar type, and by its negative where the sign differs, so the machine code stays the same.

    still_y1 >= 3   ->   repeated_samples <= still_y1      of a Block that declares repeated_samples = 3 of "still"

A whole number that a count is compared with, or becomes, remains a literal and gets a name: it is an integer in C.
"""

from collections import Counter
from collections.abc import Container, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from math import pi, sqrt

import numpy as np

from synth.block import Block, Constant
from synth.emit.passes import parts
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


def with_numbers(p: Program, block: Block, scalar: type[np.floating]) -> tuple[Program, Block]:
    """Return the program that reads numbers by name, and the Block with the constants that it then reads."""
    known = _unique_names(p, block)
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
        self.owner, self.users = parts.by_node(p), p.users()
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
    """Return by node the names of the signals, states, next states and labels of a law that it is."""
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
