"""Lanes: the C of one program for several machines side by side, one machine in each lane of a vector unit.

    for each lane l:   reals', counters', out, faults = step(reals, counters, in)    without a branch

A row of an array is one vector: the values of a signal in all lanes. Every value of a lane goes through the operations
that the program for a single machine has, in the same order and in the same type, so the bits are the same. A choice
evaluates both arms and selects; counters have the width of the scalar type. The constants of a step are read from an
array: controllers that differ in their gains alone share one compiled step.

Horner's rule for several variables at once: superword parallelism within the program of one machine.

    v_j = c_0 + t_j (c_1 + t_j (c_2 + ...)),   j = 1 .. m     one vector of m variables, the same coefficients

Chains of fused products with the same coefficients, and of which none needs the other, form a group. Each lane of the
vector goes through the operations of its chain, so the bits are the same. Larsen and Amarasinghe, Exploiting Superword
Level Parallelism with Multimedia Instruction Sets, PLDI 2000.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from synth.emit.c.expressions import literal
from synth.emit.program.lower import Node, Program
from synth.emit.program.operations import LIBM, LIBM_OF_TWO
from synth.emit.proof.ranges import kinds

WIDTHS = (2, 4, 8)  # doubles in a vector


@dataclass(frozen=True)
class Chain:
    """v = fma(t, ... fma(t, terms[0], terms[1]) ..., terms[-1]): the nodes of t, of the terms, and of v."""

    variable: int
    terms: tuple[int, ...]
    value: int


Group = tuple[Chain, ...]


def groups(program: Program) -> list[Group]:
    """Return the groups of two to eight chains."""
    chains, levels = _chains(program), _levels(program)
    alike: dict[tuple[int, tuple[int, ...]], list[Chain]] = {}
    for chain in chains:
        alike.setdefault((levels[chain.value], chain.terms), []).append(chain)
    parts = [tuple(each[k : k + WIDTHS[-1]]) for each in alike.values() for k in range(0, len(each), WIDTHS[-1])]
    return [part for part in parts if len(part) > 1]


def schedule(program: Program) -> list[int | Group]:
    """Return the nodes and groups of a memoryless function in an order of computation: each after all that it needs."""
    group_of = {chain.value: group for group in groups(program) for chain in group}
    order: list[int | Group] = []
    done = set[int]()
    waiting = [*program.outputs.values()]
    while waiting:
        k = waiting[-1]
        group = group_of.get(k)
        needs = program.nodes[k].args if group is None else {a for c in group for a in (c.variable, *c.terms)}
        missing = [a for a in needs if a not in done]
        waiting += missing
        if not missing:
            waiting.pop()
        if not missing and k not in done:
            order.append(k if group is None else group)
            done |= {k} if group is None else {chain.value for chain in group}
    return order


def _chains(program: Program) -> list[Chain]:
    """Return the longest chains of at least two fused products whose inner values nothing else reads."""
    users, chains = program.users(), dict[int, Chain]()
    for k, node in enumerate(program.nodes):
        if node.op != "fma":
            continue
        t, a, c = node.args
        before = chains.get(a)
        if before is not None and before.variable == t and users[a] == [k] and a not in program.outputs.values():
            del chains[a]
            chains[k] = Chain(t, (*before.terms, c), k)
        else:
            chains[k] = Chain(t, (a, c), k)
    return [chain for chain in chains.values() if len(chain.terms) > 2]


def _levels(program: Program) -> list[int]:
    """Return for each node the largest number of fused products on a path to it; it grows along every path."""
    levels: list[int] = []
    for node in program.nodes:
        levels.append((node.op == "fma") + max((levels[a] for a in node.args), default=0))
    return levels


def lines(group: Group, number: int, terms: Sequence[str]) -> list[str]:
    """Return the C of a group for one machine, with the `number` in its names; `terms` are doubles in C."""
    width = next(w for w in WIDTHS if w >= len(group))
    variables = [f"n{chain.variable}[0]" for chain in group]
    v, t, q = f"vd{width}", f"t{number}", f"q{number}"
    steps = [f"{q} = {v}_fma({t}, {q}, {v}_all({c}));" for c in terms[1:]]
    return [
        f"const {v} {t} = {{{', '.join(variables + variables[:1] * (width - len(group)))}}};",
        f"{v} {q} = {v}_all({terms[0]});",
        *steps,
        *(f"const vd n{chain.value} = {{{q}[{j}]}};" for j, chain in enumerate(group)),
    ]


TYPES: Mapping[type[np.floating], tuple[str, str, str]] = {
    np.float32: ("vf", "vuf", "vmf"),  # reals, counters, truth values
    np.float64: ("vd", "vud", "vmd"),
}
NUMBERS: Mapping[type[np.floating], str] = {np.float32: "float", np.float64: "double"}
SUPPORT = """/* The functions below are thousands of lines without a loop. These passes find nothing to do in
 * them, and took more than half of gcc's time. */
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("ira-region=one", "no-gcse", "no-tree-pre")
#endif
#if defined(__FMA__)
#include <immintrin.h>
#endif
typedef float vf __attribute__((vector_size(4 * LANES)));
typedef uint32_t vuf __attribute__((vector_size(4 * LANES)));
typedef int32_t vmf __attribute__((vector_size(4 * LANES)));
typedef double vd __attribute__((vector_size(8 * LANES)));
typedef uint64_t vud __attribute__((vector_size(8 * LANES)));
typedef int64_t vmd __attribute__((vector_size(8 * LANES)));
#define LANE_FUNCTIONS(v, u, m, real, whole) \\
    static inline v v##_all(real a) { return a - (v){0}; } \\
    static inline u u##_all(whole a) { return a - (u){0}; } \\
    static inline v v##_choose(m c, v a, v b) { return (v)(((m)a & c) | ((m)b & ~c)); } \\
    static inline u u##_choose(m c, u a, u b) { return (u)(((m)a & c) | ((m)b & ~c)); } \\
    static inline v v##_min(v a, v b) { return v##_choose(a < b, a, b); } \\
    static inline v v##_max(v a, v b) { return v##_choose(a > b, a, b); } \\
    static inline v v##_fabs(v a) { return (v)((m)a & ~(m)v##_all(-(real)0)); } \\
    static inline v v##_limit(v x, v high) { \\
        return v##_choose(v##_fabs(x) <= high, x, v##_choose(x < v##_all(0), -high, v##_fabs(high))); \\
    }
