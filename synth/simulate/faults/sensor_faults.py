"""Experiments in which each of several sensors fails alone: detection, isolation, and the consequences for the machine.

    detection, brakes, latch   samples from the fault to the sensor's bit, to braking and to the latch; inf for never
    isolation delay            from the contradiction to the detection or to the reaction: braking, or the latch where
                               the controller does not brake. It does not count when only working sensors are named
    latch delay                from the contradiction to the latch, without the samples of braking

A contradiction is the first sample in which a law can know of the fault. Both delays are 0 without one: such a failure
is not detected, and its share is reported. `injections` states the faults, as in a campaign.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import inf, isfinite, isinf
from typing import Any

import numpy as np
from numpy.typing import NDArray

from synth.check import Check
from synth.declare.effects import Course
from synth.declare.experiments import SensorFaults
from synth.declare.stage import Actuator, Interface
from synth.errors import SignalError
from synth.fault import BRAKING_BIT, LATCH_BIT
from synth.plant import velocities
from synth.signals import per_second
from synth.simulate import conditions
from synth.simulate.faults import campaign, injections
from synth.simulate.rig import Rig
from synth.simulate.scenario import Array, Trajectory, sample_times

ROUNDING = 1e-5  # of a slew rate: a change within a sample in single precision


@dataclass(frozen=True, eq=False)
class Response:
    """A run in which `sensor` fails at `sample`; `bits` are those of the fault word that identify each input.

    `deviations` (N,) are |position - set-point| by position, `spans` the widths of the ranges of these set-points and
    `speeds` the speeds at the end; `contradicted` is the samples from the fault to the contradiction, inf without one.
    """

    sensor: str
    sample: int
    run: Trajectory
    interface: Interface
    bits: Mapping[str, int]
    deviations: Mapping[str, Array]
    spans: Mapping[str, float]
    speeds: Mapping[str, float]
    contradicted: float = inf

    @property
    def latch(self) -> float:
        """Samples from the fault to the latch."""
        return self.first(self.run.faults >> LATCH_BIT & 1)

    @property
    def detection(self) -> float:
        """Samples from the fault until the fault word identifies the sensor, inf if it does not before the latch."""
        return self.first(self.words & self.bits.get(self.sensor, 0))

    @property
    def brakes(self) -> float:
        """Samples from the fault until it brakes, inf if it does not before the latch."""
        return self.first(self.words >> BRAKING_BIT & 1)

    @property
    def others(self) -> tuple[str, ...]:
        """The working sensors among those that a law compares which the fault word identifies before the latch."""
        word, suspected = int(np.bitwise_or.reduce(self.words)), self.interface.suspected
        return tuple(s for s in suspected if s != self.sensor and word & self.bits.get(s, 0))

    @property
    def isolation_delay(self) -> float:
        """Samples from the contradiction to the sensor's name or the reaction."""
        reaction = inf if self.others else self.brakes if self.interface.braking else self.latch
        return 0.0 if isinf(self.contradicted) else min(self.detection, reaction) - self.contradicted

    @property
    def latch_delay(self) -> float:
        """Samples from the contradiction to the latch, without those of braking."""
        return 0.0 if isinf(self.contradicted) else self.latch - self.interface.braking - self.contradicted

    @property
    def words(self) -> NDArray[np.uint32]:
        """The fault words up to the latch."""
        return self.run.faults[: self.end + 1]

    @property
    def end(self) -> int:
        """The sample of the latch, or the number of samples without one."""
        return len(self.run.time) if isinf(self.latch) else self.sample + int(self.latch)

    def excursion(self, position: str) -> float:
        """Return the largest deviation of a position from the fault to the latch, in its unit."""
        return float(self.deviations[position][self.sample : self.end].max(initial=0.0))

    def slew_rate(self, actuator: Actuator) -> float:
        """Return the fastest change of a command from the latch on, in its unit per s, 0 without a latch."""
        changes = np.diff(self.run.commands[actuator.name].astype(np.float64)[max(self.end - 1, 0) :])
        return float(np.abs(changes).max(initial=0.0)) / float(self.run.time[1]) if isfinite(self.latch) else 0.0

    def left(self, actuator: Actuator) -> float:
        """Return how far a command is from a safe value at the end, in its unit, 0 without a latch."""
        last, safe = float(self.run.commands[actuator.name][-1]), (actuator.safe, actuator.landed)
        return min(abs(last - value) for value in safe if value is not None) if isfinite(self.latch) else 0.0

    def first(self, flags: NDArray[Any]) -> float:
        """Return the samples from the fault to the first flag, inf without a flag."""
        samples = np.flatnonzero(flags)
        return float(samples[0] - self.sample) if samples.size else inf


