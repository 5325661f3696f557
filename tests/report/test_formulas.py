"""Formulas of an audit: permitted names, dependencies, and refused expressions."""

import pickle

import pytest

from synth.errors import DesignError
from synth.report import audit
from synth.report.audit import Formula

TEXT = """
[F-1]
paper = "F"
where = "Table 1"
text = "the stage of 2 kg swings at 1.59 Hz"
rule = "Rule: within one unit of the last printed digit."
numbers = { frequency = ["1.59", "Hz"], mass = ["2", "kg"] }
[F-1.computed]
pulse = "sqrt(stiffness / F-1.mass)"
frequency = ["pulse / (2 * pi)", "Hz", "frequency"]
twice = ["doubled(frequency)", "Hz", "twice it"]
as_printed = "F-1.frequency.agrees(twice)"
corrected = "F-1.frequency.agrees(frequency)"

[F-2]
paper = "F"
where = "Table 2"
text = "of a printed number alone"
numbers = { rate = ["4", "Hz"] }
computed = { half = ["F-2.rate / 2", "Hz", "half"], as_printed = "half < F-2.rate.value" }
"""
PRINTS = audit.parse_rows(TEXT)


SCOPE = audit.Scope({"stiffness": 200.0, "mass": 9.0}, {"doubled": lambda v: 2 * v}, PRINTS)


def test_rows_are_recomputed_by_their_formulas() -> None:
    first, second = audit.rows(SCOPE)
    assert [(f.name, f.unit) for f in first.recomputed] == [("frequency", "Hz"), ("twice it", "Hz")]
    assert first["frequency"] == pytest.approx(1.5915, abs=1e-4) and first["twice it"] == 2 * first["frequency"]
    assert (first.verdict, first.why) == ("RC", "Rule: within one unit of the last printed digit.")
    assert (second.verdict, second["half"], second.depends) == ("R", 2.0, ("F-2.rate",))


def test_a_row_is_data_that_another_process_can_read() -> None:
    rows = list(audit.rows(SCOPE))
    assert pickle.loads(pickle.dumps(rows)) == rows


def test_a_row_depends_on_what_its_figures_name_and_on_no_more() -> None:
    (first, _) = audit.rows(SCOPE)
    assert first.depends == ("F-1.mass", "stiffness")


def test_an_attribute_is_no_name() -> None:
    assert Formula("filter(F-1.mass).mass + rate").identifiers == {"filter", "F-1.mass", "printed", "rate"}


@pytest.mark.parametrize(
    ("text", "match"),
    [
        ("stifness / 2", "names 'stifness', which is neither a value above it nor a parameter: use one of .*stiffness"),
        ("stiffness /", "'stiffness /' is not an expression"),
        ("open('x')", "names 'open'"),
    ],
)
def test_a_formula_that_is_none_is_refused(text: str, match: str) -> None:
    with pytest.raises(DesignError, match=match):
        audit.evaluate({"value": Formula(text, "1", "value")}, {"stiffness": 1.0}, {})


def test_a_printed_number_that_is_none_is_refused() -> None:
    with pytest.raises(DesignError, match=r"F-3\.mass, which is not printed: use one of F-1\.mass"):
        audit.evaluate({"value": Formula("F-3.mass")}, {}, {"F-1.mass": 2.0})


def test_near_asks_for_all() -> None:
    assert audit.is_close(1.001, 0.01, 1.0, 1.005) and not audit.is_close(1.001, 0.01, 1.0, 1.2)
