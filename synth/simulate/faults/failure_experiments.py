"""Experiments in which each of several sensors fails alone: detection, isolation, and the consequences for the machine.

    by_sensor   one kind of failure of each sensor: figures of each
    survey      the same from several starts and at several speeds: shares and the worst

The trajectory of an experiment is that of the run with the largest excursion before the latch. Within `isolation`
samples of the first contradiction of the sensors, the failed one is named in the fault word, alone or with others, or
the controller brakes, or has latched where it does not brake. The latch follows within as many samples as the interface
needs, and those of braking. A failure without a contradiction is not detected; its share is reported.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from synth.check import Check
from synth.simulate.experiment import Experiment
from synth.simulate.faults.failure import Failure, or_never

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
