"""Control axes as parts of a stage's controller: from a model and weights to Blocks, gains and bounds of all states.

    <output>_error, _held --> [ servo_<output> ] --> w_<output>_command --> [ inverse ] --> <actuator>_demand --> limits
                                   ^ made of w  <------------- [ made ] <----------------- <actuator>_excess <------'

`axis_regulator` states the problem that one axis solves. An axis whose model is a chain of a feedback linearisation
has its demand turned into actuators' values by the inverse of the plant, at the states that the estimator predicts for
the time when these values act; what the actuators' limits leave of the demand goes back to estimator and anti-windup.
The axis of a linear model commands its actuator itself.

While it is told what the actuator really does, an axis is a stable system whether that is at its limit or not: its
internal model follows the actuator (A - E C), its estimator decays. So its states' bounds are those that its inputs in
their ranges can drive it to (`reach`), and no tuning.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import casadi as ca
import numpy as np

from synth import arguments
from synth.analyse import box, reach, structure
from synth.block import Block, Exprs, Step, build, clip
from synth.declaration import Interface, Law
from synth.errors import SignalError
from synth.signals import Signal, names
from synth.statespace import Array, StateSpace, System, of
from synth.synthesise import axis_regulator, estimator_start, internal_model, linear_block
from synth.synthesise.axis_regulator import Axis, Kalman, Regulator
from synth.synthesise.feedback_linearisation import Chain, Linearisation
from synth.timing import Discrete

MARGIN = 1.1  # of a bound: room for rounding in single precision
POINTS, SEED = 256, 11  # scattered over the plant's box, beside its vertices


@dataclass(frozen=True, eq=False)
class ServoLaw:
    """Axes that are synthesised when the rate and the interface are known; several share one inverse of the plant."""

    axes: tuple[Axis, ...]

    def law(self, time: Discrete, interface: Interface) -> Law:
        """Return the Blocks of the axes at a rate, for the delay, ranges and limits of an interface.

        Raises SignalError for an output without sensor or set-point, a command without actuator, and for an inverse
        that takes the demands of other axes too; else as `axis_regulator.synthesise`.
        """
        regulators = [axis_regulator.synthesise(axis, time, interface.delay) for axis in self.axes]
        blocks = [block for r in regulators for block in _servo(r, interface)]
        if (inverse := self.axes[0].inverse) is not None:
            blocks += _inverse(inverse, regulators, interface)
        name = "_".join(axis.output for axis in self.axes)
        return Law(name, tuple(blocks), lambda scalar: {r.axis.output: r.document() for r in regulators})


@arguments.checked
def kalman(process: Mapping[str, float], sensor: Mapping[str, float]) -> Kalman:
    """Ask for a Kalman filter, like kalman({"v": 3e-8}, {"z": 1e-14}) in m^2/s^3 and m^2.

    Raises SignalError for no noise, or one that is not positive.
    """
    for what, noise in (("process", process), ("sensor", sensor)):
        if not noise or not all(0 < v < np.inf for v in noise.values()):
            raise SignalError(f"the {what} noise is {dict(noise)}: give {{name: positive number}}, one at least")
    return Kalman(process, sensor)


@arguments.checked
def servo(
    model: System | Chain,
    *,
    modes: Mapping[float, float],
    weights: Mapping[str, float],
    effort: float,
    estimator: Kalman,
    anti_windup: float,
    set_point: float | None = None,
) -> ServoLaw:
    """Ask for one axis: the servo of the one output of `model`, which is measured, by its one input.

    model        a continuous StateSpace of one input and one output, about a resting point, or a Chain of a
                 `feedback_linearisation.Linearisation`; states without influence are left out
    modes        {frequency in rad/s: speed in 1/s}: the internal model holds constants (frequency 0) and sines, and the
                 error of each dies out at about its speed, as long as the loop is faster
    weights      {state or output: weight in 1/unit^2}, one on the output above 0
    effort       the weight on the command, in 1/unit^2; only ratios of `weights` and `effort` count
    estimator    the Kalman filter of the model's states from the output, as `kalman` asks for it
    anti_windup  the rate in 1/s at which the internal model follows the actuator while that is at its limit
    set_point    the part b >= 0 of the set-point that meets the output at the gains K_x, as in K_x (y - b r), 0 for none
                 and 1 for all; left out, the part whose zero cancels the pole that the mode 0 leaves at its speed, and
                 1 without that mode

    Raises SignalError for what does not fit; `ServoLaw.law` raises what only the sample period can tell.
    """
    inverse, plant = (model.law, model.model) if isinstance(model, Chain) else (None, structure.connected(of(model)))
    if (len(plant.inputs), len(plant.outputs)) != (1, 1):
        raise SignalError(
            f"an axis has one command and one output, the model has {', '.join(plant.inputs) or 'no input'} and "
            f"{', '.join(plant.outputs) or 'no output'}: select one of each with `channel`"
        )
    if plant.inputs == plant.outputs:
        raise SignalError(f"command and output of the axis are both called '{plant.inputs[0]}': rename one of them")
    _require_known("weights", weights, (*plant.states, *plant.outputs))
    _require_known("process noise", estimator.process, plant.states)
    _require_known("sensor noise", estimator.sensor, plant.outputs)
    internal_model.exosystem(list(modes))
    _require_positive("speed of a mode", modes, "1/s")
    _require_positive("effort", {plant.inputs[0]: effort}, f"1/{plant.unit(plant.inputs[0]) or 'unit'}^2")
    _require_positive("rate of the anti-windup", {plant.inputs[0]: anti_windup}, "1/s")
    if plant.outputs[0] not in weights:
        raise SignalError(
            f"there is no weight on '{plant.outputs[0]}', by which the speeds of the modes count: give one"
        )
    if set_point is not None and not 0 <= set_point < np.inf:
        raise SignalError(f"the part of the set-point is {set_point}: give a finite number of 0 or more")
    return ServoLaw((Axis(plant, inverse, dict(modes), dict(weights), effort, estimator, anti_windup, set_point),))


def _require_known(what: str, given: Mapping[str, float], known: Sequence[str]) -> None:
    if unknown := [name for name in given if name not in known]:
        raise SignalError(f"{what} of the axis: '{unknown[0]}' is not one of {', '.join(known)}: correct the name")
    _require_positive(what, given, "the inverse square of the unit")


def _require_positive(what: str, values: Mapping[Any, float], unit: str) -> None:
    for name, value in values.items():
        if not 0 < value < np.inf:
            raise SignalError(f"{what} ({name}) is {value}: give a finite number above 0, in {unit}")


@arguments.checked
def decoupled(axes: Sequence[ServoLaw]) -> ServoLaw:
    """Return axes on chains of one feedback linearisation as one law: its inverse takes all their demands.

    Raises SignalError for axes of unlike linearisations, or fewer or more than it has outputs.
    """
    joined = tuple(axis for law in axes for axis in law.axes)
    inverses = {id(axis.inverse): axis.inverse for axis in joined}
    inverse = joined[0].inverse if joined else None
    if len(inverses) != 1 or inverse is None:
        raise SignalError("the axes do not share one feedback linearisation: give axes on chains of the same one")
    if sorted(axis.output for axis in joined) != sorted(inverse.degree.outputs):
        raise SignalError(
            f"the axes are {', '.join(axis.output for axis in joined)}, but the feedback linearisation has the outputs "
            f"{', '.join(inverse.degree.outputs)}: give one axis for each"
        )
    return ServoLaw(joined)


@dataclass(frozen=True, eq=False)
class _Wires:
    """The signals of one axis, in the order of its controller's inputs but for the excess, and its command."""

    error: Signal
    limited: Signal
    measured: Signal
    reference: Signal
    excess: str
    command: str

    @property
    def bounds(self) -> Array:
        """The largest error, limited command, measurement and set-point."""
        return np.array([_largest(s) for s in (self.error, self.limited, self.measured, self.reference)])


