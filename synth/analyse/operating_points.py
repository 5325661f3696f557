"""Trim (MATLAB `findop`, python-control `find_operating_point`): an equilibrium of a plant in its free signals w.

    minimise  sum_j ((w_j - ref_j) / scale_j)^2   subject to   f(x, u, p) = 0

over the free states and inputs, all others held. ref_j is the value nearest zero in the signal's range and scale_j is
half the width of that range. Redundant inputs get their smallest values. Several roots may exist, for example with a
quadratic input. The search starts from a fixed set of points in the ranges and returns the nearest of all roots found
(`nearest_root`). Roots at equal distances are in `OperatingPoint.ties`.

Linearisation about an operating point (MATLAB `linearize`): dx/dt = A x + B u, y = C x + D u for small deviations.

    A = df/dx, B = df/du, C = dh/dx, D = dh/du

at (x0, u0, p0), by exact differentiation of the plant's expressions, with one-sided derivatives for a kink.
"""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from types import MappingProxyType
from typing import Any

import casadi as ca
import numpy as np

from synth import arguments, show
from synth.analyse.numerics import derivatives, nearest_root
from synth.errors import ModelError, SignalError
from synth.plant import Plant
from synth.signals import Signal, signal_names
from synth.statespace import Array, StateSpace, readonly
from synth.timing import Continuous

Linear = Callable[[Array], tuple[Array, Array]]

RELATIVE_TOLERANCE = 1e-9


@show.result
class OperatingPoint:
    """An equilibrium: x (n,), u (m,), p in the plant's order and units.

    `residual` is the largest |f_i| at the point, each in its state's unit over s; `outside` lists the signals outside
    their ranges. `ties` holds the other equilibria at the same distance, each as values of the free signals; the point
    itself has the larger value of the first free signal in which they differ. Of a continuum of such equilibria, `ties`
    holds those that the search found.
    """

    x: Array
    u: Array
    p: Array
    residual: float
    states: tuple[str, ...]
    inputs: tuple[str, ...]
    outside: tuple[str, ...] = ()
    ties: tuple[Mapping[str, float], ...] = ()

    def __post_init__(self) -> None:
        for letter in ("x", "u", "p"):
            object.__setattr__(self, letter, readonly(getattr(self, letter)))

    def sheet(self) -> show.Sheet:
        """Return the states and inputs by name, what lies outside its range, and the number of ties."""
        named = [("state", self.states, self.x), ("input", self.inputs, self.u)]
        rows = ((kind, n, show.number(v)) for kind, names, values in named for n, v in zip(names, values, strict=True))
        lines = [f"outside its range: {', '.join(self.outside)}"] if self.outside else []
        lines += [f"{len(self.ties)} other equilibria at the same distance"] if self.ties else []
        title = f"Operating point, residual {show.number(self.residual, 2)}"
        return show.Sheet(title, tuple(lines), (show.Table("", ("", "name", "value"), tuple(rows)),))

    def __getitem__(self, name: str) -> float:
        """Return the value of a state or input."""
        if name in self.states:
            return float(self.x[self.states.index(name)])
        if name in self.inputs:
            return float(self.u[self.inputs.index(name)])
        raise SignalError(f"'{name}' is not one of {', '.join((*self.states, *self.inputs))}")


@dataclass(frozen=True, eq=False)
class _Problem:
    """The equations in the scaled free variables z, with the unscaled derivatives and the tolerance of each."""

    system: nearest_root.System
    derivatives: Callable[[Array], Array]
    tolerance: Array


@arguments.checked
def trim(
    plant: Plant, fixed: Mapping[str, float], free: Collection[str], near: OperatingPoint | None = None
) -> OperatingPoint:
    """Find the equilibrium f(x, u, p) = 0 nearest zero in the `free` states and inputs.

    `fixed` holds states and inputs at values in their units; a name in neither stays at zero. With an equilibrium
    `near` of the same plant with other parameters, the search starts there, and elsewhere only if that finds none.

    Raises SignalError for a name that the plant lacks or that is fixed and free, ModelError without an equilibrium.
    """
    signals = {s.name: s for s in (*plant.states, *plant.inputs)}
    _check_names(plant, signals, fixed, free)
    reference = np.array([np.clip(0.0, signals[n].low, signals[n].high) for n in free])
    scale = np.array([signals[n].high / 2 - signals[n].low / 2 for n in free])
    problem = _problem(plant, fixed, [signals[n] for n in free], reference, scale)
    start = None if near is None else (np.array([near[n] for n in free]) - reference) / scale
    continued = None if start is None or not free else nearest_root.find_near(problem.system, start)
    roots = _roots(plant, problem, tuple(free), tuple(fixed)) if continued is None else (continued,)
    chosen, *others = (dict(zip(free, map(float, reference + scale * z), strict=True)) for z in roots)
    ties = tuple(MappingProxyType(other) for other in others)
    value = dict.fromkeys(signals, 0.0) | dict(fixed) | chosen
    x, u = np.array([value[s.name] for s in plant.states]), np.array([value[s.name] for s in plant.inputs])
    residual = float(np.abs(np.asarray(plant.f(x, u, plant.values))).max(initial=0.0))
    outside = tuple(n for n, s in signals.items() if (n in fixed or n in free) and not s.low <= value[n] <= s.high)
    return OperatingPoint(
        x, u, plant.values, residual, signal_names(plant.states), signal_names(plant.inputs), outside, ties
    )


