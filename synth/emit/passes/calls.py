"""Calls: a program in which the Parts that are alike are calls of Routines, each a program of its own.

    call      of a Routine for one Block: it reads its arguments and the Block's states, and stores the next ones
    result    a value that a call returns
    argument, parameter    in a Routine: what its caller passes, and a number that differs from Block to Block

The states of a Block whose next values a call stores are one state of the program, under the Block's name.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

from synth.block import Named
from synth.emit.c.kinds import kinds
from synth.emit.c.naming import Naming
from synth.emit.lower import Node, Program
from synth.emit.passes import outline, words
from synth.emit.passes.outline import Form, Part
from synth.signals import Signal


class Argument(NamedTuple):
    """What a Routine is passed or returns: its name there and what C holds it in."""

    name: str
    kind: str


@dataclass(frozen=True)
class Routine:
    """A part that several Blocks have in common.

    `states` are the local names of the states it reads, those it stores first; `parameters` the local names of the
    numbers that differ.
    """

    name: str
    program: Program
    arguments: tuple[Argument, ...]
    parameters: tuple[str, ...]
    results: tuple[Argument, ...]
    states: tuple[str, ...]
    constants: Mapping[str, str]

    @property
    def by_value(self) -> bool:
        """Whether the parameters are passed as numbers: so few need no struct."""
        return len(self.parameters) <= 3


@dataclass(frozen=True)
class Call:
    """One use of a Routine: the Block, and by parameter the node's constant or number in the caller's program."""

    routine: Routine
    block: str
    numbers: tuple[Node, ...]
    names: tuple[str, ...]
    states: Mapping[str, str]


Group = list[tuple[Part, Form]]


def outlined(p: Program, constants: Mapping[str, float], groups: Sequence[Group]) -> Program:
    """Return the program with a call for each Part of some groups; `constants` are the values by name."""
    taken: set[str] = set()
    calls: dict[str, Call] = {}
    parts: dict[str, tuple[Part, Form]] = {}
    for group in groups:
        routine = _routine(p, group, taken, constants)
        for part, form in group:
            numbers = [p.nodes[form.numbers[k]] for k in _different(p, group, constants)]
            states = {local: state for state, local in part.local.items() if local in routine.states}
            names = tuple(
                _name(p, k) or f"{part.key}_{r.name}" for k, r in zip(form.results, routine.results, strict=True)
            )
            calls[part.key] = Call(routine, part.block, tuple(numbers), names, states)
            parts[part.key] = (part, form)
    made = _Rewriter(p, parts, calls).program()
    return replace(made, paths={s: f"{part}.{s.removeprefix(f'{part}_')}" for s, part in owners(made).items()})


def _different(p: Program, group: Sequence[tuple[Part, Form]], constants: Mapping[str, float]) -> list[int]:
    """Return the places of the numbers that are not the same in every Part of a group."""
    columns = zip(*(form.numbers for _, form in group), strict=True)
    return [k for k, column in enumerate(columns) if len({_value(p.nodes[n], constants) for n in column}) > 1]


def _value(node: Node, constants: Mapping[str, float]) -> float:
    return constants[node.name] if node.op == "constant" else node.value


def _name(p: Program, k: int) -> str:
    """Return what a node is called in the program: its signal, the state that it becomes, or what it loads."""
    node = p.nodes[k]
    named = next((n.signal.name for n, at in p.marks if at == k), "")
    state = next((f"{s}_next" for s, at in p.next.items() if at == k or k in p.nodes[at].args[1:]), "")
    return named or node.name or state


class _Names:
    """Names of one function, each given once."""

    def __init__(self, taken: set[str]) -> None:
        self.taken = taken

    def free(self, name: str) -> str:
        free, n = name, 2
        while free in self.taken:
            free, n = f"{name}_{n}", n + 1
        self.taken.add(free)
        return free


def _routine(
    p: Program, group: Sequence[tuple[Part, Form]], taken: set[str], constants: Mapping[str, float]
) -> Routine:
    """Return the function that the Parts of a group have in common, from the nodes of the first."""
    (part, form), kind = group[0], kinds(p)
    names = _Names({"state", "parameters"})
    part_name = words.common([q.block for q, _ in group]) or part.block
    arguments = [
        Argument(names.free(_local(p, column) or "value"), kind[column[0]])
        for column in zip(*(f.arguments for _, f in group), strict=True)
    ]
    parameters = {
        column: names.free(_parameter(p, group, column, part_name) or _role(p, part, form.numbers[column]))
        for column in _different(p, group, constants)
    }
    nodes: list[Node] = []
    index: dict[int, int] = {}
    fixed: dict[int, str] = {}

    def place(k: int) -> int:
        if k in index:
            return index[k]
        node = p.nodes[k]
        if k in part.region:
            node = replace(node, args=tuple(place(a) for a in node.args))
        elif k in form.arguments:
            node = Node("argument", name=arguments[form.arguments.index(k)].name)
        elif node.op == "state":
            node = replace(node, name=part.local[node.name])
        elif k in form.numbers and form.numbers.index(k) in parameters:
            node = Node("parameter", name=parameters[form.numbers.index(k)])
        elif node.op == "constant":
            fixed[k] = fixed.get(k) or names.free(_parameter(p, group, form.numbers.index(k), part_name) or node.name)
            node = Node("constant", name=fixed[k])
        nodes.append(node)
        index[k] = len(nodes) - 1
        return index[k]

    places = [place(k) for k in form.results]
    states = {part.local[state]: k for state, k in part.next.items()}
    next = {name: place(k) for name, k in states.items()}
    loads = [n.name for n in nodes if n.op == "state"]
    integers = frozenset(local for state, local in part.local.items() if state in p.integers)
    marks = tuple(
        (Named(replace(n.signal, name=words.common([n.signal.name]) or n.signal.name), part_name, n.tag), index[k])
        for n, k in p.marks
        if k in part.region and k not in part.results
    )
    typed = {a.name: a.kind for a in arguments}
    made = Program(
        tuple(nodes),
        marks,
        {},
        next,
        integers,
        None,
        p.polynomials,
        by_value=len(parameters) <= 3,
        typed=typed,
    )
    naming = Naming(made, {})
    columns = zip(*(f.results for _, f in group), strict=True)
    results = [
        Argument(names.free(_local(p, column) or naming.name(index)), kind[column[0]])
        for column, index in zip(columns, places, strict=True)
    ]
    made = replace(made, returns={a.name: index for a, index in zip(results, places, strict=True)})
    name = _Names(taken).free(f"{part_name}_{part.phase}" if part.phase else part_name)
    order = tuple(dict.fromkeys((*states, *loads)))
    shared = {local: p.nodes[k].name for k, local in fixed.items()}
    return Routine(name, made, tuple(arguments), tuple(parameters.values()), tuple(results), order, shared)


def _local(p: Program, column: Sequence[int]) -> str:
    return words.common([_name(p, k) for k in column])


def _parameter(p: Program, group: Sequence[tuple[Part, Form]], place: int, part_name: str) -> str:
    """Return what the Parts call a number, without the Blocks' names."""
    names = [p.nodes[form.numbers[place]].name for _, form in group]
    return words.common(names).removeprefix(f"{part_name}_") if all(names) else ""


def _role(p: Program, part: Part, number: int) -> str:
    """Return what a number without a name is to the operation that reads it."""
    reader = next(p.nodes[k] for k in sorted(part.region) if number in p.nodes[k].args)
    place = reader.args.index(number)
    if reader.op in ("le", "lt"):
        return "low" if place == 0 else "high"
    return {"clamp": "high", "mul": "factor", "min": "bound", "max": "bound"}.get(reader.op, "offset")


class _Rewriter:
    """Builds the program with calls, each node and call once what it needs stands."""

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
            # The next states are stored after the signals have read the present ones.
            before = f"{part.block}_output"
            args += [self.call(before)] if part.phase == "update" and before in self.parts else []
            self.called[key] = self.put(Node("call", tuple(args), name=key))
        return self.called[key]

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
    found: dict[tuple[str, ...], list[str]] = {}
    for block, names in states.items():
        if names:
            found.setdefault(tuple(sorted(names)), []).append(block)
    return {names: tuple(blocks) for names, blocks in found.items()}
