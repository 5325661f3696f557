"""Frequency-weighted gains against spelled-out augmentation, the cost as an integral over frequency, and simulation."""

import numpy as np
import pytest
import scipy.linalg

from synth.analyse import discretise
from synth.errors import ModelError, SignalError, TimingError
from synth.statespace import StateSpace
from synth.synthesise.feedback import frequency_weights, lqr, weights
from synth.timing import Continuous, Discrete
from tests import tolerances

UNITS = {"x": "m", "v": "m/s", "f": "N"}
PLANT = StateSpace([[0, 1], [-4, -0.2]], [[0], [1]], [[1, 0]], [[0]], ("x", "v"), ("f",), ("y",), Continuous(), UNITS)
# More weight on slow errors of y, and on fast forces (roll-off).
SLOW = StateSpace([[-0.1]], [[1]], [[1]], [[0.2]], ("w",), ("y",), ("zy",), Continuous())
FAST = StateSpace([[-50]], [[1]], [[-45]], [[1]], ("r",), ("f",), ("zf",), Continuous())


def closed_loop_matrix(plant: StateSpace, controller: StateSpace) -> np.ndarray:
    """The loop's matrix on (x, w)."""
    A = plant.A + plant.B @ controller.D
    return np.block([[A, plant.B @ controller.C], [controller.B, controller.A]])


def test_plant_and_filters_are_one_model_by_hand() -> None:
    joined = frequency_weights.augmented(PLANT, [SLOW, FAST])
    A = [[0, 1, 0, 0], [-4, -0.2, 0, 0], [1, 0, -0.1, 0], [0, 0, 0, -50]]
    np.testing.assert_array_equal(joined.A, A)
    np.testing.assert_array_equal(joined.B, [[0], [1], [0], [1]])
    np.testing.assert_array_equal(joined.C, [[0.2, 0, 1, 0], [0, 0, 0, -45]])
    np.testing.assert_array_equal(joined.D, [[0], [1]])
    assert joined.states == ("x", "v", "w", "r") and joined.units["f"] == "N"
    s = 1j * np.array([0.1, 3.0, 40.0])
    np.testing.assert_allclose(
        joined.channel("zy", "f").response(s),
        SLOW.response(s) @ PLANT.response(s),
        rtol=tolerances.of("double"),
    )


def test_constant_filters_are_plain_weights() -> None:
    nothing = (np.zeros((0, 0)), np.zeros((0, 1)), np.zeros((1, 0)))
    flat = StateSpace(*nothing, [[2.0]], (), ("v",), ("z",), Continuous())
    design = frequency_weights.frequency_shaped_lqr(PLANT, [flat], {"z": 3.0}, {"f": 0.5}, {"x": 7.0})
    plain = lqr.lqr(PLANT, {"x": 7.0, "v": 12.0}, {"f": 0.5})
    np.testing.assert_allclose(design.gain.K, plain.K, rtol=tolerances.of("folded"))
    assert design.controller.states == () and design.controller.inputs == ("x", "v")
    np.testing.assert_array_equal(design.controller.D, design.gain.K)


def test_the_controller_makes_the_loop_that_the_gain_promises() -> None:
    design = frequency_weights.frequency_shaped_lqr(PLANT, [SLOW, FAST], {"zy": 5.0, "zf": 1.0}, {"f": 0.1})
    poles = np.sort_complex(np.linalg.eigvals(closed_loop_matrix(PLANT, design.controller)))
    np.testing.assert_allclose(poles, design.gain.poles, rtol=tolerances.of("pencil"))
    assert design.controller.states == ("w", "r") and design.controller.outputs == ("f",)


def test_the_optimal_cost_is_its_integral_over_frequency() -> None:
    """From x0 the cost is (1 / 2 pi) int (|W_y y|^2 + |W_f f|^2 + R |f|^2) d omega; another gain costs more."""
    Q, R = {"zy": 5.0, "zf": 1.0}, 0.1
    design = frequency_weights.frequency_shaped_lqr(PLANT, [SLOW, FAST], Q, {"f": R})
    x0 = np.array([1.0, -0.5, 0.0, 0.0])

    def cost(K: np.ndarray) -> float:
        nodes, weight = np.polynomial.legendre.leggauss(400)
        omega = 30 * np.tan(np.pi / 4 * (nodes + 1))  # the half line
        dense = weight * 30 * np.pi / 4 / np.cos(np.pi / 4 * (nodes + 1)) ** 2
        joined = frequency_weights.augmented(PLANT, [SLOW, FAST])
        A = joined.A + joined.B @ K
        x = np.linalg.solve(1j * omega[:, None, None] * np.eye(4) - A, x0[:, None])[:, :, 0]
        y, f = x[:, 0], x @ K[0]
        zy, zf = SLOW.response(1j * omega)[:, 0, 0] * y, FAST.response(1j * omega)[:, 0, 0] * f
        return float((5 * np.abs(zy) ** 2 + np.abs(zf) ** 2 + R * np.abs(f) ** 2) @ dense / np.pi)

    expected_cost = x0 @ design.gain.certificate.X @ x0
    assert cost(design.gain.K) == pytest.approx(expected_cost, rel=tolerances.of("frequency"))
    assert cost(design.gain.K * 1.05) > expected_cost * (1 + 1e-4)


