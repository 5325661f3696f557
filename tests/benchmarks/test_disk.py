"""The benchmark compares margins of one loop, and its table has a line for each size."""

import pytest

from benchmarks import disk


def test_the_compared_margins_are_of_one_loop(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(disk, "TURNS", 1)
    comparison = disk.compare(2, 10)
    assert (
        comparison.certified
        and comparison.lower <= comparison.upper <= comparison.control_margin <= 1.1 * comparison.upper
    )
    assert (
        min(
            comparison.control_ms,
            comparison.certified_ms,
            comparison.grid_ms,
            comparison.faster,
            comparison.faster_grid,
        )
        > 0
    )


def test_the_table_has_a_line_for_each_size(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(disk, "TURNS", 1)
    monkeypatch.setattr(disk, "SIZES", ((1, 4), (2, 6)))
    title, *lines = disk.table()
    assert [line.split()[:2] for line in lines] == [["1", "4"], ["2", "6"]] and title.startswith("channels")
