"""Drawings and rows get their captions from data; a missing description is refused."""

import pytest
from matplotlib.figure import Figure

from synth import show
from synth.errors import DesignError
from synth.report import page, prose

DESCRIBED = {
    "a.rows": {"caption": "Of {{ a.n }} in {{ a.x:.2f }}-100 %", "columns": ["name", "value"], "digits": 2},
    "a.drawn": {"caption": "Drawn.", "published": "Fig. 1"},
}


def test_rows_become_a_table_and_a_drawing_a_figure() -> None:
    table = show.Table("own", ("x",), ())
    made = {"a.rows": [("one", 1.0)], "a.drawn": Figure(), "a.n": 3, "a.x": -0.5, "a.table": table}
    values = prose.with_captions(made, DESCRIBED)
    assert values["a.rows"] == show.Table("Of 3 in −0.50-100 %", ("name", "value"), (("one", 1.0),), 2)
    drawn = values["a.drawn"]
    assert isinstance(drawn, page.Figure) and drawn.svg.startswith("<svg") and drawn.published == "Fig. 1"
    assert values["a.table"] is table and values["a.n"] == 3


def test_what_is_not_described_is_refused() -> None:
    with pytest.raises(DesignError, match=r"'b' has no caption: describe it in report.toml as \[blocks."):
        prose.with_captions({"b": [("one",)]}, DESCRIBED)
    with pytest.raises(DesignError, match=r"a\.n }}, which is not known"):
        prose.with_captions({"a.rows": [("one", 1.0)]}, DESCRIBED)
