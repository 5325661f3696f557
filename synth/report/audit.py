"""Audit of a paper: printed values, recomputed values, and a verdict computed from both.

A row compares recomputed values v_i with the numbers that a paper prints. The verdict follows from two statements:

    R   reproduces: the values agree with the print under the formulas as printed
    RC  reproduces after the correction that `why` states: the values agree only with the corrected formulas
    N   does not reproduce: the values agree in neither case

A value v agrees with a printed number when |v - printed| is below one unit of the last printed digit. Both rounding and
truncation therefore count as agreement.

An audit is a file published.toml with the printed values, the rule of each verdict, and formulas that
recompute each row from parameters, printed numbers and functions of a `Scope`. In a formula a printed number denotes
its value, in a verdict the `Printed` object:

    [F-1.computed]
    stiffness = "mass * F-2.rate ** 2"
    frequency = ["sqrt(stiffness / mass) / (2 * pi)", "Hz", "frequency of the free stage"]
    as_printed = "F-1.frequency.agrees(frequency)"

Formulas of an audit: expressions of parameters, printed numbers, functions and preceding values.

    turns / Y-1.turn_density          a parameter divided by the number turn_density that row Y-1 prints
    sqrt(K_theta / Kz)                a function of FUNCTIONS, or one that the audit adds

An expression is a Python expression without comprehensions. The dependencies of a value follow from the names in its
expression and are not declared separately.
"""

import ast
import math
import re
import tomllib
from collections import ChainMap
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from decimal import Decimal, InvalidOperation
from enum import StrEnum
from functools import cache
from pathlib import Path
from types import CodeType, ModuleType
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


VERDICTS = ("as_printed", "corrected")  # the formulas of a row that decide whether its values agree with the print


class Verdict(StrEnum):
    """Reproduces, reproduces after the stated correction, does not reproduce."""

    REPRODUCES = "R"
    CORRECTED = "RC"
    FAILS = "N"


@dataclass(frozen=True)
class Printed:
    """A number as printed, digit for digit, in `unit`."""

    text: str
    unit: str

    @property
    def value(self) -> float:
        """The number."""
        return float(self.text)

    @property
    def last_digit(self) -> float:
        """One unit of the last printed digit."""
        exponent = Decimal(self.text).as_tuple().exponent
        return 10.0 ** int(exponent)

    def agrees(self, value: float) -> bool:
        """Return whether `value`, in the same unit, is the printed number after rounding or truncation."""
        return abs(value - self.value) < self.last_digit


@dataclass(frozen=True)
class Published:
    """The published content of one row: its place in the paper, its text, and its numbers by name.

    `rule` states how the verdict is decided and what explains a difference; it may be empty if a function computes the
    row. `computed` are the formulas by name, including the statements of the verdict, `as_printed` and `corrected`.
    """

    id: str
    paper: str
    where: str
    text: str
    numbers: Mapping[str, Printed]
    rule: str = ""
    computed: Mapping[str, Formula] = field(default_factory=dict)

    def __getitem__(self, name: str) -> Printed:
        """Return the printed number called `name`."""
        if name not in self.numbers:
            raise DesignError(f"row {self.id} prints no '{name}': it has {', '.join(self.numbers) or 'no number'}")
        return self.numbers[name]


@dataclass(frozen=True)
class Figure:
    """One recomputed value; the unit may carry a prefix (mm, um), as in the paper."""

    name: str
    value: float
    unit: str


@dataclass(frozen=True)
class Row:
    """One audited statement. `depends` names the parameters and printed numbers that the values depend on."""

    published: Published
    recomputed: tuple[Figure, ...]
    verdict: Verdict
    why: str
    depends: tuple[str, ...] = field(default=())

    @property
    def id(self) -> str:
        """The row's name, such as F-1."""
        return self.published.id

    def __getitem__(self, name: str) -> float:
        """Return the recomputed value called `name`."""
        for figure in self.recomputed:
            if figure.name == name:
                return figure.value
        known = ", ".join(f.name for f in self.recomputed)
        raise DesignError(f"row {self.id} recomputes no '{name}': it has {known}")

    def document(self) -> dict[str, Any]:
        """Return the row as JSON: unrounded values, null for NaN and infinity."""
        figures = [{"name": f.name, "value": _finite(f.value), "unit": f.unit} for f in self.recomputed]
        published = self.published
        return {
            "id": published.id,
            "paper": published.paper,
            "where": published.where,
            "published": published.text,
            "recomputed": figures,
            "verdict": str(self.verdict),
            "why": self.why,
        }


