"""Fault campaign of the two-axis levitator: derived from its interface, measured on the plant, planted defects fail."""

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from synth.app import standard_tasks
from synth.base.progress import silent
from synth.blocks.guard import safety
from synth.declare.experiments import Sine
from synth.declare.fault_campaign import FaultCampaign, FaultLimit
from synth.errors import SignalError
from synth.simulate.faults import campaign, fault_table, injections
from synth.simulate.faults.campaign import FaultRun, HealthyRun, Sweep
from synth.simulate.faults.fault_table import Campaign
from synth.simulate.faults.injections import Injection
from synth.simulate.rig import Rig
from synth.simulate.scenario import Trajectory
from tests import levitator

SHORT_RUNS = FaultCampaign(period_s=0.2, settle_s=0.1, watch_s=0.3)
Runs = list[tuple[HealthyRun, list[FaultRun]]]


def with_campaign(rig: Rig, faults: FaultCampaign = SHORT_RUNS, **fields: Any) -> Rig:
    return campaign.with_stops(replace(rig, stage=replace(rig.stage, faults=faults, **fields)))


@pytest.fixture(scope="module")
def bare() -> Rig:
    stage = levitator.design().DESIGN
    return standard_tasks.rig(stage, stage.scalar)


@pytest.fixture(scope="module")
def rig(bare: Rig) -> Rig:
    return with_campaign(bare)


@pytest.fixture(scope="module")
def without_latch(bare: Rig) -> Rig:
    return with_campaign(standard_tasks.rig_without_latch(bare.stage, bare.stage.scalar))


def every_run(rig: Rig) -> Runs:
    return [campaign.run(rig, 0, condition, silent) for condition in campaign.motion_and_standstill(rig)]


@pytest.fixture(scope="module")
def runs(rig: Rig) -> Runs:
    return every_run(rig)


@pytest.fixture(scope="module")
def unlatched(without_latch: Rig) -> Runs:
    return every_run(without_latch)


@pytest.fixture(scope="module")
def control(unlatched: Runs) -> list[FaultRun]:
    return [run for _, faulty in unlatched for run in faulty]


class Same:
    """Equal to a trajectory with the same bits in every column, the same impacts and the same fault words."""

    def __init__(self, run: Trajectory) -> None:
        self.run = run

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Trajectory) and _contents(other) == _contents(self.run)


def _contents(run: Trajectory) -> dict[str, Any]:
    groups = {"states": run.states, "outputs": run.outputs, "applied": run.applied, "measured": run.measured}
    groups |= {"commands": run.commands, "driven": run.driven, "drive faults": run.drive_faults}
    columns = {(group, name): column.tobytes() for group, of in groups.items() for name, column in of.items()}
    return columns | {"faults": run.faults.tobytes(), "impacts": dict(run.impacts)}


def campaign_of(rig: Rig, runs: Runs, control: list[FaultRun], sweeps: Sequence[Sweep] = ()) -> Campaign:
    """Return the result of runs by condition."""
    healthy, every = [h for h, _ in runs], [run for _, faulty in runs for run in faulty]
    return fault_table.campaign(rig, 1, healthy, every, control, sweeps)


def one(rig: Rig, kind: str, target: str, condition: int = 0, duration: str = "permanent") -> FaultRun:
    group = "sensor" if target in "zx" else "actuator"
    chosen = campaign.motion_and_standstill(rig)[condition]
    return campaign.run(rig, 0, chosen, silent, [Injection(group, target, kind, duration)])[1][0]


def test_faults_are_those_of_the_interface(rig: Rig) -> None:
    derived = injections.derive(rig.stage)
    assert len(derived) == len(set(derived)) == 3 * (2 * 11 + 2 * 2 + 2 * 3 + 3) + 2
    assert {i.target for i in derived if i.group == "actuator"} == {"i1", "i2"}
    single = rig.with_interface(bad_samples=1)
    assert {i.duration for i in injections.derive(single.stage)} == {"permanent", "0.05 s"}


def test_velocities_and_stops_come_from_the_model(bare: Rig) -> None:
    known = with_campaign(bare, velocities={}, stops={})
    assert known.stage.velocities == levitator.design().levitator.VELOCITY
    assert known.stage.stops == levitator.design().levitator.STOPS  # here the domain of the plant ends at them


