"""Printing: scheduled statements become lines of C, each with the tag of the equation that it came from.

A value that is read once stands inside the expression that reads it; the others are locals, `const` unless an `if`
gives them their value. A signal of the composition keeps its name, and a value that only becomes the next value of a
state is called after it.
"""

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from synth.block import Block
from synth.emit.c.layout import CTYPES, Layout
from synth.emit.c.schedule import About, Assign, Branch, Let, Statement, Store, statements
from synth.emit.lower import LOGICAL, Node, Program
from synth.errors import EmitError

INFIX = {"add": ("+", 4), "sub": ("-", 4), "mul": ("*", 5), "div": ("/", 5), "lt": ("<", 3), "le": ("<=", 3)}
INFIX |= {"eq": ("==", 2), "ne": ("!=", 2), "and": ("&&", 1), "or": ("||", 0)}
ATOM = 9
LIBM = frozenset(
    {"exp", "log", "sqrt", "sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh", "fabs", "atan2"}
)
RESERVED = LIBM | {f"{function}f" for function in LIBM}
RESERVED |= {"state", "in", "out", "faults", "min", "max", "limit", "flag", "bool", "true", "false", "uint32_t"}
_WIDTH = 108
_LOADS = ("input", "state")
_INLINE = ("literal", "constant")
_WORD = "faults"


@dataclass(frozen=True)
class Line:
    """One line of C and the Block, with its equation, that it computes; empty for none."""

    text: str
    tag: str = ""


@dataclass(frozen=True)
class Text:
    """An expression and how strongly its outermost operator binds."""

    c: str
    strength: int = ATOM

    def inside(self, strength: int) -> str:
        """Return the text, in parentheses where it binds less than `strength`."""
        return self.c if self.strength >= strength else f"({self.c})"

    def beside(self, strength: int) -> str:
        """Return the text as the side of an operator of this strength: another operator there stands in parentheses."""
        return self.c if self.strength in (strength, *range(6, ATOM + 1)) else f"({self.c})"


def constant(name: str) -> str:
    """Return what a constant or a table of a Block is called in C, where it must not hide what the text needs."""
    bare = name.rstrip("_")
    return f"{name}_" if bare in RESERVED or bare.endswith("_polynomial") else name


def literal(value: float, scalar: type[np.floating]) -> Text:
    """Return the shortest literal that reads back as `value` in the scalar type; raise EmitError if none is finite."""
    with np.errstate(over="ignore"):
        rounded = scalar(value)
    if not np.isfinite(rounded):
        raise EmitError(f"the number {value:g} is not finite in {CTYPES[scalar]}: scale the expression")
    text = str(rounded).lower()
    text = text if "." in text or "e" in text else text + ".0"
    text += "f" if scalar is np.float32 else ""
    return Text(text, ATOM if not text.startswith("-") else 6)


def kinds(p: Program) -> list[str]:
    """Return for each node what C holds it in: "logical", "integer", "real", or "number" for a literal of either.

    A difference of integers may be below 0: it is one only where nothing but an integer state takes it.
    """
    found: list[str] = []
    counted = _counted(p)
    for k, node in enumerate(p.nodes):
        args = [found[a] for a in node.args]
        whole = all(
            k == "integer" or (k == "number" and _whole(p.nodes[a])) for a, k in zip(node.args, args, strict=True)
        )
        kind = "real"
        if node.op in LOGICAL:
            kind = "logical"
        elif node.op == "literal":
            kind = "number"
        elif node.op == "bit" or (node.op == "state" and node.name in p.integers):
            kind = "integer"
        elif node.op == "choose":
            kind = _chosen(p, node, args[1:])
        elif whole and "integer" in args and (node.op == "add" or (node.op == "sub" and k in counted)):
            kind = "integer"
        found.append(kind)
    return found


def _counted(p: Program) -> set[int]:
    """Return the nodes that reach nothing but integer states, and these through arms of choices alone."""
    other = {*p.outputs.values(), *(k for name, k in p.next.items() if name not in p.integers)}
    for k in range(len(p.nodes) - 1, -1, -1):
        node = p.nodes[k]
        other.update(node.args[:1] if node.op == "choose" and k not in other else node.args)
    return set(range(len(p.nodes))) - other


def _whole(node: Node) -> bool:
    return 0 <= node.value < 2**32 and node.value == int(node.value)


def _chosen(p: Program, node: Node, arms: Sequence[str]) -> str:
    literals = [p.nodes[a] for a, kind in zip(node.args[1:], arms, strict=True) if kind == "number"]
    flags = all(n.value in (0.0, 1.0) for n in literals)
    if set(arms) <= {"logical", "number"} and flags:
        return "logical"
    if "integer" in arms and "real" not in arms and all(_whole(n) for n in literals):
        return "integer"
    return "real"


