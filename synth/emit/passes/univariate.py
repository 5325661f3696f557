"""Univariate subexpressions of a program, identified by dominators.

Node v dominates node k if every path from the loads to k passes through v. Then k = f(v), with numbers and constants.
If a function of libm lies between v and k, f can be replaced as a whole:

    loads ... -> v -> (h + v) -> sinh(k (h + v)) -> c / sinh(...) -> root -> ...
              \\______________________ f ______________________/

Each f is maximal: the root is as high and the variable as low as f stays analytic. It absorbs factors, sums of
functions of the same variable and changes of scale, up to a named signal. Dominators form a tree; in the order of
computation the immediate dominator of a node is the nearest common ancestor of its arguments in that tree.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import flint

from synth.emit.program.lower import Program
from synth.emit.program.operations import LIBM, LIBM_OF_TWO
from synth.emit.proof.ranges import Range
from synth.errors import EmitError

Analytic = Callable[[flint.acb], flint.acb]
Key = tuple[tuple[str, tuple[int, ...], float], ...]

TRANSCENDENTAL = LIBM - LIBM_OF_TWO - {"sqrt", "fabs"}
_NUMBERS = frozenset({"literal", "constant"})
_NOT_ANALYTIC = flint.acb("nan")


@dataclass(frozen=True)
class Univariate:
    """Node `root` is a function of node `variable` and of numbers and constants alone."""

    root: int
    variable: int


@dataclass(frozen=True)
class _Dependence:
    """The variable on which a node depends, and whether a function of libm lies between them."""

    variable: int
    transcendental: bool


def find(program: Program, ranges: Sequence[Range]) -> tuple[Univariate, ...]:
    """Return the maximal functions of one variable that contain a function of libm.

    Roots that differ only by a factor and an offset are replaced by the node that they share. A subexpression that is
    also read elsewhere is a root of its own.
    """
    dependences = _dependences(program, ranges)
    users = program.users()
    live_out = set(program.ends())
    roots = [
        k
        for k, dependence in dependences.items()
        if dependence.transcendental and (k in live_out or not all(_absorbs(dependences, u, k) for u in users[k]))
    ]
    return tuple(
        Univariate(k, dependences[k].variable) for k in sorted(_merge_scaled_roots(program, dependences, roots))
    )


def _depends_on_signals(program: Program) -> list[bool]:
    """Return for each node whether it depends on an input or a state."""
    varies: list[bool] = []
    for node in program.nodes:
        varies.append(node.op in ("input", "state") or any(varies[a] for a in node.args))
    return varies


def _common_dominator(above: list[int | None], depth: list[int], a: int | None, b: int | None) -> int | None:
    while a is not None and b is not None and a != b:
        a, b = (above[a], b) if depth[a] >= depth[b] else (a, above[b])
    return a if a == b else None


def _dependences(program: Program, ranges: Sequence[Range]) -> dict[int, _Dependence]:
    """Return the dependence of each node that is an analytic function of another one.

    A named signal that is such a function and contains libm ends it: nodes computed from the signal use it as their
    variable. Naming a signal therefore separates functions.
    """
    dependences: dict[int, _Dependence] = {}
    above: list[int | None] = []
    depth: list[int] = []
    varies = _depends_on_signals(program)
    named = {k for _, k in program.marks}
    for k, node in enumerate(program.nodes):
        args = [a for a in node.args if varies[a]]
        v = args[0] if args else None
        for a in args[1:]:
            v = _common_dominator(above, depth, v, a)
        dependence = None
        if v is not None and ranges[v].finite:
            dependence = _dependence(program, ranges, varies, dependences, named, k, v)
        if dependence is not None:
            dependences[k] = dependence
        if k in named and k in dependences and dependences[k].transcendental:
            v = None
        above.append(v)
        depth.append(0 if v is None else depth[v] + 1)
    return dependences


def _dependence(
    program: Program,
    ranges: Sequence[Range],
    varies: list[bool],
    dependences: dict[int, _Dependence],
    named: set[int],
    k: int,
    v: int,
) -> _Dependence | None:
    """Return the dependence of node k through its dominator v on v's own variable; None if it is not analytic."""
    inside = [n for n in cone(program, k, v) if n != v]
    ops = {n: program.nodes[n].op for n in inside}
    if not all((op in _COMPLEX or op in _NUMBERS) and ranges[n].finite for n, op in ops.items()):
        return None
    below = dependences.get(v, _Dependence(v, False))
    below = _Dependence(v, False) if v in named and below.transcendental else below
    transcendental = any(op in TRANSCENDENTAL and varies[n] for n, op in ops.items())
    return _Dependence(below.variable, below.transcendental or transcendental)


