"""Faults inside the loop: against a recursion by hand, and without effect where nothing is changed."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from synth.errors import SignalError
from synth.execute.host import Controller
from synth.plant import Plant
from synth.simulate import closed_loop
from synth.simulate.closed_loop import Scenario
from synth.simulate.scenario import InputFault

T, N = 1e-3, 300
K = np.arange(N)
Level = Callable[[str], Controller]
BASE = Scenario(
    duration_s=0.3,
    x0={"q": 0.021, "v": 0.01},
    sensors={"gap": "gap"},
    actuators={"i": "current"},
    references={"gap_ref": 0.02},
    forcing={"j": 0.0, "i": 0.25},
    velocities={"q": "v", "s": "w"},
    hold={"current": 1.5},
)


def recursion(lags: np.ndarray, gain: np.ndarray, bias: np.ndarray, missed: np.ndarray) -> np.ndarray:
    """The free mass of 2 kg under the regulator with one sample of delay, exactly discretised: rows (q, v, command)."""
    A, B = np.array([[1, T], [0, 1]]), np.array([T**2 / 2, T]) / -2.0
    x, last, command, waiting, readings, rows = np.array([0.021, 0.01]), 0.02, 0.0, 1.5, [], []
    for k in range(len(lags)):
        readings.append(x[0])
        seen, applied = readings[k - lags[k]], gain[k] * waiting + bias[k] + 0.25
        if not missed[k]:
            command, last = 2.0 + 400.0 * (seen - 0.02) + 6.0 * (seen - last) / T, seen
        waiting = command
        rows.append([*x, command])
        x = A @ x + B * applied
    return np.array(rows)


@pytest.mark.parametrize(
    ("lags", "gain", "bias", "missed"),
    [
        (np.where(K >= 90, 1, 0), 1.0, 0.0, None),
        (np.where(K >= 90, K - 89, 0), 1.0, 0.0, None),
        (np.where(K >= 90, (K - 90) % 7, 0), 1.0, 0.0, None),
        (0, np.where(K >= 90, 0.7, 1.0), 0.0, None),
        (0, np.where((K >= 90) & (K < 100), 0.0, 1.0), np.where((K >= 90) & (K < 100), 2.5, 0.0), None),
        (0, 1.0, 0.0, (K >= 90) & (K < 97)),
        (np.where(K >= 90, 1, 0), np.where(K >= 50, 0.9, 1.0), 0.0, K % 11 == 5),
    ],
)
def test_each_fault_is_that_of_the_equations(
    mass: Plant, level: Level, lags: Any, gain: Any, bias: Any, missed: Any
) -> None:
    faults = {"lags": {"gap": lags}, "input_faults": {"i": InputFault(gain, bias)}, "missed": missed}
    run = closed_loop.simulate(mass, level("float64"), replace(BASE, **faults))
    columns = [np.broadcast_to(c, (N,)) for c in (lags, gain, bias, False if missed is None else missed)]
    expected = recursion(*columns)
    error = np.abs(np.column_stack([run["q"], run["v"], run["current"]]) - expected) / np.abs(expected).max(axis=0)
    assert float(error.max()) < 1e-11
    healthy = recursion(0 * K, 1.0 + 0 * K, 0.0 * K, K < 0)
    assert float(np.max(np.abs(expected - healthy) / np.abs(healthy).max(axis=0))) > 1e-3


def test_tables_without_a_fault_change_no_bit(mass: Plant, level: Level) -> None:
    nothing = {"lags": {"gap": 0}, "input_faults": {"i": InputFault(1.0, 0.0)}, "missed": K < 0}
    healthy = closed_loop.simulate(mass, level("float32"), BASE)
    run = closed_loop.simulate(mass, level("float32"), replace(BASE, **nothing))
    assert all(np.array_equal(run[n], healthy[n]) for n in ("q", "v", "current", "gap", "i"))


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"lags": {"gas": 1}}, "lags: 'gas' is not one of gap"),
        ({"lags": {"gap": 1}}, "from 0 to the number of the sample"),
        ({"lags": {"gap": np.zeros(3)}}, "give one finite number, or 300"),
        ({"input_faults": {"j": InputFault(0.0, 0.0)}}, "input_faults: 'j' is not one of i"),
        ({"input_faults": {"i": InputFault(np.nan, 0.0)}}, "gain of 'i'"),
        ({"missed": np.zeros(3, bool)}, "missed is bool"),
    ],
)
def test_a_wrong_table_is_refused(mass: Plant, level: Level, fields: dict[str, Any], message: str) -> None:
    with pytest.raises(SignalError, match=message):
        closed_loop.simulate(mass, level("float64"), replace(BASE, **fields))
