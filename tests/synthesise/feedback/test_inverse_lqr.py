"""Weights are recovered from the poles that they give, and poles that no weights give are refused."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from synth.errors import ModelError
from synth.statespace import StateSpace
from synth.synthesise.feedback import inverse_lqr, lqr
from synth.synthesise.regulation import internal_model
from synth.timing import Continuous, Discrete
from tests import tolerances

# Poles as printed, their decimals, and the weights of which the poles are those to the last printed digit.
PRINTED = {
    "y": (
        (-173.2, -2.61 + 5.48j, -2.61 - 5.48j, -2.16 + 1.77j, -2.16 - 1.77j),
        (1, 2, 2, 2, 2),
        (3e4, 3e4, 2.5e9, 2.5e7, 2.5e7),
    ),
    "x, z": (
        (-38.73, -3.2 + 5.89j, -3.2 - 5.89j, -2.69 + 2.23j, -2.69 - 2.23j),
        (2, 1, 1, 2, 2),
        (1500, 1500, 4.5e8, 2.25e6, 2.25e6),
    ),
    "theta": (
        (-200, -2.81 + 5.58j, -2.81 - 5.58j, -2.19 + 1.82j, -2.19 - 1.82j),
        (0, 2, 2, 2, 2),
        (4e4, 4e4, 4e9, 4e7, 4e7),
    ),
}


def model(A: object, B: object, time: Continuous | Discrete | None = None) -> StateSpace:
    A, B = np.asarray(A, float), np.asarray(B, float)
    states, inputs = tuple(f"x{i}" for i in range(len(A))), tuple(f"u{i}" for i in range(B.shape[1]))
    return StateSpace(A, B, np.eye(len(A)), np.zeros(B.shape), states, inputs, states, time or Continuous())


DOUBLE = model([[0, 1], [0, 0]], [[0], [1]])


def axis() -> StateSpace:
    double = StateSpace([[0, 1], [0, 0]], [[0], [1]], [[1, 0]], [[0]], ("e", "de"), ("w",), ("e",), Continuous())
    return internal_model.augmented(double, (0.0, 1.5 * np.pi))


def reproduces(weights: Any, poles: Sequence[complex], digits: Sequence[int]) -> bool:
    """Tell whether the weights give each of `poles` once its parts are rounded to its count of decimals."""
    attained = list(lqr.lqr(axis(), np.diag(weights), [[1.0]]).poles)
    for pole, k in zip(poles, digits, strict=True):
        nearest = attained.pop(int(np.argmin(np.abs(np.array(attained) - pole))))
        off = nearest - pole
        if max(abs(off.real), abs(off.imag)) > 0.5 * 10.0**-k * (1 + 1e-9):
            return False
    return True


@pytest.mark.parametrize("name", PRINTED)
def test_the_published_weights_are_the_unique_ones(name: str) -> None:
    poles, digits, weights = PRINTED[name]
    inverse = inverse_lqr.diagonal_weights(axis(), lqr.lqr(axis(), np.diag(weights), [[1.0]]).poles)
    assert inverse.unique and inverse.nullspace.shape == (5, 0) and inverse.residual < 1e-8
    np.testing.assert_allclose(inverse.q, weights, rtol=1e-6)
    assert reproduces(weights, poles, digits)
    detuned = np.array(weights) * np.where(np.arange(5) == 2, 1.1, 1.0)
    assert not reproduces(detuned, poles, digits)


@pytest.mark.parametrize("name", PRINTED)
def test_the_printed_poles_lead_near_the_weights(name: str) -> None:
    poles, _, weights = PRINTED[name]
    inverse = inverse_lqr.diagonal_weights(axis(), poles)
    assert inverse.unique
    np.testing.assert_allclose(inverse.q, weights, rtol=tolerances.of("print_q"))
    np.testing.assert_allclose(
        np.sort_complex(lqr.lqr(axis(), np.diag(inverse.q), [[1.0]]).poles),
        np.sort_complex(poles),
        rtol=1e-6,
    )


def test_the_double_integrator_is_solved_by_hand() -> None:
    """Poles -a, -b: q0 = (a b)^2, q1 = a^2 + b^2, times R."""
    inverse = inverse_lqr.diagonal_weights(DOUBLE, [-3, -5], R=2.0)
    np.testing.assert_allclose(inverse.q, [2 * 225, 2 * 34], rtol=tolerances.of("double"))


@settings(derandomize=True, max_examples=15, deadline=None)
@given(st.integers(0, 10**6))
def test_random_weights_come_back_from_their_poles(seed: int) -> None:
    rng = np.random.default_rng(seed)
    n = int(rng.integers(2, 5))
    c, q, R = model(rng.normal(size=(n, n)), rng.normal(size=(n, 1))), rng.uniform(0.5, 5, n), rng.uniform(0.5, 2)
    poles = lqr.lqr(c, np.diag(q), [[R]]).poles
    inverse = inverse_lqr.diagonal_weights(c, poles, R)
    again = lqr.lqr(c, np.diag(np.maximum(inverse.q, 0)), [[R]]).poles
    np.testing.assert_allclose(np.sort_complex(again), np.sort_complex(poles), rtol=tolerances.of("multiple_root"))


def test_weights_with_equal_effect_are_not_unique_and_span_the_nullspace() -> None:
    """Two states with the same transfer function from the input: only the sum of their weights counts."""
    twin = model([[-1, 0, 0], [0, -1, 0], [0, 0, -2]], [[1], [1], [1]])
    poles = lqr.lqr(twin, np.diag([3.0, 4.0, 2.0]), [[1.0]]).poles
    inverse = inverse_lqr.diagonal_weights(twin, poles)
    assert not inverse.unique and inverse.nullspace.shape == (3, 1)
    assert inverse.q[0] + inverse.q[1] == pytest.approx(7) and inverse.q[2] == pytest.approx(2)
    np.testing.assert_allclose(np.abs(inverse.nullspace[:, 0]), [np.sqrt(0.5), np.sqrt(0.5), 0], atol=1e-12)
    other_poles = lqr.lqr(twin, np.diag(inverse.q + 3 * inverse.nullspace[:, 0]), [[1.0]]).poles
    np.testing.assert_allclose(
        np.sort_complex(other_poles), np.sort_complex(poles), rtol=tolerances.of("multiple_root")
    )


def test_of_many_weights_some_that_are_not_negative_are_found() -> None:
    """x3 follows x1 + x2: q3 acts as q1 and q2 do together, and beside (10, 0, 0) least norm is (20, -10, 10) / 3."""
    c = model([[0, 1, 0], [0, 0, 0], [1, 2, -1]], [[0], [1], [1]])
    poles = lqr.lqr(c, np.diag([10.0, 0, 0]), [[1.0]]).poles
    inverse = inverse_lqr.diagonal_weights(c, poles)
    assert not inverse.unique and inverse.q.min() >= 0
    assert inverse.q @ [1, 0, 1] == pytest.approx(10) and inverse.q @ [0, 1, 1] == pytest.approx(0, abs=1e-6)


def test_a_mode_that_the_input_does_not_move_cannot_be_given_another_pole() -> None:
    c = model([[-1, 0], [0, -2]], [[1], [0]])
    inverse_lqr.diagonal_weights(c, [-3, -2])
    with pytest.raises(ModelError, match="symmetric root locus is missed by"):
        inverse_lqr.diagonal_weights(c, [-3, -4])


@pytest.mark.parametrize("time", [Continuous(), Discrete(0.1)])
@settings(derandomize=True, max_examples=15, deadline=None)
@given(seed=st.integers(0, 10**6), decades=st.sampled_from([0, 6]))
def test_weights_from_poles_do_not_depend_on_units(time: Continuous | Discrete, seed: int, decades: int) -> None:
    """A chain of n states, so that the weights are unique, in units over twelve decades."""
    rng = np.random.default_rng(seed)
    n = int(rng.integers(2, 5))
    A = np.diag(rng.uniform(0.5, 1, n - 1), 1) + np.diag(rng.uniform(-0.9, 0.9, n))
    d, q = 10.0 ** rng.uniform(-decades, decades, n), rng.uniform(0.5, 5, n)
    c = model(A * d / d[:, None], np.eye(n)[:, -1:] / d[:, None], time)
    poles = lqr.lqr((A, np.eye(n)[:, -1:], time), q, [2.0]).poles
    inverse = inverse_lqr.diagonal_weights(c, poles, 2.0)
    assert inverse.unique
    np.testing.assert_allclose(inverse.q / d**2, q, rtol=tolerances.of("multiple_root"))


def test_a_sampled_lag_by_hand() -> None:
    """x+ = a x + u, pole p: X = R (a / p - 1), q = X - a p X; a deadbeat pole of an x that forgets takes any weight."""
    inverse = inverse_lqr.diagonal_weights(model([[0.5]], [[1.0]], Discrete(0.1)), [0.1], R=2.0)
    np.testing.assert_allclose(inverse.q, [2 * 4 * 0.95], rtol=tolerances.of("double"))
    assert not inverse_lqr.diagonal_weights(model([[0.0]], [[1.0]], Discrete(0.1)), [0.0]).unique
    with pytest.raises(ModelError, match="is missed by"):
        inverse_lqr.diagonal_weights(model([[0.5]], [[1.0]], Discrete(0.1)), [0.0])


def test_the_poles_of_the_open_loop_need_no_weight() -> None:
    c = model([[-1.0, 1], [0, -2]], [[0], [1.0]])
    np.testing.assert_allclose(inverse_lqr.diagonal_weights(c, [-1, -2]).q, 0, atol=tolerances.of("double"))
