"""What a prompt and a notebook show of a result."""

from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

from benchmarks import axes
from designs.maglev_5dof import control
from models import maglev_stage
from synth import show
from synth.analyse import discretise
from synth.check import Check
from synth.statespace import StateSpace
from synth.synthesise.feedback import lqr, pole_placement
from synth.synthesise.riccati import riccati
from synth.timing import Continuous
from synth.verify.suite import Evidence

DOUBLE = StateSpace(
    *([[0.0, 1.0], [0.0, 0.0]], [[0.0], [1.0]], [[1.0, 0.0]], [[0.0]]),  # type: ignore[arg-type]
    *(("q", "v"), ("f",), ("y",), Continuous()),
)
SAMPLED = discretise.zero_order_hold(DOUBLE, 0.1)


@show.with_repr
@dataclass(frozen=True, repr=False)
class Pair:
    """Two numbers with a title that needs escaping."""

    a: float
    b: complex

    def sheet(self) -> show.Sheet:
        table = show.Table("", ("name", "value"), (("a", show.number(self.a)), ("long b", show.number(self.b))))
        return show.Sheet("a < b & c", ("one line",), (table,))


def test_a_prompt_aligns_the_columns() -> None:
    assert repr(Pair(0.5, -1 + 2j)) == "a < b & c\none line\nname    value\na         0.5\nlong b  -1+2i"


def test_a_notebook_gets_escaped_html() -> None:
    html = Pair(0.5, 2)._repr_html_()  # type: ignore[attr-defined]
    assert "<strong>a &lt; b &amp; c</strong>" in html and "<tr><td>a</td><td>0.5</td></tr>" in html


@pytest.mark.parametrize(
    ("value", "shown"),
    [(1 / 3, "0.33333"), (1e10, "1e+10"), (-0.0, "0"), (2 - 0.5j, "2-0.5i"), (np.complex128(3), "3"), (np.nan, "nan")],
)
def test_numbers_keep_five_digits(value: complex, shown: str) -> None:
    assert show.number(value) == shown


def test_a_matrix_names_its_rows_and_columns() -> None:
    table = show.matrix("K", np.eye(2), ("u1", "u2"), ("x", "v"))
    assert table == show.Table("", ("K", "x", "v"), (("u1", "1", "0"), ("u2", "0", "1")), is_matrix=True)
    with pytest.raises(ValueError, match="1 names of rows"):
        show.matrix("K", np.eye(2), ("u1",), ("x", "v"))


def test_a_table_shows_its_caption_and_its_digits() -> None:
    table = show.Table("Gains", ("name", "value"), (("k", 0.123456),), digits=3)
    assert show.text(show.Sheet("title", (), (table,))).splitlines() == ["title", "Gains", "name  value", "k     0.123"]
    assert "<p>Gains</p>" in show.html(show.Sheet("title", (), (table,)))


def latex(*tables: show.Table) -> str:
    text = show.latex(show.Sheet("title", (), tables))
    assert text is not None and text.count("{") == text.count("}")
    return text


def test_only_matrices_and_equations_are_shown_in_latex() -> None:
    plain = show.Table("", ("name", "value"), (("a", "1"),))
    assert show.latex(show.Sheet("title", ("line",), (plain,))) is None
    assert Pair(0.5, 2)._repr_latex_() is None  # type: ignore[attr-defined]
    text = latex(plain, show.matrix("K", [[0.5, -1e-12]], ("u_1 [N]",), ("x", "100 % v")))
    assert r"\mathrm{K} & \mathrm{x} & \mathrm{100\ \%\ v}" in text
    assert r"\mathrm{u\_1\ [N]} & 0.5 & -1\times 10^{-12}" in text


@pytest.mark.parametrize(
    ("value", "shown"),
    [(np.nan, r"\mathrm{NaN}"), (-np.inf, r"-\infty "), (2e-5 - 3j, r"2\times 10^{-5}-3i"), (1e10, r"1\times 10^{10}")],
)
def test_numbers_in_latex(value: complex, shown: str) -> None:
    assert rf"\mathrm{{r}} & {shown} \end" in latex(show.matrix("", [[value]], ("r",), ("c",)))


