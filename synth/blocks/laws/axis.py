"""Servo LQG axes of a stage (MATLAB `lqi` with `kalman`): from a model and weights to Blocks, gains and bounds.

    Z = axis.servo(inverse.chain("z"), modes={0.0: 25.0}, weights={"z": 1e8, "vz": 1e3}, command_weight=1e-2,
                   estimator=axis.kalman(process={"vz": 1e-5}, sensor={"z": 1e-14}), anti_windup=30.0)
    stage.controller("levitator", Discrete(1 / 2000), interface, [Z, ...])

`axis_regulator` states the optimisation problem of one axis. An axis of a linear model commands its actuator directly.
For an axis whose model is a chain of a feedback linearisation, the inverse of the plant (`axis_regulator`) converts the
demand into the actuators' values. `servo_blocks` makes the Blocks.

Servo LQG axis as a Block: signals from a stage's interface, and a bound derived for each state.

    <output>_error, <output>_held, <set point>_held --> [ servo_<output> ] --> command --> [ inverse ] --> limits
                                                              ^                                              v
                                                              '--------- limited command, excess ------------'

The axis receives the limited command, so it is a stable system whether or not the actuator is at its limit: the
internal model tracks the actuator (A - E C), and the estimator is stable. The bounds of its states are therefore the
largest values to which inputs in their ranges can drive them (`analyse.peak_bounds`); they need no tuning.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import flint
import numpy as np

from synth import arguments
from synth.analyse.loops import peak_bounds
from synth.analyse.numerics import precise
from synth.analyse.structure import realisation
from synth.block import Block
from synth.blocks.laws import axis_regulator, linear_block
from synth.blocks.laws.axis_regulator import MARGIN, Axis, Command, Kalman, Regulator, round_up
from synth.declare.stage import Interface, Law
from synth.errors import SignalError
from synth.signals import Signal
from synth.statespace import Array, StateSpace, System, of, readonly
from synth.synthesise.nonlinear.feedback_linearisation import Chain
from synth.synthesise.observers import lqg
from synth.synthesise.regulation import internal_model
from synth.synthesise.regulation import servo as servos
from synth.timing import Discrete


@dataclass(frozen=True, eq=False)
class _Wires:
    """The signals of an axis: error, limited command, measurement, excess, set-point, in the controller's order."""

    error: Signal
    command: Command
    measured: Signal
    reference: Signal

    @property
    def bounds(self) -> Array:
        """The largest error, limited command, measurement and set-point."""
        signals = (self.error, self.command.limited, self.measured, self.reference)
        return np.array([max(abs(s.low), abs(s.high)) for s in signals])


def servo_blocks(time: Discrete, axes: Sequence[Axis], interface: Interface) -> list[Block]:
    """Return the Blocks of axes that share one inverse, or of one axis without an inverse.

    Raises SignalError for an output without a sensor or a set-point, a command without an actuator, and as
    `axis_regulator.blocks`; otherwise as `axis_regulator.synthesise`.
    """
    wires = {axis.output: _wires(axis, interface) for axis in axes}
    regulators = [axis_regulator.synthesise(axis, time, interface.delay) for axis in axes]
    servo_blocks = [_servo(regulator, wires[regulator.axis.output], interface) for regulator in regulators]
    if axes[0].inverse is not None:
        servo_blocks += axis_regulator.blocks(time, axes, {name: w.command for name, w in wires.items()}, interface)
    return servo_blocks


def _wires(axis: Axis, interface: Interface) -> _Wires:
    points = interface.set_point_of
    sensor = next((s.name for s in interface.sensors if s.of == axis.output and s.name in points), None)
    if sensor is None:
        raise SignalError(
            f"the axis of '{axis.output}' needs a sensor and a set-point of it: the interface has sensors of "
            f"{', '.join(s.of for s in interface.sensors) or 'nothing'} and set-points of "
            f"{', '.join(s.of for s in interface.set_points) or 'nothing'}; declare both"
        )
    command = axis_regulator.command(axis, interface) if axis.inverse is not None else _command(axis, interface)
    return _Wires(interface.error(sensor), command, interface.held(sensor), interface.held(points[sensor].name))


def _command(axis: Axis, interface: Interface) -> Command:
    actuator = next((a.name for a in interface.actuators if a.of == axis.command), None)
    if actuator is None:
        raise SignalError(
            f"the axis of '{axis.output}' commands '{axis.command}', which no actuator drives: the interface has "
            f"{', '.join(a.of for a in interface.actuators) or 'none'}"
        )
    return Command(f"{actuator}_demand", f"{actuator}_excess", interface.computed_output(actuator))


