"""Sections of a step: which Block of the composition a statement belongs to, and the comments that open its sections.

A section opens where its Block's statements stand together: for a few of them in another section none opens, as their
names say what they are. The equations of a Block stand where most of its statements do; those of a Block with a
function stand at the function.
"""

import re
from collections import defaultdict
from collections.abc import Callable, Container, Mapping, Sequence
from dataclasses import dataclass

from synth.emit.c.lines import Line, opening, prose
from synth.emit.lower import Program
from synth.emit.passes.owners import Owners
from synth.emit.passes.statements import Branch, Statement

FEWEST = 4  # statements that open a section where a Block has more of them elsewhere
_COMMENT = ("/*", "*")
_WORD = re.compile(r"\b[A-Za-z_]\w*")


class Sections:
    """The sections of a program's text as it is printed, each tagged with the title of its Block."""

    def __init__(self, p: Program) -> None:
        self.titles = {owner: prose(title) for owner, title in p.titles.items()}
        self.owners = Owners(p)

    def tag(self, s: Statement, owner: str, tag: str) -> tuple[str, str]:
        """Return the owner and the tag of a statement behind those given."""
        owner = self.owners.of(s, owner) or owner
        return owner, self.titles.get(owner, tag or "next states")

    def joint_title(self, s: Branch) -> str:
        """Return the title of a branch of several short sections, "" for another one."""
        titles = [self.titles[owner].partition(": ") for owner in self.owners.together(s)]
        about = {title[2] for title in titles}
        return ", ".join(title[0] for title in titles) + (f": {about.pop()}" if len(about) == 1 else "")


@dataclass(eq=False)
class _Run:
    """Lines of one section on one level, with what stands in their branches: the first, statements and lines."""

    heading: str
    first: int
    size: tuple[int, int] = (0, 0)


class Headings:
    """The runs of the lines of a step, of which `most` has the one with most statements of each section.

    A line of another section among those of a run has no run, where it is one of few.
    """

    def __init__(self, p: Program, lines: Sequence[Line]) -> None:
        called = {call.block for call in p.calls.values()}
        self.equations = {prose(p.titles[part]): rows for part, rows in p.equations.items() if part not in called}
        self.lines, self.explained = lines, {prose(p.titles[part]) for part in called if part in p.titles}
        few = {k for k, run in self._runs(()).items() if run not in self.most and run.size[0] < FEWEST}
        self.opens = {run.first: run for run in self._runs(few).values()}

    def _runs(self, without: Container[int]) -> dict[int, _Run]:
        """Return the run of each line that has one."""
        runs, levels = dict[int, _Run](), [_Run("", 0)]
        for k, line in enumerate(self.lines):
            text = line.text.strip()
            levels = levels[:-1] if text.startswith("}") else levels
            heading = "" if k in without else line.joint or line.tag
            if heading not in ("", levels[-1].heading) and not text.startswith("}"):
                levels[-1] = _Run(heading, k)
            if heading and not text.startswith("}"):
                runs[k] = levels[-1]
                statements, rows = levels[-1].size
                levels[-1].size = (statements + (not text.startswith(("state->", "}"))), rows + 1)
            levels += levels[-1:] if text.endswith("{") else []
        largest: dict[str, _Run] = {}
        for run in runs.values():
            if run.heading not in self.explained and run.size > largest.get(run.heading, _Run("", 0)).size:
                largest[run.heading] = run
        self.most = set(largest.values())
        return runs

    def printed(self) -> list[Line]:
        """Return the lines with the comments that open the sections."""
        opened, printed = set[str](), list[Line]()
        for k, line in enumerate(self.lines):
            run = self.opens.get(k)
            if run:
                title = f"{run.heading} (continued)" if run.heading in opened else run.heading
                opened.add(run.heading)
                before, indent = printed[-1].text if printed else "", line.text[: -len(line.text.lstrip())]
                printed += [] if before == "" or before.endswith("{") else [Line("")]
                equations = self.equations.get(run.heading, ()) if run in self.most else ()
                printed += [Line(indent + row, line.tag) for row in opening([title], equations)]
            printed.append(line)
        return printed


def with_constants(
    lines: Sequence[Line], constants: Mapping[str, Callable[[str], Sequence[str]]]
) -> tuple[list[Line], list[Line]]:
    """Return the constants that several sections read, and the lines of a step with the others where theirs opens.

    `constants` has by its name in C what declares a constant behind an indentation.
    """
    read: dict[str, list[int]] = {name: [] for name in constants}
    scopes, scope = list[tuple[int, ...]](), tuple[int, ...]()
    for k, line in enumerate(lines):
        text = line.text.strip()
        scope = scope[:-1] if text.startswith("}") else scope
        scopes.append(scope)
        for word in set(_WORD.findall(text)) & read.keys() if not text.startswith(_COMMENT) else ():
            read[word].append(k)
        scope = (*scope, k) if text.endswith("{") else scope
    ends = [k for k, line in enumerate(lines) if _ends_heading(line.text)]
    at: dict[int, list[Line]] = defaultdict(list)
    for name, declare in constants.items():
        k = _section_of(read[name], ends, scopes)
        place, depth, tag = (-1, 0, "") if k is None else (k, len(scopes[k]), lines[k].tag)
        at[place] += [Line(row, tag) for row in declare("    " * (depth + 1))]
    return at[-1], [row for k, line in enumerate(lines) for row in (line, *at[k])]


def _ends_heading(text: str) -> bool:
    return text.strip().startswith(_COMMENT) and text.endswith("*/") and "@ admit" not in text


def _section_of(read: Sequence[int], ends: Sequence[int], scopes: Sequence[tuple[int, ...]]) -> int | None:
    """Return the last line of the heading of the section that has all lines which read a constant."""
    if not read:
        return None
    inside = scopes[read[0]]
    for k in reversed([k for k in ends if k < read[0] and scopes[k] == inside[: len(scopes[k])]]):
        after = (j for j in ends if j > k and scopes[j] == scopes[k][: len(scopes[j])])
        if read[-1] < next(after, len(scopes)) and all(scopes[j][: len(scopes[k])] == scopes[k] for j in read):
            return k
    return None
