"""Input-output linearising inverse as Blocks, with the effect of the actuators' limits on the demands (anti-windup).

    w ---> [ i = D(x)^-1 (w - a(x)) ] ---> <actuator>_demand ---> limits ---> <actuator>_excess
                                                                                   v
    <w>_limited, <w>_excess  <-----  [ <w>_excess = D(x) <actuator>_excess,  <w>_limited = a(x) + D(x) <actuator> ]

The first Block converts the demands w, the r-th derivatives of the outputs, to actuator commands. The second converts
the limited commands back to the achieved derivatives. x is the plant's state when the actuators act. Its elements are
predicted by the axes that estimate them, and measured otherwise. They are limited to the plant's domain, outside which
the law is not defined. Source: `feedback_linearisation`.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import casadi as ca
import numpy as np

from synth.analyse.numerics import box
from synth.block import Block, Exprs, Step, build, clip
from synth.blocks.laws.axis_regulator import Axis
from synth.declare.stage import Interface
from synth.errors import SignalError
from synth.signals import Signal, signal_names
from synth.statespace import Array
from synth.synthesise.nonlinear.feedback_linearisation import Linearisation
from synth.timing import Discrete

MARGIN = 1.1  # factor on a bound: room for rounding, and for maxima between the sample points
POINTS, SEED = 256, 11  # number of sample points in the plant's box, in addition to its vertices
DEMAND_FACTOR = 4.0  # largest demand considered for the bounds of the law's inputs, relative to the achievable one
UNBOUNDED = 1e30  # bound of an internal signal whose range is not known


@dataclass(frozen=True)
class Command:
    """The names of a command and of its excess, and the signal `limited`, the part of the command that is achieved."""

    name: str
    excess: str
    limited: Signal

    def signal(self, bound: float = UNBOUNDED) -> Signal:
        """Return the command's signal, in -bound .. bound."""
        return replace(self.limited, name=self.name, low=-bound, high=bound, about="before the limits")

    def excess_signal(self, bound: float = UNBOUNDED) -> Signal:
        """Return the signal of the excess, which is the limited minus the commanded value, in -bound .. bound."""
        return replace(self.limited, name=self.excess, low=-bound, high=bound, about="limited less commanded")


def command(axis: Axis, interface: Interface) -> Command:
    """Return the demand of an axis on the inverse, limited to what the actuators can achieve in the plant's box.

    Raises SignalError for an axis without an inverse.
    """
    unit = axis.model.unit(axis.command) or "1"
    bound = _demand_bound(_inverse(axis), axis.output, interface)
    limited = Signal(f"{axis.command}_limited", unit, -bound, bound, "what the actuators make of the demand")
    return Command(f"{axis.command}_command", f"{axis.command}_excess", limited)


def _inverse(axis: Axis) -> Linearisation:
    if axis.inverse is None:
        raise SignalError(
            f"the axis of '{axis.output}' has no inverse: give it a chain of integrators from a feedback linearisation"
        )
    return axis.inverse


def predicted_states(axis: Axis) -> dict[str, Signal]:
    """Return {plant state: signal of its prediction} for the states that the axis estimates and the inverse needs."""
    if axis.inverse is None:
        return {}
    needed = _states_in_law(axis.inverse)
    return {s.name: replace(s, name=f"{s.name}_predicted") for s in needed if s.name in axis.model.states}


def _states_in_law(inverse: Linearisation) -> list[Signal]:
    """Return the plant's states on which the law, the drift or the decoupling matrix depends."""
    model = inverse.degree.model
    exprs = ca.vertcat(inverse.u, ca.vec(inverse.degree.decoupling), inverse.degree.drift)
    return [model.states[k] for k in box.signal_indices(exprs, inverse.x, model.states)]


def blocks(time: Discrete, axes: Sequence[Axis], commands: Mapping[str, Command], interface: Interface) -> list[Block]:
    """Return two Blocks: from the commands {output: Command} of the axes to the actuators' demands, and back.

    Raises SignalError for an output without an axis, an input without an actuator, or a state that is neither estimated
    by an axis nor measured.
    """
    inverse = _inverse(axes[0])
    outputs = inverse.degree.outputs
    if missing := [name for name in outputs if name not in commands]:
        raise SignalError(
            f"the feedback linearisation also needs the demand of '{missing[0]}': join the axes of "
            f"{', '.join(outputs)} by axis.decouple"
        )
    state_signals = _StateSignals(inverse, _states(inverse, axes, interface))
    actuators, bounds = _actuators(inverse, interface), _actuator_bounds(inverse, commands)
    demands = [commands[name].signal() for name in outputs]
    actuator_demands = [interface.demand(a, b) for a, b in zip(actuators, bounds, strict=True)]
    actuator_excess = [interface.excess(a, b) for a, b in zip(actuators, bounds, strict=True)]
    computed = [interface.computed_output(a) for a in actuators]

    def invert(u: Exprs, x: Exprs, k: Exprs) -> Step:
        w = ca.vertcat(*(u[s.name] for s in demands))
        actuator_values = ca.substitute(state_signals.signals(inverse.u, u), inverse.w, w)
        return Step({s.name: actuator_values[i] for i, s in enumerate(actuator_demands)})

    def achieved_demands(u: Exprs, x: Exprs, k: Exprs) -> Step:
        a, D = (state_signals.signals(e, u) for e in (inverse.degree.drift, inverse.degree.decoupling))
        excess_demands = ca.mtimes(D, ca.vertcat(*(u[s.name] for s in actuator_excess)))
        achieved = a + ca.mtimes(D, ca.vertcat(*(u[s.name] for s in computed)))
        output = {commands[name].excess: excess_demands[i] for i, name in enumerate(outputs)}
        limited = [commands[name].limited for name in outputs]
        return Step(output | {s.name: clip(achieved[i], s) for i, s in enumerate(limited)})

    states, name = list(state_signals.states.values()), "_".join(outputs)
    achieved_signals = [s for name in outputs for s in (commands[name].excess_signal(), commands[name].limited)]
    tag = f"feedback linearisation of {', '.join(outputs)}"
    return [
        build(f"inverse_{name}", time, invert, inputs=[*states, *demands], outputs=actuator_demands, tag=tag),
        build(
            f"achieved_{name}",
            time,
            achieved_demands,
            inputs=[*states, *actuator_excess, *computed],
            outputs=achieved_signals,
            tag=tag,
        ),
    ]


