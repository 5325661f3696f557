"""Named SymPy definitions of a straight-line program: v_k = op(v_i, v_j) becomes name = expression of other names.

The program is divided at its named values: loads, signals, values that are used at least twice and take SHARED
operations or more, and parts of any expression that would otherwise need more than LARGEST operations. An unnamed part
is called by an unused letter and a number. SymPy simplifies only while it builds sums and products, which bounds the
time; comparisons, choices and limits are opaque functions.
"""

import math
import re
from collections.abc import Callable, Collection, Mapping, Sequence

import casadi as ca
import sympy as sp

from synth.emit.program.lower import Node
from synth.emit.program.operations import BINARY, UNARY
from synth.errors import DesignError
from synth.signals import Signal

SHARED, LARGEST = 3, 22  # operations
LETTERS = ("a", "b", "c", "d", "q", "s", "A", "B", "C")  # for unnamed parts; the first unused letter is taken
# Operations that a plant may use although the emitter does not support them.
UNARY_TOO = UNARY | {
    ca.OP_SIGN: "sign",
    ca.OP_ASINH: "asinh",
    ca.OP_ACOSH: "acosh",
    ca.OP_ATANH: "atanh",
    ca.OP_FLOOR: "floor",
    ca.OP_CEIL: "ceil",
    ca.OP_ERF: "erf",
}
BINARY_TOO = BINARY | {ca.OP_POW: "pow", ca.OP_CONSTPOW: "pow", ca.OP_FMOD: "mod", ca.OP_HYPOT: "hypot"}

ROUNDING = 4e-16  # relative error of such a number after two operations
_KNOWN = ((math.pi, sp.pi), (1 / math.pi, 1 / sp.pi), (math.sqrt(2), sp.sqrt(2)), (math.sqrt(3), sp.sqrt(3)))

