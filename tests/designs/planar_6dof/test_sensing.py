"""Sensing against the plant's Hall voltages: errors, seams, counts, noise, faults; the Block against the reference.

plant's voltages (+ noise, + fault) ---> [ sensing, filters ] ---> raw, filtered, suspects
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from designs.planar_6dof import calibration, filtering, reference_sensing, sensing, sensing_maps
from models import planar_stage
from synth.block import Block
from synth.compose import compose
from synth.emit import write
from synth.execute import compile as compiler
from synth.execute import cross, host
from synth.statespace import Array
from synth.synthesise import safety
from synth.timing import Discrete
from synth.verify import meter, rivals, steps
from tests import tolerances

PLANT = planar_stage.plant()
TIME = Discrete(1 / 800)
HALL = planar_stage.HALL
CAL = calibration.of(PLANT)
A, L = CAL.amplitude, CAL.pitch
W = 2 * np.pi / L
SIGMA = sensing_maps.deviation(PLANT)  # V rms
REFERENCE = reference_sensing.constants(TIME.period_s)
EXACT = tolerances.of("double")

Columns = Mapping[str, Array]


@cache
def estimation(predicted: bool = True) -> Block:
    return sensing_maps.estimation(PLANT, TIME, predicted)


@cache
def compiled(scalar: type[np.floating], predicted: bool = True) -> host.Controller:
    made = write.emit(estimation(predicted), scalar)
    return host.load(made.files, made.manifest)


def held(voltages: Columns) -> dict[str, Any]:
    return {f"{name}_held": v for name, v in voltages.items()}


def noisy(voltages: Columns, seed: int = 0) -> dict[str, Array]:
    rng = np.random.default_rng(seed)
    return {name: v + SIGMA * rng.normal(size=v.shape) for name, v in voltages.items()}


def seen(u: Columns) -> dict[str, Any]:
    """Return what the estimation reads of voltages (N,) that the guard accepts."""
    return held(u) | {"ready": np.arange(len(u["V_ax"])) > 0, "complete": 1.0}


def replayed(
    pose: Columns, noise: bool = False, scalar: type[np.floating] = np.float64, predicted: bool = True
) -> host.Columns:
    """Return the outputs of the C along a trajectory (N,) that begins in the middle pitch."""
    u = sensing_maps.voltages(PLANT, pose)
    return compiled(scalar, predicted).replay(seen(noisy(u) if noise else u)).outputs


def pitches(run: host.Columns, axis: str) -> Array:
    """Return the whole pitches (N,) that a run counts."""
    count = (np.asarray(run[f"{axis}_raw"], float) - np.asarray(run[f"within_{axis}"], float)) / L
    assert np.abs(count - np.rint(count)).max() < 1e-6  # single precision of a position
    return np.rint(count)


def poses(n: int, seed: int, lift: float, yaw: float) -> dict[str, Array]:
    rng = np.random.default_rng(seed)
    size = {"x": L / 2, "y": L / 2, "phi": yaw, "z": lift}
    return {axis: rng.uniform(-bound, bound, n) for axis, bound in size.items()}


def sensed(block: Block, pose: Columns) -> dict[str, Array]:
    """Return the outputs of the sensing Block at poses (N,) that are predicted as they are."""
    n = len(pose["x"])
    given = held(sensing_maps.voltages(PLANT, pose)) | {"ready": np.ones(n), "complete": np.ones(n)}
    given |= {f"{axis}_predicted": pose[axis] for axis in filtering.AXES}
    state = np.tile(block.initial[:, None], n)
    y = block.function().map(n)(state, np.array([given[s.name] for s in block.inputs]))[1].full()
    return dict(zip((s.name for s in block.outputs), y, strict=True))


def changed(block: Block, **constants: float) -> Block:
    return replace(block, constants=tuple(replace(c, value=constants.get(c.name, c.value)) for c in block.constants))


def errors(block: Block, pose: Columns) -> dict[str, Array]:
    found = sensed(block, pose)
    return {axis: found[f"{axis}_raw"] - pose[axis] for axis in filtering.AXES}


def rms(v: Array) -> float:
    return float(np.sqrt(np.mean(np.square(v))))


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
    found = sensing_maps.error_map(PLANT, points=8)
    i, j = np.unravel_index(found.noise["phi"].argmin(), found.noise["phi"].shape)
    n = 4000
    u = noisy(sensing_maps.voltages(PLANT, {"x": np.full(n, found.place[i]), "y": np.full(n, found.place[j])}))
    block = sensing.sensing(PLANT, TIME)
    given = held(u) | {"x_predicted": np.full(n, found.place[i]), "y_predicted": np.full(n, found.place[j])}
    given |= {"phi_predicted": np.zeros(n), "ready": np.ones(n), "complete": np.ones(n)}
    y = block.function().map(n)(np.tile(block.initial[:, None], n), np.array([given[s.name] for s in block.inputs]))
    raw = y[1].full()[:3]
    expected = [found.noise[axis][i, j] for axis in filtering.AXES]
    np.testing.assert_allclose(raw.std(axis=1), expected, rtol=0.05)  # 4000 samples, and curvature


def test_a_calibration_without_harmonics_is_seen() -> None:
    arctangent = np.linalg.lstsq(
        np.stack([np.tan(v) ** (2 * np.arange(4) + 1) for v in np.linspace(0.01, 0.78, 50)]),
        np.linspace(0.01, 0.78, 50) / W,
    )[0]
    plain = changed(sensing.sensing(PLANT, TIME), **{f"position_{2 * n + 1}": v for n, v in enumerate(arctangent)})
    assert 300e-6 < rms(errors(plain, poses(2000, 0, 0.0, 0.0))["x"]) < 350e-6


def test_a_yaw_that_is_not_turned_back_is_seen() -> None:
    block, pose = sensing.sensing(PLANT, TIME), poses(2000, 0, 0.0, 6e-3)
    blind = {name: v for name, v in pose.items() if name != "phi"} | {"phi": np.zeros(2000)}
    u = held(sensing_maps.voltages(PLANT, pose)) | {f"{a}_predicted": blind[a] for a in filtering.AXES}
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
        u = held(sensing_maps.voltages(PLANT, {"x": x, "y": y, "phi": np.full_like(x, phi)}))
        u |= {"x_predicted": x, "y_predicted": y, "phi_predicted": np.zeros_like(x)}
        u |= {"ready": np.ones_like(x), "complete": np.ones_like(x)}
        raw.append(step(state, np.array([u[s.name] for s in block.inputs]))[1].full()[2])
    return float((raw[0] - raw[1]).min() / 2e-4)


def test_without_the_amplitudes_the_yaw_is_lost_where_both_differences_are_blind() -> None:
    block = sensing.sensing(PLANT, TIME)
    assert yaw_gain(block) > 0.7  # what harmonics do to h_3 is left out
    assert yaw_gain(changed(block, third=0.0)) < 0.6  # 0 where both vanish: between the points of the grid


# Seams, counts, long ways.


def way(travel: float, n: int) -> dict[str, Array]:
    """To and fro through the middle: x up to `travel` and back to -travel, y the other way round at half the speed."""
    x = travel * np.interp(np.arange(n), [0, n / 4, 3 * n / 4, n], [0, 1, -1, 0])
    return {"x": x, "y": -0.5 * x}


def seams(pose: Columns, axis: str) -> np.ndarray:
    """Return the samples at which a section of 45 degrees begins."""
    section = np.floor(8 * pose[axis] / L + 0.5)
    return np.flatnonzero(np.diff(section)) + 1


@pytest.mark.parametrize("predicted", [True, False])
def test_sections_and_pitches_join_in_both_directions(predicted: bool) -> None:
    pose = way(0.11, 16_000)
    clean, found = (replayed(pose, noise, predicted=predicted) for noise in (False, True))
    for axis in "xy":
        at = seams(pose, axis)
        steps = {kind: np.diff(run[f"{axis}_raw"] - pose[axis]) for kind, run in (("clean", clean), ("noisy", found))}
        others = np.delete(steps["noisy"], at - 1)
        assert len(at) > 30 and {-1, 1} <= set(np.sign(np.diff(pose[axis])[at - 1]))
        # By construction there is no jump: what is left at a seam is the noise of any sample.
        assert np.abs(steps["clean"][at - 1]).max() < 0.05 * rms(others)
        assert rms(steps["noisy"][at - 1]) < 1.5 * rms(others)
        assert np.mean(np.abs(steps["noisy"][at - 1]) > 3 * rms(others)) <= 0.02
        counts = pitches(found, axis)
        assert set(counts) == ({-2, -1, 0, 1, 2} if axis == "x" else {-1, 0, 1})
        assert np.abs(pose[axis] - L * counts).max() < 0.51 * L


def test_a_seam_that_does_not_join_is_seen() -> None:
    block = sensing.sensing(PLANT, TIME)
    first = next(c.value for c in block.constants if c.name == "position_1")
    torn = changed(block, position_1=1.005 * first)
    near = np.array([L / 8 * (1 - 1e-6), L / 8 * (1 + 1e-6)])
    pose = {"x": near, "y": 0 * near, "phi": 0 * near, "z": 0 * near}
    assert np.diff(sensed(block, pose)["x_raw"])[0] < 1e-7 < 20e-6 < abs(np.diff(sensed(torn, pose)["x_raw"])[0])


@pytest.mark.parametrize("scalar", [np.float32, np.float64])
def test_a_circle_of_200_mm_is_followed(scalar: type[np.floating]) -> None:
    angle = 0.2094 * np.arange(24_000) * TIME.period_s
    pose = {"x": 0.1 * np.sin(angle), "y": 0.1 * np.cos(angle) - 0.1}
    pose["y"] = np.concatenate([np.linspace(0, 0.1, 2000), pose["y"] + 0.1])  # from the middle to its top first
    pose["x"] = np.concatenate([np.zeros(2000), pose["x"]])
    found = replayed(pose, noise=True, scalar=scalar)
    for axis in "xy":
        assert np.abs(found[f"{axis}_raw"] - pose[axis]).max() < 5.5 * 65e-6  # five and a half times the noise
        settled = (found[axis] - pose[axis])[3000:]
        assert rms(settled) < 0.4 * 54e-6 + 5e-6 and np.abs(np.diff(pitches(found, axis))).max() == 1
    assert {*pitches(found, "x")} == {-2, -1, 0, 1, 2}


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
    pose = {"x": way(0.1, 4000)["x"]}
    u = sensing_maps.voltages(PLANT, pose)
    u["V_ax"] = wrong * u["V_ax"]
    run = compiled(np.float64).replay(seen(u)).outputs
    error = run["x_raw"] - pose["x"]
    assert np.abs(error).max() < 10e-6 + 2 * abs(wrong - 1) / W  # of the pair itself, and by a wrong yaw
    assert np.ptp([error[pitches(run, "x") == n].mean() for n in (-1, 0, 1)]) < 1e-6  # the same in every pitch


@pytest.mark.parametrize("predicted", [True, False])
@pytest.mark.parametrize("ready", [0.0, 1.0])
def test_the_count_stays_within_its_bounds(ready: float, predicted: bool) -> None:
    """Also where all is taken for a position, since nothing has been known yet."""
    rng = np.random.default_rng(0)
    inputs = {f"{name}_held": rng.uniform(-5, 5, 3000) for name in HALL} | {"ready": ready, "complete": 1.0}
    run = compiled(np.float64, predicted).replay(inputs).outputs
    bounds = {"x_raw": 2.5 * L, "y_raw": 2.5 * L, "within_x": L / 2, "within_y": L / 2, "phi_raw": sensing.YAW}
    bounds |= {"x": 0.2, "y": 0.2, "phi": 0.05} if predicted else {}
    largest = {name: np.abs(run[name]).max() / bound for name, bound in bounds.items()}
    assert max(largest.values()) <= 1 + EXACT
    assert ready or min(v for name, v in largest.items() if "_" in name) > 0.5
    assert all(set(pitches(run, axis)) <= {-2, -1, 0, 1, 2} for axis in "xy")
    assert ready or all(np.ptp(pitches(run, axis)) > 0 for axis in "xy")


# The reference.


def motion(n: int, columns: int, seed: int) -> dict[str, Array]:
    """Sines of 0.2 to 1 Hz in x, y and phi, (n, columns), that begin anywhere in the middle pitch."""
    rng = np.random.default_rng(seed)
    t = np.arange(n)[:, None] * TIME.period_s
    found = {}
    for axis, size, start in (("x", 0.06, 0.4 * L), ("y", 0.06, 0.4 * L), ("phi", 4e-3, 0.0)):
        rate, turn = rng.uniform(0.2, 1.0, columns), rng.uniform(0, 2 * np.pi, columns)
        wave = size * rng.uniform(0.2, 1, columns) * np.sin(2 * np.pi * rate * t + turn)
        found[axis] = wave - wave[0] + rng.uniform(-start, start, columns)
    return found


def tried(n: int, columns: int, seed: int) -> dict[str, Array]:
    """Noisy voltages (n, columns) along motions; half of the columns lose a sensor, some are random at times."""
    pose = motion(n, columns, seed)
    u = noisy({k: v.reshape(n, columns) for k, v in sensing_maps.voltages(PLANT, pose).items()}, seed)
    rng = np.random.default_rng(seed)
    for j in range(columns // 2):
        name, at = HALL[j % 6], n // 4
        u[name][at:, j] = 0.0 if j % 4 else u[name][at, j]
    odd = rng.random((n, columns)) < np.where(np.arange(columns) % 8 == 7, 0.25, 0.0)
    return {name: np.clip(np.where(odd, rng.uniform(-5, 5, odd.shape), v), -5, 5) for name, v in u.items()}


def start(predicted: bool, n: int) -> dict[str, Array]:
    """Return the reference's states (n,) after init."""
    rest = reference_sensing.filters_at_rest() if predicted else {"sensing_phi_raw": np.array(0.0)}
    return {name: np.zeros(n) + v for name, v in (reference_sensing.initial_state() | rest).items()}


