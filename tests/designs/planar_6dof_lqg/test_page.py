"""The report of the LQG design, made of a short run, and what the orders cost."""

import pytest

from designs.planar_6dof import experiments
from designs.planar_6dof import loop as loops
from designs.planar_6dof_lqg import control, orders, page
from models import planar_stage
from synth.errors import CompileError
from synth.report.page import Table
from synth.simulate.experiment import Experiment
from synth.verify import meter
from synth.verify.evidence import Evidence
from tests.designs.planar_6dof import short_runs


@pytest.fixture(scope="module")
def loop() -> loops.Loop:
    return loops.of(control.controller(planar_stage.plant()))


def test_it_shows_the_whole_loop_and_what_is_refused(loop: loops.Loop, monkeypatch: pytest.MonkeyPatch) -> None:
    short_runs.coarse(monkeypatch)
    step = experiments.step_experiment(loop, experiments.step(loop, "x", 50e-6, 1.5), "step_x", "x by 50 um", None)
    html = page.report({}, Evidence(control.NAME, (), ()), [step], [], None)
    assert len(html.encode()) < short_runs.MOST
    assert html.count("open loop and sensitivity") == 6 and html.count("UNSTABLE") == 1
    for text in ("Disk margins of all channels", "The library refuses it", "has the poles −1", "weights (47)"):
        assert text in html, text
    assert "Fig. 10(d)" in html and "At rest" not in html and "1,757.55" not in html and "1757.55" in html


def test_the_full_order_costs_more(loop: loops.Loop) -> None:
    """Alone by a third at least, with the whole controller around it by some per cent; its states are more."""
    try:
        builds = [b.name for b in meter.builds()]
    except CompileError:
        pytest.skip("no cross compiler")
    rest = Experiment("standstill", "At rest", "0.5 s", loop.run(0.5, {}, {}), ("x",), {})
    (table,) = orders.spent([rest])
    assert isinstance(table, Table)
    found = {(row[0], row[1], row[4]): row for row in table.rows}
    for build in builds:
        for what, most in (("core alone, (33) and (40)", 0.8), ("whole controller", 0.99)):
            reduced, full = (found[what, order, build] for order in orders.ORDERS)
            assert float(reduced[5]) < most * float(full[5]) and float(reduced[2]) < float(full[2])
    assert orders.spent([]) == ()
