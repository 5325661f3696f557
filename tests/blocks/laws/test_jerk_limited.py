"""Moves take the time of the seven-segment profile, keep their limits, and stop at a target that changes on the way."""

from dataclasses import replace

import numpy as np
import pytest

from synth.block import Block
from synth.blocks.laws import jerk_limited
from synth.execute import host
from synth.reference import jerk_limited as reference
from synth.signals import Signal
from synth.simulate import sampling as ensembles
from synth.timing import Discrete
from synth.verify import agree, sampling

LIMITS = reference.Limits(0.5, 10.0, 1000.0, 1e-3, 1.0)
SLOW = reference.Limits(2e-3, 0.05, 3.0, 2.5e-4, 1.0)  # a scanner
SHORT = reference.Limits(1.0, 20.0, 5000.0, 1e-3, 1.0)  # the acceleration is reached in four samples
TARGET, MEASURED = Signal("r", "m", -0.4, 0.4), Signal("z", "m", -0.5, 0.5)


def block(k: reference.Limits) -> Block:
    limits = {"velocity": k.V, "acceleration": k.A, "jerk": k.J}
    return jerk_limited.block("path", Discrete(k.T), TARGET, MEASURED, **limits)


def run(k: reference.Limits, target: np.ndarray, start: float = 0.0, scalar: type[np.floating] = np.float64) -> tuple:
    """Return position, velocity and acceleration (n,)."""
    ready = (np.arange(len(target)) > 0).astype(float)
    replay = host.compile_block(block(k), scalar).replay(
        {"r": target, "z": np.full(len(target), start), "ready": ready}
    )
    return tuple(replay.outputs[f"path_{name}"].astype(float) for name in ("position", "velocity", "acceleration"))


def fastest_time(h: float, k: reference.Limits) -> float:
    """Return the time of the profile of seven, six (no cruise), five (no held acceleration) or four segments."""
    t_j = min(k.A / k.J, np.sqrt(k.V / k.J))
    t_a = max(k.V / k.A - k.A / k.J, 0.0)
    if h >= k.V * (2 * t_j + t_a):
        return 4 * t_j + 2 * t_a + (h - k.V * (2 * t_j + t_a)) / k.V
    t_j = k.A / k.J
    if h >= 2 * k.A * t_j**2:
        return 4 * t_j + (np.sqrt(t_j**2 + 4 * h / k.A) - 3 * t_j)
    return 4 * (h / (2 * k.J)) ** (1 / 3)


def assert_limits(path: tuple, k: reference.Limits, rounding: float = 1e-9) -> None:
    _, v, a = path
    assert np.abs(v).max() <= k.V * (1 + rounding) and np.abs(a).max() <= k.A * (1 + rounding)
    assert np.abs(np.diff(a)).max() <= k.J * k.T * (1 + 1e3 * rounding)


@pytest.mark.parametrize("scalar", [np.float32, np.float64])
@pytest.mark.parametrize("k", [LIMITS, SLOW, SHORT], ids=["machine", "scanner", "short"])
@pytest.mark.parametrize("share", [1.0, 0.3, 0.1, 0.01, 1e-3, 1e-4])
def test_a_move_takes_the_time_of_the_seven_segment_profile(
    share: float, k: reference.Limits, scalar: type[np.floating]
) -> None:
    h = share * (0.4 if k is not SLOW else 2e-3)
    n = int(fastest_time(h, k) / k.T) + 50
    path = run(k, np.full(n, h), scalar=scalar)
    moving = np.flatnonzero((path[1] != 0) | (path[2] != 0))
    samples = len(moving) + 1
    assert moving[0] == 2 and len(moving) == moving[-1] - 1  # in one go, from the sample after the first target on
    assert -1.5 < samples - fastest_time(h, k) / k.T < 2.5
    assert path[0][-1] == pytest.approx(h, rel=2e-7) and path[0].max() <= h * (1 + 2e-7)
    assert_limits(path, k, 1e-9 if scalar is np.float64 else 1e-5)


