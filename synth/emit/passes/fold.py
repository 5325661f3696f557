"""Constant folding and algebraic simplification. Each rule rewrites one node; a second pass shares reciprocals.

    numbers         l1 op l2,  l1 (l2 x) = (l1 l2) x,  x / l = (1/l) x,  l1 / (l2 x) = (l1/l2) / x,  x + 0, 1 x
    signs           a - (-b),  -(l x) = (-l) x
    choices         not c ? a : b = c ? b : a,  c ? a : (c ? b : d) = c ? a : d,  a gate is a choice with 0
    limits          max(min(x, h), -h)  is a clamp of x to -h .. h, with one comparison while x is inside
                    max(max(x, l), l) = max(x, l)
    intervals       -h <= x && x <= h  is  |x| <= h, also for NaN
    constants       k1 (k2 x) = (k1 k2) x for named constants, the product rounded to the scalar type once
    divisions       a / d and b / d, or 1/d: one reciprocal, and products
    comparisons     2 y + e < 2 x  is  e/2 < x - y  where x - y is an argument that the condition may guard

Numbers are folded in double and rounded once, when they are printed.
"""

import operator
from collections.abc import Callable, Sequence
from dataclasses import replace

from synth.emit.program.lower import Node, Program
from synth.emit.program.operations import LOGICAL
from synth.emit.proof.safe import Guard, node_guards

_ARITHMETIC: dict[str, Callable[[float, float], float]] = {
    "add": operator.add,
    "sub": operator.sub,
    "mul": operator.mul,
    "min": min,
    "max": max,
}


class Folder:
    """The nodes of the new program, each once (value numbering), in the order of computation."""

    def __init__(self) -> None:
        self.nodes: list[Node] = []
        self.known: dict[Node, int] = {}

    def place(self, node: Node) -> int:
        if node not in self.known:
            self.known[node] = len(self.nodes)
            self.nodes.append(node)
        return self.known[node]

    def literal(self, value: float) -> int:
        return self.place(Node("literal", value=value))

    def number(self, k: int) -> float | None:
        node = self.nodes[k]
        return node.value if node.op == "literal" else None

    def split_factor(self, k: int) -> tuple[float, int]:
        """Split node k into a number l and a node x with k = l x; l is 1 for a node without a numeric factor."""
        node = self.nodes[k]
        if node.op == "neg":
            return -1.0, node.args[0]
        if node.op == "mul" and (l := self.number(node.args[0])) is not None:
            return l, node.args[1]
        return 1.0, k

    def make(self, node: Node) -> int:
        """Return the index of a node with folded arguments, after simplification."""
        rule = _RULES.get(node.op)
        replacement = rule(self, *node.args) if rule else None
        return self.place(node) if replacement is None else replacement


def _neg(f: Folder, a: int) -> int | None:
    if (l := f.number(a)) is not None:
        return f.literal(-l)
    l, x = f.split_factor(a)
    return None if l == 1 else times(f, -l, x)


def times(f: Folder, l: float, x: int) -> int:
    """Return the index of l x."""
    if (number := f.number(x)) is not None:
        return f.literal(l * number)
    m, x = f.split_factor(x)
    l *= m
    if l == 1:
        return x
    if l == -1:
        return f.place(Node("neg", (x,)))
    node = f.nodes[x]
    if node.op == "div" and (top := f.number(node.args[0])) is not None:
        return f.place(Node("div", (f.literal(l * top), node.args[1])))
    if node.op == "inv":
        return f.place(Node("div", (f.literal(l), node.args[0])))
    return f.place(Node("mul", (f.literal(l), x)))


def _mul(f: Folder, a: int, b: int) -> int | None:
    (l, x), (m, y) = f.split_factor(a), f.split_factor(b)
    for number, other in ((f.number(a), b), (f.number(b), a)):
        if number is not None:
            return times(f, number, other)
    if l != 1 or m != 1:
        return times(f, l * m, f.make(Node("mul", (x, y))))
    return f.place(Node("sq", (x,))) if x == y else None


def _div(f: Folder, a: int, b: int) -> int | None:
    top, bottom = f.number(a), f.number(b)
    if bottom is not None and bottom != 0:
        return times(f, 1 / bottom, a) if top is None else f.literal(top / bottom)
    (l, x), (m, y) = (top, a) if top is not None else f.split_factor(a), f.split_factor(b)
    if m in (0.0, 1.0):
        return None
    if top is not None:
        return f.make(Node("div", (f.literal(l / m), y)))
    return f.make(Node("div", (times(f, l / m, x), y)))


