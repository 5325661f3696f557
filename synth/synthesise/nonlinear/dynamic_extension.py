"""Dynamic extension: integrators on inputs, until the vector relative degree is defined.

    u_rate --->( 1/s )---> u --->[ plant ]---> y          the integrator's state has the input's name

Where the decoupling matrix D (p, m) has rank s < p in the whole domain, the rows of some outputs are combinations of
the rows I of others. The inputs that enter through D_I are delayed by an integrator, and other inputs then enter in
derivatives of the same order. With columns J for which D_IJ is invertible, the delayed combinations are

    v_J = u_J + D_IJ^-1 D_IK u_K,    K the other inputs,

or u_J itself where no other input enters those rows. Each step increases the degrees of I by one. At the end the sum of
the degrees is compared with the number of states: if they are equal there are no zero dynamics. For a plant without
right inverse, for example if one output is a function of another, the algorithm does not end; a bound stops it.

Sources: Descusse, Moog, International Journal of Control 42 (1985) 1387-1398; Isidori, Nonlinear Control Systems, 5.4.

Library: no design uses it yet; docs/library.md has an example.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations

import casadi as ca
import numpy as np

from synth import arguments, show
from synth.analyse import box, relative_degree, rounding
from synth.analyse.relative_degree import RelativeDegree
from synth.errors import ModelError, SignalError
from synth.plant import Plant, Symbols, build
from synth.signals import Signal, per_second, signal_names
from synth.statespace import Array
from synth.synthesise.nonlinear import cofactors


@show.result
class Extension:
    """The extended `plant`, its new states in the order they were added, and the degree of its outputs.

    `recovered` gives the inputs (m,) of the original plant from the states and inputs of the extended one.
    """

    plant: Plant
    integrators: tuple[str, ...]
    recovered: ca.Function
    degree: RelativeDegree

    def sheet(self) -> show.Sheet:
        """Return the integrators and the relative degree."""
        added = ", ".join(self.integrators) or "none needed"
        degree = self.degree.sheet()
        lines = (f"integrators: {added}", f"inputs: {', '.join(signal_names(self.plant.inputs))}", *degree.lines)
        return show.Sheet(f"Dynamic extension of '{self.plant.name}'", lines, degree.tables)


@dataclass(frozen=True, eq=False)
class _Mixing:
    """u_j = v_j - rows_j u for the inputs at the indices `delayed`; `rows` (len(delayed), m) depend on the states."""

    delayed: tuple[int, ...]
    rows: ca.SX


@arguments.checked
def add_integrators(plant: Plant, inputs: Sequence[str]) -> Plant:
    """Return the plant with an integrator before each of the named inputs; it is then affine in the new inputs.

    An input becomes a state with the same name, unit and range; the new input `<input>_rate` can traverse that range in
    one second.

    Raises SignalError for a name that is not an input or is already used.
    """
    known = signal_names(plant.inputs)
    for name in inputs:
        if name not in known or list(inputs).count(name) > 1:
            raise SignalError(
                f"integrator before '{name}': name inputs of '{plant.name}', {', '.join(known)}, each once"
            )
    places = tuple(k for k, name in enumerate(known) if name in inputs)
    return _insert_integrators(plant, places, _identity(plant), [plant.inputs[k] for k in places])


@arguments.checked
def extend(
    plant: Plant,
    outputs: Sequence[str] | None = None,
    held: Mapping[str, float] | None = None,
    bound: int | None = None,
) -> Extension:
    """Return the plant with the integrators that the relative degree of `outputs` needs to be defined.

    At most `bound` integrators are added, by default as many as the plant has states. `degree.worst` reports points of
    the domain where D still loses rank.

    Raises as `relative_degree.of_plant`; ModelError when the plant has more outputs than inputs or the bound is
    exceeded.
    """
    limit = len(plant.states) if bound is None else bound
    degree = relative_degree.of_plant(plant, outputs, held)
    if len(degree.outputs) > len(degree.model.inputs):
        degree.require_constant_rank()
    added: list[str] = []
    recovered = _identity(plant)
    while degree.rows.dependent:
        plant, new, recovered = _extend_once(plant, degree, recovered)
        added += new
        if len(added) > limit:
            raise _no_extension(degree, len(added) - len(new))
        degree = relative_degree.of_plant(plant, degree.outputs, held)
    return Extension(plant, tuple(added), recovered, degree)


def _no_extension(degree: RelativeDegree, added: int) -> ModelError:
    dependences = [f"'{name}' on ({', '.join(others)})" for name, others in degree.rows.dependent.items()]
    return ModelError(
        f"plant '{degree.model.name}' cannot be decoupled by integrators on its inputs: with {added} of them rows of "
        f"the decoupling matrix still depend on others, {'; '.join(dependences)}; these outputs are not independent "
        "(the plant has no right inverse), or the bound is too low: choose other outputs, or raise the bound"
    )


def _extend_once(plant: Plant, degree: RelativeDegree, recovered: ca.Function) -> tuple[Plant, list[str], ca.Function]:
    """Add integrators to the inputs that enter through the rows on which others depend."""
    mixing = _mixing(degree)
    inputs = degree.model.inputs
    known = signal_names(plant.inputs)
    places = tuple(known.index(inputs[j].name) for j in mixing.delayed)
    m, x = len(known), ca.SX.sym("x", len(plant.states))
    v = ca.SX.sym("v", m)
    u = ca.SX(v)
    free = [known.index(s.name) for s in inputs]
    rows = ca.substitute(mixing.rows, degree.model.x, x)
    for k, place in enumerate(places):
        u[place] -= ca.mtimes(rows[k, :], v[free])
    undone = ca.Function("u", [x, v], [u])
    states = [_integrator_state(degree, mixing, k) for k in range(len(places))]
    extended = _insert_integrators(plant, places, undone, states)
    return extended, [s.name for s in states], _recover_inputs(extended, places, undone, recovered, len(plant.states))


def _integrator_state(degree: RelativeDegree, mixing: _Mixing, k: int) -> Signal:
    """Return the state of an integrator; the range of a combination of inputs is the sum of their ranges."""
    inputs = degree.model.inputs
    input = inputs[mixing.delayed[k]]
    row = mixing.rows[k, :]
    if not row.nnz():
        return input
    points = box.scatter(degree.model.states, rounding.POINTS, rounding.SEEDS[0])
    values = degree.model.box.evaluate(row, points)[0]
    ends = values[None] * np.array([[s.low for s in inputs], [s.high for s in inputs]])[:, :, None]
    low, high = (float(sum(extreme(ends, axis=(0, 2)))) for extreme in (np.min, np.max))
    about = f"{input.name} with " + ", ".join(s.name for s, v in zip(inputs, values, strict=True) if v.any())
    return Signal(f"{input.name}_mixed", input.unit, input.low + low, input.high + high, about)


def _mixing(degree: RelativeDegree) -> _Mixing:
    """Return the inputs to delay and the coefficients of the other inputs in them."""
    D, outputs = degree.decoupling, degree.outputs
    behind = {name for others in degree.rows.dependent.values() for name in others}
    same = behind | {n for n, others in degree.rows.dependent.items() if set(others) <= behind}
    rows, columns = _best_block(degree, [outputs.index(n) for n in outputs if n in same], len(behind))
    others_entering = [j for j in range(D.size2()) if j not in columns and D[rows, j].nnz()]
    mixed = ca.SX(len(columns), D.size2())
    if others_entering:
        solved = cofactors.solve(D[rows, columns], D[rows, others_entering]).value
        mixed[:, others_entering] = rounding.without_zeros(solved, degree.model.box)
    return _Mixing(tuple(columns), mixed)


def _best_block(degree: RelativeDegree, rows: Sequence[int], size: int) -> tuple[list[int], list[int]]:
    """Return the rows and columns of the square block of D that is best conditioned at the worst scattered point."""
    D, model = degree.decoupling, degree.model
    points = box.scatter(model.states, rounding.POINTS, rounding.SEEDS[0])
    values = model.box.evaluate(D, points).transpose(2, 0, 1) * box.half_widths(model.inputs)
    values /= np.linalg.norm(values, axis=2).max(axis=0)[:, None]
    choices = [
        (list(i), list(j)) for i in combinations(rows, size) for j in combinations(range(len(model.inputs)), size)
    ]
    return max(choices, key=lambda choice: _least_singular_value(values[:, choice[0]][:, :, choice[1]]))


def _least_singular_value(values: Array) -> float:
    return float(np.linalg.svd(values, compute_uv=False)[:, -1].min())


def _identity(plant: Plant) -> ca.Function:
    x, u = ca.SX.sym("x", len(plant.states)), ca.SX.sym("u", len(plant.inputs))
    return ca.Function("u", [x, u], [u])


def _recover_inputs(
    extended: Plant, places: Sequence[int], undone: ca.Function, recovered: ca.Function, n: int
) -> ca.Function:
    """Return the original plant's inputs as a function of the states and inputs of the extended one."""
    x, u = ca.SX.sym("x", len(extended.states)), ca.SX.sym("u", len(extended.inputs))
    v = ca.SX(u)
    for k, place in enumerate(places):
        v[place] = x[n + k]
    return ca.Function("u", [x, u], [recovered(x[: recovered.size1_in(0)], undone(x[:n], v))], ["x", "u"], ["before"])