def body(block: Block, p: Program, layout: Layout) -> list[Line]:
    """Return the lines of the step function between its braces."""
    return _Printer(block, p, layout).lines()


class _Printer:
    """Prints one program; holds the text of each node printed so far."""

    def __init__(self, block: Block, program: Program, layout: Layout) -> None:
        self.block, self.p, self.layout = block, program, layout
        self.kinds = kinds(program)
        self.users = program.users()
        self.ends = set(program.ends())
        self.statements = statements(program)
        self.reads: Counter[int] = Counter()
        _count(program, self.statements, self.reads)
        self.starts = {c: start for b in _branches(self.statements) for c, start in b.declared}
        self.handed = set(_handed(program, self.statements))
        self.same = self._shared_variables()
        self.text: dict[int, Text] = {}
        self.printed: list[Line] = []
        self.tag = ""
        self.count = 0
        self.taken = {*RESERVED, *(constant(c.name) for c in block.constants)}
        self.taken |= {n.name for n in program.nodes if n.op == "polynomial"}
        self.taken |= {constant(n.name) for n in program.nodes if n.op == "table"}
        self.name = self._names()

    def lines(self) -> list[Line]:
        """Return the lines."""
        self._block(self.statements, 1)
        self.tag = ""
        idle = [p for p in ("in", "state") if not any(f"{p}->" in line.text for line in self.printed)]
        self.printed[:0] = [*(Line(f"    (void){pointer};") for pointer in idle), *([Line("")] if idle else [])]
        self.printed.append(Line(""))
        self._put(f"return {'0u' if self.p.word is None else self._integer(self.p.word).c};", 1)
        return self.printed

    def _names(self) -> dict[int, str]:
        """Name what carries a signal, the fault word, and what becomes a next state."""
        found: dict[int, str] = {}
        roots = [(named.signal.name, node) for named, node in self.p.marks]
        roots += [] if self.p.word is None else [(_WORD, self.p.word)]
        roots += [(f"{name}_next", self._carrier(name, node)) for name, node in self.p.next.items()]
        for name, node in roots:
            if node not in found and self.p.nodes[node].op not in (*_LOADS, *_INLINE):
                found[node] = _WORD if node == self.p.word else self._free(name)
        for node, root in self.same.items():
            if node in found and root not in found:
                found[root] = found[node]
        return found

    def _carrier(self, state: str, k: int) -> int:
        """Return the node that a state becomes where it does not stay as it is."""
        while self.p.nodes[k].op == "choose":
            moved = [a for a in self.p.nodes[k].args[1:] if self.p.nodes[a] != Node("state", name=state)]
            if len(moved) != 1:
                break
            k = moved[0]
        return k

    def _shared_variables(self) -> dict[int, int]:
        """Map a choice to the variable that it carries on: the choice it starts from, when all else that reads that
        is on the way to the new choice.
        """
        same: dict[int, int] = {}
        for branch in _branches(self.statements):
            inside = set(_computed((*branch.then, *branch.other)))
            for c, start in branch.declared:
                if start in self.starts and self.kinds[start] == self.kinds[c] and self._leads(start, c, inside):
                    same[c] = same.get(start, start)
        return same

    def _leads(self, start: int, choice: int, inside: set[int]) -> bool:
        """Tell whether all that comes from a node leads to a choice, through nodes inside its branch."""
        seen, stack = {choice}, [start]
        while stack:
            k = stack.pop()
            if k in self.ends:
                return False
            found = set(self.users[k]) - seen
            if not found <= inside:
                return False
            seen |= found
            stack += found
        return True

    def _block(self, block: Sequence[Statement], depth: int) -> None:
        for s in block:
            if isinstance(s, About):
                self._about(s, depth)
            elif isinstance(s, Let):
                self._let(s.node, depth)
            elif isinstance(s, Assign):
                if s.node != self.starts[s.choice]:
                    self._put(self._assignment(s, self.text[s.choice].c), depth)
            elif isinstance(s, Store):
                self._store(s, depth)
            else:
                self._branch(s, depth)

    def _assignment(self, s: Assign, variable: str) -> str:
        node = self.p.nodes[s.node]
        if node.op == "bit" and self._text(node.args[0]).c == variable:
            return f"{variable} |= {_mask(node)};"
        return f"{variable} = {self._as(s.node, self.kinds[s.choice]).c};"

    def _about(self, s: About, depth: int) -> None:
        owner = self.p.owner(s.state) if s.mark is None else self.p.marks[s.mark][0].block
        tag = prose(self.p.titles[owner]) if owner in self.p.titles else self.tag or "next states"
        if tag != self.tag:
            if (
                self.printed
                and self.printed[-1].text.strip() not in ("", "{")
                and not self.printed[-1].text.endswith("{")
            ):
                self.printed.append(Line(""))
            self.tag = tag
            self._put(f"/* {tag} */", depth)

    def _let(self, k: int, depth: int) -> None:
        """Give node k a line of its own, or let it wait to be printed inside its reader."""
        if not self.reads[k]:
            return
        node = self.p.nodes[k]
        text = self._expression(k)
        waits = self.reads[k] <= 1 and k not in self.name and node.op not in _LOADS
        if waits and len(text.c) < _WIDTH:
            self.text[k] = text
            return
        if k in self.handed and self.reads[k] == 1:
            self.text[k] = text
            return
        name = self.name.get(k) or self._free(node.name if node.op in _LOADS else self._next())
        self.text[k] = Text(name)
        self._put(f"const {self._ctype(k)} {name} = {text.c};", depth)
        if node.op == "within":
            low, high = (self._value(a).c for a in node.args[1:])
            self._put(f"/*@ admit {low} <= {name} <= {high}; */", depth)

    def _branch(self, s: Branch, depth: int) -> None:
        for c, start in s.declared:
            if c in self.same:
                self.text[c] = self.text[self.same[c]]
                continue
            name = self.name.get(c) or self._free(self._next())
            value = "" if start is None else f" = {self._as(start, self.kinds[c]).c}"
            self._put(f"{self._ctype(c)} {name}{value};", depth)
            self.text[c] = Text(name)
        condition, tag = self._condition(s.condition), self.tag
        before, self.printed = self.printed, []
        self._block(s.then, depth + 1)
        then, self.printed, self.tag = self.printed, [], tag
        self._block(s.other, depth + 1)
        other, self.printed, self.tag = self.printed, before, tag
        if then:
            self._put(f"if ({condition.c}) {{", depth)
            self.printed += then
        else:
            self._put(f"if (!{condition.inside(7)}) {{", depth)
            self.printed += other
        if then and other:
            self._put("} else {", depth)
            self.printed += other
        self._put("}", depth)

    def _store(self, s: Store, depth: int) -> None:
        if s.struct == "word":
            return
        kind = "integer" if s.struct == "state" and s.name in self.p.integers else "real"
        pointer = "state" if s.struct == "state" else "out"
        self._put(f"{pointer}->{s.name} = {self._as(s.node, kind).c};", depth)

    def _put(self, text: str, depth: int) -> None:
        self.printed.append(Line("    " * depth + text, self.tag))

    def _ctype(self, k: int) -> str:
        kind = self.kinds[k]
        return {"logical": "bool", "integer": "uint32_t"}.get(kind, self.layout.ctype)

    def _as(self, k: int, kind: str) -> Text:
        if kind == "logical":
            node = self.p.nodes[k]
            return Text(str(bool(node.value)).lower()) if node.op == "literal" else self._condition(k)
        return self._integer(k) if kind == "integer" else self._value(k)

    def _expression(self, k: int) -> Text:
        node = self.p.nodes[k]
        op, args = node.op, node.args
        if op == "literal":
            return literal(node.value, self.layout.scalar)
        if op in ("input", "state", "constant"):
            return Text({"input": f"in->{node.name}", "state": f"state->{node.name}"}.get(op, constant(node.name)))
        if op == "not":
            return Text("!" + self._condition(args[0]).inside(7), 7)
        if op in ("and", "or"):
            sign, strength = INFIX[op]
            terms = [self._condition(a).beside(strength) for a in args]
            return Text(f" {sign} ".join(terms), strength)
        if op == "choose":
            then, other = (self._as(a, self.kinds[k]).inside(6) for a in args[1:])
            return Text(f"({self._condition(args[0]).c}) ? {then} : {other}", -1)
        if op == "bit":
            if self.p.nodes[args[0]].op == "literal":
                return Text(_mask(node))
            return Text(f"{self._integer(args[0]).inside(2)} | {_mask(node)}", 1)
        if op == "within":
            return self.text[args[0]]
        if op == "clamp":
            return Text(f"limit({self._value(args[0]).c}, {self._value(args[2]).c})")
        whole = self.kinds[k] == "integer" or self._counts(node)
        sides = [self._integer(a) if whole else self._value(a) for a in args]
        return self._operation(node, sides)

    def _counts(self, node: Node) -> bool:
        """Tell whether a comparison is one of integers; with 0, or itself, C may call it always true or false."""
        kinds = {self.kinds[a] for a in node.args}
        numbers = [self.p.nodes[a] for a in node.args if self.kinds[a] == "number"]
        whole = "integer" in kinds and kinds <= {"integer", "number"} and all(map(_whole, numbers))
        whole = whole and node.args[0] != node.args[-1]
        return node.op in LOGICAL and whole and (node.op in ("eq", "ne") or all(n.value > 0 for n in numbers))

    def _operation(self, node: Node, sides: list[Text]) -> Text:
        op = node.op
        if op in INFIX:
            sign, strength = INFIX[op]
            return Text(f"{sides[0].beside(strength)} {sign} {sides[1].inside(6)}", strength)
        if op == "neg":
            return Text("-" + sides[0].inside(7), 6)
        if op == "sq":
            return Text(f"{sides[0].inside(ATOM)} * {sides[0].inside(ATOM)}", 5)
        if op == "inv":
            return Text(f"{literal(1.0, self.layout.scalar).c} / {sides[0].inside(6)}", 5)
        if op == "polynomial":
            return Text(f"{node.name}({sides[0].c})")
        if op == "table":
            return Text(f"{constant(node.name)}[(uint32_t){sides[0].inside(7)}]")
        if op == "floor":
            return Text(f"({self.layout.ctype})(uint32_t){sides[0].inside(7)}", 7)
        suffix = "f" if op in LIBM and self.layout.scalar is np.float32 else ""
        return Text(f"{op}{suffix}({', '.join(s.c for s in sides)})")

    def _value(self, k: int) -> Text:
        """Return node k as a number of the scalar type."""
        if self.kinds[k] == "logical":
            one, zero = (literal(v, self.layout.scalar).c for v in (1.0, 0.0))
            return Text(f"{self._condition(k).inside(6)} ? {one} : {zero}", -1)
        if self.kinds[k] == "integer":
            return Text(f"({self.layout.ctype}){self._text(k).inside(7)}", 7)
        return self._text(k)

    def _integer(self, k: int) -> Text:
        """Return node k as a uint32_t."""
        node = self.p.nodes[k]
        if node.op == "literal":
            return Text(f"{int(node.value)}u")
        if self.kinds[k] == "logical":
            return Text(f"flag({self._condition(k).c})")
        return self._text(k) if self.kinds[k] == "integer" else Text(f"(uint32_t)({self._value(k).c})", 7)

    def _condition(self, k: int) -> Text:
        """Return node k as a truth value."""
        if self.kinds[k] == "logical":
            return self._text(k)
        zero = "0u" if self.kinds[k] == "integer" else literal(0.0, self.layout.scalar).c
        return Text(f"{self._text(k).inside(3)} != {zero}", 2)

    def _text(self, k: int) -> Text:
        node = self.p.nodes[k]
        return self._expression(k) if node.op in _INLINE else self.text[k]

    def _next(self) -> str:
        self.count += 1
        return f"t{self.count}"

    def _free(self, wanted: str) -> str:
        name, n = wanted, 2
        while name in self.taken:
            name, n = f"{wanted}_{n}", n + 1
        self.taken.add(name)
        return name


