"""NumPy evaluation of programs: the value of each node for arrays of loads, in double."""

from collections.abc import Callable, Iterable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from synth.emit.program.lower import Program

Array = NDArray[Any]

OPERATIONS: dict[str, Callable[..., Any]] = {
    "neg": np.negative,
    "inv": np.reciprocal,
    "sq": np.square,
    "twice": lambda a: a + a,
    "not": np.logical_not,
    "add": np.add,
    "sub": np.subtract,
    "mul": np.multiply,
    "div": np.divide,
    "fma": lambda a, b, c: a * b + c,  # rounded twice, unlike in C
    "min": np.minimum,
    "max": np.maximum,
    "lt": np.less,
    "le": np.less_equal,
    "eq": np.equal,
    "ne": np.not_equal,
    "and": np.logical_and,
    "or": np.logical_or,
    "when": lambda condition, a: np.where(condition, a, 0.0),
    "choose": np.where,
    "asin": np.arcsin,
    "acos": np.arccos,
    "atan": np.arctan,
    "atan2": np.arctan2,
    **{name: getattr(np, name) for name in ("exp", "log", "sqrt", "sin", "cos", "tan", "sinh", "cosh", "tanh")},
    **{name: getattr(np, name) for name in ("fabs", "floor")},
}


def evaluate(program: Program, targets: Iterable[int], known: Mapping[int, Array]) -> dict[int, Array]:
    """Return the values of the `targets` and of what they follow from; `known` has those of the loads, by node."""
    values, waiting = dict(known), list(targets)
    while waiting:
        k = waiting[-1]
        node = program.nodes[k]
        missing = [a for a in node.args if a not in values] if k not in values else []
        waiting += missing
        if missing:
            continue
        waiting.pop()
        if k not in values:
            arguments = [values[a] for a in node.args]
            values[k] = np.array(node.value) if node.op == "literal" else OPERATIONS[node.op](*arguments)
    return values