LANE_FUNCTIONS(vf, vuf, vmf, float, uint32_t)
LANE_FUNCTIONS(vd, vud, vmd, double, uint64_t)
static inline vd vd_fma(vd a, vd b, vd c) { /* rounded once, on every processor */
#if defined(__AVX512F__) && LANES == 8
    return (vd)_mm512_fmadd_pd((__m512d)a, (__m512d)b, (__m512d)c);
#else
    vd r;
    for (int l = 0; l < LANES; l++) r[l] = fma(a[l], b[l], c[l]);
    return r;
#endif
}
#define VECTOR_OF_CHAINS(v, n, fused) \\
    typedef double v __attribute__((vector_size(8 * n))); \\
    static inline v v##_all(double a) { return a - (v){0}; } \\
    static inline v v##_fma(v a, v b, v c) { return fused; }
#if LANES == 1 && defined(__AVX512F__)
VECTOR_OF_CHAINS(vd2, 2, (vd2)_mm_fmadd_pd((__m128d)a, (__m128d)b, (__m128d)c))
VECTOR_OF_CHAINS(vd4, 4, (vd4)_mm256_fmadd_pd((__m256d)a, (__m256d)b, (__m256d)c))
VECTOR_OF_CHAINS(vd8, 8, (vd8)_mm512_fmadd_pd((__m512d)a, (__m512d)b, (__m512d)c))
#elif LANES == 1
#define PAIR(i) fma(a[i], b[i], c[i]), fma(a[i + 1], b[i + 1], c[i + 1])
VECTOR_OF_CHAINS(vd2, 2, ((vd2){PAIR(0)}))
VECTOR_OF_CHAINS(vd4, 4, ((vd4){PAIR(0), PAIR(2)}))
VECTOR_OF_CHAINS(vd8, 8, ((vd8){PAIR(0), PAIR(2), PAIR(4), PAIR(6)}))
#endif
#define LANE_MATH(v, f) \\
    static inline v v##_##f(v a) { v r; for (int l = 0; l < LANES; l++) r[l] = f(a[l]); return r; }
#define LANE_MATH_OF_TWO(v, f) \\
    static inline v v##_##f(v a, v b) { v r; for (int l = 0; l < LANES; l++) r[l] = f(a[l], b[l]); return r; }
