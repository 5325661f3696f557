"""Inputs that are neither reading nor set-point, cases of payloads, and runs that start where the loop rests.

A mass m with a payload on it is lifted by k i. Its law knows the payload by the input `load` and gives

    k i = (m + load) (g + P e + D (v_ff - dz/dt))

so that it rests, with a load that is not the payload, at e = (payload - load) g / ((m + load) P).
"""

import json
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import casadi as ca
import numpy as np
import pytest

from synth import plant as plants
from synth import show, stage
from synth.analyse.loops import robustness
from synth.analyse.loops.robustness import Case
from synth.app import standard_tasks, tables, tune_jobs, verdicts
from synth.app.commands import Surveyed
from synth.base.progress import silent
from synth.block import Block, Exprs, State, Step, build
from synth.declare.effects import Course
from synth.declare.experiments import Conditions, Hold, LiftOff, Ramp, Sine, StepResponse, Track
from synth.declare.stage import Stage
from synth.declare.tuning import Tuning
from synth.errors import NoEquilibriumError, SignalError
from synth.export import limits
from synth.plant import Plant
from synth.reference import guard
from synth.report import template
from synth.signals import Parameter, Signal
from synth.simulate import experiments, sampling, study
from synth.simulate.integration import Integration
from synth.simulate.rig import Rig
from synth.simulate.sampling import Method, Sampling
from synth.simulate.study import StudyTable
from synth.stage import Actuator, Auxiliary, Sensor, SetPoint, consistency
from synth.timing import Discrete
from synth.verify import standard

M, K, G, P, D, T = 2.0, 10.0, 9.81, 4e3, 140.0, 1e-3
PLANT = plants.build(
    "carrier",
    [Signal("z", "m", -1e-3, 1e-3), Signal("v", "m/s", -0.5, 0.5)],
    [Signal("i", "A", 0.0, 8.0)],
    [Signal("z", "m", -1e-3, 1e-3)],
    [Parameter("m", M, "kg", 0.05, "weighed"), Parameter("payload", 0.0, "kg", (0.0, 1.0), "of the user")],
    lambda x, u, p: ({"z": x["v"], "v": K * u["i"] / (p["m"] + p["payload"]) - G}, {"z": x["z"]}),
)
CASES = {"loaded": {"payload": 1.0, "load": 1.0}, "unannounced": {"payload": 0.2}}
LIMITS = {"z": (-1e-3, 1e-3), "z_ref": (-5e-4, 5e-4), "load": (0.0, 1.0), "v_ff": (-0.1, 0.1)}


def law(interface: stage.Interface) -> Block:
    held = [interface.held(name) for name in LIMITS]

    def step(u: Exprs, x: Exprs, k: Exprs) -> Step:
        velocity = (u["z_held"] - x["before"]) / T
        acceleration = G + P * (u["z_ref_held"] - u["z_held"]) + D * (u["v_ff_held"] - velocity)
        return Step({"i_demand": (M + u["load_held"]) * acceleration / K}, {"before": u["z_held"]})

    before = State(Signal("before", "m", -1e-3, 1e-3), 0.0)
    demand = Signal("i_demand", "A", -60.0, 60.0)
    return build("lift", Discrete(T), step, inputs=held, states=[before], outputs=[demand], tag="lift")


def reference(state: Any, inputs: Any) -> Any:
    values, after, word = guard.standard(state, inputs, LIMITS, "z", 5)
    acceleration = (
        G + P * (values["z_ref"] - values["z"]) + D * (values["v_ff"] - (values["z"] - state["lift_before"]) / T)
    )
    i = np.clip((M + values["load"]) * acceleration / K, 0.0, 8.0)
    latched = after["guard_latched"] > 0
    out, last = guard.slew(state, {"i": i}, latched, 100.0 * T)
    return after | guard.frozen(state, {"lift_before": values["z"]}, latched) | last, out, word


SENSORS = (Sensor("z", offset=2e-6),)


