"""Effects that a model lacks: each against its equation, and what a closed loop withstands."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import casadi as ca
import numpy as np
import pytest

from designs.maglev_5dof import design as maglev
from synth.app import standard_tasks
from synth.declare.effects import (
    RAMP_S,
    Amplifiers,
    Cable,
    Changed,
    CurrentLoops,
    Effect,
    Floor,
    Force,
    Mode,
    Readings,
)
from synth.declare.experiments import Conditions, Hold, Sine, Withstand
from synth.errors import DesignError, SignalError
from synth.simulate import conditions, effects, experiments
from synth.simulate.rig import Rig
from tests import levitator

DESIGN: Any = levitator.design("levitator_2dof")
PLANT = DESIGN.PLANT
M, X_MASS, K, S = (PLANT.parameter(name).value for name in ("M", "m", "k", "s"))
AT = {"z": 1e-4, "vz": 0.01, "x": -2e-4, "vx": 0.03, "i1": 0.4, "i2": -0.3, "hum": 0.1}


@pytest.fixture(scope="module")
def rig() -> Rig:
    stage = DESIGN.DESIGN
    return Rig(stage, PLANT, standard_tasks.compiled_controller(stage, np.float32))


def values(of: Rig, function: str, changed: Mapping[str, float]) -> dict[str, float]:
    """Return the rates or the outputs of a rig's plant by name, at AT with some values changed, others 0."""
    known = AT | dict(changed)
    x, u = ([known.get(s.name, 0.0) for s in group] for group in (of.plant.states, of.plant.inputs))
    results = np.asarray(getattr(of.plant, function)(x, u, of.plant.values)).ravel().tolist()
    names = [s.name for s in (of.plant.states if function == "f" else of.plant.outputs)]
    return dict(zip(names, results, strict=True))


def change(rig: Rig, effect: Effect, function: str = "f", **changed: float) -> dict[str, float]:
    """Return what an effect changes in the rates or outputs that the plant has without it."""
    before, after = values(rig, function, {}), values(effects.with_effects(rig, [effect]), function, changed)
    return {name: after[name] - v for name, v in before.items() if abs(after[name] - v) > 1e-12 * abs(v)}


def test_a_force_accelerates_its_position_alone(rig: Rig) -> None:
    assert change(rig, Force("x", 2.0), force_3=2.0) == {"vx": pytest.approx(2.0 / X_MASS)}
    assert change(rig, Force("z", 2.0), force_3=-1.0) == {"vz": pytest.approx(-1.0 / M)}


def test_a_cable_is_a_spring_with_a_preload(rig: Rig) -> None:
    changed = change(rig, Cable("x", 50.0, 3.0), cable_3=1.0)
    assert changed == {"vx": pytest.approx(-(50.0 * AT["x"] + 3.0) / X_MASS)}
    assert change(rig, Cable("x", 50.0, 3.0), cable_3=0.0) == {}


def test_inertias_add_up(rig: Rig) -> None:
    faults = replace(rig.stage.faults, inertias={"x": ("m", "M")})
    both = replace(rig, stage=replace(rig.stage, faults=faults))
    assert change(both, Force("x", 2.0), force_3=2.0) == {"vx": pytest.approx(2.0 / (X_MASS + M))}


def test_a_force_acts_beside_a_drive() -> None:
    """The inputs of the driven plant are the outputs of the drive, and the force is none of them."""
    stage = maglev.DESIGN
    loop = standard_tasks.rig(stage, stage.scalar)
    pushed = Hold({"x_ref": 1e-5}, 10.0, 8.0, Conditions(start={"y": 0.025}, effects=[Force("x", 30.0)]))
    run = experiments.result(pushed, loop)
    assert all(c.passed for c in run.checks) and len(run.trajectory.driven) == 12


@pytest.mark.parametrize("band", [(50.0, 1.0), (1.0, 1100.0), (-1.0, 5.0)])
def test_a_floor_beyond_half_of_the_rate_is_refused(rig: Rig, band: tuple[float, float]) -> None:
    with pytest.raises(DesignError, match="Hz: give a band up to half of the rate, 1000 Hz"):
        effects.with_effects(rig, [Floor(["x"], 0.1, *band)])


def test_a_floor_accelerates_its_positions(rig: Rig) -> None:
    changed = change(rig, Floor(["x", "z"], 0.1), floor_3=0.2, floor_4=-0.1)
    assert changed == {"vx": pytest.approx(0.2), "vz": pytest.approx(-0.1)}


