"""Lowering: from a Block's CasADi expressions to a straight-line program in SSA form, in CasADi's order of computation.

Common subexpressions are eliminated first. Marks record the intermediate signals of the composition. CasADi's pair of
`if_else_zero` and a negated condition becomes a single choice again. The fault word is built bit by bit. Operations
without a form in C are written out:

    sign(x)         1 if 0 < x, else (-1 if x < 0, else 0)
    floor(x)        -(n + 1 if n < -x, else n) with n the whole part of -x, for x < 0; C truncates others, and alone
                    |x| and max(x, 0)
    ceil(x)         -floor(-x)
    copysign(x, y)  -|x| if y < 0, else |x|: a zero has no sign
    hypot(x, y)     sqrt(x^2 + y^2)
    x^e             products, roots and a reciprocal for a multiple e of 1/2, else exp(e log(x))

NumPy evaluation of programs: the value of each node for arrays of loads, in double.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import reduce
from itertools import groupby, islice
from math import log, remainder
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray
from scipy.special import erf

from synth.block import Block, ComputedSignal, is_dot
from synth.emit.approx.polynomial import Polynomial
from synth.emit.program import words
from synth.emit.program.operations import BINARY, LOOKUP, UNARY
from synth.errors import EmitError
from synth.fault import Fault
from synth.signals import Signal


@dataclass(frozen=True)
class Node:
    """One value: an operation on earlier nodes, a literal (`value`), or a load (`name`).

    A constant with a negative `value` is the negative of that constant.
    """

    op: str
    args: tuple[int, ...] = ()
    value: float = 0.0
    name: str = ""

    def renumbered(self, index: Sequence[int] | Mapping[int, int]) -> "Node":
        """Return the node with the arguments index[a]; the same one where they are no others."""
        args = tuple([index[a] for a in self.args])
        return self if args == self.args else Node(self.op, args, self.value, self.name)


@dataclass(frozen=True)
class Matrix:
    """Nodes of constants and literals (m, n), their values, and what each row computes and each column multiplies."""

    coefficients: tuple[tuple[Node, ...], ...]
    values: tuple[tuple[float, ...], ...]
    rows: tuple[str, ...]
    columns: tuple[str, ...]


@dataclass(frozen=True)
class Function:
    """The nodes of the arguments and of the results of a function that a law calls."""

    arguments: tuple[int, ...]
    results: tuple[int, ...]

    def renumbered(self, index: Sequence[int] | Mapping[int, int]) -> "Function":
        """Return the function with the nodes index[k], without those that a mapping does not have."""
        arguments, results = (
            tuple(dict.fromkeys(index[k] for k in nodes if not isinstance(index, Mapping) or k in index))
            for nodes in (self.arguments, self.results)
        )
        return Function(arguments, results)


@dataclass(frozen=True)
class Program:
    """Nodes in the order of computation, and the node of each named signal, output, next state and the fault word.

    `marks` holds (signal, node) in the order of the composition; `word` is None for a Block without faults.
    `polynomials` maps the name of a "polynomial" node to its polynomial, and `tables` that of a "table" node to its
    numbers, and `matrices` that of a "product" node, of which a "row" is an element. `products` maps the name of a
    constant that folding introduced to the two constants that it multiplies. `titles` maps each Block of the
    composition to its description and the number of its equation, `notes` to sentences about it. `labels` are names of
    nodes that the laws give, for the locals of the C, `functions` by their paths those for which the C has one.
    `recorded` and `limited` are the signals of which diagnostics have the value, or that they are at a limit.
    """

    nodes: tuple[Node, ...]
    marks: tuple[tuple[ComputedSignal, int], ...]
    outputs: dict[str, int]
    next: dict[str, int]
    integers: frozenset[str] = field(default=frozenset())
    word: int | None = None
    polynomials: Mapping[str, Polynomial] = field(default_factory=dict)
    products: Mapping[str, tuple[str, str]] = field(default_factory=dict)
    titles: Mapping[str, str] = field(default_factory=dict)
    tables: Mapping[str, tuple[float, ...]] = field(default_factory=dict)
    matrices: Mapping[str, Matrix] = field(default_factory=dict)
    calls: Mapping[str, Any] = field(default_factory=dict)
    typed: Mapping[str, str] = field(default_factory=dict)
    returns: Mapping[str, int] = field(default_factory=dict)
    paths: Mapping[str, str] = field(default_factory=dict)
    members: Mapping[str, tuple[str, str]] = field(default_factory=dict)
    by_value: bool = False
    labels: Mapping[int, str] = field(default_factory=dict)
    functions: Mapping[str, "Function"] = field(default_factory=dict)
    notes: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    recorded: tuple[Signal, ...] = ()
    limited: tuple[Signal, ...] = ()

    def with_nodes(
        self, nodes: tuple[Node, ...], index: Sequence[int], further_labels: Mapping[int, str] | None = None
    ) -> "Program":
        """Return the program with new nodes, where the old node k becomes node index[k], without dead nodes."""
        outputs, next = ({name: index[k] for name, k in ends.items()} for ends in (self.outputs, self.next))
        marks = tuple((named, index[k]) for named, k in self.marks)
        word = None if self.word is None else index[self.word]
        labels = {**(further_labels or {}), **{index[k]: name for k, name in self.labels.items()}}
        returns = {name: index[k] for name, k in self.returns.items()}
        functions = {path: f.renumbered(index) for path, f in self.functions.items()}
        return _without_dead_nodes(
            replace(
                self, nodes=nodes, marks=marks, outputs=outputs, next=next, word=word, labels=labels, returns=returns,
                functions=functions,
            )
        )  # fmt: skip

    def substituted(self, equal: Mapping[int, int]) -> "Program":
        """Return the program in which `equal` maps nodes to the earlier nodes that replace them."""
        index: list[int] = []
        for k in range(len(self.nodes)):
            index.append(index[equal[k]] if k in equal else k)
        nodes = tuple(n.renumbered(index) for n in self.nodes)
        return self.with_nodes(nodes, index)

    def owner(self, state: str) -> str:
        """Return the Block of the composition that owns a state: the longest Block name before its own, or ""."""
        parts = state.split("_")
        leading = ("_".join(parts[:n]) for n in range(len(parts) - 1, 0, -1))
        return next((name for name in leading if name in self.titles), "")

    def ends(self) -> list[int]:
        """Return the nodes that are stored or returned: the live-out values."""
        return [*self.outputs.values(), *self.next.values(), *self.result_nodes()]

    def result_nodes(self) -> list[int]:
        """Return the nodes that the function returns: the fault word, or the results of a routine."""
        return [*([] if self.word is None else [self.word]), *self.returns.values()]

    def users(self) -> list[list[int]]:
        """Return for each node the nodes that read it, once for each operand (use lists)."""
        users: list[list[int]] = [[] for _ in self.nodes]
        for k, node in enumerate(self.nodes):
            for a in node.args:
                users[a].append(k)
        return users


def program(block: Block) -> Program:
    """Lower a Block.

    Raises EmitError for an operation without a form in C, by name, and for a table whose name is already used.
    """
    loads = [*(("input", s.name) for s in block.inputs), *(("state", s.name) for s in block.states)]
    loads += [("constant", c.name) for c in block.constants]
    exprs = [e for _, e in block.computed_signals] + list(block.output.values()) + list(block.next.values())
    shared = ca.cse(exprs)
    f = ca.Function("step", [ca.vcat([block.symbol[n] for _, n in loads])], [ca.vcat(shared)])
    tables: dict[str, tuple[float, ...]] = {}
    nodes, results = walk(f, loads, tables)
    count = len(block.computed_signals)
    marks = tuple((named, node) for (named, _), node in zip(block.computed_signals, results[:count], strict=True))
    tail = results[count:]
    outputs = dict(zip(block.output, tail, strict=False))
    next = dict(zip(block.next, tail[len(outputs) :], strict=True))
    word = _fault_word(nodes, [(outputs[fault.output], fault) for fault in block.faults])
    outputs = {s.name: outputs[s.name] for s in block.outputs}
    titles = {n.block: f"{n.block}: {n.tag}" if n.tag else n.block for n, _ in block.computed_signals}
    integers = frozenset([s.name for s in block.states if s.integer])
    labels = _labels(block, loads, nodes)
    notes = {name: tuple(text for n, text in block.notes if n == name) for name, _ in block.notes}
    return _without_dead_nodes(
        Program(tuple(nodes), marks, outputs, next, integers, word, titles=titles, tables=tables, labels=labels,
                notes=notes, functions=_functions(block, loads, nodes))
    )  # fmt: skip


def _labels(block: Block, loads: Sequence[tuple[str, str]], nodes: Sequence[Node]) -> dict[int, str]:
    """Return by node the name of the value of a law that it computes, or ``minus_<name>`` for its negative."""
    values, results, index = _locate(block, loads, nodes, [e for _, e in block.labels])
    names: dict[int, dict[str, None]] = {}
    negatives: dict[int, str] = {}
    for value, (name, _) in zip(results, block.labels, strict=True):
        if (k := index[value]) is not None:
            names.setdefault(k, {})[name] = None
        elif values[value].op == "neg" and (k := index[values[value].args[0]]) is not None:
            negatives |= {} if nodes[k].op == "mul" else {k: f"minus_{name}"}  # a product has the names of its factors
    return negatives | {k: words.combine([*several]) for k, several in names.items()}


def _functions(block: Block, loads: Sequence[tuple[str, str]], nodes: Sequence[Node]) -> dict[str, Function]:
    """Return the functions of the laws by their paths."""
    exprs = [e for f in block.functions for e in (*f.arguments, *f.results)]
    _, results, index = _locate(block, loads, nodes, exprs)
    places = iter([index[value] for value in results])
    made: dict[str, Function] = {}
    for f in block.functions:
        each = [[k for k in islice(places, len(exprs)) if k is not None] for exprs in (f.arguments, f.results)]
        made[f.path] = Function(*(tuple(dict.fromkeys(k for k in ks if nodes[k].args)) for ks in each))
    return made


def _locate(
    block: Block, loads: Sequence[tuple[str, str]], nodes: Sequence[Node], exprs: Sequence[ca.SX]
) -> tuple[list[Node], list[int], list[int | None]]:
    """Return nodes of their own for expressions, those of the results, and for each one the node of the program."""
    if not exprs:
        return [], [], []
    shared = ca.cse([*exprs])  # it rewrites some operations, as in the program
    f = ca.Function("values", [ca.vcat([block.symbol[n] for _, n in loads])], [ca.vcat(shared)])
    values, results = walk(f, loads, {})
    known = {node: k for k, node in reversed([*enumerate(nodes)])}
    index: list[int | None] = []
    for node in values:
        args = [index[a] for a in node.args]
        index.append(None if None in args else known.get(replace(node, args=tuple(a for a in args if a is not None))))
    return values, results, index


def _fault_word(nodes: list[Node], faults: Sequence[tuple[int, Fault]]) -> int | None:
    """Append the fault word, in which each flag sets its bit, and return its node; None without faults.

    Consecutive flags that are conjunctions with a common condition are tested inside one choice on that condition. A
    status that is 0 while the flag of a fault is set is tested where that flag is not set.
    """
    if not faults:
        return None
    nodes.append(Node("literal", value=0.0))
    flags = {flag for flag, fault in faults if not fault.status and _condition(nodes[flag]) is None}
    inside = [(flag, fault) for flag, fault in faults if fault.status and _unless(nodes, flag) in flags]
    last = {_unless(nodes, flag) for flag, _ in inside}
    others = sorted((f for f in faults if f not in inside), key=lambda f: f[0] in last)
    for condition, group in groupby(others, lambda f: _condition(nodes[f[0]])):
        start = len(nodes) - 1
        for flag, fault in group:
            before = len(nodes) - 1
            statuses = [(nodes[f].args[1], status.bit) for f, status in inside if _unless(nodes, f) == flag]
            without = _with_statuses(nodes, statuses, before)
            nodes.append(Node("bit", (before,), value=float(1 << fault.bit)))
            tested = flag if condition is None else nodes[flag].args[1]
            nodes.append(Node("choose", (tested, len(nodes) - 1, without)))
        if condition is not None:
            nodes.append(Node("choose", (condition, len(nodes) - 1, start)))
    return len(nodes) - 1


def _with_statuses(nodes: list[Node], statuses: Sequence[tuple[int, int]], word: int) -> int:
    """Append the choices that set the bits of flags in a word, and return its node."""
    for flag, bit in statuses:
        nodes.append(Node("bit", (word,), value=float(1 << bit)))
        nodes.append(Node("choose", (flag, len(nodes) - 1, word)))
        word = len(nodes) - 1
    return word


def _condition(flag: Node) -> int | None:
    return flag.args[0] if flag.op == "and" else None


def _unless(nodes: Sequence[Node], flag: int) -> int | None:
    """Return the flag whose negation is the condition of another one, None if there is none."""
    if nodes[flag].op not in ("and", "when"):
        return None
    condition = nodes[nodes[flag].args[0]]
    return condition.args[0] if condition.op == "not" else None


def walk(
    f: ca.Function,
    loads: Sequence[tuple[str, str]],
    tables: dict[str, tuple[float, ...]],
    unary: Mapping[int, str] = UNARY,
    binary: Mapping[int, str] = BINARY,
) -> tuple[list[Node], list[int]]:
    """Convert a function's instructions to nodes in static single-assignment form; return nodes and output nodes.

    `f` has one column of inputs, whose kinds and names are `loads`. The tables that it calls are added to `tables`.

    Raises EmitError for an operation in neither of the two sets, and for a call of a function that is not a table.
    """
    nodes = _Nodes()
    terms = f.instructions_sx()
    slot: dict[int, int] = {}
    results: list[int] = []
    for k in range(f.n_instructions()):
        op, i, o = f.instruction_id(k), f.instruction_input(k), f.instruction_output(k)
        if op == ca.OP_OUTPUT:
            results.append(slot[i[0]])
        elif op == ca.OP_INPUT:
            kind, name = loads[i[1]]
            slot[o[0]] = nodes.place(Node(kind, name=name))
        elif op == ca.OP_CONST:
            slot[o[0]] = nodes.place(Node("literal", value=f.instruction_constant(k)))
        elif op == ca.OP_CALL:
            called = terms[k].which_function()
            if is_dot(called):
                slot[o[0]] = nodes.put("dot", *(slot[a] for a in i))
                continue
            _add_table(called, tables, [name for _, name in loads])
            slot[o[0]] = nodes.place(Node("table", (slot[i[0]],), name=called.name()))
        else:
            args = tuple(slot[a] for a in i)
            written_out = None if op in unary or op in binary else _WRITTEN_OUT.get(op)
            node = written_out(nodes, *args) if written_out else _operation(op, args, nodes, unary, binary)
            slot[o[0]] = nodes.place(node)
    return nodes, results


class _Nodes(list[Node]):
    """Nodes in the order of computation, each once."""

    def __init__(self) -> None:
        super().__init__()
        self.known: dict[Node, int] = {}

    def place(self, node: Node) -> int:
        if node not in self.known:
            self.known[node] = len(self)
            self.append(node)
        return self.known[node]

    def put(self, op: str, *args: int) -> int:
        return self.place(Node(op, args))

    def number(self, value: float) -> int:
        return self.place(Node("literal", value=value))


def _sign(p: _Nodes, x: int) -> Node:
    zero, one, minus_one = (p.number(v) for v in (0.0, 1.0, -1.0))
    return Node("choose", (p.put("lt", zero, x), one, p.put("choose", p.put("lt", x, zero), minus_one, zero)))


def _floor(p: _Nodes, x: int) -> Node:
    if p[x].op == "fabs" or (p[x].op == "max" and any(p[a].op == "literal" and p[a].value >= 0 for a in p[x].args)):
        return Node("floor", (x,))
    size = p.put("neg", x)
    whole = p.put("floor", size)
    down = p.put("neg", p.put("add", whole, p.put("lt", whole, size)))
    return Node("choose", (p.put("lt", x, p.number(0.0)), down, p.put("floor", x)))


def _copysign(p: _Nodes, x: int, y: int) -> Node:
    size = p.put("fabs", x)
    return Node("choose", (p.put("lt", y, p.number(0.0)), p.put("neg", size), size))


def _power(p: _Nodes, x: int, e: int) -> Node:
    halves = 2 * p[e].value
    if p[e].op != "literal" or halves != int(halves) or not 0 < abs(halves) <= MOST_HALVES:
        logarithm = p.number(log(p[x].value)) if p[x].op == "literal" and p[x].value > 0 else p.put("log", x)
        return Node("exp", (p.put("mul", e, logarithm),))
    product, square, n = p.put("sqrt", x) if halves % 2 else p.number(1.0), x, int(abs(halves)) // 2
    while n:
        product = p.put("mul", product, square) if n % 2 else product
        square, n = p.put("sq", square) if n > 1 else square, n // 2
    return Node("inv", (product,)) if halves < 0 else p[product]


MOST_HALVES = 64  # in an exponent that becomes products
WRITTEN_OUT = ("ceil", "copysign", "floor", "hypot", "pow", "sign")
_WRITTEN_OUT: dict[int, Callable[..., Node]] = {
    ca.OP_SIGN: _sign,
    ca.OP_FLOOR: _floor,
    ca.OP_CEIL: lambda p, x: Node("neg", (p.place(_floor(p, p.put("neg", x))),)),
    ca.OP_COPYSIGN: _copysign,
    ca.OP_HYPOT: lambda p, x, y: Node("sqrt", (p.put("add", p.put("sq", x), p.put("sq", y)),)),
    ca.OP_POW: _power,
    ca.OP_CONSTPOW: _power,
}


def _add_table(called: ca.Function, tables: dict[str, tuple[float, ...]], used_names: Sequence[str]) -> None:
    """Add a function's numbers to `tables`; raise EmitError unless it is a table of its own name."""
    name, steps = called.name(), range(called.n_instructions())
    if [called.instruction_id(k) for k in steps] != list(LOOKUP):
        raise EmitError(f"a law calls the function '{name}', which is not a table: write it out, or use block.table")
    numbers = tuple(called.instruction_MX(0).to_DM().full().ravel().tolist())
    if name in used_names or tables.get(name, numbers) != numbers:
        raise EmitError(f"table '{name}' has the name of another table, signal or constant: rename one of them")
    tables[name] = numbers


