"""The estimator as a Block and as C against NumPy's, from any state and over motions; its C in single precision."""

import numpy as np
import pytest

from designs.hall_position import reference, reference_glsdc, reference_rounding
from designs.hall_position.glsdc import channels
from designs.hall_position.reference_glsdc import Setup
from models.hall_two_waves import PlanarArray as Array
from synth.execute import host
from synth.statespace import Array as Numbers
from tests import tolerances
from tests.designs.hall_position.tracked import (
    ARRAYS,
    THREE,
    TWO,
    USUAL,
    Columns,
    L,
    Pose,
    W,
    before_start,
    block,
    by_input,
    compile_c,
    known_state,
    motion,
    noisy,
    setup,
    state_records,
)

EXACT = tolerances.of("double")
EPS = 2.0**-52
ILL_CONDITIONED = 1e3  # magnification above which the allowed error is proportional to it
SHARE = 8  # times that and the precision; 1.3 is seen


def random_samples(array: Array, n: int, seed: int) -> tuple[dict[str, Numbers], Numbers, Numbers]:
    """Return states anywhere (N,), voltages (N, sensors, 2) and which of these are refused.

    A third of the voltages belong to a pose near the predicted one, a third to one further away; the others
    are random.
    """
    rng, of, k = np.random.default_rng(seed), setup(array), len(array.positions)
    state = {name: rng.uniform(-np.pi, np.pi, n) for name in (*reference.POSE, "yaw_last_good", "start_x", "start_y")}
    state["yaw"] *= rng.choice([0.06, 1.0], n)  # half of them where an estimate may be valid
    # Every other yaw is near the last good one, where the ambiguity may be resolved.
    about = state["yaw"] + rng.uniform(-0.12, 0.12, n)
    state["yaw_last_good"] = np.where(
        rng.random(n) < 0.5, (about + np.pi) % (2 * np.pi) - np.pi, state["yaw_last_good"]
    )
    problem = reference.problem(of)
    bounds = problem.bounds * problem.units
    state |= {name: rng.uniform(-b, b, n) for name, b in zip(reference.MOTION, bounds, strict=True)}
    state |= {f"pitch_{a}": rng.integers(-8, 9, n).astype(float) for a in "xy"}
    state |= {
        "residual_faults": rng.integers(0, 5, n),
        "searching": rng.integers(0, 2, n),
        "lock_lost": rng.integers(0, 2, n),
    }
    state["ambiguity_resolved"] = rng.integers(0, 2, n) * (1 - state["searching"])
    state["acquired"] = np.maximum(state["ambiguity_resolved"], rng.integers(0, 2, n))
    start = reference.predict(of, state)
    size = rng.choice([1e-3, 0.05, 0.3], n)[:, np.newaxis] * rng.standard_normal((n, 3)) / [W, W, 6]
    x, y, yaw = (start + size).T
    (cx, cy), c, s = array.centre, np.cos(yaw), np.sin(yaw)
    V = noisy(array, Pose(x - c * cx + s * cy, y - s * cx - c * cy, yaw), seed)
    V = np.where((rng.random(n) < 0.33)[:, np.newaxis, np.newaxis], rng.uniform(-5, 5, V.shape), V)
    # In a tenth of the samples one sensor has random voltages.
    some, one = rng.random(n) < 0.1, rng.integers(0, k, n)
    V[some, one[some]] = rng.uniform(-5, 5, (some.sum(), 2))
    return state, np.clip(V, -4.9, 4.9), rng.random(V.shape) < 0.01


def held_voltages(V: Numbers, refused: Numbers) -> Numbers:
    """Return the guard's held voltages: 0 before the first accepted sample."""
    return np.where(refused, 0.0, V)


def difference(outputs: Columns, after: host.Records, out: Columns, next: Columns) -> Numbers:
    """Return by how much outputs and states differ, (N,): m, rad, a tenth of the voltages' range, and flags by 1."""
    gap = [np.abs(outputs[name] - v) / (channels.SPAN if name == "residual" else 1) for name, v in out.items()]
    for name, v in next.items():
        d = np.abs(after[f"estimator_{name}"] - v)
        if name.startswith(("phase", "yaw", "start")):
            d = np.minimum(d, 2 * np.pi - d)
        gap.append(d / W if name.startswith(("phase", "start", "motion_x", "motion_y")) else d)
    return np.max(gap, axis=0)


def disagreement(array: Array, n: int, of: Setup) -> Numbers:
    """Return by how much the C differs from the reference in n steps, over what is allowed, (N,)."""
    state, V, refused = random_samples(array, n, 3)
    out, next = reference.step(of, state, held_voltages(V, refused), refused)
    batch = compile_c(array).batch(state_records(array, state), by_input(array, np.where(refused, np.nan, V)))
    severe = reference_rounding.magnification(of, state, held_voltages(V, refused), refused)
    allowed = np.where(severe > ILL_CONDITIONED, SHARE * EPS * severe, EXACT)
    assert (severe > ILL_CONDITIONED).mean() < 0.02 and next["lock_lost"].mean() > 0.5
    return difference(batch.outputs, batch.states, out, next) / allowed


