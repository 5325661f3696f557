"""Acceptance checks: a measured value and its upper limit."""

from collections.abc import Sequence
from dataclasses import dataclass

from synth import show


@dataclass(frozen=True)
class Check:
    """`found` <= `limit`, both in `unit`; `about` describes the measurement. NaN does not pass."""

    name: str
    found: float
    limit: float
    unit: str
    about: str = ""

    @property
    def passed(self) -> bool:
        """Return whether the value keeps its limit."""
        return bool(self.found <= self.limit)


def table(checks: Sequence[Check]) -> show.Table:
    """Return checks with their limits as a table."""
    rows = ((c.name, show.number(c.found), show.number(c.limit), c.unit, _verdict(c)) for c in checks)
    return show.Table(("check", "found", "limit", "unit", ""), tuple(rows))


def _verdict(check: Check) -> str:
    return "ok" if check.passed else "FAILED"
