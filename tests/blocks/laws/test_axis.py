"""Servo LQG axis: gains against an independent reference, specified properties, and refusals."""

from typing import Any

import casadi as ca
import numpy as np
import pytest

from synth import plant as plants
from synth import stage
from synth.analyse import operating_points
from synth.analyse.loops import loop, robustness
from synth.app import standard_tasks
from synth.blocks.laws import axis, axis_regulator
from synth.blocks.laws.axis_regulator import Regulator
from synth.declare.experiments import Conditions, Hold
from synth.declare.stage import Interface
from synth.errors import ModelError, SignalError
from synth.reference import servo
from synth.signals import Parameter, Signal
from synth.simulate import experiments
from synth.simulate.rig import Rig
from synth.stage import Actuator, Sensor, SetPoint
from synth.statespace import StateSpace
from synth.synthesise.feedback import lqr
from synth.synthesise.nonlinear import feedback_linearisation
from synth.timing import Discrete
from tests import levitator

TIME = Discrete(1 / 2000)
DESIGN: Any = levitator.design("levitator_2dof")
REFERENCE: Any = DESIGN.reference
Z, X = levitator.axes()
NOISE = axis.kalman(process={"v": 1e-3}, sensor={"q": 1e-12})


def mass(stiffness: float = 0.0) -> StateSpace:
    """Return a mass of 1 kg on a spring in N/m, from a force to its position."""
    states = [Signal("q", "m", -1, 1), Signal("v", "m/s", -1, 1)]
    spring = Parameter("k", stiffness, "N/m", 0.0, "test")
    body = plants.build(
        "mass",
        states,
        [Signal("f", "N", -10, 10)],
        [Signal("q", "m", -1, 1)],
        [spring],
        lambda x, u, p: ({"q": x["v"], "v": u["f"] - p["k"] * x["q"]}, {"q": x["q"]}),
    )
    return operating_points.linearise(body, operating_points.trim(body, {}, []))


def default_axis(model: Any = None, **changed: Any) -> axis.ServoLaw:
    arguments = {
        "modes": {0.0: 5.0},
        "weights": {"q": 1e8, "v": 1e2},
        "command_weight": 1e-2,
        "estimator": NOISE,
        "anti_windup": 10.0,
    }
    return axis.servo(mass() if model is None else model, **(arguments | changed))


def regulator_for(delay: int = 1, **changed: Any) -> Regulator:
    return axis_regulator.synthesise(default_axis(**changed).axes[0], TIME, delay)


@pytest.mark.parametrize("name", ["z", "x"])
def test_all_gains_are_those_of_the_reference(name: str) -> None:
    """Doubling, a filter and Ackermann's formula in 60 digits, written without the toolkit."""
    law = Z if name == "z" else X
    regulator, gains = (
        axis_regulator.synthesise(law.axes[0], TIME, 1),
        servo.gains(REFERENCE.Z if name == "z" else REFERENCE.X),
    )
    controller, k = regulator.controller, len(gains.on_eta[0])
    expected = {
        "on_eta": controller.C[:1, :k],
        "E": controller.B[:k, 3:4],
        "L": regulator.filter.L,
        "M": regulator.filter.M,
        "on_x": regulator.servo.K_x[:, :2],
        "on_late": regulator.servo.K_x[:, 2:],
    }
    for field, values in expected.items():
        np.testing.assert_allclose(values, getattr(gains, field), rtol=1e-13, err_msg=field)
    assert regulator.feedforward == pytest.approx(gains.on_r, rel=1e-13)


def test_the_delay_costs_poles_at_zero_and_nothing_else() -> None:
    undelayed = np.sort_complex(regulator_for(0).servo.poles)
    for delay in (1, 3):
        poles = sorted(regulator_for(delay).servo.poles, key=abs)
        zeros = 2 * delay  # the commands on their way, in the plant and in the estimator
        assert np.abs(poles[:zeros]).max() < 5e-2  # several at 0 scatter by the root of the precision
        np.testing.assert_allclose(np.sort_complex(poles[zeros:]), undelayed, atol=1e-6)


def test_without_an_internal_model_of_weight_the_gain_tends_to_the_delayed_lqr() -> None:
    """With slow modes the gain on the states and the command on its way is that of `lqrd` with the delay."""
    slow = regulator_for(1, modes={0.0: 1e-4}).servo.K_x
    optimal = lqr.lqrd(mass(), [1e8, 1e2], [1e-2], TIME.period_s, delay_s=TIME.period_s).K
    np.testing.assert_allclose(slow, optimal, rtol=1e-4)


