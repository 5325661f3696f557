"""Closed loop in the report: experiments, calibration, the open loop."""

import tomllib
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure as Drawing

from designs.hall_position.paper import layouts
from designs.planar_6dof import loops, lqg
from models import hall_chain, planar_stage
from models.hall_stage import Stage
from studies.hall import page
from studies.hall.loop import closed_loop
from studies.hall.loop.closed_loop import Source
from studies.hall.pages import experiments
from studies.hall.pages import loops as own_loops
from synth.blocks.laws import error_map, lookup_table
from synth.report.page import Figure
from synth.simulate.experiments import Experiment
from synth.simulate.scenario import Trajectory

pytestmark = pytest.mark.whole


def run(values: dict[str, np.ndarray], name: str = "step_plain", more: Mapping[str, float] = {}) -> Experiment:
    """Return an experiment that shows columns of values."""
    n = len(next(iter(values.values())))
    trajectory = Trajectory(np.arange(n) / 800, values, {}, {}, {}, {}, np.zeros(n, np.uint32), {})
    references = {"x": np.full(n, 4e-3)} if "x" in values else {}
    return Experiment(name, "x by 10 um", "16 bits over +-5 V", trajectory, tuple(values), references, more)


def test_signals_are_named_as_a_reader_writes_them() -> None:
    e = run({"x": np.full(8, 4e-3), "x_raw": np.full(8, 3e-5), "phi": np.full(8, 1e-3)})
    shown = experiments.with_readable_names(e)
    assert shown.shown == ("x", "x, estimated", "phi") and set(shown.shown) <= set(experiments.UNITS)
    np.testing.assert_array_equal(shown.trajectory["x, estimated"], 3e-5)
    np.testing.assert_array_equal(shown.references["x"], 4e-3)
    (part,) = experiments.section([e], {}).sections
    assert isinstance(part.blocks[0], Figure) and "estimated" in part.blocks[0].svg and "µm" in part.blocks[0].svg


def test_runs_with_and_without_calibration_stand_side_by_side() -> None:
    plain = run({"x": np.zeros(8)}, more={"true motion, mm": 3.9, "at most, mm": 1.0, "Fig. 11: motion, mm": 4.3})
    after = run({"x": np.zeros(8)}, "step_calibrated", {"true motion, mm": 4.0, "Fig. 11: motion, mm": 4.0})
    both = {e.name: e for e in (plain, after)}
    assert experiments._before_and_after(both) == [("step", "true motion, mm", 3.9, 4.0)]
    assert experiments._before_and_after({plain.name: plain}) == []
    assert experiments.blocks(None, [plain])["calibration.compared"] == experiments.ABSENT


def test_sources_are_compared_in_columns() -> None:
    table = experiments.comparison_table({"a: phi off, urad": 1.0, "b, c: phi off, urad": 2.0, "a: more, 1": 3.0})
    assert table.columns == ("figure", "a", "b, c")
    assert table.rows[0] == ("φ off, µrad", 1.0, 2.0) and table.rows[1][1] == 3.0 and np.isnan(table.rows[1][2])


def test_every_experiment_is_on_the_page_with_the_papers_figure() -> None:
    x = np.linspace(0, 4e-3, 400)
    columns = {"x": x, "y": x, "x_raw": x, "y_raw": x}
    shown = tomllib.loads(Path(page.__file__).with_name("report.toml").read_text(encoding="utf-8"))["published"]
    runs = [run(columns, name) for name in shown]
    section, blocks = experiments.section(runs, shown), experiments.blocks(None, runs)
    assert len(section.sections) == len(runs)
    drawings = [blocks[f"experiments.{name}"] for name in ("steps", "zigzags")]
    assert [len(each.axes) for each in drawings if isinstance(each, Drawing)] == [2, 3]
    for part, published in zip(section.sections, shown.values(), strict=True):
        (figure,) = (b for b in part.blocks if isinstance(b, Figure))
        assert figure.published == published and "±5 V" in figure.caption and part.title == "x by 10 µm"


def test_the_error_map_is_drawn_as_it_is() -> None:
    of = error_map.ErrorMap(lookup_table.square(2e-3, 1e-3), np.arange(75.0).reshape(3, 5, 5) * 1e-5)
    blocks = experiments.blocks(of, [])
    rows, drawing = blocks["calibration.shares"], blocks["calibration.map"]
    assert isinstance(rows, list) and isinstance(drawing, Drawing)
    assert rows[0] == (
        "X",
        pytest.approx(10 * np.sqrt(np.mean(np.arange(25.0) ** 2))),
        pytest.approx(240.0),
        "µm",
    )
    assert experiments.blocks(None, [])["calibration.map"] == experiments.ABSENT


def test_the_loop_is_that_of_the_sections_behind_the_filter(monkeypatch: pytest.MonkeyPatch) -> None:
    """The estimate follows within a sample: what differs is the filter's lag, and 1 % of the damping."""
    plant, source = planar_stage.plant(), Source(Stage().array(layouts.LAYOUTS[5]))
    law = lqg.law(plant)
    block = closed_loop.controller(lqg.NAME, plant, lqg.TIME, law, source).rounded(np.float32)
    place = {"x": 4e-3, "y": -7e-3}
    other = loops.parts(plant, loops.rounded_controller(plant, lqg.TIME, lqg.sensing_blocks(plant), law), place)
    hertz = np.array([5.0, 12.0, 30.0])
    z = np.exp(2j * np.pi * hertz / 800)

    def difference() -> float:
        parts, worst = own_loops.open_loop(source, block, place), 0.0
        for axis in ("x", "y", "phi"):
            ours, theirs = (loops.open_loop(each, [axis]).response(z).ravel() for each in (parts, other))
            worst = max(worst, float(np.abs(ours / theirs * (1 + 1j * hertz / 200) - 1).max()))
        return worst

    assert difference() < 0.025
    with monkeypatch.context() as patched:  # a filter that is forgotten
        patched.setattr(hall_chain, "with_filter", lambda motors, outputs, chain: motors)
        assert difference() > 0.1
