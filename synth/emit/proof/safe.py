"""Safety proof of a program: no division by 0, no argument outside a function's domain, every result finite.

For each operation with an obligation D on its arguments r, D(r(x, u)) must hold for all states x in their box and all
inputs u. Interval analysis alone proves most of them. For the others, the argument's cone is cut at leaves, signals
with known ranges, and their box is bisected: in small cells the overestimation by dependent values vanishes. An
operation that is used only in an arm of a choice is checked only where the condition selects that arm.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import inf

import numpy as np

from synth.block import Block
from synth.emit.program.layout import layout
from synth.emit.program.lower import Program
from synth.emit.program.operations import LOGICAL
from synth.emit.proof import bisection, conditions
from synth.emit.proof.bisection import LOADS, SELECTIONS, Structure, nodes_between, structure
from synth.emit.proof.interval import Array, Interval, interval, truth
from synth.emit.proof.ranges import Arithmetic, Range, enclose, narrow_under
from synth.errors import EmitError

_LIMITING = SELECTIONS | {"min", "max", "clamp", "within"}
Guard = tuple[int, bool]  # a condition, and whether it holds where a value is used


@dataclass(frozen=True, eq=False)
class _Claim:
    """An obligation of node k, which depends on the nodes `watched`, wherever the guards hold."""

    k: int
    obligation: conditions.Obligation
    watched: tuple[int, ...]
    guards: frozenset[Guard]


def require_safe(
    program: Program, ranges: tuple[Range, ...], block: Block, scalar: type[np.floating]
) -> tuple[Range, ...]:
    """Return the ranges, narrowed by the proofs; each output and next state is then finite.

    Raises EmitError for an operation whose obligation is not proved, an output or next state that may not be finite, or
    an integer state whose next value is not whole or does not fit 32 bits. The message distinguishes a violation from a
    missing proof, and says where.
    """
    s, arithmetic = structure(program), Arithmetic(scalar)
    first = {k: interval(r.low, r.high, r.nan, scalar) for k, r in enumerate(ranges)}
    R, proved = first, dict[int, Interval]()
    ends = [*program.outputs.values(), *program.next.values()]
    guards = node_guards(program)
    claims = [
        _Claim(k, d, tuple(node.args[i] for i in d.watched), guards[k])
        for k, node in enumerate(program.nodes)
        if (d := conditions.of(node.op, len(program.tables.get(node.name, ()))))
    ]
    claims += [_Claim(k, conditions.FINITE, (k,), frozenset()) for k in dict.fromkeys(ends)]
    for claim in claims:
        if _holds(s, claim, R):
            continue
        intervals, refusal = _search(s, arithmetic, R, proved, replace(claim, guards=frozenset()))
        if intervals is None and claim.guards:
            under_guards, refusal = _search(s, arithmetic, R, proved, claim)
            intervals = None if under_guards is None else {}
        if intervals is None:
            raise EmitError(_refusal(program, claim, block, *refusal))
        if intervals:
            proved |= intervals
            R = enclose(s, arithmetic, first, range(len(program.nodes)), proved)
    _require_counters(s, R, block)
    return tuple(Range(float(a.low[0]), float(a.high[0]), bool(a.nan[0])) for a in (R[k] for k in range(len(R))))


def require_output_ranges(program: Program, ranges: tuple[Range, ...], block: Block, scalar: type[np.floating]) -> None:
    """Raise EmitError, by name, for an output that is not proved to stay in its declared range.

    The range is that of the layout and the manifest, rounded to the scalar type.
    """
    s, arithmetic = structure(program), Arithmetic(scalar)
    R = {k: interval(r.low, r.high, r.nan, scalar) for k, r in enumerate(ranges)}
    for field in layout(block, scalar).output.fields:
        if field.name in program.outputs:
            k = program.outputs[field.name]
            claim = _Claim(k, conditions.between(field.low, field.high, field.unit), (k,), frozenset())
            intervals, refusal = _search(s, arithmetic, R, {}, claim)
            if intervals is None:
                raise EmitError(_refusal(program, claim, block, *refusal))


def _holds(s: Structure, claim: _Claim, R: Mapping[int, Interval]) -> bool:
    with np.errstate(all="ignore"):
        return bool(claim.obligation.holds(R[claim.k], [R[a] for a in s.program.nodes[claim.k].args]).all())


def node_guards(program: Program) -> list[frozenset[Guard]]:
    """Return for each node the conditions under which alone it is used."""
    guards_of: list[frozenset[Guard] | None] = [None] * len(program.nodes)
    for k in program.ends():
        guards_of[k] = frozenset()
    for k in range(len(guards_of) - 1, -1, -1):
        node, inherited = program.nodes[k], guards_of[k] or frozenset()
        for position, a in enumerate(node.args):
            chosen = node.op in SELECTIONS and position > 0
            along = inherited | {(node.args[0], position == 1)} if chosen else inherited
            before = guards_of[a]
            guards_of[a] = along if before is None else before & along
    return [guards or frozenset() for guards in guards_of]


def leaves(s: Structure, R: Mapping[int, Interval], tops: Sequence[int], at_limits: bool) -> tuple[int, ...]:
    """Return where to cut the cone of `tops`: at loads, and at limited values whose operands are unbounded.

    With `at_limits` the cut is close to the tops, at every limited or chosen value: this gives fewer leaves, but treats
    dependent ones as independent.
    """
    nodes, cut, seen = s.program.nodes, set[int](), set[int]()
    waiting = [a for t in tops for a in (nodes[t].args or (t,))] if at_limits else list(tops)
    while waiting:
        k = waiting.pop()
        node = nodes[k]
        if k in seen or (R[k].low[0] == R[k].high[0] and not R[k].nan[0]):
            continue
        seen.add(k)
        bounded = R[k].finite[0]
        limited = node.op in _LIMITING and bounded and (at_limits or not all(R[a].finite[0] for a in node.args))
        if limited or (node.op in LOADS and bounded):
            cut.add(k)
        elif node.op not in LOADS:
            waiting += node.args
    return tuple(sorted(cut))


def _dominator(s: Structure, R: Mapping[int, Interval], tops: Sequence[int]) -> list[tuple[int, ...]]:
    """Return the last bounded node, if any, through which alone the tops depend on loads."""
    nodes = s.program.nodes
    for v in range(min(tops) - 1, -1, -1):
        seen, waiting = {v}, [*tops]
        while waiting and nodes[waiting[-1]].op not in ("input", "state"):
            k = waiting.pop()
            waiting += [a for a in nodes[k].args if a not in seen]
            seen.update(nodes[k].args)
        if not waiting and R[v].finite[0]:
            return [(v,)]
    return []


Refusal = tuple[Mapping[int, Interval], tuple[int, ...], bisection.Verdict]


def _search(
    s: Structure, arithmetic: Arithmetic, R: Mapping[int, Interval], proved: Mapping[int, Interval], claim: _Claim
) -> tuple[dict[int, Interval] | None, Refusal]:
    """Return narrower intervals that prove the claim, None where bisection does not, and then why not."""
    narrowed, infeasible = narrow_under(s, claim.guards, R)
    inside = enclose(s, arithmetic, {**R, **narrowed}, nodes_between(s, narrowed, [claim.k]))
    refusal = inside, tuple[int, ...](), bisection.Verdict(False, 0)
    if infeasible.any() or _holds(s, claim, inside):
        return {}, refusal
    cuts = [leaves(s, inside, claim.watched, at_limits) for at_limits in (True, False)]
    cuts += [leaves(s, R, [*claim.watched, *(c for c, _ in claim.guards)], False)]  # this one decides the guards
    for cut in dict.fromkeys([*filter(None, cuts[:2]), *_dominator(s, inside, claim.watched), *filter(None, cuts[2:])]):
        low, high = (np.array([getattr(inside[k], side)[0] for k in cut]) for side in ("low", "high"))
        whole = np.array([k in s.whole for k in cut])
        judge = _judge(s, arithmetic, inside, proved, claim, cut)
        verdict = bisection.prove(low, high, whole, judge, claim.obligation.signed)
        if verdict.proved:
            return {k: a for k, a in verdict.hull.items() if not a.empty[0]}, refusal
        if cut in cuts:
            refusal = inside, cut, verdict
    return None, refusal


def _judge(
    s: Structure,
    arithmetic: Arithmetic,
    R: Mapping[int, Interval],
    proved: Mapping[int, Interval],
    claim: _Claim,
    cut: tuple[int, ...],
) -> bisection.Judge:
    """Return the function that judges cells of the leaves `cut`."""
    args, obligation = s.program.nodes[claim.k].args, claim.obligation
    ends = [*claim.watched, *(c for c, _ in claim.guards)]
    cone = nodes_between(s, cut, ends)
    cone = cone if claim.k in cone or claim.k in cut else (*cone, claim.k)
    pointwise = replace(arithmetic, ulps=0, contracted=False)

    def judge(low: Array, high: Array, exact: bool) -> bisection.Judgement:
        mode, n = pointwise if exact else arithmetic, low.shape[1]
        cells = {k: Interval(low[i], high[i], np.zeros(n, bool)) for i, k in enumerate(cut)}
        inside = enclose(s, mode, {**R, **cells}, cone, None if exact else proved)
        narrowed, infeasible = narrow_under(s, claim.guards, inside)
        for c, side in claim.guards if exact else ():  # a point where a guard is undecided is no counterexample
            is_decided = (truth(inside[c]).low == side) & (truth(inside[c]).high == side)
            infeasible = infeasible | ~is_decided | (c not in cone and c not in cut)
        if narrowed:
            inside = enclose(s, mode, {**inside, **narrowed}, nodes_between(s, narrowed, [claim.k]))
        with np.errstate(all="ignore"):
            result, sides = inside[claim.k], [inside[a] for a in args]
            holds, fails = obligation.holds(result, sides) | infeasible, obligation.fails(result, sides) & ~infeasible
            value = np.where(infeasible, np.nan, obligation.value(sides if obligation.watched else [result]))
        watched = {
            k: Interval(np.where(infeasible, inf, a.low), np.where(infeasible, -inf, a.high), a.nan)
            for k, a in ((k, inside[k]) for k in (*claim.watched, claim.k))
        }
        holds, fails, value = (np.broadcast_to(v, (n,)) for v in (holds, fails, value))
        return bisection.Judgement(holds, fails, value, watched)

    return judge


def _refusal(
    program: Program,
    claim: _Claim,
    block: Block,
    R: Mapping[int, Interval],
    cut: tuple[int, ...],
    verdict: bisection.Verdict,
) -> str:
    watched = ", ".join(f"`{conditions.expression(program, k)}`" for k in claim.watched)
    if not claim.obligation.watched:
        what = f"{_end(program, claim.k)} = {watched} of block '{block.name}'"
        origin = _origin(program, R, claim.k) if claim.obligation is conditions.FINITE else claim.k
        origin_text = "" if origin == claim.k else f"; it begins at `{conditions.expression(program, origin)}`"
    else:
        op = program.nodes[claim.k].op
        name = "division by" if op in ("div", "inv") else f"{op} of"
        what, origin_text = f"the {name} {watched} in {conditions.signal(program, claim.k)}", ""
    point = conditions.values(block, program, cut, verdict.point, verdict.point) if len(verdict.point) else ""
    cell = conditions.values(block, program, cut, verdict.low, verdict.high) if len(verdict.low) else ""
    if not cut:
        where = "its operands are unbounded"
    elif verdict.fails:
        where = f"violated: {claim.obligation.quantity} is {verdict.value:.6g} at {point}"
    elif verdict.crosses:
        where = (
            f"violated: {claim.obligation.quantity} passes through 0 beside {point}, where it is {verdict.value:.6g}"
        )
    else:
        where = (
            f"not proved in {verdict.cells} cells: {claim.obligation.quantity} is {verdict.value:.6g} at the worst "
            f"point {point}, in the cell {cell}"
        )
    return f"{what} is not safe: {claim.obligation.need}; {where}{origin_text}; {claim.obligation.mend}"


def _end(program: Program, k: int) -> str:
    names = [f"output '{n}'" for n, at in program.outputs.items() if at == k]
    names += [f"next state '{n}'" for n, at in program.next.items() if at == k]
    return names[0]


def _origin(program: Program, R: Mapping[int, Interval], k: int) -> int:
    """Return the first node in the computation of k that may not be finite."""
    for a in program.nodes[k].args:
        if not R[a].finite[0]:
            return _origin(program, R, a)
    return k


def _require_counters(s: Structure, R: Mapping[int, Interval], block: Block) -> None:
    for state in block.states:
        k = s.program.next[state.name]
        if not state.integer or s.program.nodes[k].op in LOGICAL:
            continue
        if k not in s.whole or R[k].low[0] < 0 or R[k].high[0] >= 2.0**32:
            not_whole = "" if k in s.whole else ", not always whole"
            range_text = f"{R[k].low[0]:.9g} .. {R[k].high[0]:.9g}{not_whole}"
            raise EmitError(
                f"integer state '{state.name}' may become {range_text}: C holds it in 32 bits without sign, so limit "
                "it to 0 .. 4294967295 and compute it from whole numbers alone"
            )
