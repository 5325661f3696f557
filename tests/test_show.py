"""What a prompt and a notebook show of a result."""

from dataclasses import dataclass

import numpy as np
import pytest

from synth import show


@show.printed
@dataclass(frozen=True, repr=False)
class Pair:
    """Two numbers with a title that needs escaping."""

    a: float
    b: complex

    def sheet(self) -> show.Sheet:
        table = show.Table(("name", "value"), (("a", show.number(self.a)), ("long b", show.number(self.b))))
        return show.Sheet("a < b & c", ("one line",), (table,))


def test_a_prompt_aligns_the_columns() -> None:
    assert repr(Pair(0.5, -1 + 2j)) == "a < b & c\none line\nname    value\na         0.5\nlong b  -1+2i"


def test_a_notebook_gets_escaped_html() -> None:
    found = Pair(0.5, 2)._repr_html_()  # type: ignore[attr-defined]
    assert "<strong>a &lt; b &amp; c</strong>" in found and "<tr><td>a</td><td>0.5</td></tr>" in found


@pytest.mark.parametrize(
    ("value", "shown"),
    [(1 / 3, "0.33333"), (1e10, "1e+10"), (-0.0, "0"), (2 - 0.5j, "2-0.5i"), (np.complex128(3), "3"), (np.nan, "nan")],
)
def test_numbers_keep_five_digits(value: complex, shown: str) -> None:
    assert show.number(value) == shown


def test_a_matrix_names_its_rows_and_columns() -> None:
    found = show.matrix("K", np.eye(2), ("u1", "u2"), ("x", "v"))
    assert found == show.Table(("K", "x", "v"), (("u1", "1", "0"), ("u2", "0", "1")))


def test_of_a_large_table_the_ends_are_shown_in_text_and_in_html() -> None:
    names = [f"n{k}" for k in range(200)]
    sheet = show.Sheet("large", tuple(names), (show.matrix("", np.diag(np.arange(200.0)), names, names),))
    lines = show.text(sheet).splitlines()
    assert lines[1:34] == [*names[:16], "...", *names[-16:]]
    assert lines[34].split() == [*names[:8], "...", *names[-8:]]
    assert [line.split()[0] for line in lines[35:]] == [*names[:16], "...", *names[-16:]]
    assert lines[36].split() == ["n1", "0", "1", *"000000", "...", *"00000000"]
    assert lines[-1].split()[-1] == "199"
    found = show.html(sheet)
    assert len(found) < 20_000 and found.count("<tr>") == 34 and found.count("<th>") == 18 and "<td>199</td>" in found
    small = show.matrix("", np.eye(16), names[:16], names[:16])
    assert "..." not in show.text(show.Sheet("small", (), (small,)))


def test_a_unit_stands_in_brackets_where_it_is_known() -> None:
    assert show.named("gap", "m") == "gap [m]" and show.named("gap", "") == "gap"
