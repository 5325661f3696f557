"""Report of the Hall position for a design review: report.md and report.toml with the computed blocks."""

import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from designs.hall_position.pages import estimator, field
from models.hall_stage import Stage
from synth import show
from synth.report import page, prose, standard
from synth.report.template import Extra, Results

STUDIES = "Studies"


def contents(quoted: Mapping[str, Any], results: Results) -> Extra:
    """Return what the report has beyond the standard; `quoted` are the results of the studies."""
    data = tomllib.loads(Path(__file__).with_name("report.toml").read_text(encoding="utf-8"))
    computed = {**field.blocks(Stage()), **estimator.blocks(data["meaning"])}
    blocks = prose.with_captions(computed, data["blocks"])
    equations = {f"equations.{e['name']}": page.Equations(tuple(map(tuple, e["rows"]))) for e in data["equations"]}
    return Extra(
        {**equations, **blocks},
        [standard.audit(results.rows, ()), studies(quoted)],
        omitted=(standard.MODEL, standard.LAW, standard.GAINS, standard.LOOPS),
        facts=(("law", "GLSDC, Fig. 9, five corrections a sample"),),
    )


def studies(results: Mapping[str, Any]) -> page.Section:
    """Return the figures of the studies as they are quoted, with their date and revision, beside their limits."""
    about = (
        "What the estimators do beyond the paper: in random motion without end, with a calibration and with a faulty "
        f"sensor, and in loops that the estimate closes. Not computed with this page: results of {results['date']}, "
        f"revision {results['revision']}, by python -m studies.hall. What they led to is in docs/decisions, "
        "hall_position_protected.md and hall_position_loop.md."
    )
    rows = tuple((f["study"], f["figure"], f["value"], limit(f), f["unit"]) for f in results["figures"])
    table = show.Table("Figures of the studies", ("study", "figure", "value", "limit", "unit"), rows)
    return page.Section(STUDIES, (page.Text(about), page.Folded(f"{len(rows)} figures", (table,))))


def limit(figure: Mapping[str, Any]) -> str:
    """Return the limit of a figure as text."""
    if "at_most" in figure:
        return f"at most {figure['at_most']:.4g}"
    return f"at least {figure['at_least']:.4g}" if "at_least" in figure else "no limit"
