"""Constraint propagation: narrower intervals of values where a condition of the program holds or fails.

    low <= u && u <= high   true:  low <= u <= high, and u is not NaN
                            false: no information that one interval can express
    fabs(u) <= h            true:  -h <= u <= h
    u^2 + v^2 + .. <= h     true:  -sqrt(h) <= u <= sqrt(h), v likewise

Rounding to nearest is monotone, so a sum of numbers that are not negative is not below any of them, and the rounded
square of u is at most h. Then u^2 is below the number after h.

A comparison with NaN is false. Only a comparison that holds therefore implies that its sides are not NaN.
"""

from collections.abc import Iterable, Mapping, Sequence
from math import inf

import numpy as np

from synth.emit.program.lower import Node
from synth.emit.program.operations import LOGICAL
from synth.emit.proof.interval import Array, Interval, hull, intersection

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
        return _propagate(nodes, k, intersection(a, Interval(zero, zero, np.zeros_like(a.nan))))
    if k in whole:
        low, high = np.where(a.low >= 0, np.maximum(a.low, 1), a.low), np.where(a.high <= 0, -1, a.high)
        return _propagate(nodes, k, Interval(low, high, a.nan))
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
        return intersect((_propagate(nodes, i, both), _propagate(nodes, j, both)))
    steps = i in whole and j in whole
    if holds:
        a, b = (Interval(s.low, s.high, np.zeros_like(s.nan)) for s in _narrow_by_order(a, b, node.op == "lt", steps))
    else:
        below, above = _narrow_by_order(b, a, node.op == "le", steps)
        # If the other side is NaN, the comparison fails whatever this side is.
        a, b = _unless(b.nan, above, a), _unless(a.nan, below, b)
    return intersect((_propagate(nodes, i, a), _propagate(nodes, j, b)))


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


def _propagate(nodes: Sequence[Node], k: int, a: Interval) -> Narrowing:
    """Propagate an interval of node k back through negations, absolute values, squares and sums of squares."""
    node = nodes[k]
    if node.op == "neg":
        return {k: a} | _propagate(nodes, node.args[0], Interval(-a.high, -a.low, a.nan))
    if node.op == "fabs":
        return {k: a} | _propagate(nodes, node.args[0], Interval(-a.high, a.high, a.nan))
    if _is_square(node):
        root = _upper_root(a.high)
        return {k: a} | _propagate(nodes, node.args[0], Interval(-root, root, a.nan))
    if _is_sum_of_squares(nodes, k):
        part = Interval(np.zeros_like(a.low), a.high, a.nan)
        return {k: a} | intersect(_propagate(nodes, n, part) for n in node.args)
    return {k: a}


def bounds_of_squares(nodes: Sequence[Node], condition: int, scalar: type[np.floating]) -> dict[int, float]:
    """Map each u of a condition u^2 + v^2 + .. <= h with a number h to the bound of |u| where the condition holds."""
    node = nodes[condition]
    if node.op not in ("le", "lt") or nodes[node.args[1]].op != "literal":
        return {}
    at_most = Interval(np.zeros((), scalar), np.asarray(scalar(nodes[node.args[1]].value)), np.zeros((), bool))
    narrowed = _propagate(nodes, node.args[0], at_most)
    squared = [nodes[k].args[0] for k in narrowed if _is_square(nodes[k])]
    return {u: float(narrowed[u].high) for u in squared}


def _upper_root(high: Array) -> Array:
    """Return a bound of |u| where the rounded u^2 is at most `high`; it is negative where there is none."""
    above = high.dtype.type(inf)
    root = np.nextafter(np.sqrt(np.nextafter(np.maximum(high, 0), above)), above)
    return np.where(high < 0, -root, root)
