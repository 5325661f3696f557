"""The estimator: convergence, standard deviations, corrections, flags at singular points, refused arguments."""

from dataclasses import replace

import casadi as ca
import numpy as np
import pytest

from designs.hall_position import reference, reference_glsdc
from designs.hall_position.glsdc import channels
from designs.hall_position.glsdc.parameters import Tuning
from models import concentrated_field, hall_array
from models.hall_two_waves import PlanarArray as Array
from synth.errors import ModelError
from synth.statespace import Array as Numbers
from tests import tolerances
from tests.designs.hall_position.tracked import (
    ALPHA,
    ARRAYS,
    BETA,
    PAIR,
    THREE,
    TWO,
    L,
    Pose,
    W,
    at_rest,
    before_start,
    by_input,
    compile_c,
    known_state,
    noisy,
    places,
    position_error,
    replay,
    setup,
    state_records,
    volts,
    wrap_angle,
)

EXACT = tolerances.of("double")
SINGULAR = (0.375 * L, 0.125 * L)  # where two sensors lose rank at yaw 0


def rms(values: Numbers) -> float:
    return float(np.sqrt(np.mean(values**2)))


# Convergence and deviations.


def test_the_voltages_here_are_those_of_the_sensor_model() -> None:
    field = concentrated_field.waves_from_amplitudes({1: ALPHA / 8.4, 5: BETA / 8.4}, 3e-3, concentrated_field.values())
    sensors = hall_array.point_sensors(THREE.positions)
    predicted, pose = hall_array.planar(sensors, field).function(), places(20, 0, 3.0)
    for X, Y, yaw, V in zip(pose.X, pose.Y, pose.yaw, volts(THREE, pose), strict=True):
        np.testing.assert_allclose(predicted(ca.DM([X, Y, yaw]))[0].full().ravel(), V.ravel(), rtol=0, atol=EXACT)


@pytest.mark.parametrize("array", ARRAYS.values(), ids=ARRAYS)
def test_a_sample_finds_a_body_that_has_moved(array: Array) -> None:
    """By up to a sixteenth of a pitch and 2 degrees, in one sample; of two sensors one in fifty finds another place."""
    start, rng = places(2000, 1, 0.2), np.random.default_rng(1)
    X, Y, yaw = (rng.uniform(-d, d, 2000) for d in (L / 16, L / 16, 0.035))
    pose, tuning = (
        Pose(start.X + X, start.Y + Y, start.yaw + yaw),
        Tuning(damping=1e-8, innovation_gate_sigma=1e9, yaw_limit=np.pi, yaw_window=np.pi),
    )
    state = state_records(array, known_state(array, start), tuning)
    outputs = compile_c(array, tuning).batch(state, by_input(array, volts(array, pose))).outputs
    sure = outputs["valid"] > 0
    assert sure.mean() > (0.7 if array is TWO else 0.95)
    assert (position_error(outputs, pose)[sure] < 1e-7).mean() > (0.95 if array is TWO else 0.998)


@pytest.mark.parametrize("array", ARRAYS.values(), ids=ARRAYS)
def test_errors_match_the_stated_deviations(array: Array) -> None:
    pose = at_rest(places(60, 3, 0.1), 100)
    outputs = replay(array, before_start(pose), noisy(array, pose))
    sure = outputs["valid"] > 0
    errors = {"X": outputs["X"] - pose.X, "Y": outputs["Y"] - pose.Y, "yaw": wrap_angle(outputs["yaw"] - pose.yaw)}
    for name, e in errors.items():
        assert 0.9 < rms(e[sure] / outputs[f"deviation_{name}"][sure]) < 1.1, name


@pytest.mark.parametrize(("noise", "agrees"), [(1.0, True), (1.25, False)])
def test_three_sensors_at_yaw_0_err_by_no_more_than_a_tenth_above_the_prediction(noise: float, agrees: bool) -> None:
    """With 1 mV; a quarter more noise than the prediction knows is seen."""
    pose = at_rest(places(100, 16, 0.0), 100)
    exact = volts(THREE, pose)
    outputs = replay(THREE, before_start(pose), exact + noise * (noisy(THREE, pose) - exact))
    assert outputs["valid"][1:].all()
    ratios = [
        rms((outputs[name] - getattr(pose, name))[1:] / outputs[f"deviation_{name}"][1:]) for name in ("X", "Y", "yaw")
    ]
    assert (max(ratios) <= 1.1) == agrees


