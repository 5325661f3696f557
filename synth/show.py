"""Display of results at a prompt and in a notebook (as the rich `repr` of pandas): a title, sentences and tables.

A class decorated with `with_repr`, or with `result`, describes itself once, by its method ``sheet()``. From the sheet
follow the text of a prompt (``__repr__``), the HTML of a notebook (``_repr_html_``) and, for matrices and equations,
LaTeX (``_repr_latex_``).
"""

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from html import escape
from typing import Any, Protocol, TypeVar, dataclass_transform

import numpy as np
from numpy.typing import ArrayLike

from synth.errors import DesignError

COLUMNS, ROWS = 16, 32  # of a table, and lines of sentences: the middle of a longer one is left out
DOTS = "..."
Cell = str | float
POSITIVE_FEEDBACK = "u = +K x: the sign is inside K. MATLAB and python-control use u = -K x: give them -K."
NEGATIVE_FEEDBACK = "u = -L x: the sign of MATLAB and python-control. This package's gains are K = -L."
_NUMBER = re.compile(r"[+-]?(\d|nan|inf)[\d.e+-]*([+-](\d|nan|inf)[\d.e+-]*i)?")
_LATEX = {"\\": r"\backslash ", " ": r"\ ", "~": r"\sim ", "^": r"\wedge "}


@dataclass(frozen=True)
class Table:
    """Rows of texts and numbers under their columns; numbers are shown to `digits` significant digits.

    A matrix has the names of its rows in the first column. `note` is a sentence and `equation` a formula in LaTeX that
    belong to the table. Raises DesignError when the number of cells in a row differs from the number of columns.
    """

    caption: str
    columns: tuple[str, ...]
    rows: tuple[tuple[Cell, ...], ...]
    digits: int = 4
    is_matrix: bool = False
    note: str = ""
    equation: str = ""

    def __post_init__(self) -> None:
        for row in self.rows:
            if len(row) != len(self.columns):
                raise DesignError(
                    f"table '{self.caption}': the row {row} has {len(row)} cells for {len(self.columns)} columns"
                )


@dataclass(frozen=True)
class Sheet:
    """The description of a result: sentences first, then tables."""

    title: str
    lines: tuple[str, ...] = ()
    tables: tuple[Table, ...] = ()


class Shown(Protocol):
    """An object with a sheet."""

    def sheet(self) -> Sheet:
        """Return the description of the object."""
        ...


K = TypeVar("K", bound=Callable[..., Shown])
R = TypeVar("R", bound=Shown)
T = TypeVar("T")


def with_repr(kind: K) -> K:
    """Add the display methods to a class with a sheet: text for a prompt, HTML and LaTeX for a notebook."""
    for method, form in {"__repr__": text, "_repr_html_": html, "_repr_latex_": latex}.items():
        setattr(kind, method, lambda self, form=form: form(self.sheet()))
    return kind


@dataclass_transform(frozen_default=True, eq_default=False)
def result(kind: type[R]) -> type[R]:
    """Make a class a frozen dataclass, compared by identity, with the display methods."""
    return with_repr(dataclass(frozen=True, eq=False, repr=False)(kind))


def number(value: complex, digits: int = 5) -> str:
    """Return a real or complex number with `digits` significant digits; without an imaginary part of 0."""
    if not np.imag(value):
        return f"{float(np.real(value)) + 0.0:.{digits}g}"  # + 0.0 removes the sign of a zero
    return f"{np.real(value):.{digits}g}{np.imag(value):+.{digits}g}i"


def with_unit(name: str, unit: str) -> str:
    """Return the name with its unit in brackets, or the name alone where the unit is unknown."""
    return f"{name} [{unit}]" if unit else name


def matrix(corner: str, values: ArrayLike, rows: Sequence[str], columns: Sequence[str]) -> Table:
    """Return a matrix (rows, columns), called `corner`, as a table with named rows and columns.

    Only the first and last rows and columns of a large matrix are kept.
    """
    A = np.asarray(values)
    if A.shape != (len(rows), len(columns)):
        raise ValueError(f"a matrix of shape {A.shape} has {len(rows)} names of rows and {len(columns)} of columns")
    i, j = (_elided(range(n), None, most) for n, most in zip(A.shape, (ROWS, COLUMNS), strict=True))
    body = tuple(
        (DOTS,) * (len(j) + 1) if row is None else (rows[row], *(DOTS if k is None else number(A[row, k]) for k in j))
        for row in i
    )
    return Table("", (corner, *(DOTS if k is None else columns[k] for k in j)), body, is_matrix=True)


def feedback(table: Table, sign: int = 1) -> Table:
    """Return the table of a state feedback, u = +K x or with the `sign` -1 u = -L x, with its sign convention."""
    note, equation = (POSITIVE_FEEDBACK, "u = +K x") if sign > 0 else (NEGATIVE_FEEDBACK, "u = -L x")
    return replace(table, note=note, equation=equation)


def ratio(symbol: str, variable: str, gain: float, zeros: Sequence[complex], poles: Sequence[complex]) -> str:
    """Return a transfer function by its gain, zeros and poles as LaTeX: K(s) = 2 (s + 1) / (s (s + 3))."""
    above, below = (
        "".join(_factor(variable, complex(v)) for v in _elided(values, np.nan, COLUMNS)) for values in (zeros, poles)
    )
    fraction = rf"\frac{{{above or 1}}}{{{below}}}" if below else above
    return rf"{symbol}({variable}) = {_latex_cell(number(gain))}\,{fraction}"