def responses(declared: SensorFaults, rig: Rig) -> list[Response]:
    """Return the response to the fault of each sensor in each motion.

    Raises SignalError for an unknown kind, sensor or set-point, for a fault that begins before the second sample or
    after the last, and as `Rig.run`.
    """
    known = [s.name for s in rig.stage.interface.sensors]
    if declared.kind not in injections.SENSOR_KINDS or not set(declared.sensors) <= {*known}:
        raise SignalError(
            f"{declared.name}: a fault '{declared.kind}' of {', '.join(declared.sensors)}: choose one of "
            f"{', '.join(injections.SENSOR_KINDS)}, of {', '.join(known)}"
        )
    rates = velocities(rig.stage.plant) | dict(rig.stage.velocities)
    return [response for motion in declared.motions for response in _in_motion(declared, rig, motion, rates)]


def _in_motion(
    declared: SensorFaults, rig: Rig, motion: Mapping[str, Course], rates: Mapping[str, str]
) -> list[Response]:
    interface, duration, made = rig.stage.interface, declared.duration_s, []
    time = sample_times(duration, rig.period_s)
    onset, bits = int(np.searchsorted(time, declared.at_s)), campaign.input_bits(rig)
    if not 0 < onset < len(time):
        raise SignalError(f"{declared.name}: from {declared.at_s:g} s on no sample is faulty, or all are: give another")
    profiles = conditions.profiles(interface, motion, time)
    start, set_points = campaign.start_of(rig, profiles), profiles or rig.set_points_at({})
    courses = {rig.positions[name]: course for name, course in set_points.items()}
    spans = {rig.positions[s.name]: s.high - s.low for s in interface.set_points if s.name in set_points}
    healthy = rig.run(duration, start, profiles)
    for sensor in declared.sensors:
        fault = injections.Injection(injections.SENSOR, sensor, declared.kind, injections.PERMANENT)
        fields = injections.scenario_fields(rig, rig.stage.faults, fault, healthy, onset)
        run = rig.run(duration, start, profiles, **fields)
        deviations = {q: np.abs(run[q] - course) for q, course in courses.items()}
        speeds = {q: abs(float(run[rates[q]][-1])) for q in courses if q in rates}
        response = Response(sensor, onset, run, interface, bits, deviations, spans, speeds)
        if declared.contradicted is not None:
            flags = np.asarray(declared.contradicted(rig, run)) & (np.arange(len(time)) >= onset)
            response = replace(response, contradicted=response.first(flags[: response.end + 1]))
        made.append(response)
    return made


def worst(of: Sequence[Response]) -> Response:
    """Return the response with the largest excursion, as a fraction of the range of the set-point."""
    return max(of, key=lambda r: max((r.excursion(q) / span for q, span in r.spans.items()), default=0.0))


