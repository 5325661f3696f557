"""The interface of a stage, completed from its plant: names, units and ranges, guarded inputs and safe outputs."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from synth.blocks.guard import missed_calls as calls
from synth.blocks.guard import safety
from synth.declare.stage import Actuator, Auxiliary, Interface, Sensor, SetPoint
from synth.errors import SignalError
from synth.plant import Plant
from synth.signals import Signal, signal_names

COARSEST = 0.1  # of a sensor's range: a coarser resolution is in another unit


def interface(
    plant: Plant,
    *,
    sensors: Sequence[Sensor],
    set_points: Sequence[SetPoint] = (),
    actuators: Sequence[Actuator] = (),
    disturbances: Sequence[str] = (),
    delay: int = 1,
    bad_samples: int = 5,
    safe_output_effect: str = "",
    suspected: Sequence[str] = (),
    missed_calls: float | None = None,
    braking: int = 0,
    good_samples: int = 0,
    auxiliaries: Sequence[Auxiliary] = (),
) -> Interface:
    """Return the interface, completed with the names, units and ranges of the plant's signals.

    `delay` counts samples from measurement to actuation. After `bad_samples` in a row with a bad sensor the actuators
    go to their safe values; `safe_output_effect` states what this does to the machine, for the datasheet. With
    `good_samples` N above 0, N good samples cancel a bad one (a leaky counter); with 0, one good sample resets the
    count. `suspected` are sensors that a law compares. Before the latch, ``brakes`` is 1 for `braking` samples more.
    With `missed_calls`, the largest number that may be missing in a row, the controller has an input of this name and a
    fault bit above it.

    Raises SignalError for a name that the plant does not have or that is declared twice, for a plant input without an
    actuator or a disturbance, for an actuator with a wider range than its plant input or a safe value outside its own,
    for a sensor with noise or a resolution that is negative or above COARSEST, or an error that is negative or not
    finite, for `wraps` that is not positive or stands beside a `high`, for an auxiliary input of another unit than its
    parameter or with a range that lacks the tolerance, and for a `delay` that is not a whole number from 0.
    """
    if not (isinstance(delay, int | np.integer) and delay >= 0):
        raise SignalError(f"the delay is {delay} samples: give a whole number from 0, at least the true delay")
    outputs = {s.name: s for s in plant.outputs}
    positions = outputs | {s.name: s for s in plant.states}
    inputs = {s.name: s for s in plant.inputs}
    done_sensors = tuple(_sensor(s, _pick(plant, "output", outputs, s.of or s.name)) for s in sensors)
    read = {s.name: outputs[s.of] for s in done_sensors}
    done_set_points = tuple(
        _set_point(s, _pick(plant, "output or state", {**positions, **read}, s.of)) for s in set_points
    )
    done_actuators = tuple(_actuator(a, _pick(plant, "input", inputs, a.of or a.name)) for a in actuators)
    done_auxiliaries = tuple(_auxiliary(a, plant) for a in auxiliaries)
    for name in disturbances:
        _pick(plant, "input", inputs, name)
    driven = [*(a.of for a in done_actuators), *disturbances]
    if idle := [name for name in inputs if name not in driven]:
        raise SignalError(f"plant input '{idle[0]}' is driven by nothing: name it in an actuator or in disturbances")
    signals = [
        *(_signal(s, outputs[s.of].unit) for s in done_sensors),
        *(_signal(s, {**positions, **read}[s.of].unit) for s in done_set_points),
        *(_signal(a, a.unit) for a in done_auxiliaries),
        *(_signal(a, inputs[a.of].unit) for a in done_actuators),
    ]
    named = dict(zip(signal_names(signals), signals, strict=True))
    return Interface(
        plant, done_sensors, done_set_points, done_actuators, named, tuple(disturbances), delay, bad_samples,
        safe_output_effect, tuple(suspected), None if missed_calls is None else calls.signal(missed_calls),
        braking, good_samples, done_auxiliaries,
    )  # fmt: skip


def _pick(plant: Plant, role: str, known: Mapping[str, Signal], name: str) -> Signal:
    if name not in known:
        raise SignalError(f"plant '{plant.name}' has no {role} '{name}': name one of {', '.join(known)}")
    return known[name]


def _range(low: float | None, high: float | None, of: Signal) -> tuple[float, float]:
    return of.low if low is None else low, of.high if high is None else high


def _sensor(sensor: Sensor, of: Signal) -> Sensor:
    low, high = _range(sensor.low, sensor.high, of)
    if sensor.wraps:
        if not 0 < sensor.wraps < math.inf or sensor.high is not None:
            raise SignalError(
                f"sensor '{sensor.name}' wraps after {sensor.wraps:g} {of.unit}, with high = {sensor.high}: give a "
                "finite span above 0, and no high, which is low + wraps"
            )
        low = sensor.low or 0.0
        high = low + sensor.wraps
    if not 0 <= sensor.resolution <= COARSEST * (high - low):
        raise SignalError(
            f"sensor '{sensor.name}' has a resolution of {sensor.resolution:g} {of.unit} in a range of {low:g} .. "
            f"{high:g} {of.unit}: give one from 0 to {COARSEST:g} of the range, in {of.unit}"
        )
    if not 0 <= sensor.noise <= COARSEST * (high - low):
        raise SignalError(
            f"sensor '{sensor.name}' has noise of {sensor.noise:g} {of.unit} in a range of {low:g} .. {high:g} "
            f"{of.unit}: give its standard deviation, from 0 to {COARSEST:g} of the range"
        )
    for field, unit in (("offset", of.unit), ("gain_error", "1")):
        if not 0 <= (value := getattr(sensor, field)) < math.inf:
            raise SignalError(
                f"sensor '{sensor.name}' has {field} = {value:g}: give its largest size in {unit}, finite, from 0 on"
            )
    initial = float(np.clip(0.0, low, high)) if sensor.initial is None else sensor.initial
    return replace(sensor, of=of.name, low=low, high=high, initial=initial, about=sensor.about or of.about)


def _set_point(point: SetPoint, of: Signal) -> SetPoint:
    return replace(point, initial=_initial(point), about=point.about or f"set-point of {point.of}")


def _auxiliary(auxiliary: Auxiliary, plant: Plant) -> Auxiliary:
    if auxiliary.of:
        p = plant.parameter(auxiliary.of)
        least, most = sorted((p.at(-1.0), p.at(1.0)))
        if auxiliary.unit != p.unit or not auxiliary.low <= least <= most <= auxiliary.high:
            raise SignalError(
                f"auxiliary input '{auxiliary.name}' may be {auxiliary.low:g} .. {auxiliary.high:g} {auxiliary.unit}, "
                f"and the parameter '{p.name}' that it tells is {least:g} .. {most:g} {p.unit}: give it the unit of "
                "the parameter, and a range that contains the tolerance"
            )
    return replace(auxiliary, initial=_initial(auxiliary), about=auxiliary.about or auxiliary.of)


def _initial(declared: SetPoint | Auxiliary) -> float:
    """Return the value before the first good sample, by default the nearest to 0."""
    nearest = float(np.clip(0.0, declared.low, declared.high))
    return nearest if declared.initial is None else declared.initial


def _actuator(actuator: Actuator, of: Signal) -> Actuator:
    low, high = _range(actuator.low, actuator.high, of)
    for value, field in ((actuator.safe, "safe"), (actuator.slew_per_s, "slew_per_s")):
        if not isinstance(value, int | float | np.number):
            raise SignalError(f"actuator '{actuator.name}' has {field} = {value}: give a number in {of.unit}")
    for value in (actuator.safe, actuator.safe if actuator.landed is None else actuator.landed):
        if not low <= value <= high:
            raise SignalError(
                f"actuator '{actuator.name}' has the safe value {value:g}, outside {low:g} .. {high:g} {of.unit}: "
                "choose one inside"
            )
    if low < of.low or high > of.high:
        raise SignalError(
            f"actuator '{actuator.name}' may be {low:g} .. {high:g} {of.unit}, beyond the range of the plant input "
            f"'{of.name}', {of.low:g} .. {of.high:g}: give it a range inside, or the plant input a wider one"
        )
    return replace(actuator, of=of.name, low=low, high=high, about=actuator.about or of.about)


def _signal(declared: Sensor | SetPoint | Auxiliary | Actuator, unit: str) -> Signal:
    assert declared.low is not None and declared.high is not None
    return Signal(declared.name, unit, declared.low, declared.high, declared.about)


def guarded_inputs(interface: Interface) -> tuple[safety.GuardedInput, ...]:
    """Return the inputs of the controller in the form of the guard; sensors are its measurements."""
    sensors = [
        safety.GuardedInput(interface.signals[s.name], s.initial or 0.0, True, s.held) for s in interface.sensors
    ]
    references = interface.references
    return (*sensors, *(safety.GuardedInput(interface.signals[s.name], s.initial or 0.0, False) for s in references))


def safe(interface: Interface) -> safety.Safety:
    """Return the safe outputs after too many bad samples."""
    i, samples = interface, interface.bad_samples + interface.braking
    values, slews = {a.name: a.safe for a in i.actuators}, {a.name: a.slew_per_s for a in i.actuators}
    landed = {a.name: a.landed for a in i.actuators if a.landed is not None}
    return safety.Safety(samples, values, slews, i.safe_output_effect, None, i.braking, i.good_samples, landed)
