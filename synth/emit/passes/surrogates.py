"""Surrogate pass: certified polynomials replace functions of one variable in a program.

    root = f(v)   ->   root = p(v - c),   or   root = p(l/(v + d) - c)   if the program computes l/(v + d) anyway

A reciprocal moves poles and branch points below the range away from it, and a much lower degree may suffice. Functions
of one variable share its argument. Equal functions of several variables share their polynomial, on a range that has all
of theirs, where it needs no higher degree than theirs.
"""

import functools
import math
from collections import defaultdict
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace

import flint
import numpy as np

from synth.base import cache
from synth.emit.approx import surrogate
from synth.emit.approx.polynomial import Polynomial
from synth.emit.passes import univariate
from synth.emit.passes.univariate import Analytic, Key
from synth.emit.program import words
from synth.emit.program.lower import Node, Program
from synth.emit.program.operations import LIBM
from synth.emit.proof import conditions, ranges
from synth.errors import EmitError

MOST_NAMED = 4  # variables of a polynomial that its comment names
_WORDS = {"sin": "sine", "cos": "cosine", "tan": "tangent", "atan": "arctangent"}  # for a function without a signal


@dataclass(frozen=True)
class Surrogate:
    """A polynomial that approximates `tags`, signals or a function of x, in the variable x, with its name in C."""

    name: str
    tags: tuple[str, ...]
    variable: str
    polynomial: Polynomial


@dataclass(frozen=True)
class _Reciprocal:
    """The value l / (v + d) of a variable v."""

    l: float
    d: float


def replace_functions(
    program: Program, node_ranges: Sequence[ranges.Range], scalar: type[np.floating], error: float | None = None
) -> tuple[Program, tuple[Surrogate, ...]]:
    """Return the program with polynomials in place of its functions of one variable, and these polynomials.

    `node_ranges` are those of the program's nodes. A function that no polynomial approximates to the relative error,
    such as one with a zero in its range, stays.
    """
    names, users = _node_names(program), program.users()
    chosen: dict[int, tuple[int, _Task]] = {}
    for f in univariate.find(program, node_ranges):
        key = univariate.key(program, node_ranges, f.root, f.variable)
        tasks = {
            k: _Task(key, reciprocal, node_ranges[k].low, node_ranges[k].high, scalar, error)
            for k, reciprocal in _candidate_variables(program, users, node_ranges, f).items()
        }
        k = min(tasks, key=lambda k: (_degree(tasks[k]), k == f.variable))
        chosen[f.root] = (k, tasks[k])
    wider = _cover([task for _, task in chosen.values()])
    best: dict[int, tuple[int, Polynomial]] = {}
    first: dict[int, Polynomial] = {}
    for root, (k, task) in chosen.items():
        with suppress(EmitError):
            best[root] = (k, _fit_in_argument_of(wider[task], first.get(k)))
            first.setdefault(k, best[root][1])
    return _rewrite(program, names, best)


def _node_names(program: Program) -> dict[int, str]:
    names = {k: node.name for k, node in enumerate(program.nodes) if node.op in ("input", "state")}
    return names | {k: named.signal.name for named, k in reversed(program.marks)}


def _candidate_variables(
    program: Program, users: Sequence[Sequence[int]], node_ranges: Sequence[ranges.Range], f: univariate.Univariate
) -> dict[int, _Reciprocal | None]:
    """Return the nodes as functions of which a root may be written: its variable, and reciprocals of it."""
    cone = set(univariate.cone(program, f.root, f.variable))
    internal = {k for k in cone if cone.issuperset(users[k])} | {f.root}
    neighbours = sorted({k for a in users[f.variable] for k in users[a]} - internal)
    candidates = {k: _reciprocal(program, k, f.variable) for k in neighbours}
    return {f.variable: None} | {k: c for k, c in candidates.items() if c and node_ranges[k].finite}


def _reciprocal(program: Program, k: int, variable: int) -> _Reciprocal | None:
    """Read node k as l / (variable + d)."""
    node = program.nodes[k]
    top = program.nodes[node.args[0]] if node.op == "div" else Node("literal", value=1.0)
    if node.op not in ("div", "inv") or top.op != "literal":
        return None
    bottom = program.nodes[node.args[-1]]
    added = [program.nodes[a] for a in bottom.args if a != variable]
    if bottom.op != "add" or variable not in bottom.args or [a.op for a in added] != ["literal"]:
        return None
    return _Reciprocal(top.value, added[0].value)