def _servo(regulator: Regulator, interface: Interface) -> list[Block]:
    """Return the Block of one axis: internal model, estimator, gains."""
    axis, wires = regulator.axis, _wires(regulator.axis, interface)
    model = regulator.controller
    measured, late = [axis.output], [s for s in regulator.servo.plant.states if s not in axis.model.states]
    safe = {a.of: a.safe for a in interface.actuators}.get(axis.command, 0.0)
    start = estimator_start.from_measurement(model, regulator.servo.plant, measured, values=dict.fromkeys(late, safe))
    bounds = _state_bounds(model, wires)
    inputs = np.append(wires.bounds, 0.0)[[0, 1, 2, 4, 3]]  # the excess is within the command
    command = MARGIN * float(np.abs(model.C[0]) @ bounds + np.abs(model.D[0]) @ inputs)
    excess = Signal(
        wires.excess, wires.limited.unit, -command - _largest(wires.limited), command + _largest(wires.limited)
    )
    signals = (wires.error, wires.limited, wires.measured, excess, wires.reference)
    ahead = _states_ahead(axis, interface)
    kept = [model.outputs[0], *(f"{name}_ahead" for name in ahead)]
    turned = _negated(model, f"{axis.output}_error").select(kept, model.inputs)
    names_of = dict(zip(model.inputs, (s.name for s in signals), strict=True)) | {model.outputs[0]: wires.command}
    outputs = [
        Signal(wires.command, wires.limited.unit, -command, command, f"demanded of {axis.output}"),
        *ahead.values(),
    ]
    states = [Signal(name, model.unit(name) or "1", -b, b) for name, b in zip(model.states, bounds, strict=True)]
    tag = f"servo of {axis.output}"
    block = linear_block.block(
        f"servo_{axis.output}",
        turned.renamed(names_of),
        inputs=signals,
        outputs=outputs,
        states=states,
        tag=tag,
        start=start,
    )
    return [block]


