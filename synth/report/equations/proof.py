"""Test of displayed equations: each SymPy expression, as printed, must agree with CasADi at POINTS random points.

Definitions are evaluated in their order. Derivatives, outputs, named signals and next states are compared, to TOLERANCE
of the largest value of each.
"""

from collections.abc import Callable, Mapping, Sequence
from functools import reduce

import casadi as ca
import numpy as np
import sympy as sp
from scipy.special import erf

from synth.block import Block
from synth.emit.program import lower
from synth.errors import DesignError, ModelError
from synth.plant import Plant
from synth.report.equations import derive
from synth.report.equations.derive import Equation, Group, NamedTerms
from synth.signals import Signal
from synth.statespace import Array

Values = Mapping[str, Array]
POINTS, TOLERANCE, SEED = 48, 1e-9, 7
SPREAD = 0.05  # relative variation of parameters and constants
RANGE_DECADES = 4  # powers of ten by which the inputs of a Block exceed their ranges in half of the points

FUNCTIONS: Mapping[str, Callable[..., Array]] = {
    **{n: getattr(np, n) for n in ("sin", "cos", "tan", "sinh", "cosh", "tanh", "exp", "log", "hypot", "log1p")},
    **{n: getattr(np, f"arc{n[1:]}") for n in ("asin", "acos", "atan", "asinh", "acosh", "atanh", "atan2")},
    **{n: getattr(np, n) for n in ("expm1", "floor", "ceil", "sign")},
    "Abs": np.abs,
    "Pow": np.float_power,
    "min": np.fmin,
    "max": np.fmax,
    "mod": np.fmod,
    "remainder": lower.OPERATIONS["remainder"],
    "erf": erf,
    "lt": np.less,
    "le": np.less_equal,
    "eq": np.equal,
    "ne": np.not_equal,
    "and": np.logical_and,
    "or": np.logical_or,
    "not": np.logical_not,
    "Add": lambda *terms: reduce(np.add, terms),
    "Mul": lambda *factors: reduce(np.multiply, factors),
    "choose": lambda condition, chosen, otherwise: np.select([condition != 0], [chosen], otherwise),
    "sat": lambda v, low, high: np.fmax(np.fmin(v, high), low),
}


def plant(plant: Plant, groups: Sequence[Group], terms: NamedTerms | None = None) -> None:
    """Check displayed equations against a plant; raise ModelError that names the first different equation."""
    f, places = derive.plant_function(plant, terms)
    rng = np.random.default_rng(SEED)
    values = np.array([p.value for p in plant.parameters])
    points = np.vstack([_inside([*plant.states, *plant.inputs], rng), _perturbations(values, rng)])
    names = [s.name for group in (plant.states, plant.inputs, plant.parameters) for s in group]
    computed = _at(f, points)
    expected = {name: computed[k] for name, k in places.items()}
    check(f"plant '{plant.name}'", groups, dict(zip(names, points, strict=True)), expected, {})


def block(block: Block, groups: Sequence[Group]) -> None:
    """Check displayed equations against a Block; raise ModelError that names the first different equation."""
    rng = np.random.default_rng(SEED)
    names = [*(s.name for s in block.inputs), *(s.name for s in block.states), *(c.name for c in block.constants)]
    signals = [*block.inputs, *(s.signal for s in block.states)]
    points = _inside(signals, rng)
    half = POINTS // 2
    points[:, half:] *= 10.0 ** rng.uniform(0, RANGE_DECADES, (len(signals), POINTS - half))
    for row, state in zip(points[len(block.inputs) :], block.states, strict=True):
        if state.integer:
            row[:] = rng.integers(int(state.signal.low), int(state.signal.high) + 1, POINTS)
    points = np.vstack([points, _perturbations(np.array([c.value for c in block.constants]), rng)])
    exprs = {named.signal.name: e for named, e in block.computed_signals} | {
        f"{n} next": e for n, e in block.next.items()
    }
    f = ca.Function("block", [ca.vcat([block.symbol[n] for n in names])], [ca.vcat([*exprs.values()])])
    computed = dict(zip(exprs, _at(f, points), strict=True))
    tables = {name: _lookup(numbers) for name, numbers in lower.program(block).tables.items()}
    check(f"block '{block.name}'", groups, dict(zip(names, points, strict=True)), computed, tables)


