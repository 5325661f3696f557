"""Range analysis (value analysis by intervals): bounds of each value of a program, over all states and inputs.

    R_k = [low, high] contains node k as computed in the scalar type, for all x in the declared bounds and all u

Inputs that the Block guards may be any bit pattern. Where a compiler may contract a b + c into one rounding, R_k
contains both results. In the arms of a choice the condition narrows the values that it compares, and values computed
from them.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import reduce
from math import inf

import numpy as np

from synth.block import Block
from synth.emit.c.layout import layout
from synth.emit.lower import Node, Program
from synth.emit.operations import LOGICAL
from synth.emit.proof import conditions, libm
from synth.emit.proof.interval import (
    Interval,
    Mask,
    intersection,
    interval,
    lookup,
    point,
    polynomial,
    truth,
    unrounded,
)
from synth.errors import EmitError

SELECTIONS = frozenset({"choose", "when"})
LOADS = frozenset({"input", "state", "constant"})
_PRODUCTS = frozenset({"mul", "sq", "twice", "polynomial"})
# Operations that pass an unrounded product on to a sum.
_PASSING = frozenset({"neg", "choose", "when", "min", "max", "clamp", "within"})
_KEEPING_WHOLE = frozenset({"neg", "fabs", "add", "sub", "mul", "sq", "twice", "min", "max", "clamp"})
_SMALL = 40  # largest number of nodes of an arm that are recomputed under its condition


@dataclass(frozen=True)
class Range:
    """The values low..high, ends included; `nan`: the value may also be NaN."""

    low: float
    high: float
    nan: bool = False

    @property
    def finite(self) -> bool:
        """Whether every value is a finite number."""
        return self.low > -inf and self.high < inf and not self.nan


@dataclass(frozen=True)
class Arithmetic:
    """How the program is computed: scalar type, error of libm in units in the last place, contraction allowed."""

    scalar: type[np.floating]
    ulps: int = libm.ULPS
    contracted: bool = True


@dataclass(frozen=True, eq=False)
class Structure:
    """A program with properties of its graph.

    Bit j of `ancestors[k]` means that node k is node j or depends on it. `products` may enter a sum unrounded. `whole`
    are the nodes with whole values only. `recomputed` maps (selection, position of an arm) to the nodes that are
    recomputed under the condition; the last one is the arm itself.
    """

    program: Program
    ancestors: tuple[int, ...]
    products: frozenset[int]
    whole: frozenset[int]
    recomputed: Mapping[tuple[int, int], tuple[int, ...]]


def bounds(block: Block, scalar: type[np.floating]) -> dict[str, Range]:
    """Return the range of each input, state and constant; those of inputs and states are rounded as in the layout.

    Raises EmitError for a number that the scalar type cannot represent.
    """
    memory = layout(block, scalar)
    box = {f.name: Range(f.low, f.high) for s in (memory.input, memory.state) for f in s.fields}
    box |= {f.input: Range(-inf, inf, True) for f in block.faults if f.input}
    with np.errstate(over="ignore"):
        constants = {c.name: float(scalar(c.value)) for c in block.constants}
    for name, value in constants.items():
        if not np.isfinite(value):
            raise EmitError(f"constant '{name}' is not finite in {memory.ctype}: scale the expression")
    return box | {name: Range(value, value) for name, value in constants.items()}


def analyse(program: Program, bounds: Mapping[str, Range], scalar: type[np.floating]) -> tuple[Range, ...]:
    """Return the range of each node when computed in `scalar`, rounding to nearest; `bounds` gives that of each load.

    Raises EmitError for an unknown operation or load.
    """
    s = structure(program)
    R = enclose(s, Arithmetic(scalar), loads(program, bounds, scalar), range(len(program.nodes)))
    return tuple(Range(float(R[k].low[0]), float(R[k].high[0]), bool(R[k].nan[0])) for k in range(len(R)))


def loads(program: Program, bounds: Mapping[str, Range], scalar: type[np.floating]) -> dict[int, Interval]:
    """Return the interval of each load of the program."""
    intervals = {}
    for k, node in enumerate(program.nodes):
        if node.op in LOADS:
            if node.name not in bounds:
                raise EmitError(f"the {node.op} '{node.name}' has no range: declare it in the Block")
            r = bounds[node.name]
            intervals[k] = interval(r.low, r.high, r.nan, scalar)
    return intervals


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
    recomputed = {}
    for k, node in enumerate(nodes):
        if node.op in SELECTIONS:
            narrowed = conditions.narrowable_nodes(nodes, node.args[0])
            for position, arm in enumerate(node.args[1:], 1):
                recomputed[k, position] = nodes_between(ancestors, narrowed, (arm,))
    return Structure(program, tuple(ancestors), frozenset(products), frozenset(whole), recomputed)


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


def nodes_between(ancestors: Iterable[int], sources: Iterable[int], ends: Iterable[int]) -> tuple[int, ...]:
    """Return the nodes on the paths from `sources`, which are excluded, to `ends`, in order."""
    ancestors, sources = list(ancestors), set(sources)
    mask, reached = sum(1 << k for k in sources), reduce(int.__or__, (ancestors[k] for k in ends), 0)
    first = min(sources, default=0)
    reached >>= first
    nodes = []
    while reached:  # bit by bit: few of the program's nodes are reached
        k = first + (reached & -reached).bit_length() - 1
        reached &= reached - 1
        if ancestors[k] & mask and k not in sources:
            nodes.append(k)
    return tuple(nodes)


def enclose(
    s: Structure,
    arithmetic: Arithmetic,
    known: Mapping[int, Interval],
    nodes: Iterable[int],
    proved: Mapping[int, Interval] | None = None,
    deep: bool = True,
) -> dict[int, Interval]:
    """Return `known` with the intervals of `nodes`, computed in order from it; loads are not recomputed.

    `proved` intervals narrow those of their nodes. Unless `deep`, arms are not recomputed under their conditions.

    Raises EmitError for an operation without an enclosure.
    """
    R, proved = dict(known), proved or {}
    with np.errstate(all="ignore"):
        for k in nodes:
            node = s.program.nodes[k]
            if node.op not in LOADS:
                a = _select(s, arithmetic, k, R, deep) if node.op in SELECTIONS else _transfer(s, arithmetic, node, R)
                a = Interval(np.ceil(a.low), np.floor(a.high), a.nan) if k in s.whole else a
                R[k] = intersection(a, proved[k]) if k in proved else a
    return R


def _transfer(s: Structure, arithmetic: Arithmetic, node: Node, R: Mapping[int, Interval]) -> Interval:
    if node.op == "literal":
        return point(node.value, arithmetic.scalar)
    if node.op == "bit":  # of a 32-bit word, which the scalar type represents only up to rounding
        low, high = R[node.args[0]].low, unrounded(R[node.args[0]]).high + arithmetic.scalar(node.value)
        return Interval(low, high, R[node.args[0]].nan)
    if node.op == "mul" and node.args[0] == node.args[1]:
        return libm.transfer("sq", [R[node.args[0]]], arithmetic.ulps)
    args = [R[a] for a in node.args]
    if node.op in ("add", "sub") and arithmetic.contracted:
        args = [unrounded(a) if k in s.products else a for k, a in zip(node.args, args, strict=True)]
    if node.op == "table":
        return lookup(s.program.tables[node.name], args[0])
    if node.op == "polynomial":
        return polynomial(s.program.polynomials[node.name].coefficients, args[0], arithmetic.contracted)
    if node.op not in libm.FUNCTIONS and node.op not in libm.EXACT:
        raise EmitError(f"operation '{node.op}' has no enclosure: give it one in the table of its kind")
    return libm.transfer(node.op, args, arithmetic.ulps)


def _select(s: Structure, arithmetic: Arithmetic, k: int, R: Mapping[int, Interval], deep: bool) -> Interval:
    """Return the hull of the arms that can be taken, each under its condition."""
    condition = truth(R[s.program.nodes[k].args[0]])
    (then, never_then), (other, never_other) = (_arm(s, arithmetic, k, position, R, deep) for position in (1, 2))
    may_then, may_other = (condition.high > 0) & ~never_then, (condition.low < 1) & ~never_other
    neither = ~(may_then | may_other)
    may_then, may_other = may_then | neither, may_other | neither
    low = np.minimum(np.where(may_then, then.low, inf), np.where(may_other, other.low, inf))
    high = np.maximum(np.where(may_then, then.high, -inf), np.where(may_other, other.high, -inf))
    return Interval(low, high, (may_then & then.nan) | (may_other & other.nan))


def _arm(
    s: Structure, arithmetic: Arithmetic, k: int, position: int, R: Mapping[int, Interval], deep: bool
) -> tuple[Interval, Mask]:
    """Return the interval of an arm where it is taken, and where it cannot be taken; a gate's other arm is 0."""
    args = s.program.nodes[k].args
    narrowed, infeasible = narrow_under(s, [(args[0], position == 1)], R)
    if position == len(args):
        return point(0, arithmetic.scalar), infeasible
    node, recomputed = args[position], s.recomputed[k, position]
    if node in narrowed:
        return narrowed[node], infeasible
    if deep and 0 < len(recomputed) <= _SMALL:
        inside = enclose(s, arithmetic, {**R, **narrowed}, recomputed, deep=False)
        return intersection(inside[node], R[node]), infeasible
    return R[node], infeasible


