"""Trim: values of the free states and inputs w at which a plant rests.

    minimise  sum_j ((w_j - ref_j) / scale_j)^2   subject to   f(x, u, p) = 0

over the named free signals, everything else held. ref_j is the value nearest zero in the signal's range and scale_j
half the width of that range. Where inputs are redundant the smallest ones serve. Of several roots, as a quadratic input
gives them, the one reached from zero is taken: a local minimum of the distance.

Method. Least squares from the reference finds a root, or the least that the equations can come to. Newton's method on
the conditions of stationarity, J^T l + z = 0 and f = 0 with z = (w - ref)/scale, then makes it the nearest one.
"""

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass

import casadi as ca
import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from synth import arguments
from synth.errors import ModelError, SignalError
from synth.plant import Plant
from synth.signals import Signal, names
from synth.statespace import readonly

Array = NDArray[np.float64]

STARTS = (0.0, 0.3, -0.3, 0.9, -0.9)  # in half ranges from the reference
RELATIVE_TOLERANCE = 1e-9
NEWTON_STEPS = 20


@dataclass(frozen=True, eq=False)
class OperatingPoint:
    """An equilibrium: x (n,), u (m,), p in the plant's order and units.

    `residual` is the largest |f_i| at the point, each in its state's unit over s; `outside` names the signals beyond
    their range.
    """

    x: Array
    u: Array
    p: Array
    residual: float
    states: tuple[str, ...]
    inputs: tuple[str, ...]
    outside: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        for letter in ("x", "u", "p"):
            object.__setattr__(self, letter, readonly(getattr(self, letter)))

    def __getitem__(self, name: str) -> float:
        """Return the value of a state or input."""
        if name in self.states:
            return float(self.x[self.states.index(name)])
        if name in self.inputs:
            return float(self.u[self.inputs.index(name)])
        raise SignalError(f"'{name}' is not one of {', '.join((*self.states, *self.inputs))}")


@dataclass(frozen=True, eq=False)
class _Problem:
    """f(z, held) = 0 in the scaled free variables z, with derivatives, and the tolerance of each equation."""

    held: Array
    f: ca.Function
    jacobian: ca.Function
    stationarity: ca.Function
    size: int
    tolerance: Array

    def residual(self, z: Array) -> Array:
        return np.asarray(self.f(z, self.held)).ravel()

    def met(self, z: Array) -> bool:
        return bool((np.abs(self.residual(z)) <= self.tolerance).all())


@arguments.checked
def trim(plant: Plant, fixed: Mapping[str, float], free: Collection[str]) -> OperatingPoint:
    """Find the equilibrium f(x, u, p) = 0 nearest zero in the `free` states and inputs.

    `fixed` holds states and inputs at values in their units; a name in neither stays at zero.

    Raises SignalError when a name is not the plant's or is both fixed and free, ModelError when it has no equilibrium.
    """
    signals = {s.name: s for s in (*plant.states, *plant.inputs)}
    _check_names(plant, signals, fixed, free)
    reference = np.array([np.clip(0.0, signals[n].low, signals[n].high) for n in free])
    scale = np.array([(signals[n].high - signals[n].low) / 2 for n in free])
    problem = _problem(plant, fixed, tuple(free), reference, scale)
    z = _nearest(plant, problem, tuple(free), tuple(fixed))
    value = dict.fromkeys(signals, 0.0) | dict(fixed) | dict(zip(free, reference + scale * z, strict=True))
    x, u = np.array([value[s.name] for s in plant.states]), np.array([value[s.name] for s in plant.inputs])
    residual = float(np.abs(np.asarray(plant.f(x, u, plant.values))).max(initial=0.0))
    outside = tuple(n for n, s in signals.items() if (n in fixed or n in free) and not s.low <= value[n] <= s.high)
    return OperatingPoint(x, u, plant.values, residual, names(plant.states), names(plant.inputs), outside)


def _check_names(plant: Plant, known: Collection[str], fixed: Collection[str], free: Collection[str]) -> None:
    if both := [n for n in free if n in fixed]:
        raise SignalError(f"trim of '{plant.name}': {', '.join(both)} both fixed and free: take each from one of them")
    if unknown := [n for n in (*fixed, *free) if n not in known]:
        raise SignalError(f"trim of '{plant.name}': no state or input {', '.join(unknown)}: it has {', '.join(known)}")
    if len(set(free)) < len(free):
        raise SignalError(f"trim of '{plant.name}': a free name stands twice in {', '.join(free)}: name each once")


