"""C99 text of a lowered Block: a header with three structs, and one straight-line step.

    void     <name>_init(<name>_state_t *state);
    uint32_t <name>_step(<name>_state_t *state, const <name>_input_t *in, <name>_output_t *out);   fault bits

Everything is loaded before anything is stored. A value that is read once stands inside the expression that reads it;
the others are `const` locals. A signal of the composition keeps its name.
"""

from dataclasses import dataclass

import numpy as np

from synth.block import Block, Named
from synth.emit.layout import CTYPES, Layout, Struct
from synth.emit.lower import LOGICAL, Node, Program
from synth.errors import EmitError

_INFIX = {"add": ("+", 4), "sub": ("-", 4), "mul": ("*", 5), "div": ("/", 5), "lt": ("<", 3), "le": ("<=", 3)}
_INFIX |= {"eq": ("==", 2), "ne": ("!=", 2), "and": ("&&", 1), "or": ("||", 0)}
_ATOM = 9
_LIBM = frozenset(
    {"exp", "log", "sqrt", "sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh", "fabs", "atan2"}
)
_WIDTH = 110


@dataclass(frozen=True)
class Text:
    """An expression and how strongly its outermost operator binds."""

    c: str
    strength: int = _ATOM

    def inside(self, strength: int) -> str:
        """Return the text, in parentheses where it binds less than `strength`."""
        return self.c if self.strength >= strength else f"({self.c})"


def literal(value: float, scalar: type[np.floating]) -> Text:
    """Return the shortest literal that reads back as `value` in the scalar type; raise EmitError if none is finite."""
    with np.errstate(over="ignore"):
        rounded = scalar(value)
    if not np.isfinite(rounded):
        raise EmitError(f"the number {value:g} is not finite in {CTYPES[scalar]}: scale the expression")
    text = str(rounded).lower()
    text = text if "." in text or "e" in text else text + ".0"
    text += "f" if scalar is np.float32 else ""
    return Text(text, _ATOM if not text.startswith("-") else 6)


def header(block: Block, layout: Layout) -> str:
    """Return the text of <name>.h."""
    guard = f"{block.name.upper()}_H"
    structs = "\n\n".join(_struct(block.name, s) for s in layout.structs)
    checks = "\n".join(
        f"typedef char {block.name}_{s.kind}_size_is_{s.size}[(sizeof({s.type}) == {s.size}u) ? 1 : -1];"
        for s in layout.structs
    )
    faults = "\n".join(
        f" *   bit {f.bit:2d}  "
        + (f"{f.input}: not finite or outside its range" if f.input else "latched: safe output until init")
        for f in block.faults
    )
    returned = (
        f" * It returns the fault bits:\n{faults}\n" if faults else " * It returns 0: the Block guards no input.\n"
    )
    return (
        f"/* {block.name}: one step every {block.time.period_s:g} s, {layout.ctype}. Generated: do not edit. */\n"
        f"#ifndef {guard}\n#define {guard}\n\n#include <stdint.h>\n\n{structs}\n\n"
        f"/* The layout is the same on every target. */\n{checks}\n\n"
        "/* Put the state to its initial values. The caller owns it. */\n"
        f"void {block.name}_init({block.name}_state_t *state);\n\n"
        f"/* Compute one sample: read `in`, write `out`, advance `state`.\n{returned} */\n"
        f"{_step_head(block.name)};\n\n#endif\n"
    )


def _struct(name: str, struct: Struct) -> str:
    rows = [f"    {f.ctype} {f.name};".ljust(40) + f"/* {_prose(f.comment)} */" for f in struct.fields]
    return "typedef struct {\n" + "\n".join(rows) + f"\n}} {struct.type};"


def _step_head(name: str) -> str:
    return f"uint32_t {name}_step({name}_state_t *state, const {name}_input_t *in, {name}_output_t *out)"


