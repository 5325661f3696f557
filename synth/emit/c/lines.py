"""Lines of C with the equation that each computes, and the comments that open a section."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from textwrap import wrap

WIDTH = 120  # columns of a line of code


@dataclass(frozen=True)
class Line:
    """One line of C, tagged with its Block and equation; the tag may be empty."""

    text: str
    tag: str = ""


def wrapped(lines: Iterable[Line]) -> Iterator[Line]:
    """Yield the lines with code in at most WIDTH columns; what is continued is indented beyond a block of its own."""
    for line in lines:
        text = line.text.lstrip()
        if len(line.text) <= WIDTH or text.startswith(("/*", "*", "#")):
            yield line
            continue
        indent = " " * (len(line.text) - len(text))
        further = indent + " " * (8 if text.endswith("{") else 4)
        rows = wrap(
            text,
            WIDTH,
            initial_indent=indent,
            subsequent_indent=further,
            break_on_hyphens=False,
            break_long_words=False,  # nested calls have no blank, and a name must not be cut
        )
        yield from (replace(line, text=row) for row in rows)


def opening(title: Sequence[str], equations: Sequence[str]) -> list[str]:
    """Return the comment that opens a section: the lines of its title, and its equations."""
    rows = [*title, *(f"    {prose(row)}" for row in equations)]
    return [f"{'/*' if row is rows[0] else ' *'} {row}" for row in rows[:-1]] + [
        f"{' *' if rows[1:] else '/*'} {rows[-1]} */"
    ]


def prose(text: str) -> str:
    """Return a text in which C comment delimiters are broken up."""
    return text.replace("*/", "* /").replace("/*", "/ *")
