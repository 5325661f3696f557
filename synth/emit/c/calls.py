"""Calls: a program in which the Parts that are alike are calls of Routines, each a program of its own.

    call      of a Routine for one Block: it reads its arguments and the Block's states, and stores the next ones
    result    a value that a call returns
    argument, parameter    in a Routine: what its caller passes, and a number that differs from Block to Block

The states of a Block whose next values a call stores are one state of the program, under the Block's name.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

from synth.emit.c import routine as routines
from synth.emit.c.routine import TAKEN, Call, Group, Names
from synth.emit.passes.outline import Form, Part
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
