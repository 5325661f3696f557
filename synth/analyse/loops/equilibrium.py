"""Equilibrium of a sampled closed loop, and the loop linearised and opened there.

    0   = f(x, u, p)                                  the plant in equilibrium
    x_c = F(x_c, m),   m = S h(x, u, p), references   a fixed point of the controller's step
    u   = U G(x_c, m)                                 whose command is this input

The unknowns are the plant's states x, its actuated inputs u and the controller's real states x_c. They must be solved
together: an integrator alone may rest at any value, and the input that the plant needs determines this value. Newton's
method with the minimum-norm step solves the equations, each unknown relative to half the width of its range. It starts
at the plant's trim with the initial state of the controller, then at later samples of the simulated loop. Counters and
flags are stepped until they are constant. A state that no step changes holds its initial value.

Equilibrium equations of a sampled closed loop, in the plant's states x and inputs u and the controller's state c.

    T f(x, u, p) = 0,   F(c, S h(x, u, p)) - c = 0,   U G(c, S h(x, u, p)) - u = 0

each relative to half the width of its signal's range. Newton's method with the minimum-norm step solves them, from
starting points that this module also gives.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache
from itertools import pairwise

import casadi as ca
import numpy as np

from synth import arguments
from synth.analyse import operating_points
from synth.analyse.loops import loop
from synth.analyse.operating_points import OperatingPoint
from synth.block import Block, clip
from synth.errors import NoEquilibriumError, SignalError
from synth.plant import Plant
from synth.signals import Signal, signal_names
from synth.statespace import Array, StateSpace

ITERATIONS = 60
START_SAMPLES = (0, 1, 10, 100, 1000, 10_000)  # samples of the simulated loop at which Newton's method starts
MOST_COUNTS = 100_000  # samples within which counters and flags must become constant
RANK = 1e-12  # of the largest singular value of the scaled equations: a smaller one counts as zero
SUBSTEPS = 4  # of the Runge-Kutta method in a period

Wires = Mapping[str, str | Mapping[str, float]]


@arguments.checked
@dataclass(frozen=True, eq=False)
class SampledLoop:
    """A plant under a controller.

    `sensors[controller input] = plant output`; `actuators[plant input] = controller output`, or a sum of them,
    {controller output: weight}. Commands act with a delay of `delay` samples. Other inputs of the controller are
    references, other inputs of the plant disturbances. `coordinates` {name: {sensor: weight}} are sums of sensors at
    which the loop can open.

    Raises SignalError for a wire with an unknown end.
    """

    plant: Plant
    controller: Block
    sensors: Mapping[str, str]
    actuators: Wires
    delay: float = 1
    coordinates: Mapping[str, Mapping[str, float]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        ends = (
            ("sensors", self.sensors, signal_names(self.controller.inputs)),
            ("sensors", self.sensors.values(), signal_names(self.plant.outputs)),
            ("actuators", self.actuators, signal_names(self.plant.inputs)),
            ("actuators", [c for row in self.mixing.values() for c in row], signal_names(self.controller.outputs)),
        )
        for what, listed, known in ends:
            for name in listed:
                if name not in known:
                    raise SignalError(f"{what}: '{name}' is not one of {', '.join(known)}: correct the name")

    @property
    def references(self) -> tuple[str, ...]:
        """The controller's inputs that no sensor drives."""
        return tuple(n for n in signal_names(self.controller.inputs) if n not in self.sensors)

    @property
    def mixing(self) -> dict[str, dict[str, float]]:
        """The weights of the controller's outputs in each actuated input."""
        return {u: {w: 1.0} if isinstance(w, str) else dict(w) for u, w in self.actuators.items()}


@dataclass(frozen=True, eq=False)
class Trial:
    """The plant's states x and inputs u, the controller's states, and the scaled residual of each equation."""

    x: Array
    u: Array
    state: Array
    residual: Array

    @property
    def size(self) -> float:
        return float(np.abs(self.residual).max(initial=0.0)) if np.isfinite(self.residual).all() else np.inf


@dataclass(frozen=True, eq=False)
class _Functions:
    """The equilibrium equations of a loop, as functions of x, u, the controller's state and the `constants` of a case.

    The constants are the plant's parameters and the references; `scale` is that of the unknowns.
    """

    unknowns: tuple[Signal, ...]
    actuated: Array
    real: Array
    scale: Array
    residual: ca.Function
    slope: ca.Function
    step: ca.Function
    flow: ca.Function


