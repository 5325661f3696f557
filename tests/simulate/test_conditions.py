"""Time profiles of set-points and disturbances, and conditions as text."""

import numpy as np
import pytest

from synth.declare.experiments import Conditions, Ramp, Sine
from synth.errors import SignalError
from synth.simulate import conditions
from tests import levitator


def test_courses() -> None:
    time = np.array([0.0, 0.5, 1.0, 2.0])
    np.testing.assert_allclose(Ramp(1.0, 3.0, 0.5, 1.0)(time), [1, 1, 2, 3])
    np.testing.assert_allclose(Sine(2.0, np.pi, offset=1.0)(time), [1, 3, 1, 1], atol=1e-15)
    np.testing.assert_allclose(conditions.values(3.0, time), [3, 3, 3, 3])
    with pytest.raises(SignalError, match="give one, or one for each of 4 samples"):
        conditions.values([1.0, 2.0], time)


def test_conditions_as_text() -> None:
    under = Conditions({"z": 1e-4}, {"hum": Sine(0.2, 300.0)}, {"M": 1.6})
    assert under.text() == ", M = 1.6, z = 0.0001, hum acts"


def test_a_disturbance_beyond_the_range_of_its_plant_input_is_refused() -> None:
    hum, time = next(s for s in levitator.design().PLANT.inputs if s.name == "hum"), np.linspace(0, 1, 101)
    plant = levitator.design().PLANT
    within = conditions.forcing(plant, ["hum"], {"hum": Sine(hum.high, 2 * np.pi)}, time)
    assert callable(within["hum"]) and conditions.forcing(plant, ["hum"], {}, time) == {"hum": 0.0}
    with pytest.raises(SignalError, match=r"the disturbance 'hum' reaches .* give a smaller one"):
        conditions.forcing(plant, ["hum"], {"hum": -1.01 * hum.high}, time)


@pytest.mark.parametrize("duration_s", [0.0, -1.0, np.nan])
def test_a_ramp_that_takes_no_time_is_refused(duration_s: float) -> None:
    with pytest.raises(SignalError, match=f"a ramp lasts {duration_s} s: give a positive duration"):
        Ramp(0.0, 1.0, 0.1, duration_s)