@pytest.mark.parametrize(
    ("modes", "tolerance"), [({0.0: 5.0}, 0.01), ({60.0: 4.0}, 0.05), ({0.0: 5.0, 60.0: 4.0}, 0.25)]
)
def test_the_error_of_a_mode_decays_at_its_speed(modes: dict[float, float], tolerance: float) -> None:
    rates = np.log(regulator_for(0, modes=modes).undelayed.poles) / TIME.period_s
    for frequency, speed in modes.items():
        nearest = rates[np.argmin(np.abs(rates - complex(-speed, frequency)))]
        assert -nearest.real == pytest.approx(speed, rel=tolerance)
        assert abs(abs(nearest.imag) - frequency) < speed / 2


def test_the_modes_leave_no_error_in_another_plant() -> None:
    regulator = regulator_for(1, modes={0.0: 5.0, 60.0: 4.0}, model=mass(50.0))
    assert regulator.servo.steady.vanishes
    other = loop.sampled(mass(500.0), TIME.period_s, TIME.period_s)
    assert regulator.servo.steady_error_with(other).vanishes


def test_the_default_set_point_weight_cancels_the_pole_of_the_integrator() -> None:
    """The response to a step then has no slow tail: it is within 1 % long before exp(-5 t)."""
    tails = {b: settling(regulator_for(1, set_point_weight=b)) for b in (None, 0.0, 1.0)}
    assert tails[None] < 0.1 < min(tails[0.0], tails[1.0])


def settling(regulator: Regulator, samples: int = 4000) -> float:
    """Return the time after which a unit step stays within 1 %, in s."""
    plant, law = loop.sampled(mass(), TIME.period_s, TIME.period_s), regulator.controller
    x, c, y = np.zeros(len(plant.A)), np.zeros(len(law.A)), []
    for _ in range(samples):
        q = float(plant.C[0] @ x)
        u = np.array([q - 1, 0.0, q, 0.0, 1.0])  # error, limited, measured, excess, set-point
        u[1] = law.C[0] @ c + law.D[0] @ u
        c, x = law.A @ c + law.B @ u, plant.A @ x + plant.B[:, 0] * u[1]
        y.append(q)
    outside = np.flatnonzero(np.abs(np.array(y) - 1) > 0.01)
    return float((outside[-1] + 1) * TIME.period_s)


def test_the_predicted_states_are_those_of_the_plant() -> None:
    for delay in (0, 1, 2):
        regulator = regulator_for(delay)
        plant, law = loop.sampled(mass(), TIME.period_s, delay * TIME.period_s), regulator.controller
        x, c, seen, predicted = np.zeros(len(plant.A)), np.zeros(len(law.A)), [], []
        x[0] = 1e-3
        for _ in range(600):
            q = float(plant.C[0] @ x)
            u = np.array([q, 0.0, q, 0.0, 0.0])
            u[1] = law.C[0] @ c + law.D[0] @ u
            seen.append(x[:2])
            predicted.append(law.C[1:] @ c + law.D[1:] @ u)
            c, x = law.A @ c + law.B @ u, plant.A @ x + plant.B[:, 0] * u[1]
        errors = np.array(seen)[200 + delay :] - np.array(predicted)[200 : 600 - delay]
        assert np.abs(errors).max() < 1e-9


def around(**changed: Any) -> Interface:
    arguments = {
        "sensors": [Sensor("z"), Sensor("x")],
        "set_points": [SetPoint("z_ref", "z", -5e-4, 5e-4), SetPoint("x_ref", "x", -8e-4, 8e-4)],
        "actuators": [Actuator("i1", 0.0, 100.0), Actuator("i2", 0.0, 100.0)],
        "disturbances": ["hum"],
    }
    return stage.interface(DESIGN.PLANT, **(arguments | changed))


def test_the_state_bounds_of_a_saturated_axis_hold_and_have_the_right_magnitude() -> None:
    """The derived bounds hold for any input in range without the Block's own limits."""
    block = X.law(TIME, around()).blocks[0]
    bounds = np.array([s.signal.high for s in block.states if not s.integer])
    controller = axis_regulator.synthesise(X.axes[0], TIME, 1).controller
    signs = np.repeat(np.random.default_rng(1).choice([-1.0, 1.0], (500, 2)), 40, axis=0)
    x, largest = np.zeros(len(bounds)), np.zeros(len(bounds))
    for sign in signs:
        y, r = 1e-3 * sign[0], 8e-4 * sign[1]
        u = np.array([y - r, 0.0, y, 0.0, r])
        command = float(controller.C[0] @ x + controller.D[0] @ u)
        u[1] = np.clip(command, -2, 2)
        u[3] = u[1] - command
        x = controller.A @ x + controller.B @ u
        largest = np.maximum(largest, np.abs(x))
    assert (largest <= bounds).all() and (largest > 0.02 * bounds).all()


