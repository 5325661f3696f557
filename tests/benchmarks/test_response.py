"""The benchmark compares what both packages compute, and its table has a line for each model."""

import pytest

from benchmarks import response


@pytest.fixture(autouse=True)
def one_turn(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(response, "TURNS", 1)
    monkeypatch.setattr(response, "SIZES", (4, 12))
    monkeypatch.setattr(response, "POINTS", 30)


def test_the_table_has_a_line_for_each_model() -> None:
    title, *lines = response.responses()
    assert [line.split()[:2] for line in lines] == [[k, n] for n in ("4", "12") for k in ("dense", "flexible")]
    assert title.startswith("model")


def test_memory_is_measured() -> None:
    comparison = response.compare("dense", response.dense(12))
    assert 0 < comparison.memory_MB < 200
