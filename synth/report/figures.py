"""Plots of sampled signals v_k over time t_k as deterministic SVG: equal arrays give equal bytes.

    decimation    the minimum and the maximum of each of N/2 equal intervals are drawn, which preserves every spike
    error         |v - r| on a logarithmic axis; it ends a factor of 1000 below the level, if there is a level

Values are in SI units; positions are shown in mm and mrad, errors in um and urad. The global state of matplotlib is
neither read nor changed; `svg` converts each figure to text.
"""

import io
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator
from numpy.typing import ArrayLike, NDArray

from synth.analyse.plots import COLOURS, style_context
from synth.errors import SignalError
from synth.simulate.experiments import Experiment
from synth.statespace import Array

Window = tuple[float, float]

REFERENCE_COLOUR = "#000000"
POINTS = 1000  # for each curve: more than the 900 pixels of a figure's width
LEFT, RIGHT, TOP, BOTTOM = 0.75, 0.12, 0.3, 0.45  # inches around the axes of a figure
ROW_GAP, COLUMN_GAP = 0.2, 0.85  # inches between axes
DEPTH = 1e-3  # of an encoder's count: smaller errors are irrelevant
FLOOR = 1e-5  # of the largest error, if there is no level
ZERO_SUBSTITUTE = 1e-12  # m or rad: value at which a zero error is drawn
SYMBOLS = {"phi": "φ", "theta": "θ", "psi": "ψ"}
MILLI_UNITS = {"m": ("mm", 1e3), "rad": ("mrad", 1e3)}
MICRO_UNITS = {"m": ("µm", 1e6), "rad": ("µrad", 1e6)}
_NO_METADATA = {"Date": None, "Creator": None, "Format": None, "Type": None}


@dataclass(frozen=True, eq=False)
class Curve:
    """A labelled signal (N,) in the SI unit of its panel; a reference is drawn dashed and black."""

    label: str
    values: ArrayLike
    reference: bool = False


@dataclass(frozen=True, eq=False)
class Panel:
    """Curves that share an axis: the quantity, its SI unit, and horizontal lines `levels` (label, value)."""

    quantity: str
    unit: str
    curves: tuple[Curve, ...]
    levels: tuple[tuple[str, float], ...] = ()


def svg(figure: Figure, name: str) -> str:
    """Return a figure as one <svg> element; its ids begin with `name`, which keeps them unique on a page.

    Raises SignalError when `name` cannot begin an id.
    """
    if not re.fullmatch(r"[A-Za-z][A-Za-z0-9_-]*", name):
        raise SignalError(f"figure name '{name}' cannot begin an id: use letters, digits, '_' and '-'")
    text = io.StringIO()
    with style_context(), matplotlib.rc_context({"svg.hashsalt": name}):
        FigureCanvasSVG(figure).print_svg(text, metadata=_NO_METADATA)
    return _compact_svg(text.getvalue()[text.getvalue().index("<svg") :], name)


def _compact_svg(text: str, name: str) -> str:
    """Remove unused ids, prefix the others with `name`, and shorten the coordinates of paths."""
    used = set(re.findall(r"(?:url\(#|href=\"#)([^\")]+)", text))
    text = re.sub(r' id="([^"]*)"', lambda m: f' id="{name}-{m[1]}"' if m[1] in used else "", text)
    text = re.sub(r'(url\(#|href="#)', rf"\g<1>{name}-", text)
    text = re.sub(r' d="[^"]*"', lambda m: re.sub(r"(\.\d\d)\d+", r"\1", m[0]), text)
    return text.strip()


