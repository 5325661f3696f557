"""The estimator of six degrees of freedom: C against the NumPy reference, convergence, deviations, flags."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import optimize

from designs.hall_position import reference_glsdc
from designs.hall_position.glsdc import channels, six_estimator
from designs.hall_position.reference_glsdc import Setup
from models import hall_two_waves
from models.hall_two_waves import SpatialArray as Array
from synth.errors import ModelError
from synth.execute import host
from synth.statespace import Array as Numbers
from tests import tolerances
from tests.designs.hall_position import reference_six
from tests.designs.hall_position.posed import (
    ANY,
    FIVE,
    FOUR,
    TIME,
    USUAL,
    Columns,
    L,
    block,
    by_input,
    compile_c,
    errors,
    known_state,
    motion,
    noisy,
    places,
    replay,
    setup,
    state_records,
    volts,
)

EXACT = tolerances.of("double")
ARRAYS = {"four": FOUR, "five": FIVE}
UP = np.array([0, 0, 3e-3, 0, 0, 0])  # of a body at the height
SIZES = np.array([1, 1, 1, *3 * [25.4e-3]])  # m, of a unit of each coordinate


def random_samples(array: Array, n: int, seed: int) -> tuple[dict[str, Numbers], Numbers, Numbers]:
    """Return states anywhere (N,), voltages (N, sensors, 2) and which of these are refused.

    Two thirds of the voltages are those of a pose near to where the sample begins or further away; others are random.
    """
    rng, of = np.random.default_rng(seed), setup(array)
    angles = ("phase_x", "phase_y", "yaw", "yaw_last_good", "start_x", "start_y")
    state = {name: rng.uniform(-np.pi, np.pi, n) for name in angles}
    problem = reference_six.problem(of)
    ranges = dict(zip(reference_six.POSE[2:5], reference_six.ranges(of) * problem.units[2:5], strict=True))
    bounds = dict(zip(reference_six.POSE, problem.bounds * problem.units, strict=True))
    state |= {name: rng.uniform(-r, r, n) for name, r in ranges.items()}
    state |= {f"motion_{p}": rng.uniform(-b, b, n) * rng.choice([0.02, 0.2, 1.0], n) for p, b in bounds.items()}
    state |= {f"count_{a}": rng.integers(-8, 9, n).astype(float) for a in "xy"}
    state |= {
        "residual_faults": rng.integers(0, 5, n),
        "searching": rng.integers(0, 2, n),
        "lock_lost": rng.integers(0, 2, n),
    }
    size = rng.choice([1e-3, 0.02, 0.3], n)[:, np.newaxis] * rng.standard_normal((n, 6)) / [124, 124, 500, 20, 20, 6]
    V = noisy(array, reference_six.predict(of, state) + UP + size, seed)
    V = np.where((rng.random(n) < 0.33)[:, np.newaxis, np.newaxis], rng.uniform(-5, 5, V.shape), V)
    return state, np.clip(V, -4.9, 4.9), rng.random(V.shape) < 0.01


def difference(outputs: Columns, after: host.Records, out: Columns, next: Columns) -> Numbers:
    """Return by how much outputs and states differ, (N,): m, rad, of the voltages' range, and flags by 1."""
    gap = [np.abs(outputs[name] - v) / (channels.SPAN if name == "residual" else 1) for name, v in out.items()]
    for name, v in next.items():
        d = np.abs(after[f"estimator_{name}"] - v)
        gap.append(np.minimum(d, 2 * np.pi - d) if name.startswith(("phase", "yaw", "start")) else d)
    return np.max(gap, axis=0)


def disagreement(array: Array, n: int, of: Setup) -> float:
    state, V, refused = random_samples(array, n, 3)
    out, next = reference_six.step(of, state, np.where(refused, 0.0, V), refused)
    batch = compile_c(array).batch(state_records(array, state), by_input(array, np.where(refused, np.nan, V)))
    return float(difference(batch.outputs, batch.states, out, next).max())


# Against the reference.


@pytest.mark.parametrize("array", ARRAYS.values(), ids=ARRAYS)
def test_c_agrees_with_the_reference_from_any_state(array: Array) -> None:
    state, V, refused = random_samples(array, 6000, 3)
    out, _ = reference_six.step(setup(array), state, np.where(refused, 0.0, V), refused)
    assert 0.3 < out["converged"].mean() < 0.7 and 0.1 < out["valid"].mean() < 0.5
    assert disagreement(array, 6000, setup(array)) < EXACT