def _negated(model: StateSpace, name: str) -> StateSpace:
    """Return the model with one input of the other sign: an error is here the set-point less the measurement."""
    sign = np.array([-1.0 if n == name else 1.0 for n in model.inputs])
    return replace(model, B=model.B * sign, D=model.D * sign)


def _wires(axis: Axis, interface: Interface) -> _Wires:
    sensor = next((s.name for s in interface.sensors if s.of == axis.output), "")
    point = next((s.name for s in interface.set_points if s.of in (axis.output, sensor)), "")
    if not sensor or not point:
        raise SignalError(
            f"the axis of '{axis.output}' needs a sensor and a set-point of it: the interface has sensors of "
            f"{', '.join(s.of for s in interface.sensors)} and set-points of "
            f"{', '.join(s.of for s in interface.set_points) or 'nothing'}; declare both"
        )
    around = interface.error(sensor), interface.held(sensor), interface.held(point)
    if axis.inverse is not None:
        bound, unit = _demand_bound(axis, interface), axis.model.unit(axis.command) or "1"
        limited = Signal(f"{axis.command}_limited", unit, -bound, bound, "what the actuators make of the demand")
        return _Wires(around[0], limited, *around[1:], f"{axis.command}_excess", f"{axis.command}_command")
    actuator = next((a.name for a in interface.actuators if a.of == axis.command), None)
    if actuator is None:
        raise SignalError(
            f"the axis of '{axis.output}' commands '{axis.command}', which no actuator drives: the interface has "
            f"{', '.join(a.of for a in interface.actuators)}"
        )
    limited = interface.computed(actuator)
    return _Wires(around[0], limited, *around[1:], f"{actuator}_excess", f"{actuator}_demand")


