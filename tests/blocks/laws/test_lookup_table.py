"""Grids and values fitted to samples; the bilinear Block is compared with SciPy in the Hall position's error map."""

import casadi as ca
import numpy as np
import pytest

from synth.block import table
from synth.blocks.laws import lookup_table
from synth.blocks.laws.lookup_table import Grid
from synth.errors import ModelError

GRID = Grid((-1.0, 2.0), 0.5, (5, 3))


def bilinear(values: np.ndarray, x: float, y: float) -> float:
    place = [ca.SX.sym(name) for name in "xy"]
    value = lookup_table.bilinear({"v": table("v", values.ravel())}, GRID, *place)["v"]
    return float(ca.Function("f", place, [value])(x, y))


def test_a_bilinear_function_is_reproduced_and_its_edge_extended() -> None:
    x, y = np.meshgrid(*GRID.axes, indexing="ij")
    values = 1 + 2 * x - 3 * y + 0.5 * x * y
    assert bilinear(values, 0.3, 2.2) == pytest.approx(1 + 0.6 - 6.6 + 0.33)
    assert bilinear(values, 9.0, -9.0) == pytest.approx(values[-1, 0])
    assert bilinear(values, 1.0, 3.0) == pytest.approx(values[-1, -1])


def test_linear_samples_are_fitted_exactly() -> None:
    at = np.random.default_rng(0).uniform((-2, 1), (2, 4), (200, 2))
    values = np.column_stack([at @ [1.0, 2.0], at @ [-3.0, 0.5] + 1])
    fitted = lookup_table.interpolate_samples(at, values, GRID)
    x, y = np.meshgrid(*GRID.axes, indexing="ij")
    np.testing.assert_allclose(fitted, np.stack([x + 2 * y, -3 * x + 0.5 * y + 1], axis=-1), rtol=1e-12, atol=1e-12)
    with pytest.raises(ModelError, match="no samples lie about"):
        lookup_table.interpolate_samples(at, values, lookup_table.square(5.0, 1.0))
