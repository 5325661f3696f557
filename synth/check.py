"""Acceptance checks: a measured value and its upper limit."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from synth import show


@dataclass(frozen=True)
class Check:
    """`value` <= `limit`, both in `unit`; `about` describes the measurement. NaN does not pass."""

    name: str
    value: float
    limit: float
    unit: str
    about: str = ""

    @property
    def passed(self) -> bool:
        """Return whether the value keeps its limit."""
        return bool(self.value <= self.limit)

    def document(self) -> dict[str, Any]:
        """Return the fields for JSON, where the measured value is called "found"."""
        return {
            "name": self.name,
            "found": self.value,
            "limit": self.limit,
            "unit": self.unit,
            "about": self.about,
        }


def table(checks: Sequence[Check]) -> show.Table:
    """Return checks with their limits as a table."""
    rows = ((c.name, show.number(c.value), show.number(c.limit), c.unit, _verdict(c)) for c in checks)
    return show.Table(("check", "found", "limit", "unit", ""), tuple(rows))


def _verdict(check: Check) -> str:
    return "ok" if check.passed else "FAILED"
