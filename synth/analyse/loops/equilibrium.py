"""Equilibrium of a sampled closed loop, and the loop linearised and opened there.

    0   = f(x, u, p)                                  the plant in equilibrium
    x_c = F(x_c, m),   m = S h(x, u, p), references   a fixed point of the controller's step
    u   = U G(x_c, m)                                 whose command is this input

The unknowns are the plant's states x, its actuated inputs u and the controller's real states x_c. They must be solved
together: an integrator alone may rest at any value, and the input that the plant needs determines this value. Newton's
method with the minimum-norm step solves the equations, each unknown relative to half the width of its range. It starts
at the plant's trim with the initial state of the controller, then at later samples of the simulated loop. Counters and
flags are stepped until they are constant.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np

from synth import arguments
from synth.analyse import linearisation
from synth.analyse.loops import equilibrium_equations, loop
from synth.analyse.loops.equilibrium_equations import SampledLoop
from synth.analyse.operating_points import OperatingPoint
from synth.errors import NoEquilibriumError, SignalError
from synth.signals import signal_names
from synth.statespace import StateSpace

__all__ = ["Equilibrium", "SampledLoop", "open_loop", "solve"]

TOLERANCE = 1e-9  # of half the width of a signal's range; for a change, in one period


@arguments.checked
@dataclass(frozen=True, eq=False)
class Equilibrium:
    """Equilibrium of a loop: the plant's operating point, the controller's states and inputs, by name, in their units.

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
        """The controller's Jacobians at the equilibrium."""
        return loop.linearise_block(self.closed.controller, self.state, self.inputs)

    @cached_property
    def plant(self) -> StateSpace:
        """The plant's Jacobians at the equilibrium."""
        return linearisation.linearise(self.closed.plant, self.point)


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
    equations = equilibrium_equations.of_loop(closed, references, near)
    least: equilibrium_equations.Trial | None = None
    refused: list[Equilibrium] = []
    for start in equilibrium_equations.starting_points(equations, closed, near):
        trial = equilibrium_equations.rest_from(equations, start)
        if trial.size <= TOLERANCE:
            rest = _equilibrium(closed, references, near, trial)
            if not (_raised_faults(rest) or _commands_at_limit(rest) or rest.point.outside):
                return rest
            refused.append(rest)
        least = trial if least is None or trial.size < least.size else least
    without_fault = [rest for rest in refused if not _raised_faults(rest)]
    for rest in without_fault:
        if not _commands_at_limit(rest):
            return rest
    if without_fault:
        raise _at_limit(without_fault[0])
    raise _at_fault(refused[0]) if refused else _no_rest(closed, equations, least)


def _check(closed: SampledLoop, references: Mapping[str, float], near: OperatingPoint) -> None:
    missing = [n for n in closed.references if n not in references]
    unknown = [n for n in references if n not in closed.references]
    if missing or unknown:
        raise SignalError(
            f"references of '{closed.controller.name}': missing {missing or 'none'}, not known {unknown or 'none'}: "
            f"give a value for each of {', '.join(closed.references) or 'none'}"
        )
    linearisation.require_point(closed.plant, near)


def _equilibrium(
    closed: SampledLoop, references: Mapping[str, float], near: OperatingPoint, trial: equilibrium_equations.Trial
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


def _no_rest(
    closed: SampledLoop, equations: equilibrium_equations.Equations, trial: equilibrium_equations.Trial | None
) -> NoEquilibriumError:
    what = f"the loop of plant '{closed.plant.name}' under '{closed.controller.name}'"
    if trial is None or not np.isfinite(trial.residual).all() or len(trial.residual) < len(equations.unknowns):
        return NoEquilibriumError(
            f"{what} has no rest: it is not finite, or counts without end; start it closer to its trim"
        )
    worst = int(np.abs(trial.residual).argmax())
    signal = equations.unknowns[worst]
    change = trial.residual[worst] * equations.scale[worst]
    return NoEquilibriumError(
        f"{what} does not rest: '{signal.name}' still changes by {change:.4g} {signal.unit} in a period at best; give "
        "references that its plant can rest at, or a controller that stabilises it there"
    )
