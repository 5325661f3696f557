"""The waves above periodic matrices against published amplitudes, finite blocks, another series, and Maxwell."""

from collections.abc import Iterable

import casadi as ca
import numpy as np
import pytest

from models import concentrated_field as cf
from models import finite_matrix, halbach
from synth.errors import ModelError
from tests.models import matrix_oracle

P = cf.values()
l = matrix_oracle.l
FABRICATED, IDEAL = cf.fabricated_matrix(P["strong"], P["weak"]), cf.ideal_matrix(P["strong"])
ENDS = 2e-3  # T: what a matrix of six pitches lacks of an infinite one within a pitch of its middle, B_Z included
TABLE = (  # n = 1, 3, 5, 7, 9 and (2, +-1), to 1e-5 T
    (IDEAL, 0.0, (0.50991, 0, -0.12870, 0, 0.07153, 0)),
    (IDEAL, 3e-3, (0.35184, 0, -0.02013, 0, 0.00254, 0)),
    (FABRICATED, 0.0, (0.54351, -0.00467, -0.13718, 0.00202, 0.07624, -0.00781)),
    (FABRICATED, 3e-3, (0.37502, -0.00153, -0.02146, 0.00015, 0.00270, -0.00341)),
)


def amplitudes(cell: cf.Cell, orders: Iterable[cf.Order], z: float) -> list[float]:
    return [float(cf.amplitude(wave, z)) for wave in cf.waves(cell, orders, P)]


def evaluate(waves: tuple[cf.Wave, ...], points: np.ndarray) -> np.ndarray:
    r = ca.SX.sym("r", 3)
    B = cf.field(waves, r[0], r[1], r[2])
    return ca.Function("B", [r], [ca.vertcat(B.x, B.y, B.z)]).map(len(points))(points.T).full().T


def middle(count: int = 60) -> np.ndarray:
    rng = np.random.default_rng(4)
    return np.column_stack([rng.uniform(-l / 2, l / 2, (count, 2)), rng.uniform(2e-3, 8e-3, count)])


@pytest.mark.parametrize(("cell", "z", "expected"), TABLE)
def test_amplitudes_are_the_known_ones(cell: cf.Cell, z: float, expected: tuple[float, ...]) -> None:
    for cross in cf.CROSS[:2]:
        sizes = amplitudes(cell, [*((n, 0) for n in (1, 3, 5, 7, 9)), cross], z)
        np.testing.assert_allclose(sizes, expected, rtol=0, atol=5.01e-6)
    both_axes = amplitudes(cell, cf.orders_on_axes((1, 3, 5, 7, 9)), z)
    np.testing.assert_array_equal(both_axes[::2], both_axes[1::2])


@pytest.fixture(scope="module")
def pitch() -> tuple[np.ndarray, np.ndarray]:
    """Points of a pitch (n, 3) at 3 mm, dense enough for the 19th harmonic, and the flux there of finite blocks."""
    X, Y = np.meshgrid(l * np.arange(40) / 40, l * np.arange(40) / 40, indexing="ij")
    at = np.column_stack([X.ravel(), Y.ravel(), np.full(X.size, 3e-3)])
    return at, matrix_oracle.blocks().getB(at)


def test_the_fundamental_of_six_pitches_is_within_a_thousandth(pitch: tuple[np.ndarray, np.ndarray]) -> None:
    at, flux = pitch
    for axis in range(2):
        theirs = 2 * np.mean(flux[:, axis] * np.sin(2 * np.pi / l * at[:, axis]))
        assert theirs == pytest.approx(0.37480, abs=6e-6)
        assert amplitudes(FABRICATED, [(1, 0)], 3e-3)[0] == pytest.approx(theirs, rel=1e-3)


def test_all_three_components_are_those_of_finite_blocks() -> None:
    points = middle()
    theirs = matrix_oracle.blocks().getB(points)
    ours = evaluate(cf.waves(FABRICATED, cf.orders_up_to(9), P), points)
    assert np.abs(ours - theirs).max() < ENDS
    without = evaluate(cf.waves(FABRICATED, cf.orders_on_axes(range(1, 10)), P), points)
    assert np.abs(without - theirs).max() > 4 * ENDS  # what the cross terms are good for


