"""Bode plot with margins, step response and signals over time (MATLAB `margin`, `step`; `control.bode_plot`).

    gain     20 log10 |L|                         phase margin   arg L + 180 degrees where |L| = 1
    phase    arg L, unwrapped, in degrees         gain margin    1/|L| where arg L = -180 degrees

The phase lies in (-360, 0] at the highest gain crossing, and a pole on the axis lowers it by 180 degrees. Every
function returns a `matplotlib.figure.Figure` of its own: the state of `pyplot` is neither read nor changed, a notebook
shows the figure, and `figure.savefig("bode.png")` writes it. matplotlib is imported when a figure is drawn.
"""

from collections.abc import Mapping, Sequence
from contextlib import AbstractContextManager
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from synth import arguments, show
from synth.analyse import stability_margins as loop_margins
from synth.analyse import time_response, transfer
from synth.analyse.stability_margins import Margins
from synth.analyse.time_response import TimeResponse
from synth.analyse.transfer import Delayed, Loop
from synth.errors import SignalError
from synth.statespace import Array, Complex, StateSpace, System
from synth.timing import Discrete

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
MAX_DECIBELS = 80.0  # shown above and below 0 dB: an undamped pole is infinitely high
LOWEST_PHASE, HIGHEST_PHASE = -900.0, 360.0  # degrees: a delay lowers the phase without end
MOST_PANELS = 12
MOST_CHANNELS = 6  # rows, and columns, of step responses
WIDTH = 9.0  # inches


def style_context() -> AbstractContextManager[None]:
    """Return the context in which every figure is made and written, whatever the user's own settings."""
    import matplotlib.style

    return matplotlib.style.context(["default", STYLE])


@arguments.checked
def bode(loop: Loop, low: float | None = None, high: float | None = None, margins: Margins | None = None) -> Figure:
    """Return the Bode plot of a scalar loop between `low` and `high` rad/s, with its crossings and margins marked.

    A dot marks each gain crossing and a diamond each phase crossing; a thick line shows the least phase margin, and the
    gain margins up and down. By default the limits enclose all poles and crossings, and `margins` are computed.

    Raises SignalError and ModelError as `stability_margins.of_loop`.
    """
    transfer.check_limits(low, high)
    model = transfer.of_loop(loop)
    marked = margins or loop_margins.of_loop(loop)
    period = model.time.period_s if not isinstance(model, Delayed) and isinstance(model.time, Discrete) else None
    w, L = _response(model, marked, low, high)
    degrees = unwrapped_phase(w, L, max((c.frequency for c in marked.gain_crossings), default=w[-1]))
    with style_context():
        figure, (gain, phase) = _panels(2, height=5.4)
        _draw_gain(gain, w, L, marked)
        _draw_phase(phase, w, degrees, marked)
        _label_frequency((gain, phase), period)
        gain.set_title(_caption(marked), loc="left")
        figure.align_ylabels()
    return figure


@arguments.checked
def step(system: System | TimeResponse, duration_s: float | None = None, interval_s: float | None = None) -> Figure:
    """Return the step responses of a system, one panel for each output (down) and input (across).

    A dashed line is the final value. Instead of a system, a result of `time_response.step_response` or
    `impulse_response` may be given. Arguments and errors are those of `step_response`.

    Raises SignalError for more than 6 inputs or outputs.
    """
    response = (
        system if isinstance(system, TimeResponse) else time_response.step_response(system, duration_s, interval_s)
    )
    rows, columns = response.outputs.shape[1:]
    if not (1 <= rows <= MOST_CHANNELS and 1 <= columns <= MOST_CHANNELS):
        raise SignalError(
            f"the responses of {rows} outputs to {columns} inputs do not fit one figure: select 1 to {MOST_CHANNELS} "
            "of each, as by `model.select(outputs, inputs)`"
        )
    with style_context():
        figure, grid = _panels(rows, columns, height=max(3.0, 1.7 * rows + 0.8))
        for (i, j), axes in np.ndenumerate(np.reshape(grid, (rows, columns))):
            _draw_response(axes, response, i, j)
        figure.align_ylabels()
    return figure


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
        figure, panels = _panels(len(signals), height=0.7 + 1.4 * len(signals))
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


