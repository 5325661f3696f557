"""Six degrees of freedom: least squares by SciPy, deviations, cold start, ranges, false and refused voltages."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy import optimize

from models import hall_two_waves
from models.hall_two_waves import SpatialArray as Array
from studies.hall.protected import spatial
from synth.errors import ModelError, TimingError
from synth.statespace import Array as Numbers
from synth.timing import Continuous
from tests.models.posed import ANY, FIVE, FOUR, L, noisy, places, volts
from tests.studies.hall.posed import TIME, USUAL, compile_c, errors, motion, replay, tracking_states

pytestmark = pytest.mark.whole

INVALID: tuple[Any, ...] = (None, "1", True, float("nan"), float("inf"), 10**400, [1.0])
SIZES = np.array([1, 1, 1, *3 * [25.4e-3]])  # m, of a unit of each coordinate
SIGMA = float(np.hypot(FOUR.deviation, USUAL.model_error))  # V


def middle_pitch(n: int, seed: int, yaw: float = 0.09) -> Numbers:
    """Return poses in the middle pitch."""
    return places(n, seed, yaw) - [L / 2, L / 2, 0, 0, 0, 0]


def test_it_finds_the_least_squares_solution() -> None:
    """Of SciPy, by differences of voltages alone."""
    pose = middle_pitch(12, 1)
    V = noisy(FOUR, pose)
    near = pose + np.random.default_rng(2).standard_normal(pose.shape) * np.array([30e-6] * 3 + [1e-3] * 3)
    outputs = replay(FOUR, tracking_states(FOUR, near), V[None])
    assert outputs["converged"].all()
    for k, at in enumerate(pose):

        def left(d: Numbers, k: int = k, at: Numbers = at) -> Numbers:
            return (volts(FOUR, at + 1e-5 * d / SIZES) - V[k]).ravel() / FOUR.deviation

        best = 1e-5 * optimize.least_squares(left, np.zeros(6), xtol=1e-10).x
        off = np.array([outputs[name][0, k] for name in spatial.OUTPUTS]) - at - best / SIZES
        deviations = np.array([outputs[f"deviation_{name}"][0, k] for name in spatial.OUTPUTS])
        assert (np.abs(off) < 0.05 * deviations).all()


def test_the_deviations_are_those_of_cramer_and_rao() -> None:
    pose = middle_pitch(100, 4)
    outputs = replay(FOUR, tracking_states(FOUR, pose), volts(FOUR, pose)[None])
    H = hall_two_waves.rows(FOUR, pose)
    bound = SIGMA * np.sqrt(np.diagonal(np.linalg.inv(H.transpose(0, 2, 1) @ H), axis1=1, axis2=2))
    for i, name in enumerate(spatial.OUTPUTS):
        np.testing.assert_allclose(outputs[f"deviation_{name}"][0], bound[:, i], rtol=1e-3)


@pytest.mark.parametrize("array", [FOUR, FIVE], ids=["four", "five"])
def test_a_cold_start_finds_the_body(array: Array) -> None:
    """At rest, level and at the height within its ranges."""
    pose, samples = middle_pitch(60, 10), USUAL.starts * USUAL.dwell + 4
    V = noisy(array, np.repeat(pose[None], samples, axis=0))
    init = np.repeat(compile_c(array).init()[None], len(pose))
    outputs = replay(array, init, V)
    good = outputs["valid"] > 0
    assert good[-1].mean() > 0.9
    assert np.abs(errors(outputs, pose[None].repeat(samples, axis=0))[good][:, :3]).max() < 1e-4


def test_it_follows_motions() -> None:
    """Of 0.7 m/s, 7 m/s^2, 0.4 mm of gap and 8 mrad of tilt."""
    pose = motion(200, 30, 6, travel=0.1)
    outputs = replay(FOUR, tracking_states(FOUR, pose[0]), noisy(FOUR, pose))
    off, sure = errors(outputs, pose), outputs["valid"] > 0
    assert sure.mean() > 0.9 and not outputs["lost"].any()
    assert np.abs(off[sure][:, :3]).max() < 50e-6 and np.abs(off[sure][:, 3:]).max() < 2e-3


def test_a_false_voltage_is_not_valid_and_of_five_sensors_its_sensor_is_excluded() -> None:
    pose = np.repeat(middle_pitch(100, 8)[None], 12, axis=0)
    for array in (FOUR, FIVE):
        V = noisy(array, pose)
        V[4:, :, 2, 1] += 0.5
        outputs = replay(array, tracking_states(array, pose[0]), V)
        off, good = errors(outputs, pose), outputs["valid"] > 0
        assert good[:4].mean() > 0.9 and not good[4].any() and np.abs(off[good][:, :3]).max() < 2e-4
        assert array is FOUR or ((outputs["excluded"][6] == 3).mean() > 0.95 and good[6].mean() > 0.3)


def test_a_refused_sensor_is_excluded_where_one_is_redundant() -> None:
    pose = np.repeat(middle_pitch(40, 9)[None], 20, axis=0)
    for array, valid in ((FIVE, True), (FOUR, False)):
        V = noisy(array, pose)
        V[10:, :, 1, 0] = np.nan
        assert (replay(array, tracking_states(array, pose[0]), V)["valid"][10:].mean() > 0.3) == valid


@pytest.mark.parametrize("change", [[0, 0, 1e-3, 0, 0, 0], [0, 0, 0, 0.02, 0, 0]], ids=["gap", "roll"])
def test_beyond_its_ranges_it_is_not_valid(change: list[float]) -> None:
    pose = np.tile(places(1, 7, gap=0.0, tilt=0.0) - [L / 2, L / 2, 0, 0, 0, 0], (40, 1, 1))
    pose = pose + 1.4 * np.linspace(0, 1, 40)[:, None, None] * change
    outputs = replay(FOUR, tracking_states(FOUR, pose[0]), volts(FOUR, pose))
    outside = (np.abs(pose[..., 2] - 3e-3) > 1.1 * USUAL.gap) | (np.abs(pose[..., 3:5]) > 1.1 * USUAL.tilt).any(axis=-1)
    assert outside.any() and not (outputs["valid"] > 0)[outside].any()


def test_fewer_than_four_places_are_refused() -> None:
    twice = replace(FOUR, positions=(*FOUR.positions[:3], FOUR.positions[0]))
    for array in (ANY, twice):
        with pytest.raises(ModelError, match="3 sensors lose rank on curves"):
            spatial.guarded_estimator(array, TIME)


@pytest.mark.parametrize("change", [{"corrections": 0}, {"phase_step": 2.0}, {"tilt": 0.2}, {"gap": 0.0}])
def test_a_tuning_that_cannot_be_is_refused(change: dict[str, float]) -> None:
    with pytest.raises(ModelError, match=f"{next(iter(change))} is"):
        spatial.Tuning(**change)  # type: ignore[arg-type]


def test_each_number_of_a_tuning_is_refused_unless_it_is_a_number() -> None:
    for name in spatial.Tuning.__dataclass_fields__:
        for value in INVALID:
            with pytest.raises(ModelError, match=f"^{name} is "):
                spatial.Tuning(**{name: value})


def test_what_is_counted_is_a_whole_number() -> None:
    for counted in ("corrections", "pitches"):
        for value in (2.5, 2.0, 0, 1001):
            with pytest.raises(ModelError, match=f"{counted} is {value}: give a whole number of at least 1"):
                spatial.Tuning(**{counted: value})
        assert getattr(spatial.Tuning(**{counted: np.int64(2)}), counted) == 2


@pytest.mark.parametrize("time", [None, Continuous(), 1 / 800])
def test_an_estimator_takes_a_period(time: Any) -> None:
    with pytest.raises(TimingError, match=r"`time` of `glsdc_estimator.estimator` is .*: give a Discrete"):
        spatial.guarded_estimator(FOUR, time)