def by_block(array: Array, state: Columns, V: Numbers) -> dict[str, Numbers]:
    """Return the outputs (N,) of the Block as CasADi computes it."""
    of, n = block(array), len(V)
    x = np.tile(of.initial[:, np.newaxis], n)
    for i, s in enumerate(of.states):
        x[i] = state.get(s.name.removeprefix("estimator_"), x[i])
    y = of.function().map(n)(x, np.array([*by_input(array, V).values()]))[1].full()
    return {signal.name: values for signal, values in zip(of.outputs, y, strict=True)}


def test_the_block_agrees_with_the_reference() -> None:
    state, V, _ = random_samples(FOUR, 100, 4)
    out, _ = reference_six.step(setup(FOUR), state, V, np.zeros(V.shape, bool))
    for name, values in by_block(FOUR, state, V).items():
        np.testing.assert_allclose(values, out[name], rtol=0, atol=6 * EXACT, err_msg=name)


def test_c_agrees_with_the_reference_over_motions_of_many_pitches_and_turns() -> None:
    pose = motion(250, 80, 5, travel=0.3, turn=13.0)
    assert np.ptp(pose[..., 0], axis=0).max() > 3 * L and np.ptp(pose[..., 5], axis=0).max() > np.pi
    state, gap, clear = known_state(FOUR, pose[0]), 0.0, np.zeros((80, 4, 2), bool)
    after = state_records(FOUR, state)
    for now in noisy(FOUR, pose):
        out, state = reference_six.step(setup(FOUR), state, now, clear)
        batch = compile_c(FOUR).batch(after, by_input(FOUR, now))
        after = batch.states
        gap = max(gap, float(difference(batch.outputs, after, out, state).max()))
    assert gap < EXACT


@pytest.mark.parametrize(
    "change",
    [
        {"beta": -FOUR.beta},
        {"height": 3.01e-3},
        {"corrections": 3},
        *(
            {name: 1.05 * getattr(USUAL, name)}
            for name in ("damping", "max_phase_step", "velocity_gain", "tilt", "gap")
        ),
        {"residual_limit": 0.03},
        {"max_prior_weight": 0.3},
        {"innovation_gate_sigma": 0.5},
        {"convergence_sigma": 0.05},
        {"pitches": 7},
    ],
    ids=lambda change: next(iter(change)),
)
def test_another_setup_is_seen(change: dict[str, float]) -> None:
    assert disagreement(FOUR, 2000, Setup(setup(FOUR).numbers | change)) > 1e6 * EXACT


