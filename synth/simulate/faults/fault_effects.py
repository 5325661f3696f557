"""What each fault of a campaign changes in a scenario, from its onset on.

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
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any
from zlib import crc32

import numpy as np
from numpy.typing import NDArray

from synth.declare.fault_campaign import FaultCampaign
from synth.signals import Signal
from synth.simulate.faults import injections
from synth.simulate.faults.injections import Injection
from synth.simulate.rig import Rig
from synth.simulate.scenario import InputFault, Override, Trajectory, Word

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
    samples = injections.sample_count(rig, injection, len(k))
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
    if group in injections.PAIRS:
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
    injections.SENSOR: {
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
    injections.SET_POINT: {"jump": _jump, "refused": _lost},
    injections.ACTUATOR: {
        "dead": _dead,
        "stuck": _stuck,
        "weak": lambda at, a: _gain(at, a, 1.0 - at.magnitude(1.0 - at.campaign.weak)),
    },
    injections.CALLS: {
        "missing": lambda at, _: {"missed": at.active},
        "alternate": lambda at, _: {"missed": at.active & (at.since % 2 == 0)},
        "delayed": _delayed_calls,
    },
}
SENSOR_KINDS = tuple(_EFFECTS[injections.SENSOR])
_PAIRS: Mapping[str, tuple[Effect, Effect]] = {
    "both lost": (_lost, _lost),
    "lost and frozen": (_lost, _frozen),
    "both frozen": (_frozen, _frozen),
    "lost and dead": (_lost, _dead),
}
