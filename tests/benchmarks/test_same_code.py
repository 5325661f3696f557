"""The comparison of machine code: names and comments may change, a constant or an instruction may not."""

import pytest

from benchmarks import same_code

BEFORE = """
#include <math.h>
static float scale(float x) { return (3.0f * x) + 1.0f; }
float law(float x) { return sqrtf(scale(x) * scale(x + 1.0f)); }
float other(float x) { return scale(x) / 7.0f; }
"""


@pytest.mark.parametrize("after", [BEFORE.replace("scale", "gain"), BEFORE.replace("static", "/* the gain */ static")])
def test_names_and_comments_do_not_count(after: str) -> None:
    assert same_code.differences({"law.c": BEFORE}, {"law.c": after}) == []


@pytest.mark.parametrize(("old", "new"), [("3.0f", "3.0000002f"), ("sqrtf", "fabsf"), (") + 1.0f;", ") - 1.0f;")])
def test_a_planted_change_of_the_code_counts(old: str, new: str) -> None:
    assert same_code.differences({"law.c": BEFORE}, {"law.c": BEFORE.replace(old, new)})


def test_an_external_name_counts() -> None:
    text = "float f(float); float law(float x) { return f(x); }"
    assert same_code.differences({"law.c": text}, {"law.c": text.replace("f(", "g(").replace("lawg(", "law(")})


def test_what_a_revision_does_not_have_is_empty() -> None:
    assert same_code.read_revision("HEAD", "no_such_program") == {}
