"""Figures of the Hall position's report over starts and time: basins, cold starts, steps, the zigzag.

Values come in SI units and are shown in mm, ms and per cent.
"""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from synth.report import figures, maps
from synth.report.figures import COLOURS
from synth.report.maps import Map
from synth.statespace import Array


def basins(shown: Sequence[Map], wide: float) -> Figure:
    """Draw maps in per cent over starts that are off by up to `wide` pitches along X and Y."""
    with maps.panels(3.4, 1, len(shown), sharey=True) as (drawn, grid):
        for axes, each in zip(grid, shown, strict=True):
            image = axes.imshow(
                each.values.T, origin="lower", extent=(-wide, wide, -wide, wide), cmap=maps.PLAIN, vmin=0, vmax=100
            )
            axes.set(title=each.title, xlabel="off along X, pitches", aspect="equal")
            axes.grid(visible=False)
            maps.signs(axes)
        grid[0].set_ylabel("off along Y, pitches")
        drawn.colorbar(image, ax=grid, shrink=0.85, label="%")
    return drawn


def waits(found: Mapping[str, NDArray[np.int_]], most: int, period_s: float) -> Figure:
    """Draw the shares of starts that are valid by the time, of samples (n,) that each took, 0 for never."""
    with maps.panels(2.7) as (drawn, axes):
        for k, (label, took) in enumerate(found.items()):
            by = [100 * float(np.mean((took > 0) & (took <= n))) for n in range(1, most + 1)]
            time = 1e3 * period_s * np.arange(1, most + 1)
            axes.step(time, by, where="post", color=COLOURS[k // 2], ls=("-", "--")[k % 2], label=label)
        axes.set_xscale("log")
        axes.xaxis.set_major_formatter(maps.SIGNS)
        axes.set(xlabel="time since init, ms", ylabel="valid, %", ylim=(0.0, 103.0))
        maps.above(axes)
    return drawn


def steps(time: Array, curves: Mapping[str, Array], size: float) -> Figure:
    """Draw Fig. 11: x in m over time in s, whole and close to the end."""
    with maps.panels(2.9, 1, 2) as (drawn, (left, right)):
        for axes in (left, right):
            for (label, x), colour in zip(curves.items(), COLOURS, strict=False):
                keep = figures.decimate(x)
                axes.plot(time[keep], 1e3 * x[keep], color=colour, label=label, lw=0.9)
            axes.axhline(1e3 * size, color="#000000", ls="--", lw=0.9)
            axes.set(xlabel="time, s", xlim=(float(time[0]), float(time[-1])))
        ends = [1e3 * float(v) for x in curves.values() for v in (x[-200:].min(), x[-200:].max())]
        low, high = min(*ends, 1e3 * size), max(*ends, 1e3 * size)
        right.set_ylim(low - 0.3 * (high - low), high + 0.3 * (high - low))
        left.set_ylabel("x, mm")
        drawn.legend(*left.get_legend_handles_labels(), loc="outside upper right", ncols=len(curves), frameon=False)
    return drawn


def zigzags(time: Array, paths: Mapping[str, Sequence[Array]]) -> Figure:
    """Draw Fig. 10 of runs (x shown, y shown, x, y) in m by name: two paths of the first, the distances of all."""
    first = next(iter(paths.values()))
    with maps.panels(3.2, 1, 3, width_ratios=(1, 1, 1.5)) as (drawn, grid):
        for axes, title, (x, y) in zip(grid, ("(a) as shown", "(b) true"), (first[:2], first[2:]), strict=False):
            axes.plot(1e3 * x[::4], 1e3 * y[::4], color=COLOURS[0], lw=0.9)
            axes.set(title=title, xlabel="X, mm", ylabel="Y, mm", aspect="equal", xmargin=0.05)
            maps.signs(axes)
        for (label, (x_shown, y_shown, x, y)), colour in zip(paths.items(), COLOURS, strict=False):
            off = 1e3 * np.hypot(x - x_shown, y - y_shown)
            keep = figures.decimate(off)
            grid[2].plot(time[keep], off[keep], color=colour, lw=0.8, label=label)
        grid[2].set(title="(c)", xlabel="time, s", ylabel="distance of the two, mm", ylim=(0.0, None))
        grid[2].title.set_horizontalalignment("left")
        grid[2].title.set_x(0.0)
        maps.above(grid[2])
    return drawn