def check(
    what: str, groups: Sequence[Group], loaded: Values, computed: Values, tables: Mapping[str, Callable[..., Array]]
) -> None:
    """Check that the displayed equations give the values `computed` (N,) by key for the values `loaded`.

    Raises ModelError that names the first different equation.
    """
    known = {**computed, **loaded}  # an equation may use a signal of the Block whose own equation comes later
    points = len(next(iter(loaded.values())))
    for group, equation in sorted(
        ((g, e) for g in groups for e in g.equations), key=lambda pair: (pair[1].mark != "", pair[1].order)
    ):
        shown = _evaluate(group, equation, known, tables, points)
        if not equation.mark:
            known[equation.name] = shown
        if equation.key in computed:
            _require_equal(what, equation, shown, computed[equation.key])


def _evaluate(
    group: Group, equation: Equation, known: Values, tables: Mapping[str, Callable[..., Array]], points: int
) -> Array:
    names = {group.name(s.name): known[s.name] for s in equation.shown.free_symbols}
    functions = {**FUNCTIONS, **tables}
    if equation.limits:
        low, high = equation.limits  # of a saturation that is shown without bounds
        functions["sat"] = lambda v, low=low, high=high: np.fmax(np.fmin(v, high), low)
    with np.errstate(all="ignore"):
        return np.broadcast_to(value(group.shown(equation), names, functions), points)


def value(expr: sp.Expr, names: Values, functions: Mapping[str, Callable[..., Array]]) -> Array:
    """Return the value of an expression for values (N,) of its symbols and functions by name.

    Raises DesignError for a function that is not among them.
    """
    if isinstance(expr, sp.Symbol):
        return names[expr.name]
    if not expr.args:
        return np.array(float(expr))
    kind = type(expr).__name__
    if kind not in functions:
        raise DesignError(f"an equation applies '{kind}', which is not a known function: write it out")
    return np.asarray(functions[kind](*(value(a, names, functions) for a in expr.args)), dtype=np.float64)


def _require_equal(what: str, equation: Equation, shown: Array, computed: Array) -> None:
    finite = np.isfinite(computed)
    size = np.abs(computed[finite]).max(initial=0.0)
    difference = np.abs(shown[finite] - computed[finite]).max(initial=0.0)
    if not finite.any() or not np.array_equal(finite, np.isfinite(shown)) or difference > TOLERANCE * size:
        raise ModelError(
            f"{what}: the equation of '{equation.name}' as shown is off by {difference:.3g}, the largest value is "
            f"{size:.3g}; of {len(computed)} points {finite.sum()} are finite in CasADi and {np.isfinite(shown).sum()} "
            "as shown: write the expression with other functions, or replace this section in the report"
        )


def _inside(signals: Sequence[Signal], rng: np.random.Generator) -> Array:
    """Return random points (signals, POINTS) in the ranges, with a quarter of the values at a range end."""
    low, high = (np.array([getattr(s, end) for s in signals]).reshape(-1, 1) for end in ("low", "high"))
    between = rng.uniform(low, high, (len(signals), POINTS))
    ends = np.where(rng.uniform(size=between.shape) < 0.5, low, high)
    return np.where(rng.uniform(size=between.shape) < 0.25, ends, between)


def _perturbations(values: Array, rng: np.random.Generator) -> Array:
    """Return random perturbations (len, POINTS) of the values."""
    size = np.where(values == 0, 1.0, np.abs(values))[:, None]
    return np.asarray(values[:, None] + SPREAD * size * rng.uniform(-1, 1, (len(values), POINTS)))


def _at(f: ca.Function, points: Array) -> Array:
    return np.hstack([f(column).full() for column in points.T])


def _lookup(numbers: Sequence[float]) -> Callable[..., Array]:
    values = np.array(numbers)
    return lambda index: values[np.clip(np.nan_to_num(index).astype(int), 0, len(values) - 1)]
