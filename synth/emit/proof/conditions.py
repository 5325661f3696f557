"""Conditions: what is known about values where a condition of the program holds, or fails.

    low <= u && u <= high   true:  low <= u <= high, and u is a number
                            false: nothing about u that one interval can say
    fabs(u) <= h            true:  -h <= u <= h

A comparison with no number is false, so that only a comparison that holds says that its sides are numbers.
"""

from collections.abc import Iterable, Mapping, Sequence
from math import inf

import numpy as np

from synth.emit.lower import LOGICAL, Node
from synth.emit.proof.interval import Array, Interval, either, meet

Known = dict[int, Interval]


def compared(nodes: Sequence[Node], condition: int) -> frozenset[int]:
    """Return the nodes of which `known` may say something."""
    node = nodes[condition]
    if node.op in ("and", "or", "not"):
        return frozenset({condition}).union(*(compared(nodes, a) for a in node.args))
    if node.op in LOGICAL:
        return frozenset({condition}).union(*(_chain(nodes, a) for a in node.args))
    return _chain(nodes, condition)


def _chain(nodes: Sequence[Node], k: int) -> frozenset[int]:
    """Return a node and what is reached through signs and absolute values."""
    return frozenset({k}) | (_chain(nodes, nodes[k].args[0]) if nodes[k].op in ("neg", "fabs") else frozenset())


def known(
    nodes: Sequence[Node], whole: frozenset[int], condition: int, holds: bool, R: Mapping[int, Interval]
) -> Known:
    """Return narrower intervals of nodes where the condition holds, or fails; R maps each node to its interval.

    `whole` are the nodes whose values are whole numbers. Where an interval is empty the condition cannot be so.
    """
    node = nodes[condition]
    if node.op == "not":
        narrowed = known(nodes, whole, node.args[0], not holds, R)
    elif node.op in ("and", "or"):
        first, second = (known(nodes, whole, a, holds, R) for a in node.args)
        narrowed = merged((first, second)) if (node.op == "and") == holds else _hulls(first, second)
    elif node.op in LOGICAL:
        narrowed = _comparison(nodes, whole, node, holds, R)
    else:
        narrowed = _flag(nodes, whole, condition, holds, R)
    if node.op in LOGICAL:
        side = np.full_like(R[condition].low, holds)
        narrowed[condition] = meet(R[condition], Interval(side, side, np.zeros_like(R[condition].nan)))
    return narrowed


def merged(parts: Iterable[Known]) -> Known:
    """Return what is known where all parts are."""
    narrowed: Known = {}
    for part in parts:
        for k, a in part.items():
            narrowed[k] = meet(narrowed[k], a) if k in narrowed else a
    return narrowed


def _hulls(first: Known, second: Known) -> Known:
    return {k: either(first[k], second[k]) for k in first.keys() & second.keys()}


def _flag(nodes: Sequence[Node], whole: frozenset[int], k: int, holds: bool, R: Mapping[int, Interval]) -> Known:
    """Return what is known of a number that stands as a condition: it is 0 or not."""
    a = R[k]
    if not holds:
        zero = np.zeros_like(a.low)
        return _through(nodes, k, meet(a, Interval(zero, zero, np.zeros_like(a.nan))))
    if k in whole:
        low, high = np.where(a.low >= 0, np.maximum(a.low, 1), a.low), np.where(a.high <= 0, -1, a.high)
        return _through(nodes, k, Interval(low, high, a.nan))
    return {}


def _comparison(
    nodes: Sequence[Node], whole: frozenset[int], node: Node, holds: bool, R: Mapping[int, Interval]
) -> Known:
    (i, j), (a, b) = node.args, (R[k] for k in node.args)
    if node.op in ("eq", "ne"):
        if (node.op == "eq") != holds:
            return {}
        both = meet(a, b)
        both = Interval(both.low, both.high, np.zeros_like(both.nan))
        return merged((_through(nodes, i, both), _through(nodes, j, both)))
    steps = i in whole and j in whole
    if holds:
        a, b = (Interval(s.low, s.high, np.zeros_like(s.nan)) for s in _ordered(a, b, node.op == "lt", steps))
    else:
        below, above = _ordered(b, a, node.op == "le", steps)
        # Where the other side is no number, the comparison fails whatever this side is.
        a, b = _unless(b.nan, above, a), _unless(a.nan, below, b)
    return merged((_through(nodes, i, a), _through(nodes, j, b)))


def _ordered(a: Interval, b: Interval, strictly: bool, steps: bool) -> tuple[Interval, Interval]:
    """Narrow a and b by a <= b, or a < b; in `steps` both are whole."""
    low, high = a.low, b.high
    if strictly:
        bound = low.dtype.type(inf)
        low, high = (low + 1, high - 1) if steps else (np.nextafter(low, bound), np.nextafter(high, -bound))
    return Interval(a.low, np.minimum(a.high, high), a.nan), Interval(np.maximum(b.low, low), b.high, b.nan)


def _unless(mask: Array, narrowed: Interval, before: Interval) -> Interval:
    low, high = np.where(mask, before.low, narrowed.low), np.where(mask, before.high, narrowed.high)
    return Interval(low, high, before.nan)


def _through(nodes: Sequence[Node], k: int, a: Interval) -> Known:
    """Return what an interval of node k says of k and of what k is the negative or the absolute value of."""
    op = nodes[k].op
    if op == "neg":
        return {k: a} | _through(nodes, nodes[k].args[0], Interval(-a.high, -a.low, a.nan))
    if op == "fabs":
        return {k: a} | _through(nodes, nodes[k].args[0], Interval(-a.high, a.high, a.nan))
    return {k: a}
