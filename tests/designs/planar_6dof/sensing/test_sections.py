"""Sensing against the plant's Hall voltages: errors, seams, counts, noise; its C."""

from dataclasses import replace

import numpy as np
import pytest

from designs.planar_6dof import filtering, reference_sensing
from designs.planar_6dof.sensing import maps as sensing_maps
from designs.planar_6dof.sensing import sections as sensing
from synth.block import Block, unranged
from synth.emit import write
from synth.execute import compile as compiler
from synth.execute import host
from synth.statespace import Array
from synth.verify import meter, steps
from tests import ceilings
from tests.designs.planar_6dof.measured import (
    AS_MEASURED,
    CAL,
    EXACT,
    HALL,
    PLANT,
    REFERENCE,
    TIME,
    A,
    Columns,
    L,
    W,
    compile_estimation,
    estimation,
    estimation_inputs,
    forward_and_back,
    held_voltages,
    motion,
    noisy,
    pitches,
    replay,
    rms,
)


def poses(n: int, seed: int, lift: float, yaw: float) -> dict[str, Array]:
    rng = np.random.default_rng(seed)
    size = {"x": L / 2, "y": L / 2, "phi": yaw, "z": lift}
    return {axis: rng.uniform(-bound, bound, n) for axis, bound in size.items()}


def sense(block: Block, pose: Columns) -> dict[str, Array]:
    """Return the outputs of the sensing Block at poses (N,) that are predicted as they are."""
    n = len(pose["x"])
    inputs = held_voltages(sensing_maps.voltages(PLANT, pose)) | {"ready": np.ones(n), "complete": np.ones(n)}
    inputs |= {f"{axis}_predicted": pose[axis] for axis in filtering.AXES}
    state = np.tile(block.initial[:, None], n)
    y = block.function().map(n)(state, np.array([inputs[s.name] for s in block.inputs]))[1].full()
    return dict(zip((s.name for s in block.outputs), y, strict=True))


def with_constants(block: Block, **constants: float) -> Block:
    return replace(block, constants=tuple(replace(c, value=constants.get(c.name, c.value)) for c in block.constants))


def errors(block: Block, pose: Columns) -> dict[str, Array]:
    outputs = sense(block, pose)
    return {axis: outputs[f"{axis}_raw"] - pose[axis] for axis in filtering.AXES}


# The field's fits.


def test_the_amplitude_is_that_of_the_plant() -> None:
    quarter = sensing_maps.voltages(PLANT, {"x": L / 4})["V_ax"][0]
    harmonics = {n: reference_sensing.harmonic(n) for n in (1, 5, 9)}
    assert quarter == pytest.approx(sum(harmonics.values()), rel=EXACT)
    assert pytest.approx(harmonics[1], rel=EXACT) == A


def test_the_fits_are_those_of_the_reference() -> None:
    for name in ("position", "slope", "power"):
        np.testing.assert_allclose(getattr(CAL, name), getattr(REFERENCE, name), rtol=EXACT)


def test_the_position_is_fitted_to_10_um_and_joins_where_sections_meet() -> None:
    t = np.linspace(0, np.pi / 4, 2001)
    s, c, _ = reference_sensing.wave(t, {n: reference_sensing.harmonic(n) for n in (1, 5, 9)})
    fit = sum(p * (s / c) ** (2 * n + 1) for n, p in enumerate(CAL.position))
    assert rms(fit - t / W) < 4.5e-6 and np.abs(fit - t / W).max() < 10e-6
    assert fit[-1] == pytest.approx(L / 8, rel=EXACT)


# Errors of position and yaw.


def test_x_and_y_are_as_exact_as_the_calibration_where_nothing_is_lifted_or_turned() -> None:
    e = errors(sensing.sensing(PLANT, TIME), poses(4000, 0, lift=0.0, yaw=0.0))
    assert max(rms(e["x"]), rms(e["y"])) < 5e-6 and max(np.abs(e[a]).max() for a in "xy") < 10e-6


