"""Declaration of a tuning: the free parameters of a control law within bounds, and the goals beyond the requirements.

    tuning=Tuning(
        free=[FreeParameter("speed", 25.0, 5.0, 80.0, "1/s"), FreeParameter("weight", 1e3, 10.0, 1e5)],
        controller=lambda values: stage.controller("levitator", TIME, INTERFACE, [law(**values)]),
        require={"disk_margin": 0.5},
    )

`synth tune` proposes values; those of the declaration stay until they are edited.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from synth.check import Check
from synth.errors import SignalError

LARGEST = 100.0  # a larger ratio, or a value that is missing, counts as this


@dataclass(frozen=True)
class FreeParameter:
    """A free parameter: the declared `value`, and bounds; the search is logarithmic where `low` is above 0."""

    name: str
    value: float
    low: float
    high: float
    unit: str = "1"
    about: str = ""

    def __post_init__(self) -> None:
        """Check the bounds."""
        if not -np.inf < self.low <= self.value <= self.high < np.inf or self.low == self.high:
            raise SignalError(
                f"free parameter '{self.name}' is {self.value} {self.unit} within {self.low} .. {self.high}: give "
                "finite bounds, the lower one first, with the declared value between them"
            )

    def at(self, share: float) -> float:
        """Return the value at a share of the range, 0 .. 1."""
        if self.low > 0:
            return float(np.clip(self.low * (self.high / self.low) ** share, self.low, self.high))
        return self.low + (self.high - self.low) * share

    @property
    def share(self) -> float:
        """The share of the range at which the declared value lies."""
        if self.low > 0:
            return float(np.log(self.value / self.low) / np.log(self.high / self.low))
        return (self.value - self.low) / (self.high - self.low)


@dataclass(frozen=True)
class Bench:
    """Free parameters that are tuned on the running machine, each within `ranges`: {name: (low, high)}.

    The constants of the law that follow from them move to new values over `ramp_s` seconds.
    """

    ranges: Mapping[str, tuple[float, float]]
    ramp_s: float = 0.1


@dataclass(frozen=True, eq=False)
class Tuning:
    """What `synth tune` may change, and what it shall reach.

    free         the free parameters
    controller   {name: value} of these to a `stage.controller`; the declared values give the declared controller
    experiments  patterns of the experiments' names that the search runs, all of them without patterns, except for those
                 with a further plant, such as effects make, which `synth study` runs
    goals        {"experiment: check or figure": largest value} in place of the study's or the check's limit
    points       operating points at which the search computes margins, at all corners of the tolerances and in all
                 cases; all of them without. The certificate has all
    require      least margins beyond those of the stage; `disk_margin` is that of all actuators and sensors at once
    bench        which of them may change on the running machine: the C then takes the constants that follow
    """

    free: Sequence[FreeParameter]
    controller: Callable[[Mapping[str, float]], Any]
    experiments: Sequence[str] = ()
    points: Sequence[str] = ()
    goals: Mapping[str, float] = field(default_factory=dict)
    require: Mapping[str, float] = field(default_factory=dict)
    bench: Bench | None = None

    def __post_init__(self) -> None:
        """Check the ranges of the bench."""
        free = {f.name: f for f in self.free}
        for name, (low, high) in (self.bench.ranges if self.bench else {}).items():
            if name not in free:
                raise SignalError(
                    f"the bench tunes '{name}', which is no free parameter: name some of {', '.join(free)}"
                )
            f = free[name]
            if not f.low <= low <= f.value <= high <= f.high or low == high:
                raise SignalError(
                    f"the bench tunes '{name}' within {low} .. {high} {f.unit}: give a range within {f.low} .. "
                    f"{f.high} that holds the declared value {f.value}"
                )


@dataclass(frozen=True)
class Plan:
    """The machines, the seed of these and of the search, and the generations of each of its runs."""

    plants: int
    seed: int
    generations: int


@dataclass(frozen=True)
class Goal:
    """A goal: the value reached, its limit, and the ratio that is at most 1 where the goal is reached."""

    name: str
    unit: str
    value: float
    limit: float
    is_margin: bool

    @property
    def ratio(self) -> float:
        """The value over its limit, the inverse for a margin; LARGEST without a value, and beyond a limit of 0."""
        if self.is_margin:
            ratio = self.limit / self.value if self.value > 0 else np.inf
        elif self.limit > 0:
            ratio = self.value / self.limit
        else:
            ratio = 0.0 if self.value <= self.limit else np.inf
        return LARGEST if np.isnan(ratio) else float(np.clip(ratio, 0.0, LARGEST))


@dataclass(frozen=True)
class Candidate:
    """Values of the free parameters and the goals that they reach; `error` tells why they give no law."""

    values: Mapping[str, float]
    goals: tuple[Goal, ...]
    error: str = ""

    @property
    def performance(self) -> float:
        """The largest ratio of the experiments."""
        return self._largest(False)

    @property
    def robustness(self) -> float:
        """The largest ratio of the margins."""
        return self._largest(True)

    @property
    def worst(self) -> float:
        """The largest ratio."""
        return max(self.performance, self.robustness)

    def _largest(self, margins: bool) -> float:
        ratios = [goal.ratio for goal in self.goals if goal.is_margin == margins]
        return LARGEST if self.error else max(ratios, default=0.0)


@dataclass(frozen=True)
class Certificate:
    """The proposal under C of its own: the goals that this reaches, checks, and its margins over the tolerances."""

    goals: tuple[Goal, ...]
    checks: tuple[Check, ...]
    margins: Mapping[str, float]


@dataclass(frozen=True)
class Tuned:
    """The declared law (`baseline`), the certified proposal, the Pareto front, and the number of candidates."""

    plan: Plan
    baseline: Candidate
    proposal: Candidate
    certificate: Certificate
    front: tuple[Candidate, ...]
    candidates: int

    @property
    def passed(self) -> bool:
        """Whether the proposal reaches every goal and its certificate holds."""
        return self.proposal.worst <= 1 and all(check.passed for check in self.certificate.checks)


@dataclass(frozen=True)
class Tried:
    """The least margins by name, NaN for a stage without loops, with values of the bench's free parameters.

    `missed` are the names of those below what is required.
    """

    values: Mapping[str, float]
    margins: Mapping[str, float]
    missed: tuple[str, ...]


@dataclass(frozen=True)
class BenchMargins:
    """All that was tried over the ranges of a bench, in order, and the least of each margin with where it occurs."""

    tried: tuple[Tried, ...]

    @property
    def least(self) -> dict[str, Tried]:
        """The place of the least value of each margin."""
        return {name: min(self.tried, key=lambda t: t.margins[name]) for name in self.tried[0].margins}
