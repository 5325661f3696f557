"""Equations of a composition in ASCII, printed from its expressions before polynomials replace functions.

    i_d = (w - G) / (a + b)        of a signal, in signals, inputs and states of its Block and in its numbers
    integral_next = ...            of a next state

Signals whose equations differ in corresponding names alone are listed with the first one. Where it is shorter, a
section's equations are in those variables of its law that they share, whose equations stand above them. Else an
equation longer than LONGEST is in those variables of the law that are locals in C, unless it is a choice between two of
them. A signal whose equation is too long even so has none, nor has one that the code repeats as it is; a section
without any other shows its first one.
"""

import re
from collections import ChainMap, Counter
from collections.abc import Container, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import chain, takewhile
from textwrap import wrap

from synth.blocks.guard import safety
from synth.emit.passes import parts
from synth.emit.program.lower import Node, Program
from synth.emit.program.operations import LIBM, LOGICAL

LONGEST = 200  # characters of an equation
LONGEST_OF_VARIABLES = 140  # of one in variables of the law
LONGEST_HIDDEN = 440  # of one with functions that polynomials replace
FEWEST = 4  # operations of an equation that the code hides
WIDTH = 100
INFIX = {"add": ("+", 4), "sub": ("-", 4), "mul": ("*", 5), "div": ("/", 5), "lt": ("<", 3), "le": ("<=", 3)}
INFIX |= {"eq": ("==", 3), "ne": ("!=", 3), "and": ("and", 2), "or": ("or", 1)}
HIDDEN = LIBM - {"sqrt", "fabs"}  # functions that polynomials replace
SILENT = (safety.SAFE_OUTPUT,)  # its function says what it does
OF_GUARD = ("latched", "left_next", "ready_next")  # the functions of the inputs say what they do
ATOM = 9
NAME = re.compile(r"\b[A-Za-z]\w*\b(?!\()")
_LEAVES = ("input", "state", "literal", "constant")


@dataclass(frozen=True)
class Equation:
    """A signal or next state, what it equals, and whether the code shows this as it is."""

    name: str
    node: int
    text: str
    is_hidden: bool
    counts: Mapping[str, float] = field(default_factory=dict)

    @property
    def form(self) -> str:
        """The text with its names counted in the order in which they are met, and with the values of whole numbers."""
        places = {name: f"{value:g}" for name, value in self.counts.items()}
        return NAME.sub(lambda word: places.setdefault(word[0], f"_{len(places)}"), self.text)


def by_block(p: Program, variables: Container[str] = ()) -> dict[str, tuple[str, ...]]:
    """Return the lines of the equations of each Block of the composition; `variables` are the locals of the C."""
    ends: dict[str, dict[str, int]] = {block: {} for block in p.titles}
    for named, k in p.marks:
        ends[named.block][named.signal.name] = k
    following: dict[str, dict[str, int]] = {block: {} for block in p.titles}
    latched = next((k for named, k in p.marks if named.signal.name == "latched"), -1)
    for name in p.next:
        owner = p.owner(name)
        following.setdefault(owner, {})[f"{_local(name, owner)}_next"] = _without_latch(p, name, latched)
    names = {k: named.signal.name for named, k in reversed(p.marks) if p.nodes[k].op not in ("input", "state")}
    labels, of_blocks = _variables(p, names, variables), _variables_by_block(p, names)
    for of in (ends, following):
        of[safety.GUARD] = {n: k for n, k in of.get(safety.GUARD, {}).items() if n in OF_GUARD}
    shown: dict[str, Sequence[str]] = {}
    for block in (b for b in p.titles if b not in SILENT):
        text = _Text(p, block, following[block], names, labels)
        plain = _worth_showing(_equations(text, ends[block], following[block]))
        common = _common(p, of_blocks[block], {**ends[block], **following[block]}, names)
        forms = _together(plain), _together(_in_variables(text, plain, common))
        shown[block] = min(forms, key=lambda texts: len("".join(texts)))
    rows = {block: _wrapped(_like_another(block, shown) or lines) for block, lines in shown.items()}
    return {block: lines for block, lines in rows.items() if lines}


def _like_another(block: str, shown: Mapping[str, Sequence[str]]) -> list[str]:
    """Return that a Block's equations are those of an earlier one, where one word of the names makes the difference."""
    for other in takewhile(lambda name: name != block, shown):
        pairs = list(zip(other.split("_"), block.split("_"), strict=False))
        words = [(a, b) for a, b in pairs if a != b]
        if len(words) != 1 or other.count("_") != block.count("_") or not shown[block]:
            continue
        before, after = words[0]
        word = re.compile(rf"(?<![A-Za-z0-9]){re.escape(before)}(?![A-Za-z0-9])")
        if {word.sub(after, text) for text in shown[other]} == set(shown[block]):
            return [f"as {other}, with {after} in place of {before}"]
    return []


