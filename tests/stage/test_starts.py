"""Runs that start where the loop rests, on a stop or in motion, and what counts as settled, on `carrier`."""

from dataclasses import replace
from typing import Any

import casadi as ca
import numpy as np
import pytest

from synth import plant as plants
from synth import stage
from synth.analyse.loops import robustness
from synth.analyse.loops.robustness import Case
from synth.app import standard_tasks
from synth.block import Exprs, State, Step, build
from synth.declare.effects import Course
from synth.declare.experiments import Conditions, Hold, LiftOff, Ramp, Sine, StepResponse
from synth.errors import NoEquilibriumError, SignalError
from synth.signals import Signal
from synth.simulate import experiments
from synth.simulate.rig import Rig
from synth.stage import Actuator, Sensor, SetPoint
from synth.timing import Discrete
from tests.stage.carrier import CASES, PLANT, STAGE, D, G, K, M, P, T, carrier


@pytest.fixture(scope="module")
def rig() -> Rig:
    return Rig(STAGE, PLANT, standard_tasks.compiled_controller(STAGE, np.float32))


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


def test_a_state_that_the_controller_does_not_have_is_refused(rig: Rig) -> None:
    with pytest.raises(SignalError, match="'carrier' has no state 'lift_after': it has guard_last_z"):
        rig.run(0.1, state={"lift_after": 1.0})


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
