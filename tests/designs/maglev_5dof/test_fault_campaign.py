"""What single faults do to this stage: lost and frozen encoders at rest and in motion, and two lost at once."""

import json
import math
from dataclasses import replace
from itertools import product
from pathlib import Path

import numpy as np
import pytest

from designs.maglev import fault_campaign, motions, platen
from designs.maglev.fault_handling import DEGRADED
from designs.maglev_5dof.design import DESIGN
from models import maglev_stage
from synth.app import standard_tasks
from synth.base.progress import silent
from synth.execute import host
from synth.simulate.faults import campaign, injections
from synth.simulate.faults.campaign import FaultRun
from synth.simulate.faults.injections import Injection
from synth.simulate.rig import Rig
from synth.simulate.scenario import Override, Trajectory

pytestmark = [pytest.mark.slow, pytest.mark.whole]

PLANTS, ONSET = 4, 1000
FOLDER = Path(__file__).parents[3] / "generated_c" / DESIGN.name
MEASURED = [s.name for s in platen.INTERFACE.sensors]


def runs(target: str, kind: str, condition: str) -> list[FaultRun]:
    """Return the runs of a permanent fault on the nominal plant and wrong ones."""
    assert DESIGN is not None
    rig = campaign.with_stops(standard_tasks.rig(DESIGN, DESIGN.scalar))
    faults = [i for i in injections.derive(rig.stage) if (i.target, i.kind, i.duration) == (target, kind, "permanent")]
    chosen = next(c for c in campaign.motion_and_standstill(rig) if c.name == condition)
    return [run for i in range(PLANTS) for run in campaign.run(rig, i, chosen, silent, faults)[1]]


def test_an_encoder_of_x_that_freezes_in_motion_is_named_within_20_ms_and_the_platen_lands() -> None:
    frozen = runs("x", "frozen", campaign.IN_MOTION)
    assert len(frozen) == 2 * PLANTS
    assert all(run.named and not run.wrong_names and run.notice_s <= 0.02 for run in frozen)
    assert all(run.impacts["x"] == 0 and 0 < run.impacts["y"] < 0.02 for run in frozen)  # m/s
    assert all(math.isfinite(run.latch_s) for run in frozen)


def machine(rig: Rig, number: int, friction: bool) -> Rig:
    """Return a machine of the campaign, with friction in the guides of x and z or without."""
    wrong = campaign.machine_number(rig, number)
    guides = maglev_stage.guide_disturbance(wrong.plant, {"x": 1.8, "z": 1.3}, 3) if friction else None
    return replace(wrong, disturbance=guides)


def at_rest(rig: Rig, plant: int, gap: float, frozen: str = "", friction: bool = False) -> Trajectory:
    """Return 2 s at rest off the middle of the counts of x and z; an encoder freezes after 1 s."""
    n = round(2.0 / rig.period_s)
    lags = {frozen: np.clip(np.arange(n) - ONSET + 1, 0, None)} if frozen else {}
    return machine(rig, plant, friction).run(
        2.0, {"y": gap, "x": 0.010002, "z": 0.006996}, {"x_ref": np.full(n, 0.01)}, lags=lags
    )


@pytest.mark.parametrize("sensor", ["x", "z"])
@pytest.mark.parametrize("gap", [0.0195, 0.025, 0.030])
def test_an_encoder_that_freezes_at_rest_does_not_answer_the_probe_and_the_platen_lands(
    sensor: str, gap: float
) -> None:
    rig = campaign.with_stops(standard_tasks.rig(DESIGN, DESIGN.scalar))
    for i, friction in ((0, False), (0, True), (4, False), (12, False)):
        run = at_rest(rig, i, gap, sensor, friction)
        bits = np.flatnonzero(run.faults)
        named = 1 << 11 + MEASURED.index(sensor)
        assert 0 <= bits[0] - ONSET < 200 and run.faults[bits[0]] == named | 1 << DEGRADED.bit
        assert np.abs(run[sensor] - run[sensor][ONSET]).max() < 10e-3 and run.impacts[sensor] == 0
        assert run.impacts["y"] < 0.02 and run["y"][-1] == pytest.approx(platen.GAP[1])


@pytest.mark.parametrize("friction", [False, True])
@pytest.mark.parametrize("gap", [0.0185, 0.025, 0.030])
def test_at_rest_the_probe_has_no_false_alarm_and_keeps_the_platen_within_one_count(friction: bool, gap: float) -> None:
    rig = campaign.with_stops(standard_tasks.rig(DESIGN, DESIGN.scalar))
    for i in (0, 5, 12):
        run = at_rest(rig, i, gap, friction=friction)
        assert not run.faults.any()
        if not friction:
            assert np.abs(run.measured["x"][ONSET:].astype(float) - 0.01).max() <= 10e-6 * (1 + 1e-4)


