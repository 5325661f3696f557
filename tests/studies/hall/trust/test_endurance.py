"""Within the derived speed and acceleration position lock is held; slightly beyond it is lost. Runs are seeded."""

from dataclasses import replace

import numpy as np
import pytest

from designs.hall_position import config
from designs.hall_position.glsdc.parameters import Tuning
from models import hall_motions as motions
from models.hall_motions import Limits
from studies.hall.trust import endurance, estimator_ensemble
from studies.hall.trust.estimator_ensemble import EstimatorConfig

pytestmark = pytest.mark.whole

TWO = EstimatorConfig(config.array())
BODIES, SAMPLES = 2000, 250


def test_the_limits_follow_from_the_largest_step_and_the_innovation_gate() -> None:
    limits = endurance.limits(TWO)
    assert limits.speed == pytest.approx(0.5 / (2 * np.pi) * 0.0508 * 800)
    assert limits.acceleration == pytest.approx(38.96, rel=1e-3)
    calm = replace(TWO, tuning=Tuning(innovation_gate_sigma=1.5, max_phase_step=0.5))
    assert endurance.limits(calm).acceleration == pytest.approx(limits.acceleration / 2)
    assert endurance.limits(calm).speed == pytest.approx(limits.speed / 2)


@pytest.mark.parametrize(("speed", "acceleration"), [(1.3, 1.0), (1.0, 3.0)])
def test_beyond_them_bodies_are_lost_and_none_is_wrong(speed: float, acceleration: float) -> None:
    limits = endurance.limits(TWO)
    beyond = Limits(speed * limits.speed, acceleration * limits.acceleration)
    run = endurance.run(TWO, BODIES, SAMPLES, beyond)
    assert run.lock_lost_share > 0.1 and run.misleading == 0


def test_two_sensors_stay_with_it_and_are_not_valid_where_they_lose_rank() -> None:
    """Nor are they until the place is certain again. A yaw that is held as loosely as the phases slips off further."""
    run = endurance.run(TWO, BODIES, SAMPLES, endurance.limits(TWO))
    assert (
        0.7 < run.valid_share < 0.85
        and run.lock_lost_share == run.misleading == 0
        and run.max_valid_error < 1e-4
        and run.max_error < 2e-4
    )
    loose, looser = (
        endurance.run(
            replace(TWO, tuning=replace(TWO.tuning, yaw_damping_ratio=ratio)), BODIES, SAMPLES, endurance.limits(TWO)
        )
        for ratio in (1.0, 0.2)
    )
    assert loose.max_error > 2 * run.max_error and looser.lock_lost_share > 0.9


def test_motions_creep_and_swing() -> None:
    """Within the limits, and half of them come close to these."""
    rng, limits, T = np.random.default_rng(0), endurance.limits(TWO), estimator_ensemble.TIME.period_s
    at = motions.random_course(TWO.array, estimator_ensemble.TIME, 400, limits, rng, endurance.MIN_LIMIT_FRACTION)
    poses = [at(k) for k in range(4000)]
    X, Y, yaw = (np.array([getattr(p, name) for p in poses]) for name in ("X", "Y", "yaw"))
    speed = np.abs(np.diff(X, axis=0)).max(axis=0) / T
    size = np.hypot(np.diff(X, 2, axis=0), np.diff(Y, 2, axis=0)).max(axis=0) / T**2
    assert speed.max() <= limits.speed and (speed > 0.7 * limits.speed).mean() > 0.4
    assert size.max() <= 1.001 * limits.acceleration and (size > 0.6 * limits.acceleration).mean() > 0.4
    assert speed.min() < 0.01 and (speed < 0.1).mean() > 0.1
    assert limits.yaw == pytest.approx(0.95 * np.radians(2.5)) and 0.9 * limits.yaw < np.abs(yaw).max() <= limits.yaw


def test_the_checks_tell_a_body_that_is_lost(monkeypatch: pytest.MonkeyPatch) -> None:
    kind = EstimatorConfig(TWO.array)
    sound = endurance.checks("two", kind, 500, 50)
    assert all(c.passed for c in sound) and [c.value for c in sound[:2]] == [0, 0] and "25000 samples" in sound[0].about
    limits = endurance.limits(kind)
    monkeypatch.setattr(endurance, "limits", lambda of: Limits(limits.speed, 3 * limits.acceleration))
    assert not endurance.checks("two", kind, 500, 50)[0].passed