def _panels(rows: int, columns: int = 1, *, height: float) -> tuple[Figure, Any]:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(WIDTH, height), layout="constrained")
    return figure, figure.subplots(rows, columns, sharex=True)


def _response(
    model: StateSpace | Delayed, margins: Margins, low: float | None, high: float | None
) -> tuple[Array, Complex]:
    """Return frequencies (N,) in rad/s and L (N,), the crossings among them."""
    curve = transfer.trace(model, low, high)
    gains = [c.frequency for c in margins.gain_crossings]
    crossings = gains + [c.frequency for c in margins.phase_crossings]
    marks = np.array(
        [w for w in (*_natural_frequencies(model), *crossings, margins.peak_frequency) if curve.w[0] < w < curve.w[-1]]
    )
    bottom, top = (marks.min() / 10, marks.max() * 10) if marks.size else (curve.w[0], curve.w[-1])
    bottom, top = max(low or bottom, curve.w[0]), min(high or top, curve.w[-1])
    w = np.unique([bottom, *np.geomspace(bottom, top, 400), *curve.w, *(c for c in crossings if np.isfinite(c))])
    w = w[(w >= bottom) & (w <= top)]
    return w, curve.L(w)


def _natural_frequencies(loop: StateSpace | Delayed) -> Array:
    """Return the magnitudes of the poles in rad/s, of a sampled loop without those at z = 0."""
    model = loop.model if isinstance(loop, Delayed) else loop
    if isinstance(model.time, Discrete):
        return np.abs(np.log(model.poles[model.poles != 0])) / model.time.period_s
    return np.abs(model.poles)


def _decibels(values: ArrayLike) -> Array:
    return np.asarray(20 * np.log10(np.maximum(np.abs(values), 1e-300)), dtype=np.float64)


def _draw_gain(axes: Axes, w: Array, L: Complex, margins: Margins) -> None:
    """Draw 20 log10 |L|, its crossings, and the gain margins as lines from the curve to 0 dB."""
    from matplotlib.ticker import MultipleLocator

    level = _decibels(L)
    axes.axhline(0.0, color=LINE_COLOUR, lw=0.8)
    axes.plot(w / (2 * np.pi), level, color=COLOURS[0])
    _draw_crossings(axes, w, level, margins)
    for crossing in margins.phase_crossings:
        is_margin = crossing.gain_margin in (margins.gain_margin, margins.gain_reduction_margin)
        if is_margin and w[0] <= crossing.frequency <= w[-1]:
            f = crossing.frequency / (2 * np.pi)
            axes.plot([f, f], [-float(_decibels(crossing.gain_margin)), 0.0], color=COLOURS[1], lw=2.2)
    bottom, top = max(float(level.min()), -MAX_DECIBELS), min(float(level.max()), MAX_DECIBELS)
    axes.set(ylabel="|L| [dB]", ylim=(20 * np.floor(min(bottom, -1) / 20), 20 * np.ceil(max(top, 1) / 20)))
    axes.yaxis.set_major_locator(MultipleLocator(20))