def _common(
    p: Program, candidates: Mapping[int, str], ends: Mapping[str, int], names: Mapping[int, str]
) -> dict[int, str]:
    """Return those of a Block's variables, each of a name of its own, that its equations read more than once."""
    reads: Counter[int] = Counter()
    stack, seen = [*ends.values()], set()
    while stack:
        k = stack.pop()
        if k not in seen:
            seen.add(k)
            reads.update({*p.nodes[k].args})
            stack += [a for a in p.nodes[k].args if a not in names]
    counts = Counter(candidates.values())
    return {k: name for k, name in candidates.items() if reads[k] > 1 and counts[name] == 1 and name not in ends}


def _in_variables(text: "_Text", equations: Sequence[Equation], common: Mapping[int, str]) -> list[Equation]:
    """Return the equations in the variables that they share, after those of the variables that they read.

    A variable whose own equation is too long is not used.
    """
    names, fits = text.names, False
    while not fits:
        text.names = ChainMap({}, names, common)  # type: ignore[arg-type]
        of_variables = [text.equation(name, k) for k, name in sorted(common.items(), reverse=True)]
        fits = all(e.text for e in of_variables)
        common = {e.node: e.name for e in of_variables if e.text}
    result = [text.equation(e.name, e.node) for e in equations]
    for e in of_variables:
        if any(e.name in NAME.findall(reader.text) for reader in result):
            result.insert(0, e)
    return result


def _variables_by_block(p: Program, names: Mapping[int, str]) -> dict[str, dict[int, str]]:
    """Return by Block the nodes without a signal that have the name of a variable of its law."""
    taken = {*names.values(), *(n.name for n in p.nodes if n.op in _LEAVES)}
    owner, variables = parts.by_node(p), {block: dict[int, str]() for block in p.titles}
    for k, name in p.labels.items():
        plain = p.nodes[k].op in (*_LEAVES, *HIDDEN)
        if owner[k] in variables and not plain and taken.isdisjoint((name, f"{owner[k]}_{name}")):
            variables[owner[k]][k] = name
    return variables


def _variables(p: Program, names: Mapping[int, str], locals: Container[str]) -> dict[int, str]:
    """Return the nodes without a signal that alone have the name of a variable of a law, which C has as well."""
    counts, used = Counter(p.labels.values()), {*names.values(), *(n.name for n in p.nodes)}
    used |= {_local(name, p.owner(name)) for name in p.next}
    alone = {k: name for k, name in p.labels.items() if counts[name] == 1 and name in locals}
    return {k: name for k, name in alone.items() if name not in used and k not in names}


def _equations(text: "_Text", ends: Mapping[str, int], following: Mapping[str, int]) -> list[Equation]:
    known = {*ends.values()}
    all_ends = {**ends, **{name: k for name, k in following.items() if k not in known}}
    computed = {name: k for name, k in all_ends.items() if text.p.nodes[k].op not in _LEAVES}
    equations = (text.equation(name, k) for name, k in computed.items())
    return [e for e in equations if e.text]


def _without_latch(p: Program, state: str, latched: int) -> int:
    """Return the node of the next value of a state, without the choice that keeps the state once latched."""
    k = p.next[state]
    node, load = p.nodes[k], Node("state", name=state)
    kept = node.op == "choose" and node.args[0] == latched and p.nodes[node.args[1]] == load
    return node.args[2] if kept else k


def _local(name: str, block: str) -> str:
    return name.removeprefix(f"{block}_")


def _worth_showing(equations: Sequence[Equation]) -> list[Equation]:
    """Return the equations that the code hides, else those of the first one's form."""
    first = [e for e in equations if e.form == equations[0].form]
    return [e for e in equations if e.is_hidden] or first


def _together(equations: Sequence[Equation]) -> list[str]:
    """Return the texts of equations, those of one form with names that correspond together."""
    groups: list[list[Equation]] = []
    for e in equations:
        like = (group for group in groups if group[0].form == e.form and _corresponds(group[0], e))
        group = next(like, None)
        if group is None:
            groups.append([e])
        else:
            group.append(e)
    others = [f"; likewise {', '.join(e.name for e in group[1:])}" if group[1:] else "" for group in groups]
    return [f"{first.name} = {first.text}{also}" for (first, *_), also in zip(groups, others, strict=True)]


def _corresponds(e: Equation, other: Equation) -> bool:
    """Tell whether two equations of one form differ in names that are alike, or in single words."""
    pairs = {*zip(NAME.findall(e.text), NAME.findall(other.text), strict=True)}
    words = {*zip(*(re.split(r"\W|_", each.text.lower()) for each in (e, other)), strict=False)}
    on_the_left = _alike(e.name, other.name) or (e.name.lower(), other.name.lower()) in words
    return on_the_left and all(_alike(a, b) or "_" not in a + b for a, b in pairs)


