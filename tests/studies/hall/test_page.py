"""The page of the studies: all parts are present, and their numbers are right."""

import re
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from designs.hall_position.paper import fisher
from models.hall_stage import Stage, grid
from studies.hall import costs, layout_accuracy, page
from studies.hall.costs import Row
from studies.hall.pages import accuracy, integrity, six, trust
from synth.check import Check
from synth.report.page import Section, Text
from synth.report.prose import Content, Rows
from synth.show import Table

pytestmark = pytest.mark.whole

STAGE = Stage()
REPORT = Path(page.__file__).with_name("report.md").read_text(encoding="utf-8")
MOST = 2_000_000  # bytes of a page
# What several tests look at, of few places: computed once.
ACCURACY, SIX = cache(accuracy.blocks), cache(six.section)


@pytest.fixture
def coarse(monkeypatch: pytest.MonkeyPatch) -> None:
    """Draw maps of few places."""
    for name, value in {"POINTS": 12, "CURVE_POINTS": 6, "CURVE_YAWS": 5, "SINGULAR_YAWS": (5.0,)}.items():
        monkeypatch.setattr(accuracy, name, value)
    monkeypatch.setattr(six, "POINTS", 8)
    monkeypatch.setattr(accuracy, "BASIN_STARTS", 5)
    monkeypatch.setattr(accuracy, "blocks", ACCURACY)
    monkeypatch.setattr(six, "section", SIX)
    absent = dict.fromkeys(set(re.findall(r"(?:trust|failures)\.\w+", REPORT)), 0.0)
    monkeypatch.setattr(trust, "blocks", lambda of: absent)  # which compiles two estimators: see test_page_trust
    measured = dict.fromkeys(set(re.findall(r"integrity\.\w+", REPORT)), 0.0)
    monkeypatch.setattr(integrity, "blocks", lambda: measured)  # which calibrates: see calibrated/test_calibrated


def rows_of(block: Content) -> Rows:
    assert isinstance(block, list)
    return block


def tables(section: Section) -> dict[str, Table]:
    """Return the tables of a section and of those inside by caption."""
    by_caption = {b.caption: b for b in section.blocks if isinstance(b, Table)}
    for inner in section.sections:
        by_caption |= tables(inner)
    return by_caption


@pytest.mark.usefixtures("coarse")
def test_every_part_is_there() -> None:
    row, check = Row("3 sensors", "gcc -O2", 600, 3795, 7225), Check("cold starts a pitch off", 0.0, 0.0, "1")
    html = page.report({"calibrated units": (check,)}, [], {}, (row,))
    assert len(html.encode()) < MOST and html.count("<svg") == len(set(re.findall(r"Figure (\d+)\.", html)))
    for text in ("lose rank", "GLSDC", "Six degrees", "shipped one weights its prediction more", check.name):
        assert text in html, text
    assert not re.search(r"\bnan\b|>no number<", html)
    titles = [html.rindex(t) for t in ("Cost of three and four sensors", page.CHECKS)]
    assert titles == sorted(titles) and "3\u202f795" in html


def test_without_an_emulator_no_cost_is_shown() -> None:
    assert costs.section(()).blocks == (Text(costs.ABSENT),)


def test_the_map_is_that_of_the_deviations(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(accuracy, "POINTS", 6)
    shown = accuracy._larger_deviation(STAGE.three, 0.1)
    along = STAGE.pitch * (np.arange(6) + 0.5) / 6
    for i, j in ((0, 0), (2, 5), (4, 1)):
        expected = fisher.deviations(STAGE.three, np.array([[along[i]], [along[j]], [0.1]]))[:2].max()
        assert shown[i, j] == pytest.approx(expected, rel=1e-12)
    assert grid(STAGE.three, 6).shape == (3, 36)


@pytest.mark.usefixtures("coarse")
def test_the_tables_tell_what_is_proved_and_where_rank_is_lost() -> None:
    blocks = accuracy.blocks(STAGE)
    worst = {row[0]: row[2:] for row in rows_of(blocks["accuracy.worst"])}
    assert worst["third sensor added"][:3] == ("5.28", "5.308", "198")
    for name, proved in worst.items():
        if name != "two sensors":
            assert all(float(a) <= float(b) for a, b in zip(proved[:3], proved[3:], strict=True))
    assert rows_of(blocks["accuracy.singular"])[0][:2] == (5.0, 40)


@pytest.mark.usefixtures("coarse")
def test_the_page_says_that_three_sensors_lose_rank_in_six_degrees_of_freedom() -> None:
    section = six.section(STAGE)
    assert all(row[3] == "on lines" for row in rows_of(six.blocks(STAGE)["six.determinants"]))
    of = six.optimised_layout(STAGE, 4)
    expected = 1e6 * layout_accuracy.conditions(of, 8)[layout_accuracy.LEVEL].deviations.max(axis=0)
    shown = tables(section.sections[0])["Largest standard deviations over the pitch under conditions"].rows[0]
    assert shown[1:7] == pytest.approx(tuple(expected))


def test_the_basin_is_whole_where_the_yaw_is_known_and_has_holes_where_it_is_not(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(accuracy, "BASIN_STARTS", 9)
    known, free = (accuracy.basin(STAGE.pair, yaw_known) for yaw_known in (True, False))
    middle = slice(2, 7)  # a quarter pitch to either side
    assert known[middle, middle].min() == 1 and known[0].max() < 1
    assert free[4, 4] == 1 and free[middle, middle].mean() < 0.8 and (free <= known + 1e-9).mean() > 0.9