def test_wrong_plants_are_corners_first_and_always_the_same(rig: Rig) -> None:
    nominal, tolerances = rig.plant, np.array([p.tolerance for p in rig.plant.parameters])
    assert campaign.plant_number(nominal, 0) is nominal
    for i in range(1, 17):
        wrong = campaign.plant_number(nominal, i)
        change = wrong.values / nominal.values - 1
        assert np.array_equal(wrong.values, campaign.plant_number(nominal, i).values)
        if i <= campaign.CORNERS:
            assert np.allclose(np.abs(change), tolerances, rtol=0, atol=1e-12)
        else:
            assert (np.abs(change) <= tolerances).all() and (np.abs(change) < 0.99 * tolerances).any()


def test_the_sensors_of_wrong_machines_are_off_within_their_errors(rig: Rig) -> None:
    wide = {"z": replace(rig.stage.interface.sensors[0], offset=2e-6, gain_error=0.01)}
    off = rig.with_interface(sensors=tuple(wide.get(s.name, s) for s in rig.stage.interface.sensors))
    assert campaign.machine_number(off, 0) is off
    drawn = [campaign.machine_number(off, i) for i in range(1, 17)]
    assert {abs(m.offsets["z"]) for m in drawn[: campaign.CORNERS]} == {2e-6}
    assert all(0 < abs(m.gain_errors["z"]) <= 0.01 for m in drawn) and len({m.gain_errors["z"] for m in drawn}) > 8
    for i, machine in enumerate(drawn, 1):
        assert np.array_equal(machine.plant.values, campaign.plant_number(rig.plant, i).values)
    healthy, _ = campaign.run_healthy(drawn[0], campaign.motion_and_standstill(off)[0])
    expected = healthy.states["z"][-100:].mean() * (1 + drawn[0].gain_errors["z"]) + drawn[0].offsets["z"]
    assert abs(healthy.measured["z"][-100:].mean() - expected) < 2e-7


def test_a_lost_sensor_is_noticed_at_once_named_and_latches(rig: Rig) -> None:
    for kind in ("not finite", "out of range"):
        run = one(rig, kind, "z")
        assert run.notice_s == 0 and run.latch_s == pytest.approx(3 * rig.period_s)
        assert run.named and not run.wrong_names and run.harms
        short = one(rig, kind, "z", duration="short")
        assert short.notice_s == 0 and short.latch_s == np.inf and short.named and not short.harms


def test_an_operating_point_is_a_further_condition_at_rest(rig: Rig) -> None:
    tried = with_campaign(rig, replace(SHORT_RUNS, operating_points={"aside": {"x_ref": 3e-4}}))
    still, moving, aside = campaign.motion_and_standstill(tried)
    assert [still.name, moving.name, aside.name] == ["at rest", "in motion", "at rest, aside"]
    assert campaign.condition_names(tried.stage) == (still.name, moving.name, aside.name)
    lost = [i for i in injections.derive(tried.stage) if i.kind == "not finite" and i.target == "x"]
    healthy, runs = campaign.run(tried, 0, aside, silent, lost)
    assert healthy.alarms == 0 and runs[0].condition == "at rest, aside" and runs[0].notice_s == 0
    run, _ = campaign.run_healthy(tried, aside)
    assert run["x"][0] == 3e-4 and abs(run["x"][-1] - 3e-4) < 1e-6


@pytest.mark.parametrize(
    ("point", "message"),
    [
        ({"y_ref": 0.0}, "'y_ref', which is no set-point: give some of z_ref, x_ref"),
        ({"x_ref": 1.0}, "x_ref = 1; its range is .*; choose a value in it"),
        ({"x_ref": math.nan}, "x_ref = nan"),
    ],
)
def test_an_operating_point_that_the_set_points_cannot_hold_is_refused(
    rig: Rig, point: dict[str, float], message: str
) -> None:
    with pytest.raises(SignalError, match=message):
        campaign.motion_and_standstill(with_campaign(rig, replace(SHORT_RUNS, operating_points={"aside": point})))


@pytest.mark.parametrize(
    ("motion", "message"),
    [
        ({"xref": Sine(1e-4, 10.0)}, "the stage has no set-point 'xref': name one of z_ref, x_ref"),
        ({"x_ref": Sine(1e-2, 10.0)}, r"the course of set-point 'x_ref' reaches .* m; its range is"),
    ],
)
def test_a_motion_that_the_set_points_cannot_follow_is_refused(rig: Rig, motion: Any, message: str) -> None:
    with pytest.raises(SignalError, match=message):
        campaign.motion_and_standstill(with_campaign(rig, replace(SHORT_RUNS, motion=motion)))


