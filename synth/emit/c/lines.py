"""Lines of C with the equation that each computes, and the comments that open a section."""

from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True)
class Line:
    """One line of C, tagged with its Block and equation; the tag may be empty."""

    text: str
    tag: str = ""


def opening(title: Sequence[str], equations: Sequence[str]) -> list[str]:
    """Return the comment that opens a section: the lines of its title, and its equations."""
    rows = [*title, *(f"    {prose(row)}" for row in equations)]
    return [f"{'/*' if row is rows[0] else ' *'} {row}" for row in rows[:-1]] + [
        f"{' *' if rows[1:] else '/*'} {rows[-1]} */"
    ]


def prose(text: str) -> str:
    """Return a text in which C comment delimiters are broken up."""
    return text.replace("*/", "* /").replace("/*", "/ *")
