"""The matrix's field against a finite matrix of magnetised blocks, and against Maxwell's equations."""

import casadi as ca
import magpylib
import numpy as np
import pytest

from models import halbach

l, m = 50.8e-3, 0.715
P = {"l": ca.SX(l), "Delta": ca.SX(l / 4), "mu0_M0": ca.SX(m)}
CYCLE = np.array([(0, 1), (-1, 0), (0, -1), (1, 0)])  # (along the array, up) of successive blocks


def evaluate(points: np.ndarray) -> np.ndarray:
    X, Y, z = (ca.SX.sym(name) for name in "XYz")
    B = halbach.field(X, Y, z, P)
    return np.array(ca.Function("B", [X, Y, z], [B.x, B.y, B.z]).map(len(points))(*points.T)).reshape(3, -1).T


def blocks(pitches: int = 6) -> magpylib.Collection:
    """Return a matrix of ideal blocks whose middle is a block +z of both arrays; its strong side is z = 0."""
    n = 4 * pitches
    magnets = magpylib.Collection()
    for i in range(-n // 2, n // 2 + 1):
        for j in range(-n // 2, n // 2 + 1):
            (x, up_x), (y, up_y) = CYCLE[i % 4], CYCLE[j % 4]
            polarization = m * np.array([x, y, up_x + up_y], float)
            if polarization.any():
                at = (i * l / 4, j * l / 4, -l / 8)
                magnets.add(magpylib.magnet.Cuboid(polarization=polarization, dimension=(l / 4,) * 3, position=at))
    return magnets


def test_a_finite_matrix_of_blocks_has_this_field_at_its_middle() -> None:
    rng = np.random.default_rng(1)
    points = np.column_stack([rng.uniform(-l / 2, l / 2, (40, 2)), rng.uniform(2e-3, 8e-3, 40)])
    theirs = blocks().getB(points)
    difference = np.abs(evaluate(points) - theirs).max()
    assert difference < 0.01 * 2 * float(halbach.amplitude(1, ca.SX(2e-3), P))  # what the ends of the matrix leave


def test_amplitudes_are_the_known_ones() -> None:
    amplitudes = [float(halbach.amplitude(n, ca.SX(z), P)) for z in (0, 3e-3) for n in (1, 3, 5, 7, 9)]
    expected = [0.50991, 0, -0.12870, 0, 0.07153, 0.35184, 0, -0.02013, 0, 0.00254]
    np.testing.assert_allclose(amplitudes, expected, atol=5.1e-6)


def test_the_field_has_neither_divergence_nor_curl() -> None:
    r = ca.SX.sym("r", 3)
    B = halbach.field(r[0], r[1], r[2], P)
    J = ca.Function("J", [r], [ca.jacobian(ca.vertcat(B.x, B.y, B.z), r)])
    for point in np.random.default_rng(2).uniform((-l, -l, 1e-3), (l, l, 1e-2), (20, 3)):
        gradient = np.array(J(point))
        assert abs(np.trace(gradient)) < 1e-12 * np.abs(gradient).max()
        assert np.abs(gradient - gradient.T).max() < 1e-12 * np.abs(gradient).max()


@pytest.mark.parametrize("n", [3, 7, 11])
def test_the_ideal_array_lacks_every_other_odd_harmonic(n: int) -> None:
    assert float(halbach.amplitude(n, ca.SX(0), P)) == 0