@pytest.mark.parametrize("kind", ["not finite", "frozen"])
def test_a_lost_gap_encoder_is_named_and_the_loop_continues(kind: str) -> None:
    for j in platen.MOTORS:
        lost = runs(f"y{j}", kind, campaign.IN_MOTION)
        assert all(run.named and not run.wrong_names and run.notice_s <= 0.05 for run in lost)
        assert all(math.isinf(run.latch_s) and not any(run.impacts.values()) for run in lost)
        assert max(run.excursion["y"] for run in lost) < 40e-6


@pytest.mark.parametrize("pair", [("y1", "y3"), ("y2", "y4"), ("y1", "y2"), ("y3", "y4")])
def test_without_two_gap_encoders_the_platen_lands_below_a_tenth_of_a_metre_per_second(pair: tuple[str, str]) -> None:
    rig = campaign.with_stops(standard_tasks.rig(DESIGN, DESIGN.scalar))
    motion = next(c for c in campaign.motion_and_standstill(rig) if c.name == campaign.IN_MOTION)
    k = np.arange(round(motion.duration_s / rig.period_s))
    for i, onset in product(range(PLANTS), motion.onsets):
        perturbed = campaign.machine_number(rig, i)
        lost = {name: Override(k >= onset, np.full(len(k), np.nan)) for name in pair}
        run = perturbed.run(motion.duration_s, motion.start, motion.references, overrides=lost)
        assert 0 < run.impacts["y"] < 0.1 and run["y"][-1] == pytest.approx(platen.GAP[1])  # m/s
        assert max(run.impacts["phi"], run.impacts["theta"]) < 0.25  # rad/s, 0.10 m/s at the motors


def lose_x_tilted(rig: Rig, plant: int, gap: float) -> Trajectory:
    """Return 2.5 s at rest with a tilt of 3 mrad about Z, in which x is lost after 1 s."""
    mask = np.arange(round(2.5 / rig.period_s)) >= ONSET
    lost = {"x": Override(mask, np.full(len(mask), np.nan))}
    return campaign.machine_number(rig, plant).run(2.5, {"y": gap, "theta": 3e-3}, {"theta_ref": 3e-3}, overrides=lost)


def with_defect(rig: Rig, text: str, defect: str) -> Rig:
    """Return the rig with a defect planted in the controller's C."""
    name, folder = rig.stage.name, FOLDER.parent / rig.stage.name
    files = {path.name: path.read_text() for path in folder.glob("*.[ch]")}
    source = files[f"{name}.c"]
    assert source.count(text) == 1
    files[f"{name}.c"] = source.replace(text, defect)
    return replace(rig, controller=host.load(files, json.loads((folder / "manifest.json").read_text())))


@pytest.mark.parametrize("gap", [0.0185, 0.020, 0.021])
def test_a_tilted_platen_that_loses_x_near_its_upper_stop_lands_without_tilting_further(gap: float) -> None:
    rig = campaign.with_stops(standard_tasks.rig(DESIGN, DESIGN.scalar))
    for i in (0, 2, 5, 6):
        run = lose_x_tilted(rig, i, gap)
        assert np.abs(run["theta"]).max() < 6e-3 and run.impacts["theta"] == 0
        assert np.abs(run["x"]).max() < 5e-3 and run.impacts["y"] < 0.02 and run["y"][-1] == platen.GAP[1]


def test_the_campaign_sees_a_handover_that_does_not_wait_at_small_gaps() -> None:
    """The planted defect: the platen tilts to its stop, at rest at the tilted operating point alone."""
    rig = campaign.with_stops(standard_tasks.rig(DESIGN, DESIGN.scalar))
    planted = with_defect(rig, "held_by_spring = 0.022f", "held_by_spring = 0.0f")
    lost = [Injection("sensor", "x", "not finite", "permanent")]
    for condition in campaign.motion_and_standstill(rig):
        sound, spoilt = (campaign.run(r, 6, condition, silent, lost)[1] for r in (rig, planted))
        assert not any(run.impacts["theta"] for run in sound)
        assert (max(run.impacts["theta"] for run in spoilt) > 0.5) == (condition.name == fault_campaign.TILTED)  # rad/s


def freeze_tilted(rig: Rig, plant: int, name: str) -> campaign.FaultRun:
    """Return the run in which a gap encoder freezes at rest at the tilted operating point."""
    tilted = next(c for c in campaign.motion_and_standstill(rig) if c.name == fault_campaign.TILTED)
    return campaign.run(rig, plant, tilted, silent, [Injection("sensor", name, "frozen", "permanent")])[1][0]


def test_a_frozen_gap_encoder_of_which_another_one_was_accused_first_is_found_in_the_landing() -> None:
    """At rest predictions follow the frozen code; only while the platen lands does it stand still alone."""
    rig = campaign.with_stops(standard_tasks.rig(DESIGN, DESIGN.scalar))
    planted = with_defect(rig, "(excluded_y3 != 0u) && !redundancy_output_2->readmitted_y3", "excluded_y3 != 0u")
    assert max(freeze_tilted(rig, 16, "y2").impacts.values()) < 0.06  # m/s, rad/s
    assert freeze_tilted(planted, 16, "y2").impacts["y"] > 0.3  # m/s