@pytest.mark.parametrize(
    ("name", "value"), [("SLACK", 1e6), ("PATIENCE", 4), ("PART", 0.24), ("PLASTIC", 1.32), ("WAVES", (1, 3))]
)
def test_another_reference_is_seen(name: str, value: object, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(reference_six if hasattr(reference_six, name) else reference_glsdc, name, value)
    assert disagreement(FOUR, 2000, setup(FOUR)) > 1e6 * EXACT


# Convergence and deviations.


def test_it_finds_the_least_squares_solution() -> None:
    """Of SciPy, by differences of voltages alone: a twentieth of a deviation is left, by damping and corrections."""
    pose = places(12, 1)
    V = noisy(FOUR, pose)
    near = pose + np.random.default_rng(2).standard_normal(pose.shape) * np.array([30e-6] * 3 + [1e-3] * 3)
    outputs = compile_c(FOUR).batch(state_records(FOUR, known_state(FOUR, near)), by_input(FOUR, V)).outputs
    assert outputs["valid"].all()
    for k, at in enumerate(pose):

        def left(d: Numbers, k: int = k, at: Numbers = at) -> Numbers:
            return (volts(FOUR, at + 1e-5 * d / SIZES) - V[k]).ravel() / FOUR.deviation

        best = 1e-5 * optimize.least_squares(left, np.zeros(6), xtol=1e-10).x
        off = np.array([outputs[name][k] for name in six_estimator.OUTPUTS]) - at - best / SIZES
        deviations = np.array([outputs[f"deviation_{name}"][k] for name in six_estimator.OUTPUTS])
        assert (np.abs(off) < 0.05 * deviations).all()


@pytest.mark.parametrize("array", ARRAYS.values(), ids=ARRAYS)
def test_errors_match_the_stated_deviations(array: Array) -> None:
    pose = np.repeat(places(60, 3)[np.newaxis], 60, axis=0)
    outputs = replay(array, pose[0], noisy(array, pose))
    off, sure = errors(outputs, pose), outputs["valid"] > 0
    assert sure.mean() > 0.99
    for i, name in enumerate(six_estimator.OUTPUTS):
        ratio = np.sqrt(np.mean((off[..., i] / outputs[f"deviation_{name}"])[sure] ** 2))
        assert 0.9 < ratio < 1.1, name
    louder = errors(replay(array, pose[0], noisy(replace(array, deviation=1.3e-3), pose)), pose)
    assert np.sqrt(np.mean((louder[..., 2] / outputs["deviation_Z"]) ** 2)) > 1.2  # the check can fail


def test_the_deviations_are_those_of_cramer_and_rao() -> None:
    pose = places(100, 4)
    outputs = (
        compile_c(FOUR).batch(state_records(FOUR, known_state(FOUR, pose)), by_input(FOUR, volts(FOUR, pose))).outputs
    )
    H = hall_two_waves.rows(FOUR, pose)
    bound = 1e-3 * np.sqrt(np.diagonal(np.linalg.inv(H.transpose(0, 2, 1) @ H), axis1=1, axis2=2))
    for i, name in enumerate(six_estimator.OUTPUTS):
        # The prior makes them smaller: by 1 % at most.
        np.testing.assert_allclose(outputs[f"deviation_{name}"], bound[:, i], rtol=1e-2)
        assert (outputs[f"deviation_{name}"] < bound[:, i] * (1 + 1e-6)).all()


def test_it_follows_motions() -> None:
    """Of 0.7 m/s, 7 m/s^2, 0.4 mm of gap and 8 mrad of tilt: each sample is valid but a few in a thousand."""
    pose = motion(300, 40, 6, travel=0.1)
    outputs = replay(FOUR, pose[0], noisy(FOUR, pose))
    off, sure = errors(outputs, pose), outputs["valid"] > 0
    assert sure.mean() > 0.995 and not outputs["lock_lost"].any()
    assert np.abs(off[sure][:, :3]).max() < 25e-6 and np.abs(off[sure][:, 3:]).max() < 1e-3


@pytest.mark.parametrize("array", ARRAYS.values(), ids=ARRAYS)
def test_no_sample_raises_the_cost_whatever_the_voltages(array: Array) -> None:
    n, of = 2000, setup(array)
    pose, V = places(n, 6), np.random.default_rng(6).uniform(-4.9, 4.9, (2000, len(array.positions), 2))
    state = known_state(array, pose) | {"searching": np.ones(n)}
    start, weights, problem = reference_six.predict(of, state), np.ones(V.shape[:2]), reference_six.problem(of)
    before = reference_glsdc.fit(problem, start, 0 * start, V, weights).cost
    after = compile_c(array).batch(state_records(array, state), by_input(array, V)).outputs
    end = np.stack([after[name] for name in six_estimator.OUTPUTS], axis=1) - start - UP
    end[:, :2] = (end[:, :2] + L / 2) % L - L / 2
    cost = reference_glsdc.fit(problem, start, end, V, weights).cost
    assert (cost <= before + 5 * reference_glsdc.SLACK * array.deviation**2).all()
    assert (cost < 0.9 * before).mean() > 0.5


# Flags.


def test_where_rank_is_lost_it_is_damped() -> None:
    """Three places lose it on curves, where their determinant changes its sign; one beside another is no help."""
    three = replace(FOUR, positions=FOUR.positions[:3])
    x, y, z = three.positions[0]
    doubled = replace(FOUR, positions=(*three.positions, (x + 1e-9, y, z)))
    at = hall_two_waves.level(three, hall_two_waves.poses(three.pitch, 60)).reshape(60, 60, 6)
    D = np.linalg.det(hall_two_waves.rows(three, at.reshape(-1, 6))).reshape(60, 60)
    i, j = np.argwhere(np.sign(D[:-1]) != np.sign(D[1:]))[0]
    low, high = at[i, j].copy(), at[i + 1, j].copy()
    for _ in range(50):
        middle = (low + high) / 2
        same = np.sign(np.linalg.det(hall_two_waves.rows(three, middle[np.newaxis]))[0]) == np.sign(D[i, j])
        low, high = (middle, high) if same else (low, middle)
    pose = low[np.newaxis]
    for array, lost in ((doubled, 1), (FOUR, 0)):
        outputs = by_block(array, known_state(array, pose), volts(array, pose))
        assert outputs["damped"] == lost and outputs["valid"] == 1 - lost and outputs["converged"] == 1


def test_fewer_than_four_sensors_are_refused() -> None:
    with pytest.raises(ModelError, match="3 sensors lose rank on curves"):
        six_estimator.estimator(ANY, TIME)


def test_sensors_at_one_place_count_once() -> None:
    twice = replace(FOUR, positions=(*FOUR.positions[:3], FOUR.positions[0]))
    with pytest.raises(ModelError, match=r"3 sensors lose rank on curves .* each at a place of its own"):
        six_estimator.estimator(twice, TIME)
    with pytest.raises(ModelError, match="5 sensors at 4 places leave fewer than 4"):
        six_estimator.estimator(replace(FOUR, positions=(*FOUR.positions, FOUR.positions[0])), TIME)


@pytest.mark.parametrize(
    "change", [[0, 0, 0.9e-3, 0, 0, 0], [0, 0, 0, 0.018, 0, 0], [0, 0, 0, 0, -0.018, 0]], ids=["gap", "roll", "pitch"]
)
def test_beyond_its_ranges_it_is_not_valid(change: list[float]) -> None:
    """It is valid up to them; the motion goes on past them within 40 ms."""
    pose = np.tile(places(1, 7, gap=0.0, tilt=0.0), (32, 1, 1)) + 1.4 * np.linspace(0, 1, 32)[:, None, None] * change
    outputs = replay(FOUR, pose[0], volts(FOUR, pose))
    outside = np.abs(pose[..., 2] - 3e-3) > USUAL.gap
    outside |= (np.abs(pose[..., 3:5]) > USUAL.tilt).any(axis=-1)
    assert outside.any() and not (outputs["valid"] > 0)[outside].any()
    assert (outputs["valid"] > 0)[~outside].mean() > 0.9


def test_a_false_voltage_leaves_residuals_and_is_not_valid() -> None:
    pose = np.repeat(places(200, 8)[np.newaxis], 4, axis=0)
    V = volts(FOUR, pose)
    V[1:, :, 2, 1] += 0.5
    outputs = replay(FOUR, pose[0], V)
    assert outputs["valid"][0].all() and not outputs["valid"][1].any()
    assert (outputs["residual"][1] > USUAL.residual_limit).mean() > 0.9


def test_a_refused_sensor_is_excluded_where_one_is_redundant() -> None:
    pose = np.repeat(places(40, 9)[np.newaxis], 30, axis=0)
    V = noisy(FIVE, pose)
    V[10:, :, 1, 0] = np.nan
    outputs = replay(FIVE, pose[0], V)
    off = errors(outputs, pose)[10:]
    left = replace(FIVE, positions=(FIVE.positions[0], *FIVE.positions[2:]))
    H = hall_two_waves.rows(left, pose[0])
    bound = 1e-3 * np.sqrt(np.diagonal(np.linalg.inv(H.transpose(0, 2, 1) @ H), axis1=1, axis2=2))
    sure = outputs["valid"][10:] > 0
    assert sure.mean() > 0.9 and np.median(outputs["deviation_X"][20] / bound[:, 0]) == pytest.approx(1, rel=1e-2)
    assert np.sqrt(np.mean((off / bound)[sure] ** 2)) < 1.1
    V = noisy(FOUR, pose)
    V[10:, :, 1, 0] = np.nan
    assert not replay(FOUR, pose[0], V)["valid"][10:].any()


def test_the_search_converges_from_anywhere_in_the_pitch() -> None:
    """Level and at the height within 0.3 mm and 5 mrad, yaw 2 degrees: all of 200 in a quarter of a second."""
    pose = np.repeat(places(200, 10, yaw=0.035, gap=3e-4, tilt=5e-3)[np.newaxis], 200, axis=0)
    V, state = noisy(FOUR, pose), state_records(FOUR, known_state(FOUR, np.tile(UP, (200, 1))))
    state["estimator_searching"] = 1
    for now in V:
        batch = compile_c(FOUR).batch(state, by_input(FOUR, now))
        state = batch.states
    off, sure = errors(batch.outputs, pose[-1]), batch.outputs["valid"] > 0
    off[:, :2] = (off[:, :2] + L / 2) % L - L / 2
    assert sure.all() and (np.abs(off) < [5e-5] * 3 + [2e-3] * 3).all() and batch.outputs["lock_lost"].mean() > 0.5


def test_voltages_are_named_by_sensor_and_axis() -> None:
    assert [s.name for s in channels.voltages(len(ANY.positions))] == ["V_ax", "V_ay", "V_bx", "V_by", "V_cx", "V_cy"]