def test_x_and_y_are_within_the_residue_of_the_harmonics_over_lift_and_yaw() -> None:
    e = errors(sensing.sensing(PLANT, TIME), poses(4000, 1, lift=1e-4, yaw=6e-3))
    assert max(rms(e["x"]), rms(e["y"])) < 12e-6 and max(np.abs(e[a]).max() for a in "xy") < 40e-6


def test_the_error_map_tells_them_and_the_noise() -> None:
    flat, turned = (sensing_maps.error_map(PLANT, yaw, points=24) for yaw in (0.0, 6e-3))
    assert rms(flat.error["phi"]) < 6e-5 and rms(turned.error["phi"]) < 2.5e-4
    assert np.abs(turned.error["phi"]).max() < 2.5e-3
    assert rms(turned.error["x"]) < 6e-6 and np.all(flat.noise["x"] < 7e-5)
    assert 1.5e-3 < np.median(flat.noise["phi"]) < 2e-3 and flat.noise["phi"].max() < 13e-3
    lifted = sensing_maps.error_map(PLANT, lift=1e-4, points=24)
    assert 10e-6 < rms(lifted.error["x"]) < 20e-6


def test_the_noise_of_the_map_is_that_of_noisy_samples() -> None:
    error_map = sensing_maps.error_map(PLANT, points=8)
    i, j = np.unravel_index(error_map.noise["phi"].argmin(), error_map.noise["phi"].shape)
    n = 4000
    u = noisy(sensing_maps.voltages(PLANT, {"x": np.full(n, error_map.place[i]), "y": np.full(n, error_map.place[j])}))
    block = sensing.sensing(PLANT, TIME)
    inputs = held_voltages(u) | {
        "x_predicted": np.full(n, error_map.place[i]),
        "y_predicted": np.full(n, error_map.place[j]),
    }
    inputs |= {"phi_predicted": np.zeros(n), "ready": np.ones(n), "complete": np.ones(n)}
    y = block.function().map(n)(np.tile(block.initial[:, None], n), np.array([inputs[s.name] for s in block.inputs]))
    raw = y[1].full()[:3]
    expected = [error_map.noise[axis][i, j] for axis in filtering.AXES]
    np.testing.assert_allclose(raw.std(axis=1), expected, rtol=0.05)  # 4000 samples, and curvature


def test_a_calibration_without_harmonics_is_seen() -> None:
    arctangent = np.linalg.lstsq(
        np.stack([np.tan(v) ** (2 * np.arange(4) + 1) for v in np.linspace(0.01, 0.78, 50)]),
        np.linspace(0.01, 0.78, 50) / W,
    )[0]
    plain = with_constants(
        sensing.sensing(PLANT, TIME), **{f"position_{2 * n + 1}": v for n, v in enumerate(arctangent)}
    )
    assert 300e-6 < rms(errors(plain, poses(2000, 0, 0.0, 0.0))["x"]) < 350e-6


def test_a_yaw_that_is_not_turned_back_is_seen() -> None:
    block, pose = sensing.sensing(PLANT, TIME), poses(2000, 0, 0.0, 6e-3)
    blind = {name: v for name, v in pose.items() if name != "phi"} | {"phi": np.zeros(2000)}
    u = held_voltages(sensing_maps.voltages(PLANT, pose)) | {f"{a}_predicted": blind[a] for a in filtering.AXES}
    u |= {"ready": np.ones(2000), "complete": np.ones(2000)}
    y = block.function().map(2000)(np.tile(block.initial[:, None], 2000), np.array([u[s.name] for s in block.inputs]))
    assert rms(y[1].full()[0] - pose["x"]) > 15e-6


def yaw_gain(block: Block) -> float:
    """Return the least slope of the raw yaw over the yaw, which is predicted as 0, over a pitch."""
    place = L * (np.arange(160) / 160 - 0.5)
    x, y = (v.ravel() for v in np.meshgrid(place, place))
    step, state = block.function().map(len(x)), np.tile(block.initial[:, None], len(x))
    raw = []
    for phi in (1e-4, -1e-4):
        u = held_voltages(sensing_maps.voltages(PLANT, {"x": x, "y": y, "phi": np.full_like(x, phi)}))
        u |= {"x_predicted": x, "y_predicted": y, "phi_predicted": np.zeros_like(x)}
        u |= {"ready": np.ones_like(x), "complete": np.ones_like(x)}
        raw.append(step(state, np.array([u[s.name] for s in block.inputs]))[1].full()[2])
    return float((raw[0] - raw[1]).min() / 2e-4)


