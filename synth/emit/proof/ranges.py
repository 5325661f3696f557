"""Range analysis (value analysis by intervals): bounds of each value of a program, over all states and inputs.

    R_k = [low, high] contains node k as computed in the scalar type, for all x in the declared bounds and all u

Inputs that the Block guards may be any bit pattern. Where a compiler may contract a b + c into one rounding, R_k
contains both results. In the arms of a choice the condition narrows the values that it compares, and values computed
from them.

Type inference: the C type of each node of a program, a truth value, an unsigned integer or the scalar type.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import reduce
from math import inf

import numpy as np

from synth.block import Block
from synth.emit.program.layout import layout
from synth.emit.program.lower import Node, Program
from synth.emit.program.operations import LOGICAL
from synth.emit.proof import conditions, libm
from synth.emit.proof.bisection import LOADS, SELECTIONS, Structure, structure
from synth.emit.proof.conditions import Decided, Narrowing
from synth.emit.proof.interval import (
    Interval,
    Mask,
    dot,
    hull,
    intersection,
    interval,
    lookup,
    point,
    polynomial,
    truth,
    unrounded,
)
from synth.errors import EmitError


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


def enclose(
    s: Structure,
    arithmetic: Arithmetic,
    known: Mapping[int, Interval],
    nodes: Iterable[int],
    proved: Mapping[int, Interval] | None = None,
) -> dict[int, Interval]:
    """Return `known` with the intervals of `nodes`, computed in order from it; loads are not recomputed.

    `proved` intervals narrow those of their nodes. Arms are recomputed under their conditions, but not those in arms.

    Raises EmitError for an operation without an enclosure.
    """
    with np.errstate(all="ignore"):
        return _enclose(s, arithmetic, dict(known), nodes, proved or {})


def _enclose(
    s: Structure,
    arithmetic: Arithmetic,
    R: dict[int, Interval],
    nodes: Iterable[int],
    proved: Mapping[int, Interval],
    outside: "_Arms | None" = None,
) -> dict[int, Interval]:
    """Add the intervals of `nodes` to R and return it; inside an arm, `outside` are the arms of the whole program."""
    changed = reduce(int.__or__, (1 << k for k in (*R, *nodes)), 0) if outside else 0
    arms = _Arms(s, arithmetic, R, outside, changed, {}, {})
    for k in nodes:
        node = s.program.nodes[k]
        if node.op not in LOADS:
            a = _select(arms, k) if node.op in SELECTIONS else _transfer(s, arithmetic, node, R)
            a = Interval(np.ceil(a.low), np.floor(a.high), a.nan) if k in s.whole else a
            R[k] = intersection(a, proved[k]) if k in proved else a
    return R


class _Inside(dict[int, Interval]):
    """Intervals inside an arm, over those outside it."""

    def __init__(self, narrowed: Mapping[int, Interval], outside: Mapping[int, Interval]) -> None:
        super().__init__(narrowed)
        self.outside = outside

    def __missing__(self, k: int) -> Interval:
        return self.outside[k]


@dataclass(frozen=True, eq=False)
class _Arms:
    """The arms of choices in one pass in order over a program, in which no interval of R changes once it is known.

    Choices on one condition, and conditions on another one, therefore share what it narrows: `under` holds it by
    (condition, holds), `narrowed` that of every condition in it. Inside an arm, where only the nodes of the bits
    `changed` are not as `outside`, so do conditions that depend on none of these.
    """

    s: Structure
    arithmetic: Arithmetic
    R: dict[int, Interval]
    outside: "_Arms | None"
    changed: int
    under: dict[Decided, tuple[dict[int, Interval], Mask]]
    narrowed: dict[Decided, Narrowing]

    def narrow_under(self, condition: int, holds: bool) -> tuple[dict[int, Interval], Mask]:
        if self.outside and not self.s.ancestors[condition] & self.changed:
            return self.outside.narrow_under(condition, holds)
        if (condition, holds) not in self.under:
            self.under[condition, holds] = narrow_under(self.s, [(condition, holds)], self.R, self.narrowed)
        return self.under[condition, holds]


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
        nodes = s.program.nodes
        args = [
            _below_square(unrounded(a, _is_positive(nodes[k], R)), nodes[k], R) if k in s.products else a
            for k, a in zip(node.args, args, strict=True)
        ]
    if node.op == "product":  # what it multiplies; each row has its own range
        return reduce(hull, (R[a] for a in node.args))
    if node.op == "row":
        product = s.program.nodes[node.args[0]]
        coefficients = s.program.matrices[product.name].values[int(node.value)]
        return dot(coefficients, [R[a] for a in product.args], arithmetic.contracted)
    if node.op == "table":
        return lookup(s.program.tables[node.name], args[0])
    if node.op == "polynomial":
        return polynomial(s.program.polynomials[node.name].coefficients, args[0], arithmetic.contracted)
    if node.op not in libm.FUNCTIONS and node.op not in libm.EXACT:
        raise EmitError(f"operation '{node.op}' has no enclosure: give it one in the table of its kind")
    return libm.transfer(node.op, args, arithmetic.ulps)


def _below_square(a: Interval, node: Node, R: Mapping[int, Interval]) -> Interval:
    """Return the interval of an exact product, of a square not beyond that of the largest |x|, where this is exact."""
    if not (node.op == "sq" or (node.op == "mul" and node.args[0] == node.args[1])):
        return a
    x = R[node.args[0]]
    largest = np.maximum(np.abs(x.low), np.abs(x.high))
    square, wide = largest * largest, largest.astype(np.float64)
    is_exact = (wide * wide == square) & (wide == wide.astype(np.float32))
    return Interval(a.low, np.where(is_exact, np.minimum(a.high, square), a.high), a.nan)


def _is_positive(node: Node, R: Mapping[int, Interval]) -> Mask | bool:
    """Return where an exact product is not negative: a square, or a product of two numbers of one sign."""
    if node.op == "sq" or (node.op == "mul" and node.args[0] == node.args[1]):
        return True
    if node.op == "twice":
        return R[node.args[0]].low >= 0
    if node.op != "mul":
        return False
    a, b = (R[k] for k in node.args)
    return ((a.low >= 0) & (b.low >= 0)) | ((a.high <= 0) & (b.high <= 0))


def _select(arms: _Arms, k: int) -> Interval:
    """Return the hull of the arms that can be taken, each under its condition."""
    condition = truth(arms.R[arms.s.program.nodes[k].args[0]])
    (then, never_then), (other, never_other) = (_arm(arms, k, position) for position in (1, 2))
    may_then, may_other = (condition.high > 0) & ~never_then, (condition.low < 1) & ~never_other
    neither = ~(may_then | may_other)
    may_then, may_other = may_then | neither, may_other | neither
    low = np.minimum(np.where(may_then, then.low, inf), np.where(may_other, other.low, inf))
    high = np.maximum(np.where(may_then, then.high, -inf), np.where(may_other, other.high, -inf))
    return Interval(low, high, (may_then & then.nan) | (may_other & other.nan))


def _arm(arms: _Arms, k: int, position: int) -> tuple[Interval, Mask]:
    """Return the interval of an arm where it is taken, and where it cannot be taken; a gate's other arm is 0."""
    s, arithmetic, R = arms.s, arms.arithmetic, arms.R
    args = s.program.nodes[k].args
    narrowed, infeasible = arms.narrow_under(args[0], position == 1)
    if position == len(args):
        return point(0, arithmetic.scalar), infeasible
    node, recomputed = args[position], s.recomputed[k, position]
    if node in narrowed:
        return narrowed[node], infeasible
    if not arms.outside and recomputed:
        inside = _enclose(s, arithmetic, _Inside(narrowed, R), recomputed, {}, arms)
        return intersection(inside[node], R[node]), infeasible
    return R[node], infeasible


