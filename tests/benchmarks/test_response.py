"""The benchmark compares what both packages compute, and its table has a line for each model."""

import numpy as np
import pytest

from benchmarks import response


@pytest.fixture(autouse=True)
def one_turn(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(response, "TURNS", 1)
    monkeypatch.setattr(response, "SIZES", (4, 12))
    monkeypatch.setattr(response, "POINTS", 30)
    monkeypatch.setattr(response, "MASSES", (2,))


def test_the_table_has_a_line_for_each_model() -> None:
    title, *lines = response.responses()
    assert [line.split()[:2] for line in lines] == [[k, n] for n in ("4", "12") for k in ("dense", "flexible")]
    assert title.startswith("model")


def test_memory_is_measured() -> None:
    comparison = response.compare("dense", response.dense(12))
    assert 0 < comparison.memory_MB < 200


def test_both_packages_compute_the_same_of_a_chain() -> None:
    calls = response.pairs(3)
    theirs, ours = calls["response"][0](), calls["response"][1]()
    np.testing.assert_allclose(ours, np.transpose(theirs, (2, 0, 1)), rtol=0, atol=1e-9)
    norm, peak = calls["H-infinity norm"][0](), calls["H-infinity norm"][1]()
    assert peak.certified and peak.level == pytest.approx(norm[0], rel=1e-5)
    gain, phase = calls["margins"][0]()[:2]
    margins = calls["margins"][1]()
    assert margins.stable and margins.gain_margin == pytest.approx(gain, rel=1e-6)
    assert margins.phase_margin == pytest.approx(phase, rel=1e-6)
    X, ours_X = calls["Riccati"][0](), calls["Riccati"][1]().X
    np.testing.assert_allclose(ours_X, X, rtol=0, atol=1e-10 * np.abs(X).max())


def test_the_table_of_growth_has_a_line_for_each_quantity() -> None:
    title, *lines = response.growth()
    assert title.startswith("states") and len(lines) == len(response.pairs(2)) and lines[0].split()[0] == "8"