@lru_cache(maxsize=8)  # a loop comes to rest at many points, with many values of its constants
def _functions(closed: SampledLoop) -> _Functions:
    plant, block, T = closed.plant, closed.controller, closed.controller.time.period_s
    x, u, c = ca.SX.sym("x", len(plant.states)), ca.SX.sym("u", len(plant.inputs)), ca.SX.sym("c", len(block.states))
    p, r = ca.SX.sym("p", len(plant.parameters)), ca.SX.sym("r", len(closed.references))
    outputs = dict(zip(signal_names(plant.outputs), ca.vertsplit(plant.h(x, u, p)), strict=True))
    inputs = {n: outputs[y] for n, y in closed.sensors.items()}
    inputs |= zip(closed.references, ca.vertsplit(r), strict=True)
    next_state, y = block.function()(c, ca.vcat([inputs[n] for n in signal_names(block.inputs)]))
    commands = dict(zip(signal_names(block.outputs), ca.vertsplit(y), strict=True))
    actuated = [i for i, n in enumerate(signal_names(plant.inputs)) if n in closed.actuators]
    rows = [closed.mixing[plant.inputs[i].name] for i in actuated]
    commanded = ca.SX(u)
    for i, row in zip(actuated, rows, strict=True):
        commanded[i] = sum((weight * commands[name] for name, weight in row.items()), start=ca.SX(0))
    holds = [ca.is_equal(next_state[i], clip(c[i], s.signal), 2) for i, s in enumerate(block.states)]
    real = [i for i, s in enumerate(block.states) if not (s.integer or holds[i])]
    unknowns = (*plant.states, *(plant.inputs[i] for i in actuated), *(block.states[i].signal for i in real))
    widths = np.array([s.high / 2 - s.low / 2 for s in unknowns])
    scale = np.where(np.isfinite(widths) & (widths > 0), widths, 1.0)
    changes = ca.vertcat(T * plant.f(x, u, p), commanded[actuated] - u[actuated], next_state[real] - c[real]) / scale
    free = ca.vertcat(x, u[actuated], c[real])
    slope = ca.jacobian(changes, free) @ ca.diag(ca.DM(scale))
    places = [x, u, c, ca.vertcat(p, r)]
    return _Functions(
        unknowns,
        np.array(actuated, dtype=int),
        np.array(real, dtype=int),
        scale,
        ca.Function("residual", places, [ca.densify(changes)]),
        ca.Function("slope", places, [ca.densify(slope)]),
        ca.Function("step", places, [ca.densify(next_state), ca.densify(commanded)]),
        ca.Function("flow", places, [_runge_kutta(plant, x, u, p, T)]),
    )


def _runge_kutta(plant: Plant, x: ca.SX, u: ca.SX, p: ca.SX, T: float) -> ca.SX:
    h = T / SUBSTEPS
    for _ in range(SUBSTEPS):
        k1 = plant.f(x, u, p)
        k2 = plant.f(x + h / 2 * k1, u, p)
        k3 = plant.f(x + h / 2 * k2, u, p)
        x = x + h / 6 * (k1 + 2 * (k2 + k3) + plant.f(x + h * k3, u, p))
    return x


@dataclass(frozen=True, eq=False)
class Equations:
    """The equilibrium equations with the constants of a case.

    `residual` returns the change of each unknown in a period, relative to its scale, and `slope` its Jacobian with
    respect to the scaled unknowns. `step` returns the controller's next state and the inputs that it commands, `flow`
    the plant's next state.
    """

    of_loop: _Functions
    constants: Array

    def values(self, function: ca.Function, x: Array, u: Array, state: Array) -> list[Array]:
        """Return the results of one of the functions, scalars and columns as (k,)."""
        return [np.asarray(v) for v in function.call([x, u, state, self.constants])]

    def trial(self, x: Array, u: Array, state: Array) -> Trial:
        return Trial(x, u, state, self.values(self.of_loop.residual, x, u, state)[0].ravel())

    def displaced(self, at: Trial, by: Array) -> Trial:
        n, m = len(at.x), len(self.of_loop.actuated)
        x, u, state = at.x + by[:n], at.u.copy(), at.state.copy()
        u[self.of_loop.actuated] += by[n : n + m]
        state[self.of_loop.real] += by[n + m :]
        return self.trial(x, u, state)


