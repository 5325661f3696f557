"""A plant for fast simulation: polynomials, fitted to each set of parameters, for its functions of one variable.

The fits of one variable state the polynomials. Their variable is an expression that every path from the states to the
function passes through, such as the gap of a motor; their degree is chosen on plants at the corners of their
tolerances. Functions that are the same but for their variable share coefficients. A sine stays one of any argument,
where that costs less. Expressions of the parameters alone are evaluated once for each plant. The rest of
the plant is left as it is.

Sine and cosine of any argument without a branch, for plants in lanes.

    k = nearest whole number to a/(2 pi),   r = a - 2 pi k in -pi .. pi
    sin a -> r S(r^2),   cos a -> C(r^2)        S, C of the least degree with at most a given error

2 pi is subtracted in two parts by products and sums that are rounded once in C, so the reduction costs no digit while k
is below 2^20 or so. Cody and Waite, Software Manual for the Elementary Functions, 1980, chapter 8.

Polynomials for functions of one variable of a lowered program, one for each set of parameters.

    f(v; p) -> sum_j c_j(p) t^j,   t = (2 v - low - high)/(high - low),   v in low .. high

Chebyshev interpolation gives the coefficients; the least degree is taken whose error, measured between the nodes on
some sets of parameters, is below a bound relative to the largest |f|.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import NamedTuple, Protocol

import casadi as ca
import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from synth.emit.passes import univariate
from synth.emit.passes.univariate import Univariate
from synth.emit.program import lower
from synth.emit.program.lower import Node, Program
from synth.emit.proof import ranges
from synth.emit.proof.ranges import Range
from synth.plant import Plant
from synth.signals import Signal, signal_names

Array = NDArray[np.float64]

SINE_DEGREES = range(3, 14)
TURN = 2 * np.pi
TURN_LOW = 2.4492935982947064e-16  # 2 pi less its double
MAGIC = 1.5 * 2.0**52  # a + MAGIC - MAGIC is the whole number nearest to a
_SQUARE = np.pi**2


class Place(Protocol):
    """Append a node to a program, and return its number."""

    def __call__(self, op: str, *args: int, value: float = 0.0, name: str = "") -> int:
        """Return the number of the node."""
        ...


def place_sine(place: Place, op: str, argument: int, error: float) -> int:
    """Append the nodes of the "sin" or "cos" of a node, and return the last; both of one node share their reduction."""
    turns = place("mul", argument, place("literal", value=1 / TURN))
    magic = place("literal", value=MAGIC)
    k = place("sub", place("add", turns, magic), magic)
    r = place("fma", k, place("literal", value=-TURN), argument)
    r = place("fma", k, place("literal", value=-TURN_LOW), r)
    square = place("sq", r)
    *lower, last = coefficients(op, error)
    value = place("literal", value=last)
    for c in reversed(lower):
        value = place("fma", square, value, place("literal", value=c))
    return place("mul", r, value) if op == "sin" else value


@cache
def coefficients(op: str, error: float) -> tuple[float, ...]:
    """Return S or C, lowest power first, by Chebyshev interpolation in r^2."""
    function = _sine_over_angle if op == "sin" else _cosine
    square = np.linspace(0.0, _SQUARE, 1001)
    scale = np.sqrt(square) if op == "sin" else 1.0
    for degree in SINE_DEGREES:
        c = _interpolate(function, degree)
        if np.abs(scale * (np.polynomial.polynomial.polyval(square, c) - function(square))).max() <= error:
            break
    return tuple(c.tolist())


def _interpolate(function: Callable[[Array], Array], degree: int) -> Array:
    series = chebyshev.Chebyshev.interpolate(function, degree, domain=(0.0, _SQUARE))
    return np.asarray(series.convert(kind=np.polynomial.Polynomial).coef)


def _sine_over_angle(square: Array) -> Array:
    return np.asarray(np.sinc(np.sqrt(square) / np.pi))


def _cosine(square: Array) -> Array:
    return np.asarray(np.cos(np.sqrt(square)))


DEGREES = range(4, 31)
SINES = frozenset({"sin", "cos"})


@dataclass(frozen=True, eq=False)
class Fit:
    """A polynomial of `degree` in t for a function of the lowered program, on low .. high of its variable."""

    function: Univariate
    low: float
    high: float
    degree: int

    def variable(self, t: Array) -> Array:
        """Return the variable at t in -1 .. 1."""
        return 0.5 * ((self.high - self.low) * t + (self.high + self.low))


def equal_functions(program: Program, R: Sequence[Range]) -> list[list[Univariate]]:
    """Return the functions of one variable in groups that are the same but for their variable; R are the ranges."""
    groups: dict[str, list[Univariate]] = {}
    for f in univariate.find(program, R):
        groups.setdefault(_key(program, f), []).append(f)
    return list(groups.values())


def _key(program: Program, f: Univariate) -> str:
    """Return the expression of a function in its variable; equal functions of different variables have equal keys.

    The rows follow the expression, not the order of the program's nodes.
    """
    place, rows, waiting = {f.variable: 0}, list[tuple[object, ...]](), [f.root]
    while waiting:
        k = waiting[-1]
        node = program.nodes[k]
        missing = [] if k in place else [a for a in node.args if a not in place]
        waiting += missing[::-1]
        if not missing:
            waiting.pop()
        if not missing and k not in place:
            place[k] = len(place)
            rows.append((node.op, *(place[a] for a in node.args), node.name, node.value))
    return repr(rows)


def number_of_sines(program: Program, f: Univariate) -> float:
    """Return how many sines and cosines make up a function, infinity if it has another function of libm."""
    inner, waiting = set[int](), [f.root]
    while waiting:
        k = waiting.pop()
        if k != f.variable and k not in inner:
            inner.add(k)
            waiting += program.nodes[k].args
    ops = [program.nodes[k].op for k in inner]
    others = univariate.TRANSCENDENTAL - SINES
    return np.inf if any(op in others for op in ops) else sum(op in SINES for op in ops)


def least_degree(
    program: Program, f: Univariate, known: Mapping[int, Array], low: float, high: float, error: float
) -> Fit | None:
    """Return the fit of the least degree with at most this error, or None; `known` has the parameters\' values."""
    for degree in DEGREES:
        fit = Fit(f, low, high, degree)
        if largest_error(program, fit, interpolate(program, fit, known), known).max() <= error:
            return fit
    return None


