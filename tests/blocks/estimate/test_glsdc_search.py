"""Cold start and track: no wrong start, no choice among several solutions, holding through faults, loss until init."""

from functools import cache
from typing import Any

import casadi as ca
import numpy as np
import pytest

from synth.block import Block, Exprs, unranged
from synth.blocks.estimate import glsdc_estimator
from synth.blocks.estimate.glsdc_integrity import Integrity
from synth.blocks.estimate.glsdc_model import Unknown
from synth.blocks.estimate.glsdc_search import Search
from synth.blocks.estimate.glsdc_solution import Iteration
from synth.execute.host import Controller, compile_block
from synth.signals import Signal
from synth.statespace import Array
from synth.timing import Discrete

TIME, SIGMA, N = Discrete(1e-3), 0.01, 2000
STARTS, DWELL, PATIENCE = 12, 3, 5
CHANNELS = [Signal(f"y_{k}", "V", -2.0, 2.0) for k in range(5)]
PLACES = np.arange(5) * 0.37
X = Unknown(Signal("x", "m", -1.0, 1.0), 0.1, 0.3, periodic=True)
SIZE = Unknown(Signal("size", "1", 0.5, 1.5), 0.3, 0.3, start=1.0, prior=0.1, prior_value=1.0)
SEARCH = Search(STARTS, {"x": 0.05}, PATIENCE, DWELL)
INTEGRITY = Integrity({"x": 0.5}, 1e-4, 1e-3, exclude=True)


def waves(x: Any, size: Any, order: int, of: Any) -> list[Any]:
    """Return the channels: a wave of x with `order` periods in the range, at each place."""
    return [size * of.sin(np.pi * order * x + r) for r in PLACES]


def estimator(order: int, search: Search | None = SEARCH, integrity: Integrity | None = INTEGRITY) -> Block:
    def h(q: Exprs, k: Exprs) -> Exprs:
        return {s.name: v for s, v in zip(CHANNELS, waves(q["x"], q["size"], order, ca), strict=True)}

    bare = glsdc_estimator.estimator(
        "estimator",
        TIME,
        h,
        SIGMA**2 * np.eye(5),
        channels=CHANNELS,
        unknowns=[X, SIZE],
        iteration=Iteration(3, held_jacobian=True),
        integrity=integrity,
        search=search,
    )
    return glsdc_estimator.guarded(bare, "waves", CHANNELS, 5)


@cache
def compiled(order: int = 1) -> Controller:
    return compile_block(estimator(order) if order == 1 else unranged(estimator(order)))  # the proofs take long


def measured(x: Array, rng: np.random.Generator, order: int = 1) -> Array:
    return np.array(waves(x, 1.1, order, np)) + SIGMA * rng.standard_normal((5, *np.shape(x)))


def by_name(y: Array) -> dict[str, Array]:
    return {s.name: v for s, v in zip(CHANNELS, y, strict=True)}


def cold_start(order: int) -> tuple[Array, Array, Array]:
    """Return validity (samples, N), largest valid error, and the tracking flag at the end."""
    controller, rng = compiled(order), np.random.default_rng(0)
    x, states, valid, worst = rng.uniform(-1, 1, N), np.repeat(compiled(order).init()[None], N), [], 0.0
    for _ in range(2 * STARTS * DWELL):
        batch = controller.batch(states, by_name(measured(x, rng, order)))
        states, out = batch.states, batch.outputs
        valid.append(out["valid"] > 0)
        error = np.abs((out["x"] - x + 1) % 2 - 1)
        worst = max(worst, float(error[valid[-1]].max(initial=0)))
    return np.array(valid), np.array(worst), np.asarray(out["tracking"] > 0)


def test_every_start_ends_at_the_right_place() -> None:
    valid, worst, tracking = cold_start(1)
    assert worst < 0.05 and tracking.all() and valid[-1].mean() > 0.98
    assert not valid[:STARTS].any()  # a sweep is not left before its last start
    assert valid[STARTS * DWELL :].any(axis=0).mean() > 0.99


def test_of_two_places_with_the_same_readings_none_is_chosen() -> None:
    valid, _, tracking = cold_start(2)
    assert not valid.any() and not tracking.any()


def track(faults: Array) -> Any:
    """Return the outputs of a body that rests for the sweep and then moves, with faults (5, samples) from then on."""
    rng, rest = np.random.default_rng(2), 2 * STARTS * DWELL
    x = np.concatenate([np.full(rest, 0.4), 0.4 + 0.5 * np.sin(np.arange(faults.shape[1]) / 50)])
    y = measured(x, rng)
    y[:, rest:] += faults
    out = compiled().replay(by_name(y)).outputs
    return {name: v[rest:] for name, v in out.items()} | {"error": np.abs(out["x"] - x)[rest:]}


def test_a_large_fault_in_flight_is_excluded_at_once() -> None:
    faults = np.zeros((5, 100))
    faults[3, 20:] = 1.5
    out = track(faults)
    assert not out["excluded"][:21].any() and (out["excluded"][21:] == 4).all() and not out["lost"].any()
    assert not out["valid"][20] and out["valid"][21:].mean() > 0.9 and out["error"][out["valid"] > 0].max() < 0.05


def test_a_track_is_held_through_fewer_samples_than_its_patience() -> None:
    for samples, lost in ((PATIENCE - 1, 0), (PATIENCE, 1)):
        faults = np.zeros((5, 60))
        faults[:, 20 : 20 + samples] = np.array([1.5, -1.5, 1.2, 1.4, -1.3])[:, None]
        out = track(faults)
        assert not out["valid"][20 : 20 + samples].any()
        assert (out["lost"][-1] > 0) == lost and (out["valid"][30:].mean() > 0.9) == (not lost)
        assert out["valid"][30:].any() == (not lost)


def test_each_start_may_take_a_single_sample() -> None:
    """A sweep with the usual dwell finds the one solution."""
    rng, x = np.random.default_rng(5), np.full(N, 0.2)
    controller = compile_block(unranged(estimator(1, Search(4 * STARTS, {"x": 0.05}, PATIENCE))))
    states = np.repeat(controller.init()[None], N)
    for _ in range(8 * STARTS):
        batch = controller.batch(states, by_name(measured(x, rng)))
        states = batch.states
    assert (batch.outputs["valid"] > 0).mean() > 0.9 and np.abs(batch.outputs["x"] - x).max() < 0.1


def test_the_starts_fill_the_range_evenly() -> None:
    """No gap of Roberts' sequence in one dimension is wider than 2.7 spacings."""
    step = SEARCH.increments([X, SIZE])["x"]
    at = np.sort(np.arange(1, 101) * step % 2)
    assert np.diff(np.append(at, at[0] + 2)).max() < 2.7 * 2 / 100
    assert step == pytest.approx(2 * (np.sqrt(5) - 1) / 2, rel=1e-9)


def test_what_moves_within_a_sweep_is_not_followed() -> None:
    """Random channels that belong to no place never begin a track."""
    controller, rng = compiled(), np.random.default_rng(3)
    states = np.repeat(controller.init()[None], N)
    for _ in range(40):
        batch = controller.batch(states, by_name(rng.uniform(-1.5, 1.5, (5, N))))
        states = batch.states
        assert not batch.outputs["valid"].any()
