"""Scaling is independent of units and rounding noise; splits are orthonormal; deflation keeps the zeros."""

import numpy as np
import pytest
import scipy.linalg
from hypothesis import given, settings
from hypothesis import strategies as st

from synth.analyse.structure import staircase, structure
from synth.errors import ModelError
from synth.timing import Continuous
from tests import tolerances


def matrices(seed: int) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    n, m, p = (int(rng.integers(1, k)) for k in (7, 4, 4))
    return tuple(rng.normal(size=shape) for shape in ((n, n), (n, m), (p, n), (p, m)))


@settings(derandomize=True, max_examples=30, deadline=None)
@given(st.integers(0, 10**6))
def test_scaling_undoes_units_of_powers_of_two(seed: int) -> None:
    A, B, C, D = matrices(seed)
    rng = np.random.default_rng(seed)
    x, u, y = (2.0 ** rng.integers(-30, 30, k) for k in (*B.shape, len(C)))
    t = 2.0 ** int(rng.integers(-10, 10))
    one = staircase.scaled(A, B, C, D)
    other = staircase.scaled(A * x / x[:, None] * t, B * u / x[:, None] * t, C * x / y[:, None], D * u / y[:, None])
    for letter in "ABCD":
        a, b = getattr(one, letter), getattr(other, letter)
        assert ((np.abs(a) / 16 <= np.abs(b)) & (np.abs(b) <= 16 * np.abs(a))).all(), "each power is rounded"
    np.testing.assert_array_equal(other.A * other.rate * other.x[:, None] / other.x, A * x / x[:, None] * t)


def test_rounding_noise_does_not_steer_the_scaling() -> None:
    A = scipy.linalg.block_diag(*([[0.0, 1.0], [-(10.0**k), -1.0]] for k in range(4)))
    B, C = np.eye(8)[:, [1, 3, 5]], np.eye(8)[[0, 2]]
    noise = 1e-17 * np.random.default_rng(0).normal(size=(10, 11)) * 1000
    M = np.block([[A, B], [C, np.zeros((2, 3))]])
    M = np.where(M == 0, noise, M)
    decomposition = staircase.kalman(staircase.scaled(M[:8, :8], M[:8, 8:], M[8:, :8], M[8:, 8:]))
    assert (
        decomposition.kept.shape[1] == 4
        and len(decomposition.uncontrollable[0]) == 2
        and len(decomposition.unobservable[0]) == 2
    )


@pytest.mark.parametrize("noise", [-1e-20, -5e-45, 6e-72])
def test_a_rate_that_is_rounding_does_not_hide_a_controllable_state(noise: float) -> None:
    """An integrator behind a lag, as a linearisation leaves it: its own rate is rounding."""
    A, B = np.array([[noise, -0.037], [0.0, -87.0]]), np.array([[0.0], [-0.72]])
    at = staircase.scaled(A, B)
    assert staircase.controllable_split(at.A, at.B).basis.shape == (2, 2)
    assert at.rate == staircase.scaled(np.array([[0.0, -0.037], [0.0, -87.0]]), B).rate


@pytest.mark.parametrize("seed", range(4))
def test_a_split_is_orthonormal_and_keeps_coordinates(seed: int) -> None:
    rng = np.random.default_rng(seed)
    mixed = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    A = scipy.linalg.block_diag(mixed @ np.diag([-1.0, -1.0, -2.0]) @ mixed.T, [[-3.0]], [[-4.0]])
    B = np.vstack([mixed @ [[1.0], [0.0], [1.0]], [[1.0]], [[0.0]]])
    split = staircase.controllable_split(A, B)
    both = np.hstack([split.basis, split.complement])
    np.testing.assert_allclose(both.T @ both, np.eye(5), atol=tolerances.of("double"))
    np.testing.assert_array_equal(split.basis[:, 0], np.eye(5)[3])
    np.testing.assert_array_equal(split.complement[:, 0], np.eye(5)[4])
    assert np.abs(split.complement.T @ B).max() < tolerances.of("double")
    assert np.abs(split.complement.T @ A @ split.basis).max() < tolerances.of("double")


@settings(derandomize=True, max_examples=30, deadline=None)
@given(st.integers(0, 10**6))
def test_zeros_come_with_vectors_at_which_the_pencil_is_singular(seed: int) -> None:
    A, B, C, D = matrices(seed)
    zeros = staircase.zeros(A, B, C, 0 * D if seed % 2 else D)
    if not zeros.right:
        A, B, C, D = A.T, C.T, B.T, D.T
    D = 0 * D if seed % 2 else D
    for s, x, u in zip(zeros.values, zeros.x.T, zeros.u.T, strict=True):
        if zeros.rank == min(D.shape):
            size = np.linalg.norm(np.concatenate([x, u])) * max(1.0, abs(s))
            assert np.linalg.norm(A @ x - s * x + B @ u) < tolerances.of("zeros") * size
            assert np.linalg.norm(C @ x + D @ u) < tolerances.of("zeros") * size


def uncontrollable_modes(A: np.ndarray, B: list[float]) -> list[tuple[complex, tuple[str, ...]]]:
    names = tuple(f"x{k + 1}" for k in range(len(A)))
    return [(m.value, m.states) for m in structure.uncontrollable_modes(A, np.array([B]).T, names, Continuous())]


@pytest.mark.parametrize("fast", [-1e11, 1e11, -1e14])
def test_slow_modes_beside_a_fast_one_are_resolved(fast: float) -> None:
    """The staircase alone merges 1 and 2 into one uncontrollable mode at 1.5."""
    assert uncontrollable_modes(np.diag([fast, 1.0, 2.0]), [1.0, 1.0, 1.0]) == []
    assert uncontrollable_modes(np.diag([fast, 1.0, 2.0, 3.0]), [1.0, 1.0, 1.0, 0.0]) == [(3, ("x4",))]
    twice = uncontrollable_modes(np.diag([fast, 1.0, 1.0, 2.0]), [1.0, 1.0, 1.0, 1.0])
    assert [value for value, _ in twice] == pytest.approx([1]) and set(twice[0][1]) == {"x2", "x3"}
    chain = scipy.linalg.block_diag([[0.0, 1.0], [0.0, 0.0]], [[fast]])
    assert uncontrollable_modes(chain, [0.0, 1.0, 1.0]) == []
    assert [value for value, _ in uncontrollable_modes(chain, [1.0, 0.0, 1.0])] == pytest.approx([0])


def test_a_slow_mode_beside_a_fast_one_is_resolved_on_the_diagonal() -> None:
    A = np.diag([-1e-4, -1e9])
    assert uncontrollable_modes(A, [0.0, 1.0]) == []
    assert uncontrollable_modes(A - np.diag([-2e-4, 0.0]), [0.0, 1.0]) == [(1e-4, ("x1",))]
    U = np.linalg.qr(np.random.default_rng(0).normal(size=(2, 2)))[0]
    with pytest.raises(ModelError, match=r"this is within rounding of the fastest mode, 1e.09"):
        structure.check_stabilisable((U @ A @ U.T, U @ [[0.0], [1.0]]))


def test_a_direction_in_many_states_is_cut_short() -> None:
    assert structure.direction_text({f"x{k}": 1.0 for k in range(20)}).endswith("1 x7 and 12 more")
