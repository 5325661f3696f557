"""First screen of a report: every requirement with its worst value, its limit, its margin, and where that is.

    margin    what is left of the limit, relative to it: (limit - value) / |limit|

Every check of a build is in one row. A check that fails has its own row, and these come first. Checks of one name
that pass share a row, and so do all of a group with many names: it shows the one with the least margin. A value without
a limit says so.
"""

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from html import unescape
from importlib import resources

import jinja2
from markupsafe import Markup

from synth.check import Check
from synth.report.notation import number, quantities, readable

LOOPS, EXPERIMENTS, AUDIT = "Loops and margins", "Experiments", "Audit of the paper"
FAULTS, STUDY = "What faults do to the machine", "Study of the tolerances"
VERIFICATION, COST = "Verification", "Cost"
MANY = 9  # names of passed checks in a group, of which more share one row
COLUMNS = ("requirement", "worst value", "limit", "margin", "where")
_PLACE = re.compile(r'<section id="first-screen">.*?</section>', re.DOTALL)
_HEADING = re.compile(r'<h\d id="(s[\d-]+)">[\d.]+ (.*?)</h\d>')
Groups = Sequence[tuple[str, Sequence[Check]]]  # titles of sections, which may repeat, with their checks


@dataclass(frozen=True)
class Row:
    """A row: the `checks` that it stands for, the one with the least margin first, and the title of their section."""

    checks: tuple[Check, ...]
    section: str

    @property
    def worst(self) -> Check:
        """The check with the least margin."""
        return self.checks[0]

    @property
    def cells(self) -> tuple[str, ...]:
        """The texts under COLUMNS."""
        c, (value, limit) = self.worst, quantities((self.worst.value, self.worst.limit), self.worst.unit)
        bound = "no limit" if c.verdict == "no limit" else f"at {'least' if c.at_least else 'most'} {limit}"
        return self._title, value, bound, margin_text(c), c.about

    @property
    def _title(self) -> str:
        """The name of the check with the least margin, and how many others the row stands for."""
        name, n, free = readable(self.worst.name), len(self.checks), sum(c.verdict == "no limit" for c in self.checks)
        if n == 1:
            return name
        without = f", {free} without a limit" if 0 < free < n else ""
        if len({c.name for c in self.checks}) == 1:
            return f"{name}, worst of {n}{without}"
        return f"{self.section}: {n} checks{without}; least margin: {name}"


def margin(check: Check) -> float:
    """Return what is left of the limit, as a fraction of it: NaN for no value, inf where there is no limit.

    A limit of 0 has no fractions: what keeps it has the margin inf, what does not -inf.
    """
    left = check.value - check.limit if check.at_least else check.limit - check.value
    if check.verdict == "no limit":
        return math.inf
    if math.isnan(left):
        return math.nan
    return left / abs(check.limit) if check.limit else math.inf if check.passed else -math.inf


def margin_text(check: Check) -> str:
    """Return the margin as text: what is left of the limit, or by how much it is missed, in per cent."""
    fraction = margin(check)
    if math.isnan(fraction):
        return "not measured"
    if math.isinf(fraction):
        return "" if check.passed else "missed"
    if fraction < -1:
        return f"missed, {number(check.value / check.limit, 2)} times the limit"
    percent = 100 * abs(fraction)
    share = f"{percent:.0f} %" if percent >= 10 else f"{number(percent, 2)} %"
    return f"{share} left" if check.passed else f"missed by {share}"


def rows(groups: Groups) -> tuple[Row, ...]:
    """Return the rows of all checks: those that fail, then the others in the order of the groups."""
    failed = [Row((c,), section) for section, checks in groups for c in checks if not c.passed]
    others = [row for section, checks in groups for row in _passed(section, [c for c in checks if c.passed])]
    return (*failed, *others)


def _passed(section: str, checks: Sequence[Check]) -> list[Row]:
    """Return a row for each name, or where these are many one row."""
    by_name: dict[str, list[Check]] = {}
    for c in sorted(checks, key=margin):
        by_name.setdefault(c.name, []).append(c)
    if len(by_name) > MANY:
        return [Row(tuple(sorted(checks, key=margin)), section)]
    return [Row(tuple(by_name[name]), section) for name in dict.fromkeys(c.name for c in checks)]


def worst(rows: Sequence[Row], count: int) -> list[Row]:
    """Return the rows that fail, and of the others up to `count` with the least margins."""
    limited = [row for row in rows if row.worst.passed and math.isfinite(margin(row.worst))]
    return [*(row for row in rows if not row.worst.passed), *sorted(limited, key=lambda r: margin(r.worst))[:count]]


def counts(rows: Sequence[Row]) -> tuple[int, int, int]:
    """Return the numbers of checks with a limit, of those that fail, and of values without a limit."""
    checks = [c for row in rows for c in row.checks]
    free = sum(c.verdict == "no limit" for c in checks)
    return len(checks) - free, sum(not c.passed for c in checks), free


def headline(rows: Sequence[Row]) -> str:
    """Return the verdict on all rows as one sentence."""
    limited, failed, free = counts(rows)
    values = f"{number(free)} value{'s' if free != 1 else ''} without a limit"
    if failed:
        return f"{number(failed)} of {number(limited)} requirements missed; {values}"
    return f"all {number(limited)} requirements kept; {values}"


def section(rows: Sequence[Row], ids: Mapping[str, str], version: str = "") -> Markup:
    """Return the screen as HTML; `ids` are the anchors of the sections by title, `version` is that of the sources."""
    environment = jinja2.Environment(
        autoescape=True, undefined=jinja2.StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    template = resources.files(__package__).joinpath("first_screen.html.j2").read_text(encoding="utf-8")
    failed = counts(rows)[1]
    screen = environment.from_string(template).render(
        rows=rows, ids=ids, version=version, columns=COLUMNS, headline=headline(rows), failed=failed
    )
    return Markup(screen)


def put(html: str, rows: Sequence[Row], version: str) -> str:
    """Return a page with the screen of these rows in the place of its own, or else at its beginning."""
    ids = {unescape(title): place for place, title in _HEADING.findall(html)}
    screen = section(rows, ids, version)
    if _PLACE.search(html):
        return _PLACE.sub(lambda _: screen, html, count=1)
    return f"{screen}\n{html}"
