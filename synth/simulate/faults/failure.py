"""Fault injection: one sensor fails in closed loop; detection, fault latch and response of the machine are measured.

From a given sample on, the sensor shows a constant (dead, out of range, NaN) or sticks at its last valid reading.
Samples are counted from the first bad sample, which has number 0.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from synth.fault import BRAKING_BIT, LATCH_BIT
from synth.simulate.rig import Rig
from synth.simulate.scenario import Array, Trajectory, sample_times
from synth.simulate.sensors import Override


@dataclass(frozen=True, eq=False)
class Failure:
    """A run in which `sensor` fails at `sample`; `bits` are the bits of the fault word that identify each sensor.

    `deviation` (N,) is the largest |position - set-point| over the positions that have a set-point. `contradicted` is
    the samples from the failure until its law could know it, None if it never can; `suspected` are the sensors that the
    law compares. The controller brakes for `braking` samples before the latch.
    """

    sensor: str
    sample: int
    run: Trajectory
    deviation: Array
    bits: Mapping[str, int]
    suspected: tuple[str, ...] = ()
    braking: int = 0
    contradicted: int | None = None

    @property
    def samples_to_latch(self) -> int | None:
        """Samples from the failure to the latch, None without a latch."""
        return self.first(self.run.faults >> LATCH_BIT & 1)

    @property
    def samples_to_detection(self) -> int | None:
        """Samples from the failure until the fault word identifies the sensor, None if it does not before the latch."""
        return self.first(self.words & self.bits[self.sensor])

    @property
    def misidentified_sensors(self) -> tuple[str, ...]:
        """The sensors that the fault word identifies before the latch although they work."""
        word = int(np.bitwise_or.reduce(self.words))
        return tuple(name for name, bits in self.bits.items() if word & bits and name != self.sensor)

    @property
    def others(self) -> tuple[str, ...]:
        """The working sensors among the suspected ones that the fault word identifies before the latch."""
        return tuple(name for name in self.misidentified_sensors if name in self.suspected)

    @property
    def samples_to_braking(self) -> int | None:
        """Samples from the failure until it brakes, None if it does not before the latch."""
        return self.first(self.words >> BRAKING_BIT & 1)

    @property
    def samples_to_reaction(self) -> int | None:
        """Samples from the failure until it brakes, or until it latches where it does not brake."""
        return self.samples_to_braking if self.braking else self.samples_to_latch

    @property
    def isolation_delay(self) -> float:
        """Samples from the contradiction to the sensor's name or the reaction: 0 without the former, inf without these.

        A reaction does not count when only working sensors are named.
        """
        if self.contradicted is None:
            return 0.0
        answers = [self.samples_to_detection, None if self.others else self.samples_to_reaction]
        return min((float(n - self.contradicted) for n in answers if n is not None), default=np.inf)

    @property
    def latch_delay(self) -> float:
        """Samples from the contradiction to the latch, without those of braking; inf without a latch."""
        if self.contradicted is None:
            return 0.0
        return or_never(self.samples_to_latch) - self.braking - self.contradicted

    @property
    def words(self) -> NDArray[np.uint32]:
        """The fault words up to the latch."""
        return self.run.faults[: None if self.samples_to_latch is None else self.sample + self.samples_to_latch + 1]

    @property
    def excursion(self) -> float:
        """The largest deviation from the failure to the latch."""
        end = None if self.samples_to_latch is None else self.sample + self.samples_to_latch
        return float(self.deviation[self.sample : end].max(initial=0.0))

    def max_slew_rate(self) -> float:
        """Return the fastest change of a command from the latch on, in its unit per s, 0 without a latch."""
        if self.samples_to_latch is None:
            return 0.0
        step = float(self.run.time[1] - self.run.time[0])
        return (
            float(np.abs(np.diff(self._commands()[:, self.sample + self.samples_to_latch - 1 :], axis=1)).max()) / step
        )

    def final_command(self) -> float:
        """Return the largest command at the end, 0 without a latch."""
        return 0.0 if self.samples_to_latch is None else float(np.abs(self._commands()[:, -1]).max())

    def first(self, flags: NDArray[Any]) -> int | None:
        """Return the samples from the failure to the first flag, None without a flag."""
        samples = np.flatnonzero(flags)
        return int(samples[0]) - self.sample if samples.size else None

    def _commands(self) -> Array:
        return np.array(list(self.run.commands.values()), dtype=np.float64)


def fail(
    rig: Rig,
    sensor: str,
    shown: float | None,
    at_s: float,
    duration_s: float,
    courses: Mapping[str, Array],
    start: Mapping[str, float],
    contradicts: Callable[[Rig, Trajectory], NDArray[np.bool_]] | None = None,
) -> Failure:
    """Run a rig from rest at `start` on set-point profiles `courses` (N,); from `at_s` on a sensor shows only `shown`.

    With `shown` None it sticks at its last valid reading. `contradicts` returns the samples (N,) in which the sensors
    of a run contradict each other. Raises SignalError as `Rig.run`.
    """
    time = sample_times(duration_s, rig.period_s)
    k = int(np.argmax(time >= at_s))
    value = _sound_reading(rig, sensor, k, courses, start) if shown is None else shown
    bad = Override(np.arange(len(time)) >= k, np.full(len(time), value))
    run = rig.run(duration_s, start, courses, overrides={sensor: bad})
    deviation = np.abs(np.array([run[rig.positions[name]] - course for name, course in courses.items()])).max(axis=0)
    interface = rig.stage.interface
    f = Failure(sensor, k, run, deviation, bits(rig), interface.suspected, interface.braking)
    if contradicts is None:
        return f
    flags = contradicts(rig, run) & (np.arange(len(time)) >= k)
    return replace(f, contradicted=f.first(flags[: len(f.words)]))


def or_never(samples: int | None) -> float:
    """Return a count of samples, inf for None."""
    return np.inf if samples is None else float(samples)


def bits(rig: Rig) -> dict[str, int]:
    """Return the bits of the fault word that identify each sensor, as out of range or as a suspect."""
    words = dict.fromkeys((s.name for s in rig.stage.interface.sensors), 0)
    for fault in rig.controller.manifest["faults"]:
        name = fault.get("input") or fault.get("suspect")
        if name in words:
            words[name] |= 1 << fault["bit"]
    return words


def _sound_reading(rig: Rig, sensor: str, k: int, courses: Mapping[str, Array], start: Mapping[str, float]) -> float:
    """Return the reading of a working sensor at sample k."""
    until = {name: course[: k + 1] for name, course in courses.items()}
    return float(rig.run((k + 1) * rig.period_s, start, until).measured[sensor][k])