def test_current_loops_lag_by_a_pole(rig: Rig) -> None:
    lagging = effects.with_effects(rig, [CurrentLoops(3e-4)])
    rates = values(lagging, "f", {"i1_4": 1.0, "i2_5": 0.2})
    assert rates["i1_4"] == pytest.approx((AT["i1"] - 1.0) / 3e-4) and rates["i2_5"] == pytest.approx(-0.5 / 3e-4)
    assert rates["vx"] == pytest.approx(values(rig, "f", {"i2": 0.2})["vx"])
    assert lagging.lagging == {"i1_4": "i1", "i2_5": "i2"}
    assert effects.with_effects(rig, [CurrentLoops(1e-6)]).plant.states == PLANT.states  # none within a substep
    short = effects.with_effects(rig, [CurrentLoops(5e-5)]).stage.substeps
    assert short * 5e-5 >= 5e-4 > rig.stage.substeps * 5e-5  # the steps follow the lag


def test_amplifiers_are_wrong_by_a_share_and_an_offset_of_either_sign(rig: Rig) -> None:
    signs = set()
    for seed in range(32):
        rates = values(effects.with_effects(replace(rig, seed=seed), [Amplifiers(0.02, 0.05)]), "f", {})
        force = (rates["vx"] - values(rig, "f", {})["vx"]) * X_MASS / K
        cases = {(g, b): g * 0.02 * AT["i2"] + b * 0.05 for g in (-1, 1) for b in (-1, 1)}
        signs |= {case for case, expected in cases.items() if abs(force - expected) < 1e-9}
    assert len(signs) == 4


def test_a_mode_has_its_frequency_and_damping_and_shows_in_the_sensors_of_its_position(rig: Rig) -> None:
    flexible = effects.with_effects(rig, [Mode("x", 180.0, 5e-3, -0.1)])
    x, u, p = (ca.SX.sym(n, flexible.plant.f.size1_in(i)) for i, n in enumerate("xup"))
    A = ca.Function("A", [x, u, p], [ca.jacobian(flexible.plant.f(x, u, p), x)])
    poles = np.linalg.eigvals(np.asarray(A(np.zeros(6), np.zeros(3), flexible.plant.values)))
    w = 2 * np.pi * 180
    assert np.abs(poles - w * complex(-5e-3, np.sqrt(1 - 25e-6))).min() < 1e-6
    rates = values(flexible, "f", {})
    assert rates["mode_rate_5"] == pytest.approx(-0.1 * rates["vx"]) and rates["vx"] == values(rig, "f", {})["vx"]
    assert values(flexible, "h", {"mode_4": 3e-6}) == {"z": AT["z"], "x": pytest.approx(AT["x"] + 3e-6)}


def test_readings_are_wrong_by_gain_ripple_and_noise(rig: Rig) -> None:
    wrong = Readings(["x"], gain_error=0.01, noise=3e-7, ripple=1e-6, pitch=1.3e-3)
    read = effects.with_effects(rig, [wrong])
    expected = AT["x"] + 1e-6 * np.sin(2 * np.pi * AT["x"] / 1.3e-3)
    assert values(read, "h", {}) == {"z": AT["z"], "x": pytest.approx(expected, rel=1e-12)}
    assert read.gain_errors == {"x": pytest.approx(0.01)} and [*read.sensor_noise(10)] == ["x"]
    assert read.sensor_noise(20_000)["x"].std() == pytest.approx(3e-7, rel=0.03)
    assert not rig.sensor_noise(10) and effects.with_effects(rig, [Readings(noise=1e-7)]).sensor_noise(2).keys() == {
        "z",
        "x",
    }


def test_a_changed_plant_is_the_one_that_its_function_makes(rig: Rig) -> None:
    heavier = Changed("payload", lambda plant, share: plant.with_parameters(M=M * (1 + 0.1 * share)))
    assert effects.with_effects(rig, [heavier.scaled(2.0)]).plant.parameter("M").value == pytest.approx(1.2 * M)


def test_each_size_is_scaled_and_nothing_else() -> None:
    unscaled = {"of", "course", "low_hz", "high_hz", "frequency_hz", "damping", "pitch", "name", "plant"}
    for effect in (
        Force("x", 2.0), Cable("x", 50.0, 3.0), Floor(["x"], 0.1), CurrentLoops(3e-4), Amplifiers(0.02, 0.05),
        Mode("x", 180.0, 5e-3, 0.1), Readings((), 1e-3, 1e-7, 1e-6), Changed("more", lambda plant, share: plant),
    ):  # fmt: skip
        before, after = vars(effect), vars(effect.scaled(3.0))
        assert {n for n, v in before.items() if after[n] == v} <= unscaled
        assert all(after[n] == pytest.approx(3 * v) for n, v in before.items() if n not in unscaled)