def carrier(of: str = "", plant: Plant = PLANT, sensors: Sequence[Sensor] = SENSORS, **changed: Any) -> Stage:
    interface = stage.interface(
        plant,
        sensors=sensors,
        set_points=[SetPoint("z_ref", of="z", low=-5e-4, high=5e-4)],
        auxiliaries=[
            Auxiliary("load", "kg", 0.0, 1.0, about="on the carrier", of=of),
            Auxiliary("v_ff", "m/s", -0.1, 0.1),
        ],
        actuators=[Actuator("i", safe=0.0, slew_per_s=100.0)],
        safe_output_effect="the carrier comes down",
    )
    fields: dict[str, Any] = {
        "reference": reference,
        "operating_points": {"middle": {"z": 0.0}},
        "cases": CASES,
        "tolerances": ["m"],
        "stops": {"z": (-1e-3, 1e-3)},
        "coordinates": {},
    }
    controller = stage.controller("carrier", Discrete(T), interface, [law(interface)])
    return stage.design(controller, plant, **(fields | changed))


STAGE = carrier()


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


@pytest.mark.parametrize("case", ["", "loaded", "unannounced"])
def test_a_run_starts_at_rest_with_its_current(rig: Rig, case: str) -> None:
    values = CASES.get(case, {})
    run = experiments.result(Hold({"z_ref": 1e-2}, 0.3, 0.1, Conditions(case=case)), rig).trajectory
    assert run.applied["i"][0] == pytest.approx((M + values.get("payload", 0.0)) * G / K, rel=1e-6)
    assert np.ptp(run["z"]) < 1e-9 and np.ptp(run["i"]) < 1e-4 and (run.faults == 0).all()
    assert (run.measured["load"] == values.get("load", 0.0)).all()
    after_init = rig.run(0.3)
    assert np.ptp(after_init["z"]) > 4e-6  # falls by g T^2 / 2 = 5 um in the first sample, without a current
    peaks = experiments.ratios(rig.controller, run.measured, run.initial)
    assert peaks["lift_before"] == pytest.approx(abs(run["z"][0]) / 1e-3, abs=1e-6)


def test_a_run_from_a_stop_or_from_beyond_the_set_points_is_switched_on_there(rig: Rig) -> None:
    for start, begun in ((-1e-3, True), (-8e-4, True), (-5e-4, False)):
        held = experiments.result(Hold({"z_ref": 1.0}, 0.2, 0.1, Conditions(start={"z": start})), rig)
        run, where = held.trajectory, "on a stop" if start == -1e-3 else "out of the range of a set-point"
        assert held.title == f"z held, z = {start:g}" + (f", starts switched on {where}" if begun else "")
        assert (run.applied["i"][0] == 0.0) == begun == (not run.initial)
    lift = LiftOff({"z_ref": 4e-4}, 0.1, 0.1, 1e-5, Conditions(start={"z": 0.0}))
    lifted = experiments.result(lift, rig)
    assert lifted.trajectory.applied["i"][0] == 0.0 and lifted.title == "Start, z = 0"
    assert lifted.about.endswith("; starts switched on")


def single(step: Any, states: list[State], physics: Any = None, **limits: Any) -> Rig:
    """Return a rig of a mass with x'' = i - 9.81 under a law of y, r and its states, `b` the position a sample ago."""
    x, i = Signal("x", "m", -1e-2, 1e-2), Signal("i", "A", -50, 50)
    plant = plants.build(
        "mass", [x, Signal("v", "m/s", -5, 5)], [i], [x], [],
        physics or (lambda x, u, p: ({"x": x["v"], "v": u["i"] - G}, {"x": x["x"]})),
    )  # fmt: skip
    interface = stage.interface(
        plant,
        sensors=[Sensor("x")],
        set_points=[SetPoint("r", of="x", low=-1e-3, high=1e-3)],
        actuators=[Actuator("i", safe=0.0, slew_per_s=100.0)],
    )
    held, before = [interface.held("x"), interface.held("r")], State(Signal("b", "m", -1e-2, 1e-2), 0.0)

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        demand, after = step(u["x_held"], u["r_held"], (u["x_held"] - x["b"]) / T, x)
        return Step({"i_demand": demand}, {"b": u["x_held"]} | after)

    block = build("law", Discrete(T), law, inputs=held, states=[before, *states], outputs=[interface.demand("i")])
    controller = stage.controller("mass", Discrete(T), interface, [block])
    declared = stage.design(controller, plant, operating_points={"middle": {"x": 0.0}}, **limits)
    return Rig(declared, plant, standard_tasks.compiled_controller(declared, np.float32))


def state(name: str, start: float = 0.0) -> State:
    return State(Signal(name, "1", -20, 20), start)


def pd(y: Any, r: Any, v: Any) -> Any:
    return G + 4e3 * (r - y) - 80 * v