@dataclass(frozen=True)
class _Task:
    """A fit: the function of `key`, in its variable or in its reciprocal, on a range of either."""

    key: Key
    reciprocal: _Reciprocal | None
    low: float
    high: float
    scalar: type[np.floating]
    error: float | None


def _cover(tasks: Sequence[_Task]) -> dict[_Task, _Task]:
    """Return for each fit one that covers its range, with those of other fits of its function, of no higher degree."""
    by_function: dict[_Task, list[_Task]] = defaultdict(list)
    for task in dict.fromkeys(tasks):
        by_function[replace(task, low=0.0, high=0.0)].append(task)
    groups = [group for same in by_function.values() for group in _groups(same)]
    return {task: _covering(group) for group in groups for task in group}


def _groups(tasks: list[_Task]) -> list[list[_Task]]:
    """Return fits of one function in groups that one polynomial serves: all, or the widest with what it serves."""
    if len(tasks) == 1 or _serves(_covering(tasks), tasks):
        return [tasks]
    groups: list[list[_Task]] = []
    for task in sorted(tasks, key=lambda t: t.low - t.high):
        serving = next((g for g in groups if _serves(_covering([*g, task]), [*g, task])), None)
        if serving is None:
            groups.append([task])
        else:
            serving.append(task)
    return groups


def _serves(wide: _Task, tasks: Sequence[_Task]) -> bool:
    """Tell whether a fit needs no higher degree than those that it covers, which is known first without rounding."""
    degree = _fitted_degree(wide)
    return degree <= min(map(_degree, tasks)) or (degree < math.inf and degree <= min(map(_fitted_degree, tasks)))


def _covering(group: Sequence[_Task]) -> _Task:
    return replace(group[0], low=min(t.low for t in group), high=max(t.high for t in group))


def _fitted_degree(task: _Task) -> float:
    """Return the degree of the polynomial that is fitted; infinity if none suffices."""
    try:
        return _fit(task, None).degree
    except EmitError:
        return math.inf


def _fit_in_argument_of(task: _Task, like: Polynomial | None) -> Polynomial:
    """Fit in the scaled argument t of `like`, unless that needs a higher degree."""
    if like is not None and like.parity == "none":
        with suppress(EmitError):
            polynomial = _fit(task, like)
            if polynomial.parity == "none" and polynomial.degree <= _degree(task):
                return polynomial
    return _fit(task, None)


@functools.cache
@cache.cached
def _degree(task: _Task) -> float:
    """Estimate the degree that a polynomial needs; infinity if none suffices."""
    try:
        return surrogate.least_degree(_function(task), task.low, task.high, task.scalar, task.error)
    except EmitError:
        return math.inf


@functools.cache
@cache.cached
def _fit(task: _Task, like: Polynomial | None) -> Polynomial:
    """Fit a function; the results are cached, because designs evaluate one function at many signals.

    No name of a signal is passed on: only an EmitError would say it, which nobody sees.
    """
    return surrogate.fit(_function(task), task.low, task.high, task.scalar, task.error, like=like)


@functools.cache
def _function(task: _Task) -> Analytic:
    f = univariate.function(task.key)
    return _in_reciprocal(f, task.reciprocal, task.scalar) if task.reciprocal else f


def _in_reciprocal(f: Analytic, reciprocal: _Reciprocal, scalar: type[np.floating]) -> Analytic:
    """Return f as a function of u = l / (v + d), with l and d rounded to the scalar type."""
    l, d = (flint.acb(float(scalar(value))) for value in (reciprocal.l, reciprocal.d))
    return lambda u: f(l / u - d)


