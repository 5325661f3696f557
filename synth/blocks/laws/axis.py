"""Servo LQG axes of a stage (MATLAB `lqi` with `kalman`): from a model and weights to Blocks, gains and bounds.

    Z = axis.servo(inverse.chain("z"), modes={0.0: 25.0}, weights={"z": 1e8, "vz": 1e3}, command_weight=1e-2,
                   estimator=axis.kalman(process={"vz": 1e-5}, sensor={"z": 1e-14}), anti_windup=30.0)
    stage.controller("levitator", Discrete(1 / 2000), interface, [Z, ...])

`axis_regulator` states the optimisation problem of one axis. An axis of a linear model commands its actuator directly.
For an axis whose model is a chain of a feedback linearisation, the inverse of the plant (`axis_inverse`) converts the
demand into the actuators' values. `axis_blocks` makes the Blocks.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from synth import arguments
from synth.analyse.structure import realisation
from synth.blocks.laws import axis_blocks, axis_regulator
from synth.blocks.laws.axis_regulator import Axis, Kalman
from synth.declare.stage import Interface, Law
from synth.errors import SignalError
from synth.statespace import System, of
from synth.synthesise.nonlinear.feedback_linearisation import Chain
from synth.synthesise.regulation import internal_model
from synth.timing import Discrete


@dataclass(frozen=True, eq=False)
class ServoLaw:
    """Axes to synthesise once the sample rate and the interface are known; several share one inverse of the plant."""

    axes: tuple[Axis, ...]

    def law(self, time: Discrete, interface: Interface) -> Law:
        """Return the Blocks of the axes at a sample rate, for the delay, ranges and limits of an interface.

        Raises SignalError for an output without a sensor or a set-point, a command without an actuator, and an inverse
        that also needs the demands of other axes; otherwise as `axis_regulator.synthesise`.
        """
        blocks = axis_blocks.blocks(time, self.axes, interface)
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