def source(block: Block, program: Program, layout: Layout) -> str:
    """Return the text of <name>.c."""
    printer = _Printer(block, program, layout)
    body = printer.body()
    used = {n.op for n in program.nodes}
    read = {n.name for n in program.nodes if n.op == "constant"}
    parts = [f'/* {block.name}. Generated: do not edit. */\n#include "{block.name}.h"\n']
    if used & _LIBM:
        parts.append("#include <math.h>\n")
    parts.append("\n")
    if read:
        rows = (
            f"static const {layout.ctype} {c.name} = {literal(c.value, layout.scalar).c};".ljust(60)
            + f"/* {c.unit}; {_prose(c.source)} */"
            for c in block.constants
            if c.name in read
        )
        parts.append("\n".join(rows) + "\n\n")
    for op, sign in (("min", "<"), ("max", ">")):
        if op in used:
            t = layout.ctype
            parts.append(f"static inline {t} {op}({t} a, {t} b)\n{{\n    return (a {sign} b) ? a : b;\n}}\n\n")
    parts.append(_init(block, layout) + "\n" + body)
    return "".join(parts)


def _init(block: Block, layout: Layout) -> str:
    rows = []
    for s in block.states:
        value = f"{int(s.initial)}u" if s.integer else literal(s.initial, layout.scalar).c
        rows.append(f"    state->{s.name} = {value};")
    rows += [f"    state->{f.name} = 0u;" for f in layout.state.fields if f.name == "reserved"]
    return f"void {block.name}_init({block.name}_state_t *state)\n{{\n" + "\n".join(rows) + "\n}\n"


