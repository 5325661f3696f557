"""Grids and values fitted to samples; the bilinear Block is compared with SciPy in the Hall position's error map."""

from typing import Any

import casadi as ca
import numpy as np
import pytest

from synth.block import table
from synth.blocks.laws import lookup_table
from synth.blocks.laws.lookup_table import Grid
from synth.errors import ModelError, SignalError

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


@pytest.mark.parametrize("spacing", [0, -1e-3, float("nan"), None, "1", True])
def test_a_grid_without_spacing_or_extent_is_refused(spacing: Any) -> None:
    with pytest.raises((ModelError, SignalError), match=r"spacing.* is "):
        lookup_table.square(1e-3, spacing)
    with pytest.raises((ModelError, SignalError), match=r"half.width.* is "):
        lookup_table.square(spacing, 1e-3)
    with pytest.raises(ModelError, match="spacing is"):
        Grid((0.0, 0.0), spacing, (3, 3))


def test_a_grid_has_at_least_two_points_along_each_side_and_a_maximum() -> None:
    for size, message in (((1, 3), "whole number of at least 2"), ((3.5, 3), "whole"), ((2048, 2048), "wider spacing")):
        with pytest.raises(ModelError, match=message):
            Grid((0.0, 0.0), 1e-3, size)  # type: ignore[arg-type]


AT = np.array([[0.0, 0.0], [0.0, 1.0], [1.0, 0.0], [1.0, 1.0]])


@pytest.mark.parametrize(
    ("at", "values", "message"),
    [
        (AT, np.ones(4), r"the samples has shape \(4,\): give a matrix"),
        (AT, np.ones((3, 1)), r"the samples are \(3, 1\) at positions \(4, 2\)"),
        (AT * np.nan, np.ones((4, 1)), "give finite numbers"),
        (np.zeros((0, 2)), np.zeros((0, 1)), "give finite numbers"),
        (AT, 1j * np.ones((4, 1)), "no real numbers"),
    ],
)
def test_samples_that_do_not_fit_are_refused(at: np.ndarray, values: np.ndarray, message: str) -> None:
    with pytest.raises((ModelError, SignalError), match=message):
        lookup_table.interpolate_samples(at, values, Grid((0.0, 0.0), 1.0, (2, 2)))


@pytest.mark.parametrize("low", [(np.nan, 0.0), (0.0, 0.0, 0.0), None])
def test_a_grid_without_two_low_ends_is_refused(low: Any) -> None:
    with pytest.raises(ModelError, match="the low ends"):
        Grid(low, 1.0, (3, 3))
