"""Continuous and discrete time as types: a model is continuous, or sampled with one period; mixing raises an error."""

import math
from dataclasses import dataclass
from numbers import Real

from synth import arguments
from synth.errors import TimingError


@dataclass(frozen=True)
class Continuous:
    """Time t in R, seconds."""

    def __str__(self) -> str:
        return "continuous time"


@dataclass(frozen=True)
class Discrete:
    """Time t = k T with the sample period T = `period_s`, seconds.

    Raises TimingError when the period is not a finite positive number.
    """

    period_s: float

    def __post_init__(self) -> None:
        if not isinstance(self.period_s, Real) or isinstance(self.period_s, bool):
            raise TimingError(f"the sample period is {arguments.describe(self.period_s)}: give a number of seconds")
        if not (math.isfinite(self.period_s) and self.period_s > 0):
            raise TimingError(f"the sample period is {self.period_s} s: it must be finite and positive")

    def __str__(self) -> str:
        return f"discrete time of {self.period_s:g} s"


Time = Continuous | Discrete


@arguments.checked
def common(*times: Time) -> Time:
    """Return the common time; raise TimingError naming the first that differs, or when no time is given."""
    if not times:
        raise TimingError("no times were given to compare: give one or more")
    for time in times[1:]:
        if time != times[0]:
            raise TimingError(f"{times[0]} meets {time}: discretise or resample one of them")
    return times[0]


@arguments.checked
def period(time: Time) -> float:
    """Return the sample period in seconds; raise TimingError for continuous time."""
    if isinstance(time, Discrete):
        return time.period_s
    if not isinstance(time, Continuous):
        raise TimingError(f"the time is {time!r}: give Discrete with a sample period")
    raise TimingError("a continuous model has no sample period: discretise it first")
