"""Constraint propagation: narrower intervals of values where a condition of the program holds or fails.

    low <= u && u <= high   true:  low <= u <= high, and u is not NaN
                            false: no information that one interval can express
    fabs(u) <= h            true:  -h <= u <= h
    fabs(u) >= l            true:  u >= l where u is known not to be negative, u <= -l where it is not positive
    u^2 + v^2 + .. <= h     true:  -sqrt(h) <= u <= sqrt(h), v likewise

What is known of a value before is never given up: a narrowed interval lies in it.

Rounding to nearest is monotone, so a sum of numbers that are not negative is not below any of them, and the rounded
square of u is at most h. Then u^2 is below the number after h.

A comparison with NaN is false. Only a comparison that holds therefore implies that its sides are not NaN.

Descriptions of a program's nodes for messages: the signal, the expression in C syntax, values with units.

Proof obligations of operations: a nonzero denominator, a nonnegative argument of a root, and so on.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from math import inf

import numpy as np

from synth.block import Block
from synth.emit.program.lower import Node, Program
from synth.emit.program.operations import LOGICAL
from synth.emit.proof.interval import Array, Interval, Mask, hull, intersection

_INFIX = {"add": "+", "sub": "-", "mul": "*", "div": "/", "lt": "<", "le": "<=", "eq": "==", "ne": "!="}
_INFIX |= {"and": "&&", "or": "||", "sq": "*"}
_PREFIX = {"neg": "-", "not": "!", "twice": "2 * ", "inv": "1 / "}
_DEEPEST, _LONGEST, _SHORT = 8, 160, 40  # limits of nesting depth and of characters


def signal(program: Program, k: int) -> str:
    """Return the first signal, in the order of the composition, that depends on node k."""
    named = next((named for named, at in program.marks if k in _cone(program, at)), None)
    if named is None:
        return "the next states"
    return f"'{named.signal.name}' (block '{named.block}'" + (f", {named.tag})" if named.tag else ")")


def _cone(program: Program, k: int) -> set[int]:
    nodes, waiting = set[int](), [k]
    while waiting:
        k = waiting.pop()
        if k not in nodes:
            nodes.add(k)
            waiting += program.nodes[k].args
    return nodes


def expression(program: Program, k: int, spelled: bool = True) -> str:
    """Return node k as text, `spelled` out even if it has a name; deeply nested operands become (...)."""
    names = {at: named.signal.name for named, at in program.marks}
    names |= {at: node.name for at, node in enumerate(program.nodes) if node.name}
    if k in names and (not spelled or program.nodes[k].name):
        return names[k]
    names.pop(k, None)
    texts = (_text(program, names, k, depth) for depth in range(_DEEPEST, 0, -1))
    return next((t for t in texts if len(t) <= _LONGEST), _text(program, names, k, 1))


def function(program: Program, root: int, variable: int) -> str:
    """Return node `root` as a function of x, the node `variable`, "" where the text is long."""
    names = {at: node.name for at, node in enumerate(program.nodes) if node.op == "constant"} | {variable: "x"}
    text = _text(program, names, root, _DEEPEST)
    return "" if len(text) > _SHORT else text[1:-1] if text.startswith("(") else text


def _text(program: Program, names: dict[int, str], k: int, depth: int) -> str:
    node = program.nodes[k]
    if k in names:
        return names[k]
    if node.op == "literal":
        return f"{node.value:.9g}"
    if not depth:
        return "(...)"
    if node.op == "choose":
        test, last = (program.nodes[node.args[k]] for k in (0, 2))
        if last.op == "floor" and last.args == test.args[:1]:
            return _text(program, names, node.args[2], depth)  # of any sign, as it was before lowering
    sides = [_text(program, names, a, depth - 1) for a in node.args]
    if node.op in _INFIX:
        return f"({sides[0]} {_INFIX[node.op]} {sides[-1]})"
    if node.op in ("choose", "when"):
        return f"({sides[0]} ? {sides[1]} : {sides[2] if node.op == 'choose' else '0'})"
    if node.op in _PREFIX:
        return f"({_PREFIX[node.op]}{sides[0]})"
    return f"{node.op}{sides[0]}" if len(sides) == 1 and sides[0][0] == "(" else f"{node.op}({', '.join(sides)})"


def values(block: Block, program: Program, leaves: Sequence[int], low: Array, high: Array) -> str:
    """Return the leaves' values, or ranges, with units."""
    units = {s.name: s.unit for s in (*block.inputs, *(s.signal for s in block.states))}
    units |= {named.signal.name: named.signal.unit for named, _ in program.marks}
    rows = []
    for leaf, first, last in zip(leaves, low, high, strict=True):
        name = expression(program, leaf, spelled=False)
        text = f"{first:.9g}" if first == last else f"{first:.9g} .. {last:.9g}"
        rows.append(f"{name} = {text}" + (f" {units[name]}" if name in units else ""))
    return ", ".join(rows)


