"""Sections of a step: which Block of the composition a statement belongs to, and the comments that open its sections.

A section opens where its Block's statements stand together: for a few of them in another section none opens, as their
names say what they are. The equations of a Block stand where most of its statements do; those of a Block with a
function stand at the function.
"""

import re
from collections import defaultdict
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby

from synth.emit.c.lines import Line, opening, prose
from synth.emit.passes.owners import Owners
from synth.emit.passes.statements import Branch, Statement
from synth.emit.program.lower import Program

FEWEST = 3  # statements that open a section where a Block has more of them elsewhere
MANY_COPIES = 6  # next states that were computed before and are stored together
CALLS, STATES = "functions above", "next states of the sections above"
_COMMENT = ("/*", "*")
_COPY = re.compile(r"state->[\w.]+ = \w+;")
_IDLE = re.compile(rf"{_COPY.pattern}|(float|double|bool|uint32_t) .*;|if .*")  # what computes nothing
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

    def __init__(self, name: str, p: Program, lines: Sequence[Line]) -> None:
        self.lines, self.equations = lines, {prose(p.titles[part]): rows for part, rows in p.equations.items()}
        self.notes = {prose(p.titles[part]): texts for part, texts in p.notes.items() if part in p.titles}
        called = {prose(p.titles[call.block]) for call in p.calls.values()}
        self.headings = [CALLS if line.tag in called else line.joint or line.tag for line in lines]
        self.functions = {f"{name}_{c.routine.name}": c.routine.name for c in p.calls.values()}
        few = {k for k, run in self._runs().items() if run not in self.most and run.size[0] < FEWEST}
        copies = [k in few and _COPY.fullmatch(line.text.strip()) is not None for k, line in enumerate(lines)]
        for copy, group in groupby(range(len(lines)), key=copies.__getitem__):
            places = [*group]
            heading = STATES if copy and len(places) >= MANY_COPIES else ""
            for k in few.intersection(places):
                self.headings[k] = heading
        self.runs = self._runs()
        self.opens = {run.first: run for run in self.runs.values()}

    def _runs(self) -> dict[int, _Run]:
        """Return the run of each line that has one."""
        runs, levels = dict[int, _Run](), [_Run("", 0)]
        for k, (line, heading) in enumerate(zip(self.lines, self.headings, strict=True)):
            text = line.text.strip()
            levels = levels[:-1] if text.startswith("}") else levels
            if heading and not text.startswith("}"):
                if heading != levels[-1].heading:
                    levels[-1] = _Run(heading, k)
                runs[k] = levels[-1]
                statements, rows = levels[-1].size
                levels[-1].size = (statements + (_IDLE.fullmatch(text) is None), rows + 1)
            levels += levels[-1:] if text.endswith("{") else []
        largest: dict[str, _Run] = {}
        for run in runs.values():
            if run.size > largest.get(run.heading, _Run("", 0)).size:
                largest[run.heading] = run
        self.most = set(largest.values())
        return runs

    def _title(self, run: _Run, opened: Collection[str]) -> str:
        if run.heading == CALLS:
            words = (word for k, of in self.runs.items() if of is run for word in _WORD.findall(self.lines[k].text))
            names = dict.fromkeys(self.functions[word] for word in words if word in self.functions)
            return f"{CALLS}: {', '.join(names)}"
        return f"{run.heading} (continued)" if run.heading in opened and run.heading != STATES else run.heading

    def with_comments(self) -> list[Line]:
        """Return the lines with the comments that open the sections."""
        opened, printed = set[str](), list[Line]()
        for k, line in enumerate(self.lines):
            run = self.opens.get(k)
            if run:
                title = self._title(run, opened)
                notes = () if run.heading in opened else self.notes.get(run.heading, ())
                opened.add(run.heading)
                before, indent = printed[-1].text if printed else "", line.text[: -len(line.text.lstrip())]
                printed += [] if before == "" or before.endswith("{") else [Line("")]
                equations = self.equations.get(run.heading, ()) if run in self.most else ()
                printed += [Line(indent + row, line.tag) for row in opening([title], equations, notes, len(indent))]
            printed.append(line)
        return printed


def with_constants(
    lines: Sequence[Line], constants: Mapping[str, Callable[[str], Sequence[str]]]
) -> tuple[list[Line], list[Line]]:
    """Return the constants that several sections read, and the lines of a step with the others where theirs opens.

    `constants` has by its name in C what declares a constant behind an indentation.
    """
    read: dict[str, list[int]] = {name: [] for name in constants}
    scopes, scope, opened, heads = list[tuple[int, ...]](), tuple[int, ...](), [-1], list[int]()
    for k, line in enumerate(lines):
        text = line.text.strip()
        if text.startswith("}"):
            scope, opened = scope[:-1], opened[:-1]
        scopes.append(scope)
        opened[-1] = k if text.startswith(_COMMENT) and text.endswith("*/") and "@ admit" not in text else opened[-1]
        heads.append(opened[-1])
        for word in set(_WORD.findall(text)) & read.keys() if not text.startswith(_COMMENT) else ():
            read[word].append(k)
        if text.endswith("{"):
            scope, opened = (*scope, k), [*opened, opened[-1]]
    at: dict[int, list[Line]] = defaultdict(list)
    for name, declare in constants.items():
        place = {heads[k] for k in read[name] if lines[k].tag}
        head = place.pop() if len(place) == 1 else -1
        inside = scopes[head] if head >= 0 else ()
        visible = all(scopes[k][: len(inside)] == inside for k in read[name])
        head, inside = (head, inside) if visible else (-1, ())
        tag = lines[head].tag if head >= 0 else ""
        at[head] += [Line(row, tag) for row in declare("    " * (len(inside) + 1))]
    return at[-1], [row for k, line in enumerate(lines) for row in (line, *at[k])]
