"""Branch and bound: proves a claim on every point of a box by bisection into cells on each of which it holds.

    box = low..high (d,) -> cells -> the claim holds on a cell, or the cell is halved along its most influential side

Meanwhile the centre of every open cell is evaluated. The search ends at a point where the claim fails, or at two points
between which the quantity that must not vanish passes through 0. A jump over 0 is none.

Properties of a program that the proofs need: what depends on what, what is whole, what may stay unrounded.
"""

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import reduce
from itertools import product
from math import inf

import numpy as np

from synth.emit.program.lower import Node, Program
from synth.emit.program.operations import LOGICAL
from synth.emit.proof import conditions
from synth.emit.proof.interval import Array, Interval, Mask

SELECTIONS = frozenset({"choose", "when"})
LOADS = frozenset({"input", "state", "constant"})
_PRODUCTS = frozenset({"mul", "sq", "twice", "polynomial"})
# Operations that pass an unrounded product on to a sum.
_PASSING = frozenset({"neg", "choose", "when", "min", "max", "clamp", "within"})
_KEEPING_WHOLE = frozenset({"neg", "fabs", "add", "sub", "mul", "sq", "twice", "min", "max", "clamp"})
_SMALL = 40  # largest number of nodes of an arm that are recomputed under its condition


@dataclass(frozen=True, eq=False)
class Structure:
    """A program with properties of its graph.

    Bit j of `ancestors[k]`, and bit k of `descendants[j]`, means that node k is node j or depends on it. `products` may
    enter a sum unrounded. `whole` are the nodes with whole values only. `recomputed` maps (selection, position of an
    arm) to the nodes that are recomputed under the condition, none where they are many; the last is the arm itself.
    """

    program: Program
    ancestors: tuple[int, ...]
    descendants: tuple[int, ...]
    products: frozenset[int]
    whole: frozenset[int]
    recomputed: Mapping[tuple[int, int], tuple[int, ...]]


def structure(program: Program) -> Structure:
    """Return the properties of a program's graph that the analysis needs."""
    nodes = program.nodes
    ancestors: list[int] = []
    products: set[int] = set()
    whole: set[int] = set()
    for k, node in enumerate(nodes):
        ancestors.append(reduce(int.__or__, (ancestors[a] for a in node.args), 1 << k))
        if _may_stay_unrounded(nodes, node) or (node.op in _PASSING and not products.isdisjoint(node.args)):
            products.add(k)
        if _is_whole(program, node, whole):
            whole.add(k)
    descendants = [1 << k for k in range(len(nodes))]
    for k in range(len(nodes) - 1, -1, -1):
        for a in nodes[k].args:
            descendants[a] |= descendants[k]
    s = Structure(program, tuple(ancestors), tuple(descendants), frozenset(products), frozenset(whole), {})
    recomputed: dict[tuple[int, int], tuple[int, ...]] = {}
    for k, node in enumerate(nodes):
        if node.op in SELECTIONS:
            narrowed = conditions.narrowable_nodes(nodes, node.args[0])
            for position, arm in enumerate(node.args[1:], 1):
                between = _between(s, narrowed, (arm,))
                recomputed[k, position] = _places(between) if between.bit_count() <= _SMALL else ()
    return replace(s, recomputed=recomputed)


def _may_stay_unrounded(nodes: Sequence[Node], node: Node) -> bool:
    """Return whether a compiler may leave a value unrounded inside a sum; a division may become a multiplication."""
    return node.op in _PRODUCTS or (node.op == "div" and nodes[node.args[1]].op in ("literal", "constant"))


def _is_whole(program: Program, node: Node, whole: set[int]) -> bool:
    """Return whether a value is whole, as are floating-point sums and products of whole numbers, and floors."""
    if node.op == "literal":
        return float(node.value).is_integer()
    if node.op in SELECTIONS:
        return whole.issuperset(node.args[1:])
    preserved = node.op in LOGICAL or node.op == "floor" or (node.op in _KEEPING_WHOLE and whole.issuperset(node.args))
    return preserved or (node.op == "state" and node.name in program.integers)


def nodes_between(s: Structure, sources: Collection[int], ends: Iterable[int]) -> tuple[int, ...]:
    """Return the nodes on the paths from `sources`, which are excluded, to `ends`, in order."""
    return _places(_between(s, sources, ends))


