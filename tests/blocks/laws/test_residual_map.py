"""Residual map: exact for bilinear residuals, smooth where there are no samples, the same in the C as in NumPy."""

import numpy as np

from synth.block import Exprs, Step, build, table, unranged
from synth.blocks.laws import lookup_table
from synth.blocks.laws.lookup_table import Grid
from synth.emit import write
from synth.execute import host
from synth.signals import Signal
from synth.timing import Discrete

GRID = Grid((-2.0, -1.0), 0.5, (9, 5))
RNG = np.random.default_rng(0)
PLACES = RNG.uniform(-1, 1, (3000, 2)) * [2.0, 1.0]


def bilinear(at: np.ndarray) -> np.ndarray:
    x, y = at.T
    return np.column_stack([1 + 2 * x - y + 0.5 * x * y, x])


def test_a_bilinear_residual_is_fitted_exactly() -> None:
    of = lookup_table.fit(PLACES, bilinear(PLACES), GRID, smoothing=1e-9)
    np.testing.assert_allclose(of.at(PLACES), bilinear(PLACES), atol=1e-6)


def test_beyond_the_grid_its_edge_holds() -> None:
    of = lookup_table.fit(PLACES, bilinear(PLACES), GRID)
    np.testing.assert_allclose(of.at([[5.0, 0.2]]), of.at([[2.0, 0.2]]))


def test_points_without_samples_continue_their_neighbours() -> None:
    near = PLACES[PLACES[:, 0] < 1.0]
    of = lookup_table.fit(near, bilinear(near), GRID)
    np.testing.assert_allclose(of.at([[1.9, 0.3]])[0, 1], 1.9, atol=0.02)


def test_smoothing_averages_noise() -> None:
    noisy = bilinear(PLACES) + 0.1 * RNG.standard_normal((3000, 2))
    errors = [np.std(lookup_table.fit(PLACES, noisy, GRID, s).at(PLACES) - bilinear(PLACES)) for s in (1e-9, 1e3)]
    assert errors[1] < 0.7 * errors[0] < 0.03


def test_values_are_rounded_to_the_unit() -> None:
    values = lookup_table.fit(PLACES, bilinear(PLACES), GRID, unit=0.25).values
    np.testing.assert_array_equal(values, 0.25 * np.rint(values / 0.25))


def test_the_c_looks_up_the_same_values() -> None:
    of = lookup_table.fit(PLACES, np.sin(3 * bilinear(PLACES)), GRID)
    tables = {n: table(n, of.values[..., i].ravel()) for i, n in enumerate(("a", "b"))}

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        return Step(lookup_table.bilinear(tables, of.grid, u["x"], u["y"]))

    inputs, outputs = ([Signal(n, "1", -10, 10) for n in names] for names in ("xy", "ab"))
    block = build("map", Discrete(1e-3), law, inputs=inputs, outputs=outputs)
    made = write.emit(unranged(block), np.float64)
    out = host.load(made.files, made.manifest).replay(dict(zip("xy", PLACES.T, strict=True))).outputs
    np.testing.assert_allclose(np.column_stack([out["a"], out["b"]]), of.at(PLACES), atol=1e-12)


ALONG = np.linspace(-0.9, 0.9, 41)


def test_a_cross_and_one_place_beside_it_are_enough() -> None:
    cross = np.vstack([np.column_stack([ALONG, 0 * ALONG]), np.column_stack([0 * ALONG, ALONG]), [[0.5, 0.5]]])
    of = lookup_table.fit(cross, bilinear(cross), GRID, smoothing=1e-9)
    np.testing.assert_allclose(of.at(PLACES), bilinear(PLACES), atol=1e-3)
