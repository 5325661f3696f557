"""Groups of channels that fail together: levels against pseudoinverses, achieved risk, exclusion, refusals."""

from functools import cache
from typing import Any

import numpy as np
import pytest

from benchmarks import beacons
from synth.blocks.estimate import glsdc_integrity
from synth.blocks.estimate.glsdc_integrity import Integrity
from synth.execute.host import Controller, compile_block
from synth.statespace import Array

OF = beacons.ranges(6)
GROUPS = (("range_a", "range_d"), ("range_b", "range_e"), ("range_c", "range_f"))
INDICES = ((0, 3), (1, 4), (2, 5))
LIMITS = {"x": 5.0, "y": 5.0}
FALSE_ALARM, RISK, SAMPLES = 1e-3, 1e-2, 10_000


@cache
def compiled(exclude: bool, groups: tuple[tuple[str, ...], ...] = GROUPS) -> Controller:
    return compile_block(beacons.block(OF, Integrity(LIMITS, FALSE_ALARM, RISK, exclude, groups)))


def run(controller: Controller, size: float, samples: int = 3) -> tuple[Any, Array, Array]:
    """Return outputs, errors (N, 2) and faulty groups (N,): faults of a size in a random direction of a group."""
    rng = np.random.default_rng(4)
    q = beacons.draw(OF, SAMPLES, rng)
    group, turn = rng.integers(len(INDICES), size=SAMPLES), rng.uniform(0, 2 * np.pi, SAMPLES)
    states = np.repeat(controller.init()[None], SAMPLES)
    for name, value in zip("xy", q.T, strict=True):
        states[f"estimator_{name}"] = value
    for _ in range(samples):
        y = beacons.values(OF, q) + OF.sigma * rng.standard_normal((SAMPLES, 6))
        for k, wave in enumerate((np.cos(turn), np.sin(turn))):
            y[np.arange(SAMPLES), np.array(INDICES)[group, k]] += size * OF.sigma * wave
        batch = controller.batch(states, {s.name: y[:, i] for i, s in enumerate(OF.channels)})
        states = batch.states
    return batch.outputs, np.abs(np.column_stack([batch.outputs[n] for n in "xy"]) - q), group + 1


def misleading(controller: Controller, size: float) -> float:
    """Return the share of samples that are valid with an error above the level of an unknown, of the worse one."""
    out, errors, _ = run(controller, size)
    levels = np.column_stack([out[f"protection_{n}"] for n in "xy"])
    return float(((errors > levels) & (out["valid"] > 0)[:, None]).mean(axis=0).max())


def reference_levels(at: Array, groups: tuple[tuple[int, ...], ...]) -> Array:
    """Return the levels (N, 2) of the test, from blocks of pseudoinverses."""
    H = beacons.jacobian(OF, at)
    K = np.linalg.pinv(H)
    S = np.eye(6) - H @ K
    limits = glsdc_integrity.thresholds(4, FALSE_ALARM, RISK, 2)
    worst = np.zeros((len(at), 2))
    for group in groups:
        k, s = K[:, :, group], S[:, group][:, :, group]
        moved = np.einsum("nia,nab,nib->ni", k, np.linalg.inv(s), k)
        worst = np.maximum(worst, moved)
    return np.asarray(
        OF.sigma * (np.sqrt(limits.noncentrality * worst) + limits.deviations * np.linalg.norm(K, axis=2))
    )


def test_the_levels_are_those_of_pseudoinverses() -> None:
    out, _, _ = run(compiled(False), 0.0, samples=1)
    levels = np.column_stack([out[f"protection_{n}"] for n in "xy"])
    at = np.column_stack([out[n] for n in "xy"])
    np.testing.assert_allclose(levels, reference_levels(at, INDICES), rtol=2e-3)
    single = reference_levels(at, tuple((i,) for i in range(6)))
    assert (levels > 1.02 * single).mean() > 0.9


@pytest.mark.parametrize("exclude", [False, True], ids=["test", "exclusion"])
def test_the_achieved_risk_is_at_most_the_allocated_one(exclude: bool) -> None:
    for size in (0.0, 5.0, 8.0, 12.0, 40.0):
        assert misleading(compiled(exclude), size) <= RISK


def test_levels_of_single_channels_mislead_when_a_group_fails() -> None:
    assert max(misleading(compiled(True, ()), size) for size in (8.0, 12.0, 40.0)) > 2 * RISK


def test_the_faulty_group_is_excluded_and_the_rest_is_right() -> None:
    out, errors, group = run(compiled(True), 60.0)
    assert (out["excluded"] == group).mean() > 0.99 and out["valid"].mean() > 0.9
    assert np.quantile(errors[out["valid"] > 0], 0.999) < 10 * OF.sigma


def test_channels_that_are_not_listed_are_groups_after_the_others() -> None:
    names = [s.name for s in OF.channels]
    assert Integrity(LIMITS, groups=[["range_c", "range_b"]]).index_groups(names) == ((2, 1), (0,), (3,), (4,), (5,))
    assert Integrity(LIMITS).index_groups(names) == tuple((i,) for i in range(6))
