"""Inputs that are neither reading nor set-point, and cases of payloads, on the carrier of `carrier`."""

import json
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from synth import show, stage
from synth.analyse.loops import robustness
from synth.analyse.loops.robustness import Case
from synth.app import standard_tasks, tables, tune_jobs, verdicts
from synth.app.commands import Surveyed
from synth.base.progress import silent
from synth.declare.experiments import Conditions, Hold, Sine, Track
from synth.declare.tuning import Tuning
from synth.errors import SignalError
from synth.export import limits
from synth.report import template
from synth.signals import Parameter
from synth.simulate import experiments, sampling, study
from synth.simulate.integration import Integration
from synth.simulate.rig import Rig
from synth.simulate.sampling import Method, Sampling
from synth.simulate.study import StudyTable
from synth.stage import Actuator, Auxiliary, Sensor, consistency
from synth.verify import standard
from tests.stage.carrier import CASES, LIMITS, PLANT, STAGE, D, G, K, M, P, carrier


@pytest.fixture(scope="module")
def rig() -> Rig:
    return Rig(STAGE, PLANT, standard_tasks.compiled_controller(STAGE, np.float32))


def test_an_auxiliary_input_needs_no_coordinate_and_stands_between_set_points_and_actuators() -> None:
    assert [s.name for s in STAGE.interface.inputs] == list(LIMITS)
    assert STAGE.interface.constant_inputs(PLANT) == {"load": 0.0, "v_ff": 0.0}
    assert carrier(coordinates={"z": {"z": 1.0}}).coordinates


def test_a_bad_auxiliary_input_never_latches(rig: Rig) -> None:
    good = {"z": 0.0, "z_ref": 0.0, "load": 0.5, "v_ff": 0.0}
    for bad in (np.nan, np.inf, 1.1, -0.1):
        inputs = {n: np.full(100, v, np.float32) for n, v in good.items()}
        inputs["load"][10:] = bad
        replayed = rig.controller.replay(inputs)
        assert np.ptp(replayed.outputs["i"]) == 0.0 and replayed.outputs["i"][0] == np.float32(2.5 * G / K)
        assert (replayed.faults[:10] == 0).all() and (replayed.faults[10:] != 0).all()
        assert not replayed.state["guard_latched"]


def test_the_law_is_proved_equal_with_its_auxiliary_inputs() -> None:
    run = Hold({"z_ref": 1e-6}, duration_s=0.2, after_s=0.1)
    evidence = standard.verify(replace(STAGE, experiments=[run]), silent, whole=False)
    assert [c for c in evidence.checks if not c.passed] == [] and len(evidence.checks) > 10


def test_margins_are_taken_in_every_case_at_the_corners_of_what_it_leaves_open() -> None:
    survey = verdicts.survey(STAGE)
    assert survey is not None and not survey.unsolved
    cases = [loop.case for loop in survey.loops if loop.signal == "i"]
    ends = {"m": 1.9}, {"m": 2.1}
    declared = [(name, {**case, **end}) for name, case in CASES.items() for end in ({}, *ends)]
    expected = [("", {}), *(("", end) for end in ends), *declared]
    assert [c.name for c in cases] == [name for name, _ in expected]
    assert [c.values for c in cases] == [{k: pytest.approx(v) for k, v in values.items()} for _, values in expected]
    # The crossover is in proportion to (m + load) / (m + payload): of 2.0, and of 2.0 / 2.2 where it is unannounced.
    gains = {loop.case.text: loop.margins.gain_margin for loop in survey.loops if loop.signal == "i"}
    assert gains[", loaded, payload = 1, load = 1"] == pytest.approx(gains[""], rel=1e-9)
    assert gains[", unannounced, payload = 0.2"] == pytest.approx(gains[""] * 1.1, rel=1e-9)