@dataclass(frozen=True, eq=False)
class Scope:
    """The names that formulas may use: parameters in SI units, functions and constants, and printed rows."""

    parameters: Mapping[str, float]
    functions: Mapping[str, Any]
    published: Mapping[str, Published]


def functions(*modules: ModuleType) -> dict[str, Any]:
    """Return the functions and classes that modules define, by name."""
    defined = (value for m in modules for value in vars(m).values() if getattr(value, "__module__", "") == m.__name__)
    return {value.__name__: value for value in defined}


def recompute(printed: Published, scope: Scope) -> Row:
    """Recompute a row by its formulas.

    Raises DesignError as `evaluate`.
    """
    numbers = {f"{id}.{n}": number for id, each in scope.published.items() for n, number in each.numbers.items()}
    of_values = {name: f for name, f in printed.computed.items() if name not in VERDICTS}
    names = {**scope.functions, **scope.parameters}
    values = evaluate(of_values, names, {source: number.value for source, number in numbers.items()})
    statements = (printed.computed.get(name, Formula("False")) for name in VERDICTS)
    verdict = judge(*(bool(statement.value(names | values, numbers)) for statement in statements))
    figures = [(f.what, values[name], f.unit) for name, f in of_values.items() if f.what]
    depends = sources(of_values) & {*scope.parameters, *numbers}
    return row(printed, figures, verdict, printed.rule, sorted(depends))


def rows(scope: Scope, ids: Iterable[str] | None = None) -> Iterator[Row]:
    """Yield the recomputed rows with the given `ids`, or all printed rows, as they are computed.

    Raises DesignError as `recompute`.
    """
    return (recompute(scope.published[id], scope) for id in (scope.published if ids is None else ids))


def judge(as_printed: bool, corrected: bool = False) -> Verdict:
    """Return the verdict for values that agree with the print `as_printed`, or only `corrected`, or not."""
    if as_printed:
        return Verdict.REPRODUCES
    return Verdict.CORRECTED if corrected else Verdict.FAILS


def row(
    published: Published,
    figures: Iterable[tuple[str, float, str]],
    verdict: Verdict,
    why: str,
    depends: Iterable[str] = (),
) -> Row:
    """Return a row from (name, value, unit) of each recomputed value.

    Raises DesignError when a name is listed twice or there is no value.
    """
    recomputed = tuple(Figure(name, float(value), unit) for name, value, unit in figures)
    known = [f.name for f in recomputed]
    if not known or len(set(known)) < len(known):
        raise DesignError(
            f"row {published.id} has the figures {known}: give at least one, and a different name for each"
        )
    return Row(published, recomputed, verdict, why, tuple(depends))


def parse_rows(text: str) -> dict[str, Published]:
    """Parse the rows of a published.toml: `[ID]` with paper, where, text, rule and numbers = {name = ["14.3", "%"]}.

    `rule`, `numbers` and `computed` = {name = "formula" or ["formula", "unit", "figure"]} may be omitted.

    Raises DesignError for a row without the other keys, or for text that is not a number.
    """
    return {name: _parse_row(name, entry) for name, entry in tomllib.loads(text).items()}


def read_rows(folder: Path) -> dict[str, Published]:
    """Read the published.toml of a folder, as `parse_rows`."""
    return parse_rows((folder / "published.toml").read_text(encoding="utf-8"))


def _parse_row(name: str, entry: Mapping[str, Any]) -> Published:
    if missing := [key for key in ("paper", "where", "text") if not entry.get(key)]:
        raise DesignError(f"published row {name} lacks {', '.join(missing)}: say what is printed, and where")
    numbers = {key: _parse_number(name, key, value) for key, value in entry.get("numbers", {}).items()}
    computed = {k: Formula(*[v] if isinstance(v, str) else v) for k, v in entry.get("computed", {}).items()}
    return Published(name, entry["paper"], entry["where"], entry["text"], numbers, entry.get("rule", ""), computed)


def _parse_number(name: str, key: str, value: Any) -> Printed:
    try:
        digits, unit = value
        number = Decimal(digits)
    except (TypeError, ValueError, InvalidOperation) as cause:
        raise DesignError(
            f'published row {name}: {key} = {value!r} is not a printed number: write ["14.3", "%"], digits in quotes'
        ) from cause
    if not (isinstance(digits, str) and isinstance(unit, str) and number.is_finite()):
        raise DesignError(f"published row {name}: {key} = {value!r} is not as printed: put the digits in quotes")
    return Printed(digits, unit)


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None