_OPERATIONS: dict[str, Callable[..., sp.Expr]] = {
    "neg": lambda a: -a,
    "exp": sp.exp,
    "log": sp.log,
    "sqrt": sp.sqrt,
    "sq": lambda a: a**2,
    "twice": lambda a: 2 * a,
    "inv": lambda a: 1 / a,
    "add": lambda a, b: a + b,
    "sub": lambda a, b: a - b,
    "mul": lambda a, b: a * b,
    "dot": lambda *a: sum((k * x for k, x in zip(a[: len(a) // 2], a[len(a) // 2 :], strict=True)), sp.Integer(0)),
    "div": lambda a, b: a / b,
    "pow": lambda a, b: a**b,
    "fabs": sp.Abs,
    **{n: getattr(sp, n) for n in ("sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh")},
    **{n: getattr(sp, n) for n in ("asinh", "acosh", "atanh", "atan2")},
}


def opaque(name: str) -> sp.Function:
    """Return a real function without properties known to SymPy."""
    return sp.Function(name, real=True)


def symbol(name: str) -> sp.Symbol:
    """Return the real symbol of that name."""
    return sp.Symbol(name, real=True)


def name_parts(nodes: Sequence[Node], names: Mapping[int, str], ends: Sequence[int]) -> dict[int, str]:
    """Return `names` with names for further parts of `ends`, numbered in the order of computation.

    Raises DesignError when every letter for parts is in use.
    """
    needed, users = live(nodes, ends)
    parts, cost = set(), dict.fromkeys(range(len(nodes)), 0)
    for k in needed:
        if not nodes[k].args:
            continue
        cost[k] = 1 + sum(0 if a in names or a in parts else cost[a] for a in nodes[k].args)
        while cost[k] > LARGEST:
            widest = max((a for a in nodes[k].args if a not in names and a not in parts), key=lambda a: cost[a])
            cost[k] -= cost[widest]
            parts.add(widest)
        if k not in names and users[k] > 1 and cost[k] >= SHARED:
            parts.add(k)
    letter = _free_letter({n.name for n in nodes if n.name} | set(names.values()))
    return dict(names) | {k: f"{letter}_{count}" for count, k in enumerate(sorted(parts), 1)}


def expression(nodes: Sequence[Node], names: Mapping[int, str], end: int) -> sp.Expr:
    """Return a value as an expression of the named values that it depends on; a load is its name."""

    def of(k: int) -> sp.Expr:
        return symbol(names[k]) if k in names else build(k)

    def build(k: int) -> sp.Expr:
        node = nodes[k]
        if node.op == "literal":
            return number(node.value)
        if node.op == "table":
            return opaque(node.name)(*(of(a) for a in node.args))
        if node.op == "max" and (limited := _limits(nodes, names, node)):
            return opaque("sat")(*(of(a) for a in limited))
        if node.op in ("when", "choose"):
            otherwise = of(node.args[2]) if node.op == "choose" else sp.Integer(0)
            return _choice(of(node.args[0]), of(node.args[1]), otherwise)
        return _OPERATIONS.get(node.op, opaque(node.op))(*(of(a) for a in node.args))

    return build(end) if nodes[end].args or end not in names else of(end)


def number(value: float) -> sp.Expr:
    """Return a double as a SymPy number: integers, quarters, and simple fractions of pi and roots are exact."""
    if not math.isfinite(value):
        return sp.nan if math.isnan(value) else sp.oo if value > 0 else -sp.oo
    for below in (1, 2, 4):
        if abs(value) < 1e6 and abs(value * below - round(value * below)) <= ROUNDING * abs(value):
            return sp.Rational(round(value * below), below)
    for known, exact in _KNOWN:
        for below in (1, 2, 3, 4, 6):
            above = round(value * below / known)
            if 0 < abs(above) < 100 and abs(above * known / below - value) <= ROUNDING * abs(value):
                return sp.Rational(above, below) * exact
    return sp.Float(value)


def _choice(condition: sp.Expr, value: sp.Expr, otherwise: sp.Expr) -> sp.Expr:
    """Return a choice; a nested choice with the same alternative becomes part of the condition."""
    if type(value).__name__ == "choose" and value.args[2] == otherwise:
        return opaque("choose")(opaque("and")(condition, value.args[0]), value.args[1], otherwise)
    return opaque("choose")(condition, value, otherwise)


def _limits(nodes: Sequence[Node], names: Mapping[int, str], node: Node) -> tuple[int, int, int] | None:
    """Return (value, low, high) of max(min(value, high), low), None for any other maximum."""
    inner = next((a for a in node.args if nodes[a].op == "min" and a not in names), None)
    if inner is None:
        return None
    low = next(iter([a for a in node.args if a != inner]), inner)
    first, second = nodes[inner].args
    return (second, low, first) if nodes[first].op == "literal" else (first, low, second)


def live(nodes: Sequence[Node], ends: Sequence[int]) -> tuple[list[int], list[int]]:
    """Return the values that `ends` depend on, in order, and the number of values that use each."""
    needed, users = set(ends), [0] * len(nodes)
    for k in range(max(ends, default=-1), -1, -1):
        if k in needed:
            needed.update(nodes[k].args)
            for a in set(nodes[k].args):
                users[a] += 1
    return sorted(needed), users


def _free_letter(used: Collection[str]) -> str:
    for letter in LETTERS:
        if not any(re.fullmatch(rf"{letter}_?\d*", name) for name in used):
            return letter
    raise DesignError(f"the letters {', '.join(LETTERS)} are taken by signals: rename one of them")


def shape(
    nodes: Sequence[Node], names: Mapping[int, str], end: int, signal: Signal | None = None
) -> tuple[object, tuple[str, ...]]:
    """Return the structure of a value without names, and these names in order of occurrence.

    A limit to the range of `signal` counts without its numbers.
    """
    leaves: list[str] = []

    def of(k: int, top: bool = False) -> object:
        if k in names and not (top and nodes[k].args):
            if names[k] not in leaves:
                leaves.append(names[k])
            return leaves.index(names[k])
        node = nodes[k]
        if signal is not None and node.op == "max" and (limited := _limits(nodes, names, node)):
            inner, *bounds = limited
            if [nodes[b].value for b in bounds if nodes[b].op == "literal"] == [signal.low, signal.high]:
                return ("own range", of(inner))
        return (node.op, node.value, node.name, *(of(a) for a in node.args))

    return of(end, True), tuple(leaves)
