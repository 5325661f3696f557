"""Groups' own parameters, taken out one by one, leave what a dense Jacobian gives."""

import numpy as np
import pytest

from synth.synthesise.identify import least_squares
from tests import tolerances


def case(f: int) -> tuple[least_squares.Jacobian, np.ndarray, np.ndarray]:
    """Return a Jacobian of 3 groups of 5 rows and 2 outputs, the same dense, and residuals."""
    rng = np.random.default_rng(f)
    J = least_squares.Jacobian(rng.normal(size=(15, 2, 4)) * [1, 1e3, 1e-3, 1], rng.normal(size=(3, 5, 2, f)))
    dense = np.zeros((30, 4 + 3 * f))
    dense[:, :4] = J.shared.reshape(30, 4)
    for g in range(3):
        dense[10 * g : 10 * g + 10, 4 + g * f : 4 + (g + 1) * f] = J.group[g].reshape(10, f)
    return J, dense, rng.normal(size=30)


@pytest.mark.parametrize("f", [0, 2])
@pytest.mark.parametrize("damping", [0.0, 1e-3, 10.0])
def test_damped_steps_are_those_of_the_dense_equations(f: int, damping: float) -> None:
    J, dense, e = case(f)
    size = np.linalg.norm(dense, axis=0)
    M = dense / size
    expected = np.linalg.solve(M.T @ M + damping * np.eye(len(size)), M.T @ e) / size
    shared, apart = least_squares.factorise(J).step(e, damping, np.ones(4, dtype=bool))
    np.testing.assert_allclose(np.concatenate([shared, apart.ravel()]), expected, rtol=1e-9)
    assert J.parameters == len(size)


@pytest.mark.parametrize("f", [0, 2])
def test_what_is_left_is_outside_the_range(f: int) -> None:
    J, dense, e = case(f)
    parts = least_squares.factorise(J)
    M = dense / np.linalg.norm(dense, axis=0)
    expected = e - M @ np.linalg.lstsq(M, e, rcond=None)[0]
    np.testing.assert_allclose(parts.outside_range(e), expected, atol=tolerances.of("double"))
    np.testing.assert_allclose(parts.U.T @ parts.U, np.eye(4), atol=tolerances.of("double"))


def test_parameters_that_act_are_counted_by_output() -> None:
    J = case(2)[0]
    J.shared[:, 1, 2:] = 0
    J.group[0, :, 1, 0] = 0
    np.testing.assert_array_equal(J.parameters_per_output(), [4 + 6, 2 + 5])