def _branches(block: Sequence[Statement]) -> Iterator[Branch]:
    for s in block:
        if isinstance(s, Branch):
            yield s
            yield from _branches(s.then)
            yield from _branches(s.other)


def _handed(p: Program, block: Sequence[Statement]) -> Iterator[int]:
    """Yield the loads that are assigned before anything is stored: the member itself may stand for such a one."""
    loaded: set[int] = set()
    for s in block:
        if isinstance(s, Let) and p.nodes[s.node].op in _LOADS:
            loaded.add(s.node)
        elif isinstance(s, Assign) and s.node in loaded:
            yield s.node
        elif isinstance(s, Branch):
            yield from _handed(p, s.then)
            yield from _handed(p, s.other)
        if isinstance(s, Store | Branch):
            loaded.clear()


def _computed(block: Sequence[Statement]) -> Iterator[int]:
    for s in block:
        if isinstance(s, Let):
            yield s.node
        elif isinstance(s, Branch):
            yield from (c for c, _ in s.declared)
            yield from _computed((*s.then, *s.other))


def _count(p: Program, block: Sequence[Statement], reads: Counter[int]) -> None:
    """Count how often the text reads each node; from the end, as what is read by nothing is not printed."""
    for s in reversed(block):
        if isinstance(s, Let) and reads[s.node]:
            node = p.nodes[s.node]
            reads.update(_read(node))
        elif isinstance(s, Assign | Store):
            reads[s.node] += 1
        elif isinstance(s, Branch):
            _count(p, s.other, reads)
            _count(p, s.then, reads)
            reads.update([s.condition, *(start for _, start in s.declared if start is not None)])


def _read(node: Node) -> Sequence[int]:
    if node.op == "within":
        return node.args[:1]
    return node.args[::2] if node.op == "clamp" else node.args * (2 if node.op == "sq" else 1)


def _mask(node: Node) -> str:
    return f"0x{int(node.value):08x}u"


def prose(text: str) -> str:
    """Return a text that neither opens nor closes a comment."""
    return text.replace("*/", "* /").replace("/*", "/ *")