def test_courses_rise_and_a_floor_has_its_standard_deviation(rig: Rig) -> None:
    time = np.arange(0.0, 60.0, 1e-3)
    forcing = effects.with_effects(rig, [Force("x", Sine(2.0, 5.0), 0.5), Floor(["x", "z"], 0.1, 5.0, 40.0)]).forcing
    force, floor, other = (conditions.values(course, time) for course in forcing.values())
    risen = time >= RAMP_S
    np.testing.assert_allclose(force[risen], np.sin(5.0 * time[risen]))
    np.testing.assert_allclose(force[~risen], (time / RAMP_S * np.sin(5.0 * time))[~risen])
    power = np.abs(np.fft.rfft(floor[risen])) ** 2
    f = np.fft.rfftfreq(int(risen.sum()), 1e-3)
    assert floor[risen].std() == pytest.approx(0.1, rel=0.02) and floor[0] == 0.0
    assert power[(f >= 4.5) & (f <= 40.5)].sum() > 0.99 * power.sum()
    assert abs(np.corrcoef(floor, other)[0, 1]) < 0.05


def test_a_force_has_risen_before_the_step_of_a_short_step_response(rig: Rig) -> None:
    force = effects.with_effects(rig, [Force("x", 2.0)]).forcing["force_3"]
    for limit, risen_s in ((0.1, 0.1), (0.4, 0.4), (2.0, 2.0), (10.0, 2.0)):
        time = np.arange(0.0, 5 * limit, 1e-3)
        r = conditions.values(force, time) / 2.0
        assert (r[time >= risen_s] == 1.0).all() and r[0] == 0.0
        np.testing.assert_allclose(r[time < risen_s], (time / risen_s)[time < risen_s], atol=0.02)
    assert conditions.values(force, np.zeros(1)) == 0.0


def test_names_of_effects_give_way_to_those_of_the_plant(rig: Rig) -> None:
    plant = replace(PLANT, inputs=tuple(replace(s, name="force_3") if s.name == "i2" else s for s in PLANT.inputs))
    wires = {"i1": "i1", "force_3": "i2"}
    under = effects.with_effects(replace(rig, plant=plant, actuators=wires), [Force("x", 1.0), CurrentLoops(3e-4)])
    assert [s.name for s in under.plant.inputs] == ["i1", "force_3", "hum", "force_4"]
    assert [*under.forcing] == ["force_4"] and under.lagging == {"i1_4": "i1", "force_3_5": "force_3"}


@pytest.mark.parametrize(
    ("frequency", "damping"), [(50.0, 1e-3), (180.0, 5e-3), (600.0, 0.0), (950.0, 5e-3), (3e3, 0.02), (200.0, 8.0)]
)
def test_the_steps_follow_a_mode(rig: Rig, frequency: float, damping: float) -> None:
    steps = effects.with_effects(rig, [Mode("x", frequency, damping, 0.1)]).stage.substeps
    s = 2 * np.pi * frequency * np.roots([1.0, 2 * damping, 1.0]) * rig.period_s / steps
    growth = np.abs(1 + s + s**2 / 2 + s**3 / 6 + s**4 / 24)
    if damping < 1:  # ln |R(s)| is that of the mode and of what the method adds
        assert (np.abs(-np.log(growth) / np.abs(s) - damping) < 1.1 * max(1e-4, 0.1 * damping)).all()
    assert (growth <= 1).all()


@pytest.mark.parametrize(
    ("effect", "message"),
    [
        (lambda: Cable("x", np.nan), "give a finite stiffness and preload"),
        (lambda: Floor(["x"], -0.1), "give a finite rms from 0 on"),
        (lambda: CurrentLoops(-1e-4), "give a finite lag in s, from 0 on"),
        (lambda: CurrentLoops(np.nan), "give a finite lag"),
        (lambda: Amplifiers(np.inf), "give a finite gain and offset"),
        (lambda: Mode("x", -180.0, 5e-3, 0.1), "the frequency above 0"),
        (lambda: Readings(ripple=1e-6, pitch=0.0), "the pitch above 0"),
    ],
)
def test_a_size_that_cannot_be_meant_is_refused(effect: Any, message: str) -> None:
    with pytest.raises(SignalError, match=message):
        effect()


