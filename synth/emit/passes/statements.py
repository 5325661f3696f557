"""Statements: language-independent intermediate representation of a scheduled step."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from synth.emit.program.lower import Program


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
