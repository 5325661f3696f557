"""Routines: each Part of a composition as a program of its own, and the step that calls them.

    call      of a Routine for one Block: it reads its arguments and the Block's states, and stores the next ones
    result    a value that a call returns
    argument, parameter    in a Routine: what its caller passes, and a number that differs from Block to Block

The states whose next values a call stores are one state of the step's program, under the name of the Part.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple

from synth.block import ComputedSignal
from synth.emit.c import diagnostics
from synth.emit.c.expressions import ACCEPTED, GUARDS, HELPERS, RESERVED
from synth.emit.c.locals import Names
from synth.emit.c.naming import Naming
from synth.emit.passes import law_functions
from synth.emit.passes.parts import BOTH, THEN, Form, Part, latch
from synth.emit.program import words
from synth.emit.program.lower import Node, Program
from synth.emit.proof.ranges import kinds

Group = list[tuple[Part, Form]]
BY_VALUE = 1  # numbers that need no struct, where the code reads each of them
MEMBERS = 2  # of a struct that a function reads, for which it is passed the struct
LARGE = 60  # operations of a function that is worth its calls where the size of the code counts
LOADS = ("input", "state", "constant", "literal", "argument", "parameter")
_ORDER = {"integer": 1, "logical": 2}  # of members of a struct, the others first
STEP = ("init", "step", "body", "guard_inputs", "law", "latched", "input", "output", "state")
TAKEN = {*HELPERS, *GUARDS, *STEP, "times"}


class Argument(NamedTuple):
    """What a Routine is passed or returns: its name there and what C holds it in."""

    name: str
    kind: str


@dataclass(frozen=True)
class Routine:
    """A part that several Blocks have in common.

    `states` are the local names of the states it reads, those it stores first; `parameters` the local names of the
    numbers that differ. `structs` are the types of those of which it reads several members, by their names there.
    """

    name: str
    program: Program
    arguments: tuple[Argument, ...]
    parameters: tuple[str, ...]
    results: tuple[Argument, ...]
    states: tuple[str, ...]
    constants: Mapping[str, str]
    structs: Mapping[str, str] = field(default_factory=dict)

    @property
    def members(self) -> tuple[Argument, ...]:
        """The results in the order of the struct that returns several of them: numbers, counts, truth values."""
        return tuple(sorted(self.results, key=lambda r: _ORDER.get(r.kind, 0)))

    @property
    def by_value(self) -> bool:
        """Whether the parameters are passed as numbers."""
        return self.program.by_value

    @property
    def is_large(self) -> bool:
        """Whether a compiler that optimises for size need not inline it."""
        return sum(n.op not in LOADS for n in self.program.nodes) >= LARGE


@dataclass(frozen=True)
class Call:
    """One use of a Routine: the Block, and by parameter the node's constant or number in the caller's program."""

    routine: Routine
    block: str
    numbers: tuple[Node, ...]
    result_names: tuple[str, ...]
    states: Mapping[str, str]
    caller: str = ""

    @property
    def parameters(self) -> str:
        """The name of the struct of its numbers, of which the functions that call it have one each."""
        return f"{self.caller}_{self.block}" if self.caller else f"{self.block}_{self.routine.name}"


class Functions(NamedTuple):
    """The names of functions, and those that are made by what they compute: several callers have one in common."""

    taken: Names
    by_form: dict[object, Routine]


def routine(
    p: Program,
    group: Group,
    functions: Functions,
    constants: Mapping[str, float],
    caller: str = "",
    of_step: Mapping[str, str] | None = None,
) -> Routine:
    """Return the function that the Parts of a group have in common, with those that it calls."""
    return _Builder(p, group, constants).routine(functions, caller, of_step or {})


def calls_by_routine(p: Program) -> dict[str, list[Call]]:
    """Return by Routine the calls in a program and in the Routines that it calls, each before the one that calls it."""
    made: dict[str, list[Call]] = {}
    for call in p.calls.values():
        if call.routine.name not in made:
            made |= calls_by_routine(call.routine.program)
        made.setdefault(call.routine.name, []).append(call)
    return made


def different(p: Program, group: Group, constants: Mapping[str, float]) -> list[int]:
    """Return the places of the numbers that are not the same in every Part of a group, nor minus such a number."""
    columns, negatives = zip(*(form.numbers for _, form in group), strict=True), _negatives(p, group)
    several = [k for k, column in enumerate(columns) if len({_value(p.nodes[n], constants) for n in column}) > 1]
    return [k for k in several if k not in negatives]


def _negatives(p: Program, group: Group) -> dict[int, int]:
    """Return by place of a number the place of another one, of which it is the negative in every Part of a group."""
    columns = zip(*([p.nodes[n] for n in form.numbers] for _, form in group), strict=True)
    signed = [tuple((n.name, n.value if n.op == "literal" else math.copysign(1, n.value)) for n in c) for c in columns]
    places = {column: k for k, column in enumerate(signed)}
    opposite = {k: places.get(tuple((name, -value) for name, value in column)) for k, column in enumerate(signed)}
    return {k: of for k, of in opposite.items() if of is not None and all(value < 0 for _, value in signed[k])}


def name(p: Program, k: int) -> str:
    """Return what a node is called in the program: its signal, what it loads, or the state that it becomes."""
    node = p.nodes[k]
    named = next((n.signal.name for n, at in p.marks if at == k), "")
    state = next((f"{s}_next" for s, at in p.next.items() if at == k or k in p.nodes[at].args[1:]), "")
    return named or node.name or state


def _value(node: Node, constants: Mapping[str, float]) -> float:
    return (-1.0 if node.value < 0 else 1.0) * constants[node.name] if node.op == "constant" else node.value


class _Builder:
    """Builds a Routine from the nodes of a group's first Part."""

    def __init__(self, p: Program, group: Group, constants: Mapping[str, float]) -> None:
        self.p, self.group, self.kind, self.naming = p, group, kinds(p), Naming(p, {}, {})
        self.values = constants
        self.part, self.form = group[0]
        self.part_name = words.common([part.block for part, _ in group]) or self.part.block
        self.names = Names({*RESERVED})
        results = self._columns("results")
        self.result_names = [self._free(self._common(column) or self._label(column)) for _, column in results]
        self.arguments = {k: self._argument(column) for k, column in self._columns("arguments")}
        self.parameters = {
            self.form.numbers[place]: self.names.free(self._number(place) or self._role(self.form.numbers[place]))
            for place in different(p, group, constants)
        }
        self.negatives = {self.form.numbers[k]: self.form.numbers[of] for k, of in _negatives(p, group).items()}
        self.nodes: list[Node] = []
        self.index: dict[int, int] = {}
        self.constants: dict[str, str] = {}

    def routine(self, functions: Functions, caller: str, of_step: Mapping[str, str]) -> Routine:
        part = self.part
        places = [self._place(k) for k in self.form.results]
        next = {part.local[state]: self._place(k) for state, k in part.next.items()}
        made = self._program(next)
        naming = Naming(made, {}, {})
        results = [
            Argument(name or self.names.free(naming.name(at)), self.kind[column[0]])
            for at, name, (_, column) in zip(places, self.result_names, self._columns("results"), strict=True)
        ]
        made = replace(made, returns={r.name: at for r, at in zip(results, places, strict=True)})
        if len(self.group) == 1:
            shown = {*made.returns, *(named.signal.name for named, _ in made.marks)}
            limits = shown.intersection(s.name for s in self.p.limited)
            recorded = tuple(s for s in self.p.recorded if s.name in shown)
            made = replace(made, recorded=recorded, limited=self.p.limited if limits else ())
        states = dict.fromkeys((*next, *(n.name for n in self.nodes if n.op == "state")))
        parameters, arguments = tuple(self.parameters.values()), tuple(self.arguments.values())
        free = functions.taken.free("_".join(filter(None, [caller, self.part_name, part.phase])))
        values = {local: self.values[name] for local, name in self.constants.items()}
        constants = {local: of_step.get(name, name) for local, name in self.constants.items()}
        made = _with_calls(made, values, law_functions.alike(made), functions, caller or free, constants, not caller)
        made = replace(made, calls={key: replace(call, caller=free) for key, call in made.calls.items()})
        read = {n.name for n in (*made.nodes, *(n for c in made.calls.values() for n in c.numbers))}
        constants = {local: name for local, name in constants.items() if local in read}
        return Routine(free, made, arguments, parameters, tuple(results), tuple(states), constants)

    def _program(self, next: dict[str, int]) -> Program:
        part, p = self.part, self.p
        marks = tuple(
            (ComputedSignal(n.signal, self.part_name, n.tag), self.index[k])
            for n, k in p.marks
            if k in part.region and k not in part.results and k in self.index
        )
        return Program(
            tuple(self.nodes),
            marks,
            {},
            next,
            frozenset(local for state, local in part.local.items() if state in p.integers),
            polynomials=p.polynomials,
            matrices=p.matrices,
            by_value=len(self.parameters) <= BY_VALUE and self._reads_parameters(),
            typed={a.name: a.kind for a in self.arguments.values()},
            labels={self.index[k]: name for k, name in p.labels.items() if k in part.region and k in self.index},
            functions={
                path.partition(".")[2]: f.renumbered({k: i for k, i in self.index.items() if k in part.region})
                for path, f in p.functions.items()
                if path.startswith(f"{part.block}.")
            },
        )

    def _reads_parameters(self) -> bool:
        """Tell whether the code reads each parameter: one that only a comment for Frama-C reads needs a struct."""
        read = {a for n in self.nodes for a in (n.args[:1] if n.op == "within" else n.args)}
        unread = {n.name for k, n in enumerate(self.nodes) if n.op == "parameter" and k not in read}
        return unread <= {self.nodes[k].name for k in read}

    def _columns(self, field: str) -> list[tuple[int, tuple[int, ...]]]:
        """Return for each argument or result the node in the first Part and those in all Parts."""
        columns = zip(*(getattr(form, field) for _, form in self.group), strict=True)
        return [(column[0], column) for column in columns]

    def _place(self, k: int) -> int:
        if k not in self.index:
            node = self._node(k)
            self.nodes.append(node)
            self.index[k] = len(self.nodes) - 1
        return self.index[k]

    def _node(self, k: int) -> Node:
        """Return a node of the Part as it is in the Routine."""
        node = self.p.nodes[k]
        if k in self.part.region or k in self.part.copies:
            return replace(node, args=tuple(self._place(a) for a in node.args))
        if k in self.arguments:
            return Node("argument", name=self.arguments[k].name)
        if node.op == "state":
            return replace(node, name=self.part.local[node.name])
        if self.negatives.get(k, k) in self.parameters:
            return Node("parameter", name=self.parameters[self.negatives.get(k, k)], value=-float(k in self.negatives))
        if node.op == "constant" or node.name:
            local = next((local for local, name in self.constants.items() if name == node.name), "")
            local = local or self.names.free(self._number(self.form.numbers.index(k)) or node.name)
            self.constants[local] = node.name
            return replace(node, name=local)
        return node

    def _argument(self, column: Sequence[int]) -> Argument:
        name = self._common(column) or self._label(column) or self.naming.name(column[0])
        is_state = all(self.p.nodes[k].op == "state" for k in column)
        name = f"{name}_before" if is_state and name in self.names.taken else name
        return Argument(self.names.free(name), self.kind[column[0]])

    def _free(self, name: str) -> str:
        return self.names.free(name) if name else ""

    def _common(self, column: Sequence[int]) -> str:
        return words.common([name(self.p, k) for k in column]).removeprefix(f"{self.part_name}_")

    def _label(self, column: Sequence[int]) -> str:
        return words.common([self.p.labels.get(k, "") for k in column])

    def _number(self, place: int) -> str:
        """Return what the Parts call a number, without the Blocks' names."""
        names = [self.p.nodes[form.numbers[place]].name for _, form in self.group]
        common = words.common(names) if all(names) else ""
        short = common.removeprefix(f"{self.part_name}_")
        return short if short.isidentifier() else common

    def _role(self, number: int) -> str:
        """Return what a number without a name is to the operation that reads it."""
        at = next(k for k in sorted(self.part.region) if number in self.p.nodes[k].args)
        reader = self.p.nodes[at]
        place = reader.args.index(number)
        if reader.op == "within":
            return f"{'least' if place == 1 else 'largest'}_{name(self.p, at)}"
        if reader.op in ("le", "lt"):
            return "low" if place == 0 else "high"
        if reader.op == "clamp" and place == 1:
            return "low"
        return {"clamp": "high", "mul": "factor", "min": "bound", "max": "bound"}.get(reader.op, "offset")


