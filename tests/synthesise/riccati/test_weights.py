"""Weights by name, and definiteness that does not depend on units."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from synth.errors import SignalError
from synth.synthesise.riccati import weights

NAMES = ("x", "v")


def test_a_matrix_a_diagonal_and_names_are_one_weight() -> None:
    for value in (np.diag([2.0, 3.0]), [2.0, 3.0], {"v": 3.0, "x": 2.0}):
        np.testing.assert_array_equal(weights.definite("Q", value, NAMES), np.diag([2.0, 3.0]))
    np.testing.assert_array_equal(weights.semidefinite("Q", {"v": 3.0}, NAMES), np.diag([0.0, 3.0]))
    np.testing.assert_array_equal(weights.cross("N", None, NAMES, ("u",)), np.zeros((2, 1)))


@settings(derandomize=True, max_examples=40, deadline=None)
@given(seed=st.integers(0, 10**6), lowest=st.sampled_from([-1.0, -1e-6, 1e-6, 1.0]))
def test_definiteness_is_that_of_the_eigenvalues_in_any_units(seed: int, lowest: float) -> None:
    rng = np.random.default_rng(seed)
    n = int(rng.integers(2, 6))
    V = np.linalg.qr(rng.normal(size=(n, n)))[0]
    d = 10.0 ** rng.uniform(-8, 8, n)
    M = V @ np.diag([lowest, *rng.uniform(1, 3, n - 1)]) @ V.T * d * d[:, None]
    M, names = (M + M.T) / 2, tuple(f"x{i}" for i in range(n))
    if lowest < 0:
        for check in (weights.semidefinite, weights.definite):
            with pytest.raises(SignalError, match="the matrix Q has the eigenvalue -"):
                check("Q", M, names)
    else:
        np.testing.assert_array_equal(weights.definite("Q", M, names), M)


def test_rounding_passes_as_zero_but_not_as_more() -> None:
    v = np.array([[1.0], [1 / 3]])
    weights.semidefinite("Q", v @ v.T, NAMES)
    with pytest.raises(SignalError, match=r"must be positive definite beyond rounding; weight each of x, v"):
        weights.definite("R", v @ v.T, NAMES)
    weights.definite("R", v @ v.T + 1e-13 * np.eye(2), NAMES)


def test_an_asymmetry_within_rounding_passes_and_the_mean_is_taken() -> None:
    for seed in range(200):
        rng = np.random.default_rng(seed)
        n = int(rng.integers(2, 9))
        names, C, W = tuple(f"x{k}" for k in range(n)), rng.normal(size=(n, n)), rng.normal(size=(n, n))
        M = C.T @ (W @ W.T) @ C
        read = weights.symmetric("Q", M, names)
        np.testing.assert_array_equal(read, read.T)
        np.testing.assert_allclose(read, M, rtol=0, atol=1e-14 * np.abs(M).max())
    one_bit = np.array([[1.0, 0.5], [np.nextafter(0.5, 1), 1.0]])
    assert weights.symmetric("Q", one_bit, NAMES)[0, 1] == weights.symmetric("Q", one_bit, NAMES)[1, 0]
    with pytest.raises(SignalError, match="is not symmetric"):
        weights.symmetric("Q", [[1.0, 0.5], [0.5 + 1e-13, 1.0]], NAMES)
    big = np.array([[1e100, 1e100], [1e100, 1e100]])
    np.testing.assert_array_equal(weights.symmetric("Q", big, NAMES), big)


def test_a_cross_weight_has_its_shape() -> None:
    with pytest.raises(SignalError, match=r"cross weight N is \(1, 2\): 2 states and 1 inputs need a finite one"):
        weights.cross("N", [[1.0, 2.0]], NAMES, ("u",))
    with pytest.raises(SignalError, match=r"entries of the weight N are no real numbers"):
        weights.cross("N", [[1j], [0.0]], NAMES, ("u",))
    joint = weights.joint_weight(np.eye(2), np.eye(1), np.array([[0.5], [0.0]]))
    np.testing.assert_array_equal(joint, [[1, 0, 0.5], [0, 1, 0], [0.5, 0, 1]])
