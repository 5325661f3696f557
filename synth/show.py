"""How results look at a prompt and in a notebook: a title, sentences, and tables whose rows and columns are named.

A class decorated with `printed`, or with `result`, tells what it shows by its method ``sheet()``.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from html import escape
from typing import Protocol, TypeVar, dataclass_transform

import numpy as np
from numpy.typing import ArrayLike

COLUMNS, ROWS = 16, 32  # of a table, and lines of sentences: the middle of what has more is left out
DOTS = "..."


@dataclass(frozen=True)
class Table:
    """Named columns over rows of texts; each row is as long as `columns`."""

    columns: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]


@dataclass(frozen=True)
class Sheet:
    """What a result shows: sentences first, then tables."""

    title: str
    lines: tuple[str, ...] = ()
    tables: tuple[Table, ...] = ()


class Shown(Protocol):
    """What has a sheet."""

    def sheet(self) -> Sheet:
        """Return what a prompt shows."""
        ...


K = TypeVar("K", bound=Callable[..., Shown])
R = TypeVar("R", bound=Shown)
T = TypeVar("T")


def printed(kind: K) -> K:
    """Let a class print its sheet: as text at a prompt, as HTML in a notebook."""
    setattr(kind, "__repr__", lambda self: text(self.sheet()))  # noqa: B010
    setattr(kind, "_repr_html_", lambda self: html(self.sheet()))  # noqa: B010
    return kind


@dataclass_transform(frozen_default=True, eq_default=False)
def result(kind: type[R]) -> type[R]:
    """Make a class a frozen dataclass, compared by identity, that prints its sheet."""
    return printed(dataclass(frozen=True, eq=False, repr=False)(kind))


def number(value: complex, digits: int = 5) -> str:
    """Return a real or complex number with `digits` significant digits; an imaginary part of 0 is left out."""
    if not np.imag(value):
        return f"{float(np.real(value)) + 0.0:.{digits}g}"  # + 0.0 takes the sign off a zero
    return f"{np.real(value):.{digits}g}{np.imag(value):+.{digits}g}i"


def named(name: str, unit: str) -> str:
    """Return the name with its unit in brackets, alone where no unit is known."""
    return f"{name} [{unit}]" if unit else name


def matrix(corner: str, values: ArrayLike, rows: Sequence[str], columns: Sequence[str]) -> Table:
    """Return a matrix (rows, columns), called `corner`, as a table with named rows and columns."""
    body = ((label, *(number(v) for v in row)) for label, row in zip(rows, np.asarray(values).tolist(), strict=True))
    return Table((corner, *columns), tuple(body))


def text(sheet: Sheet) -> str:
    """Return a sheet as lines of text, columns aligned; of a large table its first and last rows and columns."""
    lines = (line for table in sheet.tables for line in _aligned(_abbreviated(table)))
    return "\n".join([sheet.title, *_some(sheet.lines, DOTS, ROWS), *lines])


def html(sheet: Sheet) -> str:
    """Return a sheet as HTML; of a large table its first and last rows and columns."""
    lines = (f"<p>{escape(line)}</p>" for line in _some(sheet.lines, DOTS, ROWS))
    parts = [f"<p><strong>{escape(sheet.title)}</strong></p>", *lines]
    for table in map(_abbreviated, sheet.tables):
        rows = [_row("th", table.columns), *(_row("td", row) for row in table.rows)]
        parts.append(f"<table>{''.join(rows)}</table>")
    return "\n".join(parts)


def _some(items: Sequence[T], dots: T, most: int) -> tuple[T, ...]:
    """Return the items, when there are more than `most` the first and last of them with `dots` between."""
    if len(items) <= most:
        return tuple(items)
    return (*items[: most // 2], dots, *items[-(most // 2) :])


def _abbreviated(table: Table) -> Table:
    """Return a table without its middle columns and rows, where it has many; the column of names stays."""

    def cells(line: tuple[str, ...]) -> tuple[str, ...]:
        return (*line[:1], *_some(line[1:], DOTS, COLUMNS))

    columns = cells(table.columns)
    return Table(columns, _some([cells(row) for row in table.rows], (DOTS,) * len(columns), ROWS))


def _aligned(table: Table) -> list[str]:
    lines = (table.columns, *table.rows)
    widths = [max(len(line[k]) for line in lines) for k in range(len(table.columns))]
    return [
        "  ".join([line[0].ljust(widths[0]), *(v.rjust(w) for v, w in zip(line[1:], widths[1:], strict=True))]).rstrip()
        for line in lines
    ]


def _row(tag: str, cells: Sequence[str]) -> str:
    return "<tr>" + "".join(f"<{tag}>{escape(cell)}</{tag}>" for cell in cells) + "</tr>"
