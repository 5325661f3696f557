"""Memory of loops in lanes: what a run records, and the columns of each lane by name."""

import mmap
import threading
import weakref
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

LARGE, ALIGNMENT = 2**21, 64  # bytes: of a large page, and of a vector
KEPT = 2**28  # bytes of memory that no array needs and the next loop may use
Name = tuple[str, str]  # the group of a column, as in `Trajectory`, and its name


@dataclass(frozen=True)
class Recording:
    """The columns that a run keeps, None for all, at every `every`-th sample.

    A column that is read and was not kept costs one more run of its loops, which keeps all. `read` collects what is
    read: the right choice for the next run of the same experiment.
    """

    columns: frozenset[Name] | None = None
    every: int = 1
    read: set[Name] = field(default_factory=set, compare=False)

    def choose(self, names: Sequence[Name]) -> list[int]:
        """Return the positions of the names that are kept."""
        return [k for k, name in enumerate(names) if self.columns is None or name in self.columns]


class Record:
    """What a run kept: the column (lanes, frames) of each name. `complete` runs the loops again and keeps all."""

    def __init__(self, columns: Mapping[Name, NDArray[Any]], complete: Callable[[], "Record"]) -> None:
        self._columns, self._complete, self._lock = dict(columns), complete, threading.Lock()

    def column(self, name: Name) -> NDArray[Any]:
        """Return the column (lanes, frames)."""
        with self._lock:
            if name not in self._columns:
                self._columns |= self._complete()._columns
        return self._columns[name]

    def lane(self, group: str, names: Iterable[str], lane: int, read: set[Name]) -> "LaneColumns":
        """Return the columns of a group in one lane; the set `read` collects the names that are read."""
        return LaneColumns(names, partial(self._of_lane, group, lane, read))

    def _of_lane(self, group: str, lane: int, read: set[Name], name: str) -> NDArray[Any]:
        read.add((group, name))
        column = self.column((group, name))[lane]
        column.flags.writeable = False
        return column


class LaneColumns(Mapping[str, NDArray[Any]]):
    """Columns (frames,) by name, each from a function of its name."""

    def __init__(self, names: Iterable[str], column: Callable[[str], NDArray[Any]]) -> None:
        self._names, self._column = dict.fromkeys(names), column

    def __getitem__(self, name: str) -> NDArray[Any]:
        if name not in self._names:
            raise KeyError(name)
        return self._column(name)

    def __contains__(self, name: object) -> bool:
        return name in self._names

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)


class _Pages:
    """Memory in large pages that loops have used and no array needs any more: the next loop need not clear it again."""

    def __init__(self) -> None:
        self._free: list[mmap.mmap] = []
        self._lock = threading.Lock()

    def take(self, n: int) -> mmap.mmap:
        """Return at least n bytes with any content."""
        size = -(-n // LARGE) * LARGE
        with self._lock:
            for k, pages in enumerate(self._free):
                if len(pages) == size:
                    return self._free.pop(k)
        pages = mmap.mmap(-1, size, flags=mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS)
        pages.madvise(mmap.MADV_HUGEPAGE)
        return pages

    def give(self, pages: mmap.mmap) -> None:
        """Keep memory for the next loop, unless there is KEPT already."""
        with self._lock:
            if sum(map(len, self._free)) + len(pages) <= KEPT:
                self._free.append(pages)


_PAGES = _Pages()


def empty(shape: tuple[int, ...], scalar: type[np.generic]) -> NDArray[Any]:
    """Return an array with any content at an address that vectors need, in large pages: for what a run records."""
    items = int(np.prod(shape))
    n = max(1, items) * np.dtype(scalar).itemsize
    if n <= LARGE or not hasattr(mmap, "MADV_HUGEPAGE"):
        memory = np.empty(n + ALIGNMENT, np.uint8)
        first = -memory.ctypes.data % ALIGNMENT
        return memory[first : first + n].view(scalar)[:items].reshape(shape)
    pages = _PAGES.take(n)
    array = np.frombuffer(pages, scalar, items)  # every view of it keeps it alive
    weakref.finalize(array, _PAGES.give, pages).atexit = False
    return array.reshape(shape)


def zeros(shape: tuple[int, ...], scalar: type[np.generic]) -> NDArray[Any]:
    """Return zeros as `empty` places them."""
    array = empty(shape, scalar)
    array[...] = 0
    return array


def repeat(values: Sequence[Any], lanes: int, scalar: type[np.generic]) -> NDArray[Any]:
    """Return the values in every lane (values, lanes)."""
    return align(np.repeat(np.array(values, scalar).reshape(-1, 1), lanes, axis=1))


def align(values: NDArray[Any]) -> NDArray[Any]:
    """Return a copy at an address that vectors need."""
    copy = empty(values.shape, values.dtype.type)
    copy[...] = values
    return copy
