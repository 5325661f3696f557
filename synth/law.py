"""Evaluation of a user's symbolic function, with errors that name the Block or plant, and names of its expressions.

The function runs once, before any signal has a value. `if u > 0`, `max(u, 0)` and `u > 0 and u < 1` need the truth
value of a symbol, which CasADi refuses; `math.sin(u)` needs a float and gets NaN.

    error = u["r"] - u["y"]
    label(error=error)          the C computes `error`, too
    call("gap", gap, x, u)      gap(x, u): the C has a function `gap` for it, too
"""

import dataclasses
import traceback
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextvars import ContextVar
from numbers import Real
from typing import Any, ParamSpec, TypeVar

import casadi as ca

from synth import arguments
from synth.errors import SignalError
from synth.signals import identifier

P = ParamSpec("P")
R = TypeVar("R")
Labels = tuple[tuple[str, ca.SX], ...]

DECISION = (
    "use ca.if_else(condition, value, otherwise) for `if`, ca.fmax and ca.fmin for max and min, ca.logic_and, "
    "ca.logic_or and ca.logic_not for `and`, `or` and `not`"
)
INDEX = "look a number up with block.table, and repeat with a count that is a number"
ONE_DIGIT = 9  # rows or columns of a matrix whose elements have both indices without an underscore between them


@dataclasses.dataclass(frozen=True, eq=False)
class Function:
    """A function of a law for which the C has one: `path` is its name after those of the functions that call it."""

    path: str
    arguments: tuple[ca.SX, ...]
    results: tuple[ca.SX, ...]


@dataclasses.dataclass(eq=False)
class Record:
    """What a law says about its C: the labels of its expressions by their hash, and its functions by their paths."""

    labels: dict[int, tuple[str, ca.SX]] = dataclasses.field(default_factory=dict)
    functions: dict[str, Function] = dataclasses.field(default_factory=dict)
    path: str = ""


_RECORD: ContextVar[Record | None] = ContextVar("record", default=None)


class NamedSymbols(dict[str, ca.SX]):
    """Symbols by name; `what` names their owner in the error for an unknown name."""

    def __init__(self, what: str, symbols: Mapping[str, ca.SX]) -> None:
        super().__init__(symbols)
        self.what = what

    def __missing__(self, name: str) -> ca.SX:
        raise SignalError(f"{self.what} has no {name!r}: it has {', '.join(self) or 'none'}")


def column(what: str, symbols: Mapping[str, ca.SX], names: Iterable[str]) -> ca.SX:
    """Return the symbols of `names` as a column; raise SignalError, calling them `what`, where one is missing."""
    listed = list(names)
    for name in listed:
        symbol = symbols.get(name)
        if not isinstance(symbol, ca.SX) or not symbol.is_symbolic():
            raise SignalError(
                f"{what} have no symbol for '{name}': give a scalar SX symbol for each of {', '.join(listed)}"
            )
    return ca.vcat([symbols[name] for name in listed])


def require_names(what: str, expected: Sequence[str], names: Collection[str]) -> None:
    """Raise SignalError, calling them `what`, unless `names` are the `expected` ones."""
    missing, unknown = [n for n in expected if n not in names], [n for n in names if n not in expected]
    if missing or unknown:
        raise SignalError(
            f"{what}: missing {missing or 'none'}, not declared {unknown or 'none'}: give one for each signal"
        )


def evaluate(what: str, function: Callable[P, R], *args: P.args, **kwargs: P.kwargs) -> R:
    """Return the result of a user's function of symbols.

    Raises SignalError, naming `what`, the line and the function of CasADi to use instead, where Python needs the value
    of a symbol.
    """
    try:
        return function(*args, **kwargs)
    except (RuntimeError, TypeError) as error:
        if isinstance(error, TypeError) and error.__traceback__ is not None and error.__traceback__.tb_next is None:
            raise SignalError(
                f"{what} cannot be called with {len(args)} arguments ({error}): give it one for each"
            ) from error
        if remedy := _remedy(str(error)):
            raise SignalError(f"{what} needs the value of a symbol{_line(error)}: {remedy}") from error
        raise