def test_most_of_what_the_fitted_model_leaves_are_cross_terms(pitch: tuple[np.ndarray, np.ndarray]) -> None:
    """Model (2) leaves 123 mV at 8.4 V/T, less than the 200 mV of the paper; with the 9th and cross terms 42 mV."""
    at, flux = pitch
    volts, X, w = 8.4 * flux[:, 0], at[:, 0], 2 * np.pi / l
    basis = np.column_stack([np.ones_like(X), np.sin(w * X), np.sin(5 * w * X)])
    fit = np.linalg.lstsq(basis, volts, rcond=None)[0]
    np.testing.assert_allclose(fit / 8.4, [0.00037, 0.37480, -0.02150], rtol=0, atol=1e-5)
    assert np.abs(volts - basis @ fit).max() == pytest.approx(0.123, abs=1e-3)
    waves = cf.waves(FABRICATED, cf.orders_on_axes((1, 5, 9)) + cf.CROSS, P)
    assert np.abs(volts - 8.4 * evaluate(waves, at)[:, 0]).max() == pytest.approx(0.042, abs=1e-3)


def test_the_matrix_is_two_arrays_superposed() -> None:
    one, points = cf.halbach_array(P["strong"] / 2), middle()
    parts = [evaluate(cf.waves(each, cf.orders_on_axes((1, 5, 9)), P), points) for each in (one, cf.mirrored(one))]
    both = evaluate(cf.waves(IDEAL, cf.orders_on_axes((1, 5, 9)), P), points)
    np.testing.assert_allclose(both, parts[0] + parts[1], rtol=0, atol=1e-15)
    np.testing.assert_array_equal(parts[0][:, 1], 0.0)
    assert [wave.order for wave in cf.waves(one, cf.orders_up_to(3), P)] == [(1, 0), (2, 0), (3, 0)]


def test_ideal_blocks_have_the_closed_form() -> None:
    p = P | {"mu0_M0": P["strong"] / 2}
    X, Y, z = (ca.SX.sym(name) for name in "XYz")
    B = halbach.field(X, Y, z, p)
    points = middle()
    theirs = ca.Function("B", [X, Y, z], [ca.vertcat(B.x, B.y, B.z)]).map(len(points))(*points.T[:, None, :])
    ours = evaluate(cf.waves(IDEAL, cf.orders_on_axes(range(1, 10)), P), points)
    np.testing.assert_allclose(ours, theirs.full().T, rtol=0, atol=1e-15)


def test_a_halbach_array_is_stronger_by_the_root_of_two() -> None:
    plain = cf.array([0.0, 0.0], [0.7, -0.7])
    gain = amplitudes(cf.halbach_array(0.7), [(1, 0)], 0.0)[0] / amplitudes(plain, [(1, 0)], 0.0)[0]
    assert gain == pytest.approx(np.sqrt(2), rel=1e-14)


def test_any_blocks_have_neither_divergence_nor_curl() -> None:
    rng, r = np.random.default_rng(7), ca.SX.sym("r", 3)
    cell = cf.Cell(*(ca.SX(rng.normal(size=(3, 5))) for _ in range(3)))
    B = cf.field(cf.waves(cell, cf.orders_up_to(3), P), r[0], r[1], r[2])
    J = ca.Function("J", [r], [ca.jacobian(ca.vertcat(B.x, B.y, B.z), r)])
    for point in middle(10):
        gradient = J(point).full()
        assert abs(np.trace(gradient)) < 1e-12 * np.abs(gradient).max()
        assert np.abs(gradient - gradient.T).max() < 1e-12 * np.abs(gradient).max()


def test_a_whole_matrix_as_one_cell_has_the_coefficients_of_the_other_series() -> None:
    """Twelve pitches with a matrix of six at a place without symmetry, so that sines count as well as cosines."""
    matrix, size = finite_matrix.fabricated_blocks(), 4 * finite_matrix.CELL
    J = np.zeros((size, size, 3))
    index = np.arange(-finite_matrix.BEFORE, finite_matrix.BLOCKS - finite_matrix.BEFORE) % size
    J[np.ix_(index, index)] = matrix.remanence
    cell = cf.Cell(*(ca.SX(J[:, :, axis]) for axis in range(3)))
    series = finite_matrix.series(matrix, 3)
    p = {"l": ca.SX(finite_matrix.CELL * l), "Delta": P["Delta"]}
    orders = [(12, 0), (0, 12), (12, 1), (11, 12), (24, 11), (23, -12), (1, 1), (3, -7), (5, 5), (29, 17)]
    for wave in cf.waves(cell, orders, p):
        a, b = wave.order
        theirs = series.potential[a, b] if b >= 0 else np.conj(series.potential[-a, -b])
        assert float(wave.cosine) == pytest.approx(2 * theirs.real, rel=1e-11, abs=1e-18)
        assert float(wave.sine) == pytest.approx(-2 * theirs.imag, rel=1e-11, abs=1e-18)
        assert abs(theirs) > 1e-9


