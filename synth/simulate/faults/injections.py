"""Faults of a campaign (FMEA), derived from the declaration of a stage.

    sensor              not finite, out of range, intermittent, frozen, offset, drift, noise, late, repeated,
                        bit flipped, bit stuck
    set-point           jump, refused
    actuator            dead, stuck, weak
    calls               missing, alternate, delayed
    two sensors         both lost, lost and frozen, both frozen: of one parity relation
    sensor, actuator    lost and dead: a sensor, and the actuator that moves it most

An intermittent sensor reads one good sample after each longest row of bad ones that does not latch by itself. A
permanent fault lasts to the end of the run, a short one for one sample less than the latch needs, and others as long
as the campaign declares. What each changes in a scenario:

Two sensors are in one parity relation where the projector on the left null space of the output Jacobian at rest,
I - C C+, has an entry for them: the positions do not determine their readings independently, so the loss of one leaves
the other redundant and the loss of both does not.

What each fault of a campaign changes in a scenario, from its onset on.

    not finite, out of range     the reading is NaN, or a tenth of the range above its end
    intermittent                 NaN, but for the last of every n samples, n bad samples in a row being those that latch
    zero                         the reading is 0; in experiments, not in a campaign
    frozen, late, repeated       the last reading before the onset, that of one sample ago, the last of every n samples
    offset, drift, noise         added to what the sensor sees, before its resolution
    bit flipped, bit stuck       a bit of the sensor's word is inverted, or stays at what it is not at the onset
    jump, refused                the set-point moves towards the farther end of its range, and not beyond; it is NaN
    dead, stuck, weak            the plant input is 0, that of the sample before the onset, a part of the command
    missing, alternate, delayed  no call, every second call, a call with the inputs of one sample ago

The word of a sensor counts its resolution from the lower end of its range, at least WORD bits for a sensor without
one. Magnitudes are fractions of the range; the bit is the highest whose weight is at most that fraction of the range.
"""

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from itertools import combinations
from typing import Any
from zlib import crc32

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from synth.declare.fault_campaign import FaultCampaign
from synth.declare.stage import Stage
from synth.plant import Plant
from synth.signals import Signal
from synth.simulate.rig import Rig
from synth.simulate.scenario import InputFault, Override, Trajectory, Word

PERMANENT, SHORT = "permanent", "short"
SENSOR, SET_POINT, ACTUATOR, CALLS = "sensor", "set-point", "actuator", "calls"
SENSORS, SENSOR_AND_ACTUATOR = "two sensors", "sensor and actuator"
KINDS = {
    SENSOR: (
        *("not finite", "out of range", "intermittent", "frozen", "offset", "drift", "noise", "late", "repeated"),
        *("bit flipped", "bit stuck"),
    ),
    SET_POINT: ("jump", "refused"),
    ACTUATOR: ("dead", "stuck", "weak"),
    CALLS: ("missing", "alternate", "delayed"),
    SENSORS: ("both lost", "lost and frozen", "both frozen"),
    SENSOR_AND_ACTUATOR: ("lost and dead",),
}
# One target that fails for good: what a build runs.
BASIC = {SENSOR: ("not finite", "frozen"), ACTUATOR: ("dead",), CALLS: ("missing",)}
PAIRS = (SENSORS, SENSOR_AND_ACTUATOR)
PARITY = 1e-6  # of the projector, whose entries are at most 1: below it a sensor is in no parity relation
AND = " + "  # between the two targets of a pair


@dataclass(frozen=True)
class Injection:
    """One fault: the class of its target, the target, the kind and the duration.

    A sweep gives a `magnitude` in place of the campaign's, as a fraction of the range, and a number of `samples` in
    place of those of the duration.
    """

    group: str
    target: str
    kind: str
    duration: str
    magnitude: float | None = None
    samples: int | None = None

    @property
    def targets(self) -> tuple[str, ...]:
        """The faulty sensors, set-points and actuators."""
        return tuple(self.target.split(AND))


