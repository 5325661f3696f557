"""Evaluation of a user's symbolic function, with errors that name the Block or plant.

The function runs once, before any signal has a value. `if u > 0`, `max(u, 0)` and `u > 0 and u < 1` need the truth
value of a symbol, which CasADi refuses; `math.sin(u)` needs a float and gets NaN.
"""

import traceback
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from numbers import Real
from typing import Any, ParamSpec, TypeVar

import casadi as ca

from synth import arguments
from synth.errors import SignalError

P = ParamSpec("P")
R = TypeVar("R")

DECISION = (
    "use ca.if_else(condition, value, otherwise) for `if`, ca.fmax and ca.fmin for max and min, ca.logic_and, "
    "ca.logic_or and ca.logic_not for `and`, `or` and `not`"
)
INDEX = "look a number up with block.table, and repeat with a count that is a number"


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
