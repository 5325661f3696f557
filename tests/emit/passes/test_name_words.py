"""Words that names have in common make an identifier or nothing."""

import pytest

from synth.emit.program import words


@pytest.mark.parametrize(
    ("names", "common"),
    [
        (["regulator_x_sum", "regulator_z_sum"], "regulator_sum"),
        (["row_2_5", "row_5"], "row_5"),
        (["row_1", "gradient_1"], ""),  # `1` alone would be a number in C
        (["x", "z"], ""),
        (["", ""], ""),
    ],
)
def test_names_have_words_in_common(names: list[str], common: str) -> None:
    assert words.common(names) == common


@pytest.mark.parametrize(
    ("names", "one"),
    [
        (["sign_y1", "sign_y3"], "sign_y1_y3"),
        (["sign_y1"], "sign_y1"),
        (["distance", "far"], "far"),
        (["gradient_of_a_solution_1", "gradient_of_a_solution_2"], "gradient_of_a_solution_2"),
    ],
)
def test_a_value_with_several_names_has_the_ends_of_all(names: list[str], one: str) -> None:
    assert words.combine(names) == one
