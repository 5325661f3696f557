"""Input guards: the range test, the hold and the fault bit of an input become one call of a function.

    guard       the accepted value of an input: the input where low <= input <= high, else the fallback, whose state
                then keeps its value, and the input's bit is set in the fault word
    guarded     the fault word after a guard
    accepted    whether none of the fault word's bits in a mask is set

A guard reads (input, fallback, low, high, word) or, for the range -high .. high, (input, fallback, high, word). Its
`value` is the mask of the bit. The fault word is one variable, in which bits are only set, so `accepted` may read a
later word than the one that it names.

Rate limits: max(min(target, last + step), last - step) becomes one node `slew` of (last, target, step).

Elimination of limits that never act, as proved by range analysis or by a certificate of the author.

A value that several arms use, q = 1 / x in (a ? q : 0) + (b ? 2 q : 0), is computed where one of them is: a || b.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import reduce

import numpy as np

from synth.emit.passes import fold
from synth.emit.passes.surrogates import Surrogate
from synth.emit.program.lower import Node, Program
from synth.emit.program.operations import LIBM
from synth.emit.proof import conditions, ranges
from synth.emit.proof.bisection import SELECTIONS, structure
from synth.emit.proof.safe import Guard

MOST_USES = 8  # arms of which a shared value knows the conditions


def slewed(p: Program) -> Program:
    """Return the program with a node for each rate limit whose two sums have no other user."""
    users = p.users()
    nodes = list(p.nodes)
    for k, node in enumerate(p.nodes):
        args = _slew(p, users, k) if node.op == "max" else None
        if args is not None:
            nodes[k] = replace(node, op="slew", args=args)
    return p.with_nodes(tuple(nodes), range(len(nodes)))


def _slew(p: Program, users: list[list[int]], k: int) -> tuple[int, int, int] | None:
    """Return the last value, the target and the step of a rate limit, None for another node."""
    upper, lower = p.nodes[k].args
    if p.nodes[upper].op != "min" or p.nodes[lower].op != "sub":
        return None
    target, raised = p.nodes[upper].args
    last, step = p.nodes[lower].args
    sums_up = p.nodes[raised].op == "add" and p.nodes[raised].args == (last, step)
    alone = all(len(users[n]) == 1 and n not in p.ends() for n in (upper, lower, raised))
    return (last, target, step) if sums_up and alone else None


def without_idle(program: Program, bounds: Mapping[str, ranges.Range], scalar: type[np.floating]) -> Program:
    """Return the program without the limits that its ranges prove idle."""
    while idle := find_redundant(program, ranges.analyse(program, bounds, scalar)):
        program = fold.folded(program.substituted(idle))
    return program


def without_certified_limits(program: Program, surrogates: Sequence[Surrogate], scalar: type[np.floating]) -> Program:
    """Return the program with `within` (an assertion) in place of the limits that a certificate proves idle.

    A certificate needs the errors of all functions. It applies only if polynomials have replaced libm, whose errors are
    unknown.
    """
    known = not any(node.op in LIBM - {"sqrt", "fabs"} for node in program.nodes)
    error = max((s.polynomial.max_relative_error for s in surrogates), default=0.0) if known else np.inf
    nodes = list(program.nodes)
    for named, k in program.marks:
        if named.certificate is None or nodes[k].op != "clamp":
            continue
        high = float(scalar(nodes[nodes[k].args[2]].value))
        if named.certificate(float(np.finfo(scalar).eps) / 2, error) <= high:
            nodes[k] = replace(nodes[k], op="within")
    return replace(program, nodes=tuple(nodes))


def find_redundant(program: Program, proved: tuple[ranges.Range, ...]) -> dict[int, int]:
    """Map each min, max, clamp or choice that always equals one of its arguments to that argument.

    Chains of redundant nodes are followed to their end. (a < b) ? a : b is b if either is NaN, and it is the second of
    two zeros of different sign; a tie at 0 therefore never selects the first argument.
    """
    equal: dict[int, int] = {}
    for k in range(len(program.nodes)):
        same = _same(program, k, proved)
        if same is not None:
            equal[k] = equal.get(same, same)
    return equal


def _same(program: Program, k: int, proved: tuple[ranges.Range, ...]) -> int | None:
    node = program.nodes[k]
    if node.op in ("min", "max"):
        return _extreme(node.args, [proved[a] for a in node.args], node.op == "min")
    if node.op == "clamp":
        x, low, high = (proved[a] for a in node.args)
        inside = low.high <= x.low and x.high <= high.low and not (x.nan or low.nan or high.nan)
        return node.args[0] if inside else None
    if node.op in SELECTIONS:
        c = proved[node.args[0]]
        if not c.nan and (c.low > 0 or c.high < 0):
            return node.args[1]
        if not c.nan and c.low == c.high == 0:
            zeros = (z for z, n in enumerate(program.nodes[:k]) if n.op == "literal" and str(n.value) == "0.0")
            return node.args[2] if node.op == "choose" else next(zeros, None)
    return None


def _extreme(args: tuple[int, ...], sides: list[ranges.Range], least: bool) -> int | None:
    a, b = sides if least else [ranges.Range(-r.high, -r.low, r.nan) for r in sides]
    if b.high <= a.low:
        return args[1]
    return args[0] if not (a.nan or b.nan) and _below(a, b) else None


def _below(a: ranges.Range, b: ranges.Range) -> bool:
    return a.high < b.low or a.high == b.low != 0


def with_shared_guards(p: Program) -> Program:
    """Return the program with a choice for each operation with an obligation that arms without a common guard use."""
    ancestors, uses = structure(p).ancestors, _uses(p)
    guards = {
        k: uses[k]
        for k, node in enumerate(p.nodes)
        if conditions.of(node.op, 1) and len(uses[k]) > 1 and not frozenset.intersection(*uses[k])
        if not any(ancestors[c] >> k & 1 for use in uses[k] for c, _ in use)
    }
    f, index, waiting = fold.Folder(), dict[int, int](), [*range(len(p.nodes))][::-1]
    while waiting:
        k = waiting[-1]
        needs = [*p.nodes[k].args, *sorted(c for use in guards.get(k, ()) for c, _ in use)]
        if missing := [a for a in needs if a not in index]:
            waiting += missing
            continue
        waiting.pop()
        index[k] = index.get(k, f.place(p.nodes[k].renumbered(index)))
        if k in guards and f.nodes[index[k]].op != "choose":
            holds = {
                (c, side): index[c] if side else f.make(Node("not", (index[c],))) for u in guards[k] for c, side in u
            }
            sides = sorted(
                reduce(lambda a, b: f.make(Node("and", (a, b))), [holds[g] for g in sorted(use)]) for use in guards[k]
            )
            condition = reduce(lambda a, b: f.make(Node("or", (a, b))), sides)
            index[k] = f.place(Node("choose", (condition, index[k], f.literal(0.0))))
    return p.with_nodes(tuple(f.nodes), [index[k] for k in range(len(p.nodes))])


def _uses(p: Program) -> list[set[frozenset[Guard]]]:
    """Return for each node the sets of conditions under each of which it is used, none of which contains another."""
    uses: list[set[frozenset[Guard]]] = [set() for _ in p.nodes]
    for k in p.ends():
        uses[k] = {frozenset()}
    for k in range(len(p.nodes) - 1, -1, -1):
        node = p.nodes[k]
        for position, a in enumerate(node.args):
            chosen = {(node.args[0], position == 1)} if node.op in SELECTIONS and position > 0 else set[Guard]()
            all_uses = uses[a] | {use | chosen for use in uses[k]}
            uses[a] = {use for use in all_uses if not any(other < use for other in all_uses)}
            uses[a] = uses[a] if len(uses[a]) <= MOST_USES else {frozenset.intersection(*uses[a])}
    return uses


@dataclass(frozen=True)
class Check:
    """One input's guard: the nodes of its range test, of its input, fallback and bounds, of its value and its word."""

    test: int
    loads: tuple[int, ...]
    bit: float
    held: int
    word: int
    state: str


