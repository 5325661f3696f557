"""Memory of loops in lanes: a row for each signal, a column for each lane, and the columns of one lane by name."""

import mmap
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

LARGE = 2**21  # bytes: of a large page


class LaneColumns(Mapping[str, NDArray[Any]]):
    """The columns (N,) of one lane by name; each is gathered from memory when it is first read."""

    def __init__(self, names: Sequence[str], rows: NDArray[Any]) -> None:
        self._names, self._rows, self._read = tuple(names), rows, dict[str, NDArray[Any]]()

    def __getitem__(self, name: str) -> NDArray[Any]:
        if name not in self._read:
            if name not in self._names:
                raise KeyError(name)
            column = np.ascontiguousarray(self._rows[:, self._names.index(name)])
            column.flags.writeable = False
            self._read[name] = column
        return self._read[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)


def zeros(shape: tuple[int, ...], scalar: type[np.generic]) -> NDArray[Any]:
    """Return zeros at an address that vectors need, in large pages: a record is written once, page after page."""
    n = max(1, int(np.prod(shape)) * np.dtype(scalar).itemsize)
    memory = mmap.mmap(-1, n)  # page-aligned
    if n > LARGE and hasattr(memory, "madvise"):
        memory.madvise(mmap.MADV_HUGEPAGE)
    return np.frombuffer(memory, scalar, int(np.prod(shape))).reshape(shape)


def repeat(values: Sequence[Any], lanes: int, scalar: type[np.generic]) -> NDArray[Any]:
    """Return the values in every lane (values, lanes)."""
    return align(np.repeat(np.array(values, scalar).reshape(-1, 1), lanes, axis=1))


def align(values: NDArray[Any]) -> NDArray[Any]:
    copy = zeros(values.shape, values.dtype.type)
    copy[...] = values
    return copy
