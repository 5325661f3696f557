"""Error map: exact for linear errors, in the C as in NumPy."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import interpolate

from synth.block import unranged
from synth.blocks.laws import error_map
from synth.blocks.laws.error_map import ErrorMap
from synth.blocks.laws.lookup_table import Grid
from synth.emit import write
from synth.execute import host
from synth.signals import Signal
from synth.timing import Discrete

TIME = Discrete(1 / 800)
GRID = Grid((-4e-3, -2e-3), 1e-3, (9, 6))
UNITS = np.array([1e-8, 1e-8, 1e-6])  # m, m, rad
SIGNALS = [Signal(name, unit, -10, 10) for name, unit in (("X", "m"), ("Y", "m"), ("yaw", "rad"))]
NAMES = [s.name for s in SIGNALS]
RNG = np.random.default_rng(0)
RANDOM = ErrorMap(GRID, 1e-4 * RNG.standard_normal((3, *GRID.size)))


def scattered_samples(n: int = 400) -> tuple[np.ndarray, np.ndarray]:
    """Return estimates and references (n, 3) whose difference is linear in the estimated place."""
    estimated = np.column_stack([RNG.uniform(-6e-3, 6e-3, (n, 2)), RNG.uniform(-1e-3, 1e-3, n)])
    tilt = np.array([[3e-3, -2e-3, 0.1], [1e-3, 5e-3, 0.2]])
    return estimated, estimated + estimated[:, :2] @ tilt + [1e-5, -2e-5, 1e-4]


def correct(of: ErrorMap, estimated: np.ndarray) -> np.ndarray:
    """Return corrected estimates (N, 3), by SciPy."""
    points = [np.clip(estimated[:, k], axis[0], axis[-1]) for k, axis in enumerate(of.grid.axes)]
    between = interpolate.RegularGridInterpolator(of.grid.axes, np.moveaxis(of.added, 0, -1))
    return estimated + between(np.column_stack(points))


def places() -> np.ndarray:
    """Return estimates (N, 3) inside the grid, on its points and lines, and beyond its ends."""
    inside = np.column_stack([RNG.uniform(-6e-3, 6e-3, (3000, 2)), RNG.uniform(-0.02, 0.02, 3000)])
    points = np.array(np.meshgrid(*GRID.axes)).reshape(2, -1).T
    return np.vstack([inside, np.column_stack([points, np.zeros(len(points))])])


def correct_in_c(of: ErrorMap, scalar: type[np.floating], at: np.ndarray) -> np.ndarray:
    made = write.emit(unranged(error_map.block(of, TIME, SIGNALS)), scalar)
    outputs = host.load(made.files, made.manifest).replay(dict(zip(NAMES, at.T, strict=True))).outputs
    return np.stack([outputs[f"{name}_corrected"] for name in NAMES], axis=1)


def test_linear_errors_are_corrected_to_the_unit_of_the_map() -> None:
    estimated, reference = scattered_samples()
    fitted = error_map.fit(estimated, reference, GRID, UNITS)
    inside = np.all([np.abs(estimated[:, k]) < -GRID.low[k] for k in (0, 1)], axis=0)
    left = (correct(fitted, estimated) - reference)[inside]
    assert np.all(np.abs(left) <= UNITS)
    assert np.abs(estimated - reference)[inside].max() > 1e-4
    np.testing.assert_allclose(
        np.rint(fitted.added / UNITS[:, None, None]) * UNITS[:, None, None], fitted.added, atol=0
    )


@pytest.mark.parametrize(("scalar", "most"), [(np.float64, 1e-15), (np.float32, 1e-8)])
def test_the_c_corrects_as_the_map_does(scalar: type[np.floating], most: float) -> None:
    at = places()
    assert np.abs(correct_in_c(RANDOM, scalar, at) - correct(RANDOM, at)).max() < most
    mirrored = replace(RANDOM, added=RANDOM.added[:, ::-1])
    assert np.abs(correct_in_c(mirrored, scalar, at) - correct(RANDOM, at)).max() > 1e-5


def test_beyond_the_table_the_edge_values_are_used() -> None:
    far = np.array([[9.0, -9.0, 0.0]])
    np.testing.assert_allclose(correct_in_c(RANDOM, np.float64, far)[0] - far[0], RANDOM.added[:, -1, 0], atol=1e-14)