def test_without_the_amplitudes_the_yaw_is_lost_where_both_differences_are_blind() -> None:
    block = sensing.sensing(PLANT, TIME)
    assert yaw_gain(block) > 0.7  # what harmonics do to h_3 is left out
    assert (
        yaw_gain(with_constants(block, amplitude_weight=0.0)) < 0.6
    )  # 0 where both vanish: between the points of the grid


# Seams, counts, long ways.


def seams(pose: Columns, axis: str) -> np.ndarray:
    """Return the samples at which a section of 45 degrees begins."""
    section = np.floor(8 * pose[axis] / L + 0.5)
    return np.flatnonzero(np.diff(section)) + 1


@pytest.mark.parametrize("predicted", [True, False])
def test_sections_and_pitches_join_in_both_directions(predicted: bool) -> None:
    pose = forward_and_back(0.11, 16_000)
    clean, noisy = (replay(pose, noise, predicted=predicted) for noise in (False, True))
    for axis in "xy":
        at = seams(pose, axis)
        steps = {kind: np.diff(run[f"{axis}_raw"] - pose[axis]) for kind, run in (("clean", clean), ("noisy", noisy))}
        others = np.delete(steps["noisy"], at - 1)
        assert len(at) > 30 and {-1, 1} <= set(np.sign(np.diff(pose[axis])[at - 1]))
        # By construction there is no jump: what is left at a seam is the noise of any sample.
        assert np.abs(steps["clean"][at - 1]).max() < 0.05 * rms(others)
        assert rms(steps["noisy"][at - 1]) < 1.5 * rms(others)
        assert np.mean(np.abs(steps["noisy"][at - 1]) > 3 * rms(others)) <= 0.02
        counts = pitches(noisy, axis)
        assert set(counts) == ({-2, -1, 0, 1, 2} if axis == "x" else {-1, 0, 1})
        assert np.abs(pose[axis] - L * counts).max() < 0.51 * L


def test_a_seam_that_does_not_join_is_seen() -> None:
    block = sensing.sensing(PLANT, TIME)
    first = next(c.value for c in block.constants if c.name == "position_1")
    torn = with_constants(block, position_1=1.005 * first)
    near = np.array([L / 8 * (1 - 1e-6), L / 8 * (1 + 1e-6)])
    pose = {"x": near, "y": 0 * near, "phi": 0 * near, "z": 0 * near}
    assert np.diff(sense(block, pose)["x_raw"])[0] < 1e-7 < 20e-6 < abs(np.diff(sense(torn, pose)["x_raw"])[0])


@pytest.mark.parametrize("scalar", [np.float32, np.float64])
def test_a_circle_of_200_mm_is_followed(scalar: type[np.floating]) -> None:
    angle = 0.2094 * np.arange(24_000) * TIME.period_s
    pose = {"x": 0.1 * np.sin(angle), "y": 0.1 * np.cos(angle) - 0.1}
    pose["y"] = np.concatenate([np.linspace(0, 0.1, 2000), pose["y"] + 0.1])  # from the middle to its top first
    pose["x"] = np.concatenate([np.zeros(2000), pose["x"]])
    outputs = replay(pose, noise=True, scalar=scalar)
    for axis in "xy":
        assert np.abs(outputs[f"{axis}_raw"] - pose[axis]).max() < 5.5 * 65e-6  # five and a half times the noise
        settled = (outputs[axis] - pose[axis])[3000:]
        assert rms(settled) < 0.4 * 54e-6 + 5e-6 and np.abs(np.diff(pitches(outputs, axis))).max() == 1
    assert {*pitches(outputs, "x")} == {-2, -1, 0, 1, 2}


