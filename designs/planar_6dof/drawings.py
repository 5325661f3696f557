"""Figures of the planar positioner's report: voltages and failures over a pitch, noise, circle.

Values come in SI units and are shown in mm, um, mrad and Hz.
"""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray
from scipy import signal

from designs.planar_6dof.sensing import calibration
from designs.planar_6dof.sensing import maps as sensing_maps
from synth.plant import Plant
from synth.report import figures, maps
from synth.report.figures import COLOURS, Curve, Panel
from synth.report.maps import Chart, Line, Map
from synth.statespace import Array

POINTS, SECTIONS = 64, 8  # over a pitch
SEGMENT = 1024  # samples of a spectrum at most
IN_PLANE = ("x, mm", "y, mm")


def pitch(plant: Plant) -> Figure:
    """Draw Figs. 3 and 4: the two voltages of x over a pitch, which of them is used, and the error of the fit."""
    cal = calibration.of(plant)
    x = cal.pitch * np.linspace(-0.4999, 0.4999, 16 * POINTS + 1)
    v, level = sensing_maps.voltages(plant, {"x": x}), np.zeros_like(x)
    error, _ = sensing_maps.errors(plant, {"x": x, "y": level, "phi": level, "z": level})
    first = np.abs(v["V_ax"]) <= np.abs(v["V_bx"])
    waves = []
    for label, volts, used, colour in (
        ("V_ax, sensor A", v["V_ax"], first, COLOURS[0]),
        ("−V_bx, sensor B", -v["V_bx"], ~first, COLOURS[1]),
    ):
        bold = np.where(used, volts / cal.amplitude, np.nan)
        waves.append(Line(1e3 * x, volts / cal.amplitude, style={"color": colour}))
        waves.append(Line(1e3 * x, bold, f"{label}; bold: used", {"color": colour, "lw": 3.0}))
    along = "x from the middle of a pitch, mm"
    borders = {"xticks": 1e3 * cal.pitch * (np.arange(SECTIONS + 1) / SECTIONS - 0.5)}
    off = Chart([Line(1e3 * x, 1e6 * error["x"])], along, "error of raw x, µm", legend="", options=borders)
    return maps.draw([Chart(waves, along, "voltage over amplitude", options=borders), off], 3.4)


def yaw_maps(plant: Plant, yaw: float = 6e-3, doubt: float = 1e-3) -> Figure:
    """Draw over a pitch the error of the raw yaw, for a prediction that is off by `doubt`, and its noise, rad."""
    at_yaw, level = sensing_maps.error_map(plant, yaw, 0.0, doubt, POINTS), sensing_maps.error_map(plant, points=POINTS)
    panels = [
        Map(f"error of raw φ at {1e3 * yaw:g} mrad, mrad", 1e3 * at_yaw.error["phi"]),
        Map(f"noise of raw φ for {1e6 * sensing_maps.NOISE:g} µm, mrad rms", 1e3 * level.noise["phi"]),
    ]
    return maps.signed_maps(panels, _over_pitch(plant), IN_PLANE)


def undetected_failures(plant: Plant, silent: Mapping[str, NDArray[np.bool_]]) -> Figure:
    """Draw over a pitch where the failure (n, n) of a voltage is not detected."""
    panels = [Map(f"{name}: {100 * v.mean():.0f} % of the places", v.astype(float)) for name, v in silent.items()]
    return maps.maps(panels, _over_pitch(plant), (0.0, 1.0), log=False, label="1: not noticed", labels=IN_PLANE)


def _over_pitch(plant: Plant) -> tuple[maps.Side, maps.Side]:
    half = 500 * calibration.of(plant).pitch
    return (-half, half), (-half, half)


def before_and_after(time: Array, raw: Array, filtered: Array) -> Figure:
    """Draw Fig. 5: a position at rest as measured and after the filter (6)-(16)."""
    rows = {"raw x": raw, "filtered x": filtered}
    return figures.time_plot(time, [Panel(n, "µm", (Curve(n, 1e6 * (v - v.mean())),)) for n, v in rows.items()])


def spectra(records: Mapping[str, Array], period_s: float) -> Figure:
    """Draw Fig. 10(d): the densities of positions (N,) in m, averaged over segments, without mean and trend."""
    lines = []
    for label, x in records.items():
        frequency, power = signal.welch(x, 1 / period_s, nperseg=min(SEGMENT, len(x) // 4), detrend="linear")
        lines.append(Line(frequency[1:], 1e6 * np.sqrt(power[1:]), label))
    return maps.draw([Chart(lines, "frequency, Hz", "x, µm/√Hz", options={"xlim": (0.0, 0.5 / period_s)})], 3.2)


def circle(set_point: Sequence[Array], path: Sequence[Array]) -> Figure:
    """Draw Fig. 9: y over x in m, and the radial and tangential error of the path by the angle of the set-point."""
    (x, y), (u, v) = path, set_point
    angle, offset = np.unwrap(np.arctan2(v, u)), 1e6 * ((x - u) + 1j * (y - v))
    error = offset * np.exp(-1j * angle)  # outward, and along the path
    at_radius = np.hypot(u, v) > 0.999 * np.hypot(u, v).max()
    lines = [
        Line(1e3 * u, 1e3 * v, "set-point", {"color": "#bbbbbb", "lw": 4.0}),
        Line(1e3 * x, 1e3 * y, "true path", {"color": COLOURS[0]}),
    ]
    errors = []
    for label, values in (("outward", error.real[at_radius]), ("along the path", error.imag[at_radius])):
        keep = figures.decimate(values)
        errors.append(Line(np.degrees(angle[at_radius][keep]), values[keep], label, {"lw": 0.7}))
    plane = Chart(lines, "x, mm", "y, mm", options={"aspect": "equal"})
    return maps.draw([plane, Chart(errors, "angle of the set-point, °", "true error, µm")], 4.0, (1, 1.25))
