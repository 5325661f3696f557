"""The controller in leapfrog coordinates against that in companion form, and the sizes of what is emitted."""

import numpy as np
import pytest

from synth.statespace import StateSpace
from synth.synthesise.regulation import anti_windup, servo
from synth.timing import Continuous
from tests import tolerances

T = 5e-4
HUM = 2 * np.pi * 50
UNITS = {"x": "m", "v": "m/s", "i": "A"}
AXIS = StateSpace([[0, 1], [900, 0]], [[0], [3]], [[1, 0]], [[0]], ("x", "v"), ("i",), ("x",), Continuous(), UNITS)


def regulator() -> servo.Servo:
    return servo.lqrd(AXIS, (0.0, HUM), [1e8, 1e2, 1e22, 0.0, 1e12], [1.0], T)


def two_outputs() -> servo.Servo:
    rng = np.random.default_rng(2)
    matrices = rng.normal(size=(3, 3)), rng.normal(size=(3, 3)), rng.normal(size=(2, 3)), 0.3 * rng.normal(size=(2, 3))
    plant = StateSpace(*matrices, ("a", "b", "c"), ("f", "g", "h"), ("y", "z"), Continuous())
    return servo.lqrd(plant, (0.0, 3.0, 5.0), np.ones(13), np.ones(3), 0.05)


@pytest.mark.parametrize("made", [regulator, two_outputs])
def test_it_does_the_same_with_its_anti_windup(made: object) -> None:
    servo_regulator = made()  # type: ignore[operator]
    with_anti_windup = anti_windup.back_calculation(servo_regulator, 5.0).controller
    rng = np.random.default_rng(0)
    for source, system in ((servo_regulator.controller, None), (with_anti_windup, with_anti_windup)):
        leapfrog = servo.controller(servo_regulator, system)
        assert (leapfrog.inputs, leapfrog.outputs) == (source.inputs, source.outputs)
        period = source.time.period_s  # type: ignore[union-attr]
        z = np.exp(1j * period * rng.uniform(0.1, 500, 20)) * 1.01
        size = np.abs(source.response(z)).max()
        np.testing.assert_allclose(leapfrog.response(z), source.response(z), rtol=0, atol=tolerances.of("zeros") * size)


def test_states_and_gains_are_of_like_size_and_in_the_errors_unit() -> None:
    """In companion form the gains on xi are 9e10, 4e8 and 4e5; in eta they differ by a factor of 13 at most."""
    servo_regulator = regulator()
    leapfrog = servo.controller(servo_regulator)
    assert leapfrog.states == ("sum", "p1", "q1")
    assert [leapfrog.unit(x) for x in leapfrog.states] == ["m", "m", "m"]
    gains = np.abs(leapfrog.C[0])
    assert gains.max() / gains.min() < 100
    assert np.abs(servo_regulator.K_xi).max() / np.abs(servo_regulator.K_xi).min() > 1e3
    assert set(leapfrog.B[:, leapfrog.inputs.index("x_error")]) == {0.0, 1.0}


def test_rounded_to_single_precision_the_modes_stay_where_they_are() -> None:
    """c and 1 - c are rounded each for itself: the radius is off by some 1e-8, a growth of 1e-4 1/s at most."""
    servo_regulator = regulator()
    leapfrog = servo.controller(servo_regulator)
    poles = np.linalg.eigvals(leapfrog.A.astype(np.float32).astype(float))
    assert np.abs(np.abs(poles) - 1).max() < 6e-8
    assert np.abs(np.angle(poles)).max() == pytest.approx(HUM * T, rel=1e-6)