def _alike(name: str, other: str) -> bool:
    """Tell whether names have a word in common, or are one but for a number."""
    digits = "0123456789"
    return bool({*name.split("_")} & {*other.split("_")}) or name.rstrip(digits) == other.rstrip(digits)


def _wrapped(texts: Sequence[str]) -> tuple[str, ...]:
    rows = (
        wrap(text, WIDTH, subsequent_indent="    ", break_on_hyphens=False, break_long_words=False) for text in texts
    )
    return tuple(chain.from_iterable(rows))


class _Text:
    """The text of a Block's nodes in terms of signals, with the precedence of the outermost operator."""

    def __init__(
        self,
        p: Program,
        block: str,
        following: Mapping[str, int],
        names: Mapping[int, str],
        variables: Mapping[int, str],
    ) -> None:
        self.p, self.block, self.variables = p, block, variables
        inner = {k: name for name, k in following.items() if p.nodes[k].op not in _LEAVES}
        self.names: Mapping[int, str] = ChainMap(inner | {k: names[k] for k in inner if k in names}, names)  # type: ignore[arg-type]
        self.signals = {named.signal.name for named, k in p.marks if p.nodes[k].op not in _LEAVES}
        self.left = self.operations = 0
        self.counts: dict[str, float] = {}

    def equation(self, name: str, k: int) -> Equation:
        """Return the equation of node k, in variables of the law where it is too long, else with an empty text."""
        made, names = self._equation(name, k, LONGEST), self.names
        if not made.text and self.variables:
            self.names = ChainMap({}, names, self.variables)  # type: ignore[arg-type]
            node = self.p.nodes[k]
            plain = node.op == "choose" and all(self._is_leaf(a) for a in node.args[1:])
            made, self.names = made if plain else self._equation(name, k, LONGEST_OF_VARIABLES), names
        return made

    def _is_leaf(self, k: int) -> bool:
        return k in self.names or self.p.nodes[k].op in _LEAVES

    def _equation(self, name: str, k: int, longest: int) -> Equation:
        self.left, self.operations, self.counts = LONGEST_HIDDEN, 0, {}
        text = self._operation(k)[0] if self.names.get(k, name) == name else self.names[k]
        replaced = any(f"{function}(" in text for function in HIDDEN)
        length = len(re.sub(r"\w+", lambda word: "9" if word[0] in self.counts else word[0], text))
        fits = self.left > 0 and length <= (LONGEST_HIDDEN if replaced else longest)
        return Equation(name, k, text if fits else "", replaced or self.operations >= FEWEST, self.counts)

    def _node(self, k: int, strength: int) -> str:
        """Return the text of an operand, in parentheses where its operator binds less."""
        self.left -= 1
        if k in self.names:
            return self.names[k]
        text, binding = self._operation(k) if self.left > 0 else ("", ATOM)
        self.left -= len(text) if binding == ATOM else 0
        return text if binding >= strength else f"({text})"

    def _operation(self, k: int) -> tuple[str, int]:
        node = self.p.nodes[k]
        leaf = self._leaf(node)
        if leaf:
            return leaf
        self.operations += 1
        if node.op in INFIX:
            sign, strength = INFIX[node.op]
            first, second = self._node(node.args[0], strength), self._node(node.args[1], strength + (node.op != "add"))
            return f"{first} {sign} {second}", strength
        if node.op == "choose":
            condition, then, other = (self._node(a, 1) for a in node.args)
            return f"{then} if {condition}{'' if self._is_test(node.args[0]) else ' is set'}, else {other}", 0
        if node.op == "sq":
            return f"{self._node(node.args[0], ATOM)}^2", 7
        if node.op in ("neg", "not", "inv", "fabs"):
            return self._unary(node)
        if node.op == "clamp":
            return f"limit({self._node(node.args[0], 0)}, {self._node(node.args[2], 0)})", ATOM
        return f"{node.op}({', '.join(self._node(a, 0) for a in node.args)})", ATOM

    def _unary(self, node: Node) -> tuple[str, int]:
        if node.op == "fabs":
            return f"|{self._node(node.args[0], 0)}|", ATOM
        if node.op == "inv":
            return f"1 / {self._node(node.args[0], 6)}", 5
        return f"{'-' if node.op == 'neg' else 'not '}{self._node(node.args[0], 6)}", 5

    def _is_test(self, k: int) -> bool:
        return self.p.nodes[k].op in LOGICAL

    def _leaf(self, node: Node) -> tuple[str, int] | None:
        if node.op == "literal":
            self.counts |= {node.name: node.value} if node.name else {}
            return node.name or f"{node.value:.6g}", ATOM if node.value >= 0 else 6
        if node.op in ("input", "state", "constant"):
            sign, local = "-" if node.op == "constant" and node.value < 0 else "", _local(node.name, self.block)
            return f"{sign}{node.name if local in self.signals else local}", 6 if sign else ATOM
        return None
