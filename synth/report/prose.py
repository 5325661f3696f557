"""Markdown template of a design's report, with {{ placeholders }}, merged with the computed sections of the page.

    # Title          text at the start of the standard section of this title, or else a new section
    ## Title         the same for a subsection
    {{ name }}       a value, {{ name:.3g }} with a Python format; alone in its paragraph it may be a block
    $k_s_phi$        a name, typeset as in equations

The caller places the text before the first title. HTML is shown as text, and images are disabled.

Captions of figures and tables as data (report.toml), combined with computed drawings and rows.

[blocks."accuracy.places"]         a drawing of this name is a figure, rows of this name are a table
caption = "Sensors, in pitches of {{ pitch_mm:.1f }} mm."      placeholders as in report.md
published = "Fig. 3: ..."          of a figure: content of the corresponding figure in the source
columns = ["layout", "X, µm"]      of a table; `digits` gives the significant digits, default 4
"""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from markdown_it import MarkdownIt
from markupsafe import Markup
from matplotlib.figure import Figure

from synth import show
from synth.errors import DesignError
from synth.report import figures, page
from synth.report.equations import mathml
from synth.report.notation import number
from synth.report.page import Section

Value = str | float | page.Block
_PLACEHOLDER = re.compile(r"\{\{\s*([A-Za-z]\w*(?:[.-]\w+)*)\s*(?::([^{}]*?))?\s*\}\}")
_NAME = re.compile(r"\$([A-Za-z]\w*)\$")
_OPEN, _CLOSE = "\ue000", "\ue001"  # private-use characters, without meaning in Markdown
_TITLE = re.compile(r"^(#{1,2}) +(.+?)\s*#*$")


@dataclass(frozen=True)
class Part:
    """A titled part of the text: its blocks, and its subparts."""

    title: str
    blocks: tuple[page.Block, ...]
    parts: tuple["Part", ...] = ()


def parse(text: str, values: Mapping[str, Value]) -> Part:
    """Parse the text into parts; the parts of the first level are inside one without a title.

    Raises DesignError for an unknown placeholder, for a block inside a sentence, or for a format that does not fit its
    value.
    """
    titled = [(level, title, _blocks(body, values)) for level, title, body in _split_at_titles(text)]
    first = titled[0][2]
    parts: list[Part] = []
    for level, title, blocks in titled[1:]:
        if level == 1 or not parts:
            parts.append(Part(title, blocks))
        else:
            parts[-1] = replace(parts[-1], parts=(*parts[-1].parts, Part(title, blocks)))
    return Part("", first, tuple(parts))


def merge(sections: Sequence[Section], parts: Sequence[Part]) -> tuple[Section, ...]:
    """Put text before the blocks of sections of the same title; other parts become sections in reading order."""
    merged = list(sections)
    position = 0
    for part in parts:
        same = next((k for k, s in enumerate(merged) if s.title == part.title), None)
        if same is None:
            merged.insert(position, Section(part.title, part.blocks, subsections(part)))
            position += 1
        else:
            section = merged[same]
            merged[same] = replace(
                section, blocks=(*part.blocks, *section.blocks), sections=_merge_subsections(section, part)
            )
            position = same + 1
    return tuple(merged)


def subsections(part: Part) -> tuple[Section, ...]:
    """Return the subparts of a part as sections."""
    return merge((), part.parts)


def _merge_subsections(section: Section, part: Part) -> tuple[Section, ...]:
    return merge(section.sections, part.parts)


def _split_at_titles(text: str) -> Iterator[tuple[int, str, str]]:
    """Yield (level, title, text) of each part, first the text before any title."""
    level, title, body = 0, "", list[str]()
    fenced = False
    for line in text.splitlines():
        fenced ^= line.startswith("```")
        if (match := _TITLE.match(line)) and not fenced:
            yield level, title, "\n".join(body)
            level, title, body = len(match[1]), match[2], []
        else:
            body.append(line)
    yield level, title, "\n".join(body)


def _blocks(text: str, values: Mapping[str, Value]) -> tuple[page.Block, ...]:
    blocks: list[page.Block] = []
    words: list[str] = []
    for paragraph in re.split(r"\n\s*\n", text.strip()):
        match = _PLACEHOLDER.fullmatch(paragraph.strip())
        value = _value(match[1], values) if match else ""
        if isinstance(value, str | float | int):
            words.append(_PLACEHOLDER.sub(lambda m: _escaped(m, values), paragraph))
        else:
            blocks += [*_text(words), value]
            words = []
    return (*blocks, *_text(words))


def _text(paragraphs: Sequence[str]) -> list[page.Block]:
    text = "\n\n".join(paragraphs).strip()
    return [render_markdown(text)] if text else []


def render_markdown(text: str) -> page.Prose:
    """Return Markdown as HTML; images, underlined titles and embedded HTML are disabled."""
    markdown = (
        MarkdownIt("commonmark", {"html": False, "typographer": False}).enable("table").disable(["image", "lheading"])
    )
    html = markdown.render(_NAME.sub(f"{_OPEN}\\1{_CLOSE}", text))
    return page.Prose(Markup(re.sub(f"{_OPEN}(.*?){_CLOSE}", lambda m: mathml.symbol(m[1]), html)))


def _value(name: str, values: Mapping[str, Value]) -> Value:
    if name not in values:
        raise DesignError(
            f"report.md asks for {{{{ {name} }}}}, which is not known: there are {', '.join(sorted(values))}"
        )
    return values[name]


def fill_placeholders(text: str, values: Mapping[str, Value]) -> str:
    """Return a sentence with its placeholders replaced; raise DesignError as `parse`."""
    return _PLACEHOLDER.sub(lambda m: _plain(m, values), text)


def _escaped(match: re.Match[str], values: Mapping[str, Value]) -> str:
    return re.sub(r"([\\`*_{}\[\]<>#|!])", r"\\\1", _plain(match, values))


def _plain(match: re.Match[str], values: Mapping[str, Value]) -> str:
    name, format_spec = match[1], match[2] or ""
    value = _value(name, values)
    if not isinstance(value, str | float | int):
        raise DesignError(f"report.md has the block {{{{ {name} }}}} inside a sentence: give it a paragraph of its own")
    if not format_spec and not isinstance(value, str):
        return number(value)
    try:
        text = format(value, format_spec)
    except ValueError as error:
        raise DesignError(
            f"report.md writes {{{{ {name}:{format_spec} }}}} of {value!r}, {error}: use a format that suits"
        ) from error
    return text if isinstance(value, str) else text.replace("-", "−")


Rows = Sequence[Sequence[show.Cell]]
Content = Value | Figure | Rows


def with_captions(values: Mapping[str, Content], described: Mapping[str, Any]) -> dict[str, Value]:
    """Return values for report.md: drawings and rows with their captions, other values unchanged.

    Raises DesignError for a drawing or rows without a description, and as `fill_placeholders`.
    """
    return {name: _block(name, each, described, values) for name, each in values.items()}


def _block(name: str, each: Content, described: Mapping[str, Any], values: Mapping[str, Any]) -> Value:
    if not isinstance(each, Figure | list | tuple):
        return each  # type: ignore[return-value]
    if name not in described:
        raise DesignError(f"'{name}' has no caption: describe it in report.toml as [blocks.\"{name}\"]")
    words = described[name]
    caption = fill_placeholders(words["caption"], values)
    if isinstance(each, Figure):
        return page.Figure(figures.svg(each, name.replace(".", "-")), caption, words.get("published", ""))
    return show.Table(caption, tuple(words["columns"]), tuple(map(tuple, each)), words.get("digits", 4))
