"""Sums of products against the functions that they stand for."""

import casadi as ca
import numpy as np
import pytest

from models import finite_tables

POINTS = np.linspace(-1.0, 1.0, 81)
GRID = np.meshgrid(POINTS, POINTS, indexing="ij")


def functions(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    return np.array([np.sin(3 * x) * np.cos(2 * y) + x * y, np.exp(-((x - y) ** 2)), np.zeros_like(x)])


def table(bound: float) -> ca.Function:
    return finite_tables.function("w", POINTS, functions(*GRID), [bound] * 3)


@pytest.mark.parametrize("bound", [1e-2, 1e-5])
def test_a_table_keeps_its_bound_on_the_grid_and_a_spline_between(bound: float) -> None:
    w = table(bound)
    for places, spline in (
        ((POINTS[5:70:13], POINTS[3:80:15]), 1e-12),
        (np.random.default_rng(1).uniform(-1, 1, (2, 9)), 1e-6),
    ):
        for x, y in zip(*places, strict=False):
            values = np.array(w(x, y)).ravel()
            np.testing.assert_allclose(
                values, functions(x, y), rtol=0, atol=2 * bound * (spline > 1e-9) + bound + spline
            )


def test_a_looser_bound_is_a_shorter_sum() -> None:
    """Rank 2, and one that grows with the logarithm of the bound; nothing of a function that is 0."""
    x, y = np.array([[0.11], [0.3]])
    sizes = [[finite_tables._terms(v, bound)[0].shape[1] for v in functions(*GRID)] for bound in (1e-2, 1e-5, 1e-8)]
    assert [s[0] for s in sizes] == [2, 2, 2] and [s[2] for s in sizes] == [0, 0, 0]
    assert sizes[0][1] < sizes[1][1] < sizes[2][1] < 14
    assert np.array(table(1e-8)(x, y))[2] == 0


def test_outside_the_edge_counts() -> None:
    w = table(1e-6)
    np.testing.assert_array_equal(w(1.5, 0.2), w(1.0, 0.2))
    np.testing.assert_array_equal(w(0.1, -7.0), w(0.1, -1.0))


def test_it_is_called_from_scalar_expressions_and_differentiated() -> None:
    """As a Plant needs it, whose expressions are scalar."""
    x, y, w = ca.SX.sym("x"), ca.SX.sym("y"), table(1e-8)
    first = w(x, y)[0]
    slope = ca.Function("slope", [x, y], [ca.jacobian(first, x)])
    assert float(slope(0.2, 0.4)) == pytest.approx(3 * np.cos(0.6) * np.cos(0.8) + 0.4, abs=1e-4)