def test_a_frozen_sensor_in_motion_is_never_noticed_and_harms(rig: Rig) -> None:
    run = one(rig, "frozen", "z", condition=1)
    assert run.notice_s == run.latch_s == np.inf and not run.named and run.impacts["z"] > 0.01


def test_the_impact_of_a_dead_coil_is_that_of_the_energy(rig: Rig) -> None:
    """Without current the levitator falls from rest at 0 to its stop under g less the pull of the magnet."""
    p = {each.name: each.value for each in rig.plant.parameters}
    stop = rig.stage.stops["z"][0]
    work = -p["g"] * stop - p["F0"] / p["M"] * p["l"] * (1 - np.exp(stop / p["l"]))
    assert one(rig, "dead", "i1").impacts["z"] == pytest.approx(np.sqrt(2 * work), rel=0.01)


def test_offset_and_drift_displace_the_axis_by_their_size(rig: Rig) -> None:
    for axis in "zx":
        offset = 0.02 * (rig.stage.stops[axis][1] - rig.stage.stops[axis][0])
        assert one(rig, "offset", axis).excursion[axis] > 0.9 * offset
        longer = with_campaign(rig, replace(SHORT_RUNS, drift_per_s=0.1))
        assert one(longer, "drift", axis).excursion[axis] > 1.5 * one(rig, "drift", axis).excursion[axis]


def test_a_fault_without_effect_is_counted_as_such(bare: Rig) -> None:
    still = with_campaign(bare).ideal
    assert not one(still, "frozen", "x").effect and one(still, "offset", "x").effect


def test_a_controller_without_latch_still_reports_but_never_latches(unlatched: Runs, runs: Runs) -> None:
    pairs = [
        (a, b)
        for (_, first), (_, second) in zip(runs, unlatched, strict=True)
        for a, b in zip(first, second, strict=True)
    ]
    assert all(b.latch_s == np.inf for _, b in pairs) and any(np.isfinite(a.latch_s) for a, _ in pairs)
    assert all(a.notice_s == b.notice_s for a, b in pairs if a.notice_s == 0)
    with pytest.raises(SignalError, match="'pid_z' has no latch"):
        safety.without_latch(levitator.design().pid("z"))


def test_the_campaign_sees_what_the_latch_prevents_or_not(rig: Rig, runs: Runs, control: list[FaultRun]) -> None:
    result = campaign_of(rig, runs, control)
    assert result.can_tell and result.alarms == 0
    assert {check.verdict for check in result.checks} == {"no limit"}
    assert all(row.runs == (1 if row.condition == "at rest" else 2) for row in result.rows)
    assert len(fault_table.worst_targets(result)) == 2 * (3 * (11 + 2 + 3 + 3) + 1)
    assert any("runs that latch" in note for note in fault_table.notes(result))
    assert result.document()["rows"][0]["target"] == "z"


LIMITS = (
    FaultLimit("latch_s", 1.5e-3, kind="not finite", duration="permanent"),
    FaultLimit("wrong_names", 0.0),
    FaultLimit("impact_z", 0.05, condition="at rest"),
    FaultLimit("excursion_x", 1e-3, target="z", kind="offset"),
    FaultLimit("false_alarms", 0.0),
    FaultLimit("healthy_impact", 0.0),
)


def limited(rig: Rig, limits: tuple[FaultLimit, ...] = LIMITS) -> Rig:
    return with_campaign(rig, replace(SHORT_RUNS, limits=limits))


def failures(result: Campaign) -> list[str]:
    return [check.name for check in result.checks if not check.passed]


def test_limits_become_checks(rig: Rig, runs: Runs, control: list[FaultRun]) -> None:
    result = campaign_of(limited(rig), runs, control)
    assert len(result.checks) == len(LIMITS) + 2 and failures(result) == []


def test_a_healthy_machine_that_hits_its_stop_is_caught(rig: Rig, runs: Runs, control: list[FaultRun]) -> None:
    (healthy, faulty), *others = runs
    hits = replace(healthy, impacts={"z": 0.3, "x": 0.0})
    assert failures(campaign_of(limited(rig), [(hits, faulty), *others], control)) == ["healthy_impact: every fault"]


def test_a_planted_detector_that_never_latches_is_caught(rig: Rig, unlatched: Runs, control: list[FaultRun]) -> None:
    failed = failures(campaign_of(limited(rig), unlatched, control))
    assert "latch_s: not finite, permanent" in failed and fault_table.CONTROL in failed


