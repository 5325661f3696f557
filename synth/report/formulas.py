"""Formulas of an audit: expressions of parameters, printed numbers, functions and preceding values.

    turns / Y-1.turn_density          a parameter divided by the number turn_density that row Y-1 prints
    sqrt(K_theta / Kz)                a function of FUNCTIONS, or one that the audit adds

An expression is a Python expression without comprehensions. The dependencies of a value follow from the names in its
expression and are not declared separately.
"""

import ast
import math
import re
from collections import ChainMap
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from types import CodeType
from typing import Any

from synth.errors import DesignError


def is_close(value: float, relative: float, *others: float) -> bool:
    """Return whether a value differs from each of the others by less than the fraction `relative`."""
    return all(abs(value / other - 1) < relative for other in others)


_OF_MATH = ("asin", "cos", "degrees", "exp", "floor", "log", "log10", "pi", "sin", "sqrt")
FUNCTIONS: Mapping[str, Any] = {
    **{f.__name__: f for f in (abs, all, any, dict, len, max, min, is_close, round)},
    **{name: getattr(math, name) for name in _OF_MATH},
}
_PRINTED = re.compile(r"\b([A-Z]+-\w+\.\w+)")


@dataclass(frozen=True)
class Formula:
    """An expression; with a displayed name `what` and a unit it is a figure of the audit."""

    text: str
    unit: str = ""
    what: str = ""

    @property
    def identifiers(self) -> frozenset[str]:
        """Names in the expression: parameters, functions, other values and printed numbers such as F-1.mass."""
        tree = ast.parse(_PRINTED.sub("printed", self.text), mode="eval")
        return frozenset(_PRINTED.findall(self.text)) | {n.id for n in ast.walk(tree) if isinstance(n, ast.Name)}

    def value(self, names: Mapping[str, Any], printed: Mapping[str, Any]) -> Any:
        """Return the value for names and printed numbers by "F-1.mass".

        Raises DesignError for an unknown name, a number that is not printed, and text that is not an expression.
        """
        if absent := [source for source in _PRINTED.findall(self.text) if source not in printed]:
            raise DesignError(
                f"the formula '{self.text}' names {absent[0]}, which is not printed: use one of {', '.join(printed)}"
            )
        known = ChainMap({"printed": printed}, dict(names), dict(FUNCTIONS))
        try:
            return eval(_code(self.text), {"__builtins__": {}}, known)
        except NameError as cause:
            raise DesignError(
                f"the formula '{self.text}' names '{cause.name}', which is neither a value above it nor a parameter: "
                f"use one of {', '.join(known)}"
            ) from cause


@cache
def _code(text: str) -> CodeType:
    """Compile an expression, with F-1.mass replaced by printed["F-1.mass"]."""
    try:
        return compile(_PRINTED.sub(r'printed["\1"]', text), text, "eval")
    except SyntaxError as cause:
        raise DesignError(f"the formula '{text}' is not an expression: {cause.msg}; mend it") from cause


def evaluate(formulas: Mapping[str, Formula], names: Mapping[str, Any], printed: Mapping[str, Any]) -> dict[str, Any]:
    """Return the values of formulas by name; each may use the preceding ones.

    Raises DesignError as `Formula.value`.
    """
    values: dict[str, Any] = {}
    for name, formula in formulas.items():
        values[name] = formula.value(ChainMap(values, dict(names)), printed)
    return values


def sources(formulas: Mapping[str, Formula]) -> frozenset[str]:
    """Return the names that the figures among the formulas depend on, directly or through other values."""
    reached: dict[str, frozenset[str]] = {}
    for name, formula in formulas.items():
        reached[name] = frozenset().union(*(reached.get(n, {n}) for n in formula.identifiers))
    return frozenset().union(*(reached[name] for name, formula in formulas.items() if formula.what))