def narrow_under(
    s: Structure, decided: Iterable[tuple[int, bool]], R: Mapping[int, Interval]
) -> tuple[dict[int, Interval], Mask]:
    """Return the intervals narrowed by all (condition, holds), and where these contradict each other."""
    p = s.program
    narrowed = conditions.intersect(conditions.narrow(p.nodes, s.whole, c, holds, R) for c, holds in decided)
    infeasible = reduce(np.logical_or, (a.empty for a in narrowed.values()), np.array([False]))
    feasible = {}
    for k, a in narrowed.items():
        empty = a.low > a.high
        feasible[k] = Interval(np.where(empty, R[k].low, a.low), np.where(empty, R[k].high, a.high), a.nan)
    return feasible, infeasible


def require_inductive(program: Program, ranges: tuple[Range, ...], block: Block, scalar: type[np.floating]) -> None:
    """Raise EmitError unless each next state lies in its declared bounds, rounded as in the layout."""
    box = bounds(block, scalar)
    for state in block.states:
        next_range, declared = ranges[program.next[state.name]], box[state.name]
        if next_range.nan or next_range.low < declared.low or next_range.high > declared.high:
            unit = state.signal.unit
            what = " or NaN" if next_range.nan else ""
            raise EmitError(
                f"state '{state.name}' may become {next_range.low:.9g} .. {next_range.high:.9g} {unit}{what}, but its "
                f"declared bounds are {declared.low:.9g} .. {declared.high:.9g} {unit}: limit its next value to them"
            )
