"""Lines of code have at most 120 columns, and the same words in the same order."""

from synth.emit.c.lines import WIDTH, Line, wrapped

SUM = "    const float sum = " + " + ".join(f"(gain_{n} * error_{n})" for n in range(12)) + ";"


def test_a_long_line_is_continued_with_its_equation() -> None:
    rows = list(wrapped([Line(SUM, "sum: (1)")]))
    assert len(rows) > 1 and all(len(row.text) <= WIDTH and row.tag == "sum: (1)" for row in rows)
    assert " ".join(row.text.strip() for row in rows) == SUM.strip()
    assert [row.text[:9] for row in rows[1:]] == [" " * 8 + row.text[8] for row in rows[1:]]


def test_a_condition_is_continued_beyond_its_block() -> None:
    condition = "if (" + " && ".join(f"usable_{n}" for n in range(12)) + ") {"
    first, second = wrapped([Line(condition)])
    assert first.text.startswith("if (") and second.text.startswith(" " * 8) and second.text.endswith("{")


def test_short_lines_comments_and_directives_stay() -> None:
    rows = [Line("x = 1;"), Line("/* " + "word " * 40 + "*/"), Line('#error "' + "word " * 40 + '"')]
    assert list(wrapped(rows)) == rows


def test_no_name_is_cut_where_nested_calls_have_no_blank() -> None:
    name = "a_design_with_a_long_name_max"
    nested = (
        f"x = {name}({name}({name}({name}({name}(0.0f, first_part), second_part), third_part), fourth_part), more);"
    )
    rows = [row.text for row in wrapped([Line("    " + nested)])]
    assert len(rows) > 1 and sum(row.count(f"{name}(") for row in rows) == 5