@dataclass(frozen=True, eq=False)
class _StateSignals:
    """The signals from which the law takes the plant's states, by state."""

    inverse: Linearisation
    states: Mapping[str, Signal]

    def signals(self, expr: ca.SX, u: Exprs) -> ca.SX:
        """Replace the plant's states in an expression by their signals, limited to the plant's domain."""
        domain = self.inverse.degree.model.states
        for symbol, state in zip(ca.vertsplit(self.inverse.x), domain, strict=True):
            if state.name in self.states:
                expr = ca.substitute(expr, symbol, clip(u[self.states[state.name].name], state))
        return expr


def _states(inverse: Linearisation, axes: Sequence[Axis], interface: Interface) -> dict[str, Signal]:
    signals = {name: s for axis in axes for name, s in predicted_states(axis).items()}
    sensors = {s.of: s.name for s in interface.sensors}
    for state in _states_in_law(inverse):
        if state.name not in signals:
            if state.name not in sensors:
                raise SignalError(
                    f"the feedback linearisation needs '{state.name}', which no axis estimates and no sensor measures: "
                    "linearise its output too, or measure it"
                )
            signals[state.name] = interface.held(sensors[state.name])
    return signals


def _actuators(inverse: Linearisation, interface: Interface) -> list[str]:
    actuators = {a.of: a.name for a in interface.actuators}
    if missing := [name for name in inverse.inputs if name not in actuators]:
        raise SignalError(
            f"the feedback linearisation has the input '{missing[0]}', which no actuator drives: "
            "hold it constant, or add an actuator"
        )
    return [actuators[name] for name in inverse.inputs]


def _sample_points(inverse: Linearisation, ranges: Mapping[str, tuple[float, float]]) -> tuple[Array, Array]:
    """Return k points, first the vertices of the box: states (n, k) in their ranges, and values (m, k) in `ranges`."""
    states = inverse.degree.model.states
    signals = [*states, *(Signal(name, "1", low, high) for name, (low, high) in ranges.items())]
    corners = np.array(np.meshgrid(*([0.0, 1.0] for _ in signals))).reshape(len(signals), -1)
    points = np.hstack([box.within(signals, corners), box.scatter(signals, POINTS, SEED)])
    return points[: len(states)], points[len(states) :]


def _demand_bound(inverse: Linearisation, output: str, interface: Interface) -> float:
    """Return the largest magnitude of the demanded derivative that the actuators can achieve."""
    signals = {a.of: interface.signals[a.name] for a in interface.actuators}
    degree, i = inverse.degree, inverse.degree.outputs.index(output)
    ranges = [signals.get(s.name, s) for s in degree.model.inputs]
    x, u = _sample_points(inverse, {s.name: (s.low, s.high) for s in ranges})
    symbols = ca.SX.sym("u", len(u))
    achieved = degree.drift[i] + ca.mtimes(degree.decoupling[i, :], symbols)
    function = ca.Function("achieved", [inverse.x, symbols], [ca.densify(achieved)])
    return round_up(MARGIN * float(np.abs(np.asarray(function(x, u))).max()))


def _actuator_bounds(inverse: Linearisation, commands: Mapping[str, Command]) -> list[float]:
    """Return bounds of the law's inputs in the plant's box, for demands up to DEMAND_FACTOR times the achievable."""
    outputs = signal_names(inverse.degree.model.outputs)
    largest = {name: DEMAND_FACTOR * commands[name].limited.high for name in outputs}
    x, w = _sample_points(inverse, {f"w_{name}": (-b, b) for name, b in largest.items()})
    return [round_up(MARGIN * float(v)) for v in np.abs(np.asarray(inverse.law(x, w))).max(axis=1)]


def round_up(value: float) -> float:
    """Return a bound rounded up to two digits, so that it is the same on every machine; 1e-30 for a bound of 0."""
    if not value:
        return 1e-30
    scale = 10.0 ** (np.floor(np.log10(value)) - 1)
    return float(f"{np.ceil(value / scale) * scale:.2g}")
