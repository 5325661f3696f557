"""Checks: a measured figure beside the limit that it must not exceed."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Check:
    """`found` <= `limit`, both in `unit`; `about` says what was measured and how. NaN does not pass."""

    name: str
    found: float
    limit: float
    unit: str
    about: str = ""

    @property
    def passed(self) -> bool:
        """Whether the figure keeps its limit."""
        return bool(self.found <= self.limit)