def test_the_case_of_the_least_margin_is_named_and_tuning_judges_by_it(capsys: pytest.CaptureFixture[str]) -> None:
    """A load that is announced and not there raises the crossover by (m + load) / m = 1.5."""
    light = carrier(cases={"light": {"load": 1.0}}, tolerances=[], require={"gain_margin": 1.0})
    survey, closed = verdicts.survey(light), verdicts.closed_loops(light)
    assert survey is not None
    nominal, least = (loop.margins.gain_margin for loop in survey.loops if loop.signal == "i")
    checks = verdicts.margins(light, survey)
    surveyed = Surveyed(light.name, closed, survey, checks)
    tables.print_margins(light.name, closed, survey, checks)
    text, labels = capsys.readouterr().out, [str(row[0]) for t in _tables(template.loops(survey)) for row in t.rows]
    assert "gain margin: the least of 4 loops, at i, middle, light, load = 1" in text
    assert "middle, light, load = 1" in labels and "middle, light, load = 1" in [c.place for c in closed]
    assert "at i, middle, light, load = 1" in json.dumps(surveyed.document()["checks"])
    tuning = Tuning((), lambda values: light.controller, require={"disk_margin": 0.1})
    goals = {goal.name: goal for goal in tune_jobs.margin_goals(light, tuning)}
    assert goals["gain_margin"].value == least == pytest.approx(nominal / 1.5, rel=1e-9)
    assert goals["disk_margin"].value == min(each["both"].lower for each in survey.disks.values())
    lost = replace(light, cases={"heavy": {"payload": 1.0}})  # sags by 1.2 mm, beyond the sensor: no equilibrium
    assert [goal.value for goal in tune_jobs.margin_goals(lost, tuning)] == [1.0, 0.0]


def _tables(section: Any) -> list[show.Table]:
    blocks = [block for each in (section, *section.sections) for block in each.blocks]
    return [block for block in blocks if isinstance(block, show.Table)]


@pytest.mark.parametrize(
    ("case", "e"), [({}, 0.0), (CASES["loaded"], 0.0), (CASES["unannounced"], 0.2 * G / (2.0 * P))]
)
def test_the_loop_rests_where_the_equations_say(case: dict[str, float], e: float) -> None:
    rest = robustness.equilibrium_at(robustness.of_stage(STAGE), "middle", Case(case))
    assert rest.point["i"] == pytest.approx((M + case.get("payload", 0.0)) * G / K, rel=1e-9)
    assert rest.point["z"] == pytest.approx(-e, abs=1e-9)


def test_a_feedforward_is_a_course_of_an_auxiliary_input(rig: Rig) -> None:
    course, rate = Sine(2e-4, 60.0), Sine(2e-4 * 60.0, 60.0, np.pi / 2)
    plain, forward = (
        experiments.result(Track({"z_ref": course}, 1.0, 1.0, 0.5, Conditions(auxiliaries=courses)), rig)
        for courses in ({}, {"v_ff": rate})
    )
    plain_error, error = (r.checks[0].value for r in (plain, forward))
    # e / r = (s^2 + D s) / (s^2 + D s + P) without, s^2 / (s^2 + D s + P) with it; the delay adds some
    s = 60j
    mean = 2 / np.pi * 2e-4
    assert plain_error == pytest.approx(mean * abs((s * s + D * s) / (s * s + D * s + P)), rel=0.1)
    assert error < 1.2 * mean * abs(s * s / (s * s + D * s + P)) < plain_error
    assert forward.title == "Tracking of z, v_ff acts" and plain.title == "Tracking of z"


def test_machines_are_drawn_between_the_ends_of_a_payload(rig: Rig) -> None:
    names = sampling.quantities(rig)
    assert names == ("m", "payload", "offset.z")
    for method, ends in ((Method.UNIFORM, None), (Method.NORMAL, None), (Method.CORNERS, {0.0, 1.0})):
        z = sampling.draw(Sampling(50, method=method), len(names), range(50))
        plants_drawn = [sampling.machine(rig, dict(zip(names, row, strict=True)), 0, 1).plant for row in z]
        drawn = np.array([plant.parameter("payload").value for plant in plants_drawn])
        assert drawn.min() == 0.0 and drawn.max() <= 1.0 and drawn[0] == 0.0
        assert ends is None or set(drawn[1:]) == ends
    lopsided = Parameter("p", 1.0, "kg", (0.5, 3.0), "here")
    assert [lopsided.at(z) for z in (-1.2, -1, -0.5, 0, 0.5, 1, 1.2)] == [0.5, 0.5, 0.75, 1, 2, 3, 3]
    assert robustness.corners(PLANT, ["payload"]) == [Case({"payload": 0.0}), Case({"payload": 1.0})]


