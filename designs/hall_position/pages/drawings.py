"""Figures of the Hall position's report: field, fits, maps over the pitch.

Values come in SI units and are shown in mm, um, mrad, degrees, mV and mT.
"""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.figure import Figure

from models.hall_figures import Coefficients, Line, Spacings, Surface
from models.hall_scan import Decay, Fit
from synth.report import maps
from synth.report.figures import COLOURS
from synth.statespace import Array

GREY, DARK = "#bbbbbb", "#222222"


def coefficients(found: Sequence[tuple[str, Coefficients]]) -> Figure:
    """Draw Fig. 3: amplitudes by number, above ideal blocks and those that were made, at each distance."""
    with maps.panels(3.0, 1, len(found)) as (drawn, grid):
        for axes, (title, each) in zip(np.atleast_1d(grid), found, strict=True):
            for k, (label, values) in enumerate({"ideal": each.ideal, "as made": each.fabricated}.items()):
                axes.bar(each.numbers + 0.4 * (k - 0.5), values, 0.4, color=COLOURS[k], label=label)
            axes.bar([each.numbers[-1] + 2], [each.cross], 0.4, color=COLOURS[1])
            axes.axhline(0.0, color="#666666", lw=0.6)
            axes.set(title=title, ylabel="amplitude of B_X, T", xlabel="number n of sin(n ω X)")
            axes.set_xticks([*each.numbers, each.numbers[-1] + 2], [*map(str, each.numbers), "(2, 1)"])
            axes.grid(visible=False, axis="x")
            axes.legend(loc="upper right")
            axes.yaxis.set_major_formatter(maps.SIGNS)
    return drawn


