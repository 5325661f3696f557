"""Report text: Markdown with placeholders is merged with the sections; unknown placeholders are refused by name."""

import pytest

from synth.errors import DesignError
from synth.report import page, prose
from synth.report.equations import mathml
from synth.report.page import Prose, Section
from synth.show import Table

TABLE = Table("Extra", ("a",), ((1.0,),))
VALUES = {"plant.G": 9.81, "count": 3, "who": "a*b_c", "extra": TABLE}
TEXT = """The stage.

# Model
Gravity is {{ plant.G }} m/s², to one digit {{ plant.G:.1f }}.

{{ extra }}

After it.

# Our own
Words.

## Inner
More words of *{{ who }}*.

# Files
Hashes.
"""


def sections() -> tuple[Section, ...]:
    return (Section("Model", (page.Text("standard"),)), Section("Verification"), Section("Files"))


def test_text_precedes_the_section_of_its_title_or_makes_a_new_one() -> None:
    words = prose.parse(TEXT, VALUES)
    placed = prose.merge(sections(), words.parts)
    assert [s.title for s in placed] == ["Model", "Our own", "Verification", "Files"]
    first, table, after, standard = placed[0].blocks
    assert isinstance(first, Prose) and "Gravity is 9.81 m/s², to one digit 9.8." in first.html and table is TABLE
    assert isinstance(after, Prose) and standard == page.Text("standard")
    assert [s.title for s in placed[1].sections] == ["Inner"] and "<em>a*b_c</em>" in placed[1].sections[0].blocks[
        0
    ].html
    assert isinstance(words.blocks[0], Prose) and "The stage." in words.blocks[0].html


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("{{ plant.g }}", r"asks for \{\{ plant.g \}\}.*there are count, extra, plant.G, who"),
        ("A {{ mass }} of it.", "asks for"),
        ("The {{ extra }} here.", r"block \{\{ extra \}\} inside a sentence"),
        ("It is {{ who:.3f }} m.", "use a format that suits"),
    ],
)
def test_a_placeholder_that_cannot_be_filled_is_refused(text: str, message: str) -> None:
    with pytest.raises(DesignError, match=message):
        prose.parse(f"# Model\n{text}", VALUES)


def test_markup_in_prose_is_shown_as_text_and_nothing_is_loaded() -> None:
    block = prose.render_markdown("<script>x</script> ![a](https://example.org/a.png) **b**")
    assert "<script>" not in block.html and "<img" not in block.html and "<strong>b</strong>" in block.html
    linked = page.Report("t", "a", (Section("s", (prose.render_markdown("[b](https://example.org)"),)),))
    with pytest.raises(DesignError, match=r"would load https://example\.org"):
        page.render(linked)


def test_a_title_inside_code_is_no_title() -> None:
    words = prose.parse("# Model\n```\n# no title\n```\n", {})
    assert [p.title for p in words.parts] == ["Model"] and "# no title" in words.parts[0].blocks[0].html  # type: ignore[union-attr]


def test_names_are_written_as_in_equations() -> None:
    block = prose.render_markdown("The spring $k_s_phi$ costs 3 $ and $F_V1$ *pulls*.")
    assert mathml.symbol("k_s_phi") in block.html and mathml.symbol("F_V1") in block.html and "3 $ and" in block.html