def two_coils() -> plants.Plant:
    """Return a beam on two coils whose forces depend on the gap: lift and tilt, both inputs in both."""
    states = [Signal("h", "m", -1e-3, 1e-3), Signal("vh", "m/s", -1, 1)]
    states += [Signal("a", "rad", -1e-2, 1e-2), Signal("va", "rad/s", -10, 10)]
    coils = [Signal(n, "A", -5, 5) for n in ("left", "right")]

    def physics(x: Any, u: Any, p: Any) -> Any:
        pull = [10 * ca.exp((x["h"] + sign * 0.1 * x["a"]) / 5e-3) * u[n] for sign, n in ((1, "left"), (-1, "right"))]
        return {"h": x["vh"], "vh": sum(pull), "a": x["va"], "va": 10 * (pull[0] - pull[1])}, {"h": x["h"], "a": x["a"]}

    return plants.build("beam", states, coils, [states[0], states[2]], [], physics)


def beam_axis(inverse: feedback_linearisation.Linearisation, name: str) -> axis.ServoLaw:
    noise = axis.kalman(process={f"v{name}": 1e-3}, sensor={name: 1e-12})
    weights = {name: 1e8, f"v{name}": 1e3}
    return axis.servo(
        inverse.chain(name), modes={0.0: 10.0}, weights=weights, command_weight=1e-2, estimator=noise, anti_windup=20.0
    )


def beam() -> tuple[plants.Plant, Interface, list[axis.ServoLaw]]:
    plant = two_coils()
    inverse = feedback_linearisation.of_plant(plant)
    interface = stage.interface(
        plant,
        sensors=[Sensor("h"), Sensor("a")],
        set_points=[SetPoint("h_ref", "h", -5e-4, 5e-4), SetPoint("a_ref", "a", -5e-3, 5e-3)],
        actuators=[Actuator("left", 0.0, 100.0), Actuator("right", 0.0, 100.0)],
    )
    return plant, interface, [beam_axis(inverse, name) for name in ("h", "a")]


def test_axes_of_one_inverse_are_decoupled_at_every_operating_point() -> None:
    plant, interface, laws = beam()
    controller = stage.controller("beam", TIME, interface, [axis.decouple(laws)])
    points = {"mid": {}, "corner": {"h": 5e-4, "a": 5e-3}}
    loops = robustness.open_loops(robustness.of_controller(controller, plant, points), ["h", "a"])
    by = {(o.point, o.signal): o.margin("modulus_margin") for o in loops}
    for name in ("h", "a"):
        assert by["mid", name] > 0.5 and by["corner", name] == pytest.approx(by["mid", name], rel=1e-3)


def test_an_axis_that_shares_its_inverse_is_refused_alone() -> None:
    _, interface, laws = beam()
    with pytest.raises(SignalError, match=r"also needs the demand of 'a': join the axes of h, a by axis\.decouple"):
        laws[0].law(TIME, interface)
    with pytest.raises(SignalError, match="do not share one feedback linearisation"):
        axis.decouple([laws[0], beam()[2][1]])
    with pytest.raises(SignalError, match="give one axis for each"):
        axis.decouple([laws[0], laws[0]])


def test_a_plant_that_the_command_does_not_influence_is_refused() -> None:
    stuck = StateSpace(
        np.array([[0.0, 1.0], [0.0, 0.0]]),
        np.array([[1.0], [0.0]]),
        np.array([[1.0, 0.0]]),
        np.zeros((1, 1)),
        ("q", "v"),
        ("f",),
        ("q",),
        mass().time,
    )
    with pytest.raises((ModelError, SignalError), match="v"):
        axis_regulator.synthesise(default_axis(stuck).axes[0], TIME)


def test_an_output_without_a_sensor_or_set_point_is_refused() -> None:
    for changed in ({"set_points": [SetPoint("z_ref", "z", -5e-4, 5e-4)]}, {"sensors": [Sensor("z")]}):
        with pytest.raises(SignalError, match="the axis of 'x' needs a sensor and a set-point"):
            X.law(TIME, around(**changed))


def test_the_document_contains_the_synthesised_gains() -> None:
    document = X.law(TIME, around()).gains(np.float32)["x"]
    assert document["delay_samples"] == 1 and document["speeds_per_s"] == [25.0, 20.0, 20.0]
    assert document["certificate"]["error_dies_out"] and document["states"][2] == "i2_late1"
    assert len(document["K"]) == len(document["states"]) == 8


def test_a_stage_that_wakes_away_from_zero_is_not_kicked() -> None:
    """At first the command is the safe value: x sags by 7 um at 0.7 mm, where its spring pulls, and z by 1 um."""
    design = DESIGN.DESIGN
    rig = Rig(design, DESIGN.PLANT, standard_tasks.compiled_controller(design, np.float64))
    away = Conditions(start={"z": -3e-4, "x": -7e-4})
    figures = experiments.result(Hold({"z_ref": 1e-5, "x_ref": 1e-5}, conditions=away), rig).figures
    assert figures["largest |e_z| from the start, m"] < 2e-6 and figures["largest |e_x| from the start, m"] < 1.1e-5
    assert figures["largest |i1|, A"] < 0.2 and figures["largest |i2|, A"] < 0.1
