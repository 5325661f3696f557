"""Figures of the Hall position's report that are neither charts of curves nor maps of their own.

Values come in SI units and are shown in mm, pitches, mT and T.
"""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.figure import Figure

from models.hall_figures import Coefficients, Surface
from synth.report import maps
from synth.report.figures import COLOURS

GREY = {"color": "#bbbbbb", "lw": 0.7}


def coefficients(found: Sequence[tuple[str, Coefficients]]) -> Figure:
    """Draw Fig. 3: amplitudes by number, above ideal blocks and those that were made, at each distance."""
    with maps.panels(3.0, 1, len(found)) as (drawn, grid):
        for axes, (title, each) in zip(np.atleast_1d(grid), found, strict=True):
            for k, (label, values) in enumerate({"ideal": each.ideal, "as made": each.fabricated}.items()):
                axes.bar(each.numbers + 0.4 * (k - 0.5), values, 0.4, color=COLOURS[k], label=label)
            cross = each.numbers[-1] + 2
            axes.bar([cross], [each.cross], 0.4, color=COLOURS[1])
            axes.axhline(0.0, **GREY)
            axes.set(title=title, ylabel="amplitude of B_X, T", xlabel="number n of sin(n ω X)")
            axes.set_xticks([*each.numbers, cross], [*map(str, each.numbers), "(2, 1)"])
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
            axes.set(title=title, xlabel="X, mm", ylabel="Y, mm", aspect="equal")
            axes.grid(visible=False)
        drawn.colorbar(image, ax=(left, middle), shrink=0.85)
        for each, label, colour in ((ideal, "ideal", COLOURS[0]), (made, "as made, four Y", COLOURS[1])):
            for k in range(0, len(each.Y) - 1, (len(each.Y) - 1) // 4):
                right.plot(1e3 * each.X, 1e3 * each.B_X[:, k], color=colour, lw=0.8, label=None if k else label)
        right.set(xlabel="X, mm", title="sections of B_X, mT")
        right.legend(loc="upper right")
        maps.signs(right)
    return drawn


def layouts(shown: Mapping[str, Sequence[tuple[float, float]]]) -> Figure:
    """Draw where sensors are in the body, in pitches, over one pitch's square."""
    with maps.panels(2.6, 1, len(shown), sharey=True) as (drawn, grid):
        for axes, (title, places) in zip(np.atleast_1d(grid), shown.items(), strict=True):
            axes.plot([-0.5, 0.5, 0.5, -0.5, -0.5], [-0.5, -0.5, 0.5, 0.5, -0.5], **GREY)
            axes.axhline(0.0, **GREY)
            axes.axvline(0.0, **GREY)
            for letter, (x, y) in zip("ABCDEFGH", places, strict=False):
                axes.plot([x], [y], "s", ms=6, color=COLOURS[0])
                axes.annotate(letter, (x, y), (4, 4), textcoords="offset points", fontsize=8.5)
            axes.set(title=title, xlim=(-0.72, 0.72), ylim=(-0.72, 0.72), aspect="equal")
            axes.set(xlabel="x, pitches", ylabel="y, pitches")
            axes.label_outer()
            maps.signs(axes)
    return drawn
