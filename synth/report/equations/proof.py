"""Test of displayed equations: each formula, evaluated from its markup, must agree with CasADi at POINTS random points.

Definitions are evaluated in their order. Derivatives, outputs, named signals and next states are compared, to TOLERANCE
of the largest value of each.
"""

from collections.abc import Callable, Mapping, Sequence

import casadi as ca
import numpy as np

from synth.block import Block
from synth.emit.program import lower
from synth.errors import ModelError
from synth.plant import Plant
from synth.report.equations import derive, glyphs, mathml_value
from synth.report.equations.derive import Equation, Group, NamedTerms
from synth.signals import Signal
from synth.statespace import Array

Values = Mapping[str, Array]
POINTS, TOLERANCE, SEED = 48, 1e-9, 7
SPREAD = 0.05  # relative variation of parameters and constants
RANGE_DECADES = 4  # powers of ten by which the inputs of a Block exceed their ranges in half of the points


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
    names = {
        mathml_value.key(glyphs.markup(group.name(s.name))): known[s.name] for s in equation.expression.free_symbols
    }
    with np.errstate(all="ignore"):
        shown = mathml_value.value(group.right(equation), names, equation.limits, tables)
    return np.broadcast_to(shown, points)


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
