"""Named numbers: a literal that a Block declares as a number of its law becomes a constant with name, unit and source.

    -10.6 w   ->   -M_x w        in the Block that declares M_x = 10.6

Numbers of geometry, such as pi/2, have names in every Block. A literal is replaced by a constant of the same value in
the scalar type, and by its negative where the sign differs, so the machine code stays the same.
"""

from collections.abc import Container, Iterator, Mapping, Sequence
from dataclasses import replace
from math import pi, sqrt

import numpy as np

from synth.block import Block, Constant
from synth.emit.c.kinds import kinds
from synth.emit.lower import Node, Program
from synth.emit.passes import owners, words

GEOMETRY = {
    "pi": (pi, "pi"),
    "two_pi": (2 * pi, "2 pi"),
    "half_pi": (pi / 2, "pi / 2"),
    "two_thirds_pi": (2 * pi / 3, "2 pi / 3"),
    "three_quarters_pi": (3 * pi / 4, "3 pi / 4"),
    "root_2": (sqrt(2), "sqrt(2)"),
    "half_root_3": (sqrt(3) / 2, "sqrt(3) / 2"),
}
# The operands that may become constants, by operation; the others are named elsewhere or count something.
_OPERANDS: dict[str, tuple[int, ...]] = dict.fromkeys(("add", "sub", "mul", "div", "lt", "le", "min", "max"), (0, 1))
_OPERANDS |= {"clamp": (2,), "slew": (1, 2), "choose": (1, 2), "neg": (0,)}
_CLOSE = 1e-12  # relative: folding rounds a product of numbers once


def with_numbers(
    p: Program, block: Block, scalar: type[np.floating], names: Container[str] | None = None
) -> tuple[Program, Block]:
    """Return the program that reads numbers by name, and the Block with the constants that it then reads.

    `names` are those that may be read, by default all.
    """
    namer = _Namer(p, block, scalar, names)
    program = namer.program()
    return program, replace(block, constants=(*namer.read.values(), *block.constants))


class _Namer:
    """Builds the program; `read` holds the constants that it reads, by name."""

    def __init__(self, p: Program, block: Block, scalar: type[np.floating], names: Container[str] | None) -> None:
        self.p, self.scalar, self.kind = p, scalar, kinds(p)
        known = _unique_names(p, block)
        self.known = {b: [c for c in group if names is None or c.name in names] for b, group in known.items()}
        self.owner = owners.by_node(p)
        self.read: dict[str, Constant] = {}
        self.nodes: list[Node] = []
        self.places: dict[Node, int] = {}

    def program(self) -> Program:
        index: list[int] = []
        for k, node in enumerate(self.p.nodes):
            args = [index[a] for a in node.args]
            for place in _OPERANDS.get(node.op, ()):
                constant = self._constant(k, node.args[place])
                args[place] = args[place] if constant is None else self._put(constant)
            index.append(self._append(replace(node, args=tuple(args))))
        return self.p.with_nodes(tuple(self.nodes), index)

    def _constant(self, k: int, operand: int) -> tuple[Constant, bool] | None:
        """Return the constant that node k reads in place of a literal, and whether as its negative."""
        literal, around = self.p.nodes[operand], [self.kind[k], *(self.kind[a] for a in self.p.nodes[k].args)]
        if (
            literal.op != "literal"
            or literal.value == 0
            or ("integer" in around and literal.value == int(literal.value))
        ):
            return None
        for number in (*self.known.get(self.owner[k], ()), *self.known[""]):
            size, is_negative = abs(number.value), literal.value * number.value < 0
            if abs(abs(literal.value) - size) <= _CLOSE * size and self._agrees(number, literal.value):
                value = -literal.value if is_negative else literal.value
                return self.read.setdefault(number.name, replace(number, value=value)), is_negative
        return None

    def _agrees(self, number: Constant, literal: float) -> bool:
        """Tell whether a literal rounds to the value of the constant, as the first literal of this name has it."""
        first = self.read.get(number.name)
        return first is None or self.scalar(abs(literal)) == self.scalar(abs(first.value))

    def _put(self, constant: tuple[Constant, bool]) -> int:
        number, is_negative = constant
        load = Node("constant", name=number.name, value=-1.0 if is_negative else 0.0)
        if load not in self.places:
            self.places[load] = self._append(load)
        return self.places[load]

    def _append(self, node: Node) -> int:
        self.nodes.append(node)
        return len(self.nodes) - 1


def _unique_names(p: Program, block: Block) -> Mapping[str, Sequence[Constant]]:
    """Return the numbers by Block, "" for those of all; a name that means something else gets its Block's as prefix."""
    used = {*block.symbol, *p.outputs, *(named.signal.name for named, _ in p.marks)}
    declared: dict[str, set[float]] = {}
    for _, number in block.numbers:
        declared.setdefault(number.name, set()).add(number.value)
    known: dict[str, list[Constant]] = {"": [c for c in _geometry() if c.name not in used | declared.keys()]}
    for name, number in block.numbers:
        is_own = number.name not in used and len(declared[number.name]) == 1
        known.setdefault(name, []).append(number if is_own else replace(number, name=f"{name}_{number.name}"))
    return {name: _merge(numbers, used | declared.keys()) for name, numbers in known.items()}


def _merge(numbers: Sequence[Constant], used: Container[str]) -> list[Constant]:
    """Return the numbers with one for those of equal value, under the words that their names have in common."""
    by_value: dict[float, list[Constant]] = {}
    for number in numbers:
        by_value.setdefault(abs(number.value), []).append(number)
    merged = []
    for equal in by_value.values():
        common = words.common([n.name for n in equal])
        name = equal[0].name if not common or common in used else common
        also = "".join(f", also {n.name}" for n in equal if n.name != name and len(equal) > 1)
        merged.append(replace(equal[0], name=name, source=f"{equal[0].source}{also}"))
    return merged


def _geometry() -> Iterator[Constant]:
    for name, (value, text) in GEOMETRY.items():
        yield Constant(name, value, "1", text)