def _inv(f: Folder, a: int) -> int | None:
    return _div(f, f.literal(1.0), a) if f.number(a) or f.split_factor(a)[0] != 1 else None


def _sum(f: Folder, op: str, a: int, b: int) -> int | None:
    first, second = f.number(a), f.number(b)
    if first is not None and second is not None:
        return f.literal(_ARITHMETIC[op](first, second))
    if second == 0:
        return a
    if first == 0:
        return b if op == "add" else _neg(f, b) or f.place(Node("neg", (b,)))
    l, x = f.split_factor(b)
    if l < 0:
        return f.make(Node("sub" if op == "add" else "add", (a, times(f, -l, x))))
    l, x = f.split_factor(a)
    if l < 0 and op == "add":
        return f.make(Node("sub", (b, times(f, -l, x))))
    return None


def _extreme(op: str) -> Callable[[Folder, int, int], int | None]:
    def rule(f: Folder, a: int, b: int) -> int | None:
        first, second = f.number(a), f.number(b)
        if first is not None and second is not None:
            return f.literal(_ARITHMETIC[op](first, second))
        for limited, bound in ((a, b), (b, a)):
            if f.nodes[limited].op == op and f.nodes[limited].args[1] == bound:
                return limited
        return None

    return rule


def _limit(f: Folder, a: int, b: int) -> int | None:
    """Recognise max(min(x, h), -h) as a clamp of x to -h .. h."""
    if (simpler := _extreme("max")(f, a, b)) is not None:
        return simpler
    for inner, low in ((f.nodes[a], b), (f.nodes[b], a)):
        if inner.op == "min":
            for x, high in (inner.args, inner.args[::-1]):
                negative = f.number(low) is not None and f.number(high) == -f.nodes[low].value
                if negative or f.nodes[low] == Node("neg", (high,)):
                    return f.place(Node("clamp", (x, low, high)))
    return None


def _not(f: Folder, a: int) -> int | None:
    node = f.nodes[a]
    if (l := f.number(a)) is not None:
        return f.literal(float(l == 0))
    return _truth(f, node.args[0]) if node.op == "not" else None


def _truth(f: Folder, a: int) -> int:
    return a if f.nodes[a].op in LOGICAL else f.place(Node("ne", (a, f.literal(0.0))))


def _choose(f: Folder, c: int, a: int, b: int) -> int | None:
    if (l := f.number(c)) is not None:
        return a if l else b
    if f.nodes[c].op == "not":
        return f.make(Node("choose", (f.nodes[c].args[0], b, a)))
    first, second = f.nodes[a], f.nodes[b]
    if first.op == "choose" and first.args[0] == c:
        return f.make(Node("choose", (c, first.args[1], b)))
    if second.op == "choose" and second.args[0] == c:
        return f.make(Node("choose", (c, a, second.args[2])))
    return a if a == b else None


def _and(f: Folder, a: int, b: int) -> int | None:
    first, second = f.nodes[a], f.nodes[b]
    if first.op == second.op == "le":
        low, high = f.number(first.args[0]), f.number(second.args[1])
        if low is not None and high == -low and first.args[1] == second.args[0]:
            return f.place(Node("le", (f.place(Node("fabs", (first.args[1],))), second.args[1])))
    for number, other in ((f.number(a), b), (f.number(b), a)):
        if number is not None:
            return _truth(f, other) if number else f.literal(0.0)
    return None


def _or(f: Folder, a: int, b: int) -> int | None:
    for number, other in ((f.number(a), b), (f.number(b), a)):
        if number is not None:
            return f.literal(1.0) if number else _truth(f, other)
    return None


_RULES: dict[str, Callable[..., int | None]] = {
    "neg": _neg,
    "mul": _mul,
    "div": _div,
    "inv": _inv,
    "add": lambda f, a, b: _sum(f, "add", a, b),
    "sub": lambda f, a, b: _sum(f, "sub", a, b),
    "twice": lambda f, a: times(f, 2.0, a),
    "min": _extreme("min"),
    "max": _limit,
    "not": _not,
    "when": lambda f, c, a: f.make(Node("choose", (c, a, f.literal(0.0)))),
    "choose": _choose,
    "and": _and,
    "or": _or,
}


