"""Audit of a paper: printed values, recomputed values, and a verdict computed from both.

A row compares recomputed values v_i with the numbers that a paper prints. The verdict follows from two statements:

    R   reproduces: the values agree with the print under the formulas as printed
    RC  reproduces after the correction that `why` states: the values agree only with the corrected formulas
    N   does not reproduce: the values agree in neither case

A value v agrees with a printed number when |v - printed| is below one unit of the last printed digit. Both rounding and
truncation therefore count as agreement.

An audit is a file published.toml with the printed values, the rule of each verdict, and formulas (`formulas`) that
recompute each row from parameters, printed numbers and functions of a `Scope`. In a formula a printed number denotes
its value, in a verdict the `Printed` object:

    [F-1.computed]
    stiffness = "mass * F-2.rate ** 2"
    frequency = ["sqrt(stiffness / mass) / (2 * pi)", "Hz", "frequency of the free stage"]
    as_printed = "F-1.frequency.agrees(frequency)"
"""

import math
import tomllib
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from decimal import Decimal, InvalidOperation
from enum import StrEnum
from pathlib import Path
from types import ModuleType
from typing import Any

from synth.errors import DesignError
from synth.report import formulas
from synth.report.formulas import Formula

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

    Raises DesignError as `formulas.evaluate`.
    """
    numbers = {f"{id}.{n}": number for id, each in scope.published.items() for n, number in each.numbers.items()}
    of_values = {name: f for name, f in printed.computed.items() if name not in VERDICTS}
    names = {**scope.functions, **scope.parameters}
    values = formulas.evaluate(of_values, names, {source: number.value for source, number in numbers.items()})
    statements = (printed.computed.get(name, Formula("False")) for name in VERDICTS)
    verdict = judge(*(bool(statement.value(names | values, numbers)) for statement in statements))
    figures = [(f.what, values[name], f.unit) for name, f in of_values.items() if f.what]
    depends = formulas.sources(of_values) & {*scope.parameters, *numbers}
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
