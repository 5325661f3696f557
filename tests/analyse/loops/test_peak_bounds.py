"""Bounds of a stable model's states: attained by the worst input, and not exceeded by any."""

import numpy as np

from synth.analyse.loops import peak_bounds
from synth.statespace import StateSpace
from synth.timing import Continuous, Discrete

A = np.array([[0.9, 0.2, 0.0], [-0.2, 0.9, 0.1], [0.0, 0.0, 0.99]])
B = np.array([[1.0, 0.0], [0.0, 2.0], [0.5, 0.0]])
LARGEST = np.array([0.3, 2.0])


def model(A: np.ndarray, time: Continuous | Discrete | None = None) -> StateSpace:
    names = ("a", "b", "c")[: len(A)]
    return StateSpace(
        A, B[: len(A)], np.eye(len(A)), np.zeros((len(A), 2)), names, ("u", "v"), names, time or Discrete(1e-3)
    )


def worst(i: int, samples: int) -> float:
    """Return x_i after its worst input: each u_j(N - 1 - k) has the sign of (A^k B)_ij."""
    x, power, signs = np.zeros(3), np.eye(3), []
    for _ in range(samples):
        signs.append(np.sign(power @ B)[i])
        power = power @ A
    for sign in reversed(signs):
        x = A @ x + B @ (sign * LARGEST)
    return float(x[i])


def test_each_bound_is_attained() -> None:
    bounds = peak_bounds.state_bounds(model(A), LARGEST)
    attained = np.array([worst(i, 3000) for i in range(3)])
    assert (attained <= bounds).all() and (bounds <= attained * (1 + 2 * peak_bounds.REMAINDER)).all()


def test_no_random_input_exceeds_the_bounds() -> None:
    bounds, rng, x = peak_bounds.state_bounds(model(A), LARGEST), np.random.default_rng(3), np.zeros(3)
    for _ in range(5000):
        x = A @ x + B @ (LARGEST * rng.choice([-1.0, 1.0], 2))
        assert (np.abs(x) <= bounds).all()


def test_a_state_that_nothing_drives_stays_at_zero() -> None:
    still = A.copy()
    still[2, 2] = 0.5
    bounds = peak_bounds.state_bounds(model(still), [0.0, 1.0])
    assert bounds[2] == 0 and bounds[1] > 2
