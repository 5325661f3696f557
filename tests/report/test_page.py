"""The page is self-contained, shows every failed check, and escapes every text."""

import math
import re
from collections.abc import Callable
from html.parser import HTMLParser

import pytest

from synth.check import Check
from synth.errors import DesignError
from synth.report import notation, page, sections
from synth.report.page import Checks, Equations, Figure, Report, Section, Text
from synth.show import Table
from synth.simulate.experiments import Experiment
from synth.verify.agree import Agreement

GOOD, BAD = Check("overshoot", 0.118, 0.2, "1", "of the step"), Check("t_s", 2.4, 2.2, "s")
SVG = '<svg xmlns="http://www.w3.org/2000/svg" width="10pt" viewBox="0 0 1 1"><g id="a-1"/></svg>'
EVIL = "<script>alert('x')</script>&\"<b>"
VOID = {"meta", "br", "link", "img", "use", "path", "g", "input"}


def report(*checks: Check, svg: str = SVG) -> Report:
    inner = Section("Step", (Checks("Limits", checks),))
    blocks = (Text("One.\n\nTwo."), Equations((("F(2)", "F_V = -Kv_1"),)), Table("Gains", ("K",), ((1.5,),)))
    first = Section("The model", (*blocks, Figure(svg, "drawn", "the paper's")))
    return Report("Stage", "A stage.", (first, Section("Runs", (), (inner,))), (("period", "1 ms"),))