def _problem(
    plant: Plant, fixed: Mapping[str, float], free: tuple[str, ...], reference: Array, scale: Array
) -> _Problem:
    z = ca.SX.sym("z", len(free))
    held = ca.SX.sym("held", len(fixed))  # symbols: a constant zero would cancel the infinities that it causes
    value = {n: held[i] for i, n in enumerate(fixed)}
    value |= {n: reference[i] + scale[i] * z[i] for i, n in enumerate(free)}
    x = ca.vcat([value.get(s.name, ca.SX(0)) for s in plant.states])
    u = ca.vcat([value.get(s.name, ca.SX(0)) for s in plant.inputs])
    f = plant.f(x, u, plant.values)
    multiplier = ca.SX.sym("l", f.numel())
    J = ca.jacobian(f, z)
    conditions = ca.vertcat(z + ca.mtimes(J.T, multiplier), f)
    unknowns = ca.vertcat(z, multiplier)
    stationarity = ca.Function("s", [unknowns, held], [conditions, ca.jacobian(conditions, unknowns)])
    function, slope = ca.Function("f", [z, held], [f]), ca.Function("J", [z, held], [J])
    values = np.array(list(fixed.values()), dtype=np.float64)
    size = np.abs(np.asarray(function(np.zeros(len(free)), values)).ravel())
    per_second = np.array([(s.high - s.low) / 2 for s in plant.states])
    tolerance = RELATIVE_TOLERANCE * (per_second + np.where(np.isfinite(size), size, 0.0))
    return _Problem(values, function, slope, stationarity, len(free), tolerance)


def _nearest(plant: Plant, problem: _Problem, free: tuple[str, ...], fixed: tuple[str, ...]) -> Array:
    """Return the scaled root nearest zero; raise ModelError with the equation that stays unmet."""
    found = []
    for z in _least_squares(plant, problem) if free else [np.zeros(0)]:
        if problem.met(z):
            return _polished(problem, z) if free else z
        found.append(z)
    best = min(found, key=lambda z: float(np.max(np.abs(problem.residual(z)) / problem.tolerance)))
    raise _no_trim(plant, problem, best, free, fixed)


def _least_squares(plant: Plant, problem: _Problem) -> Iterator[Array]:
    weight = RELATIVE_TOLERANCE / problem.tolerance
    starts = [np.full(problem.size, start) for start in STARTS]
    starts = [z for z in starts if np.isfinite(problem.residual(z)).all()]
    if not starts:
        raise ModelError(
            f"plant '{plant.name}': the derivatives are not finite at the values held for trim: "
            "hold the signals inside the plant's domain"
        )
    for start in starts:
        yield least_squares(
            lambda z: weight * problem.residual(z),
            start,
            lambda z: weight[:, None] * np.asarray(problem.jacobian(z, problem.held)),
            xtol=1e-15,
            ftol=1e-15,
            gtol=1e-15,
        ).x


def _polished(problem: _Problem, z: Array) -> Array:
    """Return the stationary point near the root `z`, or `z` itself where Newton's method leads to nothing nearer."""
    J = np.asarray(problem.jacobian(z, problem.held))
    w = np.concatenate([z, -np.linalg.lstsq(J.T, z, rcond=None)[0]])
    for _ in range(NEWTON_STEPS):
        conditions, slope = (np.asarray(m) for m in problem.stationarity(w, problem.held))
        step = np.linalg.lstsq(slope, conditions.ravel(), rcond=None)[0]
        if not np.isfinite(step).all():
            return z
        w = w - step
        if np.abs(step[: problem.size]).max() < 1e-15:
            break
    polished = w[: problem.size]
    nearer = np.linalg.norm(polished) <= np.linalg.norm(z) * (1 + 1e-6) + 1e-12
    return polished if nearer and problem.met(polished) else z


def _no_trim(plant: Plant, problem: _Problem, z: Array, free: tuple[str, ...], fixed: tuple[str, ...]) -> ModelError:
    residual = problem.residual(z)
    excess = np.where(np.isfinite(residual), np.abs(residual) / problem.tolerance, np.inf)
    worst = int(excess.argmax())
    state: Signal = plant.states[worst]
    return ModelError(
        f"plant '{plant.name}' has no trim: d({state.name})/dt = 0 cannot be met; the least found is "
        f"{residual[worst]:.4g} {state.unit}/s with {', '.join(free) or 'nothing'} free and "
        f"{', '.join(fixed) or 'nothing'} held: free a signal that acts on '{state.name}', or hold other values"
    )