def narrow_under(
    s: Structure,
    decided: Iterable[Decided],
    R: Mapping[int, Interval],
    known: dict[Decided, Narrowing] | None = None,
) -> tuple[dict[int, Interval], Mask]:
    """Return the intervals narrowed by all (condition, holds), and where these contradict each other.

    `known` holds, and gets, what conditions narrow; it is valid for one R.
    """
    p = s.program
    known = {} if known is None else known
    narrowed = conditions.intersect(conditions.narrow(p.nodes, s.whole, c, holds, R, known) for c, holds in decided)
    infeasible, feasible = np.array([False]), dict(narrowed)
    for k, a in narrowed.items():
        empty = a.low > a.high
        infeasible = infeasible | (empty & ~a.nan)
        if empty.any():
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


def kinds(p: Program) -> list[str]:
    """Return the kind of each node: "logical", "integer", "real", or "number" for a literal of either of the last two.

    A sum of truth values is an integer. A difference of integers may be negative. It is an integer only if integer
    states alone use it.
    """
    kind_of: list[str] = []
    counted = _only_in_counters(p)
    for k, node in enumerate(p.nodes):
        args = [kind_of[a] for a in node.args]
        whole = all(
            k in ("integer", "logical") or (k == "number" and is_whole(p.nodes[a]))
            for a, k in zip(node.args, args, strict=True)
        )
        kind = "real"
        if node.op in LOGICAL:
            kind = "logical"
        elif node.op == "literal":
            kind = "number"
        elif node.op == "accepted":
            kind = "logical"
        elif node.op in ("bit", "guarded") or (node.op == "state" and node.name in p.integers):
            kind = "integer"
        elif node.op in ("argument", "result"):
            kind = p.typed[node.name]
        elif node.op == "choose":
            kind = _kind_of_choice(p, node, args[1:])
        elif whole and (_is_sum(node, args) or (node.op == "sub" and "integer" in args and k in counted)):
            kind = "integer"
        kind_of.append(kind)
    return kind_of