def _values(program: Program, fit: Fit, t: Array, known: Mapping[int, Array]) -> Array:
    """Return the function (points, plants) at t."""
    variable = {fit.function.variable: fit.variable(t)[:, np.newaxis]}
    return np.asarray(lower.evaluate(program, [fit.function.root], {**known, **variable})[fit.function.root])


def interpolate(program: Program, fit: Fit, known: Mapping[int, Array]) -> Array:
    """Return the coefficients (degree + 1, plants), lowest power first."""
    n = fit.degree + 1
    angle = np.pi * (np.arange(n) + 0.5) / n
    values = _values(program, fit, np.cos(angle), known)
    series = _weighted_sums(np.array([np.cos(j * angle) for j in range(n)]), values)
    series = series * np.where(np.arange(n), 2.0, 1.0)[:, np.newaxis] / n
    return _weighted_sums(_powers(n).T, series)


@cache
def _powers(n: int) -> Array:
    """Return the coefficients of the first n Chebyshev polynomials in their rows, lowest power first."""
    return np.array([np.pad(chebyshev.cheb2poly(row), (0, n - 1 - j)) for j, row in enumerate(np.eye(n))])


def _weighted_sums(weights: Array, rows: Array) -> Array:
    """Return weights (m, n) times rows (n, plants) in a fixed order: a matrix product rounds as its library decides."""
    total = np.zeros((len(weights), *rows.shape[1:]))
    for weight, row in zip(weights.T, rows, strict=True):
        total = total + weight[:, np.newaxis] * row
    return total


def largest_error(program: Program, fit: Fit, coefficients: Array, known: Mapping[int, Array]) -> Array:
    """Return the largest error (plants,) between the nodes, relative to the largest value."""
    t = np.linspace(-1.0, 1.0, 4 * fit.degree + 1)
    value = np.zeros((len(t), 1)) + coefficients[-1]
    for c in coefficients[-2::-1]:
        value = c + t[:, np.newaxis] * value
    truth = _values(program, fit, t, known)
    return np.asarray(np.abs(value - truth).max(axis=0) / np.abs(truth).max(axis=0))


ERROR = 1e-10  # of a polynomial, relative to the largest value of its function
MARGIN = 0.05  # of a signal's range, added at both ends: the stages of an integration step leave the range
SINE = 10  # the degree of a polynomial that costs as much as a sine of any argument
CORNERS = 16  # plants at corners of their tolerances on which a degree is chosen
OUTSIDE = "outside"  # the output that is 1 where a variable has left the range of its polynomials


class Coefficients(NamedTuple):
    """The values of a fast plant's parameters (parameters, plants), and the error of its polynomials (plants,)."""

    values: Array
    error: Array


@dataclass(frozen=True, eq=False)
class _Expressions:
    """A program, the same with a load for each expression of the parameters alone, and the nodes of these by name."""

    source: Program
    program: Program
    nodes: Mapping[str, int]