def _state_bounds(model: StateSpace, wires: _Wires) -> Array:
    """Return the bounds of the controller's states, whether its command is limited or not: excess = limited - command."""
    excess = [i for i, name in enumerate(model.inputs) if name.endswith("_excess")]
    others = [i for i in range(len(model.inputs)) if i not in excess]
    E, command, direct = model.B[:, excess], model.C[:1], model.D[:1]
    B = model.B - E @ direct
    B[:, [i for i in others if model.inputs[i].endswith("_limited")]] += E
    held = StateSpace(
        model.A - E @ command,
        B[:, others],
        command,
        direct[:, others],
        model.states,
        tuple(model.inputs[i] for i in others),
        model.outputs[:1],
        model.time,
    )
    return np.array([_rounded_up(MARGIN * float(b)) for b in reach.states(held, wires.bounds)])


def _rounded_up(value: float) -> float:
    """Return a bound in two digits, so that it is alike on every machine."""
    if not value:
        return 1e-30
    scale = 10.0 ** (np.floor(np.log10(value)) - 1)
    return float(f"{np.ceil(value / scale) * scale:.2g}")


def _largest(signal: Signal) -> float:
    return max(abs(signal.low), abs(signal.high))


def _states_ahead(axis: Axis, interface: Interface) -> dict[str, Signal]:
    """Return the predicted states of this axis that the inverse of the plant takes, inside the plant's domain."""
    if axis.inverse is None:
        return {}
    taken = _entering(axis.inverse)
    return {s.name: replace(s, name=f"{s.name}_ahead") for s in taken if s.name in axis.model.states}


def _entering(inverse: Linearisation) -> list[Signal]:
    """Return the plant's states that the law or the decoupling matrix takes."""
    model = inverse.degree.model
    exprs = ca.vertcat(inverse.u, ca.vec(inverse.degree.decoupling), inverse.degree.drift)
    return [model.states[k] for k in box.entering(exprs, inverse.x, model.states)]


def _inverse(inverse: Linearisation, regulators: Sequence[Regulator], interface: Interface) -> list[Block]:
    """Return the Blocks from the demands to the actuators, and from what these make of it back to the axes."""
    time, axes = regulators[0].time, [r.axis for r in regulators]
    outputs, commands = inverse.degree.outputs, {axis.output: axis.command for axis in axes}
    if missing := [name for name in outputs if name not in commands]:
        raise SignalError(
            f"the feedback linearisation takes the demand of '{missing[0]}' too: join the axes of "
            f"{', '.join(outputs)} by axis.decoupled"
        )
    wires = {axis.output: _wires(axis, interface) for axis in axes}
    known = {name: s for axis in axes for name, s in _states_ahead(axis, interface).items()}
    for state in _entering(inverse):
        if state.name not in known:
            known[state.name] = _measured(state, interface)
    actuators = {a.of: a.name for a in interface.actuators}
    if missing := [name for name in inverse.inputs if name not in actuators]:
        raise SignalError(
            f"the feedback linearisation needs '{missing[0]}', which no actuator drives: hold it, or add one"
        )
    demand = {name: Signal(wires[name].command, wires[name].limited.unit, -1e30, 1e30) for name in outputs}
    bound = _actuator_bounds(inverse, wires)
    sent = {name: interface.demand(actuators[name], bound[name]) for name in inverse.inputs}
    excess = {name: interface.excess(actuators[name], bound[name]) for name in inverse.inputs}

    def at(expr: ca.SX, u: Exprs) -> ca.SX:
        """Return an expression of the plant's states at their signals, clipped to the plant's domain."""
        places = {s.name: k for k, s in enumerate(inverse.degree.model.states)}
        old = ca.vertcat(*(inverse.x[places[name]] for name in known))
        new = ca.vertcat(*(clip(u[s.name], inverse.degree.model.states[places[name]]) for name, s in known.items()))
        return ca.substitute(expr, old, new) if known else expr

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        w = ca.vertcat(*(u[demand[name].name] for name in outputs))
        command = ca.substitute(at(inverse.u, u), inverse.w, w)
        return Step({s.name: command[i] for i, s in enumerate(sent.values())})

    def made(u: Exprs, x: Exprs, k: Exprs) -> Step:
        added = ca.mtimes(at(inverse.degree.decoupling, u), ca.vertcat(*(u[s.name] for s in excess.values())))
        output = {wires[name].excess: added[i] for i, name in enumerate(outputs)}
        for i, name in enumerate(outputs):
            output[wires[name].limited.name] = clip(u[demand[name].name] + added[i], wires[name].limited)
        return Step(output)

    ends = [Signal(wires[name].excess, wires[name].limited.unit, -1e30, 1e30) for name in outputs]
    signals, tag = [*known.values(), *demand.values()], f"feedback linearisation of {', '.join(outputs)}"
    name = "_".join(outputs)
    back = [*ends, *(wires[name].limited for name in outputs)]
    return [
        build(f"inverse_{name}", time, law, inputs=signals, outputs=list(sent.values()), tag=tag),
        build(f"made_{name}", time, made, inputs=[*signals, *excess.values()], outputs=back, tag=tag),
    ]