LAWS: dict[str, tuple[bool, Any, list[State]]] = {
    "rests": (True, lambda y, r, v, x: (pd(y, r, v), {}), []),
    "holds a number": (True, lambda y, r, v, x: (pd(y, r, v) + x["s"], {"s": x["s"]}), [state("s", 0.1)]),
    "of the wrong sign": (False, lambda y, r, v, x: (G + 3.0 * (y - r), {}), []),
    "slowly unstable": (False, lambda y, r, v, x: (G + 4e3 * (r - y) + 2.0 * v, {}), []),
    "with a dither": (False, lambda y, r, v, x: (pd(y, r, v) + x["s"], {"s": -x["s"]}), [state("s", 0.1)]),
    "with a sine": (
        False,
        lambda y, r, v, x: (
            pd(y, r, v) + x["s"],
            {"s": np.cos(0.1) * x["s"] - np.sin(0.1) * x["c"], "c": np.sin(0.1) * x["s"] + np.cos(0.1) * x["c"]},
        ),
        [state("s", 0.1), state("c")],
    ),
    "that counts": (
        False,
        lambda y, r, v, x: (pd(y, r, v), {"n": ca.if_else(x["n"] >= 9, 0, x["n"] + 1)}),
        [State(Signal("n", "1", 0, 20), 0.0, integer=True)],
    ),
    "of a relay": (False, lambda y, r, v, x: (G + ca.if_else(r - y - 0.02 * v > 0, 2.0, -2.0), {}), []),
}


@pytest.mark.parametrize("law", LAWS)
def test_a_law_that_would_not_stay_at_rest_is_switched_on(law: str) -> None:
    """A run that started at an equilibrium to which none leads would show neither an instability nor an oscillator."""
    rests, step, states = LAWS[law]
    held = experiments.result(Hold({"r": 1.0}, 0.3, 0.1), single(step, states))
    run, switched_on = held.trajectory, "switched on where the loop has no stable equilibrium"
    assert held.about.endswith(f"; starts {run.begun}") and (law != "rests" or held.title == "x held")
    assert run.begun.startswith("at the loop's equilibrium" if rests else switched_on)
    assert rests or held.title == f"x held, starts {switched_on}"
    assert bool(run.initial) == rests and (run.applied["i"][0] == 0.0) == (not rests)
    assert rests or np.ptp(run["x"]) > 4e-6  # falls by g T^2 / 2
    if law in ("with a dither", "with a sine"):
        assert np.ptp(run["i"][-100:]) == pytest.approx(0.2, rel=0.2)


def test_a_loop_that_would_rest_beyond_a_stop_is_switched_on() -> None:
    sagging = single(lambda y, r, v, x: (4e3 * (r - y) - 80 * v, {}), [], stops={"x": (-2e-3, 2e-3)})
    run = experiments.result(Hold({"r": 1.0}, 0.3, 0.1), sagging).trajectory  # by g / P = 2.45 mm
    assert not run.initial and run["x"][0] == 0.0 and run["x"][-1] == -2e-3
    free = single(lambda y, r, v, x: (4e3 * (r - y) - 80 * v, {}), [], stops={"x": (-3e-3, 3e-3)})
    held = experiments.result(Hold({"r": 1.0}, 0.3, 0.1), free)
    run = held.trajectory
    assert held.title == "x held, starts at the loop's equilibrium, x = -0.002453 m"  # -g / P
    assert "starts at the loop's equilibrium, x = -0.002453 m" in run.sheet().lines
    assert run["x"][0] == pytest.approx(-G / 4e3) and np.ptp(run["x"]) < 1e-8


def test_a_sensor_that_wraps_shows_its_first_turn_at_rest(rig: Rig) -> None:
    wrapping = rig.with_interface(sensors=(Sensor("z", of="z", wraps=2e-4, low=-1e-4, high=1e-4),))
    starts = {0.0: True, 9e-5: True, -1e-4: True, 1.1e-4: False, -1.1e-4: False, 3e-4: False}
    assert {z: not wrapping.unrest({"z": z}) for z in starts} == starts


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


def test_a_run_starts_at_rest_under_a_feedforward_that_moves_and_at_the_value_of_one_that_does_not(rig: Rig) -> None:
    """A constant v_ff displaces this law by D v_ff / P; one that moves at once was 0 before."""

    def title(course: Course) -> str:
        return experiments.result(Hold({"z_ref": 1.0}, 0.1, 0.05, Conditions(auxiliaries={"v_ff": course})), rig).title

    rests = "z held, v_ff acts, starts at the loop's equilibrium, z = {:.4g} m"
    v = 0.012
    assert title(v) == title(Ramp(v, 0.0, 0.05, 0.05)) == rests.format(D * v / P)
    assert title(Sine(v, 60.0, np.pi / 2)) == title(Ramp(v, 0.0, 0.0, 0.05)) == "z held, v_ff acts"


