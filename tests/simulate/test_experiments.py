"""Experiments as data: their checks on a known loop, and cases that must fail."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from synth.app import standard_tasks
from synth.declare.experiments import Conditions, Hold, LiftOff, Sine, StepResponse, Track
from synth.errors import DesignError, SignalError
from synth.simulate import experiments
from synth.simulate.rig import Rig
from synth.simulate.scenario import Override
from tests import levitator

DESIGN: Any = levitator.design("levitator_2dof")


@pytest.fixture(scope="module")
def rig() -> Rig:
    stage = DESIGN.DESIGN
    return Rig(stage, DESIGN.PLANT, standard_tasks.compiled_controller(stage, np.float32))


def checks(run: Any) -> dict[str, Any]:
    return {c.name: c for c in run.checks}


def test_every_experiment_of_the_levitator_holds(rig: Rig) -> None:
    heard: list[str] = []
    declared = rig.stage.experiments
    runs = experiments.run(rig, declared, heard.append)
    assert heard == [r.name for r in runs] and len(set(heard)) == len(declared) > 5
    assert [f"{r.name}: {c}" for r in runs for c in r.checks if not c.passed] == []


def test_a_step_is_measured_from_the_sample_at_which_it_comes(rig: Rig) -> None:
    run = experiments.result(
        StepResponse("z_ref", 2e-4, 0.05, 0.2, error=2e-7, conditions=Conditions(start={"z": -1e-4})), rig
    )
    t, r, z = run.trajectory.time, run.references["z"], run.trajectory["z"]
    k = int(np.argmax(r > 0))
    assert t[k] == 0.2 and r[k - 1] == -1e-4 and r[k] == pytest.approx(1e-4) and len(t) == 2000
    late = np.abs(z[k:] - 1e-4) > 0.02 * 2e-4
    assert checks(run)["settling time"].value == pytest.approx((np.flatnonzero(late)[-1] + 1) * 5e-4)
    assert checks(run)["overshoot"].value == pytest.approx((z[k:].max() - 1e-4) / 2e-4)
    assert checks(run)["|e_z| at the end"].value == np.abs(z[t >= 0.9 * t[-1]] - 1e-4).max()
    assert run.figures["largest |i1|, A"] == np.abs(run.trajectory.commands["i1"]).max()


def test_a_track_starts_on_its_course_and_takes_a_limit_for_each(rig: Rig) -> None:
    course = Sine(2e-4, DESIGN.SCAN, np.pi / 2)
    run = experiments.result(Track({"z_ref": course, "x_ref": 1e-4}, {"z_ref": 1e-9, "x_ref": 1e-7}, 0.6, 0.5), rig)
    assert run.trajectory["z"][0] == pytest.approx(2e-4) and run.trajectory["x"][0] == pytest.approx(1e-4)
    error = run.trajectory["z"] - course(run.trajectory.time)
    assert checks(run)["mean |e_z|"].value == pytest.approx(np.abs(error[run.trajectory.time >= 0.5]).mean())
    assert checks(run)["mean |e_x|"].passed and not checks(run)["mean |e_z|"].passed  # held, and moving
    some = experiments.result(Track({"z_ref": course, "x_ref": 1e-4}, {"z_ref": 1e-7}, 0.6, 0.5), rig)
    assert "mean |e_x|" not in checks(some) and some.figures["mean |e_x| from 0.5 s on, m"] == pytest.approx(
        checks(run)["mean |e_x|"].value
    )
    with pytest.raises(DesignError, match="a limit is for 'y_ref', but what moves is z_ref, x_ref"):
        experiments.result(Track({"z_ref": course, "x_ref": 1e-4}, {"y_ref": 1e-7}, 0.6, 0.5), rig)


def test_an_internal_model_leaves_nothing_of_the_hum_that_it_holds(rig: Rig) -> None:
    """The same force at another frequency stays."""
    held, other = (
        experiments.result(Hold({"x_ref": 1e-6}, 2.0, 1.5, Conditions(disturbances={"hum": Sine(0.2, w)})), rig)
        for w in (DESIGN.MAINS, 0.8 * DESIGN.MAINS)
    )
    assert checks(held)["largest |e_x|"].passed and not checks(other)["largest |e_x|"].passed
    assert checks(other)["largest |e_x|"].value > 20 * checks(held)["largest |e_x|"].value
    assert held.title == "x held, hum acts"


def test_a_lift_off_ramps_from_the_set_points_end_and_may_be_too_fast(rig: Rig) -> None:
    start = Conditions(start={"z": -6e-4})
    slow, fast = (experiments.result(LiftOff({"z_ref": 0.0}, s, 0.05, 2e-7, start), rig) for s in (0.2, 0.01))
    assert slow.references["z"][0] == -5e-4 and slow.trajectory["z"][0] == -6e-4
    assert all(c.passed for c in slow.checks)
    assert not all(c.passed for c in fast.checks)


@pytest.mark.parametrize("where", ["stage", "conditions"])
def test_an_experiment_assesses_against_the_set_points_that_the_controller_gets(rig: Rig, where: str) -> None:
    start = {"x": 2e-4}
    at = replace(rig, stage=replace(rig.stage, start=start)) if where == "stage" else rig
    under = Conditions(start=start if where == "conditions" else {})
    step = StepResponse("x_ref", 1e-5, 1.0, 0.01, conditions=under)
    for experiment in (step, LiftOff({"x_ref": 0.0}, 0.1, 0.5, 1e-3, under)):
        run = experiments.result(experiment, at)
        played = run.trajectory.measured["x_ref"][0]  # in single precision
        assert run.references["x"][0] == 2e-4 == pytest.approx(float(played), rel=1e-6)
    held = experiments.result(Hold({"x_ref": 1e-6}, conditions=under), at)
    assert held.references["x"][0] == 2e-4 and checks(held)["largest |e_x|"].passed


def test_parameters_change_the_plant_alone(rig: Rig) -> None:
    step = StepResponse("z_ref", 3e-4, 0.05, 0.2)
    heavy = replace(step, conditions=Conditions(parameters={"M": 1.9, "K": 12.0}), label="heavy")
    assert all(c.passed for c in experiments.result(step, rig).checks)
    run = experiments.result(heavy, rig)
    assert not all(c.passed for c in run.checks) and run.title == "z steps by 0.0003 m, M = 1.9, K = 12"
    assert rig.plant is DESIGN.PLANT


def test_a_fault_fails_any_experiment(rig: Rig) -> None:
    missing = Override(np.arange(2000) == 1200, np.nan)
    run = experiments.result(Hold({"z_ref": 1e-6}, conditions=Conditions(options={"overrides": {"z": missing}})), rig)
    assert checks(run)["samples with a fault bit"].value == 1 and checks(run)["largest |e_z|"].passed


def test_names_are_kept_apart_and_known(rig: Rig) -> None:
    step = StepResponse("z_ref", 1e-4, 0.1, 0.1)
    with pytest.raises(SignalError, match=r"two experiments are called 'step_z_ref_0\.0001'"):
        experiments.run(rig, [step, step], print)
    with pytest.raises(SignalError, match="no set-point 'z': name one of z_ref, x_ref"):
        experiments.result(StepResponse("z", 1e-4, 0.1, 0.1), rig)


def test_a_position_is_the_plant_state_and_not_the_biased_reading_of_its_sensor(rig: Rig) -> None:
    sensors = rig.stage.interface.sensors
    biased = rig.with_interface(sensors=tuple(replace(s, of=f"{s.name}_read") for s in sensors))
    assert biased.positions == {"z_ref": "z", "x_ref": "x"}
    gauges = tuple(replace(s, name=f"{s.name}_gauge") for s in sensors)
    points = tuple(replace(s, of=f"{s.of}_gauge") for s in rig.stage.interface.set_points)
    assert rig.with_interface(sensors=gauges, set_points=points).positions == {"z_ref": "z", "x_ref": "x"}


@pytest.mark.parametrize("limit", [-2e-4, 0.0, np.nan])
def test_a_limit_that_is_meant_as_a_set_point_is_refused(rig: Rig, limit: float) -> None:
    with pytest.raises(SignalError, match=r"hold_z_ref: the limit of \|y - r\| at 'z_ref' is .*: give a positive one"):
        experiments.result(Hold({"z_ref": limit}), rig)


@pytest.mark.parametrize("run", [StepResponse("z_ref", 5e-3, 0.1, 0.2), Track({"z_ref": Sine(5e-3, 6.0)}, 1e-5)])
def test_a_course_beyond_the_range_of_its_set_point_is_refused(rig: Rig, run: Any) -> None:
    with pytest.raises(SignalError, match=r"the course of set-point 'z_ref' reaches 0\.00.*; its range is -0\.000"):
        experiments.result(run, rig)


@pytest.mark.parametrize(
    "changed", [{"overshoot": 15}, {"settling_time_s": -0.5}, {"height": 0.0}, {"settling_time_s": np.nan}]
)
def test_a_step_with_a_number_that_cannot_be_meant_is_refused(changed: dict[str, float]) -> None:
    (name, value), good = *changed.items(), {"height": 1e-4, "overshoot": 0.1, "settling_time_s": 0.2}
    with pytest.raises(SignalError, match=f"{name} {value:g}.*: give an overshoot of at most 1"):
        StepResponse("z_ref", **(good | changed))


@pytest.mark.parametrize("changed", [{"overshoot": 15}, {"ramp_s": 0.0}, {"error": -1e-6}])
def test_a_lift_off_with_a_number_that_cannot_be_meant_is_refused(changed: dict[str, float]) -> None:
    (name, value), good = *changed.items(), {"ramp_s": 0.2, "overshoot": 0.1, "error": 1e-6}
    with pytest.raises(SignalError, match=f"lift_off: .*{name} {value:g}"):
        LiftOff({"z_ref": 0.0}, conditions=Conditions(), **(good | changed))


def test_an_experiment_that_ends_before_it_is_assessed_is_refused(rig: Rig) -> None:
    with pytest.raises(SignalError, match=r"assessed after 1 s, but it ends after 0\.05 s"):
        experiments.result(Hold({"x_ref": 1e-6}, 0.05, 1.0), rig)
