"""The report: all parts are present, and their numbers are right."""

import json
import re
from datetime import date

import numpy as np
import pytest

from designs.hall_position import config, page
from designs.hall_position.design import DESIGN, RESULTS
from designs.hall_position.pages import field
from designs.hall_position.paper import rows
from models.hall_stage import Stage
from synth.emit.write import EmittedCode
from synth.report import audit, sections, template
from synth.report.page import Folded, Section
from synth.report.prose import Content, Rows
from synth.show import Table
from synth.verify.cost import Cost
from synth.verify.suite import Evidence

STAGE = Stage()
MOST = 2_000_000  # bytes of a page
QUOTED = json.loads(RESULTS.read_text(encoding="utf-8"))


def rows_of(block: Content) -> Rows:
    assert isinstance(block, list)
    return block


def test_every_part_is_there(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(field, "POINTS", 13)  # maps of few places
    monkeypatch.setattr(sections, "cost", lambda _: Section("Cost of three estimators"))
    cost = Cost(config.NAME, "cortex-m4f", 1e-3, (), (), (), {}, ())
    scope = rows.scope(STAGE, rows.published_rows())
    few = [audit.recompute(scope.published[n], scope) for n in ("K-1", "K-8")]
    files = {"other": EmittedCode({}, {})}
    html = template.report(DESIGN, template.Results(files, Evidence(config.NAME, (), ()), [], few, cost))
    assert len(html.encode()) < MOST and html.count("<svg") == len(set(re.findall(r"Figure (\d+)\.", html)))
    for text in ("Fig. 3", "Fig. 4", "Fig. 5 and (3)", "Fig. 8", "air gap", "K-8", "GLSDC", QUOTED["revision"]):
        assert text in html, text
    assert not re.search(r"\bnan\b|>no number<", html)
    titles = [html.rindex(t) for t in ("Cost of three estimators", "Figures of the studies", "SHA-256")]
    assert titles == sorted(titles)


def test_studies_are_quoted_with_their_date_revision_and_limits() -> None:
    """Those that are committed are all, and keep their limits: there is no verdict in the file."""
    assert date.fromisoformat(QUOTED["date"]) and re.fullmatch(r"[0-9a-f]{7,}", QUOTED["revision"])
    limited = [f for f in QUOTED["figures"] if "at_most" in f or "at_least" in f]
    assert all(f.get("at_least", -np.inf) <= f["value"] <= f.get("at_most", np.inf) for f in limited)
    studies = {f["study"] for f in limited}
    assert {"random motion", "calibrated units", "Zigzag, Fig. 10, calibrated, four sensors"} <= studies
    assert len(limited) > 150


def test_each_figure_of_a_study_is_a_row() -> None:
    figures = [
        {"study": "a", "figure": "share", "value": 0.25, "unit": "1", "at_most": 0.5},
        {"study": "a", "figure": "yield", "value": 0.75, "unit": "1", "at_least": 0.5},
        {"study": "b", "figure": "true motion, mm", "value": 4.0, "unit": ""},
    ]
    section = page.studies({"date": "2026-01-31", "revision": "abc1234", "figures": figures})
    text, folded = section.blocks
    assert "2026-01-31, revision abc1234" in str(text) and isinstance(folded, Folded)
    (table,) = folded.blocks
    assert isinstance(table, Table)
    assert [row[3] for row in table.rows] == ["at most 0.5", "at least 0.5", "no limit"]
    assert table.rows[0] == ("a", "share", 0.25, "at most 0.5", "1")


def test_the_law_of_decay_is_within_the_intervals() -> None:
    rates = rows_of(field.blocks(STAGE)["gap.decays"])
    w = 2 * np.pi / STAGE.pitch
    for row, n in zip(rates, (1, 5, 1), strict=True):
        assert row[4] == pytest.approx(n * w) and row[5] == "yes"
        assert isinstance(row[2], float) and isinstance(row[3], float) and row[2] < n * w < row[3]