def _operation(
    op: int, args: tuple[int, ...], nodes: list[Node], unary: Mapping[int, str], binary: Mapping[int, str]
) -> Node:
    if op in unary:
        return Node(unary[op], args[:1])
    if op not in binary:
        known = ", ".join(sorted({*unary.values(), *binary.values(), *WRITTEN_OUT}))
        called = next((n for n, value in vars(ca).items() if n.startswith("OP_") and value == op), f"number {op}")
        raise EmitError(f"operation {called} of CasADi cannot be emitted as C: write the expression with {known}")
    if op == ca.OP_ADD:
        first, second = nodes[args[0]], nodes[args[1]]
        if first.op == second.op == "when":
            if nodes[second.args[0]] == Node("not", (first.args[0],)):
                return Node("choose", (first.args[0], first.args[1], second.args[1]))
            if nodes[first.args[0]] == Node("not", (second.args[0],)):
                return Node("choose", (second.args[0], second.args[1], first.args[1]))
    return Node(binary[op], args)


def _without_dead_nodes(p: Program) -> Program:
    """Dead-code elimination: return the program without nodes that no output needs, and without marks on them."""
    live = set(p.ends())
    for k in range(len(p.nodes) - 1, -1, -1):
        if k in live:
            live.update(p.nodes[k].args)
    index = {old: new for new, old in enumerate(sorted(live))}
    nodes = tuple(p.nodes[k].renumbered(index) for k in index)
    outputs, next = ({name: index[k] for name, k in ends.items()} for ends in (p.outputs, p.next))
    marks = tuple((named, index[k]) for named, k in p.marks if k in index)
    word = None if p.word is None else index[p.word]
    labels = {index[k]: name for k, name in p.labels.items() if k in index}
    returns = {name: index[k] for name, k in p.returns.items()}
    functions = {path: f.renumbered(index) for path, f in p.functions.items()}
    return replace(
        p, nodes=nodes, marks=marks, outputs=outputs, next=next, word=word, labels=labels, returns=returns,
        functions=functions,
    )  # fmt: skip