def outlined(p: Program, constants: Mapping[str, float], groups: Sequence[Group]) -> Program:
    """Return the program with a call for each Part of some groups; `constants` are the values by name."""
    recorded, limited = diagnostics.signals(p)
    p = replace(p, recorded=recorded, limited=limited)
    made = _with_calls(p, constants, groups, Functions(Names(set(TAKEN)), {}))
    calls = made.calls
    reached = {call.block for call in calls.values() if call.states}
    blocks = {state: block for state in p.next if (block := p.owner(state)) in reached}
    return replace(made, paths={s: f"{block}.{s.removeprefix(f'{block}_')}" for s, block in blocks.items()})


def _with_calls(
    p: Program,
    constants: Mapping[str, float],
    groups: Sequence[Group],
    functions: Functions,
    caller: str = "",
    names: Mapping[str, str] | None = None,
    structs: bool = True,
) -> Program:
    """Return a program with a call for each Part; `names` are those that the step has for the constants of a caller.

    Without `structs` they are passed values: functions that differ share those that they call.
    """
    calls: dict[str, Call] = {}
    of_call: dict[str, tuple[Part, Form]] = {}
    for group in groups:
        calls |= _calls(p, group, functions, constants, caller, names or {})
        of_call |= {part.key: (part, form) for part, form in group}
    made = _Rewriter(p, of_call, calls).program() if calls else p
    return _with_structs(made) if structs else made