def stepped(
    state: Columns, v: Columns, flags: tuple[Array, Array], predicted: bool
) -> tuple[dict[str, Array], dict[str, Array]]:
    """Return outputs and next states of the reference, with its filters or predicting the sample before."""
    told = {f"suspect_{name}": state[f"sensing_found_{name}"] for name in HALL} | {"suspected": state["sensing_named"]}
    if predicted:
        out, after = reference_sensing.step(state, v, flags, REFERENCE)
    else:
        last = {axis: state[f"sensing_within_{axis}"] + state[f"sensing_offset_{axis}"] for axis in "xy"}
        last["phi"] = state["sensing_phi_raw"]
        out, after = reference_sensing.sense(state, v, flags, last, REFERENCE)
        after["sensing_phi_raw"] = out["phi_raw"]
    return out | told, after


def disagreement(n: int, columns: int, predicted: bool = True) -> float:
    """Return the worst difference of Block and C from the reference, of 1 or of the signal's largest value."""
    u, block, found = tried(n, columns, 7), estimation(predicted), compiled(np.float64, predicted)
    step, names, outputs = block.function().map(columns), [s.name for s in block.states], names_of(block)
    refused = np.random.default_rng(8).random((n, columns)) < 0.02
    state = start(predicted, columns)
    x, records = np.tile(block.initial[:, None], columns).astype(float), np.repeat(found.init()[np.newaxis], columns)
    gap, size = np.zeros(len(outputs) + len(names)), np.ones(len(outputs) + len(names))
    for i in range(n):
        v, flags = {name: column[i] for name, column in u.items()}, (np.full(columns, float(i > 0)), ~refused[i])
        out, state = stepped(state, v, flags, predicted)
        batch = found.batch(records, held(v) | {"ready": flags[0], "complete": flags[1].astype(float)})
        x, y = (m.full() for m in step(x, np.array([*v.values(), *flags])))
        records = batch.states
        wanted = np.array([*(out[name] for name in outputs), *(state[name] for name in names)])
        by_c = np.array([*(batch.outputs[name] for name in outputs), *(records[name] for name in names)])
        apart = np.maximum(np.abs(np.vstack([y, x]) - wanted), np.abs(by_c - wanted))
        gap, size = np.maximum(gap, apart.max(axis=1)), np.maximum(size, np.abs(wanted).max(axis=1))
    assert size[names.index("sensing_doubt") + len(outputs)] >= 2 * sensing.MEMORY
    assert all(state[f"sensing_found_{name}"].any() for name in HALL)  # every branch was taken
    return float((gap / size).max())