def _measured(state: Signal, interface: Interface) -> Signal:
    sensor = next((s.name for s in interface.sensors if s.of == state.name), None)
    if sensor is None:
        raise SignalError(
            f"the feedback linearisation takes '{state.name}', which no axis estimates and no sensor measures: linearise "
            "its output too, or measure it"
        )
    return interface.held(sensor)


def _scattered(inverse: Linearisation, inputs: Mapping[str, tuple[float, float]]) -> tuple[Array, Array]:
    """Return points of the plant's box and of ranges of inputs: states (n, k) and inputs (m, k), vertices first."""
    model = inverse.degree.model
    ranges = [*model.states, *(Signal(name, "1", low, high) for name, (low, high) in inputs.items())]
    points = np.hstack([_vertices(ranges), box.scatter(ranges, POINTS, SEED)])
    return points[: len(model.states)], points[len(model.states) :]


def _vertices(ranges: Sequence[Signal]) -> Array:
    corners = np.array(np.meshgrid(*([0.0, 1.0] for _ in ranges))).reshape(len(ranges), -1)
    return box.within(ranges, corners)


def _demand_bound(axis: Axis, interface: Interface) -> float:
    """Return how large the actuators can make the derivative that is the axis' demand, in the plant's box."""
    inverse = axis.inverse
    assert inverse is not None
    ranges = {a.of: (interface.signals[a.name].low, interface.signals[a.name].high) for a in interface.actuators}
    degree, i = inverse.degree, inverse.degree.outputs.index(axis.output)
    x, u = _scattered(inverse, {name: ranges.get(name, (-1.0, 1.0)) for name in names(degree.model.inputs)})
    symbols = ca.SX.sym("u", len(u))
    made = degree.drift[i] + ca.mtimes(degree.decoupling[i, :], symbols)
    function = ca.Function("made", [inverse.x, symbols], [ca.densify(made)])
    return _rounded_up(MARGIN * float(np.abs(np.asarray(function(x, u))).max()))


def _actuator_bounds(inverse: Linearisation, wires: Mapping[str, _Wires]) -> dict[str, float]:
    """Return how large the law's inputs become in the plant's box, for demands four times what the actuators can make."""
    reachable = {name: 4 * _largest(wires[name].limited) for name in inverse.degree.outputs}
    x, w = _scattered(inverse, {f"w_{name}": (-b, b) for name, b in reachable.items()})
    largest = np.abs(np.asarray(inverse.law(x, w))).max(axis=1)
    return {name: _rounded_up(MARGIN * float(b)) for name, b in zip(inverse.inputs, largest, strict=True)}
