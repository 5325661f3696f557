"""Figures of the planar positioner's report: voltages and failures over a pitch, noise, circle.

Values come in SI units and are shown in mm, um, mrad and Hz.
"""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.image import AxesImage
from numpy.typing import NDArray
from scipy import signal

from designs.planar_6dof import sensing, sensing_maps
from models import hall_calibration
from synth.plant import Plant
from synth.report import figures, maps
from synth.report.figures import COLOURS, Curve, Panel
from synth.statespace import Array
from synth.timing import Discrete

POINTS, SECTIONS = 64, 8  # over a pitch
SEGMENT = 1024  # samples of a spectrum at most
GREY = "#bbbbbb"


def pitch(plant: Plant) -> Figure:
    """Draw Figs. 3 and 4: the two voltages of x over a pitch, which of them is used, and what the fit leaves."""
    cal = hall_calibration.of(plant)
    x = cal.pitch * np.linspace(-0.4999, 0.4999, 16 * POINTS + 1)
    v = sensing_maps.voltages(plant, {"x": x})
    waves = {"V_ax, sensor A": v["V_ax"] / cal.amplitude, "−V_bx, sensor B": -v["V_bx"] / cal.amplitude}
    used = np.abs(v["V_ax"]) <= np.abs(v["V_bx"])
    with maps.panels(4.8, 2, 1, sharex=True, height_ratios=(3, 2)) as (figure, (top, bottom)):
        for (label, values), mine, colour in zip(waves.items(), (used, ~used), COLOURS, strict=False):
            top.plot(1e3 * x, values, color=colour, lw=0.8)
            top.plot(1e3 * x, np.where(mine, values, np.nan), color=colour, lw=3.0, label=f"{label}; bold: used")
        for k in range(SECTIONS):
            at = 1e3 * cal.pitch * ((k + 0.5) / SECTIONS - 0.5)
            top.text(at, -1.25, f"section {k + 1}", ha="center", va="bottom", fontsize=8.0, color="#555555")
        top.set(ylabel="voltage over amplitude", ylim=(-1.3, 1.1))
        figures.above(top)
        bottom.plot(1e3 * x, 1e6 * (_raw(plant, x) - x), color=COLOURS[0], lw=0.8)
        bottom.set(ylabel="error of raw x, µm", xlabel="x from the middle of a pitch, mm")
        for axes in (top, bottom):
            axes.set_xticks(1e3 * cal.pitch * (np.arange(SECTIONS + 1) / SECTIONS - 0.5))
            axes.xaxis.set_major_formatter(maps.SIGNS)
    return figure


def _raw(plant: Plant, x: Array) -> Array:
    """Return raw positions (N,) in m at rest at x (N,) within the middle pitch, without yaw."""
    block, v = sensing.sensing(plant, Discrete(1e-3)), sensing_maps.voltages(plant, {"x": x})
    given = {f"{name}_held": values for name, values in v.items()} | {"x_predicted": x}
    u = np.array([given.get(s.name, np.full_like(x, s.unit == "1")) for s in block.inputs])
    y = block.function().map(len(x))(np.tile(block.initial[:, None], len(x)), u)[1].full()
    return np.asarray(y[[s.name for s in block.outputs].index("x_raw")])


def yaw_maps(plant: Plant, yaw: float = 6e-3, doubt: float = 1e-3) -> Figure:
    """Draw over a pitch the error of the raw yaw, at a yaw that is known to `doubt`, and its noise, rad."""
    turned, level = sensing_maps.error_map(plant, yaw, 0.0, doubt, POINTS), sensing_maps.error_map(plant, points=POINTS)
    shown = {
        f"error of raw φ at {1e3 * yaw:g} mrad, mrad": 1e3 * turned.error["phi"],
        f"noise of raw φ for {1e6 * sensing_maps.NOISE:g} µm, mrad rms": 1e3 * level.noise["phi"],
    }
    l = hall_calibration.of(plant).pitch
    with maps.panels(4.0, 1, 2) as (figure, grid):
        for axes, (title, values) in zip(grid, shown.items(), strict=True):
            figure.colorbar(_map(axes, title, values, l, "viridis"), ax=axes, shrink=0.85)
    return figure