def of_loop(closed: SampledLoop, references: Mapping[str, float], near: OperatingPoint) -> Equations:
    return Equations(_functions(closed), np.array([*near.p, *(references[n] for n in closed.references)]))


def starting_points(equations: Equations, closed: SampledLoop, near: OperatingPoint) -> Iterator[Trial]:
    """Yield the simulated loop after some samples, with a command delay of one sample, as long as it is finite."""
    x, u, state = near.x.copy(), near.u.copy(), closed.controller.initial
    for before, until in pairwise((0, *START_SAMPLES)):
        for _ in range(before, until):
            next_state, commanded = (v.ravel() for v in equations.values(equations.of_loop.step, x, u, state))
            x, u, state = equations.values(equations.of_loop.flow, x, u, state)[0].ravel(), commanded, next_state
        if not (np.isfinite(x).all() and np.isfinite(u).all() and np.isfinite(state).all()):
            return
        yield equations.trial(x, u, state)


def rest_from(equations: Equations, trial: Trial) -> Trial:
    """Solve for the real unknowns with counters and flags held, step these, and repeat until all are constant."""
    for _ in range(len(trial.state) + 1):
        trial = _newton(equations, trial)
        stepped = _step_counters(equations, trial)
        if stepped is None or np.array_equal(stepped.state, trial.state):
            return trial if stepped is not None else replace(trial, residual=np.array([np.inf]))
        trial = stepped
    return trial


def _newton(equations: Equations, trial: Trial) -> Trial:
    for _ in range(ITERATIONS):
        slope = equations.values(equations.of_loop.slope, trial.x, trial.u, trial.state)[0]
        if not (np.isfinite(slope).all() and np.isfinite(trial.residual).all()):
            return trial
        move = -equations.of_loop.scale * np.linalg.lstsq(slope, trial.residual, rcond=RANK)[0]
        better = next(
            (t for t in (equations.displaced(trial, move / 2**i) for i in range(12)) if t.size < trial.size), None
        )
        if better is None:
            return trial
        trial = better
    return trial


def _step_counters(equations: Equations, trial: Trial) -> Trial | None:
    """Return the trial with counters and flags in their steady state, all else held; None if they have none."""
    state = trial.state.copy()
    whole = np.setdiff1d(np.arange(len(state)), equations.of_loop.real)
    seen: set[bytes] = set()
    while state[whole].tobytes() not in seen and len(seen) < MOST_COUNTS:
        seen.add(state[whole].tobytes())
        next_state = equations.values(equations.of_loop.step, trial.x, trial.u, state)[0].ravel()
        if np.array_equal(next_state[whole], state[whole]):
            return equations.trial(trial.x, trial.u, state)
        state[whole] = next_state[whole]
    return None


__all__ = ["Equilibrium", "SampledLoop", "open_loop", "solve"]

TOLERANCE = 1e-9  # of half the width of a signal's range; for a change, in one period


@arguments.checked
@dataclass(frozen=True, eq=False)
class Equilibrium:
    """Equilibrium of a loop: the plant's operating point, the controller's states and inputs, by name, in their units.

    The parameters of the plant are those of `point`.

    `residual` is the largest error of an equation, or change in a period, relative to half the width of its signal's
    range.
    """

    closed: SampledLoop
    point: OperatingPoint
    state: Mapping[str, float]
    inputs: Mapping[str, float]
    residual: float

    @cached_property
    def controller(self) -> StateSpace:
        """The controller's Jacobians at the equilibrium, at constant references."""
        return loop.linearise_block(self.closed.controller, self.state, self.inputs, self.closed.references)

    @cached_property
    def plant(self) -> StateSpace:
        """The plant's Jacobians at the equilibrium."""
        return operating_points.linearise(self.closed.plant, self.point)