@pytest.fixture(scope="module")
def announcing() -> Rig:
    """The carrier whose input `load` tells the law the payload."""
    declared = carrier("payload", cases={"loaded": {"payload": 1.0}, "unannounced": {"payload": 1.0, "load": 0.0}})
    return Rig(declared, PLANT, standard_tasks.compiled_controller(declared, np.float32))


def studied(rig: Rig, *experiments: Any) -> StudyTable:
    return study.run(rig, experiments, Sampling(9, method=Method.CORNERS), range(9), Integration(4, 0.0, 4))


def test_the_machines_of_a_study_tell_their_payload(rig: Rig, announcing: Rig) -> None:
    """Planted: without `of` every payload is drawn behind the law's back, which sags by g payload / (m P)."""
    without_offset = (each.with_interface(sensors=(Sensor("z", "z"),)) for each in (rig, announcing))
    without, table = (studied(each, Hold({"z_ref": 2e-4}, 0.2, 0.1)) for each in without_offset)
    loaded = table.z["payload"] > 0
    assert loaded.any() and not loaded.all() and not table.errors and not without.errors
    assert (without.passed == ~loaded).all()
    # z rests at -(true - announced mass) g / (announced P): an announced payload leaves it to the tolerance of m alone
    rests = 0.05 * np.abs(table.z["m"]) * M * G / ((M + loaded) * P)
    np.testing.assert_allclose(table.checks["hold_z_ref: largest |e_z|"], rests, rtol=0.02, atol=1e-9)
    assert study.estimate_yield(table).share == 1.0


def test_a_case_and_conditions_may_give_another_value_than_the_parameter(announcing: Rig) -> None:
    for conditions, payload, load in (
        (Conditions(case="loaded"), 1.0, 1.0),
        (Conditions(case="unannounced"), 1.0, 0.0),
        (Conditions(parameters={"payload": 0.4}), 0.4, 0.4),
        (Conditions(parameters={"payload": 0.4}, auxiliaries={"load": 0.3}), 0.4, 0.3),
    ):
        run = experiments.result(Hold({"z_ref": 1.0}, 0.2, 0.1, conditions), announcing).trajectory
        sag = (payload - load) * G / ((M + load) * P)
        assert (run.measured["load"] == np.float32(load)).all() and run["z"][-1] == pytest.approx(
            max(-sag, -1e-3), abs=1e-7
        )
        assert sag > 1e-3 or (np.ptp(run["z"]) < 1e-8 and run.applied["i"][0] == pytest.approx((M + payload) * G / K))


def test_margins_tell_the_payload_at_the_ends_of_its_tolerance() -> None:
    survey = verdicts.survey(
        carrier("payload", cases={"unannounced": {"payload": 0.2, "load": 0.0}}, tolerances=["payload"])
    )
    assert survey is not None and not survey.unsolved
    gains = {loop.case.text: loop.margins.gain_margin for loop in survey.loops if loop.signal == "i"}
    same = [gains[text] for text in ("", ", payload = 0", ", payload = 1")]
    np.testing.assert_allclose(same, same[0], rtol=1e-9)
    assert gains[", unannounced, payload = 0.2, load = 0"] == pytest.approx(1.1 * same[0], rel=1e-9)


@pytest.mark.parametrize(
    ("auxiliary", "message"),
    [
        (
            Auxiliary("load", "kg", 0.0, 0.5, of="payload"),
            "'load' may be 0 .. 0.5 kg, and the parameter 'payload' that",
        ),
        (Auxiliary("load", "g", 0.0, 1000.0, of="payload"), "0 .. 1000 g, .* is 0 .. 1 kg: give it the unit of"),
        (Auxiliary("load", "kg", 0.0, 1.0, of="mass"), "no parameter 'mass'"),
    ],
)
def test_an_auxiliary_input_that_cannot_tell_its_parameter_is_refused(auxiliary: Auxiliary, message: str) -> None:
    with pytest.raises(SignalError, match=message):
        stage.interface(PLANT, sensors=[Sensor("z")], actuators=[Actuator("i", 0.0, 1.0)], auxiliaries=[auxiliary])