@pytest.mark.parametrize("k", [LIMITS, SLOW], ids=["machine", "scanner"])
def test_each_sample_integrates_a_constant_jerk_exactly(k: reference.Limits) -> None:
    p, v, a = run(k, np.full(int(fastest_time(0.3, k) / k.T) + 50 if k is LIMITS else 5000, 0.3))
    j = np.diff(a) / k.T
    last = np.flatnonzero(a)[-1]
    np.testing.assert_allclose(np.diff(v)[:last], (a[:-1] * k.T + j * k.T**2 / 2)[:last], rtol=0, atol=1e-13)
    exact = v[:-1] * k.T + a[:-1] * k.T**2 / 2 + j * k.T**3 / 6
    np.testing.assert_allclose(np.diff(p)[:last], exact[:last], rtol=0, atol=1e-13)


@pytest.mark.parametrize("scalar", [np.float32, np.float64])
@pytest.mark.parametrize("seed", range(8))
def test_a_target_that_changes_on_the_way_is_reached_within_the_limits(seed: int, scalar: type[np.floating]) -> None:
    """Random limits and periods; targets that change in motion, and the last one is reached and kept."""
    rng = np.random.default_rng(seed)
    V, A, J, T = (10 ** rng.uniform(*ends) for ends in ((-1, 0), (0.3, 1.5), (3, 4), (-4, -3)))
    k = reference.Limits(V, A, J, T, 1.0)
    target = np.concatenate([np.full(rng.integers(3, 400), rng.uniform(-0.4, 0.4)) for _ in range(12)])
    target = np.r_[target, np.full(int(fastest_time(0.9, k) / T) + int(3 * V / A / T) + 200, target[-1])]
    path = run(k, target, 0.1, scalar)
    assert_limits(path, k, 1e-9 if scalar is np.float64 else 1e-5)
    assert path[0][-1] == pytest.approx(target[-1], abs=1e-7) and path[1][-1] == path[2][-1] == 0
    reached = np.flatnonzero((path[1] != 0) | (path[2] != 0))[-1]
    assert (np.abs(path[0][reached + 1 :] - target[-1]) < 1e-7).all()  # and kept
    assert np.abs(path[0]).max() <= 0.4 * (1 + 2e-7)


