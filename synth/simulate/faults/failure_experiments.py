"""Experiments in which each of several sensors fails alone: detection, isolation, and the consequences for the machine.

    by_sensor   one kind of failure of each sensor: figures of each
    survey      the same from several starts and at several speeds: shares and the worst

The trajectory of an experiment is that of the run with the largest excursion before the latch. Within `isolation`
samples of the first contradiction of the sensors, the failed one is named in the fault word, alone or with others, or
the controller brakes, or has latched where it does not brake. The latch follows within as many samples as the interface
needs, and those of braking. A failure without a contradiction is not detected; its share is reported.

Faults of a channel, or of all channels of a group, in an ensemble of bodies: what integrity monitoring must notice.

    y_faulty(k) = g(y(k), kept, k)    k samples since the failure, kept: what a converter goes on showing

A group are channels that fail together, such as the two of a sensor head. What is stuck shows the values of another
place, what is frozen the last ones before it failed: `GroupFailure.kept` holds either.

Fault injection: one sensor fails in closed loop; detection, fault latch and response of the machine are measured.

From a given sample on, the sensor shows a constant (dead, out of range, NaN) or sticks at its last valid reading.
Samples are counted from the first bad sample, which has number 0.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from synth.check import Check
from synth.fault import BRAKING_BIT, LATCH_BIT
from synth.simulate.experiments import Experiment
from synth.simulate.rig import Rig
from synth.simulate.scenario import Array, Override, Trajectory, sample_times

Values = NDArray[Any]
# Of (N, channels) now, (N, channels) kept, samples since the failure; a fault of one channel is one of the first.
Fault = Callable[[Values, Values, int | Values], Values]


def faults(
    offset: float, drift: float, end: float, channel: str = "channel", group: str = "group"
) -> Mapping[str, Fault]:
    """Return the faults by name: `offset`, `drift` a sample, and the `end` of the range in the channels' unit.

    `channel` and `group` are the words for these in the names.
    """
    return {
        "none": lambda y, kept, k: y,
        f"dead {channel}": _of_first(lambda y, kept, k: 0.0),
        f"dead {group}": lambda y, kept, k: 0 * y,
        f"stuck {channel}": _of_first(lambda y, kept, k: kept),
        f"stuck {group}": lambda y, kept, k: kept,
        "saturated": _of_first(lambda y, kept, k: end),
        "offset": _of_first(lambda y, kept, k: y + offset),
        f"halved {channel}": _of_first(lambda y, kept, k: y / 2),
        f"halved {group}": lambda y, kept, k: y / 2,
        "drift": _of_first(lambda y, kept, k: y + drift * k),
        f"frozen {channel}": _of_first(lambda y, kept, k: kept),
        f"frozen {group}": lambda y, kept, k: kept,
    }


def is_frozen(name: str) -> bool:
    """Return whether a fault keeps the last values, not those of another place."""
    return name.startswith("frozen")


def _of_first(value: Callable[[Values, Values, int | Values], Values | float]) -> Fault:
    def fault(y: Values, kept: Values, k: int | Values) -> Values:
        failed = y.copy()
        failed[:, 0] = value(y[:, 0], kept[:, 0], k)
        return failed

    return fault


@dataclass(frozen=True, eq=False)
class GroupFailure:
    """A fault of a group of each body (N,), or of its `channel`; `kept` (N, channels) are values of the group."""

    fault: Fault
    group: NDArray[np.int_]
    channel: NDArray[np.int_]
    kept: Values

    def of_group(self, y: Values) -> Values:
        """Return the values (N, channels) of the failing groups, of those of all (N, groups, channels)."""
        return np.asarray(y[np.arange(len(y)), self.group])

    def corrupt(self, y: Values, since: int) -> None:
        """Overwrite values (N, groups, channels) of a sample, so many samples since the failure."""
        order = (self.channel[:, None] + np.arange(y.shape[2])) % y.shape[2]
        now, kept = (np.take_along_axis(v, order, axis=1) for v in (self.of_group(y), self.kept))
        failed = np.empty_like(now)
        np.put_along_axis(failed, order, self.fault(now, kept, since), axis=1)
        y[np.arange(len(y)), self.group] = failed


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


NAN = "nan"  # a kind of failure that the guard refuses at once


@dataclass(frozen=True)
class Limits:
    """Largest samples to the isolation and bad samples to the latch; and the fastest change of a command after it.

    `slew_about` says what is declared.
    """

    isolation: int
    bad_samples: int
    slew: float
    slew_unit: str
    slew_about: str


@dataclass(frozen=True)
class Texts:
    """Title and description of an experiment, and the positions that are shown."""

    name: str
    title: str
    about: str
    positions: tuple[str, ...]


def experiment(
    texts: Texts, failures: Sequence[Failure], figures: Mapping[str, float], checks: Sequence[Check]
) -> Experiment:
    """Return an experiment that shows the failure with the largest excursion."""
    worst = max(failures, key=lambda f: f.excursion)
    about = f"{texts.about}; shown is {worst.sensor}"
    return Experiment(texts.name, texts.title, about, worst.run, texts.positions, {}, figures, tuple(checks))


def by_sensor(
    texts: Texts,
    failures: Sequence[Failure],
    checks: Sequence[Check],
    further: Callable[[Failure], Mapping[str, float]],
) -> Experiment:
    """Return the experiment of one failure of each sensor; `further` returns more figures of one."""
    figures: dict[str, float] = {}
    for f in failures:
        figures |= {
            f"samples until {f.sensor} is contradicted": or_never(f.contradicted),
            f"samples until {f.sensor} is named": or_never(f.samples_to_detection),
            **({f"samples until it brakes, {f.sensor}": or_never(f.samples_to_braking)} if f.braking else {}),
            f"samples until the latch, {f.sensor}": or_never(f.samples_to_latch),
            f"sound channels named, {f.sensor}": len(f.others),
            f"largest excursion before the latch, {f.sensor}, um": 1e6 * f.excursion,
            **further(f),
        }
    return experiment(texts, failures, figures, checks)


def checks(failures: Sequence[Failure], kind: str, limits: Limits, seen: bool) -> list[Check]:
    """Return the checks of the failures of each sensor; with `seen` each must be detected."""
    early = max(int(np.count_nonzero(f.run.faults[: f.sample])) for f in failures)
    rows = [
        Check("samples with a fault before the failure", float(early), 0.0, "1"),
        slew_check(failures, limits),
        Check("current left at the end after a latch", max(f.final_command() for f in failures), 0.0, "A"),
    ]
    if kind == NAN:
        return [*rows, *_latch_checks(failures, limits)]
    rows.extend(isolation_checks(failures, limits))
    if seen:
        undetected = float(sum(f.samples_to_latch is None for f in failures))
        rows.append(Check("channels whose failure is not noticed", undetected, 0.0, "1", "in 1 s"))
    return rows


def _latch_checks(failures: Sequence[Failure], limits: Limits) -> list[Check]:
    limit, late = limits.bad_samples - 1.0, max(or_never(f.samples_to_latch) - f.braking for f in failures)
    rows = [Check("samples until the latch", late, limit, "1", "without those of braking; every channel")]
    if braked := [or_never(f.samples_to_braking) for f in failures if f.braking]:
        rows.append(Check("samples until it brakes", max(braked), limit, "1", "every channel"))
    return rows


def slew_check(failures: Sequence[Failure], limits: Limits) -> Check:
    """Return the check of the fastest change of a command from the latch on."""
    fastest = max(f.max_slew_rate() for f in failures)
    return Check("change of a current from the latch on", fastest, limits.slew, limits.slew_unit, limits.slew_about)


def isolation_checks(failures: Sequence[Failure], limits: Limits) -> list[Check]:
    """Return the checks of the delays from a contradiction to the sensor's name and to the latch."""
    of = "samples from a residual out of bounds to the"
    slowest, latest = max(f.isolation_delay for f in failures), max(f.latch_delay for f in failures)
    limit = limits.isolation + limits.bad_samples - 1.0
    return [
        Check(f"{of} channel's name, braking or the latch", slowest, limits.isolation, "1"),
        Check(f"{of} latch", latest, limit, "1", "without those of braking"),
    ]


def survey(texts: Texts, failures: Sequence[Failure], limits: Limits) -> Experiment:
    """Return the survey of the failures of all sensors from several starts and at several speeds."""
    detected = [f for f in failures if f.contradicted is not None]
    isolated = [f for f in detected if f.samples_to_detection is not None]
    latched_otherwise = [f for f in failures if f.contradicted is None and f.samples_to_latch is not None]
    undetected = [f.excursion for f in failures if f.samples_to_latch is None]
    figures = {
        "runs": float(len(failures)),
        "with a residual out of its bound, %": 100 * len(detected) / len(failures),
        "latched by other means alone, %": 100 * len(latched_otherwise) / len(failures),
        "of those detected, the channel is named, %": 100 * len(isolated) / len(detected),
        "of those detected, it is named alone, %": 100 * sum(not f.others for f in isolated) / len(detected),
        "sound channels named beside it, mean": float(np.mean([len(f.others) for f in isolated])),
        "largest excursion of undetected failures, um": 1e6 * max(undetected, default=0.0),
    }
    return experiment(texts, failures, figures, (*isolation_checks(failures, limits), slew_check(failures, limits)))
