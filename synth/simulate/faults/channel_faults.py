"""Faults of a channel, or of all channels of a group, in an ensemble of bodies: what integrity monitoring must notice.

    y_faulty(k) = g(y(k), kept, k)    k samples since the failure, kept: what a converter goes on showing

A group are channels that fail together, such as the two of a sensor head. What is stuck shows the values of another
place, what is frozen the last ones before it failed: `GroupFailure.kept` holds either.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Values = NDArray[Any]
# Of (N, channels) now, (N, channels) kept, samples since the failure; a fault of one channel is one of the first.
Fault = Callable[[Values, Values, int | Values], Values]


def faults(
    offset: float, drift: float, end: float, channel: str = "channel", group: str = "group"
) -> Mapping[str, Fault]:
    """Return the faults by name: `offset`, `drift` a sample, and the `end` of the range in the channels' unit.

    `channel` and `group` are the words for these in the names.
    """
    return {
        "none": lambda y, kept, k: y,
        f"dead {channel}": _of_first(lambda y, kept, k: 0.0),
        f"dead {group}": lambda y, kept, k: 0 * y,
        f"stuck {channel}": _of_first(lambda y, kept, k: kept),
        f"stuck {group}": lambda y, kept, k: kept,
        "saturated": _of_first(lambda y, kept, k: end),
        "offset": _of_first(lambda y, kept, k: y + offset),
        f"halved {channel}": _of_first(lambda y, kept, k: y / 2),
        f"halved {group}": lambda y, kept, k: y / 2,
        "drift": _of_first(lambda y, kept, k: y + drift * k),
        f"frozen {channel}": _of_first(lambda y, kept, k: kept),
        f"frozen {group}": lambda y, kept, k: kept,
    }


def is_frozen(name: str) -> bool:
    """Return whether a fault keeps the last values, not those of another place."""
    return name.startswith("frozen")


def _of_first(value: Callable[[Values, Values, int | Values], Values | float]) -> Fault:
    def fault(y: Values, kept: Values, k: int | Values) -> Values:
        failed = y.copy()
        failed[:, 0] = value(y[:, 0], kept[:, 0], k)
        return failed

    return fault


@dataclass(frozen=True, eq=False)
class GroupFailure:
    """A fault of a group of each body (N,), or of its `channel`; `kept` (N, channels) are values of the group."""

    fault: Fault
    group: NDArray[np.int_]
    channel: NDArray[np.int_]
    kept: Values

    def of_group(self, y: Values) -> Values:
        """Return the values (N, channels) of the failing groups, of those of all (N, groups, channels)."""
        return np.asarray(y[np.arange(len(y)), self.group])

    def corrupt(self, y: Values, since: int) -> None:
        """Overwrite values (N, groups, channels) of a sample, so many samples since the failure."""
        order = (self.channel[:, None] + np.arange(y.shape[2])) % y.shape[2]
        now, kept = (np.take_along_axis(v, order, axis=1) for v in (self.of_group(y), self.kept))
        failed = np.empty_like(now)
        np.put_along_axis(failed, order, self.fault(now, kept, since), axis=1)
        y[np.arange(len(y)), self.group] = failed