def moves(made: Block, k: reference.Limits, n: int, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Return by how much n moves from rest pass their target, in J T^3, and how many samples longer than the profile's.

    The first half has one target; the others get a farther one on the way.
    """
    scale = k.V * (k.V / k.A + k.A / k.J)
    h = np.minimum(np.where(rng.random(n) < 0.3, k.J * k.T**3, scale) * 10 ** rng.uniform(-1, 1, n), 0.3)
    samples = int(max(fastest_time(each, k) for each in h) / k.T) + 40
    target = np.tile(h, (3 * samples // 2, 1))
    changes = np.arange(3 * samples // 2)[:, None] > rng.uniform(1, samples / 2, n)
    target[:, n // 2 :] += (changes * rng.uniform(0, 0.3, n) * h)[:, n // 2 :]
    sign = rng.choice([-1.0, 1.0], n)
    target *= sign
    ready = np.tile((np.arange(3 * samples // 2) > 0).astype(float)[:, None], n)
    batches = ensembles.replay(host.compile_block(made, np.float64), {"r": target, "z": 0 * target, "ready": ready})
    states = [batch.states for batch in batches]
    left, rate = (np.array([each[name] for each in states]) for name in ("left", "rate"))
    took = (left[:, : n // 2] != 0).sum(axis=0) - [fastest_time(each, k) / k.T for each in h[: n // 2]]
    assert not left[-1].any() and not rate[-1].any()
    return -(sign * left).min(axis=0) / (k.J * k.T**3), took


@pytest.mark.slow
def test_no_move_of_ten_thousand_passes_its_target() -> None:
    """Random limits, of 1 to 100 samples of jerk; `left` is the distance to the target, below 0 beyond it."""
    rng = np.random.default_rng(6)
    for _ in range(20):
        samples, T = 10 ** rng.uniform(0, 2), 1e-3
        A = 10 ** rng.uniform(0, 1)
        k = reference.Limits(A * samples * T * 10 ** rng.uniform(0, 1), A, A / (samples * T), T, 1.0)
        passed, longer = moves(block(k), k, 500, rng)
        assert passed.max() <= 0 and longer.min() > -2.5 and longer.max() < 1.5, (k, passed.max(), longer)


def test_a_planner_that_counts_on_more_braking_than_there_is_passes_its_targets() -> None:
    made = block(SHORT)
    planted = [replace(c, value=1.05 * c.value) if c.name.endswith("samples") else c for c in made.constants]
    assert moves(replace(made, constants=tuple(planted)), SHORT, 500, np.random.default_rng(0))[0].max() > 0.1


def test_a_reversal_takes_no_longer_than_a_stop_and_a_new_move() -> None:
    k = LIMITS
    change = 150  # at full speed
    p, v, a = run(k, np.r_[np.full(change, 0.4), np.full(1500, -0.3)])
    assert v[change] == pytest.approx(k.V) and (np.diff(np.sign(v[change + 1 :])) != 0).sum() == 2
    stopped = change + np.argmax(v[change:] <= 0)
    halt = p[change] + k.V * (k.V / k.A + k.A / k.J) / 2
    reached = np.flatnonzero((v != 0) | (a != 0))[-1] + 1
    two_moves = (k.V / k.A + k.A / k.J + fastest_time(halt + 0.3, k)) / k.T
    assert p.max() <= halt + 1e-6 and stopped < change + (k.V / k.A + k.A / k.J) / k.T
    assert two_moves - 15 < reached - change < two_moves + 2  # braking merges with the way back


@pytest.mark.parametrize("start", [-0.45, 0.123456])
def test_it_starts_where_the_machine_stands(start: float) -> None:
    p, v, _ = run(LIMITS, np.full(2000, 0.2), start, np.float32)
    assert p[0] == np.float32(start) and abs(p[1] - start) < 1e-7 and v[1] == 0 and p[-1] == np.float32(0.2)
    steps = np.abs(np.diff(p))
    assert steps.max() <= LIMITS.V * LIMITS.T * 1.001


@pytest.mark.parametrize("k", [LIMITS, SLOW, SHORT], ids=["machine", "scanner", "short"])
def test_the_reference_agrees_and_a_planted_defect_is_noticed(k: reference.Limits) -> None:
    made = block(k)
    x, u = sampling.anywhere(made, np.random.default_rng(0), 2000)
    u["ready"] = np.round(u["ready"])
    x["left"] *= np.random.default_rng(1).choice([1, 1e-2, 1e-4], 2000)  # near the target, where it decides
    u["r"] = np.where(np.random.default_rng(2).random(2000) < 0.8, x["goal"], u["r"])
    casadi = agree.casadi(made)(x, u)

    def gap(of: reference.Limits) -> float:
        state = {f"path_{name}": value for name, value in x.items()}
        outputs, after = reference.step("path", of, u["r"], u["z"], u["ready"] > 0, state)
        inside = (outputs[0] > -0.5) & (outputs[0] < 0.5)
        position = np.abs(outputs[0] - casadi.outputs["path_position"])[inside].max()
        return max(
            position, *(float(np.abs(after[f"path_{n}"] - v).max() / np.abs(v).max()) for n, v in casadi.states.items())
        )

    assert gap(k) < 1e-12
    assert gap(replace(k, J=1.01 * k.J)) > 1e-6 and gap(replace(k, A=0.99 * k.A)) > 1e-6
