"""The commutation on the machine: its advance, its sines, and what becomes of the platen whose position is lost."""

import re
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from designs.maglev import commutation, motions, platen
from designs.maglev_5dof.design import DESIGN
from models import maglev_stage
from synth.app import standard_tasks
from synth.block import Block
from synth.check import Check
from synth.emit import write
from synth.execute import host
from synth.simulate.faults import campaign
from synth.simulate.rig import Rig
from synth.simulate.scenario import Override, Trajectory, sample_times
from synth.verify import replays, standard
from tests.designs.maglev_5dof.test_fault_campaign import with_defect

ERROR = platen.SURROGATE_ERROR
PHASES = commutation.phase_currents(DESIGN.name, DESIGN.plant)
STOP = 0.031  # m, the gap at the lower stop


@cache
def rig() -> Rig:
    """Return the stage with stops along every coordinate."""
    return campaign.with_stops(standard_tasks.rig(DESIGN, np.float32))


def behind(block: Block) -> Rig:
    """Return the rig with another commutation."""
    return replace(rig(), drive=(host.compile_block(block, np.float32, error=ERROR[np.float32]),))


def errors(of: Rig) -> dict[str, float]:
    """Return the mean errors of 12 s of the 4-DOF tracking after 8 s."""
    return motions.mean_errors(*motions.tracking(of, True, 12.0), 8.0, 12.0)


def test_the_errors_through_both_blocks_are_those_of_ideal_currents() -> None:
    driven, direct = errors(rig()), errors(rig().without_drive)
    assert max(driven["x"], driven["z"]) < 1.5e-6
    assert driven["x"] < direct["x"] + 0.2e-6 and driven["z"] < direct["z"] + 0.2e-6


@pytest.mark.parametrize("samples", [0.0, 1.0, 2.0])
def test_any_other_advance_is_worse_by_far(samples: float) -> None:
    worse = errors(behind(commutation.phase_currents(DESIGN.name, maglev_stage.plant(), samples)))
    assert min(worse["x"], worse["z"]) > 6e-6


def test_a_drive_that_makes_other_forces_than_the_plant_of_the_margins_is_found() -> None:
    run = motions.tracking(rig(), True, 4.0)[0]

    def differs(of: Rig) -> Check:
        (check,) = standard.drive_checks(of, [run])
        return check

    assert differs(rig()).value < 3e-3 and differs(rig()).passed
    stronger = rig().plant.with_parameters(b0=1.25 * rig().plant.parameter("b0").value)
    assert not differs(replace(rig(), plant=stronger)).passed
    pitch = maglev_stage.plant().with_parameters(tau=1.02 * maglev_stage.plant().parameter("tau").value)
    late = behind(commutation.phase_currents(DESIGN.name, pitch))
    assert not differs(late).passed
    assert not standard.drive_checks(rig().without_drive, [run])


def test_the_c_calls_no_sine_and_costs_no_more_than_it_did() -> None:
    files = write.emit(PHASES, np.float32, error=ERROR[np.float32]).files
    code = re.sub(r"/\*.*?\*/", "", files[f"{PHASES.name}.c"], flags=re.DOTALL)  # comments have the equations
    assert not [f for f in ("sin", "cos", "floor") if f"{f}f(" in code or f"{f}(" in code]
    assert "maglev_5dof_phase_limit(i_a" not in code  # no limit of a phase is left: all are proved idle
    assert "x: lost; motors 2 and 4 hand their direct currents over and fade out" in files[f"{PHASES.name}.h"]


def lose(
    of: Rig, sensors: tuple[str, ...], gap: float = 0.025, onset_s: float | None = None, watch_s: float = 1.0
) -> Trajectory:
    """Lose sensors at rest after 0.3 s, or in the 4-DOF tracking at the onset, and run for another `watch_s`."""
    onset = 0.3 if onset_s is None else onset_s
    time = sample_times(onset + watch_s, of.period_s)
    lost = {s: Override(time >= onset, np.full(len(time), np.nan)) for s in sensors}
    if onset_s is None:
        return of.run(onset + watch_s, {"y": gap}, overrides=lost)
    courses = {axis: course(time) for axis, course in platen.COURSES.items()}
    start = {axis: float(courses[axis][0]) for axis in ("y", "x", "z")}
    references = {f"{axis}_ref": course for axis, course in courses.items()}
    return of.run(onset + watch_s, start, references, overrides=lost)


