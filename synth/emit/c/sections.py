"""Sections of a step: which Block of the composition a statement belongs to, and the comments that open its sections.

A section opens where its Block's statements stand together: for a few of them in another section none opens, as their
names say what they are. The equations of a Block stand where most of its statements do; those of a Block with a
function stand at the function.

Calls: a program in which the Parts that are alike are calls of Routines, each a program of its own.

    call      of a Routine for one Block: it reads its arguments and the Block's states, and stores the next ones
    result    a value that a call returns
    argument, parameter    in a Routine: what its caller passes, and a number that differs from Block to Block

The states of a Block whose next values a call stores are one state of the program, under the Block's name.
"""

import re
from collections import defaultdict
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import groupby

from synth.emit.c import routine as routines
from synth.emit.c.lines import Line, opening, prose
from synth.emit.c.routine import TAKEN, Call, Group, Names
from synth.emit.passes.outline import Branch, Form, Owners, Part, Statement
from synth.emit.program.lower import Node, Program


def outlined(p: Program, constants: Mapping[str, float], groups: Sequence[Group]) -> Program:
    """Return the program with a call for each Part of some groups; `constants` are the values by name."""
    taken = Names(set(TAKEN))
    calls: dict[str, Call] = {}
    parts: dict[str, tuple[Part, Form]] = {}
    for group in groups:
        calls |= _calls(p, group, taken, constants)
        parts |= {part.key: (part, form) for part, form in group}
    made = _Rewriter(p, parts, calls).program()
    return replace(made, paths={s: f"{part}.{s.removeprefix(f'{part}_')}" for s, part in owners(made).items()})


def _calls(p: Program, group: Group, taken: Names, constants: Mapping[str, float]) -> dict[str, Call]:
    """Return by Part the call of the function that a group has in common."""
    routine = routines.routine(p, group, taken, constants)
    calls, places = {}, routines.different(p, group, constants)
    for part, form in group:
        numbers = tuple(p.nodes[form.numbers[place]] for place in places)
        states = {local: state for state, local in part.local.items() if local in routine.states}
        names = tuple(
            routines.name(p, k) or f"{part.key}_{r.name}" for k, r in zip(form.results, routine.results, strict=True)
        )
        calls[part.key] = Call(routine, part.block, numbers, names, states)
    return calls


class _Rewriter:
    """Builds the program with calls, each node and call after its operands."""

    def __init__(self, p: Program, parts: Mapping[str, tuple[Part, Form]], calls: Mapping[str, Call]) -> None:
        self.p, self.parts, self.calls = p, parts, calls
        self.within = {k: key for key, (part, _) in parts.items() for k in part.region}
        self.nodes: list[Node] = []
        self.index: dict[int, int] = {}
        self.called: dict[str, int] = {}

    def program(self) -> Program:
        p = self.p
        stored = {state for part, _ in self.parts.values() for state in part.next}
        held = {p.next[state] for state in stored}
        for k in range(len(p.nodes)):
            if k not in held and (k not in self.within or self.is_result(k)):
                self.place(k)
        outputs = {name: self.place(k) for name, k in p.outputs.items()}
        next = {name: self.place(k) for name, k in p.next.items() if name not in stored}
        for key, (part, _) in self.parts.items():
            if part.next:
                next[part.block] = self.store(key, part)
        word = None if p.word is None else self.place(p.word)
        marks = tuple(
            (n, self.place(k)) for n, k in p.marks if k not in self.within or k in self.index or self.is_result(k)
        )
        labels = {self.index[k]: name for k, name in p.labels.items() if k in self.index}
        typed = {f"{key}.{r.name}": r.kind for key, call in self.calls.items() for r in call.routine.results}
        p = replace(
            p,
            nodes=tuple(self.nodes),
            marks=marks,
            outputs=outputs,
            next=next,
            word=word,
            calls=self.calls,
            typed=typed,
            labels=labels,
        )
        return p.with_nodes(p.nodes, range(len(p.nodes)))

    def is_result(self, k: int) -> bool:
        return k in self.parts[self.within[k]][0].results

    def put(self, node: Node) -> int:
        self.nodes.append(node)
        return len(self.nodes) - 1

    def place(self, k: int) -> int:
        if k not in self.index:
            self.index[k] = self.result(k) if k in self.within else self.copy(k)
        return self.index[k]

    def copy(self, k: int) -> int:
        node = self.p.nodes[k]
        return self.put(replace(node, args=tuple(self.place(a) for a in node.args)))

    def result(self, k: int) -> int:
        key = self.within[k]
        routine, form = self.calls[key].routine, self.parts[key][1]
        return self.put(Node("result", (self.call(key),), name=f"{key}.{routine.results[form.results.index(k)].name}"))

    def call(self, key: str) -> int:
        if key not in self.called:
            part, form = self.parts[key]
            args = [self.place(k) for k in form.arguments]
            args += [self.load(part.block)] if self.calls[key].routine.states else []
            # What others read of the states is loaded before they are stored.
            args += [self.place(k) for k in self.loads(part)] if part.next else []
            # The next states are stored after the signals have read the present ones.
            before = f"{part.block}_output"
            args += [self.call(before)] if part.phase == "update" and before in self.parts else []
            self.called[key] = self.put(Node("call", tuple(args), name=key))
        return self.called[key]

    def loads(self, part: Part) -> list[int]:
        return [k for k, node in enumerate(self.p.nodes) if node.op == "state" and node.name in part.local]

    def load(self, block: str) -> int:
        node = Node("state", name=block)
        return self.nodes.index(node) if node in self.nodes else self.put(node)

    def store(self, key: str, part: Part) -> int:
        if part.held is None:
            return self.call(key)
        condition, arm = part.held
        sides = (self.call(key), self.load(part.block))
        return self.put(Node("choose", (self.place(condition), *(sides if arm == 0 else sides[::-1]))))


def owners(p: Program) -> dict[str, str]:
    """Return by state the Block whose struct it belongs to, of the Blocks that are called."""
    return {state: c.block for c in p.calls.values() for state in c.states.values()}


def forms(p: Program) -> dict[tuple[str, ...], tuple[str, ...]]:
    """Return for each set of states that several Blocks have the Blocks that have it."""
    states: dict[str, dict[str, None]] = {}
    for call in p.calls.values():
        states.setdefault(call.block, {}).update(dict.fromkeys(call.routine.states))
    by_states: dict[tuple[str, ...], list[str]] = {}
    for block, names in states.items():
        if names:
            by_states.setdefault(tuple(sorted(names)), []).append(block)
    return {names: tuple(blocks) for names, blocks in by_states.items()}


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