def _with_structs(p: Program) -> Program:
    """Return the program whose functions are passed each struct of which they read several members."""
    calls = [n for n in p.nodes if n.op == "call"]
    made: dict[str, Routine] = {}
    for routine in {call.routine.name: call.routine for call in p.calls.values()}.values():
        used = [n.args[: len(routine.arguments)] for n in calls if p.calls[n.name].routine is routine]
        by_struct: dict[tuple[str, ...], dict[str, tuple[str, str]]] = {}
        for argument, column in zip(routine.arguments, zip(*used, strict=True), strict=True):
            structs, types, members, held = zip(*(_member(p, k) for k in column), strict=True)
            if all(structs) and len({*types}) == len({*members}) == 1 and {*held} == {argument.kind}:
                by_struct.setdefault(structs, {})[argument.name] = (types[0], members[0])
        names = Names({*RESERVED, *routine.parameters, *(a.name for a in routine.arguments)})
        passed: dict[str, str] = {}
        paths: dict[str, tuple[str, str]] = {}
        for structs, read in by_struct.items():
            if len(read) >= MEMBERS:
                kind = next(iter(read.values()))[0]
                name = names.free(structs[0] if len({*structs}) == 1 else kind)
                passed[name] = kind
                paths |= {argument: (name, member) for argument, (_, member) in read.items()}
        made[routine.name] = replace(routine, program=replace(routine.program, members=paths), structs=passed)
    return replace(p, calls={key: replace(call, routine=made[call.routine.name]) for key, call in p.calls.items()})