Narrowing = dict[int, Interval]
Decided = tuple[int, bool]  # a condition, and whether it holds


def narrowable_nodes(nodes: Sequence[Node], condition: int) -> frozenset[int]:
    """Return the nodes whose intervals `narrow` may narrow."""
    node = nodes[condition]
    if node.op in ("and", "or", "not"):
        return frozenset({condition}).union(*(narrowable_nodes(nodes, a) for a in node.args))
    if node.op in LOGICAL:
        return frozenset({condition}).union(*(_chain(nodes, a) for a in node.args))
    return _chain(nodes, condition)


def _chain(nodes: Sequence[Node], k: int) -> frozenset[int]:
    """Return a node and its operands through negations, absolute values, squares and sums of such."""
    passed = nodes[k].op in ("neg", "fabs") or _is_square(nodes[k]) or _is_sum_of_squares(nodes, k)
    return frozenset({k}).union(*(_chain(nodes, a) for a in nodes[k].args if passed))


def _is_square(node: Node) -> bool:
    return node.op == "sq" or (node.op == "mul" and node.args[0] == node.args[1])


def _is_sum_of_squares(nodes: Sequence[Node], k: int) -> bool:
    return nodes[k].op == "add" and all(_is_square(nodes[a]) or _is_sum_of_squares(nodes, a) for a in nodes[k].args)


def narrow(
    nodes: Sequence[Node],
    whole: frozenset[int],
    condition: int,
    holds: bool,
    R: Mapping[int, Interval],
    known: dict[Decided, Narrowing] | None = None,
) -> Narrowing:
    """Return narrower intervals of nodes where the condition holds, or fails; R maps each node to its interval.

    `whole` are the nodes with whole values only. An empty interval means that the condition cannot hold, or fail.
    `known` holds, and gets, the results for one R.
    """
    known = {} if known is None else known
    if (condition, holds) not in known:
        known[condition, holds] = _narrow(nodes, whole, condition, holds, R, known)
    return known[condition, holds]


def _narrow(
    nodes: Sequence[Node],
    whole: frozenset[int],
    condition: int,
    holds: bool,
    R: Mapping[int, Interval],
    known: dict[Decided, Narrowing],
) -> Narrowing:
    node = nodes[condition]
    if node.op == "not":
        narrowed = dict(narrow(nodes, whole, node.args[0], not holds, R, known))
    elif node.op in ("and", "or"):
        first, second = (narrow(nodes, whole, a, holds, R, known) for a in node.args)
        narrowed = intersect((first, second)) if (node.op == "and") == holds else _hulls(first, second)
    elif node.op in LOGICAL:
        narrowed = _narrow_comparison(nodes, whole, node, holds, R)
    else:
        narrowed = _narrow_flag(nodes, whole, condition, holds, R)
    if node.op in LOGICAL:
        side = np.full_like(R[condition].low, holds)
        narrowed[condition] = intersection(R[condition], Interval(side, side, np.zeros_like(R[condition].nan)))
    return narrowed


def intersect(parts: Iterable[Narrowing]) -> Narrowing:
    """Return the intersection of several narrowings."""
    narrowed: Narrowing = {}
    for part in parts:
        for k, a in part.items():
            narrowed[k] = intersection(narrowed[k], a) if k in narrowed else a
    return narrowed


def _hulls(first: Narrowing, second: Narrowing) -> Narrowing:
    return {k: hull(first[k], second[k]) for k in first.keys() & second.keys()}


def _narrow_flag(
    nodes: Sequence[Node], whole: frozenset[int], k: int, holds: bool, R: Mapping[int, Interval]
) -> Narrowing:
    """Return the narrowing of a number that is used as a condition: it is 0 or not."""
    a = R[k]
    if not holds:
        zero = np.zeros_like(a.low)
        return _propagate(nodes, k, intersection(a, Interval(zero, zero, np.zeros_like(a.nan))), R)
    if k in whole:
        low, high = np.where(a.low >= 0, np.maximum(a.low, 1), a.low), np.where(a.high <= 0, -1, a.high)
        return _propagate(nodes, k, Interval(low, high, a.nan), R)
    return {}


