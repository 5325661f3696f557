"""Reference semantics of a program's operations, on floats or fractions, and an interpreter of programs."""

import math
from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from typing import Any

from synth.emit.program.lower import Node, Program


def exact(a: Any) -> Any:
    """Return a truth value (an int) as a fraction, because a quotient of ints would be a float."""
    return Fraction(a) if isinstance(a, int) else a


OPERATIONS: dict[str, Callable[..., Any]] = {
    "neg": lambda a: -a,
    "fabs": abs,
    "sq": lambda a: a * a,
    "twice": lambda a: 2 * a,
    "inv": lambda a: 1 / exact(a),
    "not": lambda a: a == 0,
    "add": lambda a, b: a + b,
    "sub": lambda a, b: a - b,
    "mul": lambda a, b: a * b,
    "div": lambda a, b: a / exact(b),
    "min": lambda a, b: a if a < b else b,
    "max": lambda a, b: a if a > b else b,
    "clamp": lambda x, low, high: OPERATIONS["max"](OPERATIONS["min"](x, high), low),
    "lt": lambda a, b: a < b,
    "le": lambda a, b: a <= b,
    "eq": lambda a, b: a == b,
    "ne": lambda a, b: a != b,
    "and": lambda a, b: a != 0 and b != 0,
    "or": lambda a, b: a != 0 or b != 0,
    "when": lambda a, b: b if a != 0 else 0,
    "choose": lambda a, b, c: b if a != 0 else c,
}
LOADS = ("input", "state", "constant")


def value(node: Node, args: Sequence[Any], loads: Mapping[str, Any]) -> Any:
    """Return the value of a node; a truth value is 0 or 1."""
    if node.op in LOADS:
        return loads[node.name]
    if node.op == "literal":
        return node.value
    if node.op == "bit":
        return int(args[0]) | int(node.value)
    y = OPERATIONS.get(node.op, getattr(math, node.op, None))(*args)
    return int(y) if isinstance(y, bool) else y


def interpret(program: Program, loads: Mapping[str, Any]) -> list[Any]:
    """Return the value of each node."""
    values: list[Any] = []
    for node in program.nodes:
        values.append(value(node, [values[a] for a in node.args], loads))
    return values
