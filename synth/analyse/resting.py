"""The resting state of a sampled loop, and the loop linearised and opened there.

    0   = f(x, u, p)                                  the plant in equilibrium
    x_c = F(x_c, m),   m = S h(x, u, p), references   a fixed point of the controller's step
    u   = U G(x_c, m)                                 which commands just these inputs

Unknown are the plant's states x, its actuated inputs u and the controller's real states x_c, together: an integrator
alone may rest at any value, and the input that the plant needs says at which. Newton's method with the shortest step
solves it, each unknown relative to half the width of its range, from the plant's trim with the controller as after
`init`, and from where the simulated loop is some samples later; counters and flags are stepped until they stand still.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import casadi as ca
import numpy as np

from synth import arguments
from synth.analyse import linearise, loop
from synth.analyse.trim import OperatingPoint
from synth.block import Block
from synth.errors import ModelError, SignalError
from synth.plant import Plant
from synth.signals import Signal, names
from synth.statespace import Array, StateSpace

TOLERANCE = 1e-9  # of half the width of a signal's range, in a period for what changes
ITERATIONS = 60
LATER = (0, 1, 10, 100, 1000, 10_000)  # samples of the simulated loop from which Newton's method starts
COUNTING = 100_000  # samples that counters and flags may take to stand still
RANK = 1e-12  # singular values of the scaled equations below this part of the largest count as zero
SUBSTEPS = 4  # of the Runge-Kutta method in a period

Wires = Mapping[str, str | Mapping[str, float]]


@arguments.checked
@dataclass(frozen=True, eq=False)
class ClosedLoop:
    """A plant under a controller.

    `sensors[controller input] = plant output`; `actuators[plant input] = controller output`, or a sum of them,
    {controller output: weight}. Commands act `delay` samples late. Other inputs of the controller are references, other
    inputs of the plant disturbances.

    Raises SignalError for a wire whose ends are not known.
    """

    plant: Plant
    controller: Block
    sensors: Mapping[str, str]
    actuators: Wires
    delay: float = 1

    def __post_init__(self) -> None:
        ends = (
            ("sensors", self.sensors, names(self.controller.inputs)),
            ("sensors", self.sensors.values(), names(self.plant.outputs)),
            ("actuators", self.actuators, names(self.plant.inputs)),
            ("actuators", [c for row in self.mixing.values() for c in row], names(self.controller.outputs)),
        )
        for what, listed, known in ends:
            for name in listed:
                if name not in known:
                    raise SignalError(f"{what}: '{name}' is not one of {', '.join(known)}: correct the name")

    @property
    def references(self) -> tuple[str, ...]:
        """The controller's inputs that no sensor drives."""
        return tuple(n for n in names(self.controller.inputs) if n not in self.sensors)

    @property
    def mixing(self) -> dict[str, dict[str, float]]:
        """The weights of the controller's outputs in each actuated input."""
        return {u: {w: 1.0} if isinstance(w, str) else dict(w) for u, w in self.actuators.items()}


@arguments.checked
@dataclass(frozen=True, eq=False)
class Rest:
    """Where a loop rests: the plant's operating point, the controller's states and its inputs, by name, in their units.

    `residual` is the largest change in a period, of an unknown or of what it should equal, relative to half the width
    of its signal's range.
    """

    closed: ClosedLoop
    point: OperatingPoint
    state: Mapping[str, float]
    inputs: Mapping[str, float]
    residual: float

    @property
    def controller(self) -> StateSpace:
        """The controller's Jacobians where it rests."""
        return loop.linearised(self.closed.controller, self.state, self.inputs)

    @property
    def plant(self) -> StateSpace:
        """The plant's Jacobians where it rests."""
        return linearise.linearise(self.closed.plant, self.point)


@arguments.checked
def open_loop(rest: Rest, signal: str | Sequence[str]) -> StateSpace:
    """Return L from `signal`, an actuator or a sensor, to minus ``<signal>_out``, sampled, where the loop rests.

    An actuator is named as the plant's input, a sensor as the controller's; with several names L is opened at all of
    them. An actuator opens before its delay and behind whatever in the controller observes the command. Arguments and
    errors are those of `loop.opened`.
    """
    of = rest.closed
    return loop.opened(rest.plant, rest.controller, signal, of.sensors, of.actuators, of.delay)


@arguments.checked
def solve(closed: ClosedLoop, references: Mapping[str, float], near: OperatingPoint) -> Rest:
    """Return where the loop rests at constant `references`, for the plant `near` a trim of its own.

    Disturbances stay as in `near`. Without integral action the loop rests a little off it.

    Raises SignalError for a reference that is missing or not known, or an operating point of another plant; ModelError
    when no rest is reached, saying what does not stand still, or when the controller raises a fault there.
    """
    _check(closed, references, near)
    equations = _equations(closed, references, near)
    least: _Trial | None = None
    for start in _starts(equations, closed, near):
        trial = _rest_from(equations, start)
        if trial.size <= TOLERANCE:
            rest = _rest(closed, references, near, trial)
            _require_sound(rest)
            return rest
        least = trial if least is None or trial.size < least.size else least
    raise _refusal(closed, equations, least)


