"""A plant for fast simulation: polynomials, fitted to each set of parameters, for its functions of one variable.

`univariate_fits` states the polynomials. Their variable is an expression that every path from the states to the
function passes through, such as the gap of a motor; their degree is chosen on plants at the corners of their
tolerances. Functions that are the same but for their variable share coefficients. A sine stays one of any argument,
see `sines`, where that costs less. Expressions of the parameters alone are evaluated once for each plant. The rest of
the plant is left as it is.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from synth.emit.program import lower, numeric
from synth.emit.program.lower import Node, Program
from synth.emit.proof import ranges
from synth.emit.proof.ranges import Range
from synth.plant import Plant
from synth.signals import Signal, signal_names
from synth.simulate.lanes import sines, univariate_fits
from synth.simulate.lanes.univariate_fits import Fit

Array = NDArray[np.float64]

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
            c = univariate_fits.interpolate(self.lowered, fit, known)
            rows.append(np.broadcast_to(c, (len(c), len(plants))))
            error = np.maximum(error, univariate_fits.largest_error(self.lowered, fit, c, known))
        for each in self.expressions:
            values = numeric.evaluate(each.source, each.nodes.values(), _by_node(each.source, self.plant, p))
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
    for group in univariate_fits.equal_functions(f, R):
        low, high = min(R[each.variable].low for each in group), max(R[each.variable].high for each in group)
        fit = univariate_fits.least_degree(f, group[0], known, low, high, error)
        if fit and fit.degree <= SINE * univariate_fits.number_of_sines(f, group[0]):
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
    tolerance = np.array([q.tolerance for q in plant.parameters])
    names = signal_names(plant.parameters)
    values = plant.values * (1 + signs * tolerance)
    return [plant, *(plant.with_parameters(**dict(zip(names, row.tolist(), strict=True))) for row in values)]


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
            elif n.op in univariate_fits.SINES and varies[k]:
                index[k] = sines.place_sine(place, n.op, index[n.args[0]], error)
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