def rise(run: Trajectory, onset_s: float) -> float:
    """Return how far the platen rises after the onset, m."""
    y = run["y"][run.time >= onset_s]
    return float(y[0] - y.min())


@pytest.mark.parametrize("sensor", ["x", "z"])
@pytest.mark.parametrize("gap", [0.0182, 0.025, 0.030])
def test_at_rest_without_a_position_the_platen_lands_and_only_then_hands_its_currents_over(
    sensor: str, gap: float
) -> None:
    run = lose(rig(), (sensor,), gap)
    assert np.abs(run[sensor]).max() < 0.5e-3 and rise(run, 0.3) < 0.1e-3
    assert run["y"][-1] == pytest.approx(STOP, abs=1e-6) and run.impacts["y"] < 0.02
    bit = 1 << (10 + "xz".index(sensor))
    word, latched = run.drive_faults[PHASES.name], int(np.flatnonzero(run.faults >> 31)[0])
    assert np.flatnonzero(word & bit)[0] == latched + platen.BAD_SAMPLES - 1
    assert run["y"][latched] == pytest.approx(STOP, abs=1e-6)


@pytest.mark.parametrize("sensor", ["x", "z"])
def test_the_commutation_follows_the_prediction_until_the_platen_has_landed(sensor: str) -> None:
    run = lose(rig(), (sensor,), onset_s=0.6)
    landing = slice(600, int(np.flatnonzero(run.faults >> 31)[0]))
    predicted = run.commands[f"{sensor}_commutation"][landing].astype(float)
    assert np.abs(predicted - run[sensor][landing]).max() < 1e-4 < np.ptp(run[sensor][landing])
    assert (run.commands[f"{sensor}_commutation"][landing.stop :] == np.float32(platen.LOST)).all()


def test_a_commutation_that_keeps_a_stale_angle_pushes_the_platen_to_its_stop(monkeypatch: Any) -> None:
    monkeypatch.setattr(commutation, "BAD_SAMPLES", 10**6)
    stale_angle = behind(commutation.phase_currents(DESIGN.name, maglev_stage.plant()))
    repelling = with_defect(stale_angle, "(rests) ? 0.0f : safe_i_d", "safe_i_d")  # without current nothing pushes
    stale = lose(repelling, ("x",), watch_s=3.0)
    assert stale.impacts["x"] > 0.4


@pytest.mark.parametrize("onset", [0.5, 0.75])
def test_in_motion_no_lost_position_pulls_the_platen_up(onset: float) -> None:
    for sensors in (("x",), ("z",), ("x", "z")):
        assert rise(lose(rig(), sensors, onset_s=onset), onset) < 0.5e-3, sensors


def test_with_both_positions_lost_the_currents_end() -> None:
    """The latch comes within a pair of the probe here, which leaves a speed of 0.3 mm/s."""
    run = lose(rig(), ("x", "z"))
    assert run["y"][-1] == pytest.approx(STOP, abs=1e-6) and rise(run, 0.3) < 0.1e-3
    assert max(np.abs(run["x"]).max(), np.abs(run["z"]).max()) < 0.5e-3
    assert max(abs(float(run.driven[s.name][-1])) for s in PHASES.outputs) == 0.0


@pytest.mark.parametrize("lost", [np.nan, platen.LOST])
def test_direct_currents_go_to_the_motors_whose_position_is_known(lost: float) -> None:
    """From 1 A in each motor, 2 A in two; a position that is found again gets its currents back."""
    n = 120
    inputs = {f"i_d{j}": np.ones(n) for j in platen.MOTORS} | {f"i_q{j}": np.zeros(n) for j in platen.MOTORS}
    inputs |= {"x_commutation": np.zeros(n), "z_commutation": np.zeros(n)}
    inputs["x_commutation"][10:60] = lost
    c64 = host.compile_block(PHASES, np.float64, error=ERROR[np.float64])
    out = replays.replay(c64, inputs).outputs
    sizes = {j: np.sqrt(2 / 3 * sum(out[f"i_{p}{j}"] ** 2 for p in "abc") / 2) for j in platen.MOTORS}
    for j, before, during in ((1, 1.0, 2.0), (2, 1.0, 0.0), (3, 1.0, 2.0), (4, 1.0, 0.0)):
        assert sizes[j][9] == pytest.approx(before) and sizes[j][59] == pytest.approx(during, abs=1e-12)
        assert sizes[j][-1] == pytest.approx(before)
        assert np.abs(np.diff(sizes[j])).max() < 0.041
