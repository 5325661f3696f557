"""Faults of a sensor, as a function of its voltages: of the first one, or of both, which fail together.

What is stuck shows the voltages of another place, what is frozen the last ones before it failed.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from models.hall_motions import Numbers
from synth.errors import ModelError

OFFSET, DRIFT, END = 0.3, 0.02, 5.0  # V, V a sample, V
Fault = Callable[[Numbers, Numbers, int | Numbers], Numbers]  # (N, 2) now, (N, 2) kept from the failure, samples since


def _first(value: Callable[[Numbers, Numbers, int | Numbers], Numbers | float]) -> Fault:
    return lambda V, kept, k: np.column_stack([np.broadcast_to(value(V[:, 0], kept[:, 0], k), len(V)), V[:, 1]])


FAULTS: Mapping[str, Fault] = {
    "none": lambda V, kept, k: V,
    "dead voltage": _first(lambda v, kept, k: 0.0),
    "dead sensor": lambda V, kept, k: 0 * V,
    "stuck voltage": _first(lambda v, kept, k: kept),
    "stuck sensor": lambda V, kept, k: kept,
    "saturated": _first(lambda v, kept, k: END),
    "offset": _first(lambda v, kept, k: v + OFFSET),
    "halved voltage": _first(lambda v, kept, k: v / 2),
    "halved sensor": lambda V, kept, k: V / 2,
    "drift": _first(lambda v, kept, k: v + DRIFT * k),
    "frozen voltage": _first(lambda v, kept, k: kept),
    "frozen sensor": lambda V, kept, k: kept,
}
FROZEN = ("frozen voltage", "frozen sensor")
LASTING = tuple(f for f in FAULTS if f not in FROZEN)  # faults that there may be from the first sample on


@dataclass(frozen=True, eq=False)
class Failure:
    """A fault of a sensor of each body (N,): of its second voltage where `second`; `kept` (N, 2) are other voltages."""

    fault: str
    sensor: NDArray[np.int_]
    second: NDArray[np.bool_]
    kept: Numbers

    def corrupt(self, V: Numbers, since: int) -> None:
        """Overwrite voltages (N, sensors, 2) of a sample, so many samples since the failure."""
        each, second = np.arange(len(V)), self.second[:, None]
        pair, kept = (np.where(second, v[:, ::-1], v) for v in (V[each, self.sensor], self.kept))
        failed = FAULTS[self.fault](pair, kept, since)
        V[each, self.sensor] = np.where(second, failed[:, ::-1], failed)


def check(fault: str) -> str:
    """Return the name of a fault; raise ModelError for an unknown one."""
    if fault not in FAULTS:
        raise ModelError(f"'{fault}' is not a known fault: give one of {', '.join(FAULTS)}")
    return fault