def _insert_integrators(plant: Plant, places: Sequence[int], undone: ca.Function, states: Sequence[Signal]) -> Plant:
    """Return the plant with integrators at the input indices `places`; undone(x, v) maps their states to inputs."""
    rates = [_rate_input(s) for s in states]
    inputs = list(plant.inputs)
    for place, rate in zip(places, rates, strict=True):
        inputs[place] = rate
    taken = signal_names([*plant.states, *states])
    signal_names([*inputs, *(s for s in plant.states if s.name not in signal_names(inputs)), *states])
    old = signal_names(plant.states)

    def physics(x: Symbols, u: Symbols, p: Symbols) -> tuple[dict[str, ca.SX], dict[str, ca.SX]]:
        values = list(u.values())
        for place, state in zip(places, states, strict=True):
            values[place] = x[state.name]
        before = ca.vertcat(*(x[name] for name in old))
        args = (before, undone(before, ca.vertcat(*values)), ca.vertcat(*p.values()))
        f, h = (ca.cse(function(*args)) for function in (plant.f, plant.h))
        derivative = dict(zip(taken, [*ca.vertsplit(f), *(u[rate.name] for rate in rates)], strict=True))
        return derivative, dict(zip(signal_names(plant.outputs), ca.vertsplit(h), strict=True))

    return build(plant.name, [*plant.states, *states], inputs, plant.outputs, plant.parameters, physics)


def _rate_input(state: Signal) -> Signal:
    """Return the input of an integrator, which can traverse the range of its state in one second."""
    width = state.high - state.low
    return Signal(f"{state.name}_rate", per_second(state.unit), -width, width, f"rate of {state.name}")
