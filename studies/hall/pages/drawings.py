"""Drawings of sensor layouts for the report."""

from collections.abc import Mapping, Sequence

from matplotlib.figure import Figure

from models.hall_array import Pair
from synth.report import maps
from synth.report.figures import COLOURS
from synth.report.maps import Chart, Line

GREY = {"color": "#bbbbbb", "lw": 0.7}
SQUARE, SIDES = ([-0.5, 0.5, 0.5, -0.5, -0.5], [-0.5, -0.5, 0.5, 0.5, -0.5]), (-0.72, 0.72)  # pitches


def layouts(shown: Mapping[str, Sequence[Pair]]) -> Figure:
    """Draw layouts in the body's plane, in pitches, each sensor as its letter, with the square of one pitch."""
    lines = [Line(x, y, style=GREY) for x, y in (SQUARE, (SIDES, (0.0, 0.0)), ((0.0, 0.0), SIDES))]
    letters = [{"marker": f"${letter}$", "ms": 8.0, "color": COLOURS[0]} for letter in "ABCDEFGH"]
    panels = []
    for title, places in shown.items():
        sensors = [Line([x], [y], style=style) for (x, y), style in zip(places, letters, strict=False)]
        options = {"xlim": SIDES, "ylim": SIDES, "aspect": "equal"}
        panels.append(Chart([*lines, *sensors], "x, pitches", "y, pitches", title, legend="", options=options))
    return maps.draw(panels, 2.6)
