"""Lines of code have at most 120 columns, and the same words in the same order."""

import re

import pytest

from synth.emit.c.lines import WIDTH, Line, alternative, opening, rows, wrapped

SUM = "    const float sum = " + " + ".join(f"(gain_{n} * error_{n})" for n in range(12)) + ";"


def test_a_long_line_is_continued_with_its_equation() -> None:
    lines = list(wrapped([Line(SUM, "sum: (1)")]))
    assert len(lines) > 1 and all(len(line.text) <= WIDTH and line.tag == "sum: (1)" for line in lines)
    assert " ".join(line.text.strip() for line in lines) == SUM.strip()
    assert [line.text[:9] for line in lines[1:]] == [" " * 8 + line.text[8] for line in lines[1:]]


def test_a_condition_is_continued_beyond_its_block() -> None:
    condition = "if (" + " && ".join(f"usable_{n}" for n in range(12)) + ") {"
    first, second = wrapped([Line(condition)])
    assert first.text.startswith("if (") and second.text.startswith(" " * 8) and second.text.endswith("{")


@pytest.mark.parametrize(
    ("code", "row"),
    [
        ("return " + " + ".join(f"(gain_{n} * state->error_{n})" for n in range(5)) + ";", r".*\+"),
        ("const float limited_value = name_max(name_min(some_rather_long_name * (first + second), upper), lower);",
         r".*, upper\),"),
        ("const float some_rather_long_name_of_a_value = name_limit(some_rather_long_name_of_another, in->some_limit);",
         r".*_another,"),
        ("INLINE name_output_t name_output(const name_state_t *state_of_the_loop, const type *value, t u)",
         r".*,"),
        ("name_t a = {.first = 0.1234567890f, .second = 0.1234567890f, .third = 0.1234567890f, .fourth = 1.0f};",
         r".*,"),
    ],
)  # fmt: skip
def test_a_line_is_broken_after_an_operator_or_a_comma_where_least_is_open(code: str, row: str) -> None:
    indent = " " * (WIDTH + 4 - len(code))
    first, second = rows(indent + code)
    assert re.fullmatch(row, first) and re.match(indent + r"    \S", second)


def test_short_lines_comments_and_directives_stay() -> None:
    lines = [Line("x = 1;"), Line("/* " + "word " * 40 + "*/"), Line('#error "' + "word " * 40 + '"')]
    assert list(wrapped(lines)) == lines


def test_no_name_is_cut_where_nested_calls_have_no_blank() -> None:
    name = "a_design_with_a_long_name_max"
    nested = (
        f"x = {name}({name}({name}({name}({name}(0.0f, first_part), second_part), third_part), fourth_part), more);"
    )
    broken = rows("    " + nested)
    assert len(broken) > 1 and sum(row.count(f"{name}(") for row in broken) == 5


def joined(*texts: str, tag: str = "a") -> list[str]:
    return [line.text for line in alternative([Line(text, tag) for text in texts], 1, "a")]


LADDER = ("        if (far) {", "            x = 1;", "        } else {", "            x = 2;", "        }")


def test_an_if_alone_in_an_else_follows_in_its_line() -> None:
    assert joined(*LADDER) == ["    } else if (far) {", "        x = 1;", "    } else {", "        x = 2;", "    }"]


@pytest.mark.parametrize(
    "lines",
    [
        ("        y = 1;", *LADDER),
        (*LADDER, "        y = 1;"),
        (*LADDER, *LADDER),
        LADDER[:2] + LADDER[-1:],  # MISRA C:2012, rule 15.7: a ladder ends in an else
        (*LADDER[:2], "#if defined(DIAGNOSTICS)", *LADDER[2:]),
        ("        x = 1;",),
    ],
)
def test_any_other_else_has_a_block(lines: tuple[str, ...]) -> None:
    assert joined(*lines) == ["    } else {", *lines, "    }"]


def test_an_if_of_another_section_has_a_block() -> None:
    assert joined(*LADDER, tag="b")[0] == "    } else {"


def test_notes_stand_behind_the_title_within_the_width() -> None:
    rows = opening(["handover: currents"], ["word " * 40], indent=8)
    assert rows[0] == "/* handover: currents" and rows[-1].endswith(" word */") and len(rows) == 3
    assert all(len(row) + 8 <= WIDTH for row in rows)
