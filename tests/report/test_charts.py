"""Charts show each curve with its label, its levels and its scale."""

import numpy as np
import pytest

from synth.report import maps
from synth.report.figures import COLOURS
from synth.report.maps import Chart, Line

X = np.linspace(1.0, 100.0, 50)


def test_curves_levels_and_scales_are_drawn() -> None:
    lines = [Line(X, X**2, "square"), Line(X, X, style={"color": "#123456", "ls": "--"})]
    (axes,) = maps.draw([Chart(lines, "x, 1", "y, 1", "(a)", levels=[10.0], log="xy")], 2.5).axes
    curves = axes.get_lines()
    assert [c.get_color() for c in curves] == [COLOURS[0], "#123456", "#666666"]
    np.testing.assert_array_equal(curves[0].get_ydata(), X**2)
    assert (axes.get_xscale(), axes.get_yscale()) == ("log", "log") and axes.get_title(loc="left") == "(a)"
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("x, 1", "y, 1")
    assert [t.get_text() for t in axes.get_legend().get_texts()] == ["square"]


@pytest.mark.parametrize(("legend", "inside", "whole"), [("upper left", 2, 0), ("", 0, 0), ("figure", 0, 1)])
def test_a_legend_is_where_it_is_asked_for(legend: str, inside: int, whole: int) -> None:
    chart = Chart([Line(X, X, "line")], "x", legend=legend, options={"ylim": (0.0, 5.0)})
    drawn = maps.draw([chart, chart], 2.5, (1, 2))
    assert sum(axes.get_legend() is not None for axes in drawn.axes) == inside and len(drawn.legends) == whole
    assert all(axes.get_ylim() == (0.0, 5.0) for axes in drawn.axes)