Array = NDArray[Any]

OPERATIONS: dict[str, Callable[..., Any]] = {
    "neg": np.negative,
    "inv": np.reciprocal,
    "sq": np.square,
    "twice": lambda a: a + a,
    "not": np.logical_not,
    "add": np.add,
    "sub": np.subtract,
    "mul": np.multiply,
    "div": np.divide,
    "fma": lambda a, b, c: a * b + c,  # rounded twice, unlike in C
    "dot": lambda *a: reduce(np.add, map(np.multiply, a[: len(a) // 2], a[len(a) // 2 :])),
    "min": np.minimum,
    "max": np.maximum,
    "lt": np.less,
    "le": np.less_equal,
    "eq": np.equal,
    "ne": np.not_equal,
    "and": np.logical_and,
    "or": np.logical_or,
    "when": lambda condition, a: np.where(condition, a, 0.0),
    "choose": np.where,
    "asin": np.arcsin,
    "acos": np.arccos,
    "atan": np.arctan,
    "asinh": np.arcsinh,
    "erf": erf,
    "atan2": np.arctan2,
    "remainder": np.vectorize(remainder, otypes=[np.float64]),
    **{
        name: getattr(np, name)
        for name in ("exp", "expm1", "log", "log1p", "sqrt", "sin", "cos", "tan", "sinh", "cosh")
    },
    **{name: getattr(np, name) for name in ("tanh", "fabs", "floor", "fmod")},
}


def evaluate(program: Program, targets: Iterable[int], known: Mapping[int, Array]) -> dict[int, Array]:
    """Return the values of the `targets` and of what they follow from; `known` has those of the loads, by node."""
    values, waiting = dict(known), list(targets)
    while waiting:
        k = waiting[-1]
        node = program.nodes[k]
        missing = [a for a in node.args if a not in values] if k not in values else []
        waiting += missing
        if missing:
            continue
        waiting.pop()
        if k not in values:
            arguments = [values[a] for a in node.args]
            values[k] = np.array(node.value) if node.op == "literal" else OPERATIONS[node.op](*arguments)
    return values