def running_sum(s: Array, c: Array) -> float:
    """Return how far (4), (5) go: sums of differences of the arcsine of the sensor in its sensitive interval, m."""
    inner = np.abs(s) <= np.abs(c)
    by_a, by_b = (np.arcsin(np.clip(v, -1, 1)) for v in (s, c))
    # The position grows with the one arcsine where the cosine is positive, and falls with the other where the sine is.
    steps = np.where(inner[1:], np.sign(c[1:]) * np.diff(by_a), -np.sign(s[1:]) * np.diff(by_b))
    return float(steps.sum() / W)


@pytest.mark.parametrize(("wrong", "lost"), [(1.0, 0.0), (1.01, 0.006), (0.99, -0.006)])
def test_the_published_sum_of_differences_drifts_and_the_count_does_not(wrong: float, lost: float) -> None:
    x = np.linspace(0, 4 * L, 40_001)
    assert running_sum(wrong * np.sin(W * x), np.cos(W * x)) / x[-1] - 1 == pytest.approx(lost, abs=5e-4)
    pose = {"x": forward_and_back(0.1, 4000)["x"]}
    u = sensing_maps.voltages(PLANT, pose)
    u["V_ax"] = wrong * u["V_ax"]
    run = compile_estimation(np.float64).replay(estimation_inputs(u)).outputs
    error = run["x_raw"] - pose["x"]
    assert np.abs(error).max() < 10e-6 + 2 * abs(wrong - 1) / W  # of the pair itself, and by a wrong yaw
    assert np.ptp([error[pitches(run, "x") == n].mean() for n in (-1, 0, 1)]) < 1e-6  # the same in every pitch


@pytest.mark.parametrize("predicted", [True, False])
@pytest.mark.parametrize("ready", [0.0, 1.0])
def test_the_count_stays_within_its_bounds(ready: float, predicted: bool) -> None:
    """Also where all is taken for a position, since nothing has been known yet."""
    rng = np.random.default_rng(0)
    inputs = {f"{name}_held": rng.uniform(-5, 5, 3000) for name in HALL} | {"ready": ready, "complete": 1.0}
    run = compile_estimation(np.float64, predicted).replay(inputs).outputs
    bounds = {"x_raw": 2.5 * L, "y_raw": 2.5 * L, "within_x": L / 2, "within_y": L / 2, "phi_raw": sensing.MAX_RAW_YAW}
    bounds |= {"x": 0.2, "y": 0.2, "phi": 0.05} if predicted else {}
    largest = {name: np.abs(run[name]).max() / bound for name, bound in bounds.items()}
    assert max(largest.values()) <= 1 + EXACT
    assert ready or min(v for name, v in largest.items() if "_" in name) > 0.5
    assert all(set(pitches(run, axis)) <= {-2, -1, 0, 1, 2} for axis in "xy")
    assert ready or all(np.ptp(pitches(run, axis)) > 0 for axis in "xy")


# The C.


def test_the_c_is_free_of_warnings_and_calls_no_libm() -> None:
    made = write.emit(unranged(estimation()), np.float32)
    compiler.check(host.code(made.files))
    text = made.files["estimation.c"]
    assert not any(f"{name}f(" in text for name in ("sin", "cos", "atan", "asin", "atan2"))
    assert made.manifest["surrogates"] == []


@pytest.mark.parametrize(("subject", "build"), ceilings.builds("sensing, predicted", "sensing, as measured"))
def test_what_a_step_costs(subject: str, build: meter.Build) -> None:
    ceiling, predicted = ceilings.of(subject, build), subject == "sensing, predicted"
    block, position = estimation(predicted), ["x", "y", "phi"] if predicted else AS_MEASURED
    alone = replace(block, outputs=tuple(s for s in block.outputs if s.name in position))
    made = write.emit(unranged(alone), np.float32)
    pose = {k: v[:, 0] for k, v in motion(300, 1, 0).items()}
    inputs = estimation_inputs(noisy(sensing_maps.voltages(PLANT, pose)))
    stimulus = steps.record(host.load(made.files, made.manifest), "motion", inputs)
    assert meter.run(meter.emitted_source(made), stimulus, build).cost.instructions.max() <= ceiling
