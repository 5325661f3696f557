"""C expressions: the text of each node of a program, with parentheses where precedence or compilers need them."""

import re
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from synth.emit.program.layout import CTYPES
from synth.emit.program.lower import Node, Program
from synth.emit.program.operations import LIBM, LOGICAL
from synth.emit.proof import ranges as carriers
from synth.emit.proof.conditions import bounds_of_squares
from synth.errors import EmitError

INFIX = {"add": ("+", 4), "sub": ("-", 4), "mul": ("*", 5), "div": ("/", 5), "lt": ("<", 3), "le": ("<=", 3)}
INFIX |= {"eq": ("==", 2), "ne": ("!=", 2), "and": ("&&", 1), "or": ("||", 0)}
ATOM = 9
ARITHMETIC = (4, 5)
RESERVED = LIBM | {f"{function}f" for function in LIBM}
RESERVED |= {"state", "in", "out", "parameters", "diagnostics", "bool", "true", "false", "uint32_t"}
_KEYWORDS = """
auto break case char class const continue default delete do double else enum explicit export extern float for friend
goto if inline int long mutable namespace new operator private protected public register restrict return short signed
sizeof static struct switch template this throw try typedef typename union unsigned using virtual void volatile while
"""  # of C and of C++, which compiles the source as well
RESERVED |= {*_KEYWORDS.split()}
HELPERS = ("min", "max", "limit", "flag", "slew", "equal")
WORD, ACCEPTED = "faults", "accepted"  # the fault word, and the inputs behind their guards
GUARDS = ("hold", "hold_within", "replace", "replace_within")
INLINE = ("literal", "constant", "argument", "parameter")  # printed wherever they are read


@dataclass(frozen=True)
class Text:
    """An expression and the precedence of its outermost operator."""

    c: str
    strength: int = ATOM

    @property
    def is_composite(self) -> bool:
        """Whether its value must be assigned before it is cast (MISRA C:2012, rule 10.8): arithmetic, or a call."""
        return self.strength in ARITHMETIC or re.match(r"\w+\(", self.c) is not None

    @property
    def is_bare(self) -> bool:
        """Whether cppcheck removes the parentheses of this first arm of a choice and then misses them (rule 12.1).

        It does so for arithmetic without further parentheses, brackets or members.
        """
        return self.strength in ARITHMETIC and not re.search(r"[(\[]|->", self.c)

    def inside(self, strength: int) -> str:
        """Return the text, in parentheses if its precedence is below `strength`."""
        return self.c if self.strength >= strength else f"({self.c})"

    def beside(self, strength: int) -> str:
        """Return the text as an operand of an operator of this precedence; other operators in it need parentheses."""
        return self.c if self.strength in (strength, *range(6, ATOM + 1)) else f"({self.c})"


def constant(name: str) -> str:
    """Return the C name of a constant or a table of a Block; it must not shadow a name that the text uses."""
    bare = name.rstrip("_")
    return f"{name}_" if bare in RESERVED or bare.endswith("_polynomial") else name


def signed_constant(node: Node) -> Text:
    """Return the text of a constant, or of its negative."""
    return Text(f"-{constant(node.name)}", 6) if node.value < 0 else Text(constant(node.name))


def admission(name: str, low: str, high: str) -> str:
    """Return the comment that states the bounds of a local, for Frama-C."""
    return f"/*@ admit {low} <= {name} <= {high}; */"


def literal(value: float, scalar: type[np.floating]) -> Text:
    """Return the shortest literal that reads back as `value` in the scalar type.

    Raises EmitError for a value that becomes infinite or 0 in that type.
    """
    with np.errstate(over="ignore"):
        rounded = scalar(value)
    if not np.isfinite(rounded) or (value and not rounded):
        becomes = "0" if np.isfinite(rounded) else "not finite"
        raise EmitError(f"the number {value:g} is {becomes} in {CTYPES[scalar]}: scale the expression")
    text = str(rounded).lower()
    text = text if "." in text or "e" in text else text + ".0"
    text += "f" if scalar is np.float32 else ""
    return Text(text, ATOM if not text.startswith("-") else 6)


