"""Model of the arithmetic that C may use: every operation rounded, and randomly contracted multiply-adds.

It includes random programs, and random states at which to evaluate them.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from math import inf, nan
from typing import Any

import numpy as np
from hypothesis import strategies as st
from scipy import special

from synth.emit.approx.polynomial import Polynomial
from synth.emit.program.lower import Node, Program
from synth.emit.proof.ranges import Range

UNARY = ("neg", "fabs", "sq", "twice", "inv", "sqrt", "exp", "log", "sin", "cos", "tan", "asin", "acos", "atan")
UNARY += ("sinh", "cosh", "tanh", "not", "expm1", "log1p", "asinh", "erf")
BINARY = ("add", "sub", "mul", "div", "min", "max", "atan2", "lt", "le", "eq", "ne", "and", "or", "when")
BINARY += ("fmod", "remainder")
OFTEN = ("add", "sub", "mul", "le", "lt", "and", "choose", "min", "max", "fabs", "when")
CUBIC = Polynomial(-2, 2, 0, 1, "none", (0.25, -1.5, 0.0, 0.75), np.float32)
VANISHING = Polynomial(-2, 2, 0, 1, "none", (0.0, 2.0, -0.3125), np.float32)
POLYNOMIALS = {"cubic": CUBIC, "vanishing": VANISHING}
LIBM_UNITS = 3  # simulated error of libm in units in the last place, beyond the rounding of the double: 4 in all
LIBM = ("exp", "log", "sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh", "atan2")
LIBM += ("expm1", "log1p", "asinh", "erf")
_NUMPY = {"asin": "arcsin", "acos": "arccos", "atan": "arctan", "atan2": "arctan2", "asinh": "arcsinh"}
_PLAIN: dict[str, Callable[..., Any]] = {
    "neg": lambda a: -a,
    "fabs": abs,
    "add": lambda a, b: a + b,
    "sub": lambda a, b: a - b,
    "mul": lambda a, b: a * b,
    "sq": lambda a: a * a,
    "twice": lambda a: a + a,
    "div": lambda a, b: a / b,
    "inv": lambda a: type(a)(1) / a,
    "sqrt": np.sqrt,
    "min": lambda a, b: a if a < b else b,
    "max": lambda a, b: a if a > b else b,
    "lt": lambda a, b: a < b,
    "le": lambda a, b: a <= b,
    "eq": lambda a, b: a == b,
    "ne": lambda a, b: a != b,
    "and": lambda a, b: a != 0 and b != 0,
    "or": lambda a, b: a != 0 or b != 0,
    "not": lambda a: a == 0,
    "floor": np.floor,
    "fmod": np.fmod,
    "remainder": lambda a, b: type(a)(math.remainder(a, b) if np.isfinite(a) and b != 0 else nan),
}


def rounded(exact: Fraction, scalar: type[np.floating]) -> np.floating:
    """Return a fraction rounded once to the scalar type."""
    try:
        near = np.float64(exact.numerator / exact.denominator)  # Python rounds this quotient correctly
    except OverflowError:
        near = np.float64(np.inf if exact > 0 else -np.inf)
    if scalar is np.float32 and np.isfinite(near) and Fraction(float(near)) != exact and not near.view(np.int64) & 1:
        # Round to odd: then the second rounding is correct.
        near = np.nextafter(near, np.inf if Fraction(float(near)) < exact else -np.inf)
    return scalar(near)


def function(name: str, args: Sequence[np.floating], rng: np.random.Generator | None) -> np.floating:
    """Return a value that libm may return: rounded from double, with an error of a few units in the last place."""
    scalar = type(args[0])
    value = scalar(
        (special.erf if name == "erf" else getattr(np, _NUMPY.get(name, name)))(*(np.float64(a) for a in args))
    )
    if rng is None or value == 0 or not np.isfinite(value):
        return value
    perturbed = value
    for _ in range(rng.integers(LIBM_UNITS + 1)):
        perturbed = np.nextafter(perturbed, scalar(rng.choice([-np.inf, np.inf])))
    return perturbed if perturbed == 0 or np.sign(perturbed) == np.sign(value) else value


class _Step:
    """One computation of a program; `exact` holds products that a compiler may leave unrounded."""

    def __init__(self, program: Program, scalar: type[np.floating], rng: np.random.Generator | None) -> None:
        self.program, self.scalar, self.rng = program, scalar, rng
        self.values: list[np.floating] = []
        self.exact: dict[int, Fraction] = {}

    def add(self, node: Node, loads: Mapping[str, float]) -> None:
        k = len(self.values)
        if node.op in ("input", "state", "constant"):
            value = self.scalar(loads[node.name])
        elif node.op == "literal":
            value = self.scalar(node.value)
        elif node.op in ("choose", "when"):
            position = 1 if self.values[node.args[0]] != 0 else 2
            value = self._passed(k, node.args[position]) if position < len(node.args) else self.scalar(0)
        else:
            value = self._operation(k, node, [self.values[a] for a in node.args])
        self.values.append(self.scalar(value))

    def _operation(self, k: int, node: Node, args: list[np.floating]) -> Any:
        if node.op in LIBM:
            return function(node.op, args, self.rng)
        if node.op == "polynomial":
            return self._polynomial(k, self.program.polynomials[node.name].coefficients, args[0])
        if node.op in ("mul", "sq", "twice"):
            factors = (args[0], self.scalar(2)) if node.op == "twice" else (args[0], args[-1])
            self._product(k, *factors)
        if node.op in ("add", "sub") and (total := self._sum(node, args)) is not None:
            return total
        if node.op in ("min", "max"):
            first = args[0] < args[1] if node.op == "min" else args[0] > args[1]
            return self._passed(k, node.args[0 if first else 1])
        if node.op == "clamp":
            return (
                self._passed(k, node.args[0]) if abs(args[0]) <= args[2] else args[1] if args[0] < 0 else abs(args[2])
            )
        if node.op == "bit":
            return args[0] + self.scalar(node.value)
        if node.op == "neg" and node.args[0] in self.exact:
            self.exact[k] = -self.exact[node.args[0]]
        return _PLAIN[node.op](*args)

    def _passed(self, k: int, a: int) -> np.floating:
        if a in self.exact:
            self.exact[k] = self.exact[a]
        return self.values[a]

    def _product(self, k: int, a: np.floating, b: np.floating) -> None:
        if np.isfinite(a) and np.isfinite(b):
            self.exact[k] = Fraction(float(a)) * Fraction(float(b))

    def _sum(self, node: Node, args: list[np.floating]) -> np.floating | None:
        candidates = [i for i in (0, 1) if node.args[i] in self.exact and np.isfinite(args[1 - i])]
        if self.rng is None or not candidates or self.rng.random() < 0.3:
            return None
        i = int(self.rng.choice(candidates))
        sides = [self.exact[node.args[i]] if j == i else Fraction(float(args[j])) for j in (0, 1)]
        return rounded(sides[0] + sides[1] if node.op == "add" else sides[0] - sides[1], self.scalar)

    def _polynomial(self, k: int, coefficients: Sequence[float], v: np.floating) -> np.floating:
        q = self.scalar(coefficients[-1])
        for c in coefficients[-2::-1]:
            self.exact.pop(k, None)
            self._product(k, v, q)
            if not c:
                q = v * q
            elif k in self.exact and self.rng is not None and self.rng.random() < 0.5:
                q = rounded(self.exact.pop(k) + Fraction(c), self.scalar)
            else:
                self.exact.pop(k, None)
                q = self.scalar(c) + v * q
        return q


def compute(
    program: Program, loads: Mapping[str, float], scalar: type[np.floating], rng: np.random.Generator | None = None
) -> list[np.floating]:
    """Return the value of each node; with `rng` some sums are contracted and libm has random errors."""
    step = _Step(program, scalar, rng)
    with np.errstate(all="ignore"):
        for node in program.nodes:
            step.add(node, loads)
    return step.values


def outside_range(values: Sequence[np.floating], ranges: Sequence[Range]) -> list[int]:
    """Return the nodes whose value is not in its range."""
    return [
        k
        for k, (v, r) in enumerate(zip(values, ranges, strict=True))
        if not (r.nan if np.isnan(v) else r.low <= v <= r.high)
    ]


NUMBERS = st.one_of(
    st.integers(-4, 4).map(lambda n: n / 2), st.floats(-100, 100, width=32), st.sampled_from([1e-30, 3e38])
)


@st.composite
def programs(draw: st.DrawFn) -> tuple[Program, dict[str, Range]]:
    """Draw a program of inputs (one of any bit pattern), a state, a counter, a constant and literals."""
    nodes = [Node("input", name=n) for n in ("a", "b", "guarded")]
    nodes += [Node("state", name="x"), Node("state", name="n"), Node("constant", name="k")]
    nodes += [Node("literal", value=draw(NUMBERS)) for _ in range(3)]
    box = {n: Range(*sorted((draw(NUMBERS), draw(NUMBERS)))) for n in ("a", "b", "x")}
    k = draw(NUMBERS)
    box |= {"guarded": Range(-inf, inf, True), "n": Range(0, 5), "k": Range(k, k)}
    for _ in range(draw(st.integers(2, 16))):
        op = draw(st.one_of(st.sampled_from(OFTEN), st.sampled_from((*UNARY, *BINARY, "polynomial", "clamp"))))
        count = {"choose": 3, "polynomial": 1}.get(op, 1 if op in UNARY else 2)
        args = tuple(draw(st.integers(0, len(nodes) - 1)) for _ in range(count))
        if op == "clamp":
            nodes.append(Node("neg", args[1:]))
            args = (args[0], len(nodes) - 1, args[1])
        nodes.append(Node(op, args, name=draw(st.sampled_from(tuple(POLYNOMIALS))) if op == "polynomial" else ""))
    return Program(tuple(nodes), (), {"y": len(nodes) - 1}, {}, frozenset({"n"}), None, POLYNOMIALS), box


def states(program: Program, box: dict[str, Range], rng: np.random.Generator, count: int) -> list[dict[str, float]]:
    """Return random loads within the box: its ends, the values of the program's literals, and others."""
    special = [nan, inf, -inf, 0.0, -0.0, 3.4e38, 1e-45, *(n.value for n in program.nodes if n.op == "literal")]

    def one(r: Range, whole: bool) -> float:
        if whole:
            return float(rng.integers(int(r.low), int(r.high) + 1))
        sample = rng.choice([r.low, r.high, rng.choice(special), r.low + rng.random() * (r.high - r.low)])
        if r.nan:
            return float(rng.choice([rng.choice(special), rng.normal() * 10.0 ** rng.integers(-3, 4)]))
        return float(np.clip(sample, r.low, r.high)) if sample == sample else r.low

    return [{n: one(r, n in program.integers) for n, r in box.items()} for _ in range(count)]
