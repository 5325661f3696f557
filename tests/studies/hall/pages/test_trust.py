"""The report's parts on basins, cold starts and motions show what was found."""

from functools import cache

import numpy as np
import pytest
from matplotlib.figure import Figure

from designs.hall_position import config
from designs.hall_position.glsdc import estimator
from models import hall_two_waves
from models.hall_motions import Pose
from studies.hall.pages import trust
from studies.hall.trust import endurance, estimator_ensemble, failures, starts
from studies.hall.trust.estimator_ensemble import EstimatorConfig
from synth.block import unranged
from synth.emit import write
from synth.execute import host
from synth.report.prose import Content, Rows
from synth.show import Table
from synth.simulate import sampling

pytestmark = pytest.mark.whole

TWO = {config.NAME: trust.estimators()[config.NAME]}


@cache
def with_libm(kind: EstimatorConfig) -> host.Controller:
    """Return the same C with sines of libm, which is emitted in a tenth of the time."""
    files = write.emit(
        unranged(estimator.guarded_estimator(kind.array, estimator_ensemble.TIME, kind.tuning)), np.float32, libm=True
    )
    return host.load(files.files, files.manifest)


@pytest.fixture(autouse=True)
def small(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(estimator_ensemble, "compile_estimator", with_libm)
    for name, value in {
        "RADIUS_POINTS": 6,
        "BODIES": 400,
        "SAMPLES": 20,
        "STARTS": 4,
        "COLD_SAMPLES": 60,
        "MOVING_BODIES": 20,
        "MOTION_SAMPLES": 40,
    }.items():
        monkeypatch.setattr(trust, name, value)


def rows_of(block: Content) -> Rows:
    return block.rows if isinstance(block, Table) else block  # type: ignore[return-value]


def test_the_basin_is_shown_as_it_is() -> None:
    blocks = trust.basins(TWO)
    (kind,) = TWO.values()
    basin = starts.basin(kind, 400, trust.YAW, 20)
    rows = zip(rows_of(blocks["trust.basins"]), [*basin.first, *basin.last], strict=True)
    for k, (row, expected) in enumerate(rows):
        assert row[:2] == ("two sensors", 1 if k < len(basin.displacement) else 20)
        assert row[3:] == pytest.approx(tuple(100 * expected))
    assert rows_of(blocks["trust.wrong"]) == [("two sensors", basin.samples, basin.misleading)]
    assert isinstance(blocks["trust.capture_radius"], Figure)


def test_what_is_valid_and_wrong_is_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    """With deviations that count as wrong from a tenth on, most valid samples are."""
    monkeypatch.setattr(sampling, "WRONG", 0.1)
    assert float(rows_of(trust.basins(TWO)["trust.wrong"])[0][2]) > 10


def test_cold_starts_are_shown_as_they_are() -> None:
    row = rows_of(trust.cold_starts(TWO)["trust.cold_starts"])[0]
    (kind,) = TWO.values()
    grid = Pose(*hall_two_waves.poses(kind.array.pitch, 4, trust.YAWS))
    scores = starts.cold_start(kind, grid, 60)
    took = scores.first_valid
    assert row[1:3] == pytest.approx((100 * scores.is_correct[-1].mean(), 100 * (took > 0).mean()))
    assert row[4] == pytest.approx(1.25 * took.max())


def test_motion_is_within_the_limits_that_are_derived() -> None:
    (kind,) = TWO.values()
    row = trust._motion(config.NAME, kind)
    within = endurance.limits(kind)
    assert row[1:4] == (within.speed, within.acceleration, 800)
    assert row[6] == 0


def test_failures_are_shown_as_they_are(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(trust, "FAILURE_BODIES", 20)
    monkeypatch.setattr(trust, "FAILURE_POINTS", 6)
    rows = trust.failure_rows(TWO)
    (kind,) = TWO.values()
    outcomes = [failures.run_failure(kind, "dead", sensor, 20, None, sensor) for sensor in (1, 2)]
    row = next(r for r in rows if r[1:3] == ("dead", "at rest"))
    assert len(rows) == 2 * len(failures.FAILURES)
    assert row[4] == pytest.approx(50 * sum(f.flagged for f in outcomes))
    assert row[6] == max(f.delay for f in outcomes) and row[7] == pytest.approx(
        100 * max(f.misleading for f in outcomes)
    )
    assert sum("not flagged" in axes.get_title() for axes in trust._undetected_error_map(kind).axes) == 2


def test_a_failure_that_is_not_flagged_is_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    """A sensor that fails as nobody sees is flagged in no body that rests."""
    monkeypatch.setattr(trust, "FAILURE_BODIES", 20)
    monkeypatch.setattr(failures, "FAILURES", {"none": lambda now, before: now})
    rows = trust.failure_rows(TWO)
    assert rows[0][1:3] == ("none", "at rest") and float(rows[0][3]) == 0 and float(rows[0][5]) > 80
