"""Colour maps of values on a grid over X and Y, with one common scale or one symmetric scale each.

Positions are in the displayed unit, mm unless the labels state another.

Charts as data: curves over any quantity, with their labels and scales, side by side in one figure.
"""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LogNorm, Normalize
from matplotlib.figure import Figure
from matplotlib.image import AxesImage
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter
from numpy.typing import ArrayLike, NDArray

from synth.report import figures
from synth.report.figures import COLOURS
from synth.statespace import Array

SIGNED, PLAIN = "RdBu_r", "viridis"
PLANE = ("X, mm", "Y, mm")
Side = tuple[float, float]
TICK_LABELS = FuncFormatter(lambda v, _: f"{v:.4g}".replace("-", "−"))  # with typographic minus signs


@dataclass(frozen=True, eq=False)
class Map:
    """Values (n, n) over X (first index) and Y; marks (m, 2) are positions."""

    title: str
    values: Array | NDArray[np.bool_]
    marks: Array | None = None


@contextmanager
def panels(height: float, *shape: int, **options: Any) -> Iterator[tuple[Figure, Any]]:
    """Yield a figure of page width and given height in inches, and its axes from `Figure.subplots`."""
    with figures.style_context():
        figure = Figure(figsize=(9.0, height), layout="constrained")
        yield figure, figure.subplots(*shape, **options)


def maps(
    shown: Sequence[Map],
    sides: Sequence[Side],
    scale: tuple[float, float],
    columns: int = 3,
    log: bool = True,
    label: str = "",
    labels: tuple[str, str] = PLANE,
) -> Figure:
    """Draw maps with axis ranges `sides` and a common colour scale; values beyond it have the colour of its end."""
    norm: Normalize = LogNorm(*scale) if log else Normalize(*scale)
    rows = -(-len(shown) // columns)
    with panels(3.0 * rows, rows, columns, sharex=True, sharey=True, squeeze=False) as (figure, grid):
        for axes, each in zip(grid.flat, shown, strict=False):
            _draw_map(axes, each, sides, labels, cmap=PLAIN, norm=norm)
        for axes in grid.flat[len(shown) :]:
            axes.set_visible(False)
        for axes in grid.flat:
            axes.label_outer()
        bar = figure.colorbar(ScalarMappable(norm, PLAIN), ax=grid, shrink=0.85, extend="both", label=label)
        if log:
            plain_log(bar.ax)
    return figure


def signed_maps(shown: Sequence[Map], sides: Sequence[Side], labels: tuple[str, str] = PLANE) -> Figure:
    """Draw maps with axis ranges `sides`, each with its own colour scale, symmetric about 0."""
    with panels(2.9, 1, len(shown)) as (figure, grid):
        for axes, each in zip(np.atleast_1d(grid), shown, strict=True):
            high = float(np.nanmax(np.abs(each.values))) or 1.0
            image = _draw_map(axes, each, sides, labels, cmap=SIGNED, norm=Normalize(-high, high))
            figure.colorbar(image, ax=axes, shrink=0.8, format=TICK_LABELS)
    return figure


def _draw_map(axes: Axes, each: Map, sides: Sequence[Side], labels: tuple[str, str], **colours: Any) -> AxesImage:
    image = axes.imshow(each.values.T, origin="lower", extent=(*sides[0], *sides[1]), aspect="equal", **colours)
    axes.set(title=each.title, xlabel=labels[0], ylabel=labels[1])
    axes.grid(visible=False)
    use_minus_signs(axes)
    if each.marks is not None and len(each.marks):
        axes.plot(*each.marks.T, "o", ms=2.6, mfc="none", mec="#ffffff", mew=0.7)
        axes.set(xlim=sides[0], ylim=sides[1])
    return image


def plain_log(axes: Axes) -> None:
    """Label a logarithmic axis by plain numbers, at 1, 2 and 5 of each decade."""
    axes.yaxis.set_major_locator(LogLocator(10, (1.0, 2.0, 5.0)))
    axes.yaxis.set_major_formatter(TICK_LABELS)
    axes.yaxis.set_minor_formatter(NullFormatter())


def use_minus_signs(axes: Axes) -> None:
    """Use typographic minus signs on both axes."""
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_formatter(TICK_LABELS)


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
    with panels(height, 1, len(charts), squeeze=False, width_ratios=widths) as (figure, grid):
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
    use_minus_signs(axes)
    if "y" in chart.log:
        plain_log(axes)
    axes.set(xlabel=chart.xlabel, ylabel=chart.ylabel, **chart.options)
    axes.set_title(chart.title, loc="left" if chart.legend == "above" else "center")
    if chart.legend == "above":
        figures.put_legend_above(axes)
    elif chart.legend and chart.legend != "figure":
        axes.legend(loc=chart.legend)