@pytest.mark.parametrize("array", ARRAYS.values(), ids=ARRAYS)
def test_c_agrees_with_the_reference_from_any_state(array: Array) -> None:
    assert disagreement(array, 20_000, setup(array)).max() <= 1


@pytest.mark.parametrize("array", ARRAYS.values(), ids=ARRAYS)
def test_the_block_agrees_with_the_reference(array: Array) -> None:
    state, V, _ = random_samples(array, 300, 4)
    of, clear = block(array), np.zeros(V.shape, bool)
    x = np.tile(of.initial[:, np.newaxis], 300)
    for i, s in enumerate(of.states):
        name = s.name.removeprefix("estimator_")
        x[i] = state.get(name, x[i])
    y = of.function().map(300)(x, np.array([*by_input(array, V).values()]))[1].full()
    out, _ = reference.step(setup(array), state, V, clear)
    allowed = np.maximum(EXACT, SHARE * EPS * reference_rounding.magnification(setup(array), state, V, clear))
    for signal, values in zip(of.outputs, y, strict=True):
        size = channels.SPAN if signal.name == "residual" else 1
        assert (np.abs(values - out[signal.name]) <= size * allowed).all(), signal.name


def over_motions(array: Array, pose: Pose, of: Setup) -> float:
    """Return the worst difference between free-running C and reference."""
    V, state = noisy(array, pose), known_state(array, before_start(pose))
    after, gap, clear = state_records(array, state), 0.0, np.zeros(V.shape[1:], bool)
    for now in V:
        out, state = reference.step(of, state, now, clear)
        batch = compile_c(array).batch(after, by_input(array, now))
        after = batch.states
        gap = max(gap, float(difference(batch.outputs, after, out, state).max()))
    return gap


def test_c_agrees_with_the_reference_over_1e5_samples_of_many_pitches_and_turns() -> None:
    pose = motion(400, 250, 5, travel=0.3, yaw=0.5, turn=13.0)
    assert np.ptp(pose.X, axis=0).max() > 3 * L and np.ptp(pose.yaw, axis=0).max() > 2 * np.pi
    assert over_motions(THREE, pose, setup(THREE)) < EXACT


@pytest.mark.parametrize(
    "change",
    [
        {"beta": -TWO.beta},
        {"iterations": 4},
        *(
            {name: 1.05 * getattr(USUAL, name)}
            for name in ("damping", "yaw_damping_ratio", "max_phase_step", "velocity_gain")
        ),
        {"residual_limit": 0.15},
        {"max_prior_weight": 0.2},
        {"innovation_gate_sigma": 2.5},
        {"convergence_sigma": 0.05},
        {"pitches": 7},
        {"ambiguity_threshold": 0.005},
        {"yaw_window": 0.1},
        {"yaw_limit": 0.03},
    ],
    ids=lambda change: next(iter(change)),
)
def test_another_setup_is_seen(change: dict[str, float]) -> None:
    assert disagreement(TWO, 2000, Setup(setup(TWO).numbers | change)).max() > 1e3


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("SLACK", 1e6),
        ("ROUNDING", 0.1),
        ("PATIENCE", 4),
        ("PLASTIC", 1.32),
    ],
)
def test_another_reference_is_seen(name: str, value: float, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(reference if hasattr(reference, name) else reference_glsdc, name, value)
    assert disagreement(THREE, 2000, setup(THREE)).max() > 1e3


def test_single_precision_is_within_a_micrometre() -> None:
    """Of double precision, both free-running: ten times less where the position is valid."""
    pose = motion(400, 50, 6, travel=0.2, yaw=0.04)
    after = {
        scalar: state_records(TWO, known_state(TWO, before_start(pose)), scalar=scalar)
        for scalar in (np.float32, np.float64)
    }
    differences, valid = [], []
    for now in noisy(TWO, pose):
        outputs = {}
        for scalar, state in after.items():
            batch = compile_c(TWO, scalar=scalar).batch(state, by_input(TWO, now))
            after[scalar], outputs[scalar] = batch.states, batch.outputs
        single, double = outputs[np.float32], outputs[np.float64]
        differences.append(np.hypot(single["X"] - double["X"], single["Y"] - double["Y"]))
        valid.append((single["valid"] > 0) & (double["valid"] > 0))
    assert np.mean(valid) > 0.6 and np.array(differences)[np.array(valid)].max() < 1e-7
    assert np.array(differences).max() < 1e-6
