"""Faults of a campaign (FMEA), derived from the interface of a stage, and what each changes in a scenario.

    sensor    not finite, out of range, frozen, offset, drift, noise, one sample late, repeated code
    actuator  dead, stuck, weak
    calls     missing

Sensor faults act between plant and C, before or after the quantisation as in the hardware; actuator faults act between
C and plant. A permanent fault lasts to the end of the run, a short one for one sample less than the latch needs.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any
from zlib import crc32

import numpy as np
from numpy.typing import NDArray

from synth.campaign import FaultCampaign
from synth.simulate.rig import Rig
from synth.simulate.scenario import InputFault, Trajectory
from synth.simulate.sensors import Override

PERMANENT, SHORT = "permanent", "short"
BEYOND = 0.1  # of a sensor's range: distance of a reading out of range from its end


@dataclass(frozen=True)
class Injection:
    """One fault: the class of its target (sensor, actuator, calls), the target, the kind and the duration."""

    group: str
    target: str
    kind: str
    duration: str


@dataclass(frozen=True, eq=False)
class _Course:
    """What a fault may depend on: its samples (N,), those since the onset, and the healthy run."""

    rig: Rig
    campaign: FaultCampaign
    healthy: Trajectory
    onset: int
    active: NDArray[np.bool_]

    @property
    def since(self) -> NDArray[np.int64]:
        """The samples since the onset (N,), 0 while the fault does not act."""
        return np.where(self.active, np.arange(len(self.active)) - self.onset, 0)

    def span(self, sensor: str) -> float:
        """Return the width of a sensor's range in its unit."""
        signal = self.rig.stage.interface.signals[sensor]
        return signal.high - signal.low


Fields = Mapping[str, Any]


def _override(c: _Course, sensor: str, value: float) -> Fields:
    return {"overrides": {sensor: Override(c.active, np.full(len(c.active), value))}}


def _out_of_range(c: _Course, sensor: str) -> Fields:
    return _override(c, sensor, c.rig.stage.interface.signals[sensor].high + BEYOND * c.span(sensor))


def _disturbance(c: _Course, sensor: str, values: NDArray[np.floating]) -> Fields:
    """Return the sensor noise of the rig with `values`, as fractions of the sensor's range, added to one sensor."""
    noise = c.rig.sensor_noise(len(c.active))
    return {"noise": noise | {sensor: noise.get(sensor, 0.0) + c.span(sensor) * np.where(c.active, values, 0.0)}}


def _white_noise(c: _Course, sensor: str) -> Fields:
    values = np.random.default_rng(crc32(sensor.encode())).standard_normal(len(c.active))
    return _disturbance(c, sensor, c.campaign.noise * values)


def _drift(c: _Course, sensor: str) -> Fields:
    return _disturbance(c, sensor, c.campaign.drift_per_s * c.rig.period_s * c.since)


def _gain(c: _Course, actuator: str, gain: float, bias: float = 0.0) -> Fields:
    return {"input_faults": {actuator: InputFault(np.where(c.active, gain, 1.0), np.where(c.active, bias, 0.0))}}


_EFFECTS: Mapping[str, Mapping[str, Callable[[_Course, str], Fields]]] = {
    "sensor": {
        "not finite": lambda c, s: _override(c, s, np.nan),
        "out of range": _out_of_range,
        "frozen": lambda c, s: {"lags": {s: np.where(c.active, c.since + 1, 0)}},
        "offset": lambda c, s: _disturbance(c, s, np.full(len(c.active), c.campaign.offset)),
        "drift": _drift,
        "noise": _white_noise,
        "late": lambda c, s: {"lags": {s: np.where(c.active, 1, 0)}},
        "repeated": lambda c, s: {"lags": {s: c.since % c.campaign.repeated}},
    },
    "actuator": {
        "dead": lambda c, a: _gain(c, a, 0.0),
        "stuck": lambda c, a: _gain(c, a, 0.0, float(c.healthy.applied[a][c.onset - 1])),
        "weak": lambda c, a: _gain(c, a, c.campaign.weak),
    },
    "calls": {"missing": lambda c, _: {"missed": c.active}},
}


def derive(rig: Rig) -> tuple[Injection, ...]:
    """Return every fault of the stage's interface: sensors, plant inputs with an actuator, calls of the controller."""
    interface = rig.stage.interface
    targets = {"sensor": [s.name for s in interface.sensors], "actuator": list(rig.connections), "calls": ["calls"]}
    return tuple(
        Injection(group, target, kind, duration)
        for group, kinds in _EFFECTS.items()
        for target in targets[group]
        for kind in kinds
        for duration in (PERMANENT, SHORT)
        if duration == PERMANENT or interface.bad_samples > 1
    )


def scenario_fields(
    rig: Rig, campaign: FaultCampaign, injection: Injection, healthy: Trajectory, onset: int
) -> dict[str, Any]:
    """Return the fields of `Scenario` that a fault from sample `onset` >= 1 on changes."""
    k = np.arange(len(healthy.time))
    samples = rig.stage.interface.bad_samples - 1 if injection.duration == SHORT else len(k)
    course = _Course(rig, campaign, healthy, onset, (k >= onset) & (k < onset + samples))
    return dict(_EFFECTS[injection.group][injection.kind](course, injection.target))