def folded(p: Program) -> Program:
    """Return a program that computes the same values, up to rounding, with fewer operations."""
    return _compare_differences(_share_divisions(_rebuild(p, lambda f, node, _: f.make(node))))


def with_constant_products(p: Program) -> Program:
    """Return the program with one factor in place of two named constants: k1 (k2 x) = (k1 k2) x.

    This requires that no other node reads k2 x. The products are listed in `products`; none is a factor of another.
    """
    users, live_out = p.users(), set(p.ends())
    products = dict(p.products)
    used_names = {n.name for n in p.nodes}
    merged: dict[Node, str] = {}
    for node in p.nodes:
        first, second = (p.nodes[a] for a in node.args) if node.op == "mul" else (node, node)
        if first.op != "constant" or second.op != "mul" or p.nodes[second.args[0]].op != "constant" or second in merged:
            continue
        pair = (first.name, p.nodes[second.args[0]].name)
        name = "_times_".join(pair)
        unused = name not in used_names and products.get(name, pair) == pair
        if unused and len(users[node.args[1]]) == 1 and node.args[1] not in live_out:
            merged[node] = name
            products[name] = pair

    def make(f: Folder, node: Node, old: Node) -> int:
        if old not in merged:
            return f.place(node)
        return f.place(Node("mul", (f.place(Node("constant", name=merged[old])), f.nodes[node.args[1]].args[1])))

    return _rebuild(replace(p, products=products), make)


def _rebuild(p: Program, make: Callable[[Folder, Node, Node], int]) -> Program:
    """Return the program rebuilt node by node: `make` gets the node with new arguments, and the old node."""
    f = Folder()
    index: list[int] = []
    for node in p.nodes:
        index.append(make(f, node.renumbered(index), node))
    return p.with_nodes(tuple(f.nodes), index, _names_of_negatives(p, f, index))


def _names_of_negatives(p: Program, f: Folder, index: Sequence[int]) -> dict[int, str]:
    """Return names for nodes whose negative a law labels, as `lower` gives them."""
    negatives = {f.nodes[index[k]]: f"minus_{name}" for k, name in p.labels.items() if "minus" not in name}
    return {n.args[0]: name for n, name in negatives.items() if n.op == "neg" and f.nodes[n.args[0]].op != "mul"}


def _share_divisions(p: Program) -> Program:
    """Replace divisions by the same divisor by one reciprocal, if one of them is executed whenever any other is."""
    guards = node_guards(p)
    divisors: dict[int, list[frozenset[Guard]]] = {}
    for k, n in enumerate(p.nodes):
        if n.op in ("div", "inv"):
            divisors.setdefault(n.args[-1], []).append(guards[k])
    shared = {
        d
        for d, guard_sets in divisors.items()
        if len(guard_sets) > 1 and frozenset.intersection(*guard_sets) in guard_sets
    }

    def make(f: Folder, node: Node, old: Node) -> int:
        if node.op != "div" or old.args[1] not in shared:
            return f.place(node)
        top, inverse = node.args[0], f.place(Node("inv", node.args[1:]))
        if (number := f.number(top)) is None:
            return f.make(Node("mul", (top, inverse)))
        return inverse if number == 1 else f.place(Node("mul", (top, inverse)))

    return _rebuild(p, make)


def _compare_differences(p: Program) -> Program:
    """Compare a sum or difference itself where it is the argument of an operation that is not defined for all.

    A comparison of numbers that differ by l d + c, with such a d and a number l, is one of d with -c / l.
    """
    factors = {n.args[-1] for n in p.nodes if n.op in _GUARDED}
    for k in range(len(p.nodes) - 1, -1, -1):
        factors |= {*p.nodes[k].args} if k in factors and p.nodes[k].op in _FACTORS else set()
    sums = [k for k in sorted(factors) if p.nodes[k].op == "sub" or _is_sum_of_values(p, k)]
    guarded = [{frozenset(d.keys() - {_ONE}): (k, d) for k in sums for d in [_form(p, k, n)]} for n in _DEPTHS]
    f = Folder()
    index: list[int] = []

    def copy(k: int) -> int:
        """Return node k in the new program, which it may not have reached."""
        if k < len(index):
            return index[k]
        return f.place(p.nodes[k].renumbered({a: copy(a) for a in p.nodes[k].args}))

    for node in p.nodes:
        made = f.place(node.renumbered(index))
        if node.op in ("lt", "le") and sums:
            made = _compare(p, f, node, guarded, copy) or _compare_magnitude(p, f, node, guarded, copy) or made
        index.append(made)
    return p.with_nodes(tuple(f.nodes), index)