def test_the_deviations_are_those_of_cramer_and_rao() -> None:
    pose, size = places(200, 4, 0.05), {"X": 1e-6, "Y": 1e-6, "yaw": 1e-5}
    outputs = (
        compile_c(THREE)
        .batch(state_records(THREE, known_state(THREE, pose)), by_input(THREE, volts(THREE, pose)))
        .outputs
    )
    slopes = []
    for name, h in size.items():
        forward, behind = (replace(pose, **{name: getattr(pose, name) + d}) for d in (h, -h))
        slopes.append((volts(THREE, forward) - volts(THREE, behind)).reshape(200, -1) / (2 * h))
    H = np.stack(slopes, axis=2)
    bound = 1e-3 * np.sqrt(np.linalg.inv(H.transpose(0, 2, 1) @ H).diagonal(axis1=1, axis2=2))
    for i, name in enumerate(size):
        # The prior makes them smaller: by 1 % at the worst place here.
        np.testing.assert_allclose(outputs[f"deviation_{name}"], bound[:, i], rtol=1e-2)
        assert (outputs[f"deviation_{name}"] < bound[:, i] * (1 + 1e-6)).all()


def test_deviations_of_three_sensors_over_the_pitch_are_the_known_ones() -> None:
    grid = L * np.arange(100) / 100
    pose = Pose(*(v.ravel() for v in np.meshgrid(grid, grid)), np.zeros(10_000))
    outputs = (
        compile_c(THREE)
        .batch(state_records(THREE, known_state(THREE, pose)), by_input(THREE, volts(THREE, pose)))
        .outputs
    )
    assert 5.2e-6 < outputs["deviation_Y"].max() < 5.35e-6 and 5.2e-6 < outputs["deviation_X"].max() < 5.35e-6
    assert 190e-6 < outputs["deviation_yaw"].max() < 200e-6


def test_a_quarter_turn_about_a_strong_block_is_not_seen() -> None:
    pose = places(50, 5, 3.0)
    rotated = Pose(-pose.Y, pose.X, pose.yaw + np.pi / 2)
    np.testing.assert_allclose(volts(THREE, rotated), volts(THREE, pose), rtol=0, atol=EXACT)


# Corrections.


@pytest.mark.parametrize("array", ARRAYS.values(), ids=ARRAYS)
def test_no_sample_raises_the_cost_whatever_the_voltages(array: Array) -> None:
    n, of = 5000, setup(array)
    pose, V = places(n, 6, np.pi), np.random.default_rng(6).uniform(-4.9, 4.9, (n, len(array.positions), 2))
    state = known_state(array, pose) | {"searching": np.ones(n)}
    start, problem = reference.predict(of, state), reference.problem(of)
    before = reference_glsdc.fit(problem, start, np.zeros((n, 3)), V)
    after = compile_c(array).batch(state_records(array, state), by_input(array, V))
    c, s, (x, y) = np.cos(after.outputs["yaw"]), np.sin(after.outputs["yaw"]), array.centre
    end = np.stack(
        [after.outputs["X"] + c * x - s * y, after.outputs["Y"] + s * x + c * y, after.outputs["yaw"]], axis=1
    )
    displacement = np.column_stack([end[:, :2] - start[:, :2], wrap_angle(end[:, 2] - start[:, 2])])
    displacement[:, :2] = (displacement[:, :2] + L / 2) % L - L / 2
    cost = reference_glsdc.fit(problem, start, displacement, V).cost
    assert (cost <= before.cost + 5 * reference_glsdc.SLACK * array.deviation**2).all()
    assert (cost < 0.9 * before.cost).mean() > 0.5