def field(ideal: Surface, made: Surface) -> Figure:
    """Draw Fig. 4: B_X over the target area above ideal blocks and those that were made, and sections of both."""
    high = 1e3 * max(float(np.abs(each.B_X).max()) for each in (ideal, made))
    with maps.panels(3.3, 1, 3) as (drawn, (left, middle, right)):
        for axes, title, each in ((left, "B_X, ideal, mT", ideal), (middle, "B_X, as made, mT", made)):
            image = axes.pcolormesh(
                1e3 * each.X, 1e3 * each.Y, 1e3 * each.B_X.T, cmap=maps.SIGNED, vmin=-high, vmax=high, rasterized=True
            )
            maps.square(axes, title)
        drawn.colorbar(image, ax=(left, middle), shrink=0.85)
        for each, label, colour in ((ideal, "ideal", COLOURS[0]), (made, "as made, four Y", COLOURS[1])):
            for k in range(0, len(each.Y) - 1, (len(each.Y) - 1) // 4):
                right.plot(1e3 * each.X, 1e3 * each.B_X[:, k], color=colour, lw=0.8, label=None if k else label)
        right.set(xlabel="X, mm", title="sections of B_X, mT")
        right.legend(loc="upper right")
        maps.signs(right)
    return drawn


def spacing(line: Line, spacings: Spacings, printed: Array) -> Figure:
    """Draw Fig. 5: what two sensors read along X, and how insensitive a pair gets by its spacing."""
    pitch = line.X[-1]
    with maps.panels(2.8, 1, 2) as (drawn, (left, right)):
        steep = np.abs(line.slopes[0]) >= np.abs(line.slopes[1])
        for k, (volts, used) in enumerate(zip(line.volts, (steep, ~steep), strict=True)):
            left.plot(1e3 * line.X, volts, color=COLOURS[k], lw=0.8)
            left.plot(1e3 * line.X, np.where(used, volts, np.nan), color=COLOURS[k], lw=2.8, label=f"sensor {'AB'[k]}")
        left.set(xlabel="X, mm", ylabel="voltage, V; bold: the steeper")
        left.legend(loc="upper right")
        right.plot(spacings.spacing / pitch, 1e-3 * spacings.least, color=COLOURS[0])
        for at in printed / pitch:
            right.axvline(at, color=COLOURS[1], ls="--", lw=0.9, label="(3)" if at == printed[0] / pitch else None)
        right.set(xlabel="spacing, pitches", ylabel="least slope of the pair, V/mm", ylim=(0.0, None))
        right.legend(loc="lower right")
        maps.signs(left)
    return drawn


def residuals(fit: Fit) -> Figure:
    """Draw Fig. 8: a scan of a voltage, model (2) of it, and what is left, with a scale of its own."""
    shown = (
        ("(a) measured, V", fit.measured),
        ("(b) model (2), V", fit.modelled),
        ("(c) left, mV", 1e3 * fit.residual),
    )
    with maps.panels(3.0, 1, 3) as (drawn, grid):
        for axes, (title, values) in zip(grid, shown, strict=True):
            n = int(np.sqrt(len(values)))
            high = float(np.abs(values).max())
            image = axes.imshow(
                values.reshape(n, n).T, origin="lower", extent=_extent(fit), cmap=maps.SIGNED, vmin=-high, vmax=high
            )
            maps.square(axes, title)
            drawn.colorbar(image, ax=axes, shrink=0.8)
    return drawn


def gap(heights: Array, found: Mapping[str, Array], decays: Sequence[Decay], at: float) -> Figure:
    """Draw |alpha|, |beta|, .. in V of fits at heights in m, and the law of decay from the one `at` a height."""
    with maps.panels(2.9) as (drawn, axes):
        z = np.linspace(heights[0], heights[-1], 50)
        for (name, values), decay, colour in zip(found.items(), decays, COLOURS, strict=False):
            law = np.exp(decay.estimate["ln"] - decay.law * (z - at))
            axes.plot(1e3 * z, law, color=colour, lw=0.9)
            axes.plot(1e3 * heights, np.abs(values), "o", ms=4, color=colour, label=f"|{name}|")
        axes.set_yscale("log")
        axes.set(xlabel="height above the matrix, mm", ylabel="coefficient, V", xmargin=0.02)
        axes.set_xlim(1e3 * heights[0] - 0.05, 1e3 * heights[-1] + 0.05)
        maps.plain_log(axes)
        axes.legend(loc="center right")
    return drawn


def over_yaw(curves: Mapping[str, tuple[Array, Array]], required: float) -> Figure:
    """Draw the largest deviation of X or Y over the pitch, m, over the yaw, rad, for each layout."""
    with maps.panels(3.0) as (drawn, axes):
        for (label, (yaw, worst)), colour in zip(curves.items(), COLOURS, strict=False):
            axes.plot(np.degrees(yaw), 1e6 * worst, color=colour, label=label, lw=1.2)
        axes.axhline(1e6 * required, color="#666666", ls=":", lw=1.0)
        axes.set_yscale("log")
        axes.set(xlabel="yaw, °", ylabel="largest of X and Y over the pitch, µm")
        maps.plain_log(axes)
        axes.xaxis.set_major_formatter(maps.SIGNS)
        maps.above(axes)
    return drawn


def layouts(shown: Mapping[str, Sequence[tuple[float, float]]]) -> Figure:
    """Draw where sensors are in the body, in pitches, over one pitch's square."""
    with maps.panels(2.6, 1, len(shown), sharey=True) as (drawn, grid):
        for axes, (title, places) in zip(np.atleast_1d(grid), shown.items(), strict=True):
            axes.plot([-0.5, 0.5, 0.5, -0.5, -0.5], [-0.5, -0.5, 0.5, 0.5, -0.5], color=GREY, lw=0.8)
            axes.axhline(0.0, color=GREY, lw=0.6)
            axes.axvline(0.0, color=GREY, lw=0.6)
            for letter, (x, y) in zip("ABCDEFGH", places, strict=False):
                axes.plot([x], [y], "s", ms=6, color=COLOURS[0])
                axes.annotate(letter, (x, y), (4, 4), textcoords="offset points", fontsize=8.5)
            axes.set(title=title, xlim=(-0.72, 0.72), ylim=(-0.72, 0.72), aspect="equal", xlabel="x, pitches")
            axes.label_outer()
            maps.signs(axes)
        drawn.axes[0].set_ylabel("y, pitches")
    return drawn


def _extent(fit: Fit) -> tuple[float, float, float, float]:
    """Return the sides of a scan's picture, mm: its points are middles of squares."""
    half = fit.Y[1] / 2
    left, right, low, high = (1e3 * float(v) for each in (fit.X, fit.Y) for v in (each[0] - half, each[-1] + half))
    return left, right, low, high