def test_a_weight_on_fast_forces_rolls_the_controller_off() -> None:
    shaped = frequency_weights.frequency_shaped_lqr(PLANT, [FAST], {"zf": 1.0}, {"f": 0.01}, {"x": 100.0})
    fast = shaped.controller.response(1e4j)[0, 0]
    slow = shaped.controller.response(1e-3j)[0, 0]
    assert abs(fast[0]) < 0.4 * abs(slow[0])  # a constant weight's gain is the same at all frequencies


def test_the_held_loop_is_optimal_for_the_continuous_cost() -> None:
    T = 0.1
    design = frequency_weights.frequency_shaped_lqr(PLANT, [SLOW], {"zy": 5.0}, {"f": 0.1}, period_s=T)
    assert design.controller.time == Discrete(T)
    held = discretise.zero_order_hold(PLANT, T)
    poles = np.sort_complex(np.linalg.eigvals(closed_loop_matrix(held, design.controller)))
    np.testing.assert_allclose(poles, design.gain.poles, rtol=tolerances.of("pencil"))
    joined = frequency_weights.augmented(PLANT, [SLOW])
    w = weights.output_weights(joined, {"zy": 5.0}, {"f": 0.1})
    nodes, weight = np.polynomial.legendre.leggauss(10)
    F, x, total = scipy.linalg.block_diag(np.hstack([joined.A, joined.B]), np.zeros((1, 0))), np.array([1.0, 0, 0]), 0.0
    W = np.block([[w.Q, w.N], [w.N.T, w.R]])
    flows = [scipy.linalg.expm(F * T * (v + 1) / 2) for v in nodes]
    over = scipy.linalg.expm(F * T)
    for _ in range(1500):
        xu = np.concatenate([x, design.gain.K @ x])
        total += T / 2 * sum(k * (M @ xu) @ W @ (M @ xu) for k, M in zip(weight, flows, strict=True))
        x = (over @ xu)[:3]
    X = design.gain.certificate.X
    assert total == pytest.approx(X[0, 0], rel=tolerances.of("quadrature"))


def test_what_cannot_be_weighted_is_refused() -> None:
    with pytest.raises(SignalError, match="weights 'q', which is not a signal of the plant: it has x, v, y, f"):
        frequency_weights.augmented(PLANT, [SLOW.renamed({"y": "q"})])
    with pytest.raises(SignalError, match="no filter was given"):
        frequency_weights.augmented(PLANT, [])
    with pytest.raises(TimingError, match="continuous time meets"):
        frequency_weights.augmented(PLANT, [discretise.zero_order_hold(SLOW, 0.1)])
    with pytest.raises(SignalError, match="a name is listed twice"):
        frequency_weights.augmented(PLANT, [SLOW, SLOW])
    # The velocity's transfer function is zero at s = 0, so that nothing moves its integral alone.
    with pytest.raises(ModelError, match="not stabilisable: mode 0 in w"):
        integrator = StateSpace([[0]], [[1]], [[1]], [[0]], ("w",), ("v",), ("z",), Continuous())
        frequency_weights.frequency_shaped_lqr(PLANT, [integrator], {"z": 1.0}, {"f": 1.0})


def test_arrays_are_read_and_the_result_prints() -> None:
    plant = (PLANT.A, PLANT.B, PLANT.C, PLANT.D)
    with pytest.raises(SignalError, match="x1, x2, x1: give each its own"):
        frequency_weights.frequency_shaped_lqr(plant, [(SLOW.A, SLOW.B)], [1.0], [1.0])
    design = frequency_weights.frequency_shaped_lqr(
        plant, [SLOW.renamed({"y": "y1"}).to_control()], [1.0], [1.0], exact=True
    )
    assert design.gain.K.shape == (1, 3) and design.gain.states == ("x1", "x2", "w")
    text = repr(frequency_weights.frequency_shaped_lqr(PLANT, [SLOW], {"zy": 1.0}, {"f": 1.0}))
    assert text.startswith("Frequency-weighted gain in continuous time: 1 states of filters")


def test_a_name_of_two_signals_that_differ_is_refused() -> None:
    """The output "x" is no longer the state x; where it is, it may be weighted by that name."""
    part = StateSpace([[-1.0]], [[1.0]], [[1.0]], [[0.0]], ("w",), ("x",), ("z",), Continuous())
    for row, differs in (([[1, 0]], False), ([[1, 2]], True)):
        plant = StateSpace([[0, 1], [0, 0]], [[0], [1]], row, [[0]], ("x", "v"), ("u",), ("x",), Continuous())
        if differs:
            with pytest.raises(SignalError, match="weights 'x', which is a state and an output of the plant, and thes"):
                frequency_weights.augmented(plant, [part])
        else:
            np.testing.assert_array_equal(frequency_weights.augmented(plant, [part]).A[2], [1, 0, -1])
