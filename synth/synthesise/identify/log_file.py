"""Measurements in a CSV text file: a header of names with units, then one row of numbers for each sample.

    X [mm], Y [mm], V_ax [V], V_ay [mV]
    0.0, 0.0, 0.0021, -3.4

Empty lines and lines that begin with # are skipped. The result is a Log in SI units. A line that cannot be read raises
an error with its number; nothing is guessed.

Library: no design measures yet; docs/library.md has an example.
"""

import csv
import re
from collections.abc import Iterator, Mapping
from math import pi
from pathlib import Path

import numpy as np

from synth import arguments
from synth.errors import DesignError, SignalError
from synth.synthesise.identify.logs import Log

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