def failures(found: Mapping[str, NDArray[np.bool_]], l: float) -> Figure:
    """Draw over a pitch l in m where a voltage that drops to zero is not noticed, as `sensing_maps.unnoticed` tells."""
    colours = ListedColormap(["#f2f2f2", COLOURS[1]])
    with maps.panels(6.2, 2, 3, sharex=True, sharey=True) as (figure, grid):
        for axes, (name, silent) in zip(grid.T.flat, found.items(), strict=True):
            _map(axes, f"{name}: {100 * silent.mean():.0f} % of the places", silent, l, colours)
            axes.label_outer()
    return figure


def _map(
    axes: Axes, title: str, values: Array | NDArray[np.bool_], l: float, colours: str | ListedColormap
) -> AxesImage:
    """Draw values (x, y) over a pitch."""
    half = 500 * l
    axes.set(title=title, xlabel="x, mm", ylabel="y, mm")
    axes.grid(visible=False)
    return axes.imshow(values.T, origin="lower", extent=(-half, half, -half, half), cmap=colours, aspect="equal")


def before_and_after(time: Array, raw: Array, filtered: Array) -> Figure:
    """Draw Fig. 5: a position at rest as the Hall sensors show it and behind the filter (6)-(16)."""
    rows = {"raw x": raw, "filtered x": filtered}
    panels = [Panel(name, "µm", (Curve(name, 1e6 * (v - v.mean())),)) for name, v in rows.items()]
    figure = figures.time_plot(time, panels)
    high = 1.1e6 * float(np.abs(raw - raw.mean()).max())
    for axes in figure.axes:
        axes.set_ylim(-high, high)
    return figure


def spectra(records: Mapping[str, Array], period_s: float) -> Figure:
    """Draw Fig. 10(d): the densities of positions (N,) in m, averaged over segments, without mean and trend."""
    with maps.panels(3.2) as (figure, axes):
        for (label, x), colour in zip(records.items(), COLOURS, strict=False):
            frequency, power = signal.welch(x, 1 / period_s, nperseg=min(SEGMENT, len(x) // 4), detrend="linear")
            axes.plot(frequency[1:], 1e6 * np.sqrt(power[1:]), color=colour, label=label)
        axes.set(xlabel="frequency, Hz", ylabel="x, µm/√Hz", xlim=(0.0, 0.5 / period_s))
        axes.set_ylim(bottom=0.0)
        axes.legend(loc="upper right")
    return figure


def circle(set_point: Sequence[Array], path: Sequence[Array]) -> Figure:
    """Draw Fig. 9: y over x in m, and how far the path is from its radius, by the angle of the set-point."""
    (x, y), (u, v) = path, set_point
    angle, off = np.unwrap(np.arctan2(v, u)), 1e6 * ((x - u) + 1j * (y - v))
    turned = off * np.exp(-1j * angle)  # outward, and along the path
    grown = np.hypot(u, v) > 0.999 * np.hypot(u, v).max()
    with maps.panels(4.0, 1, 2, width_ratios=(1, 1.25)) as (figure, (left, right)):
        left.plot(1e3 * u, 1e3 * v, color=GREY, lw=4.0, label="set-point")
        left.plot(1e3 * x, 1e3 * y, color=COLOURS[0], lw=0.9, label="true path")
        left.set(xlabel="x, mm", ylabel="y, mm", aspect="equal")
        for values, label, colour in zip(
            (turned.real, turned.imag), ("outward", "along the path"), COLOURS, strict=False
        ):
            keep = figures.decimate(values[grown])
            right.plot(np.degrees(angle[grown][keep]), values[grown][keep], color=colour, lw=0.7, label=label)
        right.set(xlabel="angle of the set-point, °", ylabel="true error, µm")
        for axes in (left, right):
            figures.above(axes)
    return figure
