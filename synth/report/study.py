"""Section on a study of tolerances: distribution, worst case, yield and driver of every figure."""

from synth import show
from synth.report import page
from synth.report.page import Section
from synth.simulate import study, worst_case
from synth.simulate.study import StudyTable, Summary
from synth.simulate.worst_case import WorstCase

TITLE = "Study of the tolerances"
ABOUT = (
    "The experiments run on machines within the tolerances of their parameters and sensors. Nominal: the machine "
    "without deviations. 95 %: the value that 95 % of the machines do not exceed. Row: the worst machine, which "
    "`synth study --row` runs alone. Kept: share of the machines that keep the limit. Driver: the quantity with the "
    "largest rank correlation (Spearman), |h| where deviations of h to both sides act alike."
)
COLUMNS = ("what", "unit", "nominal", "median", "95 %", "worst", "row", "limit", "kept", "driver")


def section(table: StudyTable, worst: WorstCase | None = None) -> Section:
    """Return the section: a table of what has limits, one of what has none, the yield, and the end of a search."""
    summaries = study.summarise(table)
    limited = tuple(_row(s) for s in summaries if s.name in table.limits)
    others = tuple(_row(s) for s in summaries if s.name not in table.limits)
    notes = page.Text("\n\n".join([*study.notes(table), *(worst_case.notes(worst) if worst else [])]))
    tables = (show.Table(f"Limits on {len(table.rows)} machines", COLUMNS, limited),) if limited else ()
    folded = (page.Folded("Values without a limit", (show.Table("Values", COLUMNS, others),)),) if others else ()
    return Section(TITLE, (page.Text(ABOUT), notes, *tables, *folded))


def page_text(name: str, table: StudyTable, worst: WorstCase | None = None) -> str:
    """Return a page with the section alone, as HTML."""
    return page.render(page.Report(name, f"Study of {len(table.rows)} machines", (section(table, worst),)))


def _row(s: Summary) -> tuple[show.Cell, ...]:
    has_limit = s.limit == s.limit
    limit, kept = (s.limit, f"{s.passed:.2%}") if has_limit else ("", "")
    driver = f"{s.driver} {s.correlation:+.2f}" if s.driver else ""
    return s.name, s.unit, s.nominal, s.median, s.percentile_95, s.worst, str(s.worst_row), limit, kept, driver
