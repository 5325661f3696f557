"""What the estimators of three sensors and of six degrees of freedom cost, in the report."""

from designs.hall_position.costs import Costs
from synth.report import page

TITLE = "Cost of three sensors and of six degrees of freedom"
COLUMNS = ("estimator", "build", "steps", "emitted C", "CasADi's C in float", "ratio")


def section(of: Costs) -> page.Section:
    """Return the most instructions of a sample, beside those of CasADi's C, or why nothing was measured."""
    if not of.rows:
        return page.Section(TITLE, (page.Text(of.absent),))
    rows = tuple((r.estimator, r.build, r.steps, r.own, r.rival, f"{r.ratio:.2f}") for r in of.rows)
    caption = "Most instructions a sample, emulated Cortex-M4F; instructions are not cycles"
    return page.Section(TITLE, (page.Table(caption, COLUMNS, rows, digits=6),))
