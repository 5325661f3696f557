"""Report page: sections of blocks, rendered as one self-contained HTML file.

A Report is data. `render` numbers its figures and tables, and puts the first screen of its checks at the top.
All text is escaped; only the <svg> of a Figure is markup. A page that would load external content is refused.
"""

import re
from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from html.parser import HTMLParser
from importlib import resources
from itertools import chain

import jinja2
from markupsafe import Markup

from synth.check import Check
from synth.errors import DesignError
from synth.report import first_screen, notation
from synth.show import Table

MANY = 12  # checks of a table, of which the passed ones of a longer one are collapsed
_LOADS = {"src", "srcset", "href", "xlink:href", "data", "poster", "action", "formaction", "background"}
_STYLE_LOADS = re.compile(r"url\(\s*['\"]?([^'\")]*)|@import\s+['\"]?([^'\";]*)")


@dataclass(frozen=True)
class Text:
    """Paragraphs, separated by empty lines."""

    text: str

    @property
    def paragraphs(self) -> tuple[str, ...]:
        """The paragraphs, each as one line."""
        return tuple(" ".join(p.split()) for p in re.split(r"\n\s*\n", self.text) if p.strip())


@dataclass(frozen=True)
class Equations:
    """Displayed equations: the tag, such as F(12), and the text in the syntax of notation.equation."""

    rows: tuple[tuple[str, str], ...]


@dataclass(frozen=True)
class Formula:
    """A derived equation as MathML, its unit and range.

    For equations of equal form, `replaced_names` is markup that states which names replace which.
    """

    math: Markup
    unit: str = ""
    range: str = ""
    replaced_names: str = ""


@dataclass(frozen=True)
class Formulas:
    """Derived equations under a title; `equal_forms` lists groups of equal form with their replaced names."""

    title: str
    rows: tuple[Formula, ...]
    equal_forms: tuple[tuple[str, Markup], ...] = ()


@dataclass(frozen=True)
class Figure:
    """A drawing as one <svg> element; `published` describes the corresponding figure of the source, if any."""

    svg: str
    caption: str
    published: str = ""


@dataclass(frozen=True)
class Prose:
    """Text as HTML, from Markdown by `prose.render_markdown`."""

    html: Markup


@dataclass(frozen=True)
class Folded:
    """Equations and tables in a collapsible section; printed pages show them."""

    title: str
    blocks: tuple[Formulas | Table, ...]


@dataclass(frozen=True)
class Checks:
    """Measured values with their limits."""

    caption: str
    checks: tuple[Check, ...]


Block = Text | Prose | Equations | Formulas | Table | Figure | Folded | Checks


@dataclass(frozen=True)
class Section:
    """A titled section: blocks, then subsections."""

    title: str
    blocks: tuple[Block, ...] = ()
    sections: tuple["Section", ...] = ()

    def checks(self) -> Iterator[Check]:
        """Yield the checks of this section and its subsections, in reading order."""
        yield from chain.from_iterable(b.checks for b in self.blocks if isinstance(b, Checks))
        yield from chain.from_iterable(s.checks() for s in self.sections)


@dataclass(frozen=True)
class Report:
    """A whole report; `facts` are (name, value) pairs at the top, such as the period and the scalar type."""

    title: str
    about: str
    sections: tuple[Section, ...]
    facts: tuple[tuple[str, str], ...] = ()

    @property
    def checks(self) -> tuple[Check, ...]:
        """All checks, in reading order."""
        return tuple(chain.from_iterable(s.checks() for s in self.sections))

    @property
    def failed_checks(self) -> tuple[Check, ...]:
        """The checks that did not pass."""
        return tuple(c for c in self.checks if not c.passed)


@dataclass(frozen=True)
class Part:
    """A numbered section: its number, such as 4.2, its depth, and its number of failed checks."""

    number: str
    depth: int
    section: Section

    @property
    def id(self) -> str:
        """The anchor of its heading."""
        return "s" + self.number.replace(".", "-")

    @property
    def failed_count(self) -> int:
        """Number of failed checks in the section and its subsections."""
        return sum(not c.passed for c in self.section.checks())


def parts(sections: Iterable[Section], prefix: str = "") -> Iterator[Part]:
    """Yield the sections with their numbers, each followed by its subsections."""
    for k, section in enumerate(sections, 1):
        number = f"{prefix}{k}"
        yield Part(number, number.count(".") + 1, section)
        yield from parts(section.sections, f"{number}.")


def render(report: Report) -> str:
    """Return the report as one HTML document.

    Raises DesignError when the page would load external content or two elements share an id.
    """
    environment = jinja2.Environment(
        autoescape=True, undefined=jinja2.StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    written = {f.__name__: f for f in (notation.number, notation.quantities, notation.equation)}
    environment.filters |= written | {"svg": _inline}
    environment.tests["text"] = lambda cell: isinstance(cell, str)
    template = resources.files(__package__).joinpath("page.html.j2").read_text(encoding="utf-8")
    numbered = tuple(parts(report.sections))
    of_parts = [
        (p.section.title, [c for b in p.section.blocks if isinstance(b, Checks) for c in b.checks]) for p in numbered
    ]
    screen = first_screen.section(first_screen.rows(of_parts), {p.section.title: p.id for p in numbered[::-1]})
    html = environment.from_string(template).render(
        report=report, parts=numbered, first_screen=screen, many=MANY, kind=lambda block: type(block).__name__.lower()
    )
    reader = _read(html)
    if addresses := reader.external:
        raise DesignError(f"the report would load {', '.join(addresses)}: embed this content in the page")
    if duplicates := [i for i, count in Counter(reader.ids).items() if count > 1]:
        raise DesignError(
            f"the ids {', '.join(duplicates)} are used twice in the report: give each figure a different name"
        )
    return html


def external_addresses(html: str) -> tuple[str, ...]:
    """Return the external addresses in attributes, styles and scripts that a browser would load or follow."""
    return _read(html).external


def _read(html: str) -> "_Reader":
    reader = _Reader()
    reader.feed(html)
    reader.close()
    return reader


class _Reader(HTMLParser):
    """Collects addresses and ids."""

    def __init__(self) -> None:
        super().__init__()
        self.addresses: list[str] = []
        self.ids: list[str] = []
        self._inside = ""

    @property
    def external(self) -> tuple[str, ...]:
        """The addresses outside the page."""
        return tuple(dict.fromkeys(a for a in self.addresses if a and not a.startswith(("#", "data:"))))

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self._inside = tag
        for name, value in attrs:
            if name == "id":
                self.ids.append(value or "")
            elif name in _LOADS:
                self.addresses.append((value or "").strip())
            self.addresses += _in_style(value or "")

    def handle_data(self, data: str) -> None:
        if self._inside == "style":
            self.addresses += _in_style(data)

    def handle_endtag(self, tag: str) -> None:
        self._inside = ""


def _in_style(text: str) -> list[str]:
    if "(" not in text and "@" not in text:  # as in the long paths of figures
        return []
    return [(a or b).strip() for a, b in _STYLE_LOADS.findall(text)]


def _inline(svg: str) -> Markup:
    """Return an <svg> for use inside HTML, without namespaces, which HTML does not need."""
    if not svg.startswith("<svg") or not svg.rstrip().endswith("</svg>"):
        raise DesignError(f"a figure begins with '{svg[:20]}': give one whole <svg> element")
    return Markup(re.sub(r' (?:xmlns(?::\w+)?|version)="[^"]*"', "", svg))
