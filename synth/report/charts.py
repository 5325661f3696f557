"""Charts as data: curves over any quantity, with their labels and scales, side by side in one figure."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from synth.report import figures, maps
from synth.report.figures import COLOURS

LEVEL = {"color": "#666666", "ls": "--", "lw": 0.9}


@dataclass(frozen=True, eq=False)
class Line:
    """A curve (n,) in the displayed units; `style` is that of matplotlib, default a thin line in the next of COLOURS.

    A curve without a label is not in the legend.
    """

    x: ArrayLike
    y: ArrayLike
    label: str = ""
    style: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class Chart:
    """Curves that share axes, and horizontal lines at `levels`.

    `log` names the axes with logarithmic scales, "x", "y" or both; `legend` is a location inside the axes, "above",
    "figure" for one legend above all charts, or ""; `options` are further arguments of `matplotlib.axes.Axes.set`.
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
    """Draw charts side by side, `height` in inches, of equal or relative `widths`."""
    with maps.panels(height, 1, len(charts), squeeze=False, width_ratios=widths) as (figure, grid):
        for axes, chart in zip(grid.flat, charts, strict=True):
            _draw(axes, chart)
        if charts[0].legend == "figure":
            labelled = grid[0, 0].get_legend_handles_labels()
            figure.legend(*labelled, loc="outside upper right", ncols=len(labelled[0]), frameon=False)
    return figure


def _draw(axes: Any, chart: Chart) -> None:
    for k, line in enumerate(chart.lines):
        style = {"color": COLOURS[k % len(COLOURS)], "lw": 0.9, **line.style}
        axes.plot(np.asarray(line.x), np.asarray(line.y), label=line.label or None, **style)
    for level in chart.levels:
        axes.axhline(level, **LEVEL)
    for axis in chart.log:
        axes.set(**{f"{axis}scale": "log"})
    maps.signs(axes)
    if "y" in chart.log:
        maps.plain_log(axes)
    axes.set(xlabel=chart.xlabel, ylabel=chart.ylabel, **chart.options)
    axes.set_title(chart.title, loc="left" if chart.legend == "above" else "center")
    if chart.legend == "above":
        figures.above(axes)
    elif chart.legend and chart.legend != "figure":
        axes.legend(loc=chart.legend)