def derive(stage: Stage) -> tuple[Injection, ...]:
    """Return every fault of the stage's interface: of sensors, set-points, plant inputs with an actuator, calls."""
    interface, durations = stage.interface, stage.faults.durations_s
    targets = {
        SENSOR: [s.name for s in interface.sensors],
        SET_POINT: [s.name for s in interface.references],
        ACTUATOR: list(_connections(stage)),
        CALLS: ["calls"],
        SENSORS: [AND.join(pair) for pair in sensor_pairs(stage)],
        SENSOR_AND_ACTUATOR: [AND.join(pair) for pair in driven_sensors(stage)],
    }
    finite = ([SHORT] if interface.bad_samples > 1 else []) + [f"{seconds:g} s" for seconds in durations]
    return tuple(
        Injection(group, target, kind, duration)
        for group, kinds in KINDS.items()
        for target in targets[group]
        for kind in kinds
        for duration in (PERMANENT, *(finite if group not in PAIRS else ()))
    )


def sample_count(rig: Rig, injection: Injection, n: int) -> int:
    """Return the number of samples that a fault lasts in a run of n samples."""
    if injection.samples is not None:
        return injection.samples
    if injection.duration == PERMANENT:
        return n
    if injection.duration == SHORT:
        return rig.stage.interface.bad_samples - 1
    return max(1, round(float(injection.duration.removesuffix(" s")) / rig.period_s))


def is_basic(injection: Injection) -> bool:
    """Return whether a fault is one of BASIC for the rest of the run."""
    return injection.duration == PERMANENT and injection.kind in BASIC.get(injection.group, ())


def is_loss(injection: Injection) -> bool:
    """Return whether a fault is the loss of one sensor for the rest of the run."""
    return (injection.group, injection.kind, injection.duration) == (SENSOR, "not finite", PERMANENT)


def _plant(stage: Stage) -> Plant:
    """Return the plant with the inputs that faults of actuators concern: that of the drive, where there is one."""
    return stage.drive.plant if stage.drive else stage.plant


def _connections(stage: Stage) -> Iterable[str]:
    """Return the plant inputs that an actuator drives."""
    if stage.drive:
        return [s.name for s in stage.drive.plant.inputs if s.name not in stage.interface.disturbances]
    return stage.wires or [a.of for a in stage.interface.actuators]


def sensor_pairs(stage: Stage) -> tuple[tuple[str, str], ...]:
    """Return the pairs of sensors that are in one parity relation of the model at rest."""
    C, _, _ = _linear_model(stage)
    sensors = [s.name for s in stage.interface.sensors]
    projector = np.eye(len(sensors)) - C @ np.linalg.pinv(C)
    pairs = combinations(range(len(sensors)), 2)
    return tuple((sensors[i], sensors[j]) for i, j in pairs if abs(projector[i, j]) > PARITY)


def driven_sensors(stage: Stage) -> tuple[tuple[str, str], ...]:
    """Return each sensor with the plant input that moves it most: the largest Markov parameter times the input range.

    The Markov parameter is the first of C B, C A B, C A^2 B that is not 0; a sensor that no actuator moves is left out.
    """
    C, A, B = _linear_model(stage)
    plant_inputs = _plant(stage).inputs
    inputs = [s.name for s in plant_inputs]
    driven = [inputs.index(name) for name in _connections(stage)]
    spans = np.array([plant_inputs[j].high - plant_inputs[j].low for j in driven])
    pairs = []
    for sensor, row in zip(stage.interface.sensors, C, strict=True):
        markov = [np.abs(row @ np.linalg.matrix_power(A, k) @ B[:, driven]) * spans for k in range(3)]
        gains = next((g for g in markov if g.max(initial=0.0) > 0), None)
        if gains is not None:
            pairs.append((sensor.name, inputs[driven[int(np.argmax(gains))]]))
    return tuple(pairs)


