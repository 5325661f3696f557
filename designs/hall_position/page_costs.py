"""The report's part on what the estimators of three sensors and of six degrees of freedom cost."""

from designs.hall_position.costs import Costs
from synth.report import page

COLUMNS = (
    *("estimator", "build", "steps", "most instructions, emitted C"),
    *("most instructions, CasADi's C in float", "ratio"),
)


def section(found: Costs) -> page.Section:
    """Return the most instructions of a sample, beside those of CasADi's C, or why nothing was measured."""
    title = "Cost of three sensors and of six degrees of freedom"
    if not found.rows:
        return page.Section(title, (page.Text(found.absent),))
    text = page.Text(
        "Both texts are of one block, take the same steps and are compiled alike. The steps are of motions, some with "
        "states drawn anew, and of states and inputs drawn at random. Shown is the costliest of them for each text; "
        "the ratio is that of the two figures. These are instructions, not cycles, counted on the steps that were run, "
        "which is no bound of the worst case. Contracted: a product and a sum may be rounded once. The C of three "
        "sensors is that under Files; that of six degrees of freedom was emitted for this table and does not ship."
    )
    rows = tuple((r.estimator, r.build, r.steps, r.own, r.rival, f"{r.ratio:.2f}") for r in found.rows)
    caption = "Most instructions a sample, emulated Cortex-M4F; instructions are not cycles"
    return page.Section(title, (text, page.Table(caption, COLUMNS, rows, digits=6)))