def _rewrite(
    program: Program, names: Mapping[int, str], best: Mapping[int, tuple[int, Polynomial]]
) -> tuple[Program, tuple[Surrogate, ...]]:
    nodes: list[Node] = []
    known: dict[Node, int] = {}
    index: dict[int, int] = {}
    surrogates: dict[Polynomial, Surrogate] = {}
    roots: dict[Polynomial, list[int]] = defaultdict(list)
    for root, (_, p) in best.items():
        roots[p].append(root)

    def place(op: str, *args: int, value: float = 0.0, name: str = "") -> int:
        node = Node(op, args, value, name)
        if node not in known:
            known[node] = len(nodes)
            nodes.append(node)
        return known[node]

    def place_polynomial(k: int) -> int:
        variable, p = best[k]
        if p not in surrogates:
            signals = tuple(dict.fromkeys(names.get(root, "") for root in roots[p]))
            common = words.common(signals) if all(signals) else ""
            stem = common or (signals[0] if all(signals) else _function_name(program, names, k))
            name = _unused_name(stem, {s.name for s in surrogates.values()})
            about = _describe_variables(program, names, [*dict.fromkeys(best[root][0] for root in roots[p])])
            function = conditions.function(program, k, variable) or name
            tags = (common,) if common else signals if all(signals) else (function,)
            surrogates[p] = Surrogate(name, tags, about, p)
        t = index[variable]
        t = place("sub" if p.centre > 0 else "add", t, place("literal", value=abs(p.centre))) if p.centre else t
        t = place("mul", place("literal", value=p.scale), t) if p.scale != 1 else t
        v = t if p.parity == "none" else place("sq", t)
        q = place("polynomial", v, name=surrogates[p].name)
        return place("mul", t, q) if p.parity == "odd" else q

    waiting = list(range(len(program.nodes)))[::-1]
    while waiting:
        k = waiting.pop()
        needs = (best[k][0],) if k in best else program.nodes[k].args
        if missing := [a for a in needs if a not in index]:
            waiting += [k, *missing]
        elif k not in index:
            n = program.nodes[k]
            args = tuple(index[a] for a in n.args) if k not in best else ()
            index[k] = place_polynomial(k) if k in best else place(n.op, *args, value=n.value, name=n.name)
    rewritten = program.with_nodes(tuple(nodes), [index[k] for k in range(len(program.nodes))])
    polynomials = {s.name: s.polynomial for s in surrogates.values()}
    return replace(rewritten, polynomials=polynomials), tuple(surrogates.values())


def _function_name(program: Program, names: Mapping[int, str], k: int) -> str:
    """Return a name like cos_phi for a function of a signal, which may be limited before, else the operation's."""
    node = program.nodes[k]
    if node.op not in LIBM or len(node.args) != 1:
        return "function"
    variable = node.args[0]
    while variable not in names and program.nodes[variable].op == "clamp":
        variable = program.nodes[variable].args[0]
    return f"{node.op}_{names[variable]}" if variable in names else _WORDS.get(node.op, node.op)


def _unused_name(signal: str, used_names: set[str]) -> str:
    """Return an unused name for the polynomial of a signal; signals of different Blocks may have the same name."""
    candidates = (f"{signal}{n}_polynomial" for n in ("", *(f"_{i}" for i in range(2, len(used_names) + 3))))
    return next(name for name in candidates if name not in used_names)


def _describe_variables(program: Program, names: Mapping[int, str], variables: Sequence[int]) -> str:
    """Describe the variables of a polynomial: a few by their names, of others the first."""
    few = [names[k] for k in variables if k in names]
    if len(few) == len(variables) <= MOST_NAMED:
        return ", ".join(few)
    others = len(variables) - 1
    more = f" and {others} other{'s' if others > 1 else ''}" if others else ""
    return f"{_describe_variable(program, names, variables[0])}{more}"


def _describe_variable(program: Program, names: Mapping[int, str], k: int) -> str:
    """Describe a node: as a signal, a reciprocal, a sum or difference of others, or else as an expression."""
    node = program.nodes[k]
    sides = [names.get(a) or conditions.expression(program, a, spelled=False) for a in node.args]
    if k in names or node.op not in ("inv", "div", "add", "sub"):
        return names.get(k) or conditions.expression(program, k, spelled=False)
    if node.op in ("add", "sub"):
        return f"{sides[0]} {'+' if node.op == 'add' else '-'} {sides[1]}"
    return f"{sides[0] if node.op == 'div' else 1} / ({_describe_variable(program, names, node.args[-1])})"