def guard_function(node: Node) -> str:
    """Return the name of the C function of a guard, without the program's prefix."""
    return ("hold" if node.name else "replace") + ("" if len(node.args) == 5 else "_within")


def guarded(p: Program) -> Program:
    """Return the program with a guard for each input whose refusal sets a bit of the fault word."""
    checks = list(_checks(p))
    return _Rewriter(p, checks).program() if checks else p


def _checks(p: Program) -> Iterator[Check]:
    """Yield the checks in the order of their bits, up to the first bit that has another form."""
    users, word = p.users(), -1
    for k, node in enumerate(p.nodes):
        if node.op != "bit":
            continue
        before = node.args[0]
        choice = next((u for u in users[k] if p.nodes[u].args[1:] == (before, k)), None)
        is_next = before == word or (word < 0 and p.nodes[before] == Node("literal"))
        check = _check(p, users, choice, node.value) if choice is not None and is_next else None
        if check is None:
            return
        word = check.word
        yield check


def _check(p: Program, users: list[list[int]], word: int, bit: float) -> Check | None:
    test = p.nodes[word].args[0]
    loads = _range_test(p, test)
    if loads is None:
        return None
    source, *bounds = loads
    held = [u for u in users[source] if p.nodes[u].op == "choose" and p.nodes[u].args[:2] == (test, source)]
    stored = [state for state, k in p.next.items() if k in held]
    if len(held) != 1:
        return None
    fallback = p.nodes[held[0]].args[2]
    node = p.nodes[fallback]
    kept = node.op == "state" and node.name in stored and users[fallback] == held
    if not kept and (node.op not in ("constant", "literal") or stored):
        return None
    return Check(test, (source, fallback, *bounds), bit, held[0], word, node.name if kept else "")


