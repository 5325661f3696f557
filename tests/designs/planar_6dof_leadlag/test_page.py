"""The report of the lead-lag design, made of short runs."""

from dataclasses import replace

import pytest

from designs.planar_6dof import loop as loops
from designs.planar_6dof import loops as shared
from designs.planar_6dof_leadlag import control, page
from designs.planar_6dof_leadlag.design import DESIGN
from models import planar_stage
from synth.check import Check
from synth.report import template
from synth.verify.suite import Evidence
from tests.designs.planar_6dof import short_runs


def test_it_shows_all_that_is_handed_in(monkeypatch: pytest.MonkeyPatch) -> None:
    short_runs.coarse(monkeypatch)
    monkeypatch.setattr(
        page, "all_loops", lambda p: shared.of_block(p, control.controller(p), ("x", "psi"), "as shipped")
    )
    runs = short_runs.runs(loops.of(control.controller(planar_stage.plant())))
    bad = replace(runs[0], name="bad", title="Planted", checks=(Check("rise", 0.03, 0.025, "s"),))
    results = template.Results({}, Evidence(control.NAME, (), ()), [*runs, bad], short_runs.ROWS, None)
    html = template.report(DESIGN, results)
    assert len(html.encode()) < short_runs.MOST
    for title in ("x by 20 µm", "x by 20 µm, finite matrix", "Circle (Fig. 9)", "Planted"):
        assert f"{title}</h3>" in html
    assert html.count("open loop and sensitivity") == 2 == html.count("<td>as shipped</td>")
    assert "requirements missed" in html and "✗ 1 failed" in html and ">rise</a>" in html
    assert html.count("Fig. 8: steps rise in less than 25 ms") == 2  # beside the finite one, too
    for text in ("before and ±10 µm after", "The path over the matrix", "Not measured"):
        assert text in html, text
    assert "e-05" not in html.split("Files</h2>")[0].replace("2e-05", "")
