"""Code printer: scheduled statements to lines of C, each tagged with the equation that it computes.

Locals are `const` unless an `if` assigns their value.
"""

import re
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from textwrap import wrap
from typing import TypeVar

import numpy as np

from synth.block import Block
from synth.blocks.guard import safety
from synth.emit.c import diagnostics, naming
from synth.emit.c import locals as variables
from synth.emit.c.expressions import ACCEPTED, WORD, Expressions, Text, admission, mask
from synth.emit.c.lines import Line, alternative, opening, prose
from synth.emit.c.locals import LOADS
from synth.emit.c.routine import Routine
from synth.emit.passes import parts, schedule
from synth.emit.passes.schedule import Assign, Branch, Let, Statement, Store
from synth.emit.program.lower import Node, Program
from synth.emit.proof.ranges import kinds

_WIDTH = 108
TWICE = 40  # characters of an expression that the diagnostics state again
# The functions of the two sides of the latch, and what each is.
SIDES = {
    "latched": "what the step does once it is latched",
    "law": "the law: what the step computes unless it is latched",
}
LONG = 20  # lines of a side that has a function: a shorter one stands in the step
_LOCAL = re.compile(r"    (?:const )?(?!static |return )(\w+) (\w+)(?: = .*)?;")
_ARRAY = re.compile(r"    (?:const )?\w+ (\w+)\[")
T = TypeVar("T")


@dataclass(frozen=True)
class Side:
    """A function of one side of the latch: what it is, its head, and its lines between the braces."""

    about: str
    head: str
    lines: list[Line]


@dataclass(frozen=True)
class Body:
    """The lines of the step between its braces, and the sides of the latch that have functions."""

    lines: list[Line]
    sides: list[Side]


def body(block: Block, p: Program, statements: Sequence[Statement], scalar: type[np.floating]) -> Body:
    """Return the step function."""
    return _print(lambda late: _Printer(block, p, statements, scalar, late).step)


def routine(block: Block, r: Routine, title: str, scalar: type[np.floating]) -> list[Line]:
    """Return the lines of a routine between its braces, tagged with a title."""
    statements = schedule.statements(r.program)
    return _print(lambda late: partial(_Printer(block, r.program, statements, scalar, late).routine, r, title))


def _print(printer: Callable[[set[str | int]], Callable[[], T]]) -> T:
    """Print; a load read after a store of its state, a sum that is cast or a bare arm is a local the next time."""
    late: set[str | int] = set()
    while True:
        before = len(late)
        lines = printer(late)()
        if len(late) == before:
            return lines


