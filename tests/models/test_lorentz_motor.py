"""The closed force law against the symbolic integral, against quadrature, and against a finite matrix of blocks."""

from collections.abc import Callable

import casadi as ca
import numpy as np
import pytest
import sympy as sp

from models import halbach, lorentz_motor
from tests import tolerances
from tests.models import lorentz_derivation
from tests.models.test_halbach import blocks

Field = Callable[[np.ndarray, float], tuple[np.ndarray, np.ndarray]]

VALUES = {p.name: p.value for p in lorentz_motor.PARAMETERS}
P = {name: ca.SX(value) for name, value in VALUES.items()}
l, k = VALUES["l"], 2 * np.pi / VALUES["l"]
eta0, Gamma = VALUES["turns"] / VALUES["area"], 6 * VALUES["area"] / VALUES["l"]
K = float(lorentz_motor.force_constant(P))
DOUBLE = tolerances.of("double")


def function(harmonics: tuple[int, ...] = (1,)) -> ca.Function:
    y, z, i = ca.SX.sym("y"), ca.SX.sym("z"), ca.SX.sym("i", 3)
    force = lorentz_motor.forces(y, z, dict(zip("ABC", ca.vertsplit(i), strict=True)), P, harmonics)
    return ca.Function("f", [y, z, i], [force.y, force.z])


def currents(i_q: float, i_d: float, y: float) -> list[float]:
    return [float(v) for v in lorentz_motor.phase_currents(ca.SX(i_q), ca.SX(i_d), ca.SX(y), P).values()]


def quadrature(y: float, i: list[float], field: Field, count: int = 24) -> tuple[float, float]:
    """Return the Lorentz force of the bands from `field(Y (k,), z) -> (B_Y, B_Z)`."""
    nodes, weights = np.polynomial.legendre.leggauss(count)
    heights, bands = VALUES["z0"] + Gamma * (nodes + 1) / 2, l / 12 * nodes
    f_y = f_z = 0.0
    for current, offset in zip(i, (0, -l / 3, l / 3), strict=True):
        for sign, way in ((1, 0.0), (-1, l / 2)):
            for z, weight in zip(heights, weights * Gamma / 2, strict=True):
                B_y, B_z = field(y + offset + way + bands, z)
                f_y += sign * eta0 * current * weight * (l / 12 * weights @ B_z)
                f_z -= sign * eta0 * current * weight * (l / 12 * weights @ B_y)
    return VALUES["w"] * VALUES["Nm"] * f_y, VALUES["w"] * VALUES["Nm"] * f_z


def ideal(harmonics: tuple[int, ...]) -> Field:
    def at(Y: np.ndarray, z: float) -> tuple[np.ndarray, np.ndarray]:
        A = {n: float(halbach.amplitude(n, ca.SX(z), P)) for n in harmonics}
        B_y = sum(A[n] * np.sin(n * k * Y) for n in harmonics)
        return B_y, sum(A[n] * np.cos(n * k * Y) for n in harmonics)

    return at


@pytest.mark.parametrize("harmonics", [(1,), (1, 5, 9)])
def test_the_closed_form_is_the_integral(harmonics: tuple[int, ...]) -> None:
    f = function(harmonics)
    for y in (0.0, 3e-3, -17e-3):
        i = currents(0.7, -0.4, y + 1e-3)
        np.testing.assert_allclose(np.array(f(y, 0, i)).ravel(), quadrature(y, i, ideal(harmonics)), rtol=DOUBLE)


def test_the_symbolic_integral_is_the_closed_form() -> None:
    d = lorentz_derivation
    law = d.force_law()
    numbers = {d.l: l, d.Gamma: Gamma, d.Delta: VALUES["Delta"], d.w: VALUES["w"], d.eta0: eta0, d.Nm: VALUES["Nm"]}
    numbers |= {d.m: VALUES["mu0_M0"], d.z0: VALUES["z0"]}
    evaluate = sp.lambdify([d.y, *d.CURRENTS.values()], [law.f_y.subs(numbers), law.f_z.subs(numbers)])
    for y in (0.0, 5e-3, -31e-3):
        np.testing.assert_allclose(
            evaluate(y, 0.3, -0.7, 1.1), np.ravel(function()(y, 0, [0.3, -0.7, 1.1])), rtol=DOUBLE
        )
    constant = d.force_constant()
    assert d.y not in constant.free_symbols
    assert float(constant.subs(numbers)) == pytest.approx(K, rel=DOUBLE)


def test_17_as_printed_lacks_the_distribution_factor_of_its_bands() -> None:
    printed = float(lorentz_motor.force_constant(P, "printed"))
    assert printed / K == pytest.approx(np.pi / 3, rel=DOUBLE)
    unsound = quadrature(0.0, currents(1, 0, 0), ideal((1,)))[0]
    assert abs(printed - unsound) > 0.9 and abs(K - unsound) < 1e-9


def test_commutation_is_exact_at_every_position() -> None:
    f = function()
    for y in np.random.default_rng(3).uniform(-0.1, 0.1, 200):
        i_q, i_d = np.random.default_rng(int(abs(y) * 1e9)).uniform(-1, 1, 2)
        i = currents(i_q, i_d, y)
        np.testing.assert_allclose(np.ravel(f(y, 0, i)), [K * i_q, K * i_d], rtol=0, atol=1e-12 * K)
        a, b = (2 * i[0] - i[1] - i[2]) / 3, (i[1] - i[2]) / np.sqrt(3)
        back = np.array([[np.cos(k * y), np.sin(k * y)], [-np.sin(k * y), np.cos(k * y)]]) @ [a, b]
        np.testing.assert_allclose(back, [i_q, i_d], atol=DOUBLE)
        assert abs(sum(i)) < DOUBLE


def test_a_finite_matrix_pushes_the_winding_as_the_closed_form_says() -> None:
    """Over the middle of a matrix of ideal blocks, averaged over the conductors' length; harmonics make the rest."""
    matrix, across = blocks(), (np.arange(8) + 0.5) / 8 * l - l / 2
    scale = VALUES["mu0_M0"] / 0.715

    def field(Y: np.ndarray, z: float) -> tuple[np.ndarray, np.ndarray]:
        X, YY = np.meshgrid(across, Y, indexing="ij")
        B = matrix.getB(np.column_stack([X.ravel(), YY.ravel(), np.full(X.size, z)])).reshape(*X.shape, 3).mean(axis=0)
        return scale * B[:, 1], scale * B[:, 2]

    force = quadrature(2e-3, currents(1, 0, 2e-3), field, 5)
    np.testing.assert_allclose(force, np.ravel(function((1, 5, 9))(2e-3, 0, currents(1, 0, 2e-3))), atol=0.01 * K)
