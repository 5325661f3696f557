"""Names of the intermediate values of a law: those of the Python variables that hold them.

    def law(u, x, k):
        gap = u["y1"] - k["offset"]         gap
        force = {"x": ..., "z": ...}        force_x, force_z
        pair = Pair(sine, cosine)           pair_sine, pair_cosine, the fields of a dataclass or a NamedTuple
        J = ca.vertcat(...)                 J_1, J_2 of a vector, J_12 of a matrix
        for n in ("x", "z"):
            error = u[n] - x[n]             error_x, error_z
            place(u[n])                     ratio_x, ratio_z for `ratio` in place()

The functions that a law calls name values in the same way, and a name in the caller replaces one in a called function.
The names decide what locals are called in C and nothing else: a value that a later pass removes loses its name.
"""

import ast
import dataclasses
import inspect
import re
import sys
import textwrap
from collections.abc import Callable, Iterator, Mapping
from functools import cache
from types import CodeType, FrameType
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
SKIPPED = {"output", "next", "named", "computed", "result", "value", "values", "terms"} | {
    *("each", "expr", "exprs", "self", "v"),
}
_COMPREHENSIONS = ast.ListComp | ast.SetComp | ast.DictComp | ast.GeneratorExp
_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*")

Intermediates = tuple[tuple[str, ca.SX], ...]


def record(function: Callable[P, R], *args: P.args, **kwargs: P.kwargs) -> tuple[R, Intermediates]:
    """Return the result of a law and its intermediate values, scalar expressions with their names.

    Each expression is listed once.
    """
    names: dict[int, tuple[str, ca.SX]] = {}
    loops: dict[FrameType, _Loops] = {}

    def at_event(frame: FrameType, event: str, _: object) -> None:
        if event == "return" and computes(frame):
            running = loops.pop(frame, None)
            values = running.scalars(frame) if running else _computed_scalars(frame.f_locals)
            item = _item_of_call(frame)
            names.update({k: (_after_item(name, item), expr) for k, (name, expr) in values.items()})

    def at_call(frame: FrameType, event: str, _: object) -> Any:
        if not computes(frame) or not _loop_lines(frame.f_code):
            return None
        loops[frame] = _Loops(frame)
        return loops[frame].at_line

    profiler, tracer = sys.getprofile(), sys.gettrace()
    sys.setprofile(at_event)
    sys.settrace(at_call)
    try:
        result = function(*args, **kwargs)
    finally:
        sys.settrace(tracer)
        if profiler is None or callable(profiler):
            sys.setprofile(profiler)
        else:  # that of cProfile, which no call can set again
            profiler.enable()
    return result, tuple(names.values())


class _Loops:
    """The values that the `for` loops of a running function give to variables, one each iteration.

    The last value of a variable that exists before the loop, such as a sum, has the variable's own name.
    """

    def __init__(self, frame: FrameType) -> None:
        self.lines = _loop_lines(frame.f_code)
        self.line, self.bound = frame.f_lineno, dict(frame.f_locals)
        self.new: set[str] = set()
        self.each: dict[str, ca.SX] = {}
        self.updated: dict[str, ca.SX] = {}

    def at_line(self, frame: FrameType, event: str, _: object) -> Any:
        """Name what the line before has bound, while the loop's targets still have the values of its iteration."""
        if event == "line":
            self._name_bound(frame)
            self.line = frame.f_lineno
        return self.at_line

    def scalars(self, frame: FrameType) -> dict[int, tuple[str, ca.SX]]:
        """Return the computed scalars of the function by their hash, under their names."""
        self._name_bound(frame)
        outside = {n: v for n, v in frame.f_locals.items() if n not in self.new}
        return _computed_scalars(self.updated) | _computed_scalars(outside) | _computed_scalars(self.each)

    def _name_bound(self, frame: FrameType) -> None:
        changed = {n: v for n, v in frame.f_locals.items() if v is not self.bound.get(n)}
        loops = self.lines.get(self.line, ())
        suffix = "_".join(filter(None, (_item([frame.f_locals.get(t) for t in targets]) for targets in loops)))
        plain = [n for n, v in changed.items() if n not in SKIPPED and _is_computation(v)]
        for name in plain if suffix else ():
            self.new |= set() if name in self.bound else {name}
            values = self.each if name in self.new else self.updated
            values.setdefault(f"{name.rstrip('_')}_{suffix}", changed[name])
        self.bound |= changed


def _is_computation(value: object) -> bool:
    return isinstance(value, ca.SX) and value.is_scalar() and not (value.is_constant() or value.is_symbolic())


def _item_of_call(frame: FrameType) -> str:
    """Return the name of what the innermost loop or comprehension that calls a function runs over, "" without one."""
    inner: dict[str, object] = {}
    caller = frame.f_back
    while caller and caller.f_code is not record.__code__:
        if caller.f_code.co_name.startswith("<"):  # a comprehension, up to Python 3.11
            inner = {**caller.f_locals, **inner}
        else:
            variables = {**caller.f_locals, **inner}
            for targets in reversed(_running(caller)):
                if item := _item([variables.get(t) for t in targets]):
                    return item
            inner = {}
        caller = caller.f_back
    return ""