def _member(p: Program, k: int) -> tuple[str, str, str, str]:
    """Return the struct that holds a node, its type, the member and its kind; empty texts where none does."""
    node = p.nodes[k]
    if node.op == "guard":
        return ACCEPTED, "input", p.nodes[node.args[0]].name, "real"
    key, _, member = node.name.partition(".")
    results = p.calls[key].routine.results if node.op == "result" else ()
    kind = next((r.kind for r in results if r.name == member), "") if len(results) > 1 else ""
    return (key, p.calls[key].routine.name, member, kind) if kind else ("", "", "", "")


def _calls(
    p: Program,
    group: Group,
    functions: Functions,
    constants: Mapping[str, float],
    caller: str,
    of_step: Mapping[str, str],
) -> dict[str, Call]:
    """Return by Part the call of the function that a group has in common."""
    calls, places = {}, different(p, group, constants)
    made = group[0][1]
    values = [(n.op, n.value, of_step.get(n.name, n.name)) for n in (p.nodes[k] for k in made.numbers)]
    key = made.shape[: len(made.nodes)], *places, *_negatives(p, group).items(), *values
    shared = functions.by_form.get(key) if caller else None  # functions of several callers are one
    shared = shared or routine(p, group, functions, constants, caller, of_step)
    functions.by_form[key] = shared
    for part, form in group:
        numbers = tuple(p.nodes[form.numbers[place]] for place in places)
        if not shared.by_value:  # the struct of them is not in the caller
            numbers = tuple(replace(n, name=of_step.get(n.name, n.name)) for n in numbers)
        states = {local: state for state, local in part.local.items() if local in shared.states}
        names = tuple(name(p, k) or f"{part.key}_{r.name}" for k, r in zip(form.results, shared.results, strict=True))
        calls[part.key] = Call(shared, part.block, numbers, names, states)
    return calls