def test_a_control_without_harm_cannot_tell(rig: Rig, runs: Runs, control: list[FaultRun]) -> None:
    harmless = [replace(run, impacts=dict.fromkeys(run.impacts, 0.0)) for run in control]
    result = campaign_of(limited(rig), runs, harmless)
    assert not result.can_tell and failures(result) == [fault_table.CONTROL]
    assert "cannot tell" in fault_table.notes(result)[-1]


@pytest.mark.parametrize(
    ("limit", "message"),
    [
        (FaultLimit("impact", 0.1, target="y"), "matches no fault"),
        (FaultLimit("speed", 0.1), "has the measure 'speed'"),
        (FaultLimit("impact_y", 0.1), "has the measure 'impact_y'"),
    ],
)
def test_a_wrong_limit_is_refused(
    rig: Rig, runs: Runs, control: list[FaultRun], limit: FaultLimit, message: str
) -> None:
    with pytest.raises(SignalError, match=message):
        campaign_of(limited(rig, (limit,)), runs, control)


def test_the_two_faults_of_a_pair_act_together(rig: Rig) -> None:
    pairs = [i for i in injections.derive(rig.stage) if i.group in injections.PAIRS]
    assert [(i.target, i.kind) for i in pairs] == [("z + i1", "lost and dead"), ("x + i2", "lost and dead")]
    run = campaign.run(rig, 0, campaign.motion_and_standstill(rig)[0], silent, pairs[:1])[1][0]
    dead = one(rig, "dead", "i1")
    assert run.latch_s == one(rig, "not finite", "z").latch_s and dead.latch_s == np.inf
    assert run.impacts["z"] == pytest.approx(dead.impacts["z"], rel=0.05)


def test_a_flipped_bit_moves_the_reading_by_its_weight_and_a_stuck_bit_repeats_codes() -> None:
    """The word of z counts 0.1 um; a twentieth of 1.2 mm is 600 counts, in which the highest bit weighs 512."""
    stage = levitator.design().DESIGN
    rig = with_campaign(standard_tasks.rig(stage, stage.scalar))
    healthy = rig.run(0.1, {}, {"z_ref": 0.0})
    for kind in ("bit flipped", "bit stuck"):
        fault = Injection("sensor", "z", kind, "permanent")
        fields = injections.scenario_fields(rig, rig.stage.faults, fault, healthy, 100)
        faulty = rig.run(0.1, {}, {"z_ref": 0.0}, **fields)
        low, true = rig.stage.interface.signals["z"].low, np.rint(faulty.outputs["z"] / 1e-7)
        base = round(low / 1e-7)
        word, code = true - base, np.rint(faulty.measured["z"].astype(float) / 1e-7) - base
        bits = word.astype(int) ^ 512 if kind == "bit flipped" else word.astype(int) & ~512
        assert np.array_equal(code[100:], bits[100:]) and np.array_equal(code[:100], word[:100])


def test_a_run_that_goes_on_from_its_onset_is_the_whole_run_to_the_bit(rig: Rig) -> None:
    moving = campaign.motion_and_standstill(rig)[1]
    healthy, begun = campaign.run_healthy(rig, moving)
    course = moving.duration_s, moving.start, moving.references
    kinds = {(f.group, f.kind): f for f in injections.derive(rig.stage)}
    for fault in kinds.values():
        for onset, after in begun.items():
            fields = injections.scenario_fields(rig, rig.stage.faults, fault, healthy, onset)
            assert after.run(*course, **fields) == Same(rig.run(*course, **fields)), fault


def test_a_prefix_of_another_course_is_seen(rig: Rig) -> None:
    """Planted defect: the run goes on from samples of another motion."""
    moving = campaign.motion_and_standstill(rig)[1]
    course = moving.duration_s, moving.start, moving.references
    onset, other = moving.onsets[0], {name: -values for name, values in moving.references.items()}
    after = rig.begun(onset, moving.duration_s, moving.start, other)
    assert after.run(*course) != Same(rig.run(*course))


def test_an_intermittent_sensor_reads_one_good_sample_after_each_row_that_does_not_latch(rig: Rig) -> None:
    fault, healthy = Injection("sensor", "x", "intermittent", "permanent"), rig.run(0.1, {}, {"z_ref": 0.0})
    fields = injections.scenario_fields(rig, rig.stage.faults, fault, healthy, 20)
    bad = np.isnan(rig.run(0.1, {}, {"z_ref": 0.0}, **fields).measured["x"])
    row = rig.stage.interface.bad_samples
    assert not bad[:20].any() and bad[20 : 20 + row].tolist() == [True] * (row - 1) + [False]
    assert np.array_equal(bad[20:-row], bad[20 + row :])