def record(function: Callable[P, R], *args: P.args, **kwargs: P.kwargs) -> tuple[R, Labels, tuple[Function, ...]]:
    """Return the result of a law, the scalar expressions that it labels with their names, and its functions."""
    made = Record()
    token = _RECORD.set(made)
    try:
        return function(*args, **kwargs), tuple(made.labels.values()), tuple(made.functions.values())
    finally:
        _RECORD.reset(token)


def call(name: str, function: Callable[P, R], *args: P.args, **kwargs: P.kwargs) -> R:
    """Return function(*args, **kwargs), the expressions of a part of a law for which the C has a function `name`.

    Expressions in the arguments become its arguments, and those in the result its results: SX, or mappings, sequences
    and dataclasses of them. Calls whose names differ in a word, as ``sensor_a`` and ``sensor_b``, share one function in
    the C where they compute the same of different arguments. A function may call others. Outside the law of a Block it
    is a plain call. The values are the same as without it; MATLAB Coder: `coder.inline('never')`.

    Raises SignalError for a name that is no identifier of C, and for a second call of this name in a law or a function.
    """
    identifier("function", name)
    made = _RECORD.get()
    if made is None:
        return function(*args, **kwargs)
    outer, path = made.path, f"{made.path}.{name}".removeprefix(".")
    if path in made.functions:
        raise SignalError(f"function '{name}' is called twice: give each call a name, as '{name}_a' and '{name}_b'")
    made.functions[path] = Function(path, tuple(_expressions((args, kwargs))), ())
    made.path = path
    try:
        result = function(*args, **kwargs)
    finally:
        made.path = outer
    made.functions[path] = dataclasses.replace(made.functions[path], results=tuple(_expressions(result)))
    return result


def _expressions(value: Any) -> Iterator[ca.SX]:
    """Yield the scalar expressions in a value that compute something."""
    if isinstance(value, ca.SX):
        elements = (value[i, j] for i in range(value.shape[0]) for j in range(value.shape[1]))
        yield from (e for e in elements if not (e.is_constant() or e.is_symbolic()))
    elif isinstance(value, Mapping | tuple | list) or (dataclasses.is_dataclass(value) and not isinstance(value, type)):
        for item in _items(value).values():
            yield from _expressions(item)


@arguments.checked
def label(*of: str, **expressions: Any) -> None:
    """Name expressions of a law for its C, in which the variables that hold them then have these names.

        label(error=error)                      error
        label("x", error=error)                 error_x
        label(force={"x": f_x, "z": f_z})       force_x, force_z; so do the fields of a dataclass
        label(J=ca.vertcat(a, b))               J_1, J_2; so do the items of a list, and J_12 is one of a matrix

    The last name of an expression counts: a law renames what its functions have named. Inputs, states, constants and
    numbers keep their own names. Outside the law of a Block nothing happens.

    Raises SignalError for a name that is no identifier of C, and for what is no expression of CasADi's SX.
    """
    made = _RECORD.get()
    for name, value in expressions.items():
        for full_name, expr in _scalars("_".join((name, *of)), value):
            identifier("label", full_name)
            if made is not None and not (expr.is_constant() or expr.is_symbolic()):
                made.labels[expr.element_hash()] = full_name, expr


def _scalars(name: str, value: Any) -> Iterator[tuple[str, ca.SX]]:
    """Yield the scalar expressions of a value with their names."""
    if isinstance(value, ca.SX):
        yield from _elements(name, value)
    elif isinstance(value, Mapping | tuple | list) or (dataclasses.is_dataclass(value) and not isinstance(value, type)):
        for key, item in _items(value).items():
            yield from _scalars(key if key.startswith(f"{name}_") else f"{name}_{key}", item)
    elif not isinstance(value, Real):
        raise SignalError(f"label '{name}' is of {arguments.describe(value)}: give expressions of CasADi's SX")


def _items(value: Any) -> dict[str, Any]:
    if isinstance(value, Mapping):
        return {str(key): item for key, item in value.items()}
    if isinstance(value, tuple | list):
        keys = getattr(value, "_fields", None) or [str(n) for n in range(1, len(value) + 1)]
        return dict(zip(keys, value, strict=True))
    return {f.name: getattr(value, f.name) for f in dataclasses.fields(value)}


