"""The first command is the present one, or the controls that must jump are named."""

from dataclasses import replace

import numpy as np
import pytest
import scipy.linalg
import scipy.signal
from hypothesis import given, settings
from hypothesis import strategies as st

from synth.errors import ModelError, SignalError
from synth.statespace import StateSpace
from synth.synthesise.regulation import bumpless, optimal_servo, servo
from synth.timing import Continuous
from tests import tolerances


def random_regulator(seed: int, period: float | None) -> servo.Servo:
    """Return the regulator of a random plant with as many inputs as outputs or one more."""
    rng = np.random.default_rng(seed)
    p = int(rng.integers(1, 3))
    n, m = p + int(rng.integers(0, 3)), p + int(rng.integers(0, 2))
    n = max(n, m)
    names = [tuple(f"{letter}{i}" for i in range(k)) for letter, k in (("x", n), ("u", m), ("y", p))]
    matrices = rng.normal(size=(n, n)), rng.normal(size=(n, m)), rng.normal(size=(p, n)), np.zeros((p, m))
    args = (StateSpace(*matrices, *names, Continuous()), (0.0, 2.0), np.eye(n + 3 * p), np.eye(m))
    return optimal_servo.lqr(*args) if period is None else optimal_servo.lqrd(*args, period)


@settings(derandomize=True, max_examples=10, deadline=None)
@given(st.integers(0, 10**6), st.sampled_from([None, 0.05]))
def test_the_command_is_the_present_one_and_the_state_the_least(seed: int, period: float | None) -> None:
    regulator = random_regulator(seed, period)
    rng = np.random.default_rng(seed)
    x, u = rng.normal(size=len(regulator.plant.A)), rng.normal(size=len(regulator.controls))
    xi = bumpless.start(regulator, x, u)
    size = np.abs(regulator.K_x) @ np.abs(x) + np.abs(regulator.K_xi) @ np.abs(xi)
    assert (np.abs(regulator.K_x @ x + regulator.K_xi @ xi - u) <= 16 * np.finfo(float).eps * (size + np.abs(u))).all()
    spare = scipy.linalg.null_space(regulator.K_xi)
    assert np.abs(spare.T @ xi).max(initial=0) < tolerances.of("lyapunov") * np.linalg.norm(xi)


@pytest.mark.parametrize("with_observer", [False, True])
def test_the_first_step_of_the_controller_is_the_present_command(with_observer: bool) -> None:
    """Two coupled masses; the controller's own matrices give the command."""
    A = scipy.linalg.block_diag([[0.0, 1.0], [0.0, 0.0]], [[0.0, 1.0], [0.0, 0.0]])
    B, C = [[0, 0], [1, 0.5], [0, 0], [0, 2.0]], [[1, 0, 0, 0], [0, 0, 1, 0]]
    names = ("p", "dp", "q", "dq"), ("f", "g"), ("y", "z")
    plant = StateSpace(A, B, C, np.zeros((2, 2)), *names, Continuous())
    regulator = optimal_servo.lqrd(plant, (0.0, 3.0), np.eye(10), np.eye(2), 0.01)
    x, present = np.array([0.01, -0.2, 0.03, 0.1]), np.array([0.4, -1.2])
    if with_observer:
        sampled = regulator.plant
        placed = scipy.signal.place_poles(sampled.A.T, sampled.C.T, [0.5, 0.55, 0.6, 0.65])
        regulator = servo.with_observer(regulator, placed.gain_matrix.T)
    xi, c = bumpless.start(regulator, x, present), regulator.controller
    known = dict(zip(plant.states, x, strict=True)) | {"y": x[0], "z": x[2], "y_error": 0.3, "z_error": -0.1}
    w = np.array([known.get(name, 0.0) for name in c.inputs])
    start = np.concatenate([xi, x]) if with_observer else xi
    size = np.abs(present) + np.abs(c.C) @ np.abs(start) + np.abs(c.D) @ np.abs(w)
    assert (np.abs(c.C @ start + c.D @ w - present) <= 16 * np.finfo(float).eps * size).all()
    cold = np.concatenate([0 * xi, x]) if with_observer else 0 * xi
    assert np.abs(c.C @ cold + c.D @ w - present).max() > 0.1


@pytest.mark.parametrize("coupling", [0.0, 1e-30])
def test_a_control_at_rest_beside_one_at_work_does_not_jump_by_rounding(coupling: float) -> None:
    """Coils a and b move y and the yaw, c moves x alone: all terms of the command of c are tiny."""
    zero, one = np.zeros((3, 3)), np.eye(3)
    push = np.array([[0, 0, 13.2547], [13.2547, 13.2547, 0], [-117.15, 117.15, 0]])
    A, B = np.block([[zero, one], [zero, zero]]), np.vstack([zero, push])
    names = ("x", "y", "yaw", "dx", "dy", "dyaw"), ("a", "b", "c"), ("x", "y", "yaw")
    plant = StateSpace(A, B, np.hstack([one, zero]), zero, *names, Continuous())
    regulator = optimal_servo.lqrd(plant, (0.0, 0.2094), np.ones(15), np.ones(3), 1 / 800)
    decoupled = np.where(np.abs(regulator.K) < 1e-12, coupling, regulator.K)
    xi = bumpless.start(replace(regulator, K=decoupled), np.zeros(6), [0.1, 0.0, 0.0])
    np.testing.assert_allclose(decoupled[:, 6:] @ xi, [0.1, 0.0, 0.0], atol=1e-16)


def test_a_start_that_must_jump_names_the_controls() -> None:
    """One integrator for two inputs that act alike: a difference between them cannot be held."""
    plant = StateSpace([[-1.0]], [[1.0, 1.0]], [[1.0]], [[0.0, 0.0]], ("x",), ("left", "right"), ("x",), Continuous())
    regulator = optimal_servo.lqr(plant, (0.0,), np.eye(2), np.eye(2))
    assert bumpless.start(regulator, [0.0], [0.5, 0.5]).shape == (1,)
    with pytest.raises(ModelError, match=r"left by .* right by .* would jump, for K_xi has rank 1 with 2 controls"):
        bumpless.start(regulator, [0.0], [0.5, -0.5])
    with pytest.raises(SignalError, match=r"give 1 finite states \(x\) and 2 inputs \(left, right\)"):
        bumpless.start(regulator, [0.0], [0.5])
    with pytest.raises(SignalError, match="give 1 finite states"):
        bumpless.start(regulator, [np.nan], [0.5, 0.5])


def test_values_that_are_not_real_are_refused() -> None:
    regulator = optimal_servo.lqr(([[-1.0]], [[1.0]], [[1.0]]), [0.0], np.ones(2), [1.0])
    for wrong in ([1j], np.array([1 + 2j]), ["a"]):
        with pytest.raises(SignalError, match="the states are no real numbers"):
            bumpless.start(regulator, wrong, [0.0])
        with pytest.raises(SignalError, match="the present inputs are no real numbers"):
            bumpless.start(regulator, [0.0], wrong)