def test_what_is_no_effect_is_refused(rig: Rig) -> None:
    none: Any = "cable"
    with pytest.raises(DesignError, match=r"'cable' is no effect: give those of synth.declare.effects"):
        effects.with_effects(rig, [none])


def test_the_loop_carries_a_force_by_its_current(rig: Rig) -> None:
    held = Hold({"x_ref": 1e-7, "z_ref": 1e-7}, 3.0, 2.5, Conditions(effects=[Force("x", 2.0)]))
    run = experiments.result(held, rig)
    assert all(c.passed for c in run.checks)
    assert run.trajectory["i2"][-100:].mean() == pytest.approx(-2.0 / K, rel=1e-3)


def test_what_lags_starts_where_the_loop_rests(rig: Rig) -> None:
    run = experiments.result(Hold({"z_ref": 1e-5}, 0.1, 0.0, Conditions(effects=[CurrentLoops(3e-4)])), rig).trajectory
    assert run["i1_4"][0] == pytest.approx(0.03575) and np.ptp(run["i1_4"]) < 1e-4 and np.ptp(run["z"]) < 5e-8
    thrown = rig.run(0.1)
    assert np.ptp(thrown["z"]) > 1e-7


def test_the_largest_share_is_that_of_the_actuator(rig: Rig) -> None:
    """x carries K i2 = 16 N and, at its stop, S times the travel more."""
    push = Withstand("push", Conditions(effects=[Force("x", -4.0)]), 4.0, {"x_ref": 0.0})
    run, shares = experiments.run(rig, [push], lambda _: None)[0], experiments.largest_share(rig, push)
    assert all(c.passed for c in run.checks) and run.title == "In motion for 4 s, x = 0, Force on x"
    (what, share), most = *shares.items(), (K * 2.0 + S * 1e-3) / 4.0
    assert what == "largest share of the effects until impact on the stop of x, 1"
    assert 0.94 * most <= share <= most and run.figures[what] == share


def test_a_share_within_all_limits_and_one_that_is_nothing(rig: Rig) -> None:
    light, heavy = (Withstand("w", Conditions(effects=[Force("x", f)]), 3.0, {"x_ref": 0.0}) for f in (1e-3, 1e4))
    assert experiments.largest_share(rig, light) == {"largest share of the effects within all limits, 1": 16.0}
    assert [*experiments.largest_share(rig, heavy).values()] == [0.0]
    assert experiments.largest_share(rig, Hold({"x_ref": 1e-5})) == {}


def test_contact_and_a_fault_bit_fail_what_is_withstood(rig: Rig) -> None:
    pushed = experiments.result(Withstand("w", Conditions(effects=[Force("x", 40.0)]), 3.0), rig)
    assert {c.name for c in pushed.checks if not c.passed} >= {"impact on the stop of x"}
    allowed = Withstand("w", Conditions(effects=[Force("x", 40.0)]), 3.0, impacts={"x": 10.0})
    assert "impact on the stop of x" not in {c.name for c in experiments.result(allowed, rig).checks if not c.passed}
    flexible = experiments.result(Withstand("w", Conditions(effects=[Mode("z", 180.0, 5e-3, 2.0)]), 1.0), rig)
    assert "samples with a fault bit" in {c.name for c in flexible.checks if not c.passed}


@pytest.mark.parametrize(
    ("effect", "message"),
    [
        (Force("y", 1.0), "an effect acts on 'y', which is no position with a rate: name one of z, x"),
        (Mode("vz", 100.0, 0.01, 0.1), "an effect acts on 'vz', which is no position"),
        (Readings(["y"], noise=1e-7), "an effect acts on the sensor 'y': name some of z, x"),
    ],
)
def test_an_effect_on_what_the_machine_does_not_have_is_refused(rig: Rig, effect: Effect, message: str) -> None:
    with pytest.raises(DesignError, match=message):
        effects.with_effects(rig, [effect])


def test_a_force_on_an_unknown_inertia_is_refused(rig: Rig) -> None:
    faults = replace(rig.stage.faults, inertias={"z": "M"})
    with pytest.raises(DesignError, match=r"a force acts on 'x', whose inertia is not known: give FaultCampaign\(ine"):
        effects.with_effects(replace(rig, stage=replace(rig.stage, faults=faults)), [Cable("x", 1.0)])