def signals(groups: Mapping[str, Sequence[Any]]) -> Table:
    """Return the Signals of each group, its name in the first column, with units and ranges."""
    rows = (
        (group, s.name, s.unit, number(s.low), number(s.high), s.about) for group, each in groups.items() for s in each
    )
    return Table("", ("", "name", "unit", "low", "high", "about"), tuple(rows))


def text(sheet: Sheet) -> str:
    """Return a sheet as text with aligned columns; a large table shows its first and last rows and columns."""
    lines = (line for table in sheet.tables for line in (*_sentences(table), *_align(_abbreviated(table))))
    return "\n".join([sheet.title, *_elided(sheet.lines, DOTS, ROWS), *lines])


def html(sheet: Sheet) -> str:
    """Return a sheet as HTML; a large table shows its first and last rows and columns."""
    lines = (f"<p>{escape(line)}</p>" for line in _elided(sheet.lines, DOTS, ROWS))
    parts = [f"<p><strong>{escape(sheet.title)}</strong></p>", *lines]
    for table in sheet.tables:
        columns, *body = _abbreviated(table)
        rows = [_row("th", columns), *(_row("td", row) for row in body)]
        parts += [f"<p>{escape(line)}</p>" for line in _sentences(table)]
        parts.append(f"<table>{''.join(rows)}</table>")
    return "\n".join(parts)


def latex(sheet: Sheet) -> str | None:
    """Return the equations and matrices of a sheet as LaTeX for MathJax, None where it has none."""
    parts = []
    for table in sheet.tables:
        parts += [table.equation] if table.equation else []
        parts += [_latex_matrix(table)] if table.is_matrix else []
    inside = r" \\[1ex] ".join(parts)
    return rf"$\displaystyle \begin{{gathered}} {inside} \end{{gathered}}$" if parts else None


def _latex_matrix(table: Table) -> str:
    """Return a matrix with its names above a line and left of one."""
    lines = _abbreviated(table)
    head, *rows = (" & ".join(map(_latex_cell, line)) for line in lines)
    body = r" \\ ".join(rows)
    layout = f"l|{'r' * (len(lines[0]) - 1)}"
    return rf"\begin{{array}}{{{layout}}} {head} \\ \hline {body} \end{{array}}"


def _latex_cell(cell: str) -> str:
    """Return a number or a name, escaped."""
    if cell == DOTS:
        return r"\cdots"
    if _NUMBER.fullmatch(cell):
        powers = re.sub(r"e\+?(-?)0*(\d+)", r"\\times 10^{\1\2}", cell)
        return powers.replace("nan", r"\mathrm{NaN}").replace("inf", r"\infty ")
    texts = re.split(r"\^(-?\d+)", cell)  # every second one is a power
    names = "".join(
        rf"^{{{text}}}" if k % 2 else re.sub(r"[\\ ~^{}_#$%&]", _escaped, text) for k, text in enumerate(texts)
    )
    return rf"\mathrm{{{names}}}"


def _escaped(character: re.Match[str]) -> str:
    return _LATEX.get(character[0], f"\\{character[0]}")


def _factor(variable: str, root: complex) -> str:
    """Return (s - root), s where the root is 0."""
    if np.isnan(root):
        return r"\cdots"
    if not root:
        return variable
    if root.imag:
        return rf"\left({variable} - ({_latex_cell(number(root))})\right)"
    return rf"\left({variable} {'-' if root.real > 0 else '+'} {_latex_cell(number(abs(root.real)))}\right)"


def _elided(items: Sequence[T], dots: T, most: int) -> tuple[T, ...]:
    """Return the items; of more than `most` + 1 the first and last `most` with `dots` between."""
    if len(items) <= most + 1:
        return tuple(items)
    return (*items[: most // 2], dots, *items[-(most // 2) :])


def _sentences(table: Table) -> list[str]:
    return [line for line in (table.caption, table.note) if line]


def _abbreviated(table: Table) -> list[tuple[str, ...]]:
    """Return columns and rows of texts without the middle of many rows and columns; the column of names stays."""

    def cells(line: Sequence[Cell]) -> tuple[str, ...]:
        texts = [cell if isinstance(cell, str) else number(cell, table.digits) for cell in line]
        return (*texts[:1], *_elided(texts[1:], DOTS, COLUMNS))

    columns = cells(table.columns)
    return [columns, *_elided([cells(row) for row in table.rows], (DOTS,) * len(columns), ROWS)]


def _align(lines: Sequence[tuple[str, ...]]) -> list[str]:
    """Return the lines of a table: numbers to the right, names and sentences to the left."""
    columns = [_column(k, cells) for k, cells in enumerate(zip(*lines, strict=True))]
    return ["  ".join(line).rstrip() for line in zip(*columns, strict=True)]


def _column(place: int, cells: Sequence[str]) -> list[str]:
    width = max(map(len, cells))
    numeric = place > 0 and (len(cells) == 1 or any(_NUMBER.fullmatch(cell) for cell in cells[1:]))
    return [cell.rjust(width) if numeric else cell.ljust(width) for cell in cells]


def _row(tag: str, cells: Sequence[str]) -> str:
    return "<tr>" + "".join(f"<{tag}>{escape(cell)}</{tag}>" for cell in cells) + "</tr>"