def _is_sum(node: Node, kinds: Sequence[str]) -> bool:
    return node.op == "add" and ("integer" in kinds or "logical" in kinds)


def _only_in_counters(p: Program) -> set[int]:
    """Return the nodes that only integer states use, either directly or as arms of choices."""
    other = {*p.outputs.values(), *(k for name, k in p.next.items() if name not in p.integers)}
    for k in range(len(p.nodes) - 1, -1, -1):
        node = p.nodes[k]
        other.update(node.args[:1] if node.op == "choose" and k not in other else node.args)
    return set(range(len(p.nodes))) - other


def is_whole(node: Node) -> bool:
    return 0 <= node.value < 2**32 and node.value == int(node.value)


def _kind_of_choice(p: Program, node: Node, arms: Sequence[str]) -> str:
    literals = [p.nodes[a] for a, kind in zip(node.args[1:], arms, strict=True) if kind == "number"]
    flags = all(n.value in (0.0, 1.0) for n in literals)
    if set(arms) <= {"logical", "number"} and flags:
        return "logical"
    if "integer" in arms and "real" not in arms and all(is_whole(n) for n in literals):
        return "integer"
    return "real"


def require_whole(program: Program, proved: Sequence[Range]) -> None:
    """Raise EmitError for an unsigned 32-bit integer that may overflow.

    A possibly negative one is used only by an integer state through choices; the proof of that state's range covers it.
    """
    for k, kind in enumerate(kinds(program)):
        if kind == "integer" and not proved[k].high < 2**32:
            raise EmitError(
                f"{conditions.signal(program, k)}: the count {conditions.expression(program, k)} is "
                f"{proved[k].low:.9g} .. {proved[k].high:.9g}, but a uint32_t holds 0 .. 4294967295: limit it"
            )
