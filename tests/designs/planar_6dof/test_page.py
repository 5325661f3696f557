"""What both reports show of runs, voltages and failures is right."""

from dataclasses import replace

import numpy as np
import pytest

from designs.planar_6dof import failures, page_experiments, page_stage, sensing_maps
from designs.planar_6dof import loop as simulated
from designs.planar_6dof_leadlag import control as leadlag
from models import planar_stage
from synth.report import page, shown
from synth.simulate.experiment import Experiment
from synth.simulate.rig import Rig
from tests.designs.planar_6dof import short_runs

PLANT = planar_stage.plant()


@pytest.fixture(scope="module")
def lead() -> Rig:
    return simulated.of(leadlag.controller(PLANT))


@pytest.fixture(scope="module")
def runs(lead: Rig) -> list[Experiment]:
    return [*short_runs.runs(lead), failures.ALL[0].run(lead)]


def test_runs_are_shown_by_the_units_of_the_stage_and_the_channels_of_its_sensors(runs: list[Experiment]) -> None:
    beside = shown.beside({"step_x": (("Y-9", "Fig. 8"), ("Y-1", "Table 1"))}, short_runs.ROWS)
    section = page_experiments.experiments(runs, beside, leadlag.TIME, True, False)
    titles = [s.title for s in section.sections]
    assert titles[0] == "x by 20 µm" and len(titles) == len(runs)
    latched = section.sections[-1]
    captions = [b.caption for b in latched.blocks if isinstance(b, page.Figure)]
    assert "drawn around the latch" in captions[0]
    (table,) = [b for b in latched.blocks if isinstance(b, page.Table)]
    assert [row[0] for row in table.rows] == list(planar_stage.HALL)
    assert sum(len(row) - 1 for row in table.rows) == len(runs[-1].figures)
    texts = [b.beside for s in section.sections[:2] for b in s.blocks if isinstance(b, page.Figure)]
    assert texts == ["Fig. 8: steps rise in less than 25 ms"] * 2  # beside the finite one, too


def test_positions_are_seen_as_the_compiled_c_has_them(lead: Rig, runs: list[Experiment]) -> None:
    rest = runs[3].trajectory
    found, expected = page_stage.seen(rest, leadlag.TIME, 500), simulated.seen(lead, rest)
    for name in ("x_raw", "x", "phi"):
        np.testing.assert_allclose(found[name], expected[name][:500], rtol=0, atol=2e-8)
    assert 0.3 < np.std(found["x"][100:]) / np.std(found["x_raw"][100:]) < 0.6


def test_the_voltages_are_those_of_the_experiment(runs: list[Experiment]) -> None:
    section = page_experiments.headroom(runs)
    (table,) = (b for b in section.blocks if hasattr(b, "rows"))
    row = table.rows[0]
    assert row[3] == pytest.approx(runs[0].figures["largest voltage, V"], rel=1e-6)
    assert row[4] == pytest.approx(6.525 - float(row[3]))
    amplified = replace(runs[0].trajectory, states={**runs[0].trajectory.states, "true_i_AA": np.zeros(1)})
    (table,) = (
        b for b in page_experiments.headroom([replace(runs[0], trajectory=amplified)]).blocks if hasattr(b, "rows")
    )
    assert not table.rows


@pytest.mark.parametrize("predicted", [True, False])
def test_the_map_of_what_is_not_noticed_is_that_of_the_faults(monkeypatch: pytest.MonkeyPatch, predicted: bool) -> None:
    monkeypatch.setattr(sensing_maps, "SPEED", 2.0)  # m/s: what sticks is not asked for here
    found = sensing_maps.unnoticed(PLANT, leadlag.TIME, 6, predicted)
    rows = sensing_maps.faults(PLANT, leadlag.TIME, 6, predicted)
    told = {r.voltage: r.unnoticed for r in rows if r.failure == "zero"}
    assert {name: silent.mean() for name, silent in found.items()} == pytest.approx(told)
    assert found["V_bx"].any() and not found["V_bx"].all() and not found["V_ax"].any()
    assert (found["V_bx"] == found["V_cy"].T).all() and (found["V_bx"] == found["V_bx"][:, :1]).all()