def _linear_model(stage: Stage) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Return C of the sensors, A and B at the start of the stage with zero inputs, in the units of the ranges.

    Rows and columns are scaled by the spans of the signals, so that metres and radians compare.
    """
    plant = _plant(stage)
    x, u = ca.SX.sym("x", len(plant.states)), ca.SX.sym("u", len(plant.inputs))
    f, h = plant.f(x, u, plant.values), plant.h(x, u, plant.values)
    jacobians = ca.Function("jacobians", [x, u], [ca.jacobian(h, x), ca.jacobian(f, x), ca.jacobian(f, u)])
    start = [stage.start.get(s.name, 0.0) for s in plant.states]
    C, A, B = (np.array(ca.DM(m)) for m in jacobians(start, np.zeros(len(plant.inputs))))
    outputs = [s.name for s in plant.outputs]
    rows = [outputs.index(s.of) for s in stage.interface.sensors]
    spans = np.array([s.high - s.low for s in plant.states])
    ranges = np.array([plant.outputs[i].high - plant.outputs[i].low for i in rows])
    return C[rows] * spans / ranges[:, None], A * spans / spans[:, None], B / spans[:, None]


BEYOND = 0.1  # of a sensor's range: distance of a reading out of range from its end
WORD = 16  # bits of the word of a sensor without a resolution

Fields = dict[str, Any]


@dataclass(frozen=True, eq=False)
class Onset:
    """What a fault may depend on: its samples (N,), the first of them, the healthy run, and the fault itself."""

    rig: Rig
    campaign: FaultCampaign
    injection: Injection
    healthy: Trajectory
    first: int
    active: NDArray[np.bool_]

    @property
    def since(self) -> NDArray[np.int64]:
        """The samples since the onset (N,), 0 while the fault does not act."""
        return np.where(self.active, np.arange(len(self.active)) - self.first, 0)

    def signal(self, name: str) -> Signal:
        """Return the signal of a sensor or set-point."""
        return self.rig.stage.interface.signals[name]

    def span(self, name: str) -> float:
        """Return the width of the range of a sensor or set-point in its unit."""
        return self.signal(name).high - self.signal(name).low

    def magnitude(self, standard: float) -> float:
        """Return the magnitude of the injection, by default the `standard` one of the campaign."""
        return standard if self.injection.magnitude is None else self.injection.magnitude


def scenario_fields(rig: Rig, campaign: FaultCampaign, injection: Injection, healthy: Trajectory, onset: int) -> Fields:
    """Return the fields of `Scenario` that a fault from sample `onset` >= 1 on changes."""
    k = np.arange(len(healthy.time))
    samples = sample_count(rig, injection, len(k))
    at = Onset(rig, campaign, injection, healthy, onset, (k >= onset) & (k < onset + samples))
    merged: dict[str, Any] = {}
    for target, effect in zip(injection.targets, _effects(injection), strict=True):
        for name, value in effect(at, target).items():
            merged[name] = {**merged.get(name, {}), **value} if isinstance(value, Mapping) else value
    return merged


Effect = Callable[[Onset, str], Fields]


def _effects(injection: Injection) -> tuple[Effect, ...]:
    """Return the effect on each target; in a pair each has its own."""
    group, kind = injection.group, injection.kind
    if group in PAIRS:
        return _PAIRS[kind]
    return (_EFFECTS[group][kind],)


def _override(at: Onset, name: str, values: Any) -> Fields:
    return {"overrides": {name: Override(at.active, np.broadcast_to(values, at.active.shape))}}


def _lost(at: Onset, name: str) -> Fields:
    return _override(at, name, np.nan)


def _intermittent(at: Onset, name: str) -> Fields:
    row = max(2, at.rig.stage.interface.bad_samples)
    bad = at.active & (at.since % row != row - 1)
    return {"overrides": {name: Override(bad, np.full(len(bad), np.nan))}}


def _out_of_range(at: Onset, name: str) -> Fields:
    return _override(at, name, at.signal(name).high + BEYOND * at.span(name))


def _frozen(at: Onset, sensor: str) -> Fields:
    return _override(at, sensor, at.healthy.measured[sensor][at.first - 1])


def _late(at: Onset, sensor: str) -> Fields:
    return {"lags": {sensor: np.where(at.active, 1, 0)}}


def _disturbance(at: Onset, sensor: str, values: NDArray[np.floating]) -> Fields:
    """Return the sensor noise of the rig with `values`, as fractions of the sensor's range, added to one sensor."""
    noise = at.rig.sensor_noise(len(at.active))
    return {"noise": noise | {sensor: noise.get(sensor, 0.0) + at.span(sensor) * np.where(at.active, values, 0.0)}}


def _offset(at: Onset, sensor: str) -> Fields:
    return _disturbance(at, sensor, np.full(len(at.active), at.magnitude(at.campaign.offset)))