def _servo(regulator: Regulator, wires: _Wires, interface: Interface) -> Block:
    """Return the Block of one axis: internal model, estimator, gains."""
    axis, model, command = regulator.axis, regulator.controller, wires.command
    bounds = _state_bounds(model, wires)
    inputs = (wires.error, command.limited, wires.measured, command.excess_signal, wires.reference)
    predicted = axis_regulator.predicted_states(axis)
    selected = model.select([model.outputs[0], *(f"{name}_predicted" for name in predicted)], model.inputs)
    names = dict(zip(model.inputs, (s.name for s in inputs), strict=True)) | {model.outputs[0]: command.name}
    return linear_block.block(
        f"servo_{axis.output}",
        _with_negated_error(selected).renamed(names),
        inputs=inputs,
        outputs=[command.signal, *predicted.values()],
        states=[
            Signal(n, model.unit(n) or "1", -b, b, _description(n, axis))
            for n, b in zip(model.states, bounds, strict=True)
        ],
        tag=f"servo of {axis.output}",
        start=_start(regulator, interface),
    )


def _description(state: str, axis: Axis) -> str:
    """Return what a state of the controller is, for the header of the C and the report."""
    if state == servos.SUM:
        return "sum of the errors"
    frequencies = sorted(w for w in axis.modes if w)
    oscillators = {f"{letter}{k}": w for k, w in enumerate(frequencies, 1) for letter in "pq"}
    if state in oscillators:
        return f"internal model of {oscillators[state]:.4g} rad/s"
    if state.removesuffix("_predicted") in axis.model.states:
        return "estimate of the next sample"
    return "limited command that acts next"


def _with_negated_error(model: StateSpace) -> StateSpace:
    """Return the model with its first input, the error, in the sign of a stage: set-point minus measurement."""
    sign = np.where(np.arange(len(model.inputs)) == 0, -1.0, 1.0)
    return replace(model, B=model.B * sign, D=model.D * sign)


def _start(regulator: Regulator, interface: Interface) -> linear_block.Start:
    """Return the start at rest at the first measurement, with the actuator's safe value in the delay line.

    An integrator of the error starts so that the first command is this value, too, if the set-point is where the stage
    stands: it takes over from the feedback of the position what the set-point's weight leaves.
    """
    axis, plant = regulator.axis, regulator.servo.plant
    delay_line = [s for s in plant.states if s not in axis.model.states]
    safe = {a.of: a.safe for a in interface.actuators}.get(axis.command, 0.0)
    values = dict.fromkeys(delay_line, safe)
    start = lqg.from_measurement(regulator.controller, plant, [axis.output], values=values)
    return _with_integrator(regulator.controller, axis.output, start, safe)


def _with_integrator(controller: StateSpace, output: str, start: linear_block.Start, safe: float) -> linear_block.Start:
    """Return the start with a state `servos.SUM` for which the command at rest is `safe`."""
    if servos.SUM not in controller.states:
        return start
    row, measured = controller.states.index(servos.SUM), controller.inputs.index(output)
    columns = [measured, controller.inputs.index(f"{output}_reference")]

    def compute() -> flint.arb_mat:
        c, d = (precise.matrix(M[:1]) for M in (controller.C, controller.D))
        at_zero = (c * precise.matrix(start.a[:, None]))[0, 0]
        slope = (c * precise.matrix(start.G[:, [measured]]))[0, 0] + sum((d[0, j] for j in columns), flint.arb(0))
        return flint.arb_mat([[(safe - at_zero) / c[0, row], -slope / c[0, row]]])

    values = precise.round_correctly(compute, "the start of the integrator")[0]
    a, G = start.a.copy(), start.G.copy()
    a[row], G[row, measured] = values
    return linear_block.Start(readonly(a), readonly(G))


def _state_bounds(model: StateSpace, wires: _Wires) -> Array:
    """Return the bounds of the controller's states, with the command limited or not: excess = limited - command."""
    E, command, direct = model.B[:, [3]], model.C[:1], model.D[:1]
    B = model.B - E @ direct
    B[:, [1]] += E
    others, inputs = [0, 1, 2, 4], tuple(model.inputs[i] for i in (0, 1, 2, 4))
    form = (model.A - E @ command, B[:, others], command, direct[:, others])
    held = StateSpace(*form, model.states, inputs, model.outputs[:1], model.time)
    return np.array([round_up(MARGIN * float(b)) for b in peak_bounds.state_bounds(held, wires.bounds)])


