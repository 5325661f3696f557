"""Fault campaign and study of a stage as declared: motion, magnitudes and limits of faults (FMEA); limits of a study.

A stage without such a declaration has the default one, without limits. `simulate.campaign` runs it. What it measured
after the latch may be committed as `SafeOutput`, which the C header and the manifest quote.
"""

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from fnmatch import fnmatchcase
from math import inf
from pathlib import Path
from typing import Any

from synth.base import store
from synth.errors import DesignError


@dataclass(frozen=True)
class FaultLimit:
    """In every run whose fault matches, the `measure` is at most `most`.

    measure    impact or impact_Q        largest speed of an impact on a stop beyond the healthy run, of position Q
               energy                    largest energy of an impact, of the positions with a declared inertia
               speed_Q, final_speed_Q    largest speed of Q from the latch on, and at the end of the run
               excursion_Q               largest |q - q of the healthy run| of position Q
               notice_s, latch_s         time from the onset to the first fault bit, to the latch; inf for never
               wrong_names               sensors without a fault that a fault bit names
               false_alarms              samples with a fault bit in the healthy runs
               healthy_impact            largest speed of an impact on a stop in the healthy runs

    `target`, `kind`, `condition` and `duration` are patterns of `fnmatch` for the columns of the table. Runs in which
    the fault has no effect count as neither noticed nor late.
    """

    measure: str
    most: float
    target: str = "*"
    kind: str = "*"
    condition: str = "*"
    duration: str = "*"


@dataclass(frozen=True, eq=False)
class FaultCampaign:
    """Conditions, magnitudes and limits of a fault campaign.

    motion            {set-point: course} in motion, from rest at its start; by default each set-point swings as a sine
    operating_points  {name: {set-point: value}} where the machine rests, too, besides its initial set-points
    period_s          period of the motion, over which the onsets are spread, and of the default motion
    settle_s          from the start of a run to the first onset; `watch_s` from the last onset to the end
    onsets            number of onsets in motion
    durations_s       of faults that are neither permanent nor short
    offset, noise, drift_per_s   of a faulty sensor, as fractions of its range; noise as standard deviation
    bit               the highest bit whose weight is at most this fraction of the sensor's range is flipped or stuck
    jump              of a set-point, as a fraction of its range
    repeated          samples in which a sensor repeats a reading
    weak              fraction of the command that a weak actuator applies
    inertias          {position: plant parameter}, its mass or moment of inertia, or several that add up, such as those
                      of machine and payload: impacts on its stop have an energy, and forces accelerate it
    """

    motion: Mapping[str, Any] = field(default_factory=dict)
    operating_points: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    period_s: float = 1.0
    settle_s: float = 1.0
    watch_s: float = 1.0
    onsets: int = 2
    durations_s: Sequence[float] = (0.05,)
    offset: float = 0.02
    noise: float = 0.005
    drift_per_s: float = 0.05
    bit: float = 0.05
    jump: float = 0.1
    repeated: int = 10
    weak: float = 0.7
    inertias: Mapping[str, str | Sequence[str]] = field(default_factory=dict)
    limits: Sequence[FaultLimit] = ()

    def inertia(self, of: str) -> tuple[str, ...]:
        """Return the plant parameters whose sum is the inertia of a position."""
        names = self.inertias[of]
        return (names,) if isinstance(names, str) else tuple(names)


@dataclass(frozen=True)
class StudyLimits:
    """What must hold on the machines of a study, within the tolerances of the plant and of the sensors.

    The limits of an experiment are those of the nominal plant. `limits` {pattern: limit} has others in their place, by
    `fnmatch` patterns of "experiment: check"; inf is no limit. `least_yield` is the least share of the machines that
    keep every limit. `experiments` are patterns of the names of those that a study runs where it is given none; all
    of them without patterns.
    """

    least_yield: float = -inf
    limits: Mapping[str, float] = field(default_factory=dict)
    experiments: tuple[str, ...] = ()

    def require_experiments(self, names: Sequence[str]) -> None:
        """Raise DesignError for a pattern that names none of the experiments of a stage."""
        for pattern in (*self.experiments, *self.limits):
            if not any(fnmatchcase(name, pattern.partition(": ")[0]) for name in names):
                raise DesignError(
                    f"study: '{pattern}' names no experiment: write 'experiment: check' for a limit, with one of "
                    f"{', '.join(names) or 'no experiment'}"
                )


Speeds = Mapping[str, float]


@dataclass(frozen=True)
class SafeOutput:
    """What a machine did after the latch: of each condition the largest speeds and impacts, by position.

    `units` are those of the speeds, by position. In each of the `runs` one sensor was lost for the rest of the run, on
    one of the `plants`; in `latched` of them the controller latched. Impacts are those on declared stops, if any.
    """

    command: str
    plants: int
    runs: int
    latched: int
    units: Mapping[str, str]
    speeds: Mapping[str, Speeds]
    impacts: Mapping[str, Speeds]

    def text(self) -> str:
        """Return the measurement as one sentence without a full stop, with two significant digits."""
        conditions = "; ".join(f"{condition} {self._condition(condition)}" for condition in self.speeds)
        lost = f"on {self.plants} plants with each sensor lost in turn"
        return f"largest speeds and impacts after the latch, measured {lost}: {conditions}"

    def _condition(self, name: str) -> str:
        speeds, impacts = self._worst(self.speeds[name]), self._worst(self.impacts[name])
        stops = f" and hits {f'a stop at {impacts}' if impacts else 'no stop'}" if self.impacts[name] else ""
        return (f"the machine reaches {speeds}" if speeds else "the machine does not move") + stops

    def _worst(self, speeds: Speeds) -> str:
        """Return the largest speed of each unit with its position."""
        by_unit: dict[str, str] = {}
        for q, speed in speeds.items():
            unit = self.units[q]
            if speed > 0 and (unit not in by_unit or speed > speeds[by_unit[unit]]):
                by_unit[unit] = q
        return " and ".join(f"{speeds[q]:.2g} {unit} ({q})" for unit, q in by_unit.items())

    def write(self, path: Path) -> None:
        """Write the figures to a file, for `read_safe_output`."""
        store.replace_text(path, json.dumps(asdict(self), indent=1) + "\n")


def read_safe_output(path: Path) -> SafeOutput | None:
    """Return the figures in a file, None where there is no such file; raise DesignError for another content."""
    if not path.is_file():
        return None
    try:
        return SafeOutput(**json.loads(path.read_text(encoding="utf-8")))
    except (TypeError, ValueError) as error:
        raise DesignError(
            f"{path.name}: found {error}, need figures: write them by `synth faults NAME --write`"
        ) from error
