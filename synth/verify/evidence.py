"""Verification evidence of a design: measured values with their limits."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any

from synth import check as checks
from synth import show
from synth.analyse.loops.robustness import Survey
from synth.check import Check
from synth.simulate import study_table
from synth.simulate.faults.fault_rows import Campaign
from synth.simulate.study import StudyTable
from synth.verify.agree import Agreement


@show.with_repr
@dataclass(frozen=True, repr=False)
class Evidence:
    """Agreements between witnesses and the checks that follow from them; what else a build measured, where it did.

    `loops` are the loops with their margins, `faults` the campaign, `study` the study. `verdicts` are the checks that
    the toolkit makes of these and of audit and cost, by title of the section of the report that shows them.
    """

    design: str
    agreements: Sequence[Agreement]
    checks: Sequence[Check]
    faults: Campaign | None = None
    study: StudyTable | None = None
    loops: Survey | None = None
    verdicts: Mapping[str, Sequence[Check]] = field(default_factory=dict)

    def sheet(self) -> show.Sheet:
        """Return the checks and the agreements."""
        failed = sum(not c.passed for c in self.checks)
        title = f"Evidence of {self.design}: {len(self.checks)} checks, {failed} failed"
        agreements = (
            (f"{a.first}, {a.second}", a.what, str(a.samples), show.number(a.worst), a.signal) for a in self.agreements
        )
        columns = ("witnesses", "compared", "samples", "worst difference", "signal")
        tables = [checks.table(self.checks), show.Table(columns, tuple(agreements))]
        return show.Sheet(title, tables=tuple(t for t in tables if t.rows))

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
            "checks": [c.document() for c in self.checks],
            **({"faults": self.faults.document()} if self.faults else {}),
            **({"study": study_table.document(self.study)} if self.study else {}),
        }
