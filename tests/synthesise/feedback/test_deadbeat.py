"""Deadbeat feedback: every state is 0 after the controllability index of samples, no later and no sooner."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from synth.analyse import discretise
from synth.errors import ModelError, TimingError
from synth.statespace import Array, StateSpace
from synth.synthesise.feedback import deadbeat
from synth.timing import Discrete

TIME = Discrete(0.1)


def sampled_pair(A: Array, B: Array) -> tuple[object, ...]:
    return A, B, np.eye(len(A)), np.zeros(B.shape), TIME


def index(A: Array, B: Array) -> int:
    """Return the least k for which [B, A B, .., A^(k-1) B] has full rank."""
    blocks = [np.linalg.matrix_power(A, k) @ B for k in range(len(A))]
    return next(k for k in range(1, len(A) + 1) if np.linalg.matrix_rank(np.hstack(blocks[:k])) == len(A))


def test_a_sampled_double_integrator_rests_after_two_samples() -> None:
    """The textbook gain u = -x / T^2 - 3 v / (2 T)."""
    T = 2.0**-3
    model = discretise.zero_order_hold(([[0, 1], [0, 0]], [[0], [1]]), T)
    design = deadbeat.feedback(model)
    np.testing.assert_array_equal(design.K, [[-1 / T**2, -3 / (2 * T)]])
    assert design.steps == 2
    assert design.remainder < 1e-14
    assert "after 2 samples" in repr(design)


@given(seed=st.integers(0, 10**6), n=st.integers(1, 6), m=st.integers(1, 3))
@settings(derandomize=True, max_examples=40, deadline=None)
def test_random_pairs_take_the_controllability_index(seed: int, n: int, m: int) -> None:
    rng = np.random.default_rng(seed)
    A, B = rng.normal(size=(n, n)), rng.normal(size=(n, m))
    design = deadbeat.feedback(sampled_pair(A, B))
    closed = A + B @ design.K
    assert design.steps == index(A, B)
    left = np.linalg.norm(np.linalg.matrix_power(closed, design.steps))
    assert left <= 1e-9 * (1 + np.linalg.norm(closed)) ** design.steps
    assert design.remainder < 1e-8


def test_chains_of_different_length() -> None:
    """Inputs at the ends of chains of 3 and 1: three samples; a gain with one sample less does not exist."""
    A = np.diag([1.0, 1.0, 0.0], 1) + np.diag([0.5, -1.2, 2.0, 0.3])
    B = np.array([[0.0, 0], [0, 0], [1, 0], [0, 1]])
    design = deadbeat.feedback(sampled_pair(A, B))
    closed = A + B @ design.K
    assert design.steps == index(A, B) == 3
    assert np.abs(np.linalg.matrix_power(closed, 3)).max() < 1e-13
    assert np.abs(np.linalg.matrix_power(closed, 2)).max() > 0.1


def test_a_planted_gain_that_is_nearly_right_leaves_more() -> None:
    A, B = np.diag([1.0, 1.0, 0.0], 1) + np.eye(4), np.array([[0.0, 0], [0, 0], [1, 0], [0, 1]])
    design = deadbeat.feedback(sampled_pair(A, B))
    closed = A + B @ (design.K * (1 + 1e-6))
    assert np.abs(np.linalg.matrix_power(closed, design.steps)).max() > 1e-7 > 1e3 * design.remainder


def test_a_mode_that_rests_by_itself_needs_no_input() -> None:
    A, B = np.array([[1.0, 0.1, 0], [0, 1, 0], [0, 0, 0]]), np.array([[0.005], [0.1], [0]])
    design = deadbeat.feedback(sampled_pair(A, B))
    assert design.steps == 2
    assert np.abs(np.linalg.matrix_power(A + B @ design.K, 2)).max() < 1e-13


def test_what_has_no_deadbeat_gain() -> None:
    A, B = np.diag([0.5, 0.2]), np.array([[1.0], [0]])
    names = StateSpace(A, B, np.eye(2), np.zeros((2, 1)), ("p", "q"), ("f",), ("p", "q"), TIME)
    with pytest.raises(ModelError, match=r"mode 0.2 in q is not 0 and is uncontrollable from f"):
        deadbeat.feedback(names)
    with pytest.raises(TimingError, match="no constant gain is deadbeat in continuous time"):
        deadbeat.feedback((A, B))


def test_a_model_without_states_is_at_rest_at_once() -> None:
    nothing = (np.zeros((0, 0)), np.zeros((0, 1)), np.zeros((1, 0)), [[0.0]])
    design = deadbeat.feedback((*nothing, Discrete(0.1)))
    assert design.K.shape == (1, 0)
    assert (design.steps, design.remainder) == (0, 0.0)
