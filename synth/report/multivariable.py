"""Plots of loops with several channels: singular values of L, S and T, and disk margins, over frequency in Hz.

L is the loop from where it is opened to where it comes back, 1 + L is closed, S = 1 / (1 + L) and T = L / (1 + L); see
Skogestad and Postlethwaite, chapter 3, and MATLAB `sigma`.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, NullFormatter
from numpy.typing import ArrayLike

from synth.analyse.disk import DiskMargin
from synth.report import maps
from synth.report.figures import COLOURS
from synth.statespace import Array, StateSpace, readonly
from synth.timing import period

DECIBELS = {"L": (-60.0, 60.0), "S": (-40.0, 15.0), "T": (-40.0, 15.0)}  # at least up to the highest of S and T
LINES = ("-", "--", ":")
LOWEST = 1.0  # rad/s, of disk margins


@dataclass(frozen=True, eq=False)
class Singular:
    """Singular values (N, p), falling, of L, S and T at frequencies (N,) in rad/s."""

    frequency: Array
    L: Array
    S: Array
    T: Array


def singular(L: StateSpace, frequency: ArrayLike) -> Singular:
    """Return the singular values of a sampled loop, of its S and of its T."""
    w = readonly(np.asarray(frequency, dtype=np.float64))
    response = L.response(np.exp(1j * w * period(L.time)))
    one = np.eye(response.shape[1])
    S = np.linalg.inv(one + response)
    return Singular(w, *(readonly(np.linalg.svd(m, compute_uv=False)) for m in (response, S, one - S)))


def singular_values(loops: Mapping[str, Singular]) -> Figure:
    """Draw the singular values of L, S and T, one colour a loop."""
    with maps.panels(3.8, 1, 3, sharex=True) as (figure, grid):
        for axes, letter in zip(grid, DECIBELS, strict=True):
            for (label, each), colour, line in zip(loops.items(), COLOURS, LINES, strict=False):
                level = 20 * np.log10(getattr(each, letter))
                lines = axes.plot(each.frequency / (2 * np.pi), level, color=colour, ls=line, lw=1.2)
                lines[0].set_label(label)
            axes.axhline(0.0, color="#666666", lw=0.8)
            low, high = DECIBELS[letter]
            highest = 20 * np.log10(max(float(getattr(each, letter).max()) for each in loops.values()))
            axes.set(ylim=(low, high if letter == "L" else max(high, 5 * np.ceil(highest / 5))))
            axes.set(title=f"singular values of {letter}, dB")
            _hertz(axes)
        labelled = grid[0].get_legend_handles_labels()
        figure.legend(*labelled, loc="outside upper right", ncols=len(loops), frameon=False)
    return figure


def disks(margins: Mapping[str, DiskMargin]) -> Figure:
    """Draw disk margins by where the loop is opened, those that coincide under each other."""
    with maps.panels(2.8) as (figure, axes):
        for (label, each), colour, width in zip(margins.items(), COLOURS, (3.0, 1.2, 1.2), strict=False):
            inside = (each.frequencies > LOWEST) & np.isfinite(each.frequencies)
            axes.plot(each.frequencies[inside] / (2 * np.pi), each.curve[inside], color=colour, lw=width, label=label)
        axes.set(ylabel="disk margin α", ylim=(0.0, 2.5))
        axes.legend(loc="lower left")
        _hertz(axes)
    return figure


def _hertz(axes: Axes) -> None:
    axes.set_xscale("log")
    axes.set_xlabel("frequency, Hz")
    axes.xaxis.set_major_formatter(FuncFormatter(lambda v, _: f"{v:g}"))
    axes.xaxis.set_minor_formatter(NullFormatter())
