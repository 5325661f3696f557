"""Presentation of experiments: prefixes, the time window around a latch, values of many channels."""

from dataclasses import replace

import numpy as np
import pytest

from synth.errors import SignalError
from synth.fault import LATCH_BIT
from synth.report import sections, standard
from synth.report.sections import Shown
from synth.simulate.experiments import Experiment
from synth.simulate.scenario import Trajectory

TIME = np.arange(100) * 0.01
SMALL = 1e-5 * np.sin(TIME)


def run(latched: int | None = None) -> Experiment:
    faults = np.zeros(len(TIME), np.uint32)
    if latched is not None:
        faults[latched:] = 1 << LATCH_BIT
    states = {"y": SMALL, "theta": 0.1 * TIME}
    trajectory = Trajectory(TIME, states, {}, {}, {}, {}, faults, {})
    return Experiment("step", "A step", "of y", trajectory, ("y", "theta"), {"y": np.full(len(TIME), 2e-5)})


BY = Shown({"y": "m", "theta": "rad"}, {"y": 1e-6}, fine=5e-4)


def test_a_small_signal_its_set_point_and_its_level_are_shown_in_micrometres() -> None:
    scaled, by = sections.in_fine_units(run(), BY)
    assert by.units == {"y": "µm", "theta": "rad"} and by.levels["y"] == pytest.approx(1)
    np.testing.assert_allclose(scaled.trajectory["y"], 1e6 * SMALL)
    np.testing.assert_allclose(scaled.references["y"], 20)
    assert scaled.trajectory["theta"][-1] == 0.1 * TIME[-1]
    same = sections.in_fine_units(run(), replace(BY, fine=0.0))[0]
    assert same.trajectory["y"][-1] == SMALL[-1]


def test_a_signal_without_a_unit_is_refused() -> None:
    with pytest.raises(SignalError, match="'step' shows theta without a unit"):
        standard.experiments([run()], replace(BY, units={"y": "m"}))


def test_a_run_that_latches_is_drawn_around_the_latch() -> None:
    by = replace(BY, latch=(0.1, 0.05), longest=0.5, window=(0.0, 0.2))
    assert sections.window(run(60), by) == pytest.approx((0.5, 0.65))
    assert sections.window(run(2), by) == pytest.approx((0.0, 0.07))
    assert sections.window(run(), by) == (0.0, 0.2) == sections.window(run(60), replace(by, latch=None))
    assert sections.window(run(), replace(by, longest=2.0)) is None


def test_figures_by_channel_keep_each_value() -> None:
    measured = {"noise, V_a": 1.0, "V_b is named after": 4.0, "noise, V_b": 2.0, f"{sections.HEADROOM} (x)": 0.5}
    (table,) = sections.by_channel(measured, ("V_a", "V_b"))
    assert table.columns == ("channel", "noise", "it is named after")
    assert table.rows[1] == ("V_b", 2.0, 4.0) and table.rows[0][:2] == ("V_a", 1.0) and np.isnan(table.rows[0][2])
    assert (
        sections.by_channel({**measured, "settling, s": 0.1}, ("V_a", "V_b")) == () == sections.by_channel({}, ("V_a",))
    )
    assert sections.by_channel(measured, ()) == ()


def test_a_figure_that_ends_with_a_signal_has_the_unit_1() -> None:
    assert sections.with_units({"pitches crossed, y": 4.0, "rise, s": 0.1}, BY.units) == {
        "pitches crossed, y, 1": 4.0,
        "rise, s": 0.1,
    }
