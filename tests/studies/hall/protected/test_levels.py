"""What the headers of three and four sensors promise of levels and starts, at ten times the samples, with a defect."""

from dataclasses import replace
from math import isclose

import numpy as np
import pytest

from designs.hall_position.protected import config
from studies.hall.protected import cold_start, levels, trust
from studies.hall.protected.levels import Exceeded
from synth.errors import ModelError

NOT_OWN = ("declared", "fabricated", "built")


def run(name: str, field: str, kind: str, bodies: int, **changes: float) -> Exceeded:
    tuning = replace(config.TUNINGS[name], **changes)
    return levels.run(trust.compile_estimator(tuning, name), tuning, field, kind, bodies, name)


@pytest.mark.whole
@pytest.mark.parametrize("kind", levels.KINDS)
@pytest.mark.parametrize("field", NOT_OWN)
def test_of_four_sensors_the_level_is_exceeded_with_the_promised_risk(field: str, kind: str) -> None:
    """The share of the valid samples keeps it, and the interval of one sample of each body does not exclude it."""
    promised = config.PROMISES[config.NAME].exceeded
    exceeded = run(config.NAME, field, kind, round(10 / promised))
    assert exceeded.share < promised and lower_bound(exceeded) < promised


def lower_bound(of: Exceeded) -> float:
    return 1 - levels.upper_bound(of.chosen - of.exceeding, of.chosen)


def test_a_level_that_is_half_as_wide_is_found() -> None:
    """The planted defect, in the smallest ensemble that shows it."""
    assert run(config.NAME, "built", "drift", 4000, overbound=0.4).share > config.PROMISES[config.NAME].exceeded
    assert run(config.NAME, "built", "drift", 4000).share < config.PROMISES[config.NAME].exceeded


@pytest.mark.whole
@pytest.mark.parametrize("kind", levels.KINDS)
def test_of_three_calibrated_sensors_few_samples_are_valid_and_exceed_a_level(kind: str) -> None:
    promised = config.PROMISES[config.THREE].exceeded
    exceeded = run(config.THREE, "calibrated", kind, round(10 / promised))
    assert exceeded.of_all < promised and (exceeded.valid > 0.8 if kind == "none" else exceeded.valid < 0.1)


@pytest.mark.parametrize(("name", "field"), [(config.NAME, "built"), (config.THREE, "calibrated")])
def test_starts_at_rest_are_valid_as_promised(name: str, field: str) -> None:
    promise = config.PROMISES[name]
    assert np.radians(promise.yaw) <= trust.YAW
    start = cold_start.run(config.TUNINGS[name], field, 1000, promise.samples, name=name)
    assert start.valid >= promise.starts and start.wrong == 0 and start.longest <= promise.samples


def test_bounds_are_those_of_clopper_and_pearson() -> None:
    """None of n samples: 1 - 0.05^(1/n); 3 of 100: a published table."""
    assert isclose(levels.upper_bound(0, 100), 1 - 0.05 ** (1 / 100), rel_tol=1e-12)
    assert isclose(levels.upper_bound(3, 100, 0.975), 0.0852, abs_tol=1e-4) and levels.upper_bound(0, 0) == 1


def test_each_kind_changes_the_voltages_of_one_sensor() -> None:
    rng = np.random.default_rng(0)
    of = levels.world("declared", 50, rng, config.NAME, config.USUAL)
    for kind in levels.KINDS:
        corrupt, V = levels.failing(kind, of, 50, rng), of.read(trust.draw(trust.REACH, 50, rng))
        for k in range(3):
            failed = V + 1e-3 * rng.standard_normal(V.shape)
            sound = failed.copy()
            corrupt(failed, k)
            changed = ((failed != sound) & ~(np.isnan(failed) & np.isnan(sound))).any(axis=2).sum(axis=1)
            assert changed.max() <= (kind != "none")
        assert (changed.sum() > 20) == (kind != "none")
    with pytest.raises(ModelError, match="'rust' is not a kind of fault"):
        levels.failing("rust", of, 50, rng)
