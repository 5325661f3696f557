"""The certificate against closed forms, and against loops that are planted to leave an error."""

from dataclasses import replace

import control
import numpy as np
import pytest

from synth.errors import ModelError, SignalError
from synth.statespace import StateSpace
from synth.synthesise.regulation import internal_model, servo, steady_error
from synth.synthesise.regulation.steady_error import ERROR_ROUNDING
from synth.timing import Continuous, Discrete
from tests import tolerances

T = 1e-3


def transfer(numerator: list[float], denominator: list[float]) -> StateSpace:
    """Return a strictly proper transfer from r to e in companion form; coefficients from the highest power on."""
    n = len(denominator) - 1
    A = np.diag(np.ones(n - 1), 1)
    A[-1] = -np.array(denominator[:0:-1])
    C = np.zeros((1, n))
    C[0, : len(numerator)] = numerator[::-1]
    return StateSpace(A, np.eye(n)[:, -1:], C, [[0.0]], tuple(f"x{i}" for i in range(n)), ("r",), ("e",), Continuous())


def two_by_two(direct: float = 0.0) -> StateSpace:
    """Two coupled masses, pushed apart and each alone; outputs are the positions."""
    A = [[0, 1, 0, 0], [-3, -0.2, 2, 0.1], [0, 0, 0, 1], [2, 0.1, -5, -0.4]]
    B = [[0, 0], [1, -1], [0, 0], [0, 2]]
    C, D = [[1, 0, 0, 0], [0, 0, 1, 0]], direct * np.array([[1.0, 0.2], [0.0, 1.0]])
    return StateSpace(A, B, C, D, ("p", "dp", "q", "dq"), ("f", "g"), ("y", "z"), Continuous())


def two_output_servo(exosystem: internal_model.Exosystem = (0.0, 2.0), period: float | None = None) -> servo.Servo:
    order = 2 * len(internal_model.of(exosystem).Phi)
    Q = np.diag([10.0, 1, 10, 1] + [10.0] * order)
    if period is None:
        return servo.lqr(two_by_two(), exosystem, Q, np.eye(2))
    return servo.lqrd(two_by_two(), exosystem, Q, np.eye(2), period)


def test_the_response_is_the_closed_form() -> None:
    """e = s r / (s + 1)^2 on constants and at 1 rad/s: |j / (1 + j)^2| = 1 / 2."""
    certificate = steady_error.evaluate(transfer([1, 0], [1, 2, 1]), ["e"], (0.0, 1.0))
    np.testing.assert_allclose(certificate.response[:, 0, 0], [0, 0.5], atol=tolerances.of("double"))
    assert certificate.relative_error[0, 0, 0] < ERROR_ROUNDING < certificate.relative_error[1, 0, 0]
    assert not certificate.vanishes
    np.testing.assert_allclose(certificate.poles, -1, atol=tolerances.of("multiple_root"))
    assert "An error STAYS" in repr(certificate)


@pytest.mark.parametrize(("zeros", "vanishes"), [(1, False), (2, True)])
def test_a_ramp_needs_a_double_zero(zeros: int, vanishes: bool) -> None:
    """e = s^k r / (s + 1)^3: with one zero a ramp leaves the constant 1, with two nothing."""
    certificate = steady_error.evaluate(transfer([1.0] + [0.0] * zeros, [1, 3, 3, 1]), ["e"], {0.0: 2})
    assert certificate.vanishes is vanishes
    assert certificate.response[0, 0, 0] == 0
    once = steady_error.evaluate(transfer([1.0] + [0.0] * zeros, [1, 3, 3, 1]), ["e"], {0.0: 1})
    assert once.vanishes


def test_a_growing_sine_needs_a_double_pair() -> None:
    square = np.polymul([1, 0, 4], [1, 0, 4])
    slow = np.poly([-1.0] * 5)
    assert not steady_error.evaluate(transfer([1, 0, 4], slow.tolist()), ["e"], {2.0: 2}).vanishes
    assert steady_error.evaluate(transfer(square.tolist(), slow.tolist()), ["e"], {2.0: 2}).vanishes


@pytest.mark.parametrize("size", [1e-12, 1e12])
def test_what_is_left_does_not_depend_on_units(size: float) -> None:
    loop = two_output_servo().closed_loop()
    scaled = replace(loop, B=loop.B * size, D=loop.D * size)
    errors = ("y_error", "z_error")
    a, b = (steady_error.evaluate(model, errors, (0.0, 2.0, 1.0)) for model in (loop, scaled))
    np.testing.assert_allclose(b.relative_error[1], a.relative_error[1], rtol=tolerances.of("double"))
    assert a.relative_error[1].min() > 1e-3  # 1 rad/s is none of the regulator's frequencies
    assert a.relative_error[[0, 2]].max() < ERROR_ROUNDING


def test_an_unstable_loop_leaves_everything() -> None:
    certificate = steady_error.evaluate(transfer([1], [1, -1]), ["e"], (0.0,))
    assert certificate.worst == np.inf
    assert not certificate.vanishes
    assert "NOT STABLE: its pole 1 does not decay" in repr(certificate)
    sampled = StateSpace([[-1.01]], [[1]], [[1]], [[0]], ("x",), ("r",), ("e",), Discrete(T))
    assert steady_error.evaluate(sampled, ["e"], (0.0,)).worst == np.inf
    with pytest.raises(SignalError, match="'z' is not one of e"):
        steady_error.evaluate(sampled, ["z"], (0.0,))