class _Printer:
    """Prints one program; holds the text of each node printed so far."""

    def __init__(self, block: Block, program: Program, layout: Layout) -> None:
        self.block, self.p, self.layout = block, program, layout
        self.uses = program.uses()
        self.text: dict[int, Text] = {}
        self.taken = {"state", "in", "out", "faults", "min", "max"} | {c.name for c in block.constants}
        self.taken |= _LIBM | {f"{function}f" for function in _LIBM}
        self.name: dict[int, str] = {}
        for _, named, node in program.marks:
            if node not in self.name and program.nodes[node].op not in ("input", "state", "constant", "literal"):
                self.name[node] = self._free(named.signal.name)

    def body(self) -> str:
        """Return the step function."""
        lines: list[str] = []
        pending: list[str] = []
        marks = list(self.p.marks)
        told = ""
        for k in range(len(self.p.nodes) + 1):
            while marks and marks[0][0] <= k:
                named = marks.pop(0)[1]
                if pending and (title := _title(named)) != told:
                    lines += ["", f"    /* {title} */"]
                    told = title
                lines += pending
                pending = []
            if k < len(self.p.nodes):
                pending += self._line(k)
        if pending:
            lines += ["", "    /* next states */", *pending]
        stores = self._stores()
        idle = [] if self.block.states else ["    (void)state;"]
        idle += [] if any(n.op == "input" for n in self.p.nodes) else ["    (void)in;"]
        lines = ["", *idle, *lines] if idle else lines
        return _step_head(self.block.name) + "\n{" + "\n".join([*lines, "", *stores]) + "\n}\n"

    def _line(self, k: int) -> list[str]:
        """Decide whether node k gets a line of its own or waits to be printed inside its reader."""
        node = self.p.nodes[k]
        text = self._expression(node)
        if node.op in ("literal", "constant"):
            self.text[k] = text
            return []
        loaded = node.op in ("input", "state")
        if k not in self.name and not loaded and self.uses[k] <= 1 and len(text.c) < _WIDTH:
            self.text[k] = text
            return []
        name = self.name.get(k) or self._free(node.name if loaded else f"t{len(self.text)}")
        self.text[k] = Text(name)
        ctype = "uint32_t" if node.name in self.p.integers and loaded else self._ctype(node)
        return [f"    const {ctype} {name} = {text.c};"]

    def _expression(self, node: Node) -> Text:
        op, args = node.op, node.args
        if op == "literal":
            return literal(node.value, self.layout.scalar)
        if op in ("input", "state", "constant"):
            prefix = {"input": "in->", "state": "state->", "constant": ""}[op]
            return Text(prefix + node.name)
        if op in ("and", "or", "not"):
            sides = [self._condition(a) for a in args]
            if op == "not":
                return Text("!" + sides[0].inside(7), 7)
        elif op == "choose":
            then, other = self._value(args[1]).inside(1), self._value(args[2]).inside(1)
            return Text(f"({self._condition(args[0]).c}) ? {then} : {other}", -1)
        elif op == "when":
            return Text(f"({self._condition(args[0]).c}) ? {self._value(args[1]).inside(1)} : {self._zero().c}", -1)
        else:
            sides = [self._value(a) for a in args]
        if op in _INFIX:
            sign, strength = _INFIX[op]
            if op in ("and", "or"):
                return Text(f"{sides[0].inside(2)} {sign} {sides[1].inside(2)}", strength)
            return Text(f"{sides[0].inside(strength)} {sign} {sides[1].inside(strength + 1)}", strength)
        return self._special(op, sides)

    def _special(self, op: str, sides: list[Text]) -> Text:
        if op == "neg":
            return Text("-" + sides[0].inside(7), 6)
        if op == "sq":
            return Text(f"{sides[0].inside(_ATOM)} * {sides[0].inside(_ATOM)}", 5)
        if op in ("twice", "inv"):
            number = literal(2.0 if op == "twice" else 1.0, self.layout.scalar).c
            return Text(f"{number} {'*' if op == 'twice' else '/'} {sides[0].inside(6)}", 5)
        suffix = "f" if op in _LIBM and self.layout.scalar is np.float32 else ""
        return Text(f"{op}{suffix}({', '.join(s.c for s in sides)})")

    def _value(self, k: int) -> Text:
        """Return node k as a number."""
        node = self.p.nodes[k]
        if node.op in LOGICAL:
            return Text(f"{self.text[k].inside(0)} ? {literal(1.0, self.layout.scalar).c} : {self._zero().c}", -1)
        if node.op == "state" and node.name in self.p.integers:
            return Text(f"({self.layout.ctype}){self.text[k].c}", 7)
        return self.text[k]

    def _condition(self, k: int) -> Text:
        """Return node k as a truth value."""
        node = self.p.nodes[k]
        if node.op in LOGICAL:
            return self.text[k]
        zero = "0u" if node.op == "state" and node.name in self.p.integers else self._zero().c
        return Text(f"{self.text[k].inside(3)} != {zero}", 2)

    def _zero(self) -> Text:
        return literal(0.0, self.layout.scalar)

    def _ctype(self, node: Node) -> str:
        return "int" if node.op in LOGICAL else self.layout.ctype

    def _stores(self) -> list[str]:
        rows = []
        for s in self.block.states:
            k = self.p.next[s.name]
            if s.integer:
                value = (
                    f"{self._condition(k).inside(0)} ? 1u : 0u" if self.p.nodes[k].op in LOGICAL else self._counted(k)
                )
            else:
                value = self._value(k).c
            rows.append(f"    state->{s.name} = {value};")
        rows += [f"    out->{s.name} = {self._value(self.p.outputs[s.name]).c};" for s in self.block.outputs]
        bits = [
            f"({self._condition(self.p.outputs[f.output]).c} ? 0x{1 << f.bit:08x}u : 0u)" for f in self.block.faults
        ]
        return [*rows, "    return " + ("\n        | ".join(bits) if bits else "0u") + ";"]

    def _counted(self, k: int) -> str:
        if self.p.nodes[k].op == "state" and self.p.nodes[k].name in self.p.integers:
            return self.text[k].c
        return f"(uint32_t)({self._value(k).c})"

    def _free(self, wanted: str) -> str:
        name, n = wanted, 2
        while name in self.taken:
            name, n = f"{wanted}_{n}", n + 1
        self.taken.add(name)
        return name


def _title(named: Named) -> str:
    return f"{named.block}: {_prose(named.tag)}" if named.tag else named.block


def _prose(text: str) -> str:
    """Return a text that neither opens nor closes a comment."""
    return text.replace("*/", "* /").replace("/*", "/ *")