class _Rewriter:
    """Builds the program with calls, each node and call after its operands."""

    def __init__(self, p: Program, of_call: Mapping[str, tuple[Part, Form]], calls: Mapping[str, Call]) -> None:
        self.p, self.parts, self.calls = p, of_call, calls
        self.within = {k: key for key, (part, _) in of_call.items() for k in part.region}
        self.nodes: list[Node] = []
        self.index: dict[int, int] = {}
        self.called: dict[str, int] = {}

    def program(self) -> Program:
        p = self.p
        stored = {state for part, _ in self.parts.values() for state in part.next}
        held = {p.next[state] for state in stored} - {*p.outputs.values()}
        read = {a for k, node in enumerate(p.nodes) if k not in held | self.within.keys() for a in node.args}
        for k in range(len(p.nodes)):
            if (k not in held or k in read) and (k not in self.within or self.is_result(k)):
                self.place(k)
        outputs = {name: self.place(k) for name, k in p.outputs.items()}
        next = {name: self.place(k) for name, k in p.next.items() if name not in stored}
        next |= {key: self.store(key, part) for key, (part, _) in self.parts.items() if part.next}
        word = None if p.word is None else self.place(p.word)
        marks = tuple(
            (n, self.place(k)) for n, k in p.marks if k not in self.within or k in self.index or self.is_result(k)
        )
        labels = {self.index[k]: name for k, name in p.labels.items() if k in self.index}
        typed = {f"{key}.{r.name}": r.kind for key, call in self.calls.items() for r in call.routine.results}
        returns = {name: self.place(k) for name, k in p.returns.items()}
        p = replace(
            p,
            nodes=tuple(self.nodes),
            marks=marks,
            outputs=outputs,
            next=next,
            word=word,
            calls=self.calls,
            typed={**p.typed, **typed},
            labels=labels,
            returns=returns,
            functions={},
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
            args += [self.load(key)] if self.calls[key].routine.states else []
            # What others read of the states that it stores is loaded before, by the Block's own Parts as well.
            args += [self.place(k) for k in self.loads(part)]
            args += [self.call(earlier) for earlier in part.before]
            self.called[key] = self.put(Node("call", tuple(args), name=key))
        return self.called[key]

    def loads(self, part: Part) -> list[int]:
        """Return the loads of what a Part stores that something else than a function of its Block reads."""
        direct = {(k, state) for q, _ in self.parts.values() for k in q.region for state in q.local}
        loads = {k for k, node in enumerate(self.p.nodes) if node.op == "state" and node.name in part.next}
        used = {(k, a) for k, node in enumerate(self.p.nodes) for a in node.args if a in loads}
        read = {a for k, a in used if (k, self.p.nodes[a].name) not in direct}
        return sorted(read | (loads & {*self.p.outputs.values()}))

    def load(self, key: str) -> int:
        node = Node("state", name=key)
        return self.nodes.index(node) if node in self.nodes else self.put(node)

    def store(self, key: str, part: Part) -> int:
        if part.side == BOTH:
            return self.call(key)
        sides = (self.call(key), self.load(key))
        return self.put(Node("choose", (self.place(latch(self.p)), *(sides if part.side == THEN else sides[::-1]))))


def owners(p: Program) -> dict[str, str]:
    """Return by state the Block whose struct it belongs to, of the Blocks whose functions reach their states."""
    return {state: path.partition(".")[0] for state, path in p.paths.items()}


def forms(p: Program) -> dict[tuple[str, ...], tuple[str, ...]]:
    """Return for each set of states that several Blocks have the Blocks that have it; a count has the mark #."""
    states: dict[str, list[str]] = {}
    for state, path in p.paths.items():
        block, _, local = path.partition(".")
        states.setdefault(block, []).append(f"{local}#" if state in p.integers else local)
    by_states: dict[tuple[str, ...], list[str]] = {}
    for block, names in states.items():
        by_states.setdefault(tuple(sorted(names)), []).append(block)
    return {names: tuple(blocks) for names, blocks in by_states.items()}