class Expressions:
    """The text of nodes: `text` holds that of each node printed so far, a local's name or an expression.

    `late` receives the nodes that need a local: those that are cast although their text is composite, and bare first
    arms of a choice.
    """

    def __init__(
        self, program: Program, kinds: list[str], scalar: type[np.floating], name: str, late: set[str | int]
    ) -> None:
        self.p, self.kinds, self.scalar, self.name, self.late = program, kinds, scalar, name, late
        self.text: dict[int, Text] = {}

    def bounds_of_squares(self, condition: int) -> Iterator[str]:
        """Yield the bounds of locals that a condition on the sum of their squares implies: Eva does not see them."""
        for k, bound in bounds_of_squares(self.p.nodes, condition, self.scalar).items():
            high = literal(bound, self.scalar).c
            if self.text[k].c.isidentifier():
                yield admission(self.text[k].c, f"-{high}", high)

    def ctype(self, k: int) -> str:
        """Return the type of a variable that holds node k."""
        return self.ctype_of(self.kinds[k])

    def ctype_of(self, kind: str) -> str:
        """Return the type of a variable of a kind."""
        return {"logical": "bool", "integer": "uint32_t"}.get(kind, CTYPES[self.scalar])

    def as_kind(self, k: int, kind: str) -> Text:
        """Return node k converted to a kind."""
        if kind == "logical":
            node = self.p.nodes[k]
            return Text(str(bool(node.value)).lower()) if node.op == "literal" else self.condition(k)
        return self.integer(k) if kind == "integer" else self.value(k)

    def of(self, k: int) -> Text:
        """Return the expression of node k from the texts of its operands."""
        node = self.p.nodes[k]
        op, args = node.op, node.args
        if op == "literal":
            return literal(node.value, self.scalar)
        if op == "constant":
            return signed_constant(node)
        if op in ("input", "state"):
            return Text(f"in->{node.name}" if op == "input" else f"state->{self.p.paths.get(node.name, node.name)}")
        if op == "argument":
            return Text("->".join(self.p.members.get(node.name, (node.name,))))
        if op == "parameter":
            parameter = node.name if self.p.by_value else f"parameters->{node.name}"
            return Text(f"-{parameter}", 7) if node.value < 0 else Text(parameter)
        if op == "not":
            return self.negation(args[0])
        if op in ("and", "or"):
            sign, strength = INFIX[op]
            terms = [self.condition(a).beside(strength) for a in args]
            return Text(f" {sign} ".join(terms), strength)
        if op == "choose" and self.kinds[k] == "logical":
            return self._truth(args)
        if op == "choose":
            then, other = (self.as_kind(a, self.kinds[k]) for a in args[1:])
            self.late |= {args[1]} if then.is_bare and self.kinds[k] == "real" else set()
            return Text(f"({self.condition(args[0]).c}) ? {then.inside(6)} : {other.inside(6)}", -1)
        if op == "bit":
            if self.p.nodes[args[0]].op == "literal":
                return Text(mask(node))
            return Text(f"{self.integer(args[0]).inside(2)} | {mask(node)}", 1)
        if op == "within":
            return self.operand(args[0])
        if op == "accepted":
            return self._bits(node, "==")
        if op == "clamp":
            return Text(f"{self.name}_limit({self.value(args[0]).c}, {self.value(args[2]).c})")
        if self.kinds[k] == "integer" or self._counts(node):
            return self._count_or_comparison(node)
        return self._operation(node, [self.value(a) for a in args])

    def _count_or_comparison(self, node: Node) -> Text:
        """Return a sum or a comparison of counts."""
        if self._is_sign(node):
            counted, sign = (node.args[1], "!=") if node.op == "lt" else (node.args[0], "==")
            return Text(f"{self.integer(counted).beside(2)} {sign} 0u", 2)
        return self._operation(node, [self.integer(a) for a in node.args])

    def _truth(self, args: tuple[int, ...]) -> Text:
        """Return a choice between truth values: c && b for (c ? b : false), c || b for (c ? true : b).

        gcc needs more instructions for !c than for (c ? false : true), and for !c && b than for (c ? false : b).
        """
        condition = self.condition(args[0])
        then, other = (self.as_kind(a, "logical") for a in args[1:])
        if (then.c, other.c) == ("true", "false"):
            return condition
        if then.c == "true" or other.c == "false":
            sign, strength = INFIX["or" if then.c == "true" else "and"]
            sides = [condition, other if then.c == "true" else then]
            return Text(f" {sign} ".join(side.beside(strength) for side in sides), strength)
        return Text(f"({condition.c}) ? {then.inside(6)} : {other.inside(6)}", -1)

    def _counts(self, node: Node) -> bool:
        """Tell whether to compare as integers; compilers warn about a comparison with 0 or itself as always true."""
        kinds = {self.kinds[a] for a in node.args}
        numbers = [self.p.nodes[a] for a in node.args if self.kinds[a] == "number"]
        whole = "integer" in kinds and kinds <= {"integer", "number"} and all(map(carriers.is_whole, numbers))
        whole = whole and node.args[0] != node.args[-1]
        sizes = all(n.value > 0 for n in numbers) or self._is_sign(node)
        return node.op in LOGICAL and whole and (node.op in ("eq", "ne") or sizes)

    def _is_sign(self, node: Node) -> bool:
        """Tell whether a node is 0 < a or a <= 0: for an unsigned a, that it is not 0, or is."""
        zero = {"lt": 0, "le": 1}.get(node.op)
        return zero is not None and self.p.nodes[node.args[zero]] == Node("literal", value=0.0)

    def _operation(self, node: Node, sides: list[Text]) -> Text:
        op = node.op
        if op in ("eq", "ne") and not self._counts(node):
            return self._equal(sides, op == "eq")
        if op in INFIX:
            sign, strength = INFIX[op]
            return Text(f"{sides[0].beside(strength)} {sign} {sides[1].inside(6)}", strength)
        if op == "neg":
            return Text("-" + sides[0].inside(7), 6)
        if op == "sq":
            return Text(f"{sides[0].inside(ATOM)} * {sides[0].inside(ATOM)}", 5)
        if op == "inv":
            return Text(f"{literal(1.0, self.scalar).c} / {sides[0].inside(6)}", 5)
        if op == "polynomial":
            return Text(f"{node.name}({sides[0].c})")
        if op == "table":
            return Text(f"{constant(node.name)}[{self._cast('uint32_t', node.args[0], sides[0]).c}]")
        if op == "floor":
            return Text(f"({CTYPES[self.scalar]}){self._cast('uint32_t', node.args[0], sides[0]).c}", 7)
        suffix = "f" if op in LIBM and self.scalar is np.float32 else ""
        prefix = f"{self.name}_" if op in HELPERS else ""
        return Text(f"{prefix}{op}{suffix}({', '.join(s.c for s in sides)})")

    def value(self, k: int) -> Text:
        """Return node k as a number of the scalar type."""
        if self.kinds[k] == "logical":
            one, zero = (literal(v, self.scalar).c for v in (1.0, 0.0))
            return Text(f"{self.condition(k).inside(6)} ? {one} : {zero}", -1)
        if self.kinds[k] == "integer":
            return self._cast(CTYPES[self.scalar], k, self.operand(k))
        return self.operand(k)

    def integer(self, k: int) -> Text:
        """Return node k as a uint32_t."""
        node = self.p.nodes[k]
        if node.op == "literal":
            return Text(constant(node.name) if node.name else f"{int(node.value)}u")
        if self.kinds[k] == "logical":
            return Text(f"{self.name}_flag({self.condition(k).c})")
        return self.operand(k) if self.kinds[k] == "integer" else self._cast("uint32_t", k, self.value(k))

    def number(self, n: Node) -> Text:
        """Return a constant or a literal as a number of the scalar type."""
        return signed_constant(n) if n.op == "constant" else literal(n.value, self.scalar)

    def _cast(self, ctype: str, k: int, text: Text) -> Text:
        """Return the text of node k cast to a type; note the node if the text is composite."""
        if text.is_composite:
            self.late.add(k)
        return Text(f"({ctype}){text.inside(7)}", 7)

    def condition(self, k: int) -> Text:
        """Return node k as a truth value."""
        if self.kinds[k] == "logical":
            return self.operand(k)
        if self.kinds[k] == "integer":
            return Text(f"{self.operand(k).beside(2)} != 0u", 2)
        return self._equal([self.operand(k), literal(0.0, self.scalar)], False)

    def negation(self, k: int) -> Text:
        """Return the negation of node k as a truth value: of a count, of bits and of an unnamed comparison, their own.

        A comparison of numbers that may be NaN is not the reverse of another one.
        """
        node, reverse = self.p.nodes[k], {"lt": "le", "le": "lt"}
        if self.kinds[k] == "integer":
            return Text(f"{self.operand(k).beside(2)} == 0u", 2)
        if node.op == "accepted" and self.text[k].strength < ATOM:
            return self._bits(node, "!=")
        if node.op in reverse and self._counts(node) and self.text[k].strength < ATOM:
            return self._count_or_comparison(Node(reverse[node.op], node.args[::-1]))
        return Text("!" + self.condition(k).inside(7), 7)

    def _bits(self, node: Node, sign: str) -> Text:
        """Return the comparison with 0 of the bits of a fault word that a node tests."""
        return Text(f"({self.operand(node.args[0]).c} & {mask(node)}) {sign} 0u", 2)

    def _equal(self, sides: list[Text], holds: bool) -> Text:
        """Return the comparison of two real numbers by a function: compilers warn about == between them."""
        call = f"{self.name}_equal({', '.join(s.c for s in sides)})"
        return Text(call) if holds else Text(f"!{call}", 7)

    def operand(self, k: int) -> Text:
        """Return the text of node k as an operand: its local or expression, or the literal or constant itself."""
        node = self.p.nodes[k]
        return self.of(k) if node.op in INLINE else self.text[k]


def mask(node: Node) -> str:
    """Return the mask of the node's bit."""
    return f"0x{int(node.value):08x}u"
