"""The report of the LQG design, made of a short run."""

from pathlib import Path

import pytest

from designs.planar_6dof import experiments, lqg
from designs.planar_6dof import loop as loops
from designs.planar_6dof import loops as shared
from designs.planar_6dof_lqg import page
from designs.planar_6dof_lqg.design import DESIGN
from models import planar_stage
from synth.emit.write import EmittedCode
from synth.report import template
from synth.verify.suite import Evidence
from tests.designs.planar_6dof import short_runs

ROOT = Path(__file__).parents[3]


def test_it_shows_the_whole_loop_and_what_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    loop = loops.of(lqg.controller(planar_stage.plant()))
    short_runs.coarse(monkeypatch)
    parts = shared.parts(planar_stage.plant(), lqg.controller(planar_stage.plant()))
    monkeypatch.setattr(page.loops, "all_loops", lambda _: shared.of_parts(parts, ("x", "psi"), "as shipped"))
    monkeypatch.setattr(page.loops, "horizontals", lambda _: {"as shipped": shared.horizontal(parts)})
    step = experiments.step_experiment(loop, experiments.step(loop, "x", 50e-6, 1.5), "step_x", "x by 50 um", None)
    gains = (ROOT / "generated_c" / lqg.NAME / "gains.json").read_text()
    files = {lqg.NAME: EmittedCode({"gains.json": gains}, {})}
    html = template.report(DESIGN, template.Results(files, Evidence(lqg.NAME, (), ()), [step], [], None))
    assert len(html.encode()) < short_runs.MOST
    assert html.count("open loop and sensitivity") == 2 and html.count("<td>as shipped</td>") == 2 + 3
    for text in ("Disk margins of all channels", "The library refuses it", "has the poles −1", "weights (47)"):
        assert text in html, text
    assert "Fig. 10(d)" in html and "At rest" not in html and "1,757.55" not in html and "1757.55" in html
