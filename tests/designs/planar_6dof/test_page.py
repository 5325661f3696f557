"""What both reports show of runs and failures is right."""

import numpy as np
import pytest

from designs.planar_6dof import failures
from designs.planar_6dof import loop as simulated
from designs.planar_6dof import page as planar
from designs.planar_6dof.sensing import maps as sensing_maps
from designs.planar_6dof_leadlag import control as leadlag
from models import planar_stage
from synth import show
from synth.report import page
from synth.simulate import experiments
from synth.simulate.experiments import Experiment
from synth.simulate.rig import Rig
from tests.designs.planar_6dof import short_runs

PLANT = planar_stage.plant()


@pytest.fixture(scope="module")
def lead() -> Rig:
    return simulated.of(leadlag.controller(PLANT))


@pytest.fixture(scope="module")
def runs(lead: Rig) -> list[Experiment]:
    return [*short_runs.runs(lead), experiments.result(failures.ALL[0], lead)]


def test_runs_are_shown_by_the_units_of_the_stage_and_the_channels_of_its_sensors(runs: list[Experiment]) -> None:
    published = {"step_x": (("Y-9", "Fig. 8"), ("Y-1", "Table 1"))}
    contents = planar.Contents(leadlag.controller(PLANT), "", (), (), published)
    section = planar.experiments(contents, runs, short_runs.ROWS, {})
    titles = [s.title for s in section.sections]
    assert titles[0] == "x by 20 µm" and len(titles) == len(runs)
    latched = section.sections[-1]
    captions = [b.caption for b in latched.blocks if isinstance(b, page.Figure)]
    assert "drawn around the latch" in captions[0]
    (table,) = [b for b in latched.blocks if isinstance(b, show.Table)]
    assert [row[0] for row in table.rows] == list(planar_stage.HALL)
    assert sum(len(row) - 1 for row in table.rows) == len(runs[-1].figures)
    texts = [b.published for s in section.sections[:2] for b in s.blocks if isinstance(b, page.Figure)]
    assert texts == ["Fig. 8: steps rise in less than 25 ms"] * 2  # beside the finite one, too


def test_the_filter_leaves_about_half_of_the_noise(lead: Rig, runs: list[Experiment]) -> None:
    measured = simulated.measured_positions(lead, runs[3].trajectory)
    assert 0.3 < np.std(measured["x"][100:500]) / np.std(measured["x_raw"][100:500]) < 0.6


def test_the_map_of_what_is_not_noticed() -> None:
    failed = sensing_maps.zero_voltages(PLANT, leadlag.TIME, 6)
    undetected = {name: (w.noticed < 0).reshape(6, 6) for name, w in failed.items()}
    shares = {name: w.summary(name)["unnoticed, %"] for name, w in failed.items()}
    assert {name: 100 * silent.mean() for name, silent in undetected.items()} == pytest.approx(shares)
    assert undetected["V_bx"].any() and not undetected["V_bx"].all() and not undetected["V_ax"].any()
    assert (undetected["V_bx"] == undetected["V_cy"].T).all() and (
        undetected["V_bx"] == undetected["V_bx"][:, :1]
    ).all()
