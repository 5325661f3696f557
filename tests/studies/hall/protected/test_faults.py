"""Each fault changes the voltages that it names, of the body's own sensor, and no other."""

import numpy as np
import pytest

from studies.hall.protected.faults import DRIFT, END, FAULTS, OFFSET, Failure

N, SENSORS, VOLTAGES = 6, 3, 2
RNG = np.random.default_rng(0)
Y, KEPT = RNG.standard_normal((N, SENSORS, VOLTAGES)), RNG.standard_normal((N, VOLTAGES))
SENSOR, VOLTAGE = np.arange(N) % SENSORS, np.arange(N) % VOLTAGES


def corrupted(name: str, since: int = 4) -> np.ndarray:
    y = Y.copy()
    Failure(FAULTS[name], SENSOR, VOLTAGE, KEPT).corrupt(y, since)
    return y


@pytest.mark.parametrize("name", FAULTS)
def test_only_the_failing_voltages_change(name: str) -> None:
    changed = corrupted(name) != Y
    others = np.ones_like(changed)
    others[np.arange(N), SENSOR] = False
    assert not changed[others].any()
    count = 0 if name == "none" else VOLTAGES if "sensor" in name else 1
    assert (changed.sum(axis=(1, 2)) == count).all()
    if count == 1:
        assert changed[np.arange(N), SENSOR, VOLTAGE].all()


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("dead voltage", 0 * Y),
        ("saturated", 0 * Y + END),
        ("offset", Y + OFFSET),
        ("drift", Y + 4 * DRIFT),
        ("halved sensor", Y / 2),
        ("stuck voltage", np.broadcast_to(KEPT[:, None], Y.shape)),
        ("frozen sensor", np.broadcast_to(KEPT[:, None], Y.shape)),
    ],
)
def test_the_values_are_those_of_the_fault(name: str, expected: np.ndarray) -> None:
    each = np.arange(N), SENSOR, VOLTAGE
    assert (corrupted(name)[each] == expected[each]).all()