@arguments.checked
def open_loop(rest: Equilibrium, signal: str | Sequence[str]) -> StateSpace:
    """Return the sampled L from `signal`, an actuator, sensor or coordinate, to minus ``<signal>_out`` at equilibrium.

    An actuator has the name of the plant's input, a sensor that of the controller's input; with several names L opens
    at all of them. At an actuator the loop opens before the delay and after the point where the controller observes the
    command. Arguments and errors are those of `loop.open_loop`.
    """
    closed = rest.closed
    return loop.open_loop(
        rest.plant, rest.controller, signal, closed.sensors, closed.actuators, closed.delay, closed.coordinates
    )


@arguments.checked
def solve(closed: SampledLoop, references: Mapping[str, float], near: OperatingPoint) -> Equilibrium:
    """Return the equilibrium of the loop at constant `references`; `near` is a trim of the plant close to it.

    Disturbances are those of `near`. Without integral action the equilibrium differs slightly from the trim.

    A plant with several equilibria, such as one with cogging, or a command at the end of its range may lead the search
    to one out of range; it then goes on from the next starting point. At an actuator's limit a loop comes to rest by
    its anti-windup, but has no gain there: it is no equilibrium whose margins mean anything.

    Raises SignalError for a missing or unknown reference, or an operating point of another plant; NoEquilibriumError
    with the signal that still changes, with the commands at their limits, or with the faults of the first equilibrium
    where each one raises some.
    """
    _check(closed, references, near)
    equations = of_loop(closed, references, near)
    least: Trial | None = None
    balanced = [(near.x, near.u)]  # where the plant balances: its trim, and under the commands of the law
    refused: list[Equilibrium] = []
    for start in starting_points(equations, closed, near):
        trial = rest_from(equations, start)
        if trial.size <= TOLERANCE:
            rest = _equilibrium(closed, references, near, trial)
            if not (_raised_faults(rest) or _commands_at_limit(rest) or rest.point.outside):
                return rest
            refused.append(rest)
        if np.abs(trial.residual[: len(trial.x) + len(equations.of_loop.actuated)]).max(initial=0.0) <= TOLERANCE:
            balanced.append((trial.x, trial.u))
        least = trial if least is None or trial.size < least.size else least
    without_fault = [rest for rest in refused if not _raised_faults(rest)]
    for rest in without_fault:
        if not _commands_at_limit(rest):
            return rest
    if without_fault:
        raise _at_limit(without_fault[0])
    for x, u in balanced[:2]:
        if beyond := _beyond_range(closed, near, x, u):
            raise NoEquilibriumError(beyond)
    raise _at_fault(refused[0]) if refused else _no_rest(closed, equations, least)


def _check(closed: SampledLoop, references: Mapping[str, float], near: OperatingPoint) -> None:
    missing = [n for n in closed.references if n not in references]
    unknown = [n for n in references if n not in closed.references]
    if missing or unknown:
        raise SignalError(
            f"references of '{closed.controller.name}': missing {missing or 'none'}, not known {unknown or 'none'}: "
            f"give a value for each of {', '.join(closed.references) or 'none'}"
        )
    operating_points.require_point(closed.plant, near)


def _equilibrium(
    closed: SampledLoop, references: Mapping[str, float], near: OperatingPoint, trial: Trial
) -> Equilibrium:
    plant, block = closed.plant, closed.controller
    y = dict(zip(signal_names(plant.outputs), np.asarray(plant.h(trial.x, trial.u, near.p)).ravel(), strict=True))
    inputs = {
        n: float(y[closed.sensors[n]]) if n in closed.sensors else references[n] for n in signal_names(block.inputs)
    }
    state = dict(zip((s.name for s in block.states), map(float, trial.state), strict=True))
    derivative = float(np.abs(np.asarray(plant.f(trial.x, trial.u, near.p))).max(initial=0.0))
    signals = (*plant.states, *plant.inputs)
    values = np.concatenate([trial.x, trial.u])
    outside = tuple(s.name for s, v in zip(signals, values, strict=True) if not s.low <= v <= s.high)
    point = OperatingPoint(trial.x, trial.u, near.p, derivative, near.states, near.inputs, outside)
    return Equilibrium(closed, point, state, inputs, trial.size)


def _raised_faults(rest: Equilibrium) -> list[str]:
    """Return the faults that the controller raises at equilibrium."""
    flags = [f.output for f in rest.closed.controller.faults if not f.status]
    return [f for f, value in _outputs(rest, flags).items() if value]


