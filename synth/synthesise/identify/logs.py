"""Logs: samples of named signals, row by row, with or without a sample period; MATLAB `iddata`.

Measurements in a CSV text file: a header of names with units, then one row of numbers for each sample.

    X [mm], Y [mm], V_ax [V], V_ay [mV]
    0.0, 0.0, 0.0021, -3.4

Empty lines and lines that begin with # are skipped. The result is a Log in SI units. A line that cannot be read raises
an error with its number; nothing is guessed.

Library: no design measures yet; docs/library.md has an example.
"""

import csv
import re
from collections.abc import Iterator, Mapping, Sequence
from math import pi
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from synth import arguments, show
from synth.errors import DesignError, SignalError, TimingError
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


# unit -> SI unit, factor, divisor: with a divisor of 1e3, 12.7 mm are 0.0127 m to the last bit
UNITS: dict[str, tuple[str, float, float]] = {
    **{unit: (unit, 1, 1) for unit in ("m", "rad", "V", "T", "s", "1")},
    "mm": ("m", 1, 1e3),
    "um": ("m", 1, 1e6),
    "mrad": ("rad", 1, 1e3),
    "deg": ("rad", pi, 180),
    "mV": ("V", 1, 1e3),
    "mT": ("T", 1, 1e3),
    "ms": ("s", 1, 1e3),
}
COLUMN = re.compile(r"\s*([A-Za-z]\w*)\s*\[\s*([^\]\s]+)\s*\]\s*", re.ASCII)
NUMBER = re.compile(r"\s*[+-]?(\d+(\.\d*)?|\.\d+)([eE][+-]?\d+)?\s*", re.ASCII)
SI = tuple(dict.fromkeys(unit for unit, _, _ in UNITS.values()))
MAX_MAGNITUDE = 1e70  # upper bound of a magnitude, as in `arguments.SIZES`


@arguments.checked
def read(path: Path | str, required: Mapping[str, str]) -> Log:
    """Return the samples of a file; `required` are names and SI units of columns that it must contain.

    Raises DesignError for a file that cannot be opened, and SignalError as `parse`, naming file and line.
    """
    try:
        text = Path(path).read_bytes().decode("utf-8-sig")
    except OSError as error:
        raise DesignError(
            f"{path} cannot be read: {error.strerror}; give the path of a file of measurements"
        ) from error
    except UnicodeDecodeError as error:
        line = error.object[: error.start].count(b"\n") + 1
        raise SignalError(f"{path}, line {line}: a byte is not UTF-8 text: write the file as plain text") from error
    return parse(text, required, str(path))


@arguments.checked
def parse(text: str, required: Mapping[str, str], name: str = "measurements") -> Log:
    """Return the samples in a text called `name`, in SI units.

    Raises SignalError for a required unit that is not an SI unit; and with the line number for a text without columns,
    a column without unit, with an unknown or wrong unit, a duplicate or missing column, a row with more or fewer
    numbers than columns, or an entry that is not a finite number.
    """
    for column, unit in required.items():
        _check_unit(column, unit)
    lines = _lines(text, name)
    where, cells = next(lines, (1, []))
    columns = _read_header(cells, required, f"{name}, line {where}")
    samples: dict[str, list[float]] = {column: [] for column, _ in columns}
    for where, cells in lines:
        if len(cells) != len(columns):
            raise SignalError(
                f"{name}, line {where}: {len(cells)} values for {len(columns)} columns: give one for each, by commas"
            )
        for (column, unit), cell in zip(columns, cells, strict=True):
            samples[column].append(_read_number(cell, unit, f"{name}, line {where}: {column}"))
    if not samples[columns[0][0]]:
        raise SignalError(f"{name}, line {where}: no row of numbers follows the names: give one or more")
    return Log({column: np.array(values) for column, values in samples.items()})


def _check_unit(column: str, unit: str) -> None:
    if unit not in SI:
        raise SignalError(f"'{column}' is asked for in '{unit}': logs are in SI units, give one of {', '.join(SI)}")


def _lines(text: str, name: str) -> Iterator[tuple[int, list[str]]]:
    """Yield the number and the cells of each line that is not empty."""
    for where, line in enumerate(text.split("\n"), 1):
        if line.strip() and not line.lstrip().startswith("#"):
            try:
                yield where, next(csv.reader([line.rstrip("\r")], strict=True))
            except csv.Error as error:
                raise SignalError(f"{name}, line {where}: {error}: write plain numbers by commas") from error


def _read_header(cells: list[str], required: Mapping[str, str], where: str) -> list[tuple[str, str]]:
    units: dict[str, str] = {}
    for cell in cells:
        match = COLUMN.fullmatch(cell)
        if match is None:
            raise SignalError(f"{where}: '{cell.strip()}' is not a column: give a name and its unit, like X [mm]")
        column, unit = match.groups()
        if unit not in UNITS:
            raise SignalError(f"{where}: '{column}' has the unit '{unit}', which is not one of {', '.join(UNITS)}")
        if column in units:
            raise SignalError(f"{where}: the column '{column}' is listed twice: name it once")
        if UNITS[unit][0] != required.get(column, UNITS[unit][0]):
            raise SignalError(f"{where}: '{column}' is in {unit}: give it in {required[column]} or a multiple")
        units[column] = unit
    for column, unit in required.items():
        if column not in units:
            raise SignalError(f"{where}: there is no column '{column}': add '{column} [{unit}]'")
    if not units:
        raise SignalError(f"{where}: there are no columns: begin with names and units, like X [mm], V_ax [V]")
    return list(units.items())


def _read_number(cell: str, unit: str, where: str) -> float:
    if not NUMBER.fullmatch(cell):
        raise SignalError(f"{where} is '{cell.strip()}': give a finite number, with a point and without its unit")
    _, factor, divisor = UNITS[unit]
    value = float(cell) * factor / divisor
    if not abs(value) < MAX_MAGNITUDE:
        raise SignalError(f"{where} is {cell.strip()} {unit}: give a number of a size that can be measured")
    return value
