"""Code printer: scheduled statements to lines of C, each tagged with the equation that it computes.

Locals are `const` unless an `if` assigns their value.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from synth.block import Block
from synth.emit.c import locals as variables
from synth.emit.c.expressions import Expressions, Text, mask
from synth.emit.c.kinds import kinds
from synth.emit.c.locals import LOADS
from synth.emit.lower import Node, Program
from synth.emit.passes.statements import Annotation, Assign, Branch, Let, Statement, Store

_WIDTH = 108


@dataclass(frozen=True)
class Line:
    """One line of C, tagged with its Block and equation; the tag may be empty."""

    text: str
    tag: str = ""


def body(block: Block, p: Program, statements: Sequence[Statement], scalar: type[np.floating]) -> list[Line]:
    """Return the lines of the step function between its braces."""
    return _Printer(block, p, statements, scalar).lines()


class _Printer:
    """Prints the statements of one program."""

    def __init__(
        self, block: Block, program: Program, statements: Sequence[Statement], scalar: type[np.floating]
    ) -> None:
        self.p, self.statements, self.kinds = program, statements, kinds(program)
        self.locals = variables.assign(block, program, statements, self.kinds)
        self.c = Expressions(program, self.kinds, scalar)
        self.printed: list[Line] = []
        self.tag = ""

    def lines(self) -> list[Line]:
        """Return the lines."""
        self._block(self.statements, 1)
        self.tag = ""
        idle = [p for p in ("in", "state") if not any(f"{p}->" in line.text for line in self.printed)]
        self.printed[:0] = [*(Line(f"    (void){pointer};") for pointer in idle), *([Line("")] if idle else [])]
        self.printed.append(Line(""))
        self._put(f"return {'0u' if self.p.word is None else self.c.integer(self.p.word).c};", 1)
        return self.printed

    def _block(self, block: Sequence[Statement], depth: int) -> None:
        for s in block:
            if isinstance(s, Annotation):
                self._annotate(s, depth)
            elif isinstance(s, Let):
                self._let(s.node, depth)
            elif isinstance(s, Assign):
                if s.node != self.locals.starts[s.choice]:
                    self._put(self._assignment(s, self.c.text[s.choice].c), depth)
            elif isinstance(s, Store):
                self._store(s, depth)
            else:
                self._branch(s, depth)

    def _assignment(self, s: Assign, variable: str) -> str:
        node = self.p.nodes[s.node]
        if node.op == "bit" and self.c.operand(node.args[0]).c == variable:
            return f"{variable} |= {mask(node)};"
        return f"{variable} = {self.c.as_kind(s.node, self.kinds[s.choice]).c};"

    def _annotate(self, s: Annotation, depth: int) -> None:
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
        """Print node k as a local variable, or keep its text for the expression that reads it."""
        if not self.locals.reads[k]:
            return
        node = self.p.nodes[k]
        text = self.c.of(k)
        waits = self.locals.reads[k] <= 1 and k not in self.locals.name and node.op not in LOADS
        if waits and len(text.c) < _WIDTH:
            self.c.text[k] = text
            return
        if k in self.locals.direct_loads and self.locals.reads[k] == 1:
            self.c.text[k] = text
            return
        name = self.locals.name.get(k) or self._new_name(node)
        self.c.text[k] = Text(name)
        self._put(f"const {self.c.ctype(k)} {name} = {text.c};", depth)
        if node.op == "within":
            low, high = (self.c.value(a).c for a in node.args[1:])
            self._put(f"/*@ admit {low} <= {name} <= {high}; */", depth)

    def _branch(self, s: Branch, depth: int) -> None:
        for c, start in s.choices:
            if c in self.locals.shared:
                self.c.text[c] = self.c.text[self.locals.shared[c]]
                continue
            name = self.locals.name.get(c) or self.locals.identifiers.next()
            value = "" if start is None else f" = {self.c.as_kind(start, self.kinds[c]).c}"
            self._put(f"{self.c.ctype(c)} {name}{value};", depth)
            self.c.text[c] = Text(name)
        condition, tag = self.c.condition(s.condition), self.tag
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
        self._put(f"{pointer}->{s.name} = {self.c.as_kind(s.node, kind).c};", depth)

    def _put(self, text: str, depth: int) -> None:
        self.printed.append(Line("    " * depth + text, self.tag))

    def _new_name(self, node: Node) -> str:
        return self.locals.identifiers.free(node.name) if node.op in LOADS else self.locals.identifiers.next()


def prose(text: str) -> str:
    """Return a text in which C comment delimiters are broken up."""
    return text.replace("*/", "* /").replace("/*", "/ *")