def _narrow_comparison(
    nodes: Sequence[Node], whole: frozenset[int], node: Node, holds: bool, R: Mapping[int, Interval]
) -> Narrowing:
    (i, j), (a, b) = node.args, (R[k] for k in node.args)
    if node.op in ("eq", "ne"):
        if (node.op == "eq") != holds:
            return {}
        both = intersection(a, b)
        both = Interval(both.low, both.high, np.zeros_like(both.nan))
        return intersect((_propagate(nodes, i, both, R), _propagate(nodes, j, both, R)))
    steps = i in whole and j in whole
    if holds:
        a, b = (Interval(s.low, s.high, np.zeros_like(s.nan)) for s in _narrow_by_order(a, b, node.op == "lt", steps))
    else:
        below, above = _narrow_by_order(b, a, node.op == "le", steps)
        # If the other side is NaN, the comparison fails whatever this side is.
        a, b = _unless(b.nan, above, a), _unless(a.nan, below, b)
    return intersect((_propagate(nodes, i, a, R), _propagate(nodes, j, b, R)))


def _narrow_by_order(a: Interval, b: Interval, strictly: bool, steps: bool) -> tuple[Interval, Interval]:
    """Narrow a and b by a <= b, or a < b; `steps`: both are whole."""
    low, high = a.low, b.high
    if strictly:
        bound = low.dtype.type(inf)
        low, high = (low + 1, high - 1) if steps else (np.nextafter(low, bound), np.nextafter(high, -bound))
    return Interval(a.low, np.minimum(a.high, high), a.nan), Interval(np.maximum(b.low, low), b.high, b.nan)


def _unless(mask: Array, narrowed: Interval, before: Interval) -> Interval:
    low, high = np.where(mask, before.low, narrowed.low), np.where(mask, before.high, narrowed.high)
    return Interval(low, high, before.nan)


def _propagate(nodes: Sequence[Node], k: int, a: Interval, R: Mapping[int, Interval]) -> Narrowing:
    """Propagate an interval of node k back through negations, absolute values, squares and sums of squares."""
    node, a = nodes[k], intersection(a, R[k]) if k in R else a
    if node.op == "neg":
        return {k: a} | _propagate(nodes, node.args[0], Interval(-a.high, -a.low, a.nan), R)
    if node.op == "fabs":
        return {k: a} | _propagate(nodes, node.args[0], _of_magnitude(a.low, a, R.get(node.args[0])), R)
    if _is_square(node):
        part = Interval(a.low, _upper_root(a.high), a.nan)
        return {k: a} | _propagate(nodes, node.args[0], _of_magnitude(_lower_root(a.low), part, R.get(node.args[0])), R)
    if _is_sum_of_squares(nodes, k):
        part = Interval(np.zeros_like(a.low), a.high, a.nan)
        return {k: a} | intersect(_propagate(nodes, n, part, R) for n in node.args)
    return {k: a}


def _of_magnitude(least: Array, a: Interval, known: Interval | None) -> Interval:
    """Return u, whose magnitude is `least` to a.high, where the sign that is `known` of it serves."""
    if known is None:
        return Interval(-a.high, a.high, a.nan)
    least = np.maximum(least, 0)
    return Interval(np.where(known.low >= 0, least, -a.high), np.where(known.high <= 0, -least, a.high), a.nan)


def bounds_of_squares(nodes: Sequence[Node], condition: int, scalar: type[np.floating]) -> dict[int, float]:
    """Map each u of a condition u^2 + v^2 + .. <= h with a number h to the bound of |u| where the condition holds."""
    node = nodes[condition]
    if node.op not in ("le", "lt") or nodes[node.args[1]].op != "literal":
        return {}
    at_most = Interval(np.zeros((), scalar), np.asarray(scalar(nodes[node.args[1]].value)), np.zeros((), bool))
    narrowed = _propagate(nodes, node.args[0], at_most, {})
    squared = [nodes[k].args[0] for k in narrowed if _is_square(nodes[k])]
    return {u: float(narrowed[u].high) for u in squared}


def _upper_root(high: Array) -> Array:
    """Return a bound of |u| where the rounded u^2 is at most `high`; it is negative where there is none."""
    above = high.dtype.type(inf)
    root = np.nextafter(np.sqrt(np.nextafter(np.maximum(high, 0), above)), above)
    return np.where(high < 0, -root, root)


def _lower_root(low: Array) -> Array:
    """Return a bound of |u| where the rounded u^2 is at least `low`; 0 where there is none."""
    none = low.dtype.type(0)
    return np.nextafter(np.sqrt(np.nextafter(np.maximum(low, 0), none)), none)


Test = Callable[[Interval, list[Interval]], Mask]  # of an operation's result and arguments (n,)


