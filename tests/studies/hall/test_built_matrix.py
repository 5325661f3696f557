"""The true field against magpylib's displaced and tilted blocks, and the stage above it."""

from dataclasses import replace
from math import pi, radians

import magpylib
import numpy as np
import pytest

from models import finite_matrix, planar_stage
from models.finite_matrix import HEIGHT, SIDE
from models.hall_chain import Chain
from studies.hall import built_matrix
from studies.hall.built_matrix import AsBuilt, Tolerances
from studies.hall.loop import closed_loop
from synth.errors import ModelError
from synth.signals import signal_names

pytestmark = pytest.mark.whole

LATTICE = 1.2e-4  # T: what the other matrices of the lattice add, 9e-5 T at the corners of the reach
DRAWN = 2e-5  # T: of what errors of blocks add: 1.2e-5 T by the lattice, 1e-6 T by terms of the third order
EXACT = Tolerances(0.0, 0.0, 0.0)
AT = np.random.default_rng(1).uniform(-built_matrix.MAX_REACH, built_matrix.MAX_REACH, (2, 60))


def oracle(as_built: AsBuilt, z: float = 3e-3) -> np.ndarray:
    """Return B_X and B_Y (2, N) in T at AT by magpylib."""
    blocks, off = as_built.blocks, as_built.displacements
    cuboids = [
        magpylib.magnet.Cuboid(
            dimension=(SIDE, SIDE, HEIGHT),
            polarization=blocks.remanence[i, j],
            position=np.array([X, Y, -HEIGHT / 2]) + off[i, j],
        )
        for i, X in enumerate(blocks.places)
        for j, Y in enumerate(blocks.places)
        if blocks.remanence[i, j].any()
    ]
    return magpylib.Collection(*cuboids).getB(np.column_stack([*AT, np.full(AT.shape[1], z)])).T[:2]


def ours(spread: Tolerances) -> np.ndarray:
    return built_matrix.field(spread).at.map(AT.shape[1])(AT[:1], AT[1:]).full()


def test_the_field_is_that_of_the_blocks_as_they_were_made() -> None:
    as_built, meant = built_matrix.draw_blocks(), built_matrix.draw_blocks(EXACT)
    theirs, exact = oracle(as_built), oracle(meant)
    flux = ours(built_matrix.DEFAULT_TOLERANCES)[:2]
    assert np.abs(flux - theirs).max() < LATTICE
    assert np.abs((flux - ours(EXACT)[:2]) - (theirs - exact)).max() < DRAWN
    # What a defect would be: places counted the other way.
    planted = oracle(replace(as_built, displacements=-as_built.displacements))
    assert np.abs((flux - ours(EXACT)[:2]) - (planted - exact)).max() > 50 * DRAWN


def test_the_slope_is_that_along_z() -> None:
    slope = (oracle(built_matrix.draw_blocks(), 3.01e-3) - oracle(built_matrix.draw_blocks(), 2.99e-3)) / 2e-5
    np.testing.assert_allclose(
        ours(built_matrix.DEFAULT_TOLERANCES)[2:], slope, rtol=0, atol=2e-3 * np.abs(slope).max()
    )


def test_the_tables_add_little() -> None:
    fine = built_matrix.series(built_matrix.draw_blocks(), built_matrix.HARMONICS * 3 // 2)
    points, true = fine.grid(built_matrix.MAX_REACH), built_matrix.tabulate(fine)
    X, Y = np.meshgrid(points, points, indexing="ij")
    at = built_matrix.field().at.map(X.size)(X.ravel()[None], Y.ravel()[None]).full()
    error = np.abs(at.reshape(true.shape) - true).max(axis=(1, 2))[:2]
    assert error.min() > 0 and error.max() * Chain().gain < 0.03e-3  # V, a thirtieth of the noise


def test_blocks_are_spread_as_far_as_they_should_be_and_no_further() -> None:
    as_built, meant = built_matrix.draw_blocks(), finite_matrix.fabricated_blocks()
    sizes = [np.linalg.norm(m, axis=2) for m in (as_built.blocks.remanence, meant.remanence)]
    there = sizes[1] > 0
    ratio = sizes[0][there] / sizes[1][there]
    cosine = (as_built.blocks.remanence * meant.remanence).sum(axis=2)[there] / (sizes[0] * sizes[1])[there]
    tilt = np.arccos(np.clip(cosine, -1, 1))
    for errors, bound in ((np.abs(ratio - 1), 0.02), (tilt, radians(1)), (np.abs(as_built.displacements), 1e-4)):
        assert 0.95 * bound < errors.max() <= bound * (1 + 1e-9)
    assert not as_built.blocks.remanence[~there].any()
    assert np.array_equal(built_matrix.draw_blocks().displacements, as_built.displacements)
    assert not np.array_equal(built_matrix.draw_blocks(Tolerances(seed=1)).displacements, as_built.displacements)


def test_the_stage_reads_the_field_at_its_sensors_behind_a_filter() -> None:
    chain, turn = Chain(), 0.3
    plant = built_matrix.plant(closed_loop.PLACES, built_matrix.field(), chain)
    pose = {"x": 4e-3, "y": -7e-3, "phi": turn, "z": 1e-4}
    x = np.array([pose.get(name, 0.0) for name in signal_names(plant.states)])
    u, p = np.zeros(len(plant.inputs)), plant.values
    rate = dict(zip(signal_names(plant.states), plant.f(x, u, p).full().ravel(), strict=True))
    c, s = np.cos(turn), np.sin(turn)
    for letter, (a, b) in zip("abc", closed_loop.PLACES, strict=True):
        bx, by, dx, dy = built_matrix.field().at(4e-3 + c * a - s * b, -7e-3 + s * a + c * b).full().ravel()
        bx, by = bx + 1e-4 * dx, by + 1e-4 * dy
        for axis, B in (("x", c * bx + s * by), ("y", c * by - s * bx)):
            volts = chain.gain * B  # the filter holds 0
            assert rate[f"filtered_V_{letter}{axis}"] == pytest.approx(2 * pi * chain.corner * volts, rel=1e-9)
    held = np.where([n.startswith("filtered_") for n in signal_names(plant.states)], 1.5, x)
    read = dict(zip(signal_names(plant.outputs), plant.h(held, u, p).full().ravel(), strict=True))
    assert [read[name] for name in planar_stage.HALL] == [1.5] * 6


def test_what_makes_no_sense_is_refused() -> None:
    with pytest.raises(ModelError, match="the tolerance of tilt is -1"):
        Tolerances(tilt=-1.0)
    with pytest.raises(ModelError, match="the number of places is 2"):
        built_matrix.plant(closed_loop.PLACES[:2], built_matrix.field(), Chain())
