"""The finite matrix' series against magpylib's blocks, against the infinite matrix, and with its magnets turned."""

import casadi as ca
import numpy as np
import pytest

from models import finite_matrix, halbach
from tests.models import finite_oracle

LATTICE = 1e-4  # T: other matrices of the lattice add 4.7e-5 T, harmonics beyond the 24th 3e-5 T at the sensors' height


@pytest.fixture(scope="module")
def fabricated() -> finite_matrix.Series:
    return finite_matrix.series(finite_matrix.fabricated_blocks(), 24)


BLOCKS = finite_oracle.single(finite_matrix.fabricated_blocks())


def difference(series: finite_matrix.Series, z: float = 3e-3) -> float:
    """Return by how much B of a series is off from blocks as made, somewhere above them or just beside, T."""
    at = np.random.default_rng(3).integers(-150, 151, (60, 2))
    theirs = BLOCKS.getB(np.column_stack([at * series.spacing, np.full(60, z)]))
    reach = 150 * series.spacing
    ours = [series.evaluate(c, reach)[at[:, 0] + 150, at[:, 1] + 150] for c in finite_matrix.flux_density(series, z)]
    return float(np.abs(np.transpose(ours) - theirs).max())


def test_the_series_is_the_field_of_the_blocks(fabricated: finite_matrix.Series) -> None:
    assert difference(fabricated) < LATTICE
    assert difference(fabricated, 8e-3) < LATTICE


def test_the_slope_along_z_is_the_difference_of_two_heights(fabricated: finite_matrix.Series) -> None:
    flux = {z: fabricated.evaluate(finite_matrix.flux_density(fabricated, z)[0], 0.05) for z in (2.9e-3, 3e-3, 3.1e-3)}
    slope = fabricated.evaluate(finite_matrix.flux_density(fabricated, 3e-3, 1)[0], 0.05)
    third = 7e-4 * np.abs(slope).max()  # (13 k h)^2 / 6 of what the 13th harmonic has of the slope, a twentieth
    np.testing.assert_allclose(slope, (flux[3.1e-3] - flux[2.9e-3]) / 2e-4, rtol=0, atol=third)


def test_what_blocks_there_are() -> None:
    for matrix, strong, weak in (
        (finite_matrix.fabricated_blocks(), 1.43, 1.10),
        (finite_matrix.ideal_blocks(), 1.42, 1.0041),
    ):
        sizes = np.linalg.norm(matrix.remanence, axis=2)
        counts = [int(np.isclose(sizes, size, atol=1e-4).sum()) for size in (strong, weak, 0.0)]
        assert counts == [72, 432, 72]  # an eighth each, and the rest, of 24 x 24
        i = finite_matrix.BEFORE
        assert matrix.places[i] == 0 and matrix.remanence[i, i].tolist() == [0, 0, strong]
        assert np.ptp(matrix.places) + finite_matrix.SIDE == pytest.approx(304.8e-3)


def test_harmonics_in_the_middle_pitch(fabricated: finite_matrix.Series) -> None:
    """Of an infinite matrix of these blocks 0.37502 and 0.02146 T, and 0.34932 T of ideal ones of 0.71 T; ends add."""
    for series, n, expected in (
        (fabricated, 1, 0.37502),
        (fabricated, 5, -0.02146),
        (finite_matrix.series(finite_matrix.ideal_blocks(), 24), 1, ideal(1)),
    ):
        pitch = series.evaluate(finite_matrix.flux_density(series, 3e-3)[0], 25.4e-3)[:-1, :-1]
        wave = np.sin(2 * np.pi * n / 50.8e-3 * series.grid(25.4e-3)[:-1])
        assert 2 * np.mean(pitch * wave[:, None]) == pytest.approx(expected, abs=6e-4)


def ideal(n: int) -> float:
    p = {name: ca.SX(value) for name, value in finite_matrix.VALUES.items()}
    return float(halbach.amplitude(n, ca.SX(3e-3), p))
