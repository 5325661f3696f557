"""The records of a loop: CSV with names and units, as `src/recorder.c` writes them, read as a `Log` for `identify`."""

import csv
import re
from pathlib import Path

import numpy as np

from synth.errors import SignalError
from synth.synthesise.identify.logs import Log

COLUMN = re.compile(r"(\w+) \[(.*)\]")


def read(path: Path, period_s: float | None = None) -> Log:
    """Return the columns (N,) of a record by name, in their units, which are those of the stage.

    With `period_s` the column of the time is held against it: a missed period is then refused.

    Raises SignalError for a file that is not a record, naming line and column, and as `Log`; TimingError as `Log`.
    """
    with path.open(newline="", encoding="utf-8") as file:
        rows = list(csv.reader(file))
    titles = [COLUMN.fullmatch(title) for title in rows[0]] if rows else []
    names = [title[1] for title in titles if title]
    if not names or len(names) < len(titles) or names[0] != "t":
        raise SignalError(f"{path}, line 1: found {rows[:1]}, need `t [s]` and names with units: give a loop's record")
    table = np.empty((len(rows) - 1, len(names)))
    for k, row in enumerate(rows[1:]):
        try:
            table[k] = [float(row[i]) for i in range(len(names))]
        except (ValueError, IndexError) as error:
            raise SignalError(f"{path}, line {k + 2}: found {row}, need {len(names)} numbers: cut it off") from error
    columns = dict(zip(names, table.T, strict=True))
    times = columns.pop("t")
    return Log(columns, period_s, None if period_s is None else times)


def units(path: Path) -> dict[str, str]:
    """Return the unit of each column by name."""
    with path.open(newline="", encoding="utf-8") as file:
        titles = next(csv.reader(file), [])
    return {match[1]: match[2] for title in titles if (match := COLUMN.fullmatch(title))}