"""
INFIX = {"add": "+", "sub": "-", "mul": "*", "div": "/"}
COMPARED = {"lt": "<", "le": "<=", "eq": "==", "ne": "!="}


@dataclass(frozen=True)
class Rows:
    """The names of the rows of each array: inputs, real states, counters, parameters, outputs, constants, in order."""

    inputs: Sequence[str]
    reals: Sequence[str]
    counters: Sequence[str] = ()
    parameters: Sequence[str] = ()
    outputs: Sequence[str] = ()
    constants: Sequence[str] = ()


def step(name: str, program: Program, rows: Rows, scalar: type[np.floating]) -> str:
    """Return the C of a discrete step, which replaces the states of each lane and writes its outputs and faults.

    It reads the constants of `rows` from the array `constants`, the same in all lanes.
    """
    program = with_horner(program)
    lines = _Lanes(program, rows, scalar)
    v, u, _ = TYPES[scalar]
    stores = [f"x[{rows.reals.index(n)}] = {lines.real(k)};" for n, k in program.next.items() if n in rows.reals]
    stores += [
        f"counters[{rows.counters.index(n)}] = {lines.whole(k)};" for n, k in program.next.items() if n in rows.counters
    ]
    stores += [f"out[{rows.outputs.index(n)}] = {lines.real(k)};" for n, k in program.outputs.items()]
    stores.append(f"*faults = {f'{u}_all(0)' if program.word is None else lines.whole(program.word)};")
    arguments = f"{v} *x, {u} *counters, const {v} *in, const {NUMBERS[scalar]} *constants, {v} *out, {u} *faults"
    return _function(name, arguments, [*lines.texts, *stores], program, scalar)


def function(name: str, program: Program, rows: Rows, lanes: int) -> str:
    """Return the C of a memoryless function of states, inputs and parameters, in double.

    For one lane the vectors hold several polynomials of the function.
    """
    order = schedule(program) if lanes == 1 else None
    lines = _Lanes(program, rows, np.float64, order)
    stores = [f"out[{i}] = {lines.real(program.outputs[n])};" for i, n in enumerate(rows.outputs)]
    return _function(
        name, "const vd *x, const vd *in, const vd *p, vd *out", [*lines.texts, *stores], program, np.float64
    )


def _function(name: str, arguments: str, lines: Sequence[str], program: Program, scalar: type[np.floating]) -> str:
    body = "\n".join(f"    {line}" for line in lines)
    return f"static void {name}({arguments}) {{\n{body}\n}}\n"


def mathematics(programs: Sequence[tuple[Program, type[np.floating]]]) -> str:
    """Return the functions of libm that the programs call, lane by lane."""
    calls = {
        ("_OF_TWO" if n.op in LIBM_OF_TWO else "", TYPES[scalar][0], f"{n.op}{'f' if scalar is np.float32 else ''}")
        for program, scalar in programs
        for n in program.nodes
        if n.op in LIBM - {"fabs"}
    }
    return "\n".join(f"LANE_MATH{kind}({v}, {f})" for kind, v, f in sorted(calls))


def with_horner(program: Program) -> Program:
    """Return the program with each polynomial written out by Horner's rule, in the order of `c_text`."""
    nodes: list[Node] = []
    index: list[int] = []

    def place(node: Node) -> int:
        nodes.append(node)
        return len(nodes) - 1

    for node in program.nodes:
        args = tuple(index[a] for a in node.args)
        if node.op != "polynomial":
            index.append(place(replace(node, args=args)))
            continue
        *lower, value = program.polynomials[node.name].coefficients
        k = place(Node("literal", value=value))
        for c in reversed(lower):
            k = place(Node("mul", (args[0], k)))
            k = place(Node("add", (place(Node("literal", value=c)), k))) if c else k
        index.append(k)
    return replace(program.with_nodes(tuple(nodes), index), polynomials={})