def _check(closed: ClosedLoop, references: Mapping[str, float], near: OperatingPoint) -> None:
    missing = [n for n in closed.references if n not in references]
    unknown = [n for n in references if n not in closed.references]
    if missing or unknown:
        raise SignalError(
            f"references of '{closed.controller.name}': missing {missing or 'none'}, not known {unknown or 'none'}: "
            f"give a value for each of {', '.join(closed.references) or 'none'}"
        )
    linearise.require_point(closed.plant, near)


@dataclass(frozen=True, eq=False)
class _Trial:
    """Plant's states x, all inputs u, all controller's states, and the scaled residual of each equation."""

    x: Array
    u: Array
    state: Array
    residual: Array

    @property
    def size(self) -> float:
        return float(np.abs(self.residual).max(initial=0.0)) if np.isfinite(self.residual).all() else np.inf


@dataclass(frozen=True, eq=False)
class _Equations:
    """The equations of rest, as functions of x, u and the controller's state; `scale` is that of the unknowns.

    `residual` returns for each unknown its change in a period, relative to its scale, `slope` the Jacobian of that by
    the scaled unknowns; `step` the controller's next state and the inputs that it commands; `flow` the plant's next
    state.
    """

    unknowns: tuple[Signal, ...]
    acted: Array
    real: Array
    scale: Array
    residual: ca.Function
    slope: ca.Function
    step: ca.Function
    flow: ca.Function

    def trial(self, x: Array, u: Array, state: Array) -> _Trial:
        return _Trial(x, u, state, np.asarray(self.residual(x, u, state)).ravel())

    def moved(self, at: _Trial, by: Array) -> _Trial:
        n, m = len(at.x), len(self.acted)
        x, u, state = at.x + by[:n], at.u.copy(), at.state.copy()
        u[self.acted] += by[n : n + m]
        state[self.real] += by[n + m :]
        return self.trial(x, u, state)


def _equations(closed: ClosedLoop, references: Mapping[str, float], near: OperatingPoint) -> _Equations:
    plant, block, T = closed.plant, closed.controller, closed.controller.time.period_s
    x, u, c = ca.SX.sym("x", len(plant.states)), ca.SX.sym("u", len(plant.inputs)), ca.SX.sym("c", len(block.states))
    outputs = dict(zip(names(plant.outputs), ca.vertsplit(plant.h(x, u, near.p)), strict=True))
    measured = [outputs[closed.sensors[n]] if n in closed.sensors else references[n] for n in names(block.inputs)]
    after, y = block.function()(c, ca.vcat(measured))
    sent = dict(zip(names(block.outputs), ca.vertsplit(y), strict=True))
    acted = [i for i, n in enumerate(names(plant.inputs)) if n in closed.actuators]
    rows = [closed.mixing[plant.inputs[i].name] for i in acted]
    commanded = ca.SX(u)
    for i, row in zip(acted, rows, strict=True):
        commanded[i] = sum((weight * sent[name] for name, weight in row.items()), start=ca.SX(0))
    real = [i for i, s in enumerate(block.states) if not s.integer]
    unknowns = (*plant.states, *(plant.inputs[i] for i in acted), *(block.states[i].signal for i in real))
    widths = np.array([s.high / 2 - s.low / 2 for s in unknowns])
    scale = np.where(np.isfinite(widths) & (widths > 0), widths, 1.0)
    changes = ca.vertcat(T * plant.f(x, u, near.p), commanded[acted] - u[acted], after[real] - c[real]) / scale
    free = ca.vertcat(x, u[acted], c[real])
    slope = ca.jacobian(changes, free) @ ca.diag(ca.DM(scale))
    places = [x, u, c]
    return _Equations(
        unknowns,
        np.array(acted, dtype=int),
        np.array(real, dtype=int),
        scale,
        ca.Function("residual", places, [ca.densify(changes)]),
        ca.Function("slope", places, [ca.densify(slope)]),
        ca.Function("step", places, [ca.densify(after), ca.densify(commanded)]),
        ca.Function("flow", [x, u], [_runge_kutta(plant, x, u, near.p, T)]),
    )


def _runge_kutta(plant: Plant, x: ca.SX, u: ca.SX, p: Array, T: float) -> ca.SX:
    h = T / SUBSTEPS
    for _ in range(SUBSTEPS):
        k1 = plant.f(x, u, p)
        k2 = plant.f(x + h / 2 * k1, u, p)
        k3 = plant.f(x + h / 2 * k2, u, p)
        x = x + h / 6 * (k1 + 2 * (k2 + k3) + plant.f(x + h * k3, u, p))
    return x


