"""What the reduced order saves, counted on the emulated core."""

import pytest

from designs.planar_6dof import loop as loops
from designs.planar_6dof import lqg
from designs.planar_6dof_lqg import core
from models import planar_stage
from synth.show import Table
from synth.simulate.experiments import Experiment
from synth.verify import meter


def test_the_full_order_costs_more(monkeypatch: pytest.MonkeyPatch) -> None:
    """Alone by a third at least, with the whole controller around it by some per cent; its states are more."""
    builds = meter.builds()[-1:]
    monkeypatch.setattr(meter, "builds", lambda: builds)
    loop = loops.of(lqg.controller(planar_stage.plant()))
    rest = Experiment("standstill", "At rest", "0.5 s", loop.run(0.5, {}, {}), ("x",), {})
    (table,) = core.cost_table([rest])
    assert isinstance(table, Table)
    costs = {(row[0], row[1], row[4]): row for row in table.rows}
    for build in (b.name for b in builds):
        for what, most in (("core alone, (33) and (40)", 0.8), ("whole controller", 0.99)):
            reduced, full = (costs[what, order, build] for order in core.ORDERS)
            assert float(reduced[5]) < most * float(full[5]) and float(reduced[2]) < float(full[2])
    assert core.cost_table([]) == ()