def test_a_case_beyond_what_its_input_can_tell_is_refused() -> None:
    light = Parameter("payload", 0.5, "kg", 0.1, "of the user")
    plant = replace(PLANT, parameters=(PLANT.parameters[0], light))
    with pytest.raises(SignalError, match=r"case 'full' has payload = 2, which the auxiliary input 'load' of 0 .. 1"):
        carrier("payload", plant, cases={"full": {"payload": 2.0}})
    assert carrier("payload", plant, cases={"full": {"payload": 2.0, "load": 1.0}}).cases


@pytest.mark.parametrize(
    "tolerance", [1.0, -0.1, np.nan, 5, (1.0, 2.0), (2.0, 1.0), (-np.inf, 1.0), (0.0, np.nan), [0.0, 1.0]]
)
def test_a_tolerance_that_cannot_be_meant_is_refused(tolerance: Any) -> None:
    with pytest.raises(
        SignalError, match=r"parameter 'p' has value 0.5 and .*: give a finite value, and a share of it"
    ):
        Parameter("p", 0.5, "kg", tolerance, "here")


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        (
            {"cases": {"full": {"mass": 1.0}}},
            "case 'full' gives 'mass', which is neither a parameter of plant 'carrier'",
        ),
        (
            {"cases": {"full": {"payload": 2.0}}},
            "case 'full' has payload = 2, beyond its range of 0 .. 1: choose one inside",
        ),
        ({"cases": {"full": {"load": 2.0}}}, "case 'full' has load = 2, beyond its range of 0 .. 1: choose one inside"),
        ({"cases": {"": {"payload": 0.5}}}, "a case has no name, by which conditions would choose it"),
        ({"cases": {"full": {"m": np.nan}}}, "case 'full' has m = nan, beyond its range"),
        (
            {"cases": {"full": {"payload": 1.2}}},
            "case 'full' has payload = 1.2, beyond its range of 0 .. 1: choose one",
        ),
        (
            {"experiments": [Hold({"z_ref": 1.0}, conditions=Conditions(case="full"))]},
            "hold_z_ref runs in case 'full', ",
        ),
    ],
)
def test_a_case_that_does_not_fit_is_refused_where_it_is_declared(changed: dict[str, Any], message: str) -> None:
    with pytest.raises(SignalError, match=message):
        carrier(**changed)


def test_an_auxiliary_input_with_the_name_of_a_parameter_is_refused() -> None:
    for name in ("payload", "m"):
        interface = replace(STAGE.interface, auxiliaries=(Auxiliary(name, "kg", 0.0, 1.0, 0.0),))
        clash = replace(STAGE, controller=replace(STAGE.controller, interface=interface), cases={})
        with pytest.raises(SignalError, match=f"'{name}' is an auxiliary input and a parameter of plant 'carrier'"):
            consistency.require_consistent(clash)


@pytest.mark.parametrize(
    ("course", "message"),
    [
        ({"lode": 1.0}, "the stage has no auxiliary input 'lode': name one of load, v_ff"),
        ({"load": 1.5}, "the course of auxiliary input 'load' reaches 1.5 kg; its range is 0 .. 1 kg"),
    ],
)
def test_a_course_that_no_auxiliary_input_takes_is_refused(rig: Rig, course: dict[str, float], message: str) -> None:
    with pytest.raises(SignalError, match=message):
        experiments.result(Hold({"z_ref": 1.0}, conditions=Conditions(auxiliaries=course)), rig)


def test_the_exported_loop_takes_auxiliary_inputs_from_its_client(rig: Rig) -> None:
    least = limits.of_stage(STAGE, rig.positions, rig.at_rest())
    assert [*least] == ["z_ref", "load", "v_ff"] and rig.at_rest()["load"] == 0.0
    assert least["load"].speed == 10.0 and least["load"].step == pytest.approx(0.1)  # its range of 1 kg in 0.1 s
