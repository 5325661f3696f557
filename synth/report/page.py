"""The page of a report: sections of blocks, rendered as one HTML file that needs no other.

A Report is data. `render` numbers its figures and tables, counts its checks, and puts the failed ones at the top. All
text is escaped; the <svg> of a Figure alone is markup, and a page that would load anything from elsewhere is refused.
"""

import math
import re
from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from html.parser import HTMLParser
from importlib import resources
from itertools import chain

import jinja2
from markupsafe import Markup, escape

from synth.check import Check
from synth.errors import DesignError

Cell = str | float
FINEST = {"m": ("mm", "µm", "nm"), "rad": ("mrad", "µrad", "nrad"), "s": ("ms", "µs", "ns")}
UPRIGHT = frozenset("sin cos sinh cosh tanh coth csch exp sqrt min max sign round abs atan det mod".split())
_TOKEN = re.compile(r"(?P<name>[A-Za-zΑ-Ωα-ω]+)|(?P<shift>[_^])(?:\{(?P<group>[^{}]*)\}|(?P<one>-?[A-Za-z0-9Α-Ωα-ω*]+))")
_LOADS = {"src", "srcset", "href", "xlink:href", "data", "poster", "action", "formaction", "background", "style"}
_STYLE_LOADS = re.compile(r"url\(\s*['\"]?([^'\")]*)|@import\s+['\"]?([^'\";]*)")


@dataclass(frozen=True)
class Text:
    """Paragraphs, parted by empty lines."""

    text: str

    @property
    def paragraphs(self) -> tuple[str, ...]:
        """The paragraphs, each as one line."""
        return tuple(" ".join(p.split()) for p in re.split(r"\n\s*\n", self.text) if p.strip())


@dataclass(frozen=True)
class Equations:
    """Displayed equations: the tag, such as F(12), and the text, with x_1 or x_{ref} lowered and x^2 or x^{-1} raised."""

    rows: tuple[tuple[str, str], ...]


@dataclass(frozen=True)
class Table:
    """Rows of texts and numbers under their columns; a number is shown to four digits, a text as it is.

    Raises DesignError when a row has another count of cells than there are columns.
    """

    caption: str
    columns: tuple[str, ...]
    rows: tuple[tuple[Cell, ...], ...]

    def __post_init__(self) -> None:
        for row in self.rows:
            if len(row) != len(self.columns):
                raise DesignError(
                    f"table '{self.caption}': the row {row} has {len(row)} cells for {len(self.columns)} columns"
                )


@dataclass(frozen=True)
class Figure:
    """A drawing as one <svg> element, and beside it what the source's own figure shows, if it has one."""

    svg: str
    caption: str
    beside: str = ""


@dataclass(frozen=True)
class Checks:
    """Measured figures with their limits."""

    caption: str
    checks: tuple[Check, ...]


Block = Text | Equations | Table | Figure | Checks


@dataclass(frozen=True)
class Section:
    """A titled part: blocks, then parts of its own."""

    title: str
    blocks: tuple[Block, ...] = ()
    sections: tuple["Section", ...] = ()

    def checks(self) -> Iterator[Check]:
        """Yield the checks of this section and of those inside, in reading order."""
        yield from chain.from_iterable(b.checks for b in self.blocks if isinstance(b, Checks))
        yield from chain.from_iterable(s.checks() for s in self.sections)


@dataclass(frozen=True)
class Report:
    """A whole report; `facts` are (name, value) pairs that stand at its top, such as the period and the scalar type."""

    title: str
    about: str
    sections: tuple[Section, ...]
    facts: tuple[tuple[str, str], ...] = ()

    @property
    def checks(self) -> tuple[Check, ...]:
        """All checks, in reading order."""
        return tuple(chain.from_iterable(s.checks() for s in self.sections))

    @property
    def failed(self) -> tuple[Check, ...]:
        """The checks that did not pass."""
        return tuple(c for c in self.checks if not c.passed)


