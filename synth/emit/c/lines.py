"""Lines of C with the equation that each computes, and the comments that open a section."""

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import accumulate, pairwise
from textwrap import wrap

WIDTH = 120  # columns of a line of code
_OPEN_END = re.compile(r"(,|[^\w)\]}])$")


@dataclass(frozen=True)
class Line:
    """One line of C, tagged with its Block and equation; the tag may be empty."""

    text: str
    tag: str = ""


def wrapped(lines: Iterable[Line]) -> Iterator[Line]:
    """Yield the lines with code in at most WIDTH columns; what is continued is indented beyond a block of its own."""
    for line in lines:
        if line.text.lstrip().startswith(("/*", "*", "#")):
            yield line
        else:
            yield from (replace(line, text=row) for row in rows(line.text))


def alternative(lines: Sequence[Line], depth: int, tag: str) -> list[Line]:
    """Return the lines from `} else {` to the last brace; an `if` alone that ends in an `else` follows in its line."""
    indent = "    " * depth
    inside = [line.text.removeprefix(f"{indent}    ") for line in lines]
    braces = [text for text in inside if text.startswith("}")]
    level = [text for text in inside if text[:1] not in (" ", "}", "#")]
    alone = len(level) == 1 and lines[0].tag == tag and inside[0].startswith("if (") and "} else {" in braces
    if not alone or any(len(text) == len(line.text) for text, line in zip(inside, lines, strict=True)):
        return [Line(f"{indent}}} else {{", tag), *lines, Line(f"{indent}}}", tag)]
    return [
        replace(line, text=f"{indent}{'} else ' if line is lines[0] else ''}{text}")
        for line, text in zip(lines, inside, strict=True)
    ]


def rows(text: str) -> list[str]:
    """Return a line of code in the fewest rows of at most WIDTH columns, broken where the fewest parentheses are open.

    By dynamic programming from the last word to the first. A name is never cut.
    """
    if len(text) <= WIDTH:
        return [text]
    words = text.split()
    first = " " * (len(text) - len(text.lstrip()))
    further = first + " " * (8 if text.endswith("{") else 4)
    costs = _break_costs(words)
    # For the words from i on: the number of rows, the cost of their breaks, and minus the index after the first row.
    best = {len(words): (0, 0, 0)}
    for i in reversed(range(len(words))):
        ends = accumulate((len(word) + 1 for word in words[i:]), initial=len(further if i else first) - 1)
        fitting = [i + n for n, end in enumerate(ends) if n == 1 or (n and end <= WIDTH)]
        best[i] = min((best[j][0] + 1, best[j][1] + costs[j], -j) for j in fitting)
    starts = [0]
    while starts[-1] < len(words):
        starts.append(-best[starts[-1]][2])
    return [(further if i else first) + " ".join(words[i:j]) for i, j in pairwise(starts)]


def _break_costs(words: Sequence[str]) -> list[int]:
    """Return by index the cost of a break before each word, and 0 after the last one.

    It is the number of open parentheses. A break stands after a comma or an operator, where it can; rather not after
    the `=` before a value, or within a product.
    """
    depths = accumulate(sum(map(word.count, "([{")) - sum(map(word.count, ")]}")) for word in words)
    joined = [0 if _OPEN_END.search(word) else 100 for word in words]
    extra = {"=": 3, "*": 1}
    costs = [depth + joint + extra.get(word, 0) for depth, joint, word in zip(depths, joined, words, strict=True)]
    return [0, *costs[:-1], 0]


def comment(text: str, indent: str = "") -> list[str]:
    """Return a comment in lines of at most WIDTH columns; its last word stands before the end of the comment."""
    lines = wrap(
        f"{indent}/* {text}\0*/",
        WIDTH,
        subsequent_indent=f"{indent} * ",
        break_on_hyphens=False,
        break_long_words=False,
    )
    return [row.replace("\0", " ") for row in lines]


def member(ctype: str, name: str, about: str) -> str:
    """Return a member of a struct with its comment beside it, or above it where they are long."""
    text, said = f"    {ctype} {name};", prose(about)
    row = f"{text:39} /* {said} */" if said else text
    return row if len(row) <= WIDTH else "\n".join([*comment(said, "    "), text])


def opening(title: Sequence[str], notes: Sequence[str] = (), indent: int = 0) -> list[str]:
    """Return the comment that opens a section behind an indentation: lines of its title, and notes."""
    width = WIDTH - indent - len(" *  */")
    said = [row for note in notes for row in wrap(prose(note), width, break_on_hyphens=False)]
    rows = [*title, *said]
    return [f"{'/*' if row is rows[0] else ' *'} {row}" for row in rows[:-1]] + [
        f"{' *' if rows[1:] else '/*'} {rows[-1]} */"
    ]


def prose(text: str) -> str:
    """Return a text in which C comment delimiters are broken up."""
    return text.replace("*/", "* /").replace("/*", "/ *")