def _elements(name: str, matrix: ca.SX) -> Iterator[tuple[str, ca.SX]]:
    rows, columns = matrix.shape
    between = "" if max(rows, columns) <= ONE_DIGIT else "_"
    for i in range(rows):
        for j in range(columns):
            index = f"{i + 1}{between}{j + 1}" if min(rows, columns) > 1 else f"{max(i, j) + 1}"
            yield (name if rows == columns == 1 else f"{name}_{index}"), matrix[i, j]


def _remedy(message: str) -> str:
    if "truth value" in message or any(f"{operator}: 'SX'" in message for operator in ("&", "|", "~")):
        return DECISION
    return INDEX if "to_int not defined" in message or "SX" in message else ""


def _line(error: Exception) -> str:
    """Return the last line of the user's own code that ran, as text."""
    frames = [f for f in traceback.extract_tb(error.__traceback__)[1:] if "casadi" not in f.filename and f.line]
    return f" in line {frames[-1].lineno}, `{frames[-1].line}`" if frames else ""


def check_numbers(what: str, exprs: Mapping[str, ca.SX], symbols: Iterable[ca.SX]) -> None:
    """Raise SignalError, naming `what` and the expression, that computes with NaN; ca.if_else may select NaN."""
    symbols = list(symbols)
    if not _has_nan(list(exprs.values()), symbols):  # most of what they compute is shared
        return
    for name, expr in exprs.items():
        if _has_nan([expr], symbols):
            raise SignalError(
                f"{what} computes '{name}' with NaN, the result of a function of Python's math for a symbol: use "
                "CasADi's, like ca.sin(u) for math.sin(u)"
            )


def scalars(what: str, values: Mapping[str, Any]) -> dict[str, ca.SX]:
    """Return scalar expressions; raise SignalError, naming `what` and the value, for anything else."""
    made: dict[str, ca.SX] = {}
    for name, value in values.items():
        is_number = isinstance(value, Real) and not isinstance(value, bool)
        if not (isinstance(value, ca.SX | ca.DM) and value.shape == (1, 1)) and not is_number:
            size = f" of shape {value.shape}" if isinstance(value, ca.SX | ca.DM | ca.MX) else ""
            raise SignalError(
                f"{what} gives '{name}' the value {arguments.describe(value)}{size}: give a scalar expression of "
                "CasADi's SX, or a number"
            )
        made[name] = ca.SX(value)
    return made


def check_symbols(what: str, exprs: Sequence[ca.SX], symbols: Iterable[ca.SX]) -> None:
    """Raise SignalError, naming `what` and the symbol, unless the expressions contain `symbols` alone."""
    for v in foreign_symbols(ca.vcat(exprs), symbols) if exprs else []:
        raise SignalError(f"{what} uses '{v}', which is none of its inputs, states or constants: declare it")


def foreign_symbols(expr: ca.SX, symbols: Iterable[ca.SX]) -> list[ca.SX]:
    """Return the symbols in `expr` that are none of `symbols`, which are compared by identity."""
    known = {s.element_hash() for s in symbols}
    return [v for v in ca.symvar(expr) if v.element_hash() not in known]


def _has_nan(exprs: Sequence[ca.SX], symbols: Sequence[ca.SX]) -> bool:
    """Return whether one of the expressions computes with NaN."""
    f = ca.Function("f", list(symbols), [ca.SX(e) for e in exprs], {"allow_free": True})
    unset: set[int] = set()  # registers that hold NaN; only a selection by ca.if_else may read them
    for k in range(f.n_instructions()):
        operation, used, made = f.instruction_id(k), f.instruction_input(k), f.instruction_output(k)
        if operation == ca.OP_CONST:
            value = f.instruction_constant(k)
            (unset.add if value != value else unset.discard)(made[0])
            continue
        if operation not in (ca.OP_INPUT, ca.OP_IF_ELSE_ZERO) and not unset.isdisjoint(used):
            return True
        if operation != ca.OP_OUTPUT:
            unset.difference_update(made)
    return False