@dataclass(frozen=True, eq=False)
class ServoLaw:
    """Axes to synthesise once the sample rate and the interface are known; several share one inverse of the plant."""

    axes: tuple[Axis, ...]

    def law(self, time: Discrete, interface: Interface) -> Law:
        """Return the Blocks of the axes at a sample rate, for the delay, ranges and limits of an interface.

        Raises SignalError for an output without a sensor or a set-point, a command without an actuator, and an inverse
        that also needs the demands of other axes; otherwise as `axis_regulator.synthesise`.
        """
        blocks = servo_blocks(time, self.axes, interface)
        name = "_".join(axis.output for axis in self.axes)
        regulators = [axis_regulator.synthesise(axis, time, interface.delay) for axis in self.axes]
        return Law(name, tuple(blocks), lambda scalar: {r.axis.output: r.document() for r in regulators})


@arguments.checked
def kalman(process: Mapping[str, float], sensor: Mapping[str, float]) -> Kalman:
    """Specify a Kalman filter, for example kalman({"v": 3e-8}, {"z": 1e-14}) in m^2/s^3 and m^2.

    Raises SignalError for missing noise, or noise that is not positive.
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
    command_weight: float,
    estimator: Kalman,
    anti_windup: float,
    set_point_weight: float | None = None,
) -> ServoLaw:
    """Specify one axis: a servo of the measured output of `model` by its input.

    model             a continuous StateSpace of one input and one output, about an equilibrium, or a Chain of a
                      `feedback_linearisation.Linearisation`; states without influence are left out
    modes             {frequency in rad/s: decay rate in 1/s} of the internal model: a constant for frequency 0, else a
                      sine; the error of each mode decays at about this rate, as long as the loop is faster
    weights           {state or output: weight in 1/unit^2}; the output needs a weight above 0
    command_weight    weight on the command, in 1/unit^2; only its ratios to `weights` matter
    estimator         the Kalman filter of the model's states from the output, from `kalman`
    anti_windup       rate in 1/s at which the internal model tracks the actuator while that is at its limit
    set_point_weight  weight b >= 0 of the set-point in the state feedback K_x (y - b r): 0 for none, 1 for the error;
                      by default its zero cancels the pole of mode 0 at that mode's speed, and without mode 0 it is 1

    In the first sample the estimator rests at the measured position. With mode 0, the first command is then the
    actuator's safe value if the set-point is there, too.

    Raises SignalError for arguments that do not fit; `ServoLaw.law` raises errors that depend on the sample period.
    """
    inverse, plant = (
        (model.law, model.model)
        if isinstance(model, Chain)
        else (None, realisation.without_unconnected_states(of(model)))
    )
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
    _require_positive(
        "command weight", {plant.inputs[0]: command_weight}, f"1/{plant.unit(plant.inputs[0]) or 'unit'}^2"
    )
    _require_positive("rate of the anti-windup", {plant.inputs[0]: anti_windup}, "1/s")
    if plant.outputs[0] not in weights:
        raise SignalError(f"there is no weight on '{plant.outputs[0]}', which scales the speeds of the modes: give one")
    if set_point_weight is not None and not 0 <= set_point_weight < np.inf:
        raise SignalError(f"the weight of the set-point is {set_point_weight}: give a finite number of 0 or more")
    return ServoLaw(
        (Axis(plant, inverse, dict(modes), dict(weights), command_weight, estimator, anti_windup, set_point_weight),)
    )


def _require_known(what: str, values: Mapping[str, float], known: Sequence[str]) -> None:
    if unknown := [name for name in values if name not in known]:
        raise SignalError(f"{what} of the axis: '{unknown[0]}' is not one of {', '.join(known)}: correct the name")
    _require_positive(what, values, "the inverse square of the unit")


def _require_positive(what: str, values: Mapping[Any, float], unit: str) -> None:
    for name, value in values.items():
        if not 0 < value < np.inf:
            raise SignalError(f"{what} ({name}) is {value}: give a finite number above 0, in {unit}")


@arguments.checked
def decouple(axes: Sequence[ServoLaw]) -> ServoLaw:
    """Return axes on chains of one feedback linearisation as one law; the inverse needs the demands of all of them.

    Raises SignalError for axes of different linearisations, or unless there is one axis for each of its outputs.
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
