"""Files of measurements: what is read, and the line of what is refused."""

from pathlib import Path

import numpy as np
import pytest

from synth.errors import DesignError, SignalError
from synth.synthesise.identify import logs

WANTED = {"X": "m", "V_ax": "V"}
GOOD = "# scan of May\nX [mm], turn[deg], V_ax [mV]\n\n12.7, 180, -3.5e0\r\n+.5,0,7\n"


def test_units_become_si_to_the_last_bit() -> None:
    log = logs.parse(GOOD, WANTED)
    assert log.samples["X"].tolist() == [0.0127, 0.0005]
    assert log.samples["V_ax"].tolist() == [-0.0035, 0.007]
    assert log.samples["turn"].tolist() == [np.pi, 0.0]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "line 1: there is no column 'X': add 'X [m]'"),
        ("X [mm], V_ax [V]\n", "line 1: no row of numbers"),
        ("X, V_ax [V]\n1, 2\n", "line 1: 'X' is not a column: give a name and its unit, like X [mm]"),
        ("1.0, 2.0\n3.0, 4.0\n", "line 1: '1.0' is not a column"),
        ("X [mm]; V_ax [V]\n1; 2\n", "line 1: 'X [mm]; V_ax [V]' is not a column"),
        ("X [inch], V_ax [V]\n1, 2\n", "line 1: 'X' has the unit 'inch', which is not one of m, "),
        ("X [V], V_ax [V]\n1, 2\n", "line 1: 'X' is in V: give it in m or a multiple"),
        ("X [m], X [mm], V_ax [V]\n1, 2, 3\n", "line 1: the column 'X' is listed twice"),
        ("X [m]\n1\n", "line 1: there is no column 'V_ax': add 'V_ax [V]'"),
        ("X [m], V_ax [V]\n1, 2\n3\n", "line 3: 1 values for 2 columns"),
        ("X [m], V_ax [V]\n1, 2,\n", "line 2: 3 values for 2 columns"),
        ("# a\n\nX [m], V_ax [V]\n1, 2\n\n# b\n1, two\n", "line 7: V_ax is 'two'"),
        ("X [m], V_ax [V]\n1, \n", "line 2: V_ax is ''"),
        ("X [m], V_ax [V]\n1, nan\n", "line 2: V_ax is 'nan'"),
        ("X [m], V_ax [V]\n1, inf\n", "line 2: V_ax is 'inf'"),
        ("X [m], V_ax [V]\n1_0, 2\n", "line 2: X is '1_0'"),
        ("X [m], V_ax [V]\n1, 2 V\n", "line 2: V_ax is '2 V'"),
        ("X [m], V_ax [V]\n1, ١\n", "line 2: V_ax is '١'"),
        ("X [m], V_ax [V]\n1e999, 2\n", "line 2: X is 1e999 m"),
        ('X [m], V_ax [V]\n"1, 2\n', "line 2: unexpected end of data"),
        ("X [m], V_ax [V]\n1,5, 2,5\n", "line 2: 4 values for 2 columns"),
    ],
)
def test_what_is_malformed_is_refused_with_its_line(text: str, message: str) -> None:
    with pytest.raises(SignalError) as refused:
        logs.parse(text, WANTED, "scan.csv")
    assert f"scan.csv, {message}" in str(refused.value)


def test_files(tmp_path: Path) -> None:
    file = tmp_path / "scan.csv"
    with pytest.raises(DesignError, match=r"scan\.csv cannot be read: No such file"):
        logs.read(file, WANTED)
    with pytest.raises(DesignError, match="cannot be read"):
        logs.read(tmp_path, WANTED)
    file.write_bytes(GOOD.encode("utf-8-sig"))
    assert len(logs.read(file, WANTED)) == len(logs.read(str(file), WANTED)) == 2
    file.write_bytes(b"X [m], V_ax [V]\n1, 2\n\xff\xfe, 3\n")
    with pytest.raises(SignalError, match=r"scan\.csv, line 3: a byte is not UTF-8"):
        logs.read(file, WANTED)