@arguments.checked
def trim_with_free_states(
    plant: Plant, fixed: Mapping[str, float], free: Collection[str], near: OperatingPoint | None = None
) -> OperatingPoint:
    """Return `trim`, and where there is none, that with all states free that are not fixed.

    A force that holds one coordinate may displace another, such as a flexible mode, which then cannot stay at zero.
    States that are displaced at an equilibrium `near` are free from the first.

    Raises as `trim`.
    """
    zero = [s for s in plant.states if s.name not in (*fixed, *free)]
    others = [s.name for s in zero]
    if near is None or all(abs(near[s.name]) <= RELATIVE_TOLERANCE * (s.high / 2 - s.low / 2) for s in zero):
        try:
            return trim(plant, fixed, free, near)
        except ModelError:
            if not others:
                raise
    return trim(plant, fixed, [*free, *others], near)


def _check_names(plant: Plant, known: Collection[str], fixed: Collection[str], free: Collection[str]) -> None:
    if both := [n for n in free if n in fixed]:
        raise SignalError(f"trim of '{plant.name}': {', '.join(both)} both fixed and free: take each from one of them")
    if unknown := [n for n in (*fixed, *free) if n not in known]:
        raise SignalError(f"trim of '{plant.name}': no state or input {', '.join(unknown)}: it has {', '.join(known)}")
    if len(set(free)) < len(free):
        raise SignalError(f"trim of '{plant.name}': a free name is listed twice in {', '.join(free)}: name each once")


def _problem(
    plant: Plant, fixed: Mapping[str, float], free: Sequence[Signal], reference: Array, scale: Array
) -> _Problem:
    z = ca.SX.sym("z", len(free))
    held = ca.SX.sym("held", len(fixed))  # symbols, because a constant zero would cancel infinities
    value = {n: held[i] for i, n in enumerate(fixed)}
    value |= {s.name: reference[i] + scale[i] * z[i] for i, s in enumerate(free)}
    x = ca.vcat([value.get(s.name, ca.SX(0)) for s in plant.states])
    u = ca.vcat([value.get(s.name, ca.SX(0)) for s in plant.inputs])
    f = plant.f(x, u, plant.values)
    function, values = ca.Function("f", [z, held], [f]), np.array(list(fixed.values()), dtype=np.float64)

    def derivatives(z: Array) -> Array:
        return np.asarray(function(z, values)).ravel()

    size = np.abs(derivatives(np.zeros(len(free))))
    per_second = np.array([s.high / 2 - s.low / 2 for s in plant.states])
    tolerance = RELATIVE_TOLERANCE * (per_second + np.where(np.isfinite(size), size, 0.0))
    low, high = ((np.array(ends) - reference) / scale for ends in ([s.low for s in free], [s.high for s in free]))
    linear, stationary = _derivatives(RELATIVE_TOLERANCE * f / tolerance, z, held, values)
    is_affine = not any(ca.which_depends(f, z, 2, True))
    system = nearest_root.System(linear, stationary, low, high, RELATIVE_TOLERANCE, is_affine)
    return _Problem(system, derivatives, tolerance)


def _derivatives(f: ca.SX, z: ca.SX, held: ca.SX, values: Array) -> tuple[Linear, Linear]:
    """Return the functions `linear` and `stationary` of a `nearest_root.System`."""
    multiplier = ca.SX.sym("l", f.numel())
    J = ca.jacobian(f, z)
    conditions, unknowns = ca.vertcat(z + ca.mtimes(J.T, multiplier), f), ca.vertcat(z, multiplier)
    stationary = [conditions, ca.jacobian(conditions, unknowns)]
    return _numeric(z, held, [f, J], values), _numeric(unknowns, held, stationary, values)