class _Printer:
    """Prints the statements of one program."""

    def __init__(
        self,
        block: Block,
        program: Program,
        statements: Sequence[Statement],
        scalar: type[np.floating],
        late: set[str | int],
    ) -> None:
        self.p, self.statements, self.kinds = program, statements, kinds(program)
        self.locals = variables.assign(block, program, statements, self.kinds)
        self.users = program.users()
        self.naming = naming.Naming(program, self.locals.name, self.locals.shared)
        self.c = Expressions(program, self.kinds, scalar, block.name, late)
        self.block, self.watched, self.returned = block, diagnostics.of_program(program), dict[str, str]()
        self.printed, self.owners, self.tag = list[Line](), parts.by_node(program), ""
        self.late, self.waiting = late, dict[str, str]()  # text of a load that no line has read yet, and its state
        self.unread = Counter[str]()  # how often a line will read it
        self.columns = dict[tuple[int, ...], str]()  # arrays of what matrices multiply
        self.sharing = Counter[tuple[int, ...]]()  # how many products of a block multiply it
        self.latch, self.sides = parts.latch(program), list[Side]()

    def routine(self, routine: Routine, title: str) -> list[Line]:
        """Return the lines of a routine's body."""
        self.tag = title
        self._block(self.statements, 1)
        self.tag = ""
        texts = {r.name: self.c.as_kind(self.p.returns[r.name], r.kind).c for r in routine.results}
        if len(texts) == 1:
            self._put(f"return {texts[routine.results[0].name]};", 1)
        elif texts:
            fields = ", ".join(f".{r.name} = {texts[r.name]}" for r in routine.members)
            self._put(f"return ({self.block.name}_{routine.name}_t){{{fields}}};", 1)
        return self.printed

    def step(self) -> Body:
        """Return the step."""
        self._block(self.statements, 1)
        self.tag = ""
        idle = [p for p in ("in", "state") if not any(re.search(rf"\b{p}(->|,)", line.text) for line in self.printed)]
        self.printed[:0] = [*(Line(f"    (void){pointer};") for pointer in idle), *([Line("")] if idle else [])]
        self.printed = [*self._with_headings(self.printed), Line("")]
        self._put(f"return {'0u' if self.p.word is None else self.c.integer(self.p.word).c};", 1)
        return Body(self.printed, self.sides)

    def _with_headings(self, lines: Sequence[Line]) -> list[Line]:
        """Return the lines with a comment before the first one of each Block that has no function: it has its own."""
        called = {call.block for call in self.p.calls.values()}
        titles = {prose(title): block for block, title in self.p.titles.items() if block not in called}
        printed: list[Line] = []
        for line in lines:
            block = titles.pop(line.tag, "")
            if block and not line.text.strip().startswith("}"):
                indent = line.text[: -len(line.text.lstrip())]
                rows = opening([line.tag], self.p.notes.get(block, ()), len(indent))
                printed += [Line("")] if printed and not printed[-1].text.endswith("{") else []
                printed += [Line(indent + row, line.tag) for row in rows]
            printed.append(line)
        return printed

    def _block(self, block: Sequence[Statement], depth: int) -> None:
        outside = self.sharing
        self.sharing = Counter(self._factors_of_matrices(block)) if self.p.matrices else outside
        for s in block:
            self._annotate(s)
            if isinstance(s, Let):
                self._let(s.node, depth)
            elif isinstance(s, Assign):
                variable = self.c.text[s.choice].c
                if s.node != self.locals.starts[s.choice] and self.c.text.get(s.node) != Text(variable):
                    self._put(self._assignment(s, variable), depth)
            elif isinstance(s, Store):
                self._store(s, depth)
            elif isinstance(s, Branch):
                self._branch(s, depth)
        self.sharing = outside
        self._record(block, depth)

    def _factors_of_matrices(self, block: Sequence[Statement]) -> Iterator[tuple[int, ...]]:
        """Yield what each product with a matrix in some statements multiplies."""
        for s in block:
            if isinstance(s, Let) and self.p.nodes[s.node].op == "product":
                yield self.p.nodes[s.node].args
            elif isinstance(s, Branch):
                yield from self._factors_of_matrices((*s.then, *s.other))

    def _record(self, block: Sequence[Statement], depth: int) -> None:
        """Record the signals that a block of statements computes, for the diagnostics."""
        made = [k for s in block for k in variables.local_nodes(s) if k in self.c.text]
        values = [(self.watched.signals[k], self.c.value(k).c) for k in made if k in self.watched.signals]
        limits = [(bit, self._at_limit(k)) for k, bit in self.watched.limited.items() if k in made]
        self.printed += map(Line, diagnostics.record_statements(values, limits, "    " * depth))

    def _at_limit(self, k: int) -> str:
        """Return the test whether a limited value is at its limit."""
        size = "fabsf" if self.c.scalar is np.float32 else "fabs"
        return f"{size}({self.c.text[k].c}) >= {self.c.value(self.p.nodes[k].args[2]).inside(4)}"

    def _assignment(self, s: Assign, variable: str) -> str:
        node = self.p.nodes[s.node]
        if node.op == "bit" and self.c.operand(node.args[0]).c == variable:
            return f"{variable} |= {mask(node)};"
        return f"{variable} = {self.c.as_kind(s.node, self.kinds[s.choice]).c};"

    def _annotate(self, s: Statement) -> None:
        owner = self.owners[s.node] if isinstance(s, Let | Assign | Store) else ""
        first = self.p.titles.get(safety.GUARD, next(iter(self.p.titles.values()), ""))
        self.tag = prose(self.p.titles[owner]) if owner in self.p.titles else self.tag or prose(first) or "next states"

    def _let(self, k: int, depth: int) -> None:
        """Print node k as a local variable, or keep its text for the expression that reads it."""
        node = self.p.nodes[k]
        if node.op == "call":
            self._call(node, depth)
            return
        if node.op == "guard":
            self._guard(k, depth)
            return
        if not self.locals.reads[k]:
            return
        if node.op == "guarded" or (node.op == "input" and self._is_guarded(k)):
            self.c.text[k] = Text(WORD) if node.op == "guarded" else self.c.of(k)
            return
        if node.op == "result":
            self.c.text[k] = Text(self.returned[node.name])
            return
        if node.op == "product":
            self._product(k, depth)
            return
        if node.op == "row":
            self.c.text[k] = Text(f"{self.c.text[node.args[0]].c}[{int(node.value)}]")
            return
        text = self.c.of(k)
        if k in self.locals.stored:
            place = f"state->{self._path(self.locals.stored[k])}"
            self._put(f"{place} = {text.c};", depth)
            self.c.text[k] = Text(place)
            return
        unnamed = k not in self.locals.name or k in self.locals.next_only
        waits = self.locals.reads[k] <= 1 and unnamed and node.op not in (*LOADS, "within") and k not in self.late
        waits = waits and (k not in self.watched.signals or len(text.c) <= TWICE)
        # An analyser learns from a condition what it does not learn from a variable that holds it.
        width = _WIDTH if self.kinds[k] != "logical" else 2 * _WIDTH
        if waits and (self.naming.width(text.c) < width or k in self.locals.at_once):
            self.c.text[k] = text
            return
        once = self.locals.reads[k] == 1 and (k in self.locals.direct_loads or self._can_wait(node))
        may_wait = (node.op == "input" or self._can_wait(node)) and k not in self.watched.signals
        if once or (may_wait and any(self.p.nodes[u].op == "product" for u in self.users[k])):
            self.waiting |= {} if k in self.locals.direct_loads else {text.c: node.name}
            self.unread[text.c] = self.locals.reads[k]
            self.c.text[k] = text
            return
        name = self.locals.name.get(k) or self._new_name(k)
        self.c.text[k] = Text(name)
        self._put(f"const {self.c.ctype(k)} {name} = {text.c};", depth)
        if node.op == "within":
            low, high = (self.c.value(a).c for a in node.args[1:])
            self._put(admission(name, low, high), depth)

    def _product(self, k: int, depth: int) -> None:
        """Print the values that a matrix multiplies as an array, and the call that fills an array with its rows."""
        node = self.p.nodes[k]
        matrix = self.p.matrices[node.name]
        if node.args not in self.columns:
            self.columns[node.args] = self.locals.identifiers.free("columns")
            self._put(f"const {self.c.ctype(k)} {self.columns[node.args]}[{len(node.args)}] = {{", depth)
            texts = wrap(", ".join(self.c.value(a).c for a in node.args), _WIDTH - 4 * depth, break_on_hyphens=False)
            for row in [*(f"    {text}" for text in texts), "};"]:
                self._put(row, depth)
            for a in node.args:  # the array has it for the other products in its scope
                self._note_reads(self.c.operand(a).c, self.sharing[node.args] - 1)
        rows = self.locals.identifiers.free(f"{node.name.removesuffix('_matrix')}_rows")
        self._put(f"{self.c.ctype(k)} {rows}[{len(matrix.rows)}];", depth)
        self._put(f"{self.block.name}_{node.name}_times({self.columns[node.args]}, {rows});", depth)
        self.c.text[k] = Text(rows)

    def _branch(self, s: Branch, depth: int) -> None:
        for c, start in s.choices:
            if c in self.locals.shared:
                self.c.text[c] = self.c.text[self.locals.shared[c]]
                continue
            name = self.locals.name.get(c) or self._new_name(c)
            value = "" if start is None else f" = {self.c.as_kind(start, self.kinds[c]).c}"
            self._put(f"{self.c.ctype(c)} {name}{value};", depth)
            self.c.text[c] = Text(name)
        condition, negation, tag = self.c.condition(s.condition), self.c.negation(s.condition), self.tag
        before, sides = self.printed, []
        outside = self.columns
        for side in (s.then, s.other):
            self.printed, self.tag, self.columns = [], tag, {**outside}
            for bound in self.c.bounds_of_squares(s.condition) if side is s.then else ():
                self._put(bound, depth + 1)
            self._block(side, depth + 1)
            sides.append(self.printed)
        (then, other), self.printed, self.tag, self.columns = sides, before, tag, outside
        if s.condition == self.latch and depth == 1:
            then, other = map(self._as_function, SIDES, (then, other))
        if then:
            self._put(f"if ({condition.c}) {{", depth)
            self.printed += then
        else:
            self._put(f"if ({negation.c}) {{", depth)
            self.printed += other
        if then and other:
            self.printed += alternative(other, depth, self.tag)
        else:
            self._put("}", depth)

    def _as_function(self, side: str, lines: list[Line]) -> list[Line]:
        """Return the call of a function with these lines; it is passed the locals that they read, structs by pointer.

        They stay as they are where they are few, assign several of these locals, or read an array.
        """
        text = "\n".join(line.text for line in lines)
        read = [p for p in ("state", "in", "out", "diagnostics") if re.search(rf"\b{p}\b", text)]
        outside = [
            m
            for line in self.printed
            if (m := _LOCAL.fullmatch(line.text)) and re.search(rf"(?<![.>])\b{m[2]}\b", text)
        ]
        assigned = [m for m in outside if re.search(rf"^ +{m[2]} (\|)?= ", text, re.MULTILINE)]
        arrays = [m[1] for line in self.printed if (m := _ARRAY.match(line.text))]
        reads_array = any(re.search(rf"\b{name}\b", text) for name in arrays)
        if len(lines) < LONG or len(assigned) > 1 or any(" = " in m[0] for m in assigned) or reads_array:
            return lines
        name, pointers = self.block.name, self._pointers()
        structs = [m[2] for m in outside if m[1].startswith(name)]
        passed = [m for m in outside if m not in assigned]
        types = [f"const {m[1]} *{m[2]}" if m[2] in structs else f"{m[1]} {m[2]}" for m in passed]
        values = [f"&{m[2]}" if m[2] in structs else m[2] for m in passed]
        first, last = [p for p in read if p in ("state", "in")], [p for p in read if p in ("out", "diagnostics")]
        order = [*(pointers[p] for p in first), *types, *(pointers[p] for p in last)]
        result, target = (assigned[0][1], assigned[0][2]) if assigned else ("void", "")
        head = f"{name.upper()}_INLINE {result} {name}_{side}({', '.join(order)})"
        used = re.compile(rf"&({'|'.join(structs)})\b|\b({'|'.join(structs)})\.") if structs else re.compile(r"(?!)")
        inside = [Line(f"    {result} {target};"), Line("")] if assigned else []
        inside += self._with_headings(
            [
                replace(line, text=used.sub(lambda m: m[1] or f"{m[2]}->", line.text.removeprefix("    ")))
                for line in lines
            ]
        )
        inside += [Line(f"    return {target};")] if assigned else []
        self.sides.append(Side(SIDES[side], head, inside))
        call = f"{name}_{side}({', '.join([*first, *values, *last])});"
        return [Line(f"        {f'{target} = ' if assigned else ''}{call}")]

    def _pointers(self) -> dict[str, str]:
        name = self.block.name
        return {
            "state": f"{name}_state_t *state",
            "in": f"const {name}_input_t *in",
            "out": f"{name}_output_t *out",
            "diagnostics": diagnostics.parameter(self.block, self.p),
        }

    def _store(self, s: Store, depth: int) -> None:
        node = self.p.nodes[s.node]
        stores_itself = node.op == "call" or (node.op == "guard" and (s.struct, s.name) == ("state", node.name))
        is_state = s.struct == "state"
        if s.struct == "word" or stores_itself or (is_state and self.locals.stored.get(s.node) == s.name):
            return
        kind = "integer" if is_state and s.name in self.p.integers else "real"
        place = f"state->{self._path(s.name)}" if is_state else f"out->{s.name}"
        self._put(f"{place} = {self.c.as_kind(s.node, kind).c};", depth)

    def _path(self, state: str) -> str:
        return self.p.paths.get(state, state)

    def _guard(self, k: int, depth: int) -> None:
        """Read an input behind its guard; the first one calls the function of all guards."""
        node = self.p.nodes[k]
        source, *_, word = node.args
        if self.p.nodes[word].op == "literal":
            state = "state, " if any(n.op == "guard" and n.name for n in self.p.nodes) else ""
            call = f"{self.block.name}_guard_inputs({state}in, &{WORD})"
            self._put(f"uint32_t {WORD} = 0u;", depth)
            self._put(f"const {self.block.name}_input_t {ACCEPTED} = {call};", depth)
        self.c.text[k] = Text(f"{ACCEPTED}.{self.p.nodes[source].name}")

    def _is_guarded(self, k: int) -> bool:
        """Tell whether only a guard reads an input."""
        return len(self.users[k]) == 1 and self.p.nodes[self.users[k][0]].op == "guard"

    def _call(self, node: Node, depth: int) -> None:
        """Call a routine; its one result has the name of a signal, several are members of a struct."""
        call = self.p.calls[node.name]
        routine = call.routine
        passed = [f"&state->{call.block}"] if routine.states else []
        if routine.by_value:
            passed += [self.c.number(n).c for n in call.numbers]
        elif routine.parameters:
            passed += [f"&{call.parameters}"]
        for a, argument in zip(node.args, routine.arguments, strict=False):
            text = self.c.as_kind(a, argument.kind).c
            struct = f"&{text.partition('.')[0]}" if argument.name in routine.program.members else ""
            passed += [] if struct in passed else [struct or text]
        passed += ["diagnostics"] if diagnostics.records(routine.program) else []
        text = f"{self.block.name}_{routine.name}({', '.join(passed)});"
        if len(routine.results) == 1:
            result = self.p.nodes.index(
                Node("result", (self.p.nodes.index(node),), name=f"{node.name}.{routine.results[0].name}")
            )
            name = self.locals.name.get(result) or self.locals.identifiers.free(call.result_names[0])
            text = f"const {self.c.ctype_of(routine.results[0].kind)} {name} = {text}"
            self.returned[f"{node.name}.{routine.results[0].name}"] = name
        elif routine.results:
            name = self.locals.identifiers.free(node.name)
            text = f"const {self.block.name}_{routine.name}_t {name} = {text}"
            self.returned |= {f"{node.name}.{r.name}": f"{name}.{r.name}" for r in routine.results}
        self._check_loads(text)
        self.printed.append(Line("    " * depth + text, prose(self.p.titles.get(call.block, self.tag))))

    def _put(self, text: str, depth: int) -> None:
        self._check_loads(text)
        self.printed.append(Line("    " * depth + text, self.tag))

    def _can_wait(self, node: Node) -> bool:
        return node.op == "state" and node.name not in self.late and node.name not in self.p.integers

    def _check_loads(self, text: str) -> None:
        """Note the loads that a line reads, and those that it would change before they are read."""
        target, _, value = text.partition(" = ")
        for place in [*self.waiting]:
            self._note_reads(place, len(re.findall(rf"{re.escape(place)}\b", value or text)))
        for place, state in list(self.waiting.items()):
            owner = place.rsplit(".", 1)[0]
            if target == place or re.search(rf"&{re.escape(owner)}\b", text):
                self.late.add(state)

    def _note_reads(self, place: str, reads: int) -> None:
        self.unread[place] -= reads
        if self.unread[place] <= 0:
            self.waiting.pop(place, "")

    def _new_name(self, k: int) -> str:
        node = self.p.nodes[k]
        name = self.locals.identifiers.free(node.name if node.op in LOADS else self.naming.name(k))
        self.naming.made |= set() if node.op in LOADS else {name}
        self.naming.named[k] = name
        return name