def decimate(values: ArrayLike, points: int = POINTS) -> NDArray[np.intp]:
    """Return at most `points` + 2 ascending indices of values (N,): the extremes of each interval and both ends."""
    v = np.asarray(values, dtype=np.float64)
    if len(v) <= points:
        return np.arange(len(v))
    edges = np.linspace(0, len(v), points // 2 + 1).astype(int)
    extremes = [a + f(v[a:b]) for a, b in pairwise(edges) for f in (np.argmin, np.argmax)]
    return np.unique([0, *extremes, len(v) - 1])


def time_plot(time: ArrayLike, panels: Sequence[Panel], window: Window | None = None) -> Figure:
    """Draw panels (positions, currents, ...) above each other over time in s."""
    with style_context():
        figure = Figure(figsize=(9.0, 0.7 + 1.75 * len(panels)))
        column = figure.subplots(len(panels), 1, sharex=True, squeeze=False)[:, 0]
        place_axes(figure, len(panels), 1)
        for axes, panel in zip(column, panels, strict=True):
            _plot_signals(axes, np.asarray(time, dtype=np.float64), panel, window)
            _legend(axes)
        _label_time(figure, column[-1:])
    return figure


def response(
    experiment: Experiment,
    units: Mapping[str, str],
    levels: Mapping[str, float] | None = None,
    window: Window | None = None,
) -> Figure:
    """Draw the signals of an experiment: on the left each signal and its set-point, on the right |error|.

    `units` gives the SI unit of each signal, `levels` a horizontal line in its error plot (an encoder's count, SI), and
    `window` the time range in s of the left side.

    Raises SignalError when a unit is missing.
    """
    time, missing = experiment.trajectory.time, [n for n in experiment.shown if n not in units]
    if missing or not experiment.shown:
        which = f"{', '.join(missing)} without a unit: give each an SI unit" if missing else "nothing: name a signal"
        raise SignalError(f"experiment '{experiment.name}' shows {which}")
    positions, errors = _panels(experiment, units, levels or {})
    if not any(e.curves for e in errors):
        return time_plot(time, positions, window)
    with style_context():
        figure = Figure(figsize=(9.0, 0.7 + 1.75 * len(positions)))
        grid = figure.subplots(len(positions), 2, sharex="col", squeeze=False)
        place_axes(figure, len(positions), 2)
        for (left, right), position, error in zip(grid, positions, errors, strict=True):
            _plot_signals(left, time, position, window)
            _plot_errors(right, time, error) if error.curves else right.set_visible(False)
        for axes in grid[0]:
            _legend(axes)
        _label_time(figure, (*grid[-1],))
    return figure


def _panels(
    experiment: Experiment, units: Mapping[str, str], levels: Mapping[str, float]
) -> tuple[list[Panel], list[Panel]]:
    positions, errors = [], []
    for name in experiment.shown:
        signal, unit = np.asarray(experiment.trajectory[name], dtype=np.float64), units[name]
        reference, symbol = experiment.references.get(name), SYMBOLS.get(name, name)
        curves = (Curve("true value", signal),) + (() if reference is None else (Curve("set-point", reference, True),))
        error = () if reference is None else (Curve("|true value − set-point|", signal - reference),)
        level = (("one count", levels[name]),) if name in levels else ()
        positions.append(Panel(symbol, unit, curves))
        errors.append(Panel(f"|error| of {symbol}", unit, error, level))
    return positions, errors


def path_3d(
    set_point: ArrayLike, path: ArrayLike, labels: tuple[str, str, str], unit: str = "m", points: int = 2 * POINTS
) -> Figure:
    """Draw a path (3, N) in space over the wide path (3, N) of its set-point; the third coordinate points up."""
    shown, factor = MILLI_UNITS.get(unit, (unit, 1.0))
    styles: tuple[dict[str, Any], ...] = ({"color": "#bbbbbb", "lw": 4.5}, {"color": COLOURS[0], "lw": 0.9})
    with style_context():
        figure = Figure(figsize=(6.0, 4.6))
        axes: Any = figure.add_axes((0.0, 0.03, 0.94, 0.97), projection="3d")
        for label, xyz, style in zip(("set-point", "true path"), (set_point, path), styles, strict=True):
            axes.plot(*(factor * _decimate_path(np.asarray(xyz, dtype=np.float64), points)), label=label, **style)
        axes.set(**dict(zip(("xlabel", "ylabel", "zlabel"), (f"{n}, {shown}" for n in labels), strict=True)))
        axes.legend(loc="upper left")
    return figure


def _decimate_path(path: Array, points: int) -> Array:
    """Return about `points` columns of a path (3, N), equidistant in time, and the extremes of each coordinate."""
    even = np.linspace(0, path.shape[1] - 1, points).astype(int)
    return path[:, np.unique([*even, *path.argmin(axis=1), *path.argmax(axis=1)])]


def _plot_signals(axes: Axes, time: Array, panel: Panel, window: Window | None) -> None:
    unit, factor = MILLI_UNITS.get(panel.unit, (panel.unit, 1.0))
    low, high = window or _span(time)
    inside = (time >= low) & (time <= high)
    for (k, curve), style in zip(enumerate(panel.curves), _styles(panel.curves), strict=True):
        _require_length(time, panel, curve)
        v = factor * np.asarray(curve.values, dtype=np.float64)[inside]
        at = decimate(v)
        axes.plot(time[inside][at], v[at], label=curve.label, zorder=3 + k, **style)
    for label, level in panel.levels:
        axes.axhline(factor * level, color="#666666", ls=":", lw=0.9, label=label)
    axes.set(ylabel=f"{panel.quantity}, {unit}", xlim=(low, high))


def _plot_errors(axes: Axes, time: Array, panel: Panel) -> None:
    unit, factor = MICRO_UNITS.get(panel.unit, (panel.unit, 1.0))
    sizes = [np.abs(_require_length(time, panel, c)) for c in panel.curves]
    greatest = max((float(np.nanmax(v)) for v in sizes if np.isfinite(v).any()), default=0.0)
    least = max(min((DEPTH * level for _, level in panel.levels), default=FLOOR * greatest), ZERO_SUBSTITUTE)
    for v, curve, style in zip(sizes, panel.curves, _styles(panel.curves), strict=True):
        at = decimate(v)
        axes.plot(time[at], factor * np.maximum(v[at], least), label=curve.label, **(style | {"linewidth": 0.6}))
    for label, level in panel.levels:
        axes.axhline(factor * level, color=COLOURS[1], ls=":", lw=1.2, zorder=5, label=label)
    axes.set_yscale("log")
    axes.set_ylim(factor * least, factor * max(2 * greatest, 10 * least))
    axes.yaxis.set_major_locator(LogLocator(10, numticks=7))
    axes.yaxis.set_major_formatter(FuncFormatter(lambda v, _: f"{v:g}"))
    axes.yaxis.set_minor_locator(NullLocator())
    axes.set(ylabel=f"{panel.quantity}, {unit}", xlim=_span(time))


def _span(time: Array) -> Window:
    """Return the time range including the period of the last sample: 60 s of samples end at 60 s."""
    return float(time[0]), float(2 * time[-1] - time[-2]) if len(time) > 1 else float(time[0]) + 1.0


def _require_length(time: Array, panel: Panel, curve: Curve) -> Array:
    v = np.asarray(curve.values, dtype=np.float64)
    if v.shape != time.shape:
        raise SignalError(f"'{curve.label}' of panel '{panel.quantity}' has {v.shape} values for {time.shape} times")
    return v


def _styles(curves: Iterable[Curve]) -> list[dict[str, Any]]:
    colours = iter(COLOURS * 4)
    reference = {"color": REFERENCE_COLOUR, "linestyle": "--", "linewidth": 0.9}
    return [reference if c.reference else {"color": next(colours)} for c in curves]


def _legend(axes: Axes) -> None:
    """Put a legend above the axes if there are two or more curves."""
    if len(axes.get_legend_handles_labels()[0]) > 1:
        put_legend_above(axes)


def place_axes(figure: Figure, rows: int, columns: int) -> None:
    """Place a grid of axes by margins in inches: a layout that measures every label takes longer than the drawing."""
    width, height = figure.get_size_inches()
    inner_width = (width - LEFT - RIGHT - (columns - 1) * COLUMN_GAP) / columns
    inner_height = (height - TOP - BOTTOM - (rows - 1) * ROW_GAP) / rows
    figure.subplots_adjust(
        LEFT / width,
        BOTTOM / height,
        1 - RIGHT / width,
        1 - TOP / height,
        COLUMN_GAP / inner_width,
        ROW_GAP / inner_height,
    )


def put_legend_above(axes: Axes) -> None:
    """Put the legend above the axes, where it hides no curve."""
    count = len(axes.get_legend_handles_labels()[0])
    axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=count, frameon=False, borderaxespad=0.1)


def _label_time(figure: Figure, lowest: Iterable[Axes]) -> None:
    for axes in lowest:
        axes.set_xlabel("time, s")
    figure.align_ylabels()
