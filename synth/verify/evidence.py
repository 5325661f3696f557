"""Verification evidence of a design: measured values with their limits."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

from synth.check import Check
from synth.verify.agree import Agreement


@dataclass(frozen=True)
class Evidence:
    """The agreements between witnesses and the checks that follow from them."""

    design: str
    agreements: Sequence[Agreement]
    checks: Sequence[Check]

    @property
    def passed(self) -> bool:
        """Whether every check passes."""
        return all(c.passed for c in self.checks)

    def document(self) -> Mapping[str, Any]:
        """Return the evidence as a JSON document."""
        return {
            "design": self.design,
            "passed": self.passed,
            "agreements": [asdict(a) for a in self.agreements],
            "checks": [asdict(c) | {"passed": c.passed} for c in self.checks],
        }
