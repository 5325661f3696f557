"""Every experiment keeps its limits, and a wrong sign anywhere makes one fail."""

from dataclasses import replace

import numpy as np
import pytest

from designs.maglev import platen
from designs.maglev_5dof.design import DESIGN
from synth.app import tasks
from synth.simulate.experiments import Experiment
from synth.simulate.faults import campaign
from synth.simulate.rig import Rig

pytestmark = pytest.mark.whole


@pytest.fixture(scope="module")
def all_runs() -> dict[str, Experiment]:
    return {e.name: e for e in tasks.experiments(DESIGN).result(lambda _: None)}


def test_every_check_passes(all_runs: dict[str, Experiment]) -> None:
    failed = [
        f"{e.name}: {c.name} {c.value:.4g} > {c.limit:.4g} {c.unit}"
        for e in all_runs.values()
        for c in e.checks
        if not c.passed
    ]
    assert not failed
    assert sum(len(e.checks) for e in all_runs.values()) >= 80


def test_names_are_unique_and_no_run_without_a_planted_fault_reports_one(all_runs: dict[str, Experiment]) -> None:
    for name, e in all_runs.items():
        expected = name.startswith("set_down") or name == "zero_current"  # the probe of x and z is not answered
        assert bool((e.trajectory.faults != 0).any()) == expected, name


def test_both_ellipses_stay_in_range(all_runs: dict[str, Experiment]) -> None:
    for name in ("ellipse", "tracking"):
        y = all_runs[name].trajectory["y"]
        assert 0.018 < y.min() < y.max() < 0.031


def test_zero_current_slams_up_and_the_safe_output_does_not(all_runs: dict[str, Experiment]) -> None:
    assert all_runs["zero_current"].figures["speed there, m/s"] > 0.4
    assert all_runs["zero_current"].figures["time to the upper stop, s"] < 0.05
    for name in ("set_down_18.1", "set_down_20", "set_down_25", "set_down_30"):
        e = all_runs[name]
        assert e.trajectory["y"][-1] == pytest.approx(0.031, abs=1e-6)
        assert e.trajectory["y"].min() > 0.018


@pytest.mark.parametrize("gap", np.arange(0.0181, 0.031, 0.0003).tolist())
def test_the_safe_output_lets_the_platen_down_from_every_gap(emitted_rig: Rig, gap: float) -> None:
    """From rest, under the safe output alone; zero current instead slams it up from 28.7 mm and below."""
    safe = {f"i_d{j}": platen.SAFE_CURRENT for j in range(1, 5)} | {"u_x": 0.0, "u_z": 0.0}
    direct = emitted_rig.without_drive
    y = direct.run(2.0, {"y": gap}, {}, actuators={}, forcing=safe)["y"]
    assert y[-1] == pytest.approx(0.031, abs=1e-9) and np.diff(y).min() > -1e-9
    y = direct.run(2.0, {"y": gap}, {}, actuators={}, forcing=dict.fromkeys(safe, 0.0))["y"]
    assert y[-1] == pytest.approx(0.018 if gap < 0.0287 else 0.031, abs=1e-9)


def final_gaps(rig: Rig, gap: float, current: float) -> list[float]:
    """Return the gaps at the end, from rest at a gap under direct currents alone, on the plants of the campaign."""
    direct = rig.without_drive
    forcing = {f"i_d{j}": current for j in range(1, 5)} | {"u_x": 0.0, "u_z": 0.0}
    plants = [replace(direct, plant=campaign.plant_number(direct.plant, i)) for i in range(17)]
    return [float(r.run(2.0, {"y": gap}, {}, actuators={}, forcing=forcing)["y"][-1]) for r in plants]


def test_the_safe_output_lowers_each_plant_from_its_upper_stop(emitted_rig: Rig) -> None:
    """The header says so. With 2 A the magnets hold the nominal one."""
    upper, lower = platen.GAP
    assert final_gaps(emitted_rig, upper + 1e-6, platen.SAFE_CURRENT) == pytest.approx([lower] * 17, abs=1e-9)
    assert final_gaps(emitted_rig, upper + 1e-6, 0.8 * platen.SAFE_CURRENT)[0] == pytest.approx(upper, abs=1e-9)
    assert final_gaps(emitted_rig, platen.PULLED_UP, 0.0)[0] == pytest.approx(upper, abs=1e-9)
    assert final_gaps(emitted_rig, platen.PULLED_UP + 1e-5, 0.0)[0] == pytest.approx(lower, abs=1e-9)


def test_anti_windup_is_what_differs(all_runs: dict[str, Experiment]) -> None:
    assert all_runs["windup_with"].figures["overshoot"] < 0.9 * all_runs["windup_without"].figures["overshoot"]