def names_of(block: Block) -> list[str]:
    return [s.name for s in block.outputs]


@pytest.mark.parametrize("predicted", [True, False])
def test_block_and_c_agree_with_the_reference_over_1e5_samples(predicted: bool) -> None:
    assert disagreement(500, 200, predicted) < EXACT


@pytest.mark.parametrize("name", ["LEAN", "EVIDENCE", "MEMORY", "WEIGHT", "POWER", "RESIDUAL"])
def test_another_reference_is_seen(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(reference_sensing, name, 1.1 * getattr(reference_sensing, name))
    assert disagreement(100, 200) > 1e-6


@pytest.mark.parametrize("predicted", [True, False])
def test_a_sample_that_is_refused_moves_nothing(predicted: bool) -> None:
    """Whatever stands in the place of its voltages; the filters go on as they predict."""
    u = noisy(sensing_maps.voltages(PLANT, way(0.02, 400)))
    refused = np.isin(np.arange(400), [100, 101, 250])
    runs = []
    for instead in (0.0, 4.9):
        given = {name: np.where(refused, instead, v) for name, v in u.items()}
        runs.append(compiled(np.float64, predicted).replay(seen(given) | {"complete": ~refused}).outputs)
    moved = [name for name in runs[0] if name not in names_of_residuals()]
    assert all((runs[0][name] == runs[1][name]).all() for name in moved) and "x_raw" in moved
    for axis in "xy":
        within = np.asarray(runs[0][f"within_{axis}"])
        assert (within[refused] == within[np.flatnonzero(refused) - [1, 2, 1]]).all()
        assert np.abs(runs[0][f"{axis}_raw"] - way(0.02, 400)[axis]).max() < (5e-4 if predicted else 1e-3)
    assert not np.asarray(runs[0]["suspected"]).any()


def names_of_residuals() -> list[str]:
    return [s.name for s in sensing.RESIDUALS]


# Faults.


BOUNDS = {name: (sensing.POWER * A if name.startswith("m_") else sensing.RESIDUAL) * A for name in names_of_residuals()}


@pytest.mark.parametrize("predicted", [True, False])
def test_nothing_is_suspected_in_1e5_noisy_samples(predicted: bool) -> None:
    n = 120_000
    t = np.arange(n) * TIME.period_s
    pose = {"x": 0.1 * np.sin(0.7 * t), "y": 0.09 * np.sin(1.1 * t), "phi": 6e-3 * np.sin(7 * t)}
    pose |= {"z": 2e-4 * np.sin(3 * t), "theta": 1e-3 * np.sin(2 * t), "psi": 1e-3 * np.sin(5 * t)}
    run = replayed(pose, noise=True, scalar=np.float32, predicted=predicted)
    assert not any(run[s.name].any() for s in (sensing.SUSPECTED, *sensing.SUSPECTS))
    for name, bound in BOUNDS.items():
        assert 0.3 < np.abs(run[name]).max() / bound < 1.0  # neither idle nor near to an alarm
    assert rms(run["phi" if predicted else "phi_raw"] - pose["phi"]) < (2e-3 if predicted else 4e-3)


@dataclass(frozen=True)
class Outcome:
    """Of runs in which one sensor fails: shares noticed and named among, and samples to the name, at most and mostly.

    `delay` is from the third contradiction to the suspects' bits in the fault word, `late` from the first one, of each
    of which the next is MEMORY samples away at most; `prompt` is the share of the runs in which `late` is 5 or less.
    """

    noticed: float
    among: float
    delay: int
    late: int
    prompt: float


def outcomes(columns: int, predicted: bool) -> dict[tuple[str, bool], Outcome]:
    """Fail each voltage, stuck or at zero, at sample 150 of noisy motions."""
    n, at, kinds = 600, 150, [(name, stuck) for name in HALL for stuck in (False, True)]
    pose = motion(n, columns, 3)
    clean = {k: np.tile(v.reshape(n, columns), len(kinds)) for k, v in sensing_maps.voltages(PLANT, pose).items()}
    u, which = noisy(clean, 4), np.repeat(np.arange(len(kinds)), columns)
    for j, (name, stuck) in enumerate(kinds):
        u[name][at:, which == j] = u[name][at, which == j] if stuck else 0.0
    state, named, told, over = start(predicted, len(which)), [], [], []
    for i in range(n):
        flags = np.full(len(which), float(i > 0)), ~(state["sensing_named"] > 0)  # the guard's
        out, state = stepped(state, {k: v[i] for k, v in u.items()}, flags, predicted)
        told.append(out["suspected"] > 0)
        named.append([out[f"suspect_{v}"] > 0 for v in HALL])
        over.append(np.any([np.abs(out[name]) > bound for name, bound in BOUNDS.items()], axis=0) & (i > 0))
    found, bits, alarms = np.array(named), np.array(told), np.array(over)  # (n, 6, N), (n, N), (n, N)
    assert not bits[:at].any()
    assert found.any(axis=1)[bits].all()  # never nobody
    first, started, third = (np.full(len(which), n) for _ in range(3))
    for j in range(len(which)):
        samples = np.flatnonzero(alarms[:, j])
        close = np.diff(samples) <= sensing.MEMORY
        three = np.flatnonzero(close[1:] & close[:-1])
        if three.size:
            started[j], third[j] = samples[three[0]], samples[three[0] + 2]
        first[j] = bits[:, j].argmax() if bits[:, j].any() else n
    seen, last = first < n, np.minimum(first, n - 1)
    assert (seen == (third < n - 1)).all()
    result = {}
    for j, (name, stuck) in enumerate(kinds):
        mine = seen & (which == j)
        own = found[last[mine], HALL.index(name), np.flatnonzero(mine)]
        late = (first - started)[mine]
        result[name, stuck] = Outcome(
            float(mine[which == j].mean()),
            float(own.mean()) if mine.any() else 0.0,
            int((first - third)[mine].max(initial=0)),
            int(late.max(initial=0)),
            float((late <= 5).mean()) if mine.any() else 0.0,
        )
    return result


@pytest.mark.parametrize("predicted", [True, False])
def test_a_sensor_that_fails_in_motion_is_named_at_once(predicted: bool) -> None:
    """Three contradictions and the sample in which the word tells it: 5 at most, but for noise about the bound."""
    for found in outcomes(80, predicted).values():
        assert found.noticed > 0.95 and found.among > 0.95
        assert found.delay == 1 and found.late <= 2 * sensing.MEMORY + 1 and found.prompt > 0.95


def test_a_sensor_that_is_not_checked_goes_unnoticed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(reference_sensing, "POWER", 10.0)
    monkeypatch.setitem(BOUNDS, "m_x", np.inf)
    monkeypatch.setitem(BOUNDS, "m_y", np.inf)
    found = outcomes(10, True)
    assert found["V_bx", False].among == 0 and found["V_cx", False].among > 0.95
    monkeypatch.setattr(reference_sensing, "RESIDUAL", 10.0)
    monkeypatch.setitem(BOUNDS, "r_1", np.inf)
    monkeypatch.setitem(BOUNDS, "r_2", np.inf)
    assert max(f.noticed for f in outcomes(10, True).values()) == 0


def guarded(predicted: bool) -> Block:
    held = [replace(s, name=s.name.removesuffix("_held")) for s in sensing.HELD]
    inputs = [safety.Guarded(s, 0.0, True, held=False) for s in held]
    parts = [safety.guard(TIME, inputs, WAIT, HALL), sensing.sensing(PLANT, TIME, predicted)]
    parts += filtering.blocks(TIME) if predicted else []
    return compose("guarded", parts, inputs=HALL, outputs=["x", "y", "phi"] if predicted else AS_MEASURED)


WAIT = 5  # samples that are not complete, of which the last latches
AS_MEASURED = [s.name for s in sensing.RAW.values()]


@cache
def guarded_c(predicted: bool) -> host.Controller:
    made = write.emit(guarded(predicted), np.float32)
    return host.load(made.files, made.manifest)


@cache
def bits() -> tuple[dict[str, int], dict[str, int]]:
    """Return the masks of the fault word that say a voltage is out of range, and that it is a suspect."""
    faults = guarded(True).faults
    refused = {f.input: 1 << f.bit for f in faults if f.input}
    suspect = {f.suspect: 1 << f.bit for f in faults if f.suspect}
    assert set(refused) == set(suspect) == set(HALL) and len({*refused.values(), *suspect.values()}) == 2 * len(HALL)
    return refused, suspect


def resting(n: int) -> dict[str, Array]:
    return noisy(sensing_maps.voltages(PLANT, {"x": np.full(n, L / 16), "y": np.full(n, L / 16)}))


@pytest.mark.parametrize("predicted", [True, False])
@pytest.mark.parametrize("name", HALL)
@pytest.mark.parametrize("value", [0.0, np.nan, 7.0])
def test_what_contradicts_is_named_and_latches(name: str, value: float, predicted: bool) -> None:
    n, at, (refused, suspect) = 80, 50, bits()
    u = resting(n)
    u[name][at:] = value
    run = guarded_c(predicted).replay(u)
    bit = suspect[name] if value == 0 else refused[name]
    wait = 3 if value == 0 else 0  # three samples contradict before it is named
    latch = at + wait + WAIT - 1
    assert (run.faults[: at + wait] == 0).all() and wait <= 5
    assert (run.faults[at + wait :] & bit).all()
    assert not (run.faults & (1 << safety.LATCH_BIT))[:latch].any() and (run.faults >> safety.LATCH_BIT)[latch:].all()
    if value != 0:  # nothing else is said
        assert (run.faults[at:latch] == bit).all()
    for axis in "xy":  # and meanwhile the position stays
        position = run.outputs[axis if predicted else f"{axis}_raw"]
        assert abs(position[at : latch + 1] - L / 16).max() < 2.5e-4


@pytest.mark.parametrize("predicted", [True, False])
@pytest.mark.parametrize("every", [1, 2, 3])
def test_a_loose_contact_is_named(every: int, predicted: bool) -> None:
    """One that is open in each second or third sample only; in each fourth it is no more than a single glitch."""
    n, at, (_, suspect) = 120, 50, bits()
    for name in HALL:
        u = resting(n)
        u[name][at::every] = 0.0
        faults = guarded_c(predicted).replay(u).faults
        told = at + 2 * every + 1
        assert not faults[:told].any() and (faults[told : told + WAIT] & suspect[name]).all()
        assert faults[told + WAIT - 1] >> safety.LATCH_BIT
    u = resting(n)
    u["V_ax"][at :: sensing.MEMORY + 1] = 0.0
    assert not guarded_c(predicted).replay(u).faults.any()


@pytest.mark.parametrize("predicted", [True, False])
def test_a_single_glitch_is_passed_over(predicted: bool) -> None:
    u = resting(100)
    calm = guarded_c(predicted).replay({k: v.copy() for k, v in u.items()})
    for name in HALL:
        glitch = {k: v.copy() for k, v in u.items()}
        glitch[name][60] = 4.9
        run = guarded_c(predicted).replay(glitch)
        assert (run.faults == 0).all()
        apart = [np.abs(run.outputs[a] - calm.outputs[a]) for a in (("x", "y") if predicted else ("x_raw", "y_raw"))]
        # Without a filter the sample is that before; a yaw that is another one fades.
        assert max(v.max() for v in apart) < (5e-5 if predicted else 3e-4) and max(v[80:].max() for v in apart) < 2e-5


@pytest.mark.parametrize("predicted", [True, False])
def test_the_map_of_faults_says_what_is_not_noticed(predicted: bool) -> None:
    found = sensing_maps.faults(PLANT, TIME, points=5, predicted=predicted)
    rows = {(r.voltage, r.failure): r for r in found.rows}
    assert len(rows) == 12 and all(r.named == 1.0 for r in found.rows)
    # What drops to zero near its zero is not noticed, and is worth little; V_bx and V_cy hide wherever the circle of
    # their pair passes near by.
    assert 0.3 < rows["V_bx", "zero"].unnoticed < 0.6 and rows["V_bx", "zero"].position < 5e-3
    assert all(rows[v, "zero"].unnoticed <= 0.2 for v in ("V_ax", "V_ay", "V_by", "V_cx"))
    assert all(rows[v, "stuck"].unnoticed == 0.0 and rows[v, "stuck"].moved < 15e-3 for v in HALL)
    assert "V_bx" in repr(found) and "unnoticed" in found._repr_html_()  # type: ignore[attr-defined]


def test_at_rest_a_sensor_that_sticks_is_not_noticed() -> None:
    start = np.full((2, 1), L / 16)
    for predicted in (True, False):
        seen = sensing_maps._watched(PLANT, estimation(predicted), start, 0 * start, 50, "V_ax", stuck=True)
        assert seen.noticed.tolist() == [-1] and seen.error.max() < 1e-5


# The C.


def test_the_c_is_free_of_warnings_and_calls_no_libm() -> None:
    made = write.emit(estimation(), np.float32)
    compiler.check(host.code(made.files))
    text = made.files["estimation.c"]
    assert not any(f"{name}f(" in text for name in ("sin", "cos", "atan", "asin", "atan2"))
    assert made.manifest["surrogates"] == []


def test_a_step_costs_at_most_330_instructions() -> None:
    block = compose(
        "cost",
        [sensing.sensing(PLANT, TIME), *filtering.blocks(TIME)],
        inputs=[s.name for s in estimation().inputs],
        outputs=["x", "y", "phi"],
    )
    made = write.emit(block, np.float32)
    pose = {k: v[:, 0] for k, v in motion(300, 1, 0).items()}
    inputs = seen(noisy(sensing_maps.voltages(PLANT, pose)))
    given = steps.recorded(host.load(made.files, made.manifest), "motion", inputs)
    build = next(b for b in meter.builds() if b.compiler == cross.available()[-1])
    assert meter.run(rivals.emitted(made), given, build).cost.instructions.max() <= 330
