"""Audit: criterion of agreement, verdicts, and the JSON document."""

import json
from math import inf, nan
from pathlib import Path

import pytest

from synth.errors import DesignError
from synth.report import audit
from synth.report.audit import Printed, Verdict, judge

TEXT = """
[A-1]
paper = "A"
where = "Fig. 1"
text = "the pole is -2.61 1/s | damped"
numbers = { pole = ["-2.61", "1/s"], step = ["7", "mm"] }
"""


@pytest.mark.parametrize(
    ("value", "same"), [(-2.614, True), (-2.606, True), (-2.6199, True), (-2.6201, False), (2.61, False)]
)
def test_agreement_reaches_one_unit_of_the_last_digit(value: float, same: bool) -> None:
    assert Printed("-2.61", "1/s").agrees(value) is same


@pytest.mark.parametrize(("text", "digit"), [("-2.61", 0.01), ("22", 1.0), ("33.040", 1e-3), ("2.5e9", 1e8)])
def test_the_last_digit_is_that_of_the_print(text: str, digit: float) -> None:
    assert Printed(text, "1").last_digit == pytest.approx(digit, rel=1e-12)


def test_nan_never_agrees() -> None:
    assert not Printed("14.3", "%").agrees(nan)
    assert not Printed("14.3", "%").agrees(inf)


@pytest.mark.parametrize(
    ("as_printed", "corrected", "verdict"),
    [(True, True, "R"), (True, False, "R"), (False, True, "RC"), (False, False, "N")],
)
def test_the_verdict_follows_from_two_statements(as_printed: bool, corrected: bool, verdict: str) -> None:
    assert judge(as_printed, corrected) == verdict


def row(value: float) -> audit.Row:
    published = audit.parse_rows(TEXT)["A-1"]
    return audit.row(published, [("pole", value, "1/s")], judge(published["pole"].agrees(value)), "why | so", ("m",))


def test_the_document_has_the_declared_keys_and_unrounded_values() -> None:
    value = -2.6144397110588162
    (document,) = json.loads(json.dumps([row(value).document()]))
    assert list(document) == ["id", "paper", "where", "published", "recomputed", "verdict", "why"]
    assert document["recomputed"] == [{"name": "pole", "value": value, "unit": "1/s"}]
    assert (document["id"], document["paper"], document["verdict"]) == ("A-1", "A", "R")


@pytest.mark.parametrize("value", [nan, inf, -inf])
def test_a_value_that_does_not_exist_is_null(value: float) -> None:
    text = json.dumps([row(value).document()], allow_nan=False)
    assert json.loads(text)[0]["recomputed"][0]["value"] is None
    assert json.loads(text)[0]["verdict"] == "N"


def test_figures_and_numbers_are_read_by_name() -> None:
    example = row(-2.6)
    assert example["pole"] == -2.6
    assert example.published["step"].value == 7
    for wrong in (lambda: example["zero"], lambda: example.published["zero"]):
        with pytest.raises(DesignError, match=r"A-1.*'zero'.*pole"):
            wrong()


@pytest.mark.parametrize("figures", [[], [("a", 1.0, "m"), ("a", 2.0, "m")]])
def test_a_row_without_figures_or_with_two_of_a_name_is_refused(figures: list[tuple[str, float, str]]) -> None:
    with pytest.raises(DesignError, match="A-1"):
        audit.row(audit.parse_rows(TEXT)["A-1"], figures, Verdict.REPRODUCES, "why")


@pytest.mark.parametrize(
    ("wrong", "right"),
    [
        ('where = "Fig. 1"', ""),
        ('["7", "mm"]', '["7", "mm", "m"]'),
        ('["7", "mm"]', '["seven", "mm"]'),
        ('["7", "mm"]', "7"),
    ],
)
def test_a_published_row_that_lacks_something_is_refused(wrong: str, right: str) -> None:
    with pytest.raises(DesignError, match="published row A-1"):
        audit.parse_rows(TEXT.replace(wrong, right))


def test_digits_must_be_quoted() -> None:
    with pytest.raises(DesignError, match="in quotes"):
        audit.parse_rows(TEXT.replace('["7", "mm"]', '[7.50, "mm"]'))


TWO_ROWS = (
    TEXT
    + """
computed = { pole = ["A-1.pole", "1/s", "pole"], as_printed = "A-1.pole.agrees(pole)" }

[A-2]
paper = "A"
where = "Fig. 2"
text = "it is late"
rule = "Rule: within a millimetre."
numbers = { late = ["7", "mm"] }
[A-2.computed]
late = ["A-2.late + m", "mm", "late"]
corrected = "A-2.late.agrees(late - m)"
"""
)


def test_rows_come_in_the_order_asked_for_or_in_that_of_the_print_with_their_rules() -> None:
    scope = audit.Scope({"m": 9.61}, {}, audit.parse_rows(TWO_ROWS))
    first, second = audit.rows(scope)
    assert (first.id, first.verdict, first.why, first.depends) == ("A-1", "R", "", ("A-1.pole",))
    assert (second.id, second.verdict, second.depends) == ("A-2", "RC", ("A-2.late", "m"))
    assert second.why == "Rule: within a millimetre."
    assert [row.id for row in audit.rows(scope, ["A-2", "A-1"])] == ["A-2", "A-1"]


def test_functions_are_those_that_a_module_defines() -> None:
    named = audit.functions(audit)
    assert named["judge"] is judge and named["evaluate"] is audit.evaluate
    assert "Decimal" not in named


def test_the_prints_of_a_folder_are_read(tmp_path: Path) -> None:
    (tmp_path / "published.toml").write_text(TEXT, encoding="utf-8")
    assert audit.read_rows(tmp_path) == audit.parse_rows(TEXT)
