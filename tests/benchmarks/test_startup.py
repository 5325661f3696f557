"""The benchmark of start-up times every process and relates them to the import of control."""

import pytest

from benchmarks import startup

pytestmark = pytest.mark.slow


def test_every_process_is_timed() -> None:
    rows = {row.name: row for row in startup.measure(turns=1)}
    assert list(rows) == list(startup.COMMANDS)
    assert all(row.wall_ms > 0 and row.processor_ms > 0 for row in rows.values())
    assert rows["import control"].of_control == 1.0


def test_a_process_that_fails_is_no_figure(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(startup.COMMANDS, "import synth", "import no_such_module")
    with pytest.raises(Exception, match="returned non-zero exit status 1"):
        startup.measure(turns=1)