def test_a_set_point_that_jumps_is_followed_and_a_refused_one_held(rig: Rig) -> None:
    at_rest = campaign.motion_and_standstill(rig)[0]
    jump, refused = (
        campaign.run(rig, 0, at_rest, silent, [Injection("set-point", "x_ref", kind, "permanent")])[1][0]
        for kind in ("jump", "refused")
    )
    assert jump.excursion["x"] > 1e-4 and jump.notice_s == np.inf  # a tenth of 1.6 mm
    assert refused.excursion["x"] == 0 and refused.notice_s == 0 and refused.named and refused.latch_s == np.inf


def test_calls_that_miss_every_second_sample_disturb_less_than_none_at_all(rig: Rig) -> None:
    in_motion = campaign.motion_and_standstill(rig)[1]
    missing, alternate, delayed = (
        campaign.run(rig, 0, in_motion, silent, [Injection("calls", "calls", kind, "permanent")])[1][0]
        for kind in ("missing", "alternate", "delayed")
    )
    assert missing.harms and 0 < delayed.excursion["z"] < missing.excursion["z"]
    assert alternate.effect and alternate.excursion["z"] < missing.excursion["z"]


def test_a_planted_fault_that_is_not_injected_is_not_counted(monkeypatch: pytest.MonkeyPatch, rig: Rig) -> None:
    """A limit on faults without any effect fails: nothing was tested."""
    monkeypatch.setattr(injections, "scenario_fields", lambda *_: {})
    at_rest = campaign.motion_and_standstill(rig)[0]
    lost = Injection("sensor", "z", "not finite", "permanent")
    healthy, runs = campaign.run(rig, 0, at_rest, silent, [lost])
    limit = FaultLimit("latch_s", 1.5e-3, kind="not finite")
    result = campaign_of(limited(rig, (limit,)), [(healthy, runs)], [])
    (row,) = result.rows
    assert (row.runs, row.without_effect, row.noticed, row.named) == (1, 1, 0, 0)
    assert not result.checks[0].passed and "nothing was tested" in result.checks[0].about
    assert "1 without effect" in fault_table.notes(result)[2]


def test_a_sweep_finds_the_gap_of_the_detector(rig: Rig, without_latch: Rig) -> None:
    """Half of the range added to z in motion is not noticed and runs into the stop; the whole range is noticed."""
    offset = Injection("sensor", "z", "offset", "permanent")
    (swept,) = campaign.run_sweeps(rig, without_latch, campaign.motion_and_standstill(rig)[1], silent, [offset])
    assert (swept.noticed, swept.harmful, swept.tolerated_s) == (1.0, 0.5, np.inf)
    result = campaign_of(rig, [], [], [swept])
    expected = ("z offset", "permanent", "in motion", "100 %", "50 %")
    assert fault_table.magnitude_cells(result, False) == fault_table.magnitude_cells(result, True) == (expected,)


def test_the_tolerated_time_is_the_longest_that_does_no_harm(rig: Rig, without_latch: Rig) -> None:
    at_rest = campaign.motion_and_standstill(rig)[0]
    dead = Injection("actuator", "i1", "dead", "permanent")
    (swept,) = campaign.run_sweeps(rig, without_latch, at_rest, silent, [dead])
    assert swept.noticed is None and swept.harmful is None and swept.tolerated_s is not None
    longest = round(swept.tolerated_s / rig.period_s)
    for samples, harms in ((longest, False), (round(campaign.REFINEMENT * longest) + 1, True)):
        fault = replace(dead, samples=samples)
        assert campaign.run(without_latch, 0, at_rest, silent, [fault])[1][0].harms == harms


def test_a_planted_detector_that_names_the_wrong_sensor_is_caught(rig: Rig) -> None:
    names = {"z": "x", "x": "z"}
    swapped = [f | {"input": names.get(f.get("input"), f.get("input"))} for f in rig.controller.manifest["faults"]]
    planted = replace(rig, controller=replace(rig.controller, manifest={**rig.controller.manifest, "faults": swapped}))
    run = one(planted, "not finite", "z")
    assert not run.named and run.wrong_names == ("x",)
    result = campaign_of(
        limited(rig, (FaultLimit("wrong_names", 0.0),)), [(HealthyRun("at rest", 0, 0, {}), [run])], []
    )
    assert not result.checks[0].passed