def _starts(equations: _Equations, closed: ClosedLoop, near: OperatingPoint) -> Iterator[_Trial]:
    """Yield where the simulated loop is after some samples, commands one sample late, as long as it is finite."""
    x, u, state = near.x.copy(), near.u.copy(), closed.controller.initial
    for before, until in pairwise((0, *LATER)):
        for _ in range(before, until):
            state, commanded = (np.asarray(v).ravel() for v in equations.step(x, u, state))
            x, u = np.asarray(equations.flow(x, u)).ravel(), commanded
        if not (np.isfinite(x).all() and np.isfinite(u).all() and np.isfinite(state).all()):
            return
        yield equations.trial(x, u, state)


def _rest_from(equations: _Equations, trial: _Trial) -> _Trial:
    """Solve for the real unknowns with counters and flags held, and step these until all stand still."""
    for _ in range(len(trial.state) + 1):
        trial = _newton(equations, trial)
        counted = _counted(equations, trial)
        if counted is None or np.array_equal(counted.state, trial.state):
            return trial if counted is not None else replace(trial, residual=np.array([np.inf]))
        trial = counted
    return trial


def _newton(equations: _Equations, trial: _Trial) -> _Trial:
    for _ in range(ITERATIONS):
        slope = np.asarray(equations.slope(trial.x, trial.u, trial.state))
        if not (np.isfinite(slope).all() and np.isfinite(trial.residual).all()):
            return trial
        move = -equations.scale * np.linalg.lstsq(slope, trial.residual, rcond=RANK)[0]
        better = next(
            (t for t in (equations.moved(trial, move / 2**i) for i in range(12)) if t.size < trial.size), None
        )
        if better is None:
            return trial
        trial = better
    return trial


def _counted(equations: _Equations, trial: _Trial) -> _Trial | None:
    """Return the trial with counters and flags where they stand still with the rest held; None where they do not."""
    state = trial.state.copy()
    whole = np.setdiff1d(np.arange(len(state)), equations.real)
    seen: set[bytes] = set()
    while state[whole].tobytes() not in seen and len(seen) < COUNTING:
        seen.add(state[whole].tobytes())
        after = np.asarray(equations.step(trial.x, trial.u, state)[0]).ravel()
        if np.array_equal(after[whole], state[whole]):
            return equations.trial(trial.x, trial.u, state)
        state[whole] = after[whole]
    return None


def _rest(closed: ClosedLoop, references: Mapping[str, float], near: OperatingPoint, trial: _Trial) -> Rest:
    plant, block = closed.plant, closed.controller
    y = dict(zip(names(plant.outputs), np.asarray(plant.h(trial.x, trial.u, near.p)).ravel(), strict=True))
    inputs = {n: float(y[closed.sensors[n]]) if n in closed.sensors else references[n] for n in names(block.inputs)}
    state = dict(zip((s.name for s in block.states), map(float, trial.state), strict=True))
    derivative = float(np.abs(np.asarray(plant.f(trial.x, trial.u, near.p))).max(initial=0.0))
    signals = (*plant.states, *plant.inputs)
    values = np.concatenate([trial.x, trial.u])
    outside = tuple(s.name for s, v in zip(signals, values, strict=True) if not s.low <= v <= s.high)
    point = OperatingPoint(trial.x, trial.u, near.p, derivative, near.states, near.inputs, outside)
    return Rest(closed, point, state, inputs, trial.size)


def _require_sound(rest: Rest) -> None:
    """Raise ModelError where the controller raises a fault at rest."""
    block = rest.closed.controller
    flags = [f.output for f in block.faults]
    symbols = {
        **{n: block.symbol[n] for n in (*rest.state, *rest.inputs)},
        **{c.name: block.symbol[c.name] for c in block.constants},
    }
    values = [*rest.state.values(), *rest.inputs.values(), *(c.value for c in block.constants)]
    raised = ca.Function("flags", list(symbols.values()), [ca.vcat([block.output[f] for f in flags])])(*values)
    if on := [f for f, value in zip(flags, np.asarray(raised).ravel(), strict=True) if value]:
        raise ModelError(
            f"the controller '{block.name}' raises {', '.join(on)} at rest, with inputs "
            f"{', '.join(f'{n} = {v:.6g}' for n, v in rest.inputs.items())}: rest within the declared ranges"
        )


def _refusal(closed: ClosedLoop, equations: _Equations, trial: _Trial | None) -> ModelError:
    what = f"the loop of plant '{closed.plant.name}' under '{closed.controller.name}'"
    if trial is None or not np.isfinite(trial.residual).all() or len(trial.residual) < len(equations.unknowns):
        return ModelError(f"{what} has no rest: it is not finite, or counts without end; start it nearer to its trim")
    worst = int(np.abs(trial.residual).argmax())
    signal = equations.unknowns[worst]
    change = trial.residual[worst] * equations.scale[worst]
    return ModelError(
        f"{what} does not rest: '{signal.name}' still changes by {change:.4g} {signal.unit} in a period at best; give "
        "references that its plant can rest at, or a controller that stabilises it there"
    )
