"""Sixty-four axes emit, compile without a warning and compute what CasADi does; the C grows with the axes alone."""

import numpy as np
import pytest

from benchmarks import axes
from synth.emit.write import EmittedCode


@pytest.fixture(scope="module")
def grown() -> axes.Growth:
    return axes.measure_growth(64)


@pytest.mark.whole
def test_sixty_four_axes_compute_what_casadi_does(grown: axes.Growth) -> None:
    # A few roundings in double, of sums of terms up to 1000 times the result.
    assert grown.axes == 64 and grown.worst <= 1e-12


def test_the_c_grows_with_the_axes_alone(grown: axes.Growth) -> None:
    """What all axes share, functions and the guard of the first one, is spread over four times as many."""
    text = axes.emit(16, np.float32).files["axes_16.c"]
    assert 0.70 <= grown.size / 64 / (len(text) / 16) <= 1.05
    assert 0.70 <= grown.lines / 64 / (text.count("\n") / 16) <= 1.05


def test_a_planted_difference_is_found() -> None:
    made, double = axes.block(4), axes.emit(4, np.float64)
    text = double.files["axes_4.c"]
    wrong = text.replace("&state->filter_3, guard_ready, e3)", "&state->filter_3, guard_ready, e3 * (1.0 + 1e-9))")
    assert wrong != text
    planted = EmittedCode(double.files | {"axes_4.c": wrong}, double.manifest)
    assert axes.disagreement(made, double) <= 1e-12 < 1e-10 < axes.disagreement(made, planted)


def test_the_table_has_a_line_for_each_count(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(axes, "COUNTS", (1, 2))
    title, *lines = axes.table()
    assert [line.split()[0] for line in lines] == ["1", "2"] and title.startswith("axes")