def test_the_error_of_a_gauge_is_no_overshoot_to_the_final_value(rig: Rig) -> None:
    step = StepResponse("z_ref", 2e-5, overshoot=0.01, settling_time_s=0.3, error=3e-6)
    wrong = replace(rig, offsets={"z": -2e-6})
    to_set_point, to_final = (experiments.result(replace(step, to_final=f), wrong) for f in (False, True))
    by_kind = {f: {c.name: c for c in r.checks} for f, r in ((False, to_set_point), (True, to_final))}
    assert by_kind[False]["overshoot"].value == pytest.approx(0.1, abs=0.005) and not by_kind[False]["overshoot"].passed
    assert all(c.passed for c in to_final.checks) and by_kind[True]["overshoot"].value < 0.005
    assert to_set_point.figures["overshoot to the final value, 1"] == by_kind[True]["overshoot"].value
    assert to_final.figures["settling time to the set-point, s"] == np.inf
    assert by_kind[True]["|e_z| at the end"].value == pytest.approx(2e-6, rel=1e-3)
    with pytest.raises(
        SignalError, match=r"step_z_ref_2e-05: a response to its final value may end anywhere: give `err"
    ):
        replace(step, error=None, to_final=True)


@pytest.mark.parametrize(("push", "moves"), [(-0.2, True), (-0.45, True), (-0.55, False), (-1.0, False), (-1.5, False)])
def test_a_position_that_does_not_follow_does_not_settle_at_its_final_value(rig: Rig, push: float, moves: bool) -> None:
    """A force that acts from the step on takes away a share of it: e = force / (m P)."""
    plant = plants.build(
        "pushed", list(PLANT.states), [*PLANT.inputs, Signal("push", "N", -9, 9)], list(PLANT.outputs),
        list(PLANT.parameters),
        lambda x, u, p: ({"z": x["v"], "v": (K * u["i"] + u["push"]) / p["m"] - G}, {"z": x["z"]}),
    )  # fmt: skip
    pushed = replace(rig, plant=plant).with_interface(plant=plant, disturbances=("push",))
    pushed = replace(pushed, stage=replace(pushed.stage, plant=plant))
    course = Ramp(0.0, push * 1e-4 * M * P, 0.3, 1e-6)
    step = StepResponse("z_ref", 1e-4, 0.1, 0.3, 1e-3, Conditions(disturbances={"push": course}), to_final=True)
    checks = {c.name: c for c in experiments.result(step, pushed).checks}
    assert checks["|e_z| at the end"].value == pytest.approx(-push * 1e-4, rel=0.01)
    assert checks["settling time"].passed == checks["overshoot"].passed == moves


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


def test_a_sensor_that_is_out_of_range_at_rest_is_named_with_its_reading() -> None:
    """It sags by g payload / (M P) = 1.23 mm, beyond its sensor; and a second sensor shows 3 z, beyond its range."""
    sags = carrier(cases={"heavy": {"payload": 1.0}}, tolerances=[])
    message = r"would balance where sensor 'z' reads -0\.00122625 of -0\.001 .. 0\.001 m, .*give the sensor a range"
    with pytest.raises(NoEquilibriumError, match=message):
        robustness.equilibrium_at(robustness.of_stage(sags), "middle", Case(sags.cases["heavy"]))
    tripled = Signal("y", "m", -3e-3, 3e-3)
    plant = plants.build(
        "carrier", list(PLANT.states), list(PLANT.inputs), [*PLANT.outputs, tripled], list(PLANT.parameters),
        lambda x, u, p: (
            {"z": x["v"], "v": K * u["i"] / (p["m"] + p["payload"]) - G}, {"z": x["z"], "y": 3 * x["z"]}
        ),
    )  # fmt: skip
    for high, reads in ((1.2e-3, False), (1.21e-3, True)):
        sensors = (Sensor("z"), Sensor("far", of="y", low=-1e-3, high=high))
        stage_ = carrier(plant=plant, sensors=sensors, operating_points={"up": {"z": 4.02e-4}}, cases={})
        loops = robustness.of_stage(stage_)
        if reads:
            assert robustness.equilibrium_at(loops, "up").inputs["far"] == pytest.approx(1.206e-3)
        else:
            with pytest.raises(NoEquilibriumError, match=r"sensor 'far' reads 0\.001206 of -0\.001 .. 0\.0012 m"):
                robustness.equilibrium_at(loops, "up")


