"""Servo LQG axis as a Block: signals from a stage's interface, and a bound derived for each state.

    <output>_error, <output>_held, <set point>_held --> [ servo_<output> ] --> command --> [ inverse ] --> limits
                                                              ^                                              v
                                                              '--------- limited command, excess ------------'

The axis receives the limited command, so it is a stable system whether or not the actuator is at its limit: the
internal model tracks the actuator (A - E C), and the estimator is stable. The bounds of its states are therefore the
largest values to which inputs in their ranges can drive them (`analyse.peak_bounds`); they need no tuning.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import flint
import numpy as np

from synth.analyse.loops import peak_bounds
from synth.analyse.numerics import precise
from synth.block import Block
from synth.blocks.laws import axis_inverse, axis_regulator, linear_block
from synth.blocks.laws.axis_inverse import MARGIN, Command, round_up
from synth.blocks.laws.axis_regulator import Axis, Regulator
from synth.declare.stage import Interface
from synth.errors import SignalError
from synth.signals import Signal
from synth.statespace import Array, StateSpace, readonly
from synth.synthesise.observers import estimator_start
from synth.synthesise.regulation import leapfrog_form
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


def blocks(time: Discrete, axes: Sequence[Axis], interface: Interface) -> list[Block]:
    """Return the Blocks of axes that share one inverse, or of one axis without an inverse.

    Raises SignalError for an output without a sensor or a set-point, a command without an actuator, and as
    `axis_inverse.blocks`; otherwise as `axis_regulator.synthesise`.
    """
    wires = {axis.output: _wires(axis, interface) for axis in axes}
    regulators = [axis_regulator.synthesise(axis, time, interface.delay) for axis in axes]
    servo_blocks = [_servo(regulator, wires[regulator.axis.output], interface) for regulator in regulators]
    if axes[0].inverse is not None:
        servo_blocks += axis_inverse.blocks(time, axes, {name: w.command for name, w in wires.items()}, interface)
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
    command = axis_inverse.command(axis, interface) if axis.inverse is not None else _command(axis, interface)
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
    largest = np.insert(wires.bounds, 3, 0.0)  # the excess has no feedthrough to the command
    bound = MARGIN * float(np.abs(model.C[0]) @ bounds + np.abs(model.D[0]) @ largest)
    excess = command.excess_signal(bound + wires.bounds[1])
    inputs = (wires.error, command.limited, wires.measured, excess, wires.reference)
    predicted = axis_inverse.predicted_states(axis)
    selected = model.select([model.outputs[0], *(f"{name}_predicted" for name in predicted)], model.inputs)
    names = dict(zip(model.inputs, (s.name for s in inputs), strict=True)) | {model.outputs[0]: command.name}
    return linear_block.block(
        f"servo_{axis.output}",
        _with_negated_error(selected).renamed(names),
        inputs=inputs,
        outputs=[command.signal(bound), *predicted.values()],
        states=[
            Signal(n, model.unit(n) or "1", -b, b, _description(n, axis))
            for n, b in zip(model.states, bounds, strict=True)
        ],
        tag=f"servo of {axis.output}",
        start=_start(regulator, interface),
    )


def _description(state: str, axis: Axis) -> str:
    """Return what a state of the controller is, for the header of the C and the report."""
    if state == leapfrog_form.SUM:
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
    start = estimator_start.from_measurement(regulator.controller, plant, [axis.output], values=values)
    return _with_integrator(regulator.controller, axis.output, start, safe)


def _with_integrator(controller: StateSpace, output: str, start: linear_block.Start, safe: float) -> linear_block.Start:
    """Return the start with a state `leapfrog_form.SUM` for which the command at rest is `safe`."""
    if leapfrog_form.SUM not in controller.states:
        return start
    row, measured = controller.states.index(leapfrog_form.SUM), controller.inputs.index(output)
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