def cone(program: Program, root: int, variable: int) -> list[int]:
    """Return the nodes between `variable` and `root`, in order, both included."""
    nodes, waiting = {variable}, [root]
    while waiting:
        k = waiting.pop()
        if k not in nodes:
            nodes.add(k)
            waiting += program.nodes[k].args
    return sorted(nodes)


def _absorbs(dependences: dict[int, _Dependence], user: int, k: int) -> bool:
    """Return whether k lies between one of its users and the user's variable."""
    return user in dependences and dependences[user].transcendental and dependences[user].variable != k


def _merge_scaled_roots(program: Program, dependences: dict[int, _Dependence], roots: list[int]) -> set[int]:
    """Replace roots that are affine functions of the same node by the last node that they share."""
    varies = _depends_on_signals(program)
    chains = {k: _linear_chain(program, dependences, varies, k) for k in roots}
    groups: dict[int, list[int]] = {}
    for k in roots:
        groups.setdefault(chains[k][-1], []).append(k)
    return {max(set(chains[group[0]]).intersection(*(chains[k] for k in group))) for group in groups.values()}


def _linear_chain(program: Program, dependences: dict[int, _Dependence], varies: list[bool], k: int) -> list[int]:
    """Return k and the nodes below it of which it is an affine function, as long as libm is below them."""
    node = program.nodes[k]
    varying = [a for a in node.args if varies[a]]
    linear = node.op in ("add", "sub", "mul", "neg", "twice") or (node.op == "div" and varying == [node.args[0]])
    if not linear or len(varying) != 1 or varying[0] not in dependences or not dependences[varying[0]].transcendental:
        return [k]
    return [k, *_linear_chain(program, dependences, varies, varying[0])]


def key(program: Program, ranges: Sequence[Range], root: int, variable: int) -> Key:
    """Return `root` as operations on earlier rows (operation, rows, number), the variable first.

    Numbers and constants are rounded to the scalar type. Equal functions of different variables have equal keys: the
    rows follow the expression, not the program.

    Raises EmitError if the root depends on more than the variable, or is not analytic.
    """
    rows: list[tuple[str, tuple[int, ...], float]] = [("variable", (), 0.0)]
    place, waiting = {variable: 0}, [root]
    while waiting:
        k = waiting[-1]
        node = program.nodes[k]
        missing = [a for a in node.args if a not in place]
        if k in place or not missing:
            waiting.pop()
        if k in place:
            continue
        if node.op not in _COMPLEX and node.op not in _NUMBERS:
            raise EmitError(
                f"node {root} is not an analytic function of node {variable}: it needs '{node.name or node.op}'; "
                "choose another variable"
            )
        waiting += missing[::-1]
        if not missing:
            place[k] = len(rows)
            number = ranges[k].low if node.op in _NUMBERS else 0.0
            op = "literal" if node.op in _NUMBERS else node.op
            rows.append((op, tuple(place[a] for a in node.args), number))
    return tuple(rows)


def function(key: Key) -> Analytic:
    """Return the function of a key on complex balls, in the precision that is set when it is called.

    For a ball on which the function is not analytic the result is not finite.
    """

    def f(x: flint.acb) -> flint.acb:
        values = [x]
        for op, args, number in key[1:]:
            values.append(flint.acb(number) if op == "literal" else _COMPLEX[op](*(values[a] for a in args)))
        return values[-1]

    return f


def _off_branch_cut(x: flint.arb, y: flint.arb) -> bool:
    """Return whether x + i y is provably off the branch cuts: the real axis beyond 1 and -1."""
    return not y.contains(0) or bool(abs(x) < 1)


_COMPLEX: dict[str, Callable[..., flint.acb]] = {
    "neg": lambda a: -a,
    "sq": lambda a: a * a,
    "twice": lambda a: 2 * a,
    "inv": lambda a: 1 / a,
    "add": lambda a, b: a + b,
    "sub": lambda a, b: a - b,
    "mul": lambda a, b: a * b,
    "div": lambda a, b: a / b,
    "sqrt": lambda a: a.sqrt(analytic=True),
    "log": lambda a: a.log(analytic=True),
    "log1p": lambda a: (1 + a).log(analytic=True),
    "asin": lambda a: a.asin() if _off_branch_cut(a.real, a.imag) else _NOT_ANALYTIC,
    "acos": lambda a: a.acos() if _off_branch_cut(a.real, a.imag) else _NOT_ANALYTIC,
    "atan": lambda a: a.atan() if _off_branch_cut(a.imag, a.real) else _NOT_ANALYTIC,
    "asinh": lambda a: a.asinh() if _off_branch_cut(a.imag, a.real) else _NOT_ANALYTIC,
    **{
        name: (lambda a, name=name: getattr(a, name)())
        for name in ("exp", "expm1", "erf", "sin", "cos", "tan", "sinh", "cosh", "tanh")
    },
}