def _commands_at_limit(rest: Equilibrium) -> dict[str, float]:
    """Return the commands at an end of their declared range, where a limit holds them."""
    signals = {s.name: s for s in rest.closed.controller.outputs}
    commands = _outputs(rest, list(dict.fromkeys(c for row in rest.closed.mixing.values() for c in row)))
    room = {n: min(v - signals[n].low, signals[n].high - v) for n, v in commands.items()}
    return {n: v for n, v in commands.items() if room[n] < TOLERANCE * (signals[n].high - signals[n].low) / 2}


def _outputs(rest: Equilibrium, names: Sequence[str]) -> dict[str, float]:
    """Return outputs of the controller at equilibrium."""
    block = rest.closed.controller
    symbols = {
        **{n: block.symbol[n] for n in (*rest.state, *rest.inputs)},
        **{c.name: block.symbol[c.name] for c in block.constants},
    }
    values = [*rest.state.values(), *rest.inputs.values(), *(c.value for c in block.constants)]
    outputs = ca.Function("outputs", list(symbols.values()), [ca.vcat([block.output[n] for n in names])])(*values)
    return dict(zip(names, np.asarray(outputs).ravel().tolist(), strict=True))


def _at_limit(rest: Equilibrium) -> NoEquilibriumError:
    block = rest.closed.controller
    signals = {s.name: s for s in block.outputs}
    commands = [
        f"{n} = {v:.6g} of {signals[n].low:g} .. {signals[n].high:g} {signals[n].unit}"
        for n, v in _commands_at_limit(rest).items()
    ]
    return NoEquilibriumError(
        f"the controller '{block.name}' rests with a command at its limit, {', '.join(commands)}, and no gain there: "
        "choose a point that the actuators can hold, or widen their range"
    )


def _at_fault(rest: Equilibrium) -> NoEquilibriumError:
    block = rest.closed.controller
    inputs = ", ".join(f"{name} = {value:.9g}" for name, value in rest.inputs.items())
    ranges = [
        f"{s.name} in {s.low:g} .. {s.high:g} {s.unit}"
        for s in block.inputs
        if not s.low <= rest.inputs[s.name] <= s.high
    ]
    return NoEquilibriumError(
        f"the controller '{block.name}' raises {', '.join(_raised_faults(rest))} at rest, with inputs {inputs}: rest "
        f"within the declared ranges{', ' * bool(ranges)}{', '.join(ranges)}"
    )


def _beyond_range(closed: SampledLoop, near: OperatingPoint, x: Array, u: Array) -> str:
    """Return why the loop does not rest at a state of the plant whose readings are beyond the sensors' ranges."""
    plant = closed.plant
    outputs = dict(zip(signal_names(plant.outputs), np.asarray(plant.h(x, u, near.p)).ravel().tolist(), strict=True))
    ranges = {s.name: s for s in closed.controller.inputs}
    readings = [
        f"'{name}' reads {y:.6g} of {s.low:g} .. {s.high:g} {s.unit}"
        for name, output in closed.sensors.items()
        for s, y in [(ranges[name], outputs[output])]
        if not -TOLERANCE <= (y - s.low) / (s.high - s.low) <= 1 + TOLERANCE
    ]
    if not readings:
        return ""
    return (
        f"the loop of plant '{plant.name}' under '{closed.controller.name}' would balance where sensor "
        f"{', '.join(readings)}, which the guard refuses: give the sensor a range that contains it, or choose a point "
        "inside, or a law that leaves less of an error there"
    )


def _no_rest(closed: SampledLoop, equations: Equations, trial: Trial | None) -> NoEquilibriumError:
    what = f"the loop of plant '{closed.plant.name}' under '{closed.controller.name}'"
    if trial is None or not np.isfinite(trial.residual).all() or len(trial.residual) < len(equations.of_loop.unknowns):
        return NoEquilibriumError(
            f"{what} has no rest: it is not finite, or counts without end; start it closer to its trim"
        )
    worst = int(np.abs(trial.residual).argmax())
    signal = equations.of_loop.unknowns[worst]
    change = trial.residual[worst] * equations.of_loop.scale[worst]
    return NoEquilibriumError(
        f"{what} does not rest: '{signal.name}' still changes by {change:.4g} {signal.unit} in a period at best; give "
        "references that its plant can rest at, or a controller that stabilises it there"
    )
