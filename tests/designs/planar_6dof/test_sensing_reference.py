"""Sensing and filters as Blocks and as C against NumPy's, sample by sample, also with sensors that fail."""

import numpy as np
import pytest

from designs.planar_6dof import reference_suspects
from designs.planar_6dof.sensing import maps as sensing_maps
from designs.planar_6dof.sensing import sections as sensing
from synth.statespace import Array
from tests.designs.planar_6dof.measured import (
    EXACT,
    HALL,
    PLANT,
    RESIDUALS,
    A,
    compile_estimation,
    estimation,
    estimation_inputs,
    forward_and_back,
    held_voltages,
    motion,
    noisy,
    reference_step,
    start,
)


def noisy_voltages(n: int, columns: int, seed: int) -> dict[str, Array]:
    """Noisy voltages (n, columns) along motions; half of the columns lose a sensor, some are random at times."""
    pose = motion(n, columns, seed)
    u = noisy({k: v.reshape(n, columns) for k, v in sensing_maps.voltages(PLANT, pose).items()}, seed)
    rng = np.random.default_rng(seed)
    for j in range(columns // 2):
        name, at = HALL[j % 6], n // 4
        u[name][at:, j] = 0.0 if j % 4 else u[name][at, j]
    odd = rng.random((n, columns)) < np.where(np.arange(columns) % 8 == 7, 0.25, 0.0)
    return {name: np.clip(np.where(odd, rng.uniform(-5, 5, odd.shape), v), -5, 5) for name, v in u.items()}


def disagreement(n: int, columns: int, predicted: bool = True) -> float:
    """Return the worst difference of Block and C from the reference, of 1 or of the signal's largest value."""
    u, block, controller = (
        noisy_voltages(n, columns, 7),
        estimation(predicted),
        compile_estimation(np.float64, predicted),
    )
    step, names, outputs = (
        block.function().map(columns),
        [s.name for s in block.states],
        [s.name for s in block.outputs],
    )
    refused = np.random.default_rng(8).random((n, columns)) < 0.02
    state = start(predicted, columns)
    x, records = (
        np.tile(block.initial[:, None], columns).astype(float),
        np.repeat(controller.init()[np.newaxis], columns),
    )
    gap, size = np.zeros(len(outputs) + len(names)), np.ones(len(outputs) + len(names))
    for i in range(n):
        v, flags = {name: column[i] for name, column in u.items()}, (np.full(columns, float(i > 0)), ~refused[i])
        out, state = reference_step(state, v, flags, predicted)
        batch = controller.batch(records, held_voltages(v) | {"ready": flags[0], "complete": flags[1].astype(float)})
        x, y = (m.full() for m in step(x, np.array([*v.values(), *flags])))
        records = batch.states
        expected = np.array([*(out[name] for name in outputs), *(state[name] for name in names)])
        by_c = np.array([*(batch.outputs[name] for name in outputs), *(records[name] for name in names)])
        apart = np.maximum(np.abs(np.vstack([y, x]) - expected), np.abs(by_c - expected))
        gap, size = np.maximum(gap, apart.max(axis=1)), np.maximum(size, np.abs(expected).max(axis=1))
    assert size[names.index("sensing_contradiction_left") + len(outputs)] >= sensing.MEMORY
    assert all(one.any() for one in reference_suspects.suspects(state, A).values())  # every branch was taken
    return float((gap / size).max())


@pytest.mark.parametrize("predicted", [True, False])
def test_block_and_c_agree_with_the_reference_over_1e5_samples(predicted: bool) -> None:
    assert disagreement(500, 200, predicted) < EXACT


@pytest.mark.parametrize("predicted", [True, False])
def test_a_sample_that_is_refused_moves_nothing(predicted: bool) -> None:
    """Whatever stands in the place of its voltages; the filters go on as they predict."""
    u = noisy(sensing_maps.voltages(PLANT, forward_and_back(0.02, 400)))
    refused = np.isin(np.arange(400), [100, 101, 250])
    runs = []
    for instead in (0.0, 4.9):
        inputs = {name: np.where(refused, instead, v) for name, v in u.items()}
        runs.append(
            compile_estimation(np.float64, predicted).replay(estimation_inputs(inputs) | {"complete": ~refused}).outputs
        )
    moved = [name for name in runs[0] if name not in RESIDUALS]
    assert all((runs[0][name] == runs[1][name]).all() for name in moved) and "x_raw" in moved
    for axis in "xy":
        within = np.asarray(runs[0][f"within_{axis}"])
        assert (within[refused] == within[np.flatnonzero(refused) - [1, 2, 1]]).all()
        assert np.abs(runs[0][f"{axis}_raw"] - forward_and_back(0.02, 400)[axis]).max() < (5e-4 if predicted else 1e-3)
    assert not np.asarray(runs[0]["suspected"]).any()
