"""Logs with holes are refused by row and signal."""

import numpy as np
import pytest

from synth.errors import SignalError, TimingError
from synth.synthesise.identify.logs import Log


def test_columns_come_by_name() -> None:
    log = Log({"a": [1, 2, 3], "b": [4.0, 5.0, 6.0]}, 1e-3, times=[0.0, 0.001, 0.002])
    np.testing.assert_array_equal(log.columns(("b", "a")), [[4, 1], [5, 2], [6, 3]])
    assert len(log) == 3 and log.period() == 1e-3
    with pytest.raises(SignalError, match="no signal 'c': it has a, b"):
        log.columns(("c",))
    with pytest.raises(TimingError, match="no sample period"):
        Log({"a": [1.0]}).period()


def test_rows_that_are_not_one_period_apart_are_named() -> None:
    times = np.arange(6) * 1e-3
    times[4:] += 1e-3
    with pytest.raises(TimingError, match=r"0\.002 s pass between rows 3 and 4 .* period is 0\.001 s: split the log"):
        Log({"a": np.zeros(6)}, 1e-3, times)
    Log({"a": np.zeros(6)}, 1e-3, np.arange(6) * 1e-3 + 1e-6 * (-1.0) ** np.arange(6))
    with pytest.raises(SignalError, match="2 times and 3 rows"):
        Log({"a": np.zeros(3)}, 1e-3, [0.0, 1e-3])
    with pytest.raises(TimingError, match="period is 0"):
        Log({"a": np.zeros(3)}, 0.0)


def test_a_clock_that_drifts_is_caught() -> None:
    """Each gap is 0.9 % too long: within the jitter of one row, not of a log."""
    with pytest.raises(TimingError, match=r"0\.1009 s apart on average, .* period is 0\.1 s: give period_s = 0\.1009"):
        Log({"a": np.zeros(300)}, 0.1, np.arange(300) * 0.1009)
    Log({"a": np.zeros(300)}, 0.1, 1.7e9 + np.arange(300) * 0.1 * (1 + 2e-5))
    with pytest.raises(TimingError, match="the sample period is 'x'"):
        Log({"a": np.zeros(3)}, "x")


def test_a_log_prints_what_it_holds_and_not_its_samples() -> None:
    text = str(Log({"gap": np.linspace(0, 3, 100_000)}, 1e-3))
    assert "Log of 100000 rows, 0.001 s apart" in text and len(text) < 300
    assert text.splitlines()[-1].split() == ["gap", "0", "1.5", "3", "0.86603"]
