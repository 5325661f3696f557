"""Validation of numbers, rows and tables from a user; errors name the quantity."""

from contextlib import suppress
from dataclasses import field, fields
from math import inf, isfinite
from numbers import Real
from typing import Any

import numpy as np
from numpy.typing import NDArray

from synth.errors import ModelError

MOST_SENSORS = 26  # they are named a to z


def number(name: str, value: object) -> float:
    """Return a finite number; raise ModelError for text, a bool, None, NaN or an infinite value."""
    if isinstance(value, Real) and not isinstance(value, bool):
        with suppress(OverflowError):
            real = float(value)
            if isfinite(real):
                return real
    raise ModelError(f"{name} is {value!r}: it must be finite, give a number")


def positive(name: str, value: object) -> float:
    """Return a finite number above 0; raise ModelError for anything else."""
    real = number(name, value)
    if not real > 0:
        raise ModelError(f"{name} is {value}: it must be finite and positive")
    return real


def whole(name: str, value: object, least: int = 1, most: float = inf) -> int:
    """Return a whole number of at least `least` and at most `most`; raise ModelError for anything else."""
    if isinstance(value, bool) or not isinstance(value, int | np.integer) or not least <= value <= most:
        limit = "" if most == inf else f" and at most {most}"
        raise ModelError(f"{name} is {value!r}: give a whole number of at least {least}{limit}")
    return int(value)


def above(name: str, value: object, low: float, high: float = inf) -> float:
    """Return a finite number above `low` and at most `high`; raise ModelError for anything else."""
    real = number(name, value)
    if not low < real <= high:
        limit = "" if high == inf else f" and at most {high}"
        raise ModelError(f"{name} is {value}: it must be above {low}{limit}")
    return real


def between(low: float, default: float, high: float) -> Any:
    """Return a dataclass field above `low` and at most `high`; a whole number from `low` on if the default is whole."""
    return field(default=default, metadata={"range": (low, high)})


def check_fields(of: Any) -> None:
    """Check the fields of a dataclass that are declared by `between`.

    Raises ModelError with the name of the first one out of its range.
    """
    for f in (f for f in fields(of) if "range" in f.metadata):
        (whole if isinstance(f.default, int) else above)(f.name, getattr(of, f.name), *f.metadata["range"])


def numbers(name: str, values: object) -> tuple[float, ...]:
    """Return finite numbers from a tuple, a list or an array; raise ModelError for anything else."""
    try:
        entries: tuple[object, ...] = tuple(values)  # type: ignore[arg-type]
    except TypeError as error:
        raise ModelError(f"{name} are {values!r}: give numbers in a row") from error
    return tuple(number(f"one of {name}", v) for v in entries)


def rows(name: str, values: object, size: int) -> tuple[tuple[float, ...], ...]:
    """Return rows of `size` finite numbers, from tuples, lists or an array; raise ModelError for anything else."""
    needed = f"give {size} numbers for each"
    try:
        entries: tuple[tuple[object, ...], ...] = tuple(tuple(row) for row in values)  # type: ignore[attr-defined]
    except TypeError as error:
        raise ModelError(f"{name} are {values!r}: {needed}") from error
    for row in entries:
        if len(row) != size:
            raise ModelError(f"{name} are {entries}, where {row} has {len(row)} numbers: {needed}")
    return tuple(numbers(name, row) for row in entries)


def positions(values: object, size: int) -> tuple[tuple[float, ...], ...]:
    """Return positions of sensors, `size` coordinates each; raise ModelError for other values and for more than 26."""
    positions = rows("positions", values, size)
    if len(positions) > MOST_SENSORS:
        raise ModelError(f"there are {len(positions)} positions: sensors are named a to z, give {MOST_SENSORS} at most")
    return positions


def table(name: str, values: object, columns: int) -> NDArray[np.float64]:
    """Return an array (N, columns) of finite numbers, N at least 1; raise ModelError for anything else."""
    needed = f"give finite numbers (N, {columns}), a row or more"
    try:
        array = np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise ModelError(f"{name} are no numbers, {error}: {needed}") from error
    if array.ndim != 2 or array.shape[1] != columns or not len(array) or not np.isfinite(array).all():
        lacking = "" if np.isfinite(array).all() else ", not all finite"
        raise ModelError(f"{name} have the shape {array.shape}{lacking}: {needed}")
    return array