class _Lanes:
    """The lines that compute every node of a program, one vector a node."""

    def __init__(
        self,
        program: Program,
        rows: Rows,
        scalar: type[np.floating],
        order: Sequence[int | Group] | None = None,
    ) -> None:
        self.p, self.kinds, self.rows, self.scalar = program, kinds(program), rows, scalar
        self.v, self.u, self.m = TYPES[scalar]
        self.texts: list[str] = []
        for number, item in enumerate(range(len(program.nodes)) if order is None else order):
            self.texts += self._node(item) if isinstance(item, int) else self._group(item, number)

    def _node(self, k: int) -> list[str]:
        node = self.p.nodes[k]
        if node.op in ("literal", "constant", "product"):
            return []
        t = {"logical": self.m, "integer": self.u}.get(self.kinds[k], self.v)
        return [f"const {t} n{k} = {self._of(k, node)};"]

    def _group(self, group: Group, number: int) -> list[str]:
        nodes = self.p.nodes
        terms = [
            literal(nodes[k].value, self.scalar).c if nodes[k].op == "literal" else f"n{k}[0]" for k in group[0].terms
        ]
        return lines(group, number, terms)

    def real(self, k: int) -> str:
        """Return node k as a number of the scalar type."""
        node = self.p.nodes[k]
        if node.op == "literal":
            return f"{self.v}_all({literal(node.value, self.scalar).c})"
        if node.op == "constant":
            return f"{self.v}_all(constants[{self.rows.constants.index(node.name)}])"
        if self.kinds[k] == "logical":
            return f"{self.v}_choose(n{k}, {self.v}_all(1), {self.v}_all(0))"
        return f"__builtin_convertvector(n{k}, {self.v})" if self.kinds[k] == "integer" else f"n{k}"

    def whole(self, k: int) -> str:
        """Return node k as a counter."""
        node = self.p.nodes[k]
        if node.op == "literal":
            return f"{self.u}_all({int(node.value)})"
        if self.kinds[k] == "logical":
            return f"(({self.u})n{k} & {self.u}_all(1))"
        return f"n{k}" if self.kinds[k] == "integer" else f"__builtin_convertvector({self.real(k)}, {self.u})"

    def truth(self, k: int) -> str:
        """Return node k as a mask."""
        if self.kinds[k] == "logical":
            return f"n{k}"
        return f"({self.whole(k)} != {self.u}_all(0))" if self.kinds[k] == "integer" else self._is_not_zero(k)

    def _is_not_zero(self, k: int) -> str:
        return f"({self.real(k)} != {self.v}_all(0))"

    def _of(self, k: int, node: Node) -> str:
        op, args = node.op, node.args
        if op in ("input", "state", "parameter"):
            return self._load(node)
        if op == "row":
            return self._row(self.p.nodes[args[0]], int(node.value))
        if op == "not":
            return f"~{self.truth(args[0])}"
        if op in ("and", "or"):
            return f" {'&' if op == 'and' else '|'} ".join(self.truth(a) for a in args)
        if op in ("choose", "when"):
            return self._choice(k, node)
        if op == "bit":
            return f"{self.whole(args[0])} | {self.u}_all({int(node.value)}u)"
        if op in COMPARED:
            counters = all(self.kinds[a] == "integer" or self._is_count(a) for a in args)
            first, second = (self.whole(a) if counters else self.real(a) for a in args)
            return f"{first} {COMPARED[op]} {second}"
        sides = [self.whole(a) if self.kinds[k] == "integer" else self.real(a) for a in args]
        return self._arithmetic(op, node, sides)

    def _is_count(self, k: int) -> bool:
        node = self.p.nodes[k]
        return node.op == "literal" and node.value >= 0 and float(node.value).is_integer()

    def _choice(self, k: int, node: Node) -> str:
        condition, then, *other = node.args
        kind = self.kinds[k]
        if kind == "logical":
            sides = [self._mask_of(a) for a in node.args[1:]]
            return f"({self.truth(condition)} & {sides[0]}) | (~{self.truth(condition)} & {sides[1]})"
        form, name = (self.whole, self.u) if kind == "integer" else (self.real, self.v)
        last = form(other[0]) if other else f"{name}_all(0)"
        return f"{name}_choose({self.truth(condition)}, {form(then)}, {last})"

    def _mask_of(self, k: int) -> str:
        node = self.p.nodes[k]
        return f"({self.m})({self.u}_all({-int(bool(node.value))}))" if node.op == "literal" else self.truth(k)

    def _arithmetic(self, op: str, node: Node, sides: Sequence[str]) -> str:
        if op in INFIX:
            return f"{sides[0]} {INFIX[op]} {sides[1]}"
        if op == "neg":
            return f"-{sides[0]}"
        if op == "sq":
            return f"{sides[0]} * {sides[0]}"
        if op == "twice":
            return f"{sides[0]} + {sides[0]}"
        if op == "inv":
            return f"{self.v}_all(1) / {sides[0]}"
        if op == "within":
            return sides[0]
        if op == "clamp":
            return f"{self.v}_limit({sides[0]}, {sides[2]})"
        if op == "floor":
            return f"__builtin_convertvector(__builtin_convertvector({sides[0]}, {self.u}), {self.v})"
        suffix = "f" if op in LIBM - {"fabs"} and self.scalar is np.float32 else ""
        return f"{self.v}_{op}{suffix}({', '.join(sides)})"

    def _row(self, product: Node, i: int) -> str:
        """Return a row of a product with a matrix, whose coefficients are those of the controller in these lanes."""
        texts = [
            f"constants[{self.rows.constants.index(c.name)}]" if c.op == "constant" else literal(c.value, self.scalar).c
            for c in self.p.matrices[product.name].coefficients[i]
        ]
        return " + ".join(f"{text} * {self.real(a)}" for text, a in zip(texts, product.args, strict=True))

    def _load(self, node: Node) -> str:
        rows = self.rows
        if node.op == "state" and node.name in rows.counters:
            return f"counters[{rows.counters.index(node.name)}]"
        array, names = {"input": ("in", rows.inputs), "state": ("x", rows.reals), "parameter": ("p", rows.parameters)}[
            node.op
        ]
        return f"{array}[{names.index(node.name)}]"