def test_every_parameter_may_be_a_symbol() -> None:
    p, z = {name: ca.SX.sym(name) for name in P}, ca.SX.sym("z")
    fabricated = cf.fabricated_matrix(p["strong"], p["weak"])
    orders = [(1, 0), (3, 0), (2, -1), (1, 2)]
    sizes = ca.vertcat(*(cf.amplitude(wave, z) for wave in cf.waves(fabricated, orders, p)))
    at = [float(value) for value in P.values()]
    of = ca.Function("A", [*p.values(), z], [sizes, ca.jacobian(sizes, z)])
    value, slope = (each.full().ravel() for each in of(*at, 3e-3))
    np.testing.assert_allclose(value, amplitudes(FABRICATED, orders, 3e-3), rtol=1e-14)
    kappa = 2 * np.pi / l * np.array([1, 3, np.sqrt(5), np.sqrt(5)])
    np.testing.assert_allclose(slope, -kappa * value, rtol=1e-13)


def test_fitted_amplitudes_are_those_at_their_height() -> None:
    sizes = {1: 0.375, 5: -0.0215}
    waves = cf.waves_from_amplitudes(sizes, 3e-3, P)
    assert [float(cf.amplitude(wave, 3e-3)) for wave in waves] == pytest.approx([0.375, 0.375, -0.0215, -0.0215])
    B = evaluate(waves, np.array([[4e-3, 7e-3, 3e-3]]))[0]
    expected = [sum(A * np.sin(2 * np.pi * n / l * x) for n, A in sizes.items()) for x in (4e-3, 7e-3)]
    np.testing.assert_allclose(B[:2], expected, rtol=1e-13)


def test_orders_that_blocks_do_not_make_are_left_out() -> None:
    assert not cf.waves(FABRICATED, [(4, 0), (0, 8), (4, 3)], P)
    assert len(cf.orders_up_to(2)) == 12  # (5 x 5 - 1) / 2
    assert all((-a, -b) not in cf.orders_up_to(2) for a, b in cf.orders_up_to(2))


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: cf.waves(FABRICATED, [(0, 0)], P), "no field"),
        (lambda: cf.waves(FABRICATED, [(1, 0), (1, 0)], P), "listed twice"),
        (lambda: cf.waves(FABRICATED, [(2, 1), (-2, -1)], P), "listed twice"),
        (lambda: cf.array([1.0, 0.0], [1.0]), "one of each for every block"),
        (lambda: cf.array([], []), "one of each for every block"),
        (lambda: cf.superpose(cf.array([1, 0], [0, 1]), cf.halbach_array(0.7)), "do not fit"),
    ],
)
def test_refusals_name_the_mend(call: object, message: str) -> None:
    assert callable(call)
    with pytest.raises(ModelError, match=message):
        call()


def test_the_amplitudes_are_those_of_figure_3() -> None:
    numbers, p = range(1, 10), cf.values()
    fabricated = cf.fabricated_matrix(p["strong"], p["weak"])
    of_ideal, of_made = (
        np.array(cf.amplitudes(cell, numbers, 0.0)) for cell in (cf.ideal_matrix(p["strong"]), fabricated)
    )
    odd = [0, 2, 4, 6, 8]
    np.testing.assert_allclose(of_ideal[odd], [0.50991, 0, -0.12870, 0, 0.07153], rtol=0, atol=5.01e-6)
    np.testing.assert_allclose(of_made[odd], [0.54351, -0.00467, -0.13718, 0.00202, 0.07624], rtol=0, atol=5.01e-6)
    assert not of_ideal[1::2].any() and not of_made[1::2].any()
    assert float(cf.amplitude(cf.waves(fabricated, cf.CROSS, p)[0], 0.0)) == pytest.approx(-0.00781, abs=5e-6)
    assert (1 + np.argsort(-np.abs(of_made))[:3]).tolist() == [1, 5, 9]