@dataclass(frozen=True, eq=False)
class FastPlant:
    """Programs `f` and `h` in the states, the inputs and `parameters`, one form for every set of physical parameters.

    The outputs of `f` are the derivatives by state, and OUTSIDE. `degrees` are those of the polynomials, `error` bounds
    their error at the corners of the tolerances.
    """

    plant: Plant
    error: float
    lowered: Program
    fits: tuple[Fit, ...]
    expressions: tuple[_Expressions, _Expressions]

    @property
    def f(self) -> Program:
        """The derivatives."""
        return self.expressions[0].program

    @property
    def h(self) -> Program:
        """The outputs."""
        return self.expressions[1].program

    @property
    def degrees(self) -> tuple[int, ...]:
        """The degrees of the polynomials."""
        return tuple(fit.degree for fit in self.fits)

    @property
    def parameters(self) -> tuple[str, ...]:
        """The names of the parameters of f and h: coefficients of polynomials and expressions of physical ones."""
        coefficients = [_coefficient(i, j) for i, degree in enumerate(self.degrees) for j in range(degree + 1)]
        return (*coefficients, *(name for each in self.expressions for name in each.nodes))

    @property
    def second_order(self) -> dict[str, str]:
        """The velocity of each position where the states are q and v = dq/dt, and dv/dt depends on no v; else {}."""
        f = self.f
        pairs = {q: f.nodes[k].name for q, k in f.outputs.items() if f.nodes[k].op == "state"}
        velocities = {*pairs.values()}
        accelerations = [f.outputs[v] for v in velocities]
        loads = {f.nodes[k].name for k in _ancestors(f, accelerations) if f.nodes[k].op == "state"}
        complete = {*pairs} | velocities == {*signal_names(self.plant.states)} and len(velocities) == len(pairs)
        return pairs if complete and velocities.isdisjoint(pairs) and velocities.isdisjoint(loads) else {}

    def coefficients(self, plants: Sequence[Plant]) -> Coefficients:
        """Return the parameters' values for plants that differ from this one in their physical parameters."""
        p = np.array([plant.values for plant in plants], dtype=np.float64).T
        known = _by_node(self.lowered, self.plant, p)
        rows, error = [np.zeros((0, len(plants)))], np.zeros(len(plants))
        for fit in self.fits:  # one column serves every plant where the function depends on no parameter
            c = interpolate(self.lowered, fit, known)
            rows.append(np.broadcast_to(c, (len(c), len(plants))))
            error = np.maximum(error, largest_error(self.lowered, fit, c, known))
        for each in self.expressions:
            values = lower.evaluate(each.source, each.nodes.values(), _by_node(each.source, self.plant, p))
            rows += [np.broadcast_to(values[k], (1, len(plants))) for k in each.nodes.values()]
        return Coefficients(np.vstack(rows), error)


def fast_plant(plant: Plant, error: float = ERROR) -> FastPlant:
    """Return the fast form of a plant; `error` bounds that of each polynomial, relative to its largest value.

    A function that no polynomial of degree 30 approximates stays as it is.

    Raises EmitError for an operation without a form in C.
    """
    f, h = _lower(plant, plant.f, plant.states), _lower(plant, plant.h, plant.outputs)
    corners = np.array([each.values for each in _corners(plant)]).T
    R = ranges.analyse(f, _bounds(plant, corners), np.float64)
    known = _by_node(f, plant, corners)
    fits: list[Fit] = []
    replaced: dict[int, tuple[int, int]] = {}
    for group in equal_functions(f, R):
        low, high = min(R[each.variable].low for each in group), max(R[each.variable].high for each in group)
        fit = least_degree(f, group[0], known, low, high, error)
        if fit and fit.degree <= SINE * number_of_sines(f, group[0]):
            replaced |= {each.root: (each.variable, len(fits)) for each in group}
            fits.append(fit)
    f_fast, h_fast = _rewritten(f, replaced, fits, error), _rewritten(h, {}, (), error)
    expressions = (_hoist_parameters(f_fast, "f"), _hoist_parameters(h_fast, "h"))
    return FastPlant(plant, error, f, tuple(fits), expressions)


def _lower(plant: Plant, function: ca.Function, results: Sequence[Signal]) -> Program:
    """Return a function of (x, u, p) as a program; the parameters are its constants."""
    groups: dict[str, tuple[str, ...]] = {
        "state": signal_names(plant.states),
        "input": signal_names(plant.inputs),
        "constant": signal_names(plant.parameters),
    }
    symbols = [ca.SX.sym(kind, len(names)) for kind, names in groups.items()]
    loads = [(kind, name) for kind, names in groups.items() for name in names]
    expressions = ca.cse([ca.densify(function(*symbols))])
    nodes, ends = lower.walk(ca.Function("plant", [ca.vcat(symbols)], expressions), loads, {})
    return Program(tuple(nodes), (), dict(zip(signal_names(results), ends, strict=True)), {})


