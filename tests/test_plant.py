"""A plant's functions compute the physics that it was given, in the order of its signals."""

from collections.abc import Mapping

import casadi as ca
import numpy as np
import pytest

from synth import plant
from synth.errors import SignalError
from synth.signals import Parameter, Signal

STATES = (Signal("angle", "rad", -1, 1), Signal("rate", "rad/s", -5, 5))
INPUTS = (Signal("torque", "N m", -2, 2),)
OUTPUTS = (Signal("height", "m", 0, 2),)
PARAMETERS = (Parameter("length", 0.5, "m", 0.01, "drawing"), Parameter("mass", 2.0, "kg", 0.02, "scale"))
Exprs = Mapping[str, ca.SX]


def pendulum(x: Exprs, u: Exprs, p: Exprs) -> tuple[dict[str, ca.SX], dict[str, ca.SX]]:
    inertia = p["mass"] * p["length"] ** 2
    acceleration = u["torque"] / inertia - 9.81 / p["length"] * ca.sin(x["angle"])
    # The order of these entries is not that of the signals.
    return {"rate": acceleration, "angle": x["rate"]}, {"height": p["length"] * (1 - ca.cos(x["angle"]))}


def build(physics: plant.Physics = pendulum) -> plant.Plant:
    return plant.build("pendulum", STATES, INPUTS, OUTPUTS, PARAMETERS, physics)


def test_f_and_h_follow_the_order_of_the_signals() -> None:
    made = build()
    f = made.f([0.3, 0.7], [1.5], made.values).full().ravel()
    np.testing.assert_allclose(f, [0.7, 1.5 / (2 * 0.25) - 9.81 / 0.5 * np.sin(0.3)], rtol=1e-15)
    np.testing.assert_allclose(float(made.h([0.3, 0.7], [1.5], made.values)), 0.5 * (1 - np.cos(0.3)), rtol=1e-15)


def test_parameters_are_replaced_in_a_copy() -> None:
    made = build()
    heavy = made.with_parameters(mass=3.0)
    assert heavy.parameter("mass").value == 3.0 and made.parameter("mass").value == 2.0
    np.testing.assert_array_equal(heavy.values, [0.5, 3.0])
    assert heavy.parameter("mass").tolerance == 0.02
    with pytest.raises(SignalError, match="no parameter 'weight': it has length, mass"):
        made.with_parameters(weight=1.0)


@pytest.mark.parametrize(
    ("derivatives", "outputs", "text"),
    [
        ({"angle": 0}, {"height": 0}, r"derivatives: missing \['rate'\], not declared none"),
        ({"angle": 0, "rate": 0}, {"height": 0, "x": 0}, r"outputs: missing none, not declared \['x'\]"),
    ],
)
def test_a_missing_or_unknown_name_is_refused(derivatives: dict, outputs: dict, text: str) -> None:
    with pytest.raises(SignalError, match=text):
        build(lambda x, u, p: (derivatives, outputs))


def test_a_plant_without_parameters_works() -> None:
    made = plant.build("lag", STATES[:1], INPUTS, OUTPUTS, (), lambda x, u, p: ({"angle": -x["angle"]}, {"height": 1}))
    assert float(made.f([0.25], [0], made.values)) == -0.25
    assert float(made.h([0.25], [0], made.values)) == 1


def test_outputs_are_those_of_states_and_inputs_by_name() -> None:
    made = build()
    angles = np.array([0.0, 0.3, -0.3])
    np.testing.assert_allclose(made.output_values({"angle": angles})["height"], 0.5 * (1 - np.cos(angles)), atol=1e-15)
    assert made.output_values({"angle": 0.3, "torque": 1.0})["height"].shape == (1,)
    with pytest.raises(SignalError, match="no state or input 'tilt': it has angle, rate, torque"):
        made.output_values({"tilt": 0.1})


def test_an_output_called_like_a_state_is_that_state() -> None:
    """A biased reading under the state's name would be hidden by it in a trajectory and in the report."""
    signals, inputs = STATES[:1], (Signal("bias", "rad", -1, 1),)

    def biased(x: Exprs, u: Exprs, p: Exprs) -> tuple[dict[str, ca.SX], dict[str, ca.SX]]:
        return {"angle": ca.SX(0)}, {"angle": x["angle"] + u["bias"]}

    with pytest.raises(SignalError, match=r"output 'angle' of plant 'gauge' is not the state .*Sensor\('angle', of="):
        plant.build("gauge", signals, inputs, signals, (), biased)
    plant.build("gauge", signals, inputs, signals, (), lambda x, u, p: ({"angle": u["bias"]}, dict(x)))


def test_a_parameter_has_no_name_of_a_signal() -> None:
    twice = (*PARAMETERS, Parameter("height", 0.5, "m", 0.01, "drawing"))
    with pytest.raises(SignalError, match="'height' names a parameter and a signal: give the parameter another name"):
        plant.build("pendulum", STATES, INPUTS, OUTPUTS, twice, pendulum)


@pytest.mark.parametrize("unit", ["rad", "m/s", "rad/s^2", "Hz"])
def test_a_velocity_has_the_unit_of_its_position_per_second(unit: str) -> None:
    states = (STATES[0], Signal("rate", unit, -5, 5))
    with pytest.raises(SignalError, match=f"'angle' .rad. is 'rate', which is declared in {unit.replace('^', '.')}"):
        plant.build("pendulum", states, INPUTS, OUTPUTS, PARAMETERS, pendulum)