def _running(frame: FrameType) -> list[tuple[str, ...]]:
    """Return the targets of the loops and comprehensions around the call that a frame waits for."""
    repetitions = _repetitions(frame.f_code)
    if not repetitions:
        return []
    line, end_line, column, end_column = _positions(frame.f_code)[frame.f_lasti // 2]
    if line is None or end_line is None or column is None or end_column is None:
        return []
    call = (line, column), (end_line, end_column)
    return [r.targets for r in repetitions if r.first <= call[0] and call[1] <= r.last]


@cache
def _positions(code: CodeType) -> tuple[tuple[int | None, ...], ...]:
    return tuple(code.co_positions())


def _after_item(name: str, item: str) -> str:
    """Return the name followed by the item, where it does not hold the item already and stays short."""
    longer = f"{name}_{item}"
    return longer if item and item not in name.split("_") and len(longer) <= LONGEST else name


def _item(targets: list[object]) -> str:
    """Return the name of what a loop runs over: a target that is a text, else the name of one."""
    texts = [t for t in targets if isinstance(t, str)]
    names = [getattr(t, "name", None) for t in targets]
    return next(iter([*texts, *(n for n in names if isinstance(n, str))]), "")


@dataclasses.dataclass(frozen=True)
class _Repetition:
    """The body of a loop or a comprehension from `first` to `last`, line and column, and the targets of the loop."""

    first: tuple[int, int]
    last: tuple[int, int]
    targets: tuple[str, ...]
    is_loop: bool


@cache
def _repetitions(code: CodeType) -> tuple[_Repetition, ...]:
    """Return the loops and comprehensions of a function, outer ones first."""
    try:
        rows, above = inspect.getsourcelines(code)
        function = ast.parse(textwrap.dedent("".join(rows))).body[0]
    except (OSError, SyntaxError, IndexError):
        return ()
    indent = len(rows[0]) - len(rows[0].lstrip())
    repetitions = []
    for node in ast.walk(function):
        if isinstance(node, ast.For | _COMPREHENSIONS):
            is_loop = isinstance(node, ast.For)
            start = node.body[0] if isinstance(node, ast.For) else node
            first = start.lineno + above - 1, start.col_offset + indent
            last = (node.end_lineno or start.lineno) + above - 1, (node.end_col_offset or 0) + indent
            for loop in [node] if isinstance(node, ast.For) else node.generators:
                targets = tuple(n.id for n in ast.walk(loop.target) if isinstance(n, ast.Name))
                repetitions.append(_Repetition(first, last, targets, is_loop))
    return tuple(repetitions)


@cache
def _loop_lines(code: CodeType) -> dict[int, tuple[tuple[str, ...], ...]]:
    """Return the lines in the bodies of a function's loops, with the targets of each loop, the outermost first."""
    lines: dict[int, tuple[tuple[str, ...], ...]] = {}
    for loop in (r for r in _repetitions(code) if r.is_loop):
        for line in range(loop.first[0], loop.last[0] + 1):
            lines[line] = (*lines.get(line, ()), loop.targets)
    return lines


def computes(frame: FrameType) -> bool:
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
            if _is_computation(expr) and len(name) <= LONGEST and _NAME.fullmatch(name):
                named.setdefault(expr.element_hash(), (name, expr))
    return named


def _scalars(name: str, held: Any, depth: int) -> Iterator[tuple[str, ca.SX]]:
    """Yield the scalars in a variable under the names that they have there."""
    if isinstance(held, ca.SX):
        yield from _elements(name, held)
    elif depth:
        for key, item in items(held).items():
            yield from _scalars(key if key.startswith(f"{name}_") else f"{name}_{key}", item, depth - 1)


def _elements(name: str, matrix: ca.SX) -> Iterator[tuple[str, ca.SX]]:
    rows, columns = matrix.shape
    if (rows, columns) == (1, 1):
        yield name, matrix
    elif max(rows, columns) <= LARGEST:
        for i in range(rows):
            for j in range(columns):
                index = f"{i + 1}{j + 1}" if min(rows, columns) > 1 else f"{max(i, j) + 1}"
                yield f"{name}_{index}", matrix[i, j]


def items(held: Any) -> dict[str, Any]:
    """Return the items of a mapping with names, of a dataclass of scalars, or of a short sequence by their names."""
    if isinstance(held, Mapping):
        return {key: item for key, item in held.items() if isinstance(key, str)}
    if dataclasses.is_dataclass(held) and not isinstance(held, type):
        fields = {f.name: getattr(held, f.name) for f in dataclasses.fields(held)}
        return fields if all(isinstance(item, ca.SX | float | int) for item in fields.values()) else {}
    if isinstance(held, tuple | list):
        keys = getattr(held, "_fields", None) or [str(n) for n in range(1, len(held) + 1)]
        return dict(zip(keys, held, strict=True)) if len(held) <= LARGEST else {}
    return {}