def wait_on_the_stop(rig: Rig) -> float:
    """Return by how much the mean direct current changes in 20 s at a set-point on the stop, with wrong zeros."""
    run = replace(rig, offsets={f"y{j}": -7e-6 for j in platen.MOTORS}).run(
        22.0, {"y": platen.GAP[1]}, {"y_ref": platen.GAP[1]}
    )
    current = np.mean([run.commands[f"i_d{j}"] for j in platen.MOTORS], axis=0)
    return abs(float(current[-2000:].mean() - current[2000:4000].mean()))


def test_no_current_grows_while_the_platen_waits_at_a_set_point_on_its_stop() -> None:
    rig = campaign.with_stops(standard_tasks.rig(DESIGN, DESIGN.scalar))
    planted = with_defect(rig, "in->y_ref, 0.01805f, 0.03095f,", "in->y_ref, 0.01805f, 0.031f,")
    assert wait_on_the_stop(rig) < 0.02 < 0.05 < wait_on_the_stop(planted)  # A


def test_a_latch_in_flight_keeps_the_angles_of_the_encoders_that_still_read() -> None:
    """Once latched the observers stand still, and the platen moves on: x and z are measured, and nothing else."""
    rig = campaign.with_stops(standard_tasks.rig(DESIGN, DESIGN.scalar))
    motion = next(c for c in campaign.motion_and_standstill(rig) if c.name == campaign.IN_MOTION)
    k = np.arange(round(motion.duration_s / rig.period_s))
    bits = {f.get("suspect"): f["bit"] for f in rig.controller.manifest["faults"]}
    for onset in motion.onsets:
        lost = {name: Override(k >= onset, np.full(len(k), np.nan)) for name in ("y1", "y2", "y3")}
        run = rig.run(motion.duration_s, motion.start, motion.references, overrides=lost)
        latched = np.flatnonzero(run.faults >> 31 & 1)
        assert len(latched) > 500
        moved = {a: np.ptp(run[a][latched]) for a in "xz"}
        assert max(moved.values()) > 1e-3  # m: far more than the gate of a jump
        for a in "xz":
            assert not (run.faults[latched] >> bits[a] & 1).any()
            np.testing.assert_array_equal(run.commands[f"{a}_commutation"][latched], run.measured[a][latched])


@pytest.mark.parametrize("plant", [8, 11, 14, 15])
def test_calls_that_are_missing_at_rest_end_in_no_contact_and_are_reported_at_the_next_call(plant: int) -> None:
    """A pair of the probe that pushes meanwhile moves the platen far, and its code stands still as it turns."""
    faults = replace(DESIGN.faults, durations_s=(0.05, 0.06))
    rig = campaign.with_stops(standard_tasks.rig(replace(DESIGN, faults=faults), DESIGN.scalar))
    missing = [i for i in injections.derive(rig.stage) if i.kind == "missing" and i.duration.endswith(" s")]
    rest = next(c for c in campaign.motion_and_standstill(rig) if c.name == campaign.AT_REST)
    _, ended = campaign.run(rig, plant, rest, silent, missing)
    assert len(ended) == 2 and not any(any(run.impacts.values()) for run in ended)
    assert [run.notice_s for run in ended] == pytest.approx([0.05, 0.06])
    assert all(run.named and not run.wrong_names and math.isinf(run.latch_s) for run in ended)


@pytest.mark.parametrize("plant", [0, 5, 12])
@pytest.mark.parametrize("friction", [False, True])
def test_a_minute_of_tracking_a_step_and_a_lift_off_have_no_false_alarm(plant: int, friction: bool) -> None:
    rig = machine(campaign.with_stops(standard_tasks.rig(DESIGN, DESIGN.scalar)), plant, friction)
    healthy = [
        motions.tracking(rig, True)[0],
        *(motions.step(rig, axis, -0.0499, 0.0499, gap=0.030).trajectory for axis in "xz"),
        motions.lift_off(rig)[0],
    ]
    assert not any(run.faults.any() for run in healthy)


def test_pairs_of_faults_are_the_redundant_gap_encoders_and_each_sensor_with_its_motor() -> None:
    """The four gap encoders see three coordinates, y1 + y3 = y2 + y4; x and z have one encoder each."""
    assert DESIGN is not None
    gaps = {f"y{j}" for j in platen.MOTORS}
    pairs = injections.sensor_pairs(DESIGN)
    assert len(pairs) == 6 and all(set(pair) <= gaps for pair in pairs)
    motors = {sensor: current[-1] for sensor, current in injections.driven_sensors(DESIGN)}  # i_a1 .. i_c4
    assert motors == {"y1": "1", "y2": "2", "y3": "3", "y4": "4", "x": "2", "z": "1"}
