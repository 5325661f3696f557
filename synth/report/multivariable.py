"""Plots of loops with several channels: singular values of L, S and T, and disk margins, over frequency in Hz.

L is the open loop with negative feedback, S = (1 + L)^-1 and T = L (1 + L)^-1; see Skogestad and Postlethwaite,
chapter 3, and MATLAB `sigma`.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from synth.analyse.loops.disk import DiskMargin
from synth.report import charts
from synth.report.charts import Chart, Line
from synth.report.figures import COLOURS
from synth.statespace import Array, StateSpace, readonly
from synth.timing import period

# Limits of the axes; the upper one rises with the peak of S and T.
DECIBELS = {"L": (-60.0, 60.0), "S": (-40.0, 15.0), "T": (-40.0, 15.0)}
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
    for letter, (low, high) in DECIBELS.items():
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
    return charts.draw(panels, 3.8)


def disks(margins: Mapping[str, DiskMargin]) -> Figure:
    """Draw the disk margins of each loop-breaking point; different widths keep coincident curves visible."""
    lines = []
    for (label, each), colour, width in zip(margins.items(), COLOURS, (3.0, 1.2, 1.2), strict=False):
        inside = (each.frequencies > MIN_FREQUENCY) & np.isfinite(each.frequencies)
        style = {"color": colour, "lw": width}
        lines.append(Line(each.frequencies[inside] / (2 * np.pi), each.curve[inside], label, style))
    options = {"ylim": (0.0, 2.5)}
    return charts.draw([Chart(lines, HERTZ, "disk margin α", log="x", legend="lower left", options=options)], 2.8)
