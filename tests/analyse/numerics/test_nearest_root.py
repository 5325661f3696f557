"""Roots nearest the origin against equations whose roots are all known."""

from itertools import product

import numpy as np
import pytest

from synth.analyse.numerics import nearest_root

Array = np.ndarray


def product_system(a: Array, b: Array) -> nearest_root.System:
    """Return f_i = prod_j (a_ij . z - b_ij), a (n, d, n), b (n, d), on the cube |z| <= 1."""
    n, d, _ = a.shape

    def linear(z: Array) -> tuple[Array, Array]:
        factors = a @ z - b
        others = np.stack([np.delete(factors, j, axis=1).prod(axis=1) for j in range(d)], axis=1)
        return factors.prod(axis=1), np.einsum("ij,ijk->ik", others, a)

    def stationary(w: Array) -> tuple[Array, Array]:
        z, multiplier = w[:n], w[n:]
        f, J = linear(z)
        factors, curvature = a @ z - b, np.eye(n)
        for j, k in product(range(d), repeat=2):
            if j != k:
                rest = multiplier * np.delete(factors, (j, k), axis=1).prod(axis=1)
                curvature += np.einsum("i,ip,iq->pq", rest, a[:, j], a[:, k])
        return np.concatenate([J.T @ multiplier + z, f]), np.block([[curvature, J.T], [J, np.zeros((n, n))]])

    return nearest_root.System(linear, stationary, -np.ones(n), np.ones(n), 1e-10)


def known_roots(a: Array, b: Array) -> list[Array]:
    n, d, _ = a.shape
    choices = (list(choice) for choice in product(range(d), repeat=n))
    return [np.linalg.solve(a[np.arange(n), choice], b[np.arange(n), choice]) for choice in choices]


@pytest.mark.slow
@pytest.mark.parametrize(("n", "d"), [(1, 2), (1, 5), (2, 2), (2, 3), (3, 2)])
def test_the_nearest_of_many_roots_is_taken(n: int, d: int) -> None:
    for seed in range(8):
        rng = np.random.default_rng(seed)
        a, b = rng.normal(size=(n, d, n)), rng.uniform(-1, 1, (n, d))
        expected = min(known_roots(a, b), key=lambda z: float(np.linalg.norm(z)))
        (root,) = nearest_root.find(product_system(a, b)).roots
        np.testing.assert_allclose(root, expected, rtol=0, atol=1e-6 * np.linalg.norm(expected) + 1e-9)


def ellipse(centre: Array, axes: Array) -> nearest_root.System:
    """Return f = |(z - centre) / axes|^2 - 1: a continuum of roots."""
    n = len(centre)

    def linear(z: Array) -> tuple[Array, Array]:
        shift = (z - centre) / axes
        return np.array([shift @ shift - 1]), (2 * shift / axes)[None]

    def stationary(w: Array) -> tuple[Array, Array]:
        f, J = linear(w[:n])
        curvature = np.diag(1 + 2 * w[n] / axes**2)
        return np.concatenate([J.T @ w[n:] + w[:n], f]), np.block([[curvature, J.T], [J, np.zeros((1, 1))]])

    return nearest_root.System(linear, stationary, -np.ones(n), np.ones(n), 1e-10)


@pytest.mark.parametrize("seed", range(6))
def test_on_a_continuum_no_sampled_root_is_nearer(seed: int) -> None:
    rng = np.random.default_rng(seed)
    n = 2 + seed % 3
    centre, axes = rng.uniform(-1, 1, n), rng.uniform(0.3, 1.5, n)
    root = nearest_root.find(ellipse(centre, axes)).roots[0]
    sphere = rng.normal(size=(200_000, n))
    sampled = centre + axes * sphere / np.linalg.norm(sphere, axis=1)[:, None]
    assert np.linalg.norm(root) <= np.linalg.norm(sampled, axis=1).min() * (1 + 1e-12)
    assert abs(np.sum(((root - centre) / axes) ** 2) - 1) < 1e-9


def test_an_affine_system_needs_no_other_start() -> None:
    rng = np.random.default_rng(1)
    for shape in ((1, 1), (2, 4), (3, 3), (3, 2)):
        J, z = rng.normal(size=shape), rng.normal(size=shape[1])

        def linear(w: Array, J: Array = J, z: Array = z) -> tuple[Array, Array]:
            return J @ (w - z), J

        def stationary(w: Array, J: Array = J, z: Array = z) -> tuple[Array, Array]:
            k, n = J.shape
            zero = np.zeros((k, k))
            return np.concatenate([J.T @ w[n:] + w[:n], J @ (w[:n] - z)]), np.block([[np.eye(n), J.T], [J, zero]])

        ends = (-np.ones(shape[1]), np.ones(shape[1]))
        one, many = (nearest_root.System(linear, stationary, *ends, 1e-10, affine) for affine in (True, False))
        for system in (one, many):
            (root,) = nearest_root.find(system).roots
            np.testing.assert_allclose(root, np.linalg.pinv(J) @ J @ z, rtol=0, atol=1e-11)


def test_the_order_of_ties_does_not_depend_on_rounding() -> None:
    near = 0.00005  # at this value a rounding to multiples of the tolerance would turn with the last digit
    for nudge in (-1e-12, 0.0, 1e-12):
        roots = [np.array([near + nudge, -0.5]), np.array([near, 0.5]), np.array([-0.5, near])]
        first, second, third = nearest_root._nearest(roots)
        assert (first[1], second[1], third[0]) == (0.5, -0.5, -0.5)


def test_a_step_out_of_the_domain_is_shortened_and_an_undefined_system_has_no_best() -> None:
    def linear(z: Array) -> tuple[Array, Array]:
        with np.errstate(invalid="ignore", divide="ignore"):
            return np.log(z) + 6, (1 / z)[None]

    def stationary(w: Array) -> tuple[Array, Array]:
        (z, multiplier), (f, J) = w, linear(w[:1])
        return np.array([J[0, 0] * multiplier + z, f[0]]), np.array([[1 - multiplier / z**2, J[0, 0]], [J[0, 0], 0]])

    inside = nearest_root.System(linear, stationary, np.zeros(1), np.ones(1), 1e-12)
    assert nearest_root.find(inside).roots[0] == pytest.approx(np.exp(-6), rel=1e-12)
    outside = nearest_root.System(linear, stationary, -np.ones(1), np.zeros(1), 1e-12)
    assert (nearest_root.find(outside).roots, nearest_root.find(outside).best) == ((), None)