def test_an_auxiliary_input_with_the_name_of_a_parameter_is_refused() -> None:
    for name in ("payload", "m"):
        interface = replace(STAGE.interface, auxiliaries=(Auxiliary(name, "kg", 0.0, 1.0, 0.0),))
        clash = replace(STAGE, controller=replace(STAGE.controller, interface=interface), cases={})
        with pytest.raises(SignalError, match=f"'{name}' is an auxiliary input and a parameter of plant 'carrier'"):
            consistency.require_consistent(clash)


@pytest.mark.parametrize("start", [{"v": 0.01}, {"v": -1e-3, "z": 2e-4}, {"z": 9e-4}])
def test_a_run_that_begins_in_motion_or_out_of_reach_is_switched_on_there(rig: Rig, start: dict[str, float]) -> None:
    held = experiments.result(Hold({"z_ref": 1.0}, 0.1, 0.05, Conditions(start=start)), rig)
    run, where = held.trajectory, "in motion" if "v" in start else "out of the range of a set-point"
    assert held.title.endswith(f", starts switched on {where}")
    assert not run.initial and run.applied["i"][0] == 0.0
    assert {name: run[name][0] for name in start} == start


def test_a_position_that_is_an_output_may_be_out_of_reach(rig: Rig) -> None:
    """y = 2 z is no state: z = 4e-4 is beyond a set-point of y up to 5e-4."""
    signals = [Signal("y", "m", -2e-3, 2e-3)]
    plant = plants.build(
        "scaled", list(PLANT.states), list(PLANT.inputs), signals, list(PLANT.parameters),
        lambda x, u, p: ({"z": x["v"], "v": K * u["i"] / (p["m"] + p["payload"]) - G}, {"y": 2 * x["z"]}),
    )  # fmt: skip
    sensors, points = (Sensor("z", of="y", low=-1e-3, high=1e-3),), (SetPoint("z_ref", of="y", low=-5e-4, high=5e-4),)
    read = replace(rig, plant=plant).with_interface(plant=plant, sensors=sensors, set_points=points)
    read = replace(read, stage=replace(read.stage, plant=plant))
    assert [not read.unrest({"z": z}) for z in (0.0, 2e-4, 2.5e-4, 2.6e-4, -4e-4)] == [True, True, True, False, False]


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


def test_a_state_that_the_controller_does_not_have_is_refused(rig: Rig) -> None:
    with pytest.raises(SignalError, match="'carrier' has no state 'lift_after': it has guard_last_z"):
        rig.run(0.1, state={"lift_after": 1.0})


def test_the_exported_loop_takes_auxiliary_inputs_from_its_client(rig: Rig) -> None:
    least = limits.of_stage(STAGE, rig.positions, rig.at_rest())
    assert [*least] == ["z_ref", "load", "v_ff"] and rig.at_rest()["load"] == 0.0
    assert least["load"].speed == 10.0 and least["load"].step == pytest.approx(0.1)  # its range of 1 kg in 0.1 s


LAG = 1e-3  # s


def test_states_that_nothing_names_are_as_the_equilibrium_needs_them(rig: Rig) -> None:
    """The currents of the coils are states, and `start` leaves them out."""
    coil = plants.build(
        "carrier",
        [*PLANT.states, Signal("c", "A", -1.0, 9.0)],
        list(PLANT.inputs),
        list(PLANT.outputs),
        list(PLANT.parameters),
        lambda x, u, p: (
            {"z": x["v"], "v": K * x["c"] / (p["m"] + p["payload"]) - G, "c": (u["i"] - x["c"]) / LAG},
            {"z": x["z"]},
        ),
    )
    interface = replace(STAGE.interface, plant=coil)
    controller = replace(STAGE.controller, interface=interface)
    lagging = Rig(replace(STAGE, plant=coil, controller=controller), coil, rig.controller)
    run = experiments.result(Hold({"z_ref": 1e-5}, 0.2, 0.1), lagging).trajectory
    assert run["c"][0] == pytest.approx(M * G / K) == run.applied["i"][0] and np.ptp(run["z"]) < 1e-9