def _range_test(p: Program, k: int) -> list[int] | None:
    """Return the input and the bounds of low <= input <= high or |input| <= high, None for another node."""
    nodes, node = p.nodes, p.nodes[k]
    if node.op == "le" and nodes[node.args[0]].op == "fabs":
        source, bounds = nodes[node.args[0]].args[0], [node.args[1]]
    elif node.op == "and" and all(nodes[a].op == "le" for a in node.args):
        (low, source), (other, high) = (nodes[a].args for a in node.args)
        bounds = [low, high] if other == source else []
    else:
        return None
    known = all(nodes[b].op == "literal" for b in bounds) and bounds
    return [source, *bounds] if known and nodes[source].op == "input" else None


class _Rewriter:
    """Builds the program with guards."""

    def __init__(self, p: Program, checks: list[Check]) -> None:
        self.p, self.checks = p, checks
        self.nodes: list[Node] = []
        self.known: dict[Node, int] = {}
        self.index: dict[int, int] = {}

    def program(self) -> Program:
        guards, word = [], self._put(Node("literal"))
        for check in self.checks:
            loads = tuple(self._put(self.p.nodes[k]) for k in check.loads)
            guards.append(self._put(Node("guard", (*loads, word), value=check.bit, name=check.state)))
            word = self._put(Node("guarded", (guards[-1],)))
            self.index |= {check.held: guards[-1], check.word: word}
        for check in self.checks:
            self.index[check.test] = self._acceptance(word, int(check.bit))
        for k in range(len(self.p.nodes)):
            self.index.setdefault(k, -1)
            if self.index[k] < 0:
                self.index[k] = self._copy(k, word)
        return self.p.with_nodes(tuple(self.nodes), [self.index[k] for k in range(len(self.p.nodes))])

    def _put(self, node: Node) -> int:
        if node not in self.known:
            self.known[node] = len(self.nodes)
            self.nodes.append(node)
        return self.known[node]

    def _acceptance(self, word: int, bits: int) -> int:
        return self._put(Node("accepted", (word,), value=float(bits)))

    def _copy(self, k: int, word: int) -> int:
        """Copy a node; a conjunction of accepted inputs tests the bits of all."""
        node = self.p.nodes[k]
        node = node.renumbered(self.index)
        tested = [int(n.value) if n.op == "accepted" else 0 for n in (self.nodes[a] for a in node.args)]
        if node.op == "choose" and tested[0] and self.nodes[node.args[2]] == Node("literal"):
            if self.nodes[node.args[1]] == Node("literal", value=1.0):
                return node.args[0]
            tested = tested[:2]
        elif node.op != "and":
            return self._put(node)
        return self._acceptance(word, tested[0] | tested[1]) if all(tested) else self._put(node)
