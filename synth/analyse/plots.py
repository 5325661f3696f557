"""Signals over time, and what all plots share: their style, and the phase of a loop as a continuous curve.

`over_time` returns a `matplotlib.figure.Figure` of its own: the state of `pyplot` is neither read nor changed, a
notebook shows the figure, and `figure.savefig("run.png")` writes it. matplotlib is imported when a figure is drawn.
"""

from collections.abc import Mapping
from contextlib import AbstractContextManager
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from synth import arguments, show
from synth.errors import SignalError
from synth.statespace import Array, Complex

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
else:
    Axes = Figure = Any  # annotations are read at the first call, which shall not load matplotlib

COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00")  # distinguishable with any colour vision
LINE_COLOUR = "#666666"
STYLE = {
    "font.size": 9.0,
    "font.family": "sans-serif",
    "font.sans-serif": ["DejaVu Sans", "Verdana", "Arial"],
    "axes.grid": True,
    "axes.edgecolor": LINE_COLOUR,
    "axes.linewidth": 0.6,
    "axes.labelsize": 9.0,
    "axes.titlesize": 9.5,
    "axes.xmargin": 0.0,
    "grid.color": "#dddddd",
    "grid.linewidth": 0.5,
    "lines.linewidth": 1.1,
    "xtick.color": "#333333",
    "ytick.color": "#333333",
    "legend.fontsize": 8.0,
    "legend.framealpha": 0.85,
    "legend.edgecolor": "#cccccc",
    "svg.fonttype": "none",
}
MOST_PANELS = 12
WIDTH = 9.0  # inches


def style_context() -> AbstractContextManager[None]:
    """Return the context in which every figure is made and written, whatever the user's own settings."""
    import matplotlib.style

    return matplotlib.style.context(["default", STYLE])


@arguments.checked
def over_time(time: ArrayLike, signals: Mapping[str, ArrayLike], units: Mapping[str, str]) -> Figure:
    """Return signals (N,) over `time` (N,) in s, one panel each; `units` names their units where they are known.

    Raises SignalError for no signal or more than 12 of them, and for values that are not (N,) real numbers.
    """
    if not 1 <= len(signals) <= MOST_PANELS:
        raise SignalError(f"there are {len(signals)} signals to plot: name 1 to {MOST_PANELS} of them")
    t = arguments.real("times", time)
    columns = {name: arguments.real(f"values of {name}", values) for name, values in signals.items()}
    for what, values in {"time": t, **columns}.items():
        if values.ndim != 1 or values.shape != t.shape:
            raise SignalError(f"'{what}' has shape {values.shape}: give one value for each of {t.size} times")
    with style_context():
        figure, panels = _panels(len(signals), 0.7 + 1.4 * len(signals))
        for axes, (name, values) in zip(np.atleast_1d(panels), columns.items(), strict=True):
            axes.plot(t, values, color=COLOURS[0])
            axes.set_ylabel(show.with_unit(name, units.get(name, "")))
            _use_plain_numbers(axes)
        axes.set_xlabel("time [s]")
        figure.align_ylabels()
    return figure


def unwrapped_phase(w: Array, L: Complex, crossing: float) -> Array:
    """Return the phase of L (N,) in degrees over w (N,), in (-360, 0] at a `crossing` rad/s.

    It is continuous but for poles and zeros on the axis: a step near 180 degrees is a pole, which lowers the phase, so
    steps lie within -225 .. 135 degrees.
    """
    angle = np.angle(L)
    steps = (np.diff(angle) + 1.25 * np.pi) % (2 * np.pi) - 1.25 * np.pi
    degrees = np.degrees(angle[0] + np.concatenate([[0.0], np.cumsum(steps)]))
    phase_at_crossing = np.interp(crossing, w, degrees)
    return np.asarray(degrees - 360 * np.ceil(phase_at_crossing / 360), dtype=np.float64)


def _panels(rows: int, height: float) -> tuple[Figure, Any]:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(WIDTH, height), layout="constrained")
    return figure, figure.subplots(rows, sharex=True)


def _use_plain_numbers(axes: Axes) -> None:
    """Show the values themselves on the axis, with a common power of ten where they are small or large, no offset."""
    axes.ticklabel_format(axis="y", style="sci", scilimits=(-3, 4), useOffset=False)