@pytest.mark.parametrize(
    ("name", "shown"), [("m/s^2", "m/s^{2}"), ("a\\b{c}", r"a\backslash b\{c\}"), ("$x~y#&^", r"\$x\sim y\#\&\wedge ")]
)
def test_names_in_latex_are_escaped(name: str, shown: str) -> None:
    assert rf"\mathrm{{{shown}}} & 1" in latex(show.matrix("", [[1.0]], (name,), ("c",)))


def test_a_huge_matrix_is_elided_before_its_numbers_are_written() -> None:
    names = [f"n{k}" for k in range(4000)]
    table = show.matrix("A", np.zeros((4000, 4000)), names, names)
    assert len(table.rows) == 33 and len(table.columns) == 18
    assert "n2000" not in show.text(show.Sheet("", (), (table,))) and r"\cdots" in latex(table)


@pytest.mark.parametrize(
    ("gain", "zeros", "poles", "shown"),
    [
        (2.0, [-1.0], [0.0, -3.0], r"2\,\frac{\left(s + 1\right)}{s\left(s + 3\right)}"),
        (2.0, [], [0.5], r"2\,\frac{1}{\left(s - 0.5\right)}"),
        (-1.5, [1 + 2j], [], r"-1.5\,\left(s - (1+2i)\right)"),
    ],
)
def test_a_transfer_function_by_its_zeros_and_poles(
    gain: float, zeros: list[complex], poles: list[complex], shown: str
) -> None:
    assert show.ratio("K", "s", gain, zeros, poles) == f"K(s) = {shown}"


@pytest.mark.parametrize(
    "gain",
    [
        lqr.lqr(DOUBLE, np.eye(2), [[1.0]]),
        pole_placement.place(DOUBLE, [-1.0, -2.0]),
    ],
)
def test_each_gain_tells_its_sign_and_how_to_convert_it(gain: Any) -> None:
    """MATLAB and python-control have u = -K x."""
    assert "u = +K x: the sign is inside K. MATLAB and python-control use u = -K x: give them -K." in repr(gain)
    assert "give them -K." in gain._repr_html_() and "u = +K x" in gain._repr_latex_()
    assert np.linalg.eigvals(DOUBLE.A + DOUBLE.B @ gain.K).real.max() < 0


def test_a_riccati_solution_has_the_other_sign() -> None:
    solution = riccati.solve(DOUBLE, np.eye(2), [[1.0]])
    assert "u = -L x: the sign of MATLAB" in repr(solution) and "u = -L x" in solution._repr_latex_()  # type: ignore[attr-defined]


def test_models_blocks_and_plants_show_their_signals() -> None:
    assert r"\dot{x} = A x + B u" in DOUBLE._repr_latex_() and "x_{k+1}" in SAMPLED._repr_latex_()  # type: ignore[attr-defined]
    for shown, lines in (
        (repr(maglev_stage.plant()), ("Plant ", "state", "tolerance")),
        (repr(control.controller(maglev_stage.plant()).interface), ("Interface to the plant", "sensor", "set-point")),
        (repr(axes.block(1)), ("Block axes_1", "input", "output")),
        (repr(Evidence("stage", (), (Check("replay", 2, 1, "1"),))), ("1 checks, 1 failed", "replay", "FAILED")),
    ):
        assert all(line in shown for line in lines) and "SX(" not in shown, shown


def test_of_a_large_table_the_ends_are_shown_in_text_and_in_html() -> None:
    names = [f"n{k}" for k in range(200)]
    sheet = show.Sheet("large", tuple(names), (show.matrix("", np.diag(np.arange(200.0)), names, names),))
    lines = show.text(sheet).splitlines()
    assert lines[1:34] == [*names[:16], "...", *names[-16:]]
    assert lines[34].split() == [*names[:8], "...", *names[-8:]]
    assert [line.split()[0] for line in lines[35:]] == [*names[:16], "...", *names[-16:]]
    assert lines[36].split() == ["n1", "0", "1", *"000000", "...", *"00000000"]
    assert lines[-1].split()[-1] == "199"
    html = show.html(sheet)
    assert len(html) < 20_000 and html.count("<tr>") == 34 and html.count("<th>") == 18 and "<td>199</td>" in html
    small = show.matrix("", np.eye(16), names[:16], names[:16])
    assert "..." not in show.text(show.Sheet("small", (), (small,)))


def test_a_unit_stands_in_brackets_where_it_is_known() -> None:
    assert show.with_unit("gap", "m") == "gap [m]" and show.with_unit("gap", "") == "gap"