def _draw_phase(axes: Axes, w: Array, degrees: Array, margins: Margins) -> None:
    """Draw arg L, its crossings, and the least phase margin as a line from the curve to an odd multiple of 180."""
    from matplotlib.ticker import MultipleLocator

    low, high = max(float(degrees.min()), LOWEST_PHASE), min(float(degrees.max()), HIGHEST_PHASE)
    bottom, top = 90 * np.floor(low / 90) - 10, 90 * np.ceil(high / 90) + 10
    for level in np.arange(-900.0, 361.0, 360.0):
        if bottom < level < top:
            axes.axhline(level, color=LINE_COLOUR, lw=0.8)
    axes.plot(w / (2 * np.pi), degrees, color=COLOURS[0])
    _draw_crossings(axes, w, degrees, margins)
    if margins.gain_crossings:
        worst = min(margins.gain_crossings, key=lambda c: abs(c.phase_margin))
        f, end = worst.frequency / (2 * np.pi), np.interp(worst.frequency, w, degrees)
        axes.plot([f, f], [float(end) - worst.phase_margin, float(end)], color=COLOURS[1], lw=2.2)
    axes.set(ylabel="arg L [°]", ylim=(bottom, top))
    axes.yaxis.set_major_locator(MultipleLocator(45 if high - low < 200 else 90 if high - low < 720 else 180))


def _draw_crossings(axes: Axes, w: Array, values: Array, margins: Margins) -> None:
    style: dict[str, Any] = {"ls": "", "ms": 4.5, "mfc": "white", "mec": COLOURS[0], "zorder": 5}
    gains = np.array([c.frequency for c in margins.gain_crossings])
    phases = np.array([c.frequency for c in margins.phase_crossings])
    for crossings, marker in ((gains, "o"), (phases, "D")):
        shown = crossings[(crossings >= w[0]) & (crossings <= w[-1])]
        axes.plot(shown / (2 * np.pi), np.interp(shown, w, values), marker=marker, **style)


def _label_frequency(column: Sequence[Axes], period_s: float | None) -> None:
    """Label the common axis in Hz, up to the Nyquist frequency of a sampled loop."""
    from matplotlib.ticker import FuncFormatter, NullFormatter

    last = column[-1]
    last.set_xscale("log")
    last.set_xlabel("frequency [Hz]")
    last.xaxis.set_major_formatter(FuncFormatter(lambda v, _: f"{v:g}"))
    last.xaxis.set_minor_formatter(NullFormatter())
    if period_s:
        last.set_xlabel(f"frequency [Hz], up to the Nyquist frequency {0.5 / period_s:g} Hz")


def _caption(margins: Margins) -> str:
    """Return the margins in one line."""
    if not margins.stable:
        return "closed loop NOT STABLE: the marks show how far it is from the stability limit"
    n = show.number
    parts = [f"phase margin {n(margins.phase_margin, 3)}°"] if margins.gain_crossings else []
    if np.isfinite(margins.gain_margin):
        parts.append(f"gain margin {n(margins.gain_margin, 3)} ({n(float(_decibels(margins.gain_margin)), 3)} dB)")
    if margins.gain_reduction_margin:
        parts.append(f"gain reduction margin {n(margins.gain_reduction_margin, 3)}")
    if np.isfinite(margins.delay_margin):
        parts.append(f"delay margin {n(1e3 * margins.delay_margin, 3)} ms")
    return ", ".join([*parts, f"modulus margin {n(margins.modulus_margin, 3)}"])


def _draw_response(axes: Axes, response: TimeResponse, i: int, j: int) -> None:
    """Draw the response of output i to input j, and its final value."""
    axes.plot(response.time, response.outputs[:, i, j], color=COLOURS[0])
    if response.final is not None:
        axes.axhline(float(response.final[i, j]), color=LINE_COLOUR, ls="--", lw=0.9)
    if i == 0:
        axes.set_title(f"{response.signal} at {show.with_unit(response.input_names[j], response.input_units[j])}")
    if j == 0:
        axes.set_ylabel(show.with_unit(response.output_names[i], response.output_units[i]))
    if i == response.outputs.shape[1] - 1:
        axes.set_xlabel("time [s]")
    _use_plain_numbers(axes)


def _use_plain_numbers(axes: Axes) -> None:
    """Show the values themselves on the axis, with a common power of ten where they are small or large, no offset."""
    axes.ticklabel_format(axis="y", style="sci", scilimits=(-3, 4), useOffset=False)