def test_five_corrections_of_a_fifth_take_three_samples_as_in_the_paper() -> None:
    """0.8^15 = 3.5 % of a step remains; 51 % with one correction a sample. The last trial is not applied yet."""
    pose = places(200, 7, 0.02)
    target = at_rest(Pose(pose.X + 5e-4, pose.Y, pose.yaw), 3)
    for iterations, left in ((6, 0.8**15), (2, 0.8**3)):
        tuning = Tuning(iterations, scale=0.2, velocity_gain=0.0, damping=1e-6, residual_limit=10.0)
        outputs = replay(THREE, pose, volts(THREE, target), tuning)
        assert np.median(position_error(outputs, target)[2]) == pytest.approx(left * 5e-4, rel=0.05)
        assert not outputs["valid"][0].any()


# Singular points.


def test_at_a_singular_point_it_stays_and_is_damped() -> None:
    """Half a second with a tenth of the noise; at the point itself the noise alone causes no large jump."""
    n, rest = 400, Pose(*(np.full(20, v) for v in (*SINGULAR, 0.0)))
    pose = at_rest(rest, n)
    V = volts(TWO, pose) + 1e-4 * np.random.default_rng(0).standard_normal((n, 20, 2, 2))
    outputs = replay(TWO, rest, V)
    assert outputs["damped"].all() and not outputs["valid"].any() and not outputs["lock_lost"].any()
    assert position_error(outputs, pose).max() < 1e-4 and np.abs(np.diff(outputs["X"], axis=0)).max() < 1e-5
    undamped = replay(TWO, rest, V, Tuning(damping=1e-9, innovation_gate_sigma=1e9))
    assert undamped["damped"].mean() < 0.1 and np.abs(np.diff(undamped["X"], axis=0)).max() > 1e-4


def crossing(n: int) -> Pose:
    """Return n straight paths through the singular point, at 5 to 300 mm/s and any heading."""
    rng, t = np.random.default_rng(11), np.arange(-200, 200)[:, np.newaxis] / 800
    speed, heading, turn = 10 ** rng.uniform(-2.3, -0.5, n), rng.uniform(0, 2 * np.pi, n), rng.uniform(-0.3, 0.3, n)
    return Pose(SINGULAR[0] + speed * np.cos(heading) * t, SINGULAR[1] + speed * np.sin(heading) * t, turn * t)


def test_a_singular_point_is_passed() -> None:
    """Two curves lead out of it, on which two sensors have nearly the same voltages.

    The motion before it, above all that of the yaw, determines the right one.
    """
    pose = crossing(300)
    V = noisy(TWO, pose)
    loose, still = (
        replay(TWO, before_start(pose), V, Tuning(yaw_damping_ratio=1.0, velocity_gain=follow)) for follow in (0.5, 0.0)
    )
    lost, more = ((position_error(each, pose) > 1e-3).any(axis=0).mean() for each in (loose, still))
    assert 0.01 < lost < 0.02 < more
    outputs = replay(TWO, before_start(pose), V)
    assert outputs["damped"].max(axis=0).mean() > 0.95 and position_error(outputs, pose).max() < 1e-3


# Refused arguments.


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"positions": ((0.0, 0.0), (0.0, 0.0))}, "two places"),
        ({"alpha": 0.0}, "alpha is 0.0"),
        ({"beta": float("nan")}, "must be finite"),
    ],
)
def test_an_array_that_cannot_be_is_refused(change: dict[str, object], message: str) -> None:
    with pytest.raises(ModelError, match=message):
        replace(TWO, **change)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    "change", [{"iterations": 0}, {"scale": 1.5}, {"max_phase_step": 2.0}, {"velocity_gain": -0.1}, {"damping": 0.0}]
)
def test_a_tuning_that_cannot_be_is_refused(change: dict[str, float]) -> None:
    with pytest.raises(ModelError, match=f"{next(iter(change))} is"):
        Tuning(**change)  # type: ignore[arg-type]


def test_voltages_are_named_by_sensor_and_axis() -> None:
    assert [s.name for s in channels.voltages(len(PAIR))] == ["V_ax", "V_ay", "V_bx", "V_by"]
    assert pytest.approx(TWO.wave_number) == W