def _white_noise(at: Onset, sensor: str) -> Fields:
    values = np.random.default_rng(crc32(sensor.encode())).standard_normal(len(at.active))
    return _disturbance(at, sensor, at.magnitude(at.campaign.noise) * values)


def _drift(at: Onset, sensor: str) -> Fields:
    return _disturbance(at, sensor, at.magnitude(at.campaign.drift_per_s) * at.rig.period_s * at.since)


def _bit(at: Onset, sensor: str) -> tuple[float, int]:
    """Return the step of the sensor's word, and the bit with the largest weight of at most the magnitude."""
    resolution = next(s.resolution for s in at.rig.stage.interface.sensors if s.name == sensor)
    step = resolution or at.span(sensor) / 2**WORD
    weight = at.magnitude(at.campaign.bit) * at.span(sensor) / step
    return step, 1 << max(0, math.floor(math.log2(max(weight, 1.0))))


def _flipped_bit(at: Onset, sensor: str) -> Fields:
    step, bit = _bit(at, sensor)
    return {"words": {sensor: Word(at.signal(sensor).low, step, flipped=np.where(at.active, bit, 0))}}


def _stuck_bit(at: Onset, sensor: str) -> Fields:
    """Return a bit that is stuck at the value that it does not have at the onset."""
    (step, bit), low = _bit(at, sensor), at.signal(sensor).low
    reading = float(at.healthy.measured[sensor][at.first])
    mask = np.where(at.active, bit, 0)
    is_set = bool(round((reading - low) / step) & bit)
    return {"words": {sensor: Word(low, step, cleared=mask) if is_set else Word(low, step, set_bits=mask)}}


def _jump(at: Onset, point: str) -> Fields:
    signal, course = at.signal(point), at.healthy.measured[point].astype(float)
    up = signal.high - course[at.first] >= course[at.first] - signal.low
    size = at.magnitude(at.campaign.jump) * at.span(point) * (1 if up else -1)
    return _override(at, point, np.clip(course + size, signal.low, signal.high))


def _gain(at: Onset, actuator: str, gain: float, bias: float = 0.0) -> Fields:
    return {"input_faults": {actuator: InputFault(np.where(at.active, gain, 1.0), np.where(at.active, bias, 0.0))}}


def _dead(at: Onset, actuator: str) -> Fields:
    return _gain(at, actuator, 0.0)


def _stuck(at: Onset, actuator: str) -> Fields:
    return _gain(at, actuator, 0.0, float(at.healthy.applied[actuator][at.first - 1]))


def _delayed_calls(at: Onset, _: str) -> Fields:
    interface = at.rig.stage.interface
    points = [s.name for s in interface.references]
    before = {p: Override(at.active, np.roll(at.healthy.measured[p], 1)) for p in points}
    return {"lags": {s.name: np.where(at.active, 1, 0) for s in interface.sensors}, "overrides": before}


_EFFECTS: Mapping[str, Mapping[str, Effect]] = {
    SENSOR: {
        "not finite": _lost,
        "out of range": _out_of_range,
        "intermittent": _intermittent,
        "zero": lambda at, s: _override(at, s, 0.0),
        "frozen": _frozen,
        "offset": _offset,
        "drift": _drift,
        "noise": _white_noise,
        "late": _late,
        "repeated": lambda at, s: {"lags": {s: at.since % at.campaign.repeated}},
        "bit flipped": _flipped_bit,
        "bit stuck": _stuck_bit,
    },
    SET_POINT: {"jump": _jump, "refused": _lost},
    ACTUATOR: {
        "dead": _dead,
        "stuck": _stuck,
        "weak": lambda at, a: _gain(at, a, 1.0 - at.magnitude(1.0 - at.campaign.weak)),
    },
    CALLS: {
        "missing": lambda at, _: {"missed": at.active},
        "alternate": lambda at, _: {"missed": at.active & (at.since % 2 == 0)},
        "delayed": _delayed_calls,
    },
}
SENSOR_KINDS = tuple(_EFFECTS[SENSOR])
_PAIRS: Mapping[str, tuple[Effect, Effect]] = {
    "both lost": (_lost, _lost),
    "lost and frozen": (_lost, _frozen),
    "both frozen": (_frozen, _frozen),
    "lost and dead": (_lost, _dead),
}