@dataclass(frozen=True)
class Obligation:
    """A condition that an operation needs: `holds` and `fails` are both certain, otherwise it is undecided.

    `value` must not vanish and, if `signed`, must not change its sign. `watched` are the positions of the arguments on
    which the condition depends.
    """

    need: str
    quantity: str
    watched: tuple[int, ...]
    holds: Test
    fails: Test
    value: Callable[[list[Interval]], Array]
    signed: bool = False
    mend: str = (
        "narrow the ranges of the signals named, limit the argument (fmax, fmin), or write the expression in another "
        "form"
    )


def _middle(a: Interval) -> Array:
    return np.where(a.nan, np.nan, a.low + (a.high - a.low) / 2)


def _division(watched: int) -> Obligation:
    def holds(q: Interval, args: list[Interval]) -> Mask:
        below = args[-1]
        return ~below.zero & ~below.nan & (q.finite | ~args[0].finite)

    def fails(q: Interval, args: list[Interval]) -> Mask:
        below = args[-1]
        zero = (below.low == 0) & (below.high == 0) & ~below.nan
        return zero | (args[0].finite & ((q.low == inf) | (q.high == -inf)))

    need = "its denominator must exclude 0 and leave the quotient finite"
    return Obligation(need, "the denominator", (watched,), holds, fails, lambda args: _middle(args[-1]), True)


def _inside(low: float, high: float, need: str, quantity: str, value: Callable[[Array], Array]) -> Obligation:
    return Obligation(
        need,
        quantity,
        (0,),
        lambda y, args: (args[0].low >= low) & (args[0].high <= high) & ~args[0].nan,
        lambda y, args: (args[0].high < low) | (args[0].low > high),
        lambda args: value(_middle(args[0])),
    )


def _above(low: float, need: str) -> Obligation:
    return Obligation(
        need,
        "the argument",
        (0,),
        lambda y, args: (args[0].low > low) & ~args[0].nan,
        lambda y, args: args[0].high <= low,
        lambda args: _middle(args[0]),
    )


_UNIT = _inside(-1, 1, "its argument must lie in -1 .. 1", "1 - |argument|", lambda x: 1 - np.abs(x))

_OF: dict[str, Obligation] = {
    "div": _division(1),
    "inv": _division(0),
    "floor": _inside(
        0, 2.0**31, "its argument must lie in 0 .. 2^31, because C truncates it in 32 bits", "the argument", lambda x: x
    ),
    "sqrt": _inside(0, inf, "its argument must not be negative", "the argument", lambda x: x),
    "fmod": _division(1),
    "remainder": _division(1),
    "log": _above(0, "its argument must be positive"),
    "log1p": _above(-1, "its argument must be greater than -1"),
    "asin": _UNIT,
    "acos": _UNIT,
    "tan": Obligation(
        "its argument must stay away from the poles",
        "the cosine of the argument",
        (0,),
        lambda y, args: y.finite,
        lambda y, args: np.zeros_like(y.nan),
        lambda args: np.cos(_middle(args[0])),
        True,
    ),
    "atan2": Obligation(
        "its arguments must not both be 0",
        "the arguments' distance from (0, 0)",
        (0, 1),
        lambda y, args: ~(args[0].zero & args[1].zero) & ~args[0].nan & ~args[1].nan,
        lambda y, args: np.logical_and.reduce([(a.low == 0) & (a.high == 0) for a in args]),
        lambda args: np.hypot(_middle(args[0]), _middle(args[1])),
    ),
}


def of(op: str, size: int) -> Obligation | None:
    """Return the obligation of an operation, or None; `size` is the number of values of a table."""
    if op == "table":
        need = f"its index must lie in 0 .. {size - 1}"
        return _inside(
            0, size - 1, need, "the distance of the index from the nearer end", lambda x: np.minimum(x, size - 1 - x)
        )
    return _OF.get(op)


FINITE = Obligation(
    "it must be a finite number",
    "its reciprocal",
    (),
    lambda y, args: y.finite,
    lambda y, args: (y.low == inf) | (y.high == -inf),
    lambda args: 1 / _middle(args[0]),
)


def between(low: float, high: float, unit: str) -> Obligation:
    """Return the obligation that a result itself, in `unit`, lies in low .. high."""

    def holds(y: Interval, args: list[Interval]) -> Mask:
        return (y.low >= low) & (y.high <= high) & ~y.nan

    def fails(y: Interval, args: list[Interval]) -> Mask:
        return (y.low > high) | (y.high < low)

    return Obligation(
        f"it must stay in its declared range {low:.9g} .. {high:.9g} {unit}",
        "it",
        (),
        holds,
        fails,
        lambda sides: _middle(sides[0]),
        mend="limit it in the law, as block.clip(y, signal) does, declare the range that it has, or, only to look at "
        "it on the host, take block.unranged",
    )