def _between(s: Structure, sources: Collection[int], ends: Iterable[int]) -> int:
    """Return the nodes between `sources` and `ends` as bits."""
    reached = reduce(int.__or__, (s.ancestors[k] for k in ends), 0)
    depending = reduce(int.__or__, (s.descendants[k] for k in sources), 0)
    return reached & depending & ~reduce(int.__or__, (1 << k for k in sources), 0)


def _places(bits: int) -> tuple[int, ...]:
    """Return the places of the bits that are set, in order."""
    octets = np.frombuffer(bits.to_bytes(bits.bit_length() // 8 + 1, "little"), np.uint8)
    return tuple(np.flatnonzero(np.unpackbits(octets, bitorder="little")).tolist())


BUDGET = 20_000
_CORNERS = 8  # largest dimension for which all corners are evaluated
_SECTIONS = 64
_JUMPS = 4  # changes of sign that are jumps, after which no further one is sought
_STEEP = 16  # times the median of the steps near a change of sign: a larger one is a jump


@dataclass(frozen=True, eq=False)
class Judgement:
    """Evaluation of n cells: whether the claim holds, or fails, on the whole cell; `value` (n,) must not vanish.

    `watched` are intervals (n,) by node; they are empty on infeasible cells.
    """

    holds: Mask
    fails: Mask
    value: Array
    watched: dict[int, Interval]


# Arguments: cells low (d, n), high (d, n), and whether they are points to compute as C does, without enclosure.
Judge = Callable[[Array, Array, bool], Judgement]


@dataclass(frozen=True, eq=False)
class Verdict:
    """Whether the claim is proved, with the hull of the watched intervals; else the worst cell and a point (d,) in it.

    `fails`: the claim fails at the point. `crosses`: the quantity passes through 0 beside it, between two numbers.
    """

    proved: bool
    cells: int
    hull: dict[int, Interval] = field(default_factory=dict)
    fails: bool = False
    crosses: bool = False
    low: Array = field(default_factory=lambda: np.zeros(0))
    high: Array = field(default_factory=lambda: np.zeros(0))
    point: Array = field(default_factory=lambda: np.zeros(0))
    value: float = inf


def prove(low: Array, high: Array, whole: Mask, judge: Judge, signed: bool, budget: int = BUDGET) -> Verdict:
    """Prove a claim on the box low..high (d,) of the scalar type, or find where it fails.

    `whole` (d,) marks coordinates with whole values only. `signed`: the value may have either sign but not both.
    """
    weight = _weights(low, high, judge)
    low, high = low[:, None], high[:, None]
    points = _corners(low, high, whole)
    cells, jumps, hulls, signs = 0, 0, list[dict[int, Interval]](), dict[bool, Array]()
    while True:
        judgement = judge(low, high, False)
        cells += low.shape[1]
        hulls.append({k: _hull(a, judgement.holds) for k, a in judgement.watched.items()})
        if judgement.holds.all():
            return Verdict(True, cells, {k: _join([h[k] for h in hulls]) for k in hulls[0]})
        low, high = low[:, ~judgement.holds], high[:, ~judgement.holds]
        points = np.hstack([points, _middle(low, high, whole)])
        at_points = judge(points, points, True)
        worst = _worst(at_points, points, low, high, cells)
        if worst.fails:
            return worst
        signs |= {side: points[:, mask.argmax()] for side, mask in _sides(at_points) if mask.any()}
        if signed and len(signs) == 2 and jumps < _JUMPS:
            jumps += 1
            if crossing := _crossing(signs, judge, whole):
                point, value = crossing
                return Verdict(False, cells, {}, value == 0, value != 0, point, point, point, value)
        open_ = (high > low).any(axis=0)
        if not open_.all() or cells + 2 * low.shape[1] > budget:
            return worst
        low, high = _halve(low, high, whole, weight)
        points = np.zeros((len(low), 0), low.dtype)


def _sides(at_points: Judgement) -> list[tuple[bool, Mask]]:
    return [(True, at_points.value > 0), (False, at_points.value < 0)]


def _middle(low: Array, high: Array, whole: Mask) -> Array:
    middle = low + (high - low) / 2
    return np.where(whole[:, None], np.floor(middle), middle)


def _corners(low: Array, high: Array, whole: Mask) -> Array:
    if len(low) > _CORNERS:
        return np.hstack([low, high])
    return np.array(list(product(*zip(low[:, 0], high[:, 0], strict=True))), low.dtype).T


def _weights(low: Array, high: Array, judge: Judge) -> Array:
    """Return (d,) the variation of the watched intervals along each side alone, per length: bisection priorities."""
    middle = low + (high - low) / 2
    free = np.eye(len(low), dtype=bool)
    judgement = judge(np.where(free, low, middle).T, np.where(free, high, middle).T, False)
    spread = [a.high.astype(np.float64) - a.low for a in judgement.watched.values()]
    weight = np.max([np.where(np.isfinite(s), s, 0) for s in spread], axis=0) * np.ones(len(low))
    # Every side has a minimum weight, so that each is halved eventually.
    weight = weight / weight.max() + 1e-3 if weight.max() > 0 else np.ones(len(low))
    return weight / np.maximum((high - low).astype(np.float64), np.finfo(low.dtype).tiny)


def _halve(low: Array, high: Array, whole: Mask, weight: Array) -> tuple[Array, Array]:
    side = (weight[:, None] * (high - low).astype(np.float64)).argmax(axis=0)
    at = (side, np.arange(low.shape[1]))
    middle = _middle(low, high, whole)[at]
    upper, lower = low.copy(), high.copy()
    # No number of the scalar type lies between neighbours: each of them becomes a cell.
    adjacent = (middle <= low[at]) | (middle >= high[at])
    lower[at] = np.where(adjacent, low[at], middle)
    upper[at] = np.where(adjacent, high[at], np.where(whole[side], middle + 1, middle))
    return np.hstack([low, upper]), np.hstack([lower, high])


def _hull(a: Interval, mask: Mask) -> Interval:
    low, high = np.where(mask, a.low, inf), np.where(mask, a.high, -inf)
    return Interval(low.min(keepdims=True), high.max(keepdims=True), np.array([(a.nan & mask).any()]))


def _join(parts: list[Interval]) -> Interval:
    low, high = np.minimum.reduce([p.low for p in parts]), np.maximum.reduce([p.high for p in parts])
    return Interval(low, high, np.logical_or.reduce([p.nan for p in parts]))


def _worst(at_points: Judgement, points: Array, low: Array, high: Array, cells: int) -> Verdict:
    """Return the failing point of the smallest value; else the open cell whose value at its centre is closest to 0."""
    if at_points.fails.any():
        k = int(np.where(at_points.fails, at_points.value, inf).argmin())
        at = points[:, k]
        return Verdict(False, cells, {}, True, False, at, at, at, float(at_points.value[k]))
    value = at_points.value[-low.shape[1] :]
    k = int(np.where(np.isnan(value), inf, np.abs(value)).argmin())
    return Verdict(False, cells, {}, False, False, low[:, k], high[:, k], points[:, k - low.shape[1]], float(value[k]))


def _crossing(signs: dict[bool, Array], judge: Judge, whole: Mask) -> tuple[Array, float] | None:
    """Return a point between two points beside which the value passes through 0, and its value; None if it jumps."""
    ends = [signs[False].astype(np.float64), signs[True].astype(np.float64)]
    span, first, last, is_jump = ends[1] - ends[0], 0.0, 1.0, True
    while True:
        t = np.linspace(first, last, _SECTIONS)
        points = (ends[0][:, None] + span[:, None] * t).astype(signs[True].dtype)
        points = np.where(whole[:, None], np.floor(points), points)
        value = judge(points, points, True).value
        k = int(np.abs(value).argmin())
        change = int((value >= 0).argmax())
        if change == 0 or np.isnan(value).any():
            return None
        bracket = (t[change - 1], t[change])
        if value[k] == 0 or not bracket[1] - bracket[0] < last - first or bracket[1] - bracket[0] < 1e-17:
            return None if is_jump and value[k] != 0 else (points[:, k], float(value[k]))
        if len(np.unique(points, axis=1).T) == _SECTIONS:
            steps = np.abs(np.diff(value))
            is_jump = bool(steps[change - 1] > _STEEP * np.median(steps))
        first, last = bracket
