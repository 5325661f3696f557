"""Parser of Frama-C's report of an Eva analysis: proved claims, alarms, unproved claims, trusted contracts."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

HARNESS = "synth_eva.c"


@dataclass(frozen=True)
class Analysis:
    """Properties as text; a property has the same text in every analysis of a harness."""

    proved: frozenset[str]
    alarms: frozenset[str]
    unproved: frozenset[str]
    trusted: frozenset[str]

    @property
    def open(self) -> frozenset[str]:
        """The alarms and the claims that are not proved."""
        return self.alarms | self.unproved


def read(rows: Sequence[Mapping[str, str]], log: str) -> Analysis:
    """Sort the properties of Frama-C into proved claims, alarms and unproved claims."""
    admitted = [row for row in rows if row["property kind"] == "user hypothesis"]
    source_rows = [row for row in rows if not row["directory"].startswith("FRAMAC_SHARE") and row not in admitted]
    ends = [row for row in source_rows if row["property"] == "\\false" and row["file"] == HARNESS]
    claims = [row for row in source_rows if row["property kind"] == "user check" and row not in ends]
    others = [
        row for row in source_rows if row not in claims and row not in ends and row["status"] not in ("Valid", "Dead")
    ]
    alarms = [row for row in others if not row["property kind"].startswith("precondition")]
    unproved = [row for row in claims if row["status"] != "Valid"] + [row for row in others if row not in alarms]
    # Eva must refute the false claim at the end: if the end were unreachable, every claim there would hold.
    reached = [row["status"] for row in ends] == ["Invalid or unreachable"]
    return Analysis(
        proved=frozenset(property_text(row) for row in claims if row["status"] == "Valid"),
        alarms=frozenset(map(property_text, alarms)),
        unproved=frozenset(map(property_text, unproved)) | (frozenset() if reached else {"the end is never reached"}),
        trusted=_trusted_functions(log),
    )


def _trusted_functions(log: str) -> frozenset[str]:
    marker = "using specification for function "
    functions = [line.split(marker)[1].strip() for line in log.splitlines() if marker in line]
    return frozenset(name for name in functions if not name.startswith("Frama_C_"))


def property_text(row: Mapping[str, str]) -> str:
    """Return a property of the report as text."""
    return f"{row['file']}:{row['line']}: {row['property kind']}: {row['property']}"
