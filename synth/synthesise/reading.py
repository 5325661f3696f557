"""What is given, read once: arrays of real numbers, distinct names, whole numbers, probabilities."""

import operator
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from synth.errors import SignalError
from synth.statespace import Array

SIZES = (1e-70, 1e70)  # magnitudes whose squares, and the covariances made of them, are numbers in double precision


def real(what: str, values: ArrayLike) -> Array:
    """Return an array as float64.

    Raises SignalError, calling it `what`, for complex, masked or ragged values and for text.
    """
    try:
        if np.ma.is_masked(values):
            raise ValueError("some are masked")
        if np.iscomplexobj(values):
            raise ValueError("they are complex")
        return np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise SignalError(f"the {what} are no real numbers ({error}): give an array of real numbers alone") from error


def distinct(what: str, names: Sequence[str]) -> tuple[str, ...]:
    """Return names as a tuple; raise SignalError for one text instead of several, no name or one that stands twice."""
    if isinstance(names, str):
        raise SignalError(f"the {what} are the text '{names}': give a list of names, like ['{names}']")
    found = tuple(names)
    if not found:
        raise SignalError(f"no {what} are named: give one or more")
    if twice := [name for k, name in enumerate(found) if name in found[:k]]:
        raise SignalError(f"'{twice[0]}' stands twice among the {what}: name it once")
    return found


def whole(what: str, value: int) -> int:
    """Return a whole number; raise SignalError, calling it `what`, where it is none."""
    try:
        return operator.index(value)
    except TypeError as error:
        raise SignalError(f"the {what} is {value}: give a whole number") from error


def check_level(level: float) -> None:
    """Raise SignalError for a confidence level that is no probability between 0 and 1."""
    if not isinstance(level, float | int | np.number) or not 0 < level < 1:
        raise SignalError(f"the confidence level is {level}: give a probability between 0 and 1, like 0.95")


def check_samples(y: Array, outputs: Sequence[str]) -> None:
    """Raise SignalError for outputs (N, p) that are not finite or too large or small to be squared."""
    for row, j in np.argwhere(~np.isfinite(y)):
        raise SignalError(f"row {row} of '{outputs[j]}' is {y[row, j]}: leave the row out")
    check_sizes("the output", y, outputs)


def check_sizes(what: str, columns: Array, names: Sequence[str]) -> None:
    """Raise SignalError for columns (N, k), calling them `what` and a name, too large or small to be squared."""
    for name, size in zip(names, np.abs(columns).max(axis=0, initial=0.0), strict=True):
        if size and not SIZES[0] <= size <= SIZES[1]:
            raise SignalError(f"{what} '{name}' has the size {size:.3g}: choose units in which it is nearer to 1")
