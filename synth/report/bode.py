"""Bode plots of scalar open loops L with their crossings, and of the sensitivity S = 1/(1 + L); MATLAB `margin`.

gain      20 log10 |L|
phase     arg L, unwrapped: a pole on the axis reduces it by 180 degrees; in (-360, 0] at the highest gain crossing
|S|       20 log10 |S|; the maximum of |S| is Ms, the inverse of the modulus margin

Plots of loops with several channels: singular values of L, S and T, and disk margins, over frequency in Hz.

L is the open loop with negative feedback, S = (1 + L)^-1 and T = L (1 + L)^-1; see Skogestad and Postlethwaite,
chapter 3, and MATLAB `sigma`.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, MultipleLocator, NullFormatter
from numpy.typing import ArrayLike

from synth.analyse import plots
from synth.analyse.loops import stability_margins
from synth.analyse.loops.disk import DiskMargin
from synth.analyse.loops.stability_margins import Margins
from synth.errors import SignalError
from synth.report import maps
from synth.report.figures import COLOURS, place_axes, style_context
from synth.report.maps import Chart, Line
from synth.statespace import Array, Complex, StateSpace, readonly
from synth.timing import Discrete, period

# Limits of the axes; the upper one rises with the peak of S and T.
GAIN_DECIBELS = {"L": (-60.0, 60.0), "S": (-40.0, 15.0), "T": (-40.0, 15.0)}
LINES = ("-", "--", ":")
HERTZ = "frequency, Hz"
MIN_FREQUENCY = 1.0  # rad/s, lower limit of the disk margins


@dataclass(frozen=True, eq=False)
class Singular:
    """Singular values (N, p) of L, S and T, descending, at frequencies (N,) in rad/s."""

    frequency: Array
    L: Array
    S: Array
    T: Array


def singular(L: StateSpace, frequency: ArrayLike) -> Singular:
    """Return the singular values of a sampled loop L and of its S and T."""
    w = readonly(np.asarray(frequency, dtype=np.float64))
    response = L.response(np.exp(1j * w * period(L.time)))
    one = np.eye(response.shape[1])
    S = np.linalg.inv(one + response)
    return Singular(w, *(readonly(np.linalg.svd(m, compute_uv=False)) for m in (response, S, one - S)))


def singular_values(loops: Mapping[str, Singular]) -> Figure:
    """Draw the singular values of L, S and T, one colour per loop."""
    panels = []
    for letter, (low, high) in GAIN_DECIBELS.items():
        levels = {label: 20 * np.log10(getattr(each, letter)) for label, each in loops.items()}
        highest = max(float(level.max()) for level in levels.values())
        lines = [
            Line(loops[label].frequency / (2 * np.pi), column, "" if k else label, {"color": colour, "ls": style})
            for (label, level), colour, style in zip(levels.items(), COLOURS, LINES, strict=False)
            for k, column in enumerate(level.T)
        ]
        limits = {"ylim": (low, high if letter == "L" else max(high, 5 * np.ceil(highest / 5)))}
        title = f"singular values of {letter}, dB"
        panels.append(Chart(lines, HERTZ, "", title, (0.0,), log="x", legend="figure", options=limits))
    return maps.draw(panels, 3.8)


def disks(margins: Mapping[str, DiskMargin]) -> Figure:
    """Draw the disk margins of each loop-breaking point; different widths keep coincident curves visible."""
    lines = []
    for (label, each), colour, width in zip(margins.items(), COLOURS, (3.0, 1.2, 1.2), strict=False):
        inside = (each.frequencies > MIN_FREQUENCY) & np.isfinite(each.frequencies)
        style = {"color": colour, "lw": width}
        lines.append(Line(each.frequencies[inside] / (2 * np.pi), each.curve[inside], label, style))
    options = {"ylim": (0.0, 2.5)}
    return maps.draw([Chart(lines, HERTZ, "disk margin α", log="x", legend="lower left", options=options)], 2.8)


DECIBELS = (-60.0, 80.0)  # limits of the axis; the poles of an internal model are infinitely high
LOWEST_PHASE = -540.0  # degrees
MAX_WIDTH, MIN_WIDTH = 2.6, 0.7  # points; different widths keep coincident curves visible
MAX_LOOPS = len(COLOURS)  # loops in one plot
NYQUIST = 0.98  # upper limit, of pi/T: at pi/T L is real and its phase jumps


@dataclass(frozen=True, eq=False)
class LoopCurve:
    """An open loop: frequencies (N,) in rad/s, ascending, the response L (N,), and its margins."""

    label: str
    frequency: Array
    response: Complex
    margins: Margins


def curve(
    label: str, loop: StateSpace, loop_margins: Margins, low: float = 0.5, high: float = 1e4, points: int = 350
) -> LoopCurve:
    """Return the response of a scalar loop, with its margins, from `low` to `high` rad/s, at most NYQUIST pi/T.

    It begins below the crossings and the maximum of |S|, where these lie below `low`.

    Raises SignalError when the loop is not scalar.
    """
    top = min(high, NYQUIST * np.pi / loop.time.period_s) if isinstance(loop.time, Discrete) else high
    marks = [f for f in _marks(loop_margins) if 0 < f < top]
    bottom = min([low, *(f / 2 for f in marks)])
    w = np.unique([*np.geomspace(bottom, top, points), *marks])
    return LoopCurve(label, w, stability_margins.response(loop)(w), loop_margins)


def _marks(margins: Margins) -> tuple[float, ...]:
    """Return the frequencies in rad/s that decide the margins: of the crossings and of Ms."""
    gains, phases = ([c.frequency for c in each] for each in (margins.gain_crossings, margins.phase_crossings))
    return (*gains, *phases, margins.peak_frequency)


def phase(curve: LoopCurve) -> Array:
    """Return the phase of L in degrees (N,), continuous except at poles and zeros on the axis."""
    crossings = [c.frequency for c in curve.margins.gain_crossings]
    return plots.unwrapped_phase(curve.frequency, curve.response, max(crossings, default=curve.frequency[-1]))


def bode_plot(curves: Sequence[LoopCurve]) -> Figure:
    """Draw gain, phase and sensitivity over frequency in Hz, one colour per loop, for at most six loops.

    A dot marks each gain crossing, a diamond each phase crossing, a square Ms. The axis of the phase encloses the
    phase at these and at all lower frequencies; the legend names the loops whose closed loop is unstable.

    Raises SignalError when there are none or more than six.
    """
    if not 1 <= len(curves) <= MAX_LOOPS:
        raise SignalError(f"Bode plot has {len(curves)} loops: give 1 to {MAX_LOOPS}, more cannot be distinguished")
    widths = np.linspace(MAX_WIDTH, MIN_WIDTH, max(len(curves), 3)).tolist()
    with style_context():
        figure = Figure(figsize=(9.0, 6.2))
        gain, angle, sensitivity = figure.subplots(3, 1, sharex=True, height_ratios=(3, 3, 2))
        place_axes(figure, 3, 1)
        for c, colour, width in zip(curves, COLOURS, widths, strict=False):
            _draw(gain, angle, sensitivity, c, {"color": colour, "linewidth": width})
        _decibels(gain, "|L|, dB", DECIBELS, 20)
        _decibels(sensitivity, "|S|, dB", (-40.0, max(10.0, *(float(_S(c).max()) + 2 for c in curves))), 20)
        _degrees(angle, curves)
        gain.legend(loc="upper right")
        sensitivity.set_xscale("log")
        sensitivity.set_xlabel("frequency, Hz")
        sensitivity.xaxis.set_major_formatter(FuncFormatter(lambda v, _: f"{v:g}"))
        sensitivity.xaxis.set_minor_formatter(NullFormatter())
        figure.align_ylabels()
    return figure


def _draw(gain: Axes, angle: Axes, sensitivity: Axes, curve: LoopCurve, style: dict[str, Any]) -> None:
    f, level, degrees = curve.frequency / (2 * np.pi), _db(curve.response), phase(curve)
    gain.plot(f, level, label=curve.label if curve.margins.stable else f"{curve.label}, unstable", **style)
    angle.plot(f, degrees, **style)
    sensitivity.plot(f, _S(curve), **style)
    marker_style = {"ls": "", "ms": 4.5, "mfc": "white", "mec": style["color"], "zorder": 5}
    gains = [c.frequency for c in curve.margins.gain_crossings]
    phases = [c.frequency for c in curve.margins.phase_crossings]
    for marked, marker in ((gains, "o"), (phases, "D"), ([curve.margins.peak_frequency], "s")):
        at = np.array([w for w in marked if curve.frequency[0] <= w <= curve.frequency[-1]]) / (2 * np.pi)
        for axes, values in ((gain, level), (angle, degrees), (sensitivity, _S(curve))):
            axes.plot(at, np.interp(at, f, values), marker=marker, **marker_style)


def _db(response: Complex) -> Array:
    return np.asarray(20 * np.log10(np.maximum(np.abs(response), 1e-300)), dtype=np.float64)


def _S(curve: LoopCurve) -> Array:
    return -_db(1 + curve.response)


def _decibels(axes: Axes, label: str, limits: tuple[float, float], step: float) -> None:
    axes.set(ylabel=label, ylim=limits)
    axes.axhline(0.0, color="#666666", lw=0.8)
    axes.yaxis.set_major_locator(MultipleLocator(step))


def _degrees(axes: Axes, curves: Sequence[LoopCurve]) -> None:
    """Limit the phase to LOWEST_PHASE where no mark lies below: a delay reduces it without end."""
    marked = [np.interp(w, c.frequency, phase(c)) for c in curves for w in _marks(c.margins) if w <= c.frequency[-1]]
    low = max(min(float(phase(c).min()) for c in curves), min([LOWEST_PHASE, *marked]))
    high = max(float(phase(c).max()) for c in curves)
    bottom, top = 90 * np.floor(low / 90) - 10, 90 * np.ceil(high / 90) + 10
    axes.set(ylabel="arg L, °", ylim=(bottom, top))
    for turn in range(int(bottom // 360), int(top // 360) + 1):
        axes.axhline(360.0 * turn + 180, color="#666666", lw=0.8)
    axes.yaxis.set_major_locator(MultipleLocator(90 if high - low < 540 else 180))
