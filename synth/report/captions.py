"""Captions of figures and tables as data (report.toml), combined with computed drawings and rows.

[blocks."accuracy.places"]         a drawing of this name is a figure, rows of this name are a table
caption = "Sensors, in pitches of {{ pitch_mm:.1f }} mm."      placeholders as in report.md
published = "Fig. 3: ..."          of a figure: content of the corresponding figure in the source
columns = ["layout", "X, µm"]      of a table; `digits` gives the significant digits, default 4
"""

from collections.abc import Mapping, Sequence
from typing import Any

from matplotlib.figure import Figure

from synth.errors import DesignError
from synth.report import figures, page, prose
from synth.report.prose import Value

Rows = Sequence[Sequence[page.Cell]]
Content = Value | Figure | Rows


def with_captions(values: Mapping[str, Content], described: Mapping[str, Any]) -> dict[str, Value]:
    """Return values for report.md: drawings and rows with their captions, other values unchanged.

    Raises DesignError for a drawing or rows without a description, and as `prose.fill_placeholders`.
    """
    return {name: _block(name, each, described, values) for name, each in values.items()}


def _block(name: str, each: Content, described: Mapping[str, Any], values: Mapping[str, Any]) -> Value:
    if not isinstance(each, Figure | list | tuple):
        return each  # type: ignore[return-value]
    if name not in described:
        raise DesignError(f"'{name}' has no caption: describe it in report.toml as [blocks.\"{name}\"]")
    words = described[name]
    caption = prose.fill_placeholders(words["caption"], values)
    if isinstance(each, Figure):
        return page.Figure(figures.svg(each, name.replace(".", "-")), caption, words.get("published", ""))
    return page.Table(caption, tuple(words["columns"]), tuple(map(tuple, each)), words.get("digits", 4))