def _numeric(unknown: ca.SX, held: ca.SX, results: Sequence[ca.SX], values: Array) -> Linear:
    """Return two results (k,) and (k, n) as a function of `unknown`, through buffers, which avoid slow conversions."""
    value, slope = results
    function = ca.Function("numeric", [unknown, held], [ca.densify(ca.vertcat(value, ca.vec(slope)))])
    buffer: Any  # CasADi's annotations want a size with the array
    buffer, evaluate = function.buffer()
    argument, result = np.zeros(unknown.numel()), np.zeros(function.numel_out(0))
    buffer.set_arg(0, argument.data)
    if values.size:
        buffer.set_arg(1, values.data)
    buffer.set_res(0, result.data)

    # `evaluate` alone does not keep the buffer alive: the default argument does.
    def evaluate_at(z: Array, _owner: object = buffer) -> tuple[Array, Array]:
        argument[:] = z
        evaluate()
        return result[: value.numel()].copy(), result[value.numel() :].reshape(slope.shape, order="F").copy()

    return evaluate_at


def _roots(plant: Plant, problem: _Problem, free: tuple[str, ...], fixed: tuple[str, ...]) -> tuple[Array, ...]:
    """Return the scaled roots nearest zero; raise ModelError with the unsatisfied equation."""
    origin = np.zeros(len(free))
    if not free:
        search = nearest_root.Search((origin,) if problem.system.is_root(origin) else (), origin)
    else:
        search = nearest_root.find(problem.system)
    if search.roots:
        return search.roots
    if search.best is None:
        raise _not_finite(plant, problem.derivatives(origin), free)
    raise _no_trim(plant, problem, search.best, free, fixed)


def _not_finite(plant: Plant, derivatives: Array, free: tuple[str, ...]) -> ModelError:
    state = plant.states[int(np.argmin(np.isfinite(derivatives)))]
    zero = [p.name for p in plant.parameters if p.value == 0]
    divided = f", and look for a division by a parameter that is 0: {', '.join(zero)}" if zero else ""
    return ModelError(
        f"plant '{plant.name}' has no trim: d({state.name})/dt is not finite at the values held for trim, at any of "
        f"the points tried in the ranges of {', '.join(free)}: hold the signals inside the plant's domain{divided}"
    )


def _no_trim(plant: Plant, problem: _Problem, z: Array, free: tuple[str, ...], fixed: tuple[str, ...]) -> ModelError:
    residual = problem.derivatives(z)
    excess = np.where(np.isfinite(residual), np.abs(residual) / problem.tolerance, np.inf)
    worst = int(excess.argmax())
    state: Signal = plant.states[worst]
    zero = [s.name for s in (*plant.states, *plant.inputs) if s.name not in (*free, *fixed)]
    others = f" and {', '.join(zero)} at 0" if zero else ""
    return ModelError(
        f"plant '{plant.name}' has no trim: d({state.name})/dt = 0 cannot be met; the least found is "
        f"{residual[worst]:.4g} {state.unit}/s with {', '.join(free) or 'nothing'} free and "
        f"{', '.join(fixed) or 'nothing'} held{others}: free a signal that acts on '{state.name}', or hold other values"
    )


@arguments.checked
def linearise(plant: Plant, point: OperatingPoint) -> StateSpace:
    """Return the Jacobians A (n, n), B (n, m), C (p, n), D (p, m) at `point`, in the units of the signals.

    Raises SignalError when `point` belongs to another plant, or a derivative is not finite there; ModelError at a kink,
    such as a stop or a limit, where there is no derivative.
    """
    require_point(plant, point)
    model = _model(plant.f, plant.h)
    signals = (*plant.states, *plant.inputs)
    rows = [*(f"d({s.name})/dt" for s in plant.states), *(f"the output '{s.name}'" for s in plant.outputs)]
    A, B, C, D = derivatives.linear_model(
        f"plant '{plant.name}'", model, (point.x, point.u, point.p), signals, [(True, True)] * len(signals), rows
    )
    units = {s.name: s.unit for s in (*plant.states, *plant.inputs, *plant.outputs)}
    return StateSpace(A, B, C, D, point.states, point.inputs, signal_names(plant.outputs), Continuous(), units)


@lru_cache(maxsize=8)  # a plant is linearised at many points, with many values of its parameters
def _model(f: ca.Function, h: ca.Function) -> ca.Function:
    """Return (x, u, p) -> (f, h)."""
    arguments = f.sx_in()
    return ca.Function("model", arguments, [f(*arguments), h(*arguments)])


@arguments.checked
def require_point(plant: Plant, point: OperatingPoint) -> None:
    """Raise SignalError when `point` belongs to another plant."""
    if (point.states, point.inputs) != (signal_names(plant.states), signal_names(plant.inputs)):
        raise SignalError(
            f"the operating point has states {', '.join(point.states)} and inputs {', '.join(point.inputs)}, "
            f"which are not those of plant '{plant.name}': trim this plant"
        )