def render(report: Report) -> str:
    """Return the report as one HTML document.

    Raises DesignError when something in it would be loaded from elsewhere or two elements share an id.
    """
    environment = jinja2.Environment(
        autoescape=True, undefined=jinja2.StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    environment.filters |= {"number": number, "limit": quantities, "equation": equation, "svg": _inline}
    environment.tests["text"] = lambda cell: isinstance(cell, str)
    template = resources.files(__package__).joinpath("page.html.j2").read_text(encoding="utf-8")
    html = environment.from_string(template).render(report=report, kind=lambda block: type(block).__name__.lower())
    if found := external(html):
        raise DesignError(f"the report would load {', '.join(found)}: put all that it shows into the page itself")
    if twice := _repeated_ids(html):
        raise DesignError(f"the ids {', '.join(twice)} stand twice in the report: give each figure its own name")
    return html


def external(html: str) -> tuple[str, ...]:
    """Return what a browser would fetch, or follow, outside the page: addresses in attributes, styles and scripts."""
    reader = _Reader()
    reader.feed(html)
    reader.close()
    return tuple(dict.fromkeys(a for a in reader.addresses if a and not a.startswith(("#", "data:"))))


class _Reader(HTMLParser):
    """Collects addresses and ids."""

    def __init__(self) -> None:
        super().__init__()
        self.addresses: list[str] = []
        self.ids: list[str] = []
        self._inside = ""

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self._inside = tag
        for name, value in attrs:
            if name == "id":
                self.ids.append(value or "")
            elif name in _LOADS - {"style"}:
                self.addresses.append((value or "").strip())
            self.addresses += _in_style(value or "")

    def handle_data(self, data: str) -> None:
        if self._inside == "style":
            self.addresses += _in_style(data)

    def handle_endtag(self, tag: str) -> None:
        self._inside = ""


def _in_style(text: str) -> list[str]:
    return [(a or b).strip() for a, b in _STYLE_LOADS.findall(text)]


def _repeated_ids(html: str) -> list[str]:
    reader = _Reader()
    reader.feed(html)
    reader.close()
    return [i for i, count in Counter(reader.ids).items() if count > 1]


def number(value: Cell, digits: int = 4) -> str:
    """Return a number to some significant digits as a reader writes it; a text as it is."""
    if isinstance(value, str):
        return value
    if not math.isfinite(value):
        return "no number" if math.isnan(value) else "∞" if value > 0 else "−∞"
    if isinstance(value, int):
        return f"{value:,}".replace(",", "\u202f").replace("-", "−")
    text = f"{value:.{digits}g}"
    if "e" in text:
        mantissa, exponent = text.split("e")
        text = f"{mantissa}·10{str(int(exponent)).translate(str.maketrans('-0123456789', '⁻⁰¹²³⁴⁵⁶⁷⁸⁹'))}"
    return text.replace("-", "−")


def quantities(values: Iterable[float], unit: str) -> tuple[str, ...]:
    """Return values in SI `unit` as texts, all under the one prefix that suits the greatest: 12.3 µm, not 1.23e-05 m."""
    values = tuple(values)
    greatest = max((abs(v) for v in values if math.isfinite(v)), default=0.0)
    shown, factor = unit, 1.0
    for k, finer in enumerate(FINEST.get(unit, ()), 1):
        if 0 < greatest < 0.9999 * 1000.0 ** (1 - k):
            shown, factor = finer, 1000.0**k
    suffix = "" if unit == "1" else f" {shown}"
    return tuple(number(v if isinstance(v, int) and factor == 1 else factor * v) + suffix for v in values)


def equation(text: str) -> Markup:
    """Return an equation as HTML: names slanted, what follows _ lowered, what follows ^ raised, each in braces or not."""
    found, at = [], 0
    for match in _TOKEN.finditer(text):
        found.append(escape(text[at : match.start()]))
        found.append(_token(match))
        at = match.end()
    return Markup("").join([*found, escape(text[at:])])


def _token(match: re.Match[str]) -> Markup:
    if name := match["name"]:
        return escape(name) if name in UPRIGHT else Markup("<i>{}</i>").format(name)
    inner = match["group"] if match["group"] is not None else match["one"]
    return Markup("<sub>{}</sub>" if match["shift"] == "_" else "<sup>{}</sup>").format(equation(inner))


def _inline(svg: str) -> Markup:
    """Return an <svg> for use inside HTML, which knows the namespaces by itself."""
    if not svg.startswith("<svg") or not svg.rstrip().endswith("</svg>"):
        raise DesignError(f"a figure begins with '{svg[:20]}': give one whole <svg> element")
    return Markup(re.sub(r' (?:xmlns(?::\w+)?|version)="[^"]*"', "", svg))