@pytest.mark.parametrize("period", [None, 0.02])
def test_a_copy_for_each_error_leaves_nothing(period: float | None) -> None:
    certificate = two_output_servo(period=period).steady
    assert certificate.vanishes
    assert certificate.worst < 1e-11
    assert certificate.sources == ("y_reference", "z_reference", "f_disturbance", "g_disturbance")
    assert certificate.response.shape == (2, 2, 4)


def test_a_regulator_of_another_frequency_is_seen_to_leave_an_error() -> None:
    loop = two_output_servo((0.0, 2.001)).closed_loop()
    certificate = steady_error.evaluate(loop, ("y_error", "z_error"), (0.0, 2.0))
    assert 1e-6 < certificate.worst < 1e-2


def test_an_algebraic_loop_without_a_solution_is_refused() -> None:
    """y = x + u and u = e leave 0 = x - r; with u = e / 2 there is a solution."""
    plant = StateSpace([[-1.0]], [[1.0]], [[1.0]], [[1.0]], ("x",), ("u",), ("y",), Continuous())
    nothing = plant.select((), plant.inputs)
    for gain in (0.5, 1.0):
        empty = np.zeros((0, 0)), np.zeros((0, 1)), np.zeros((1, 0))
        controller = StateSpace(*empty, [[gain]], (), ("y_error",), ("u_command",), Continuous())
        if gain == 0.5:
            loop = steady_error.closed_loop(plant, nothing, ["y"], ["u"], controller)
            np.testing.assert_allclose(loop.poles, [0.0], atol=tolerances.of("double"))  # u = x - r + 2 d
        else:
            with pytest.raises(ModelError, match="around a loop at once, without a solution"):
                steady_error.closed_loop(plant, nothing, ["y"], ["u"], controller)


def test_the_loop_is_that_of_python_control() -> None:
    """Random plants with direct terms and disturbances, a random controller, joined by python-control's lft."""
    rng = np.random.default_rng(7)
    plant = two_by_two(0.3)
    plant = replace(
        plant, B=np.hstack([plant.B, rng.normal(size=(4, 1))]), D=np.hstack([plant.D, rng.normal(size=(2, 1))]),
        inputs=("f", "g", "draught"),
    )  # fmt: skip
    matrices = rng.normal(size=(3, 3)), rng.normal(size=(3, 5)), rng.normal(size=(2, 3)), 0.1 * rng.normal(size=(2, 5))
    inputs = ("y", "y_error", "z_error", "f_limited", "g_limited")
    controller = StateSpace(*matrices, ("a", "b", "c"), inputs, ("f_command", "g_command"), Continuous())
    loop = steady_error.closed_loop(plant, plant.select(["y"], plant.inputs), ["y", "z"], ["f", "g"], controller)
    assert loop.inputs == ("y_reference", "z_reference", "f_disturbance", "g_disturbance", "draught")
    # P: (r, d, u) -> (e, u, [y, e, u]); the controller closes the last ones.
    B = np.hstack([np.zeros((4, 2)), plant.B, plant.B[:, :2]])
    e = np.hstack([-np.eye(2), plant.D, plant.D[:, :2]])
    u, y = np.hstack([np.zeros((2, 5)), np.eye(2)]), np.hstack([np.zeros((1, 2)), plant.D[:1], plant.D[:1, :2]])
    C = np.vstack([plant.C, np.zeros((2, 4)), plant.C[:1], plant.C, np.zeros((2, 4))])
    P = control.ss(plant.A, B, C, np.vstack([e, u, y, e, u]))
    joined = P.lft(controller.to_control())
    s = 1j * np.array([0.1, 1.0, 7.0])
    theirs = np.array([joined(v) for v in s])
    np.testing.assert_allclose(loop.response(s), theirs, rtol=tolerances.of("lyapunov"), atol=tolerances.of("lyapunov"))


@pytest.mark.parametrize("time", [Continuous(), Discrete(T)])
def test_a_loop_without_states_or_errors_is_certified(time: Continuous | Discrete) -> None:
    """A constant passes everything on; where nothing is regulated nothing is left."""
    gain = StateSpace(np.zeros((0, 0)), np.zeros((0, 1)), np.zeros((1, 0)), [[0.5]], (), ("r",), ("e",), time)
    certificate = steady_error.evaluate(gain, ["e"], (0.0, 1.0))
    np.testing.assert_allclose(certificate.response[:, 0, 0], [0.5, 0.5], rtol=tolerances.of("double"))
    assert not certificate.vanishes
    empty = steady_error.evaluate(gain, [], (0.0, 1.0))
    assert empty.response.shape == (2, 0, 1)
    assert empty.vanishes
    assert "Each error dies out" in repr(empty)


def test_an_unstable_loop_without_sources_is_not_certified() -> None:
    loop = transfer([1], [1, -1]).select(["e"], [])
    assert not steady_error.evaluate(loop, ["e"], (0.0,)).vanishes