class Tags(HTMLParser):
    """Checks that every element is closed in order."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        pass

    def handle_endtag(self, tag: str) -> None:
        if tag not in VOID:
            assert self.open.pop() == tag


def test_the_page_is_one_whole_document() -> None:
    html = page.render(report(GOOD, BAD))
    tags = Tags()
    tags.feed(html)
    assert not tags.open and html.startswith("<!DOCTYPE html>") and html.count("<svg") == 1
    assert all(text in html for text in ("<p>One.</p>", "<p>Two.</p>", "Figure 1. drawn", "Table 1. Gains", "1 ms"))


def test_the_page_is_the_same_each_time() -> None:
    assert page.render(report(GOOD)) == page.render(report(GOOD))


def test_every_link_leads_to_a_heading() -> None:
    html = page.render(report(GOOD, BAD))
    targets = re.findall(r'<a href="#([^"]+)"', html)
    assert set(targets) == {"s1", "s2", "s2-1"}
    assert set(targets) <= set(re.findall(r' id="([^"]+)"', html))


@pytest.mark.parametrize(
    "planted",
    [
        '<image href="https://example.org/a.png"/>',
        '<image xlink:href="http://example.org/a.png"/>',
        '<image href="//example.org/a.png"/>',
        '<image href="figures/a.png"/>',
        '<script src="https://example.org/a.js"></script>',
        '<a href="https://example.org/">x</a>',
        '<rect style="fill: url(https://example.org/a.svg#b)"/>',
        "<rect fill=\"url('https://example.org/a.svg#b')\"/>",
        '<style>@import "https://example.org/a.css";</style>',
        "<style>@font-face { src: url(a.woff2) }</style>",
    ],
)
def test_external_content_is_refused(planted: str) -> None:
    with pytest.raises(DesignError, match=r"would load .*(example|a\.)"):
        page.render(report(GOOD, svg=SVG.replace("</svg>", planted + "</svg>")))


def test_embedded_content_is_accepted() -> None:
    inside = '<use href="#a-1"/><rect fill="url(#a-1)"/><image href="data:image/png;base64,AAAA"/></svg>'
    assert page.external_addresses(page.render(report(GOOD, svg=SVG.replace("</svg>", inside)))) == ()


def test_a_failed_check_comes_first_in_red_and_is_in_the_contents_and_its_table() -> None:
    html = page.render(report(GOOD, BAD))
    screen, contents, rest = re.split("<nav|</nav>", html)
    assert '<strong class="bad">1 of 2 requirements missed; 0 values without a limit' in screen
    assert 'class="summary failed"' in screen
    first, second = re.findall(r"<tr.*</tr>", screen)[1:]
    assert first.startswith('<tr class="failed"><td><span class="bad">✗</span> <a href="#s2-1">t_s</a></td>')
    cells = ("2.4 s", "at most 2.2 s", "missed by 9.1 %", "")
    assert re.findall(r"<td>([^<]*)</td>", first) == list(cells) and "falls short" not in html
    assert second.startswith('<tr><td><a href="#s2-1">overshoot</a></td><td>0.118</td><td>at most 0.2</td>')
    assert contents.count('<span class="bad">✗ 1 failed</span>') == 2
    assert rest.count('<tr class="failed">') == 1 and rest.count('<span class="bad">✗ fail</span>') == 1
    assert rest.count('<span class="good">✓ pass</span>') == 1
    assert re.search(r"\.bad \{[^}]*var\(--bad\)", screen) and "--bad: #b00020" in screen


def test_no_failure_is_shown_where_there_is_none() -> None:
    html = page.render(report(GOOD))
    assert '<strong class="good">all 1 requirements kept' in html and "✗" not in html and 'failed"' not in html


def test_a_value_without_a_limit_is_counted_and_says_so() -> None:
    free = (Check("cost", 900.0, math.inf, "1"), Check("disk margin", 0.3, -math.inf, "1", at_least=True))
    html = page.render(report(GOOD, *free))
    assert "all 1 requirements kept; 2 values without a limit" in html and html.count("<td>no limit</td>") >= 2


def test_nan_fails() -> None:
    html = page.render(report(Check("margin", math.nan, 1.0, "s")))
    assert 'class="summary failed"' in html and "<td>no number" in html and "<td>not measured</td>" in html


def test_many_checks_that_pass_are_collapsed_and_the_failed_one_is_not() -> None:
    many = [Check(f"agreement {k}", 1e-9 * k, 1e-6, "1") for k in range(300)]
    screen, rest = page.render(report(*many, BAD)).split("<nav")
    assert screen.count("<tr") == 3 and "Step: 300 checks; least margin: agreement 299" in screen
    shown, collapsed = rest.split("<details>")
    assert "Limits: 300 that pass" in collapsed and "agreement 7<" in collapsed and "agreement" not in shown
    assert shown.count('<tr class="failed">') == 1


def test_text_is_shown_as_text() -> None:
    blocks = (
        Text(EVIL),
        Equations(((EVIL, EVIL),)),
        Table(EVIL, (EVIL,), ((EVIL,),)),
        Figure(SVG, EVIL, EVIL),
        Checks(EVIL, (Check(EVIL, 2.0, 1.0, "1", EVIL),)),
    )
    html = page.render(Report(EVIL, EVIL, (Section(EVIL, blocks),), ((EVIL, EVIL),)))
    assert "<script" not in html and "<b>" not in html
    assert html.count("&lt;script&gt;") >= 14


def test_two_figures_with_the_same_ids_are_refused() -> None:
    blocks = (Figure(SVG, "one"), Figure(SVG, "two"))
    with pytest.raises(DesignError, match="a-1 are used twice"):
        page.render(Report("r", "", (Section("s", blocks),)))


def test_a_figure_without_svg_is_refused() -> None:
    with pytest.raises(DesignError, match="one whole <svg>"):
        page.render(report(GOOD, svg="<img>"))


def test_a_row_that_does_not_fit_its_columns_is_refused() -> None:
    with pytest.raises(DesignError, match="2 cells for 1 columns"):
        Table("t", ("a",), ((1.0, 2.0),))


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.118271, "0.1183"),
        (-26.5, "−26.5"),
        (35719.4, "35\u202f719"),
        (100000, "100\u202f000"),
        (875400.0, "875\u202f400"),
        (3.04e-14, "3.04·10⁻¹⁴"),
        (2.5e9, "2.5·10⁹"),
        (0.0, "0"),
        (math.inf, "∞"),
        (-math.inf, "−∞"),
        (math.nan, "no number"),
        ("as it is", "as it is"),
    ],
)
def test_numbers_are_written_for_readers(value: float | str, text: str) -> None:
    assert notation.number(value) == text


@pytest.mark.parametrize(
    ("values", "unit", "texts"),
    [
        ((7.4517e-07, 5e-5), "m", ("0.7452 µm", "50 µm")),
        ((0.0181, 0.001), "m", ("18.1 mm", "1 mm")),
        ((2.19e-5, 2.5e-5), "rad", ("21.9 µrad", "25 µrad")),
        ((1.83, 2.2), "s", ("1.83 s", "2.2 s")),
        ((4.94975, 4.950), "A rms", ("4.94975 A rms", "4.95 A rms")),
        ((0.118, 0.2), "1", ("0.118", "0.2")),
        ((0.0, 0.0), "m", ("0 m", "0 m")),
        ((math.inf, 2.2), "s", ("∞ s", "2.2 s")),
        ((1.5, 1.0), "m/s^2", ("1.5 m/s²", "1 m/s²")),
    ],
)
def test_quantities_share_a_prefix_and_differ_where_they_differ(
    values: tuple[float, ...], unit: str, texts: tuple[str, ...]
) -> None:
    assert notation.quantities(values, unit) == texts


def test_equations_are_lowered_raised_and_escaped() -> None:
    html = str(notation.equation("F_V' = -Kv_1 e^{-k g} csch^2 x < θ_{ref}"))
    assert html == (
        "<i>F</i><sub><i>V</i></sub>′ = −<i>Kv</i><sub>1</sub> <i>e</i><sup>−<i>k</i> <i>g</i></sup> "
        "csch<sup>2</sup> <i>x</i> &lt; <i>θ</i><sub><i>ref</i></sub>"
    )


def test_an_experiment_becomes_a_section(run: Callable[..., Experiment]) -> None:
    section = sections.experiment(run((GOOD, BAD)), {"y": "m", "theta": "rad"}, window=(0.0, 8.0), published="Fig. 7")
    figure, measured, checks = section.blocks
    assert isinstance(figure, Figure) and figure.published == "Fig. 7" and "0 to 8 s" in figure.caption
    assert isinstance(measured, Table) and measured.rows == (("mean |e_y|", 1.25, "µm"), ("overshoot", 0.118, ""))
    assert isinstance(checks, Checks) and tuple(section.checks()) == (GOOD, BAD)
    html = page.render(Report("r", "", (section,)))
    assert len(html) < 400_000 and "1 failed" in html


def test_agreements_and_files_become_tables() -> None:
    table = sections.agreements([Agreement("reference", "c64", "random", 1000, 3e-14, "i_d1", 7, 12.0, 2, 1e-15, "xi")])
    assert table.rows == (("random", 1000, "reference", "c64", 3e-14, "i_d1", 7, 12.0, 2, 1e-15, "xi"),)
    digest = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"  # FIPS 180-2, appendix B.1
    assert sections.files({"abc.c": "abc"}).rows == (("abc.c", 3, digest),)
