"""Names of the intermediate values of a law: those of the Python variables that hold them.

    def law(u, x, k):
        gap = u["y1"] - k["offset"]         gap
        force = {"x": ..., "z": ...}        force_x, force_z
        pair = Pair(sine, cosine)           pair_sine, pair_cosine, the fields of a dataclass or a NamedTuple
        J = ca.vertcat(...)                 J_1, J_2 of a vector, J_12 of a matrix

The functions that a law calls name values in the same way, and a name in the caller replaces one in a called function.
The names decide what locals are called in C and nothing else: a value that a later pass removes loses its name.
"""

import dataclasses
import re
import sys
from collections.abc import Callable, Iterator, Mapping
from types import FrameType
from typing import Any, ParamSpec, TypeVar

import casadi as ca

P = ParamSpec("P")
R = TypeVar("R")

LONGEST = 24  # letters of a name
LARGEST = 9  # rows or columns of a matrix whose elements have names: their indices have one digit
DEPTH = 3  # of containers in containers
# The variables of these modules hold the arguments of any call.
LIBRARIES = sys.stdlib_module_names - {"__main__"} | {"casadi", "numpy"}
CHECKS = ("synth.arguments", "synth.kinds", "synth.law")
# They name a role in Python, not the value that they hold.
SKIPPED = {"output", "next", "named", "computed", "result", "value", "values", "each", "expr", "exprs", "self", "v"}
_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*")

Intermediates = tuple[tuple[str, ca.SX], ...]


def record(function: Callable[P, R], *args: P.args, **kwargs: P.kwargs) -> tuple[R, Intermediates]:
    """Return the result of a law and its intermediate values, scalar expressions with their names.

    Each expression is listed once.
    """
    names: dict[int, tuple[str, ca.SX]] = {}

    def at_event(frame: FrameType, event: str, _: object) -> None:
        if event == "return" and _computes(frame):
            names.update(_computed_scalars(frame.f_locals))

    profiler = sys.getprofile()
    sys.setprofile(at_event)
    try:
        result = function(*args, **kwargs)
    finally:
        sys.setprofile(profiler)
    return result, tuple(names.values())


def _computes(frame: FrameType) -> bool:
    """Tell whether a frame runs a function of the law, not a comprehension, a library's or a check of arguments."""
    module = str(frame.f_globals.get("__name__", ""))
    return not frame.f_code.co_name.startswith("<") and module not in CHECKS and module.split(".")[0] not in LIBRARIES


def _computed_scalars(variables: Mapping[str, object]) -> dict[int, tuple[str, ca.SX]]:
    """Return the computed scalars that variables hold by their hash, under the first name of each."""
    kept = {n: v for n, v in variables.items() if n not in SKIPPED and _NAME.fullmatch(n)}
    plain = {n: v for n, v in kept.items() if isinstance(v, ca.SX) and v.is_scalar()}
    named: dict[int, tuple[str, ca.SX]] = {}
    for variable, held in (plain | kept).items():
        for name, expr in _scalars(variable.rstrip("_"), held, DEPTH):
            computed = not (expr.is_constant() or expr.is_symbolic())
            if computed and len(name) <= LONGEST and _NAME.fullmatch(name):
                named.setdefault(expr.element_hash(), (name, expr))
    return named


def _scalars(name: str, held: Any, depth: int) -> Iterator[tuple[str, ca.SX]]:
    """Yield the scalars in a variable under the names that they have there."""
    if isinstance(held, ca.SX):
        yield from _elements(name, held)
    elif depth:
        for key, item in _items(held).items():
            yield from _scalars(f"{name}_{key}", item, depth - 1)


def _elements(name: str, matrix: ca.SX) -> Iterator[tuple[str, ca.SX]]:
    rows, columns = matrix.shape
    if (rows, columns) == (1, 1):
        yield name, matrix
    elif max(rows, columns) <= LARGEST:
        for i in range(rows):
            for j in range(columns):
                index = f"{i + 1}{j + 1}" if min(rows, columns) > 1 else f"{max(i, j) + 1}"
                yield f"{name}_{index}", matrix[i, j]


def _items(held: Any) -> dict[str, Any]:
    if isinstance(held, Mapping):
        return {key: item for key, item in held.items() if isinstance(key, str)}
    if dataclasses.is_dataclass(held) and not isinstance(held, type):
        fields = {f.name: getattr(held, f.name) for f in dataclasses.fields(held)}
        return fields if all(isinstance(item, ca.SX | float | int) for item in fields.values()) else {}
    if isinstance(held, tuple | list):
        keys = getattr(held, "_fields", None) or [str(n) for n in range(1, len(held) + 1)]
        return dict(zip(keys, held, strict=True)) if len(held) <= LARGEST else {}
    return {}
