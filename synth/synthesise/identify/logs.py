"""Logs: samples of named signals, row by row, with or without a sample period; MATLAB `iddata`."""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike

from synth import arguments, show
from synth.errors import SignalError, TimingError
from synth.statespace import Array, readonly
from synth.timing import Discrete

JITTER = 1e-2  # of the period: tolerance of the time between two rows
DRIFT = 1e-4  # of the log's duration: tolerance of the times, twice the drift of a poor quartz clock


@show.result
class Log:
    """Samples (N,) of each signal by name, in the signals' SI units, one period apart if there is one.

    `times` (N,), in s, are compared with the period, row by row and over the whole log, and not stored.

    Raises SignalError for signals with different numbers of samples, no samples, or samples that are not finite, naming
    row and signal; TimingError for a period that is not positive, or times that are not one period apart.
    """

    samples: Mapping[str, Array]
    period_s: float | None = None
    times: ArrayLike | None = None

    def __post_init__(self) -> None:
        if not isinstance(self.samples, Mapping):
            raise SignalError(f"the log is a {type(self.samples).__name__}: give samples by name, like {{'x': [1, 2]}}")
        object.__setattr__(self, "samples", {name: _column(name, v) for name, v in self.samples.items()})
        if not self.samples:
            raise SignalError("the log contains no signal: give samples by name")
        first = next(iter(self.samples))
        for name, values in self.samples.items():
            if len(values) != len(self):
                raise SignalError(
                    f"the log has {len(values)} samples of '{name}' and {len(self)} of '{first}': give as many of each"
                )
        if not len(self):
            raise SignalError(f"the log has no sample of '{first}': give one row or more")
        if self.period_s is not None:
            Discrete(self.period_s)
        if self.times is not None:
            self._check_times(_column("times", self.times))
            object.__setattr__(self, "times", None)

    def __len__(self) -> int:
        """Return the number of rows."""
        return len(next(iter(self.samples.values())))

    def columns(self, names: Sequence[str]) -> Array:
        """Return the samples of some signals (N, k); raise SignalError for one that the log does not contain."""
        for name in names:
            if name not in self.samples:
                raise SignalError(f"the log has no signal '{name}': it has {', '.join(self.samples)}")
        return np.column_stack([self.samples[name] for name in names]) if names else np.zeros((len(self), 0))

    def period(self) -> float:
        """Return the sample period in s; raise TimingError where none was given."""
        if self.period_s is None:
            raise TimingError("the log has no sample period: give period_s")
        return self.period_s

    def sheet(self) -> show.Sheet:
        """Return the number of rows, the period, and the least, mean and largest sample of each signal."""
        spread = [(v.min(), v.mean(), v.max(), v.std()) for v in self.samples.values()]
        table = show.matrix("signal", spread, tuple(self.samples), ("least", "mean", "largest", "deviation"))
        each = "" if self.period_s is None else f", {self.period_s:g} s apart"
        return show.Sheet(f"Log of {len(self)} rows{each}", tables=(table,))

    def _check_times(self, times: Array) -> None:
        if len(times) != len(self):
            raise SignalError(f"the log has {len(times)} times and {len(self)} rows: give one for each row")
        gaps, period = np.diff(times), self.period()
        wrong = np.flatnonzero(np.abs(gaps - period) > JITTER * period)
        if len(wrong):
            k = int(wrong[0])
            raise TimingError(
                f"{gaps[k]:.6g} s pass between rows {k} and {k + 1} of the log, whose period is {period:g} s: "
                "split the log there, or resample it"
            )
        if abs(float(gaps.sum()) - len(gaps) * period) > max(JITTER, DRIFT * len(gaps)) * period:
            raise TimingError(
                f"the rows of the log are {gaps.mean():.6g} s apart on average, and its period is {period:g} s: "
                f"give period_s = {gaps.mean():.6g}, or mend the clock"
            )


def _column(name: str, values: ArrayLike) -> Array:
    column = readonly(arguments.real(f"samples of '{name}'", values))
    if column.ndim != 1:
        raise SignalError(f"the samples of '{name}' have the shape {column.shape}: give an array (N,)")
    if not np.isfinite(column).all():
        row = int(np.flatnonzero(~np.isfinite(column))[0])
        raise SignalError(f"row {row} of '{name}' is {column[row]}: leave the row out of the log or measure it again")
    return column
