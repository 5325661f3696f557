"""The first screen: what fails comes first and in red, in the page and at the terminal, in plain words."""

import io
import math
import re

import pytest
from rich.console import Console

from synth.app import tables
from synth.check import Check
from synth.report import first_screen

PHASE = Check("phase margin", 32.6, 35.0, "degrees", "at z, mid", at_least=True)
DELAY = Check("delay margin", 3.6e-3, 3.5e-3, "s", at_least=True)
FREE = Check("disk margin", 0.3, -math.inf, "1", at_least=True)
STEPS = [Check(f"random steps {k}", k * 1e-12, 1e-9, "of range", "c64") for k in range(1, 100)]
OVERSHOOTS = [Check("overshoot", value, 0.2, "1", f"step {value}") for value in (0.1, 0.19, 0.05)]
GROUPS = (
    ("Loops and margins", [DELAY, PHASE, FREE]),
    ("Experiments", OVERSHOOTS),
    ("Verification", STEPS),
)
PAGE = '<body><section id="first-screen">old</section><h2 id="s4">4 Loops and margins</h2></body>'


def planted() -> tuple[first_screen.Row, ...]:
    return first_screen.rows(GROUPS)


def sound() -> tuple[first_screen.Row, ...]:
    return first_screen.rows([("Loops and margins", [DELAY, FREE]), *GROUPS[1:]])


def test_every_check_is_in_one_row_and_what_fails_comes_first() -> None:
    rows = planted()
    assert [row.worst.name for row in rows[:3]] == ["phase margin", "delay margin", "disk margin"]
    assert rows[0].cells == ("phase margin", "32.6 degrees", "at least 35 degrees", "missed by 6.9 %", "at z, mid")
    assert rows[1].cells[1:4] == ("3.6 ms", "at least 3.5 ms", "2.9 % left") and rows[2].cells[2] == "no limit"
    assert rows[3].cells[0] == "overshoot, worst of 3" and rows[3].cells[4] == "step 0.19"
    assert rows[4].cells[0] == "Verification: 99 checks; least margin: random steps 99" and len(rows) == 5
    checks = [id(c) for row in rows for c in row.checks]
    assert sorted(checks) == sorted(id(c) for _, each in GROUPS for c in each)
    assert first_screen.counts(rows) == (104, 1, 1)


def test_a_failed_check_among_many_has_a_row_of_its_own() -> None:
    rows = first_screen.rows([("Verification", [*STEPS, Check("random steps 100", 1e-8, 1e-9, "of range")])])
    assert [row.worst.passed for row in rows] == [False, True] and len(rows[1].checks) == 99


@pytest.mark.parametrize(
    ("check", "text"),
    [
        (Check("a", 0.0, 0.0, "1"), ""),
        (Check("a", 2.0, 0.0, "1"), "missed"),
        (Check("a", math.nan, 1.0, "1"), "not measured"),
        (Check("a", 2.0, math.inf, "1"), ""),
        (Check("a", -3.0, -2.0, "1"), "50 % left"),
        (Check("a", 9.4e-5, 0.05, "1"), "100 % left"),
        (Check("a", 0.9976, 1.0, "1"), "0.24 % left"),
        (Check("a", 0.5, 1.0, "1", at_least=True), "missed by 50 %"),
        (Check("a", math.inf, 0.5, "s"), "missed"),
        (Check("a", 30.0, 10.0, "s"), "missed, 3 times the limit"),
    ],
)
def test_a_margin_is_said_in_words(check: Check, text: str) -> None:
    assert first_screen.margin_text(check) == text


def test_the_page_shows_the_rows_in_the_place_of_its_own_with_links_and_versions() -> None:
    html = first_screen.put(PAGE, planted(), "synth 1.0, sources 0123456789ab")
    assert "old" not in html and html.count('id="first-screen"') == 1 and "synth 1.0, sources 0123456789ab" in html
    assert 'class="summary failed"' in html and "1 of 104 requirements missed; 1 value without a limit" in html
    first = re.findall("<tr.*</tr>", html)[1]
    assert first.startswith('<tr class="failed">') and '<a href="#s4">phase margin</a>' in first
    assert "falls short" not in html
    green = first_screen.put(PAGE, sound(), "")
    assert "failed" not in green and '<strong class="good">all 103 requirements kept; 1 value without' in green
    assert first_screen.put("a page", planted(), "").endswith("a page"), "a page without a place loses no verdict"


@pytest.mark.parametrize("width", [80, 100])
def test_the_terminal_shows_the_rows_that_fail_first_and_red(width: int, monkeypatch: pytest.MonkeyPatch) -> None:
    text = printed({"stage": planted()}, width, monkeypatch)
    lines = text.splitlines()
    assert max(len(re.sub(r"\x1b\[[0-9;]*m", "", line)) for line in lines) <= width
    assert "\x1b[1;31m" in lines[4] and "phase margin" in lines[4] and "32.6 degrees" in re.sub(r"\s+", " ", text)
    assert text.index("phase margin") < text.index("delay") and "no limit" in text
    assert "31m" not in printed({"stage": sound()}, width, monkeypatch)


def test_of_several_designs_the_terminal_shows_the_worst_rows(monkeypatch: pytest.MonkeyPatch) -> None:
    text = printed({"first": planted(), "second": sound()}, 100, monkeypatch)
    assert text.count("first") == 1 and text.count("second") == 1 and text.count("\x1b[1;31m") >= 1
    assert "disk margin" not in text and text.count("delay margin") == 2


def printed(screens: dict[str, tuple[first_screen.Row, ...]], width: int, monkeypatch: pytest.MonkeyPatch) -> str:
    out = io.StringIO()
    options = {"file": out, "force_terminal": True, "color_system": "standard", "no_color": False}
    monkeypatch.setattr(tables, "Console", lambda **_: Console(**options, width=width))
    tables.print_first_screen(screens)
    return out.getvalue()