def checks(declared: SensorFaults, of: Sequence[Response]) -> list[Check]:
    """Return the checks of all responses."""
    interface, (sensor, command, sign) = of[0].interface, declared.words
    early = max(int(np.count_nonzero(r.run.faults[: r.sample])) for r in of)
    rows = [Check("samples with a fault before the failure", float(early), 0.0, "1")]
    if interface.actuators:
        fast = {a: max(r.slew_rate(a) for r in of) for a in interface.actuators}
        left = {a: max(r.left(a) for r in of) for a in interface.actuators}
        a, b = max(fast, key=lambda a: fast[a] / a.slew_per_s), max(left, key=lambda a: left[a] / a.slew_per_s)
        unit, about = per_second(interface.signals[a.name].unit), f"declared: {a.slew_per_s:g}"
        rows += [
            Check(f"change of a {command} from the latch on", fast[a], a.slew_per_s * (1 + ROUNDING), unit, about),
            Check(f"{command} left at the end after a latch", left[b], 0.0, interface.signals[b.name].unit),
        ]
    refused, braking = interface.bad_samples - 1.0, interface.braking
    if declared.contradicted is None:
        about = f"without those of braking; every {sensor}"
        rows.append(Check("samples until the latch", max(r.latch - braking for r in of), refused, "1", about))
        if braking:
            about = f"every {sensor}"
            rows.append(Check("samples until it brakes", max(r.brakes for r in of), refused, "1", about))
        return rows
    since, isolation = f"samples from a {sign} to the", declared.isolation
    slowest, latest = max(r.isolation_delay for r in of), max(r.latch_delay for r in of)
    rows += [
        Check(f"{since} {sensor}'s name, braking or the latch", slowest, isolation, "1"),
        Check(f"{since} latch", latest, isolation + refused, "1", "without those of braking"),
    ]
    if isfinite(declared.unnoticed):
        unnoticed = float(sum(isinf(r.latch) for r in of))
        rows.append(Check(f"{sensor}s whose failure is not noticed", unnoticed, declared.unnoticed, "1", "no latch"))
    return rows


def figures(declared: SensorFaults, of: Sequence[Response]) -> dict[str, float]:
    """Return the figures of each sensor, or in several motions their shares and the worst."""
    return _over_motions(declared, of) if len(declared.motions) > 1 else _by_sensor(declared, of)


def _by_sensor(declared: SensorFaults, of: Sequence[Response]) -> dict[str, float]:
    values: dict[str, float] = {}
    for r in of:
        known = {f"samples until {r.sensor} is contradicted": r.contradicted} if declared.contradicted else {}
        brakes = {f"samples until it brakes, {r.sensor}": r.brakes} if r.interface.braking else {}
        values |= known | {f"samples until {r.sensor} is named": r.detection} | brakes
        values |= {
            f"samples until the latch, {r.sensor}": r.latch,
            f"sound {declared.words[0]}s named, {r.sensor}": float(len(r.others)),
            **{f"largest |e_{q}| before the latch, {r.sensor}, {_unit(r, q)}": r.excursion(q) for q in r.deviations},
            **{
                f"speed of {q} at the end, {r.sensor}, {per_second(_unit(r, q))}": speed if isfinite(r.latch) else 0.0
                for q, speed in r.speeds.items()
            },
        }
    return values


def _over_motions(declared: SensorFaults, of: Sequence[Response]) -> dict[str, float]:
    sensor, _, sign = declared.words
    detected = [r for r in of if isfinite(r.contradicted)]
    named = [r for r in detected if isfinite(r.detection)]
    other = [r for r in of if isinf(r.contradicted) and isfinite(r.latch)]
    return {
        "runs": float(len(of)),
        f"with a {sign}, %": 100 * len(detected) / len(of),
        "latched by other means alone, %": 100 * len(other) / len(of),
        f"of those detected, the {sensor} is named, %": 100 * len(named) / max(len(detected), 1),
        "of those detected, it is named alone, %": 100 * sum(not r.others for r in named) / max(len(detected), 1),
        f"sound {sensor}s named beside it, mean": sum(len(r.others) for r in named) / max(len(named), 1),
        **{
            f"largest |e_{q}| of undetected failures, {_unit(of[0], q)}": max(
                (r.excursion(q) for r in of if isinf(r.latch)), default=0.0
            )
            for q in of[0].deviations
        },
    }


def _unit(response: Response, position: str) -> str:
    return response.run.units.get(position, "1")