def _is_sum_of_values(p: Program, k: int) -> bool:
    """Tell whether node k is a sum; one with a named constant is none, for that keeps it from 0 as it is."""
    return p.nodes[k].op == "add" and not any(p.nodes[a].op in ("constant", "literal") for a in p.nodes[k].args)


_GUARDED = ("div", "inv", "sqrt", "log")
_FACTORS = ("mul", "sq", "neg", "fabs", "sqrt")
_DEPTHS = range(1, 5)
_ONE = -1

_Form = dict[int, float]  # the factor of each node, and with _ONE a number


def _form(p: Program, k: int, depth: int) -> _Form:
    """Return node k as a sum of multiples of nodes, so many operations deep."""
    node = p.nodes[k]
    if node.op == "literal":
        return {_ONE: node.value}
    if depth and node.op == "neg":
        return _scaled(_form(p, node.args[0], depth - 1), -1.0)
    if depth and node.op == "mul" and p.nodes[node.args[0]].op == "literal":
        return _scaled(_form(p, node.args[1], depth - 1), p.nodes[node.args[0]].value)
    if depth and node.op in ("add", "sub"):
        first, second = (_form(p, a, depth - 1) for a in node.args)
        return _total(first, _scaled(second, 1.0 if node.op == "add" else -1.0))
    return {k: 1.0}


def _scaled(form: _Form, l: float) -> _Form:
    return {k: l * v for k, v in form.items()}


def _total(first: _Form, second: _Form) -> _Form:
    both = {k: first.get(k, 0.0) + second.get(k, 0.0) for k in first | second}
    return {k: v for k, v in both.items() if v}


_Guarded = Sequence[dict[frozenset[int], tuple[int, _Form]]]  # by depth: a sum and its form, by the nodes in it


def _compare(p: Program, f: Folder, node: Node, guarded: _Guarded, copy: Callable[[int], int]) -> int | None:
    """Return a comparison of a guarded sum in place of one of its multiple, None where there is none."""
    for depth, by_nodes in zip(_DEPTHS, guarded, strict=True):
        difference = _total(_form(p, node.args[1], depth), _scaled(_form(p, node.args[0], depth), -1.0))
        nodes = difference.keys() - {_ONE}
        for e in (None, *sorted(nodes)):
            k, d = by_nodes.get(frozenset(nodes - {e}), (0, {}))
            first = min(d.keys() - {_ONE}, default=None)
            if first is None:
                continue
            l = difference[first] / d[first]
            rest = _total(difference, _scaled(d, -l))
            if rest.keys() - {_ONE, e}:
                continue
            threshold = f.literal(-rest.get(_ONE, 0.0) / l)
            if e is not None:
                multiple = times(f, -rest[e] / l, copy(e))
                threshold = f.make(Node("add", (multiple, threshold)))
            return f.place(Node(node.op, (threshold, copy(k)) if l > 0 else (copy(k), threshold)))
    return None


def _compare_magnitude(p: Program, f: Folder, node: Node, guarded: _Guarded, copy: Callable[[int], int]) -> int | None:
    """Return a comparison of the magnitude of a guarded sum with a number, in place of that of its multiple."""
    for position in (0, 1):
        of, bound = p.nodes[node.args[position]], p.nodes[node.args[1 - position]]
        for depth, by_nodes in zip(_DEPTHS, guarded, strict=True) if (of.op, bound.op) == ("fabs", "literal") else ():
            form = _form(p, of.args[0], depth)
            k, d = by_nodes.get(frozenset(form), (0, {}))
            first = min(d, default=_ONE)
            if first != _ONE and not _total(form, _scaled(d, -form[first] / d[first])):
                magnitude = f.place(Node("fabs", (copy(k),)))
                sides = [magnitude, f.literal(bound.value * abs(d[first] / form[first]))]
                return f.place(Node(node.op, (sides[position], sides[1 - position])))
    return None
