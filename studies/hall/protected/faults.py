"""Faults of sensors in an ensemble of bodies, in the first voltage of a sensor or in both, which fail together.

    y_faulty(k) = g(y(k), kept, k)    k samples since the failure

What is stuck shows the voltages of another place, what is frozen the last ones before it failed: `kept` is either.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from synth.errors import ModelError

Values = NDArray[Any]
# Of (N, voltages) now, (N, voltages) kept, samples since the failure; a fault of one voltage is one of the first.
Fault = Callable[[Values, Values, int | Values], Values]

OFFSET, DRIFT, END = 0.3, 0.02, 5.0  # V, V a sample, V


def _of_first(value: Callable[[Values, Values, int | Values], Values | float]) -> Fault:
    def fault(y: Values, kept: Values, k: int | Values) -> Values:
        failed = y.copy()
        failed[:, 0] = value(y[:, 0], kept[:, 0], k)
        return failed

    return fault


FAULTS: dict[str, Fault] = {
    "none": lambda y, kept, k: y,
    "dead voltage": _of_first(lambda y, kept, k: 0.0),
    "dead sensor": lambda y, kept, k: 0 * y,
    "stuck voltage": _of_first(lambda y, kept, k: kept),
    "stuck sensor": lambda y, kept, k: kept,
    "saturated": _of_first(lambda y, kept, k: END),
    "offset": _of_first(lambda y, kept, k: y + OFFSET),
    "halved voltage": _of_first(lambda y, kept, k: y / 2),
    "halved sensor": lambda y, kept, k: y / 2,
    "drift": _of_first(lambda y, kept, k: y + DRIFT * k),
    "frozen voltage": _of_first(lambda y, kept, k: kept),
    "frozen sensor": lambda y, kept, k: kept,
}
LASTING = tuple(f for f in FAULTS if not f.startswith("frozen"))  # faults that there may be from init on


@dataclass(frozen=True, eq=False)
class Failure:
    """A fault of a sensor of each body (N,), or of its `voltage`; `kept` (N, voltages) are voltages of the sensor."""

    fault: Fault
    sensor: NDArray[np.int_]
    voltage: NDArray[np.int_]
    kept: Values

    def of_sensor(self, y: Values) -> Values:
        """Return the voltages (N, voltages) of the failing sensors, of those of all (N, sensors, voltages)."""
        return np.asarray(y[np.arange(len(y)), self.sensor])

    def corrupt(self, y: Values, since: int) -> None:
        """Overwrite voltages (N, sensors, voltages) of a sample, so many samples since the failure."""
        order = (self.voltage[:, None] + np.arange(y.shape[2])) % y.shape[2]
        now, kept = (np.take_along_axis(v, order, axis=1) for v in (self.of_sensor(y), self.kept))
        failed = np.empty_like(now)
        np.put_along_axis(failed, order, self.fault(now, kept, since), axis=1)
        y[np.arange(len(y)), self.sensor] = failed


def find(fault: str) -> Fault:
    """Return the fault of a name; raise ModelError for an unknown one."""
    if fault not in FAULTS:
        raise ModelError(f"'{fault}' is not a known fault: give one of {', '.join(FAULTS)}")
    return FAULTS[fault]
