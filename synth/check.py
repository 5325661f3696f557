"""Acceptance checks: a measured value, its limit, and the verdict.

    value <= limit, or value >= limit where it is to be at least the limit
    a limit of infinity is none: the value is shown with the verdict "no limit"

What raises an error keeps none of its limits: `of_error` is the failed check that names it. `Incomplete` carries what
was computed beside the parts that raised errors.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf, isinf
from typing import Any

from synth import show
from synth.errors import SynthError, design_lines

NO_LIMIT = inf


@dataclass(frozen=True)
class Check:
    """`value` <= `limit`, or `value` >= `limit` with `at_least`, in `unit`; `about` describes the measurement.

    An infinite limit is none. NaN passes no other.
    """

    name: str
    value: float
    limit: float
    unit: str
    about: str = ""
    at_least: bool = False

    @property
    def passed(self) -> bool:
        """Return whether the value keeps its limit, which it does where there is none."""
        return isinf(self.limit) or bool(self.value >= self.limit if self.at_least else self.value <= self.limit)

    @property
    def verdict(self) -> str:
        """Return "ok", "FAILED", or "no limit"."""
        return "no limit" if isinf(self.limit) else "ok" if self.passed else "FAILED"

    def document(self) -> dict[str, Any]:
        """Return the fields for JSON, where the measured value is called "found"."""
        return {
            "name": self.name,
            "found": self.value,
            "limit": self.limit,
            "at_least": self.at_least,
            "unit": self.unit,
            "about": self.about,
            "verdict": self.verdict,
            "passed": self.passed,
        }


class Incomplete(Exception):
    """Parts of a computation raised errors: `value` is what was computed of the others, `checks` name those parts."""

    def __init__(self, value: Any, checks: Sequence[Check]) -> None:
        """Keep the value and the failed checks."""
        super().__init__("; ".join(f"{c.name}: {c.about}" for c in checks))
        self.value, self.checks = value, tuple(checks)


def of_error(part: str, error: BaseException) -> Check:
    """Return the failed check of a part that raised an error."""
    return Check(f"errors of {part}", 1.0, 0.0, "1", describe(error))


def describe(error: BaseException) -> str:
    """Return an error as text: its notes, which name the input, what it says, and the line of the design."""
    kind = "" if isinstance(error, SynthError) else f"{type(error).__name__}: "
    places = [line for line in design_lines(error) if line][-1:]
    return "; ".join([*getattr(error, "__notes__", ()), f"{kind}{error}", *(f"at {line}" for line in places)])


def table(checks: Sequence[Check]) -> show.Table:
    """Return checks with their limits as a table."""
    rows = ((c.name, show.number(c.value), limit_text(c), c.unit, c.verdict) for c in checks)
    return show.Table("", ("check", "found", "limit", "unit", ""), tuple(rows))


def limit_text(check: Check) -> str:
    """Return the limit as text: a number, "at least" a number, or nothing where there is none."""
    if isinf(check.limit):
        return ""
    return f"at least {show.number(check.limit)}" if check.at_least else show.number(check.limit)
