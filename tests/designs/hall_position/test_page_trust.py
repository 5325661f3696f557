"""The report's parts on basins, cold starts and motions show what was found."""

from functools import cache

import numpy as np
import pytest

from designs.hall_position import page_failures, page_trust, shipped
from designs.hall_position.glsdc import estimator
from designs.hall_position.trust import basin, cold_start, endurance, failures, fleet
from designs.hall_position.trust.fleet import Kind
from synth.emit import write
from synth.execute import host
from synth.report.page import Figure, Section, Table

TWO = {shipped.NAME: page_trust.kinds()[shipped.NAME]}


@cache
def with_libm(kind: Kind) -> host.Controller:
    """Return the same C with sines of libm, which is emitted in a tenth of the time."""
    made = write.emit(estimator.guarded(kind.array, kind.time, kind.tuning), np.float32, libm=True)
    return host.load(made.files, made.manifest)


@pytest.fixture(autouse=True)
def small(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(fleet, "compiled", with_libm)
    for name, value in {
        "POINTS": 6,
        "BODIES": 400,
        "SAMPLES": 20,
        "STARTS": 4,
        "WAIT": 60,
        "MOVING": 20,
        "LONG": 40,
    }.items():
        monkeypatch.setattr(page_trust, name, value)


def tables(section: Section) -> list[Table]:
    return [b for b in section.blocks if isinstance(b, Table)]


def test_the_basin_is_shown_as_it_is() -> None:
    section = page_trust.convergence(TWO)
    first, then, wrong = tables(section)
    (kind,) = TWO.values()
    found = basin.mapped(kind, 400, page_trust.YAW, 20)
    for table, shares in ((first, found.first), (then, found.then)):
        for row, expected in zip(table.rows, shares, strict=True):
            assert row[1:] == pytest.approx(tuple(100 * expected))
    assert wrong.rows == (("two sensors", found.samples, found.wrong),)
    assert sum(isinstance(b, Figure) for b in section.blocks) == 1


def test_what_is_valid_and_wrong_is_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    """With deviations that count as wrong from a tenth on, most valid samples are."""
    monkeypatch.setattr(fleet, "WRONG", 0.1)
    *_, wrong = tables(page_trust.convergence(TWO))
    assert float(wrong.rows[0][2]) > 10


def test_cold_starts_are_shown_as_they_are() -> None:
    (table,) = tables(page_trust.cold_starts(TWO))
    (kind,) = TWO.values()
    grid = cold_start.grid(kind, 4, np.array([-page_trust.YAW, 0.0, page_trust.YAW]))
    found = cold_start.run(kind, grid, 60)
    assert table.rows[0][1:3] == pytest.approx((100 * found.found.mean(), 100 * found.valid))
    assert table.rows[0][4] == pytest.approx(1.25 * found.took.max())


def test_motion_is_within_the_limits_that_are_derived() -> None:
    (table,) = tables(page_trust.motion(TWO))
    (kind,) = TWO.values()
    within = endurance.limits(kind)
    assert table.rows[0][1:4] == (within.speed, within.acceleration, 800)
    assert table.rows[0][6] == 0


def test_failures_are_shown_as_they_are(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(page_failures, "BODIES", 20)
    monkeypatch.setattr(page_failures, "POINTS", 6)
    section = page_failures.section(TWO)
    (table,) = tables(section)
    (kind,) = TWO.values()
    found = [failures.tried(kind, "dead", sensor, 20, None, sensor) for sensor in (1, 2)]
    row = next(r for r in table.rows if r[:2] == ("dead", "at rest"))
    assert len(table.rows) == 2 * len(failures.FAILURES)
    assert row[3] == pytest.approx(50 * sum(f.flagged for f in found))
    assert row[4] == max(f.late for f in found) and row[7] == pytest.approx(100 * max(f.away for f in found))
    (figure,) = (b for b in section.blocks if isinstance(b, Figure))
    assert figure.svg.count("unseen") >= 2


def test_a_failure_that_is_not_flagged_is_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    """A sensor that fails as nobody sees is flagged in no body that rests."""
    monkeypatch.setattr(page_failures, "BODIES", 20)
    monkeypatch.setattr(failures, "FAILURES", {"none": lambda now, before: now})
    (kind,) = TWO.values()
    rows = page_failures._table("two", kind).rows
    assert rows[0][:2] == ("none", "at rest") and float(rows[0][2]) == 0 and float(rows[0][6]) > 80