def _corners(plant: Plant) -> list[Plant]:
    """Return the plant and others at random corners of the tolerances of its parameters."""
    signs = np.random.default_rng(0).choice([-1.0, 1.0], (CORNERS, len(plant.parameters)))
    rows = [{q.name: q.at(s) for q, s in zip(plant.parameters, row, strict=True)} for row in signs.tolist()]
    return [plant, *(plant.with_parameters(**row) for row in rows)]


def _bounds(plant: Plant, p: Array) -> dict[str, Range]:
    bounds = {}
    for signal in (*plant.states, *plant.inputs):
        margin = MARGIN * (signal.high - signal.low)
        bounds[signal.name] = Range(signal.low - margin, signal.high + margin)
    ends = zip(p.min(axis=1).tolist(), p.max(axis=1).tolist(), strict=True)
    return bounds | {q.name: Range(low, high) for q, (low, high) in zip(plant.parameters, ends, strict=True)}


def _by_node(program: Program, plant: Plant, p: Array) -> dict[int, Array]:
    """Return the values (plants,) of the physical parameters by node."""
    rows = dict(zip(signal_names(plant.parameters), p, strict=True))
    return {k: rows[n.name] for k, n in enumerate(program.nodes) if n.op == "constant"}


def _coefficient(fit: int, power: int) -> str:
    return f"c{fit}_{power}"


def _rewritten(program: Program, replaced: Mapping[int, tuple[int, int]], fits: Sequence[Fit], error: float) -> Program:
    """Return the program with polynomials, sines and the output OUTSIDE; `replaced` maps a root to (variable, fit)."""
    nodes: list[Node] = []
    known: dict[Node, int] = {}
    index: dict[int, int] = {}
    varies = _varies(program)

    def place(op: str, *args: int, value: float = 0.0, name: str = "") -> int:
        node = Node(op, args, value, name)
        if node not in known:
            known[node] = len(nodes)
            nodes.append(node)
        return known[node]

    def place_polynomial(variable: int, number: int) -> int:
        fit = fits[number]
        centred = place("sub", index[variable], place("literal", value=0.5 * (fit.low + fit.high)))
        t = place("mul", centred, place("literal", value=2.0 / (fit.high - fit.low)))
        *lower_powers, value = (place("parameter", name=_coefficient(number, j)) for j in range(fit.degree + 1))
        for c in reversed(lower_powers):
            value = place("fma", t, value, c)
        return value

    waiting = list(program.outputs.values())
    while waiting:
        k = waiting.pop()
        needs = (replaced[k][0],) if k in replaced else program.nodes[k].args
        if missing := [a for a in needs if a not in index]:
            waiting += [k, *missing]
        elif k not in index:
            n = program.nodes[k]
            if k in replaced:
                index[k] = place_polynomial(*replaced[k])
            elif n.op in SINES and varies[k]:
                index[k] = place_sine(place, n.op, index[n.args[0]], error)
            elif n.op == "div" and varies[n.args[0]] and not varies[n.args[1]]:
                index[k] = place("mul", index[n.args[0]], place("inv", index[n.args[1]]))
            else:
                index[k] = place(n.op, *(index[a] for a in n.args), value=n.value, name=n.name)
    outside = place("literal", value=0.0)
    for variable, number in dict.fromkeys(replaced.values()):
        low, high = (place("literal", value=end) for end in (fits[number].low, fits[number].high))
        within = place("and", place("le", low, index[variable]), place("le", index[variable], high))
        outside = place("choose", within, outside, place("literal", value=1.0))
    outputs = {name: index[k] for name, k in program.outputs.items()} | {OUTSIDE: outside}
    return Program(tuple(nodes), (), outputs, {})


def _ancestors(program: Program, ends: Sequence[int]) -> set[int]:
    """Return the nodes from which the ends follow, themselves included."""
    reached, waiting = set[int](), list(ends)
    while waiting:
        k = waiting.pop()
        if k not in reached:
            reached.add(k)
            waiting += program.nodes[k].args
    return reached


def _varies(program: Program) -> list[bool]:
    """Return for each node whether it depends on more than the physical parameters."""
    varies: list[bool] = []
    for n in program.nodes:
        varies.append(n.op in ("state", "input", "parameter") or any(varies[a] for a in n.args))
    return varies


def _hoist_parameters(program: Program, prefix: str) -> _Expressions:
    """Return the program with a load for each expression of parameters alone that the rest reads."""
    varies = _varies(program)
    users, ends = program.users(), {*program.outputs.values()}
    fixed = {
        f"{prefix}{k}": k
        for k, n in enumerate(program.nodes)
        if not varies[k] and n.op != "literal" and (k in ends or any(varies[u] for u in users[k]))
    }
    names = {k: name for name, k in fixed.items()}
    nodes = (Node("parameter", name=names[k]) if k in names else n for k, n in enumerate(program.nodes))
    return _Expressions(program, program.with_nodes(tuple(nodes), range(len(program.nodes))), fixed)
