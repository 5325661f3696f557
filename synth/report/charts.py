"""Charts as data: curves over any quantity, with their labels and scales, side by side in one figure."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from synth.report import figures, maps
from synth.report.figures import COLOURS

LEVEL = {"color": "#666666", "ls": "--", "lw": 0.9}  # style of the horizontal lines of a Chart


@dataclass(frozen=True, eq=False)
class Line:
    """A curve (n,) in the displayed units. Without a label it is not in the legend.

    `style` holds keyword arguments of `matplotlib.axes.Axes.plot`. The default is a thin line in the next of COLOURS.
    """

    x: ArrayLike
    y: ArrayLike
    label: str = ""
    style: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class Chart:
    """Curves that share axes, and horizontal lines at `levels`.

    `log` names the axes with logarithmic scales: "", "x", "y" or "xy". `legend` is "above" the axes, a location in the
    axes as for matplotlib, or "" for none. "figure" in the first chart puts a legend of its curves above all charts.
    `options` are further arguments of `matplotlib.axes.Axes.set`.
    """

    lines: Sequence[Line]
    xlabel: str
    ylabel: str = ""
    title: str = ""
    levels: Sequence[float] = ()
    log: str = ""
    legend: str = "above"
    options: Mapping[str, Any] = field(default_factory=dict)


def draw(charts: Sequence[Chart], height: float, widths: Sequence[float] | None = None) -> Figure:
    """Draw charts side by side, `height` in inches; `widths` are relative, by default equal."""
    with maps.panels(height, 1, len(charts), squeeze=False, width_ratios=widths) as (figure, grid):
        for axes, chart in zip(grid.flat, charts, strict=True):
            _draw(axes, chart)
        if charts[0].legend == "figure":
            handles, labels = grid[0, 0].get_legend_handles_labels()
            figure.legend(handles, labels, loc="outside upper right", ncols=len(labels), frameon=False)
    return figure


def _draw(axes: Any, chart: Chart) -> None:
    for k, line in enumerate(chart.lines):
        style = {"color": COLOURS[k % len(COLOURS)], "lw": 0.9, **line.style}
        axes.plot(np.asarray(line.x), np.asarray(line.y), label=line.label or None, **style)
    for level in chart.levels:
        axes.axhline(level, **LEVEL)
    for axis in chart.log:
        axes.set(**{f"{axis}scale": "log"})
    maps.use_minus_signs(axes)
    if "y" in chart.log:
        maps.plain_log(axes)
    axes.set(xlabel=chart.xlabel, ylabel=chart.ylabel, **chart.options)
    axes.set_title(chart.title, loc="left" if chart.legend == "above" else "center")
    if chart.legend == "above":
        figures.put_legend_above(axes)
    elif chart.legend and chart.legend != "figure":
        axes.legend(loc=chart.legend)
