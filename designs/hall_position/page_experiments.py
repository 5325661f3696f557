"""The report's parts on the closed loop: calibration, every experiment with the paper's figures beside, the sources."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from designs.hall_position import drawings, drawings_runs
from designs.hall_position.drawings import Map
from designs.hall_position.loop.closed_loop import Source
from designs.hall_position.loop.error_map import ErrorMap
from synth.report import figures, page, sections
from synth.report.notation import readable
from synth.simulate.experiment import Experiment
from synth.statespace import Array

UNITS = {"x": "m", "y": "m", "phi": "rad"}  # of what begins so
SMALL, PREFIXED = 5e-4, {"m": "µm", "rad": "µrad"}  # m, rad: below it a signal is shown with the prefix
BESIDE = {
    "step_plain": "Fig. 11(a): the platen moves 4.3 mm where the estimate moves 4 mm.",
    "step_calibrated": "Fig. 11(b), (c): 4 mm, as the estimate says.",
    "zigzag_plain": "Fig. 10: the sensors show the path as commanded, the lasers one that is up to 1.4 mm off.",
    "zigzag_calibrated": "The paper calibrates from the error of Fig. 10(c), but prints no zigzag with it.",
    "staircase": "Fig. 12: steps of 10 µm are seen in the output of GLSDC.",
    "rest": "Section IV: the noise of the voltages is 1 mV.",
}
STEPS, ZIGZAGS, SOURCES = ("step_plain", "step_calibrated"), ("zigzag_plain", "zigzag_calibrated"), "sources"
LAW = (
    ("Fig. 10", "D(x, y) = (X - x, Y - y, θ - θ_{estimated}),  linear on the triangles between the samples"),
    ("Fig. 11", "corrected = estimate + D,  bilinear between the nearest four of the table"),
)


def calibration(source: Source, found: Sequence[Experiment]) -> page.Section:
    """Return the map of a source's errors and what it takes off them."""
    text = page.Text(
        "The truth is a field that the estimator does not know: six pitches of finite blocks whose remanence scatters "
        "by ±2 %, the direction of their magnetisation by ±1° and their places by ±0.1 mm, drawn from a seed. Model "
        "(2) is fitted to scans of it, as on a bench. Then estimates are noted beside the laser's positions on lines "
        "across the travel, the differences are interpolated linearly onto a grid, and the grid is a table in the "
        "emitted C. The yaw is mapped too, for X and Y depend on it."
    )
    drawn = () if source.map is None else (_map(source.map), _share(source.map))
    blocks = (text, page.Equations(LAW), *drawn, *_before_and_after(found))
    return page.Section("Calibration", blocks)


def _map(of: ErrorMap) -> page.Figure:
    scales = (("added to X, mm", 1e3), ("added to Y, mm", 1e3), ("added to yaw, mrad", 1e3))
    shown = [Map(title, scale * values) for (title, scale), values in zip(scales, of.added, strict=True)]
    drawn = drawings.signed(shown, tuple((a[0], a[-1]) for a in of.grid.axes))
    caption = f"The table: {of.grid.size[0]} × {of.grid.size[1]} places, {1e3 * of.grid.spacing:g} mm apart."
    return page.Figure(figures.svg(drawn, "error-map"), caption, "Fig. 10(c): errors of up to 1.4 mm.")


def _share(of: ErrorMap) -> page.Table:
    rows = []
    for name, unit, scale, values in zip(("X", "Y", "yaw"), ("µm", "µm", "µrad"), (1e6,) * 3, of.added, strict=True):
        rows.append((name, scale * float(np.sqrt(np.mean(values**2))), scale * float(np.abs(values).max()), unit))
    return page.Table("What the table takes off", ("of", "rms", "largest", "unit"), tuple(rows))


def _before_and_after(found: Sequence[Experiment]) -> tuple[page.Table, ...]:
    """Return the figures that runs without calibration and with it share, one row a figure."""
    by_name, rows = {e.name: e for e in found}, []
    for first, second in (STEPS, ZIGZAGS):
        if first in by_name and second in by_name:
            before, after = by_name[first], by_name[second]
            common = (n for n in before.figures if n in after.figures and not n.startswith("Fig."))
            rows += [(first.split("_")[0], _unit(n), before.figures[n], after.figures[n]) for n in common]
    if not rows:
        return ()
    return (page.Table("Without calibration and with it", ("run", "figure", "without", "with"), tuple(rows)),)


def section(found: Sequence[Experiment]) -> page.Section:
    """Return every experiment."""
    text = page.Text(
        "X, Y and yaw are closed by three sensors at 800 Hz, on the full planar stage under the regulators of "
        "planar_6dof_lqg; the paper closes X and Y alone and leaves the yaw to the lasers. Voltages pass the filters "
        "of 200 Hz, 1 mV of noise and a converter of 16 bits; the controller is the compiled C in single precision. "
        "At a speed the filters' lag is part of the difference of true and estimated position."
    )
    drawn = (*_steps(found), *_zigzags(found))
    return page.Section("Experiments", (text, *drawn), tuple(_one(e) for e in found))


def _one(e: Experiment) -> page.Section:
    shown, units = scaled(e)
    measured = {} if e.name == SOURCES else {_unit(n): v for n, v in e.figures.items()}
    title, about = (readable(t).replace("+-", "±") for t in (e.title, e.about))
    part = sections.experiment(
        replace(shown, title=title, about=about, figures=measured), units, beside=BESIDE.get(e.name, "")
    )
    return replace(part, blocks=(*part.blocks, *(() if e.name != SOURCES else (compared(e.figures),))))


def scaled(e: Experiment) -> tuple[Experiment, dict[str, str]]:
    """Return an experiment whose small signals are in um and urad, and the units of what it shows, names readable."""
    units: dict[str, str] = {}
    states: dict[str, Array] = {}
    references: dict[str, Array] = {}
    for name in e.shown:
        axis, *estimated = name.split("_")
        label = f"{axis}, estimated" if estimated else axis
        values, unit = np.asarray(e.trajectory[name], dtype=np.float64), UNITS[axis]
        small = float(np.nanmax(np.abs(values))) < SMALL
        units[label], factor = (PREFIXED[unit], 1e6) if small else (unit, 1.0)
        states[label] = factor * values
        references |= {label: factor * e.references[name]} if name in e.references else {}
    run = replace(e.trajectory, states=states)
    return replace(e, trajectory=run, shown=tuple(units), references=references), units


def compared(measured: Mapping[str, float]) -> page.Table:
    """Return figures 'source: what' as a table, a row for each of what, a column for each source."""
    found: dict[str, dict[str, float]] = {}
    for key, value in measured.items():
        source, what = key.split(": ", 1)
        found.setdefault(what, {})[source] = value
    names = tuple(dict.fromkeys(key.split(": ", 1)[0] for key in measured))
    rows: list[tuple[page.Cell, ...]] = [(_unit(w), *(row.get(n, np.nan) for n in names)) for w, row in found.items()]
    return page.Table("The position sources of planar_6dof_lqg compared", ("figure", *names), tuple(rows))


def _unit(what: str) -> str:
    return readable(_greek(what))


def _greek(what: str) -> str:
    return re.sub(r"\bphi\b", "φ", what)


def _steps(found: Sequence[Experiment]) -> tuple[page.Figure, ...]:
    by_name = {e.name: e for e in found}
    if not all(name in by_name for name in STEPS):
        return ()
    plain, calibrated = (by_name[name].trajectory for name in STEPS)
    curves = {
        "(a) true, not calibrated": np.asarray(plain["x"]),
        "(c) estimate, calibrated": np.asarray(calibrated["x_raw"]),
        "(b) true, calibrated": np.asarray(calibrated["x"]),
    }
    drawn = drawings_runs.steps(plain.time, curves, float(by_name[STEPS[0]].references["x"].max()))
    caption = "A step of 4 mm. The paper's 4.3 mm belong to another place of another matrix; rows K-6 and K-9."
    return (page.Figure(figures.svg(drawn, "steps"), caption, "Fig. 11: 4.3 mm without calibration, 4 mm with it."),)


def _zigzags(found: Sequence[Experiment]) -> tuple[page.Figure, ...]:
    by_name = {e.name: e for e in found}
    if not all(name in by_name for name in ZIGZAGS):
        return ()
    runs = {n: by_name[n].trajectory for n in ZIGZAGS}
    paths = {n: [np.asarray(run[c]) for c in ("x_raw", "y_raw", "x", "y")] for n, run in runs.items()}
    drawn = drawings_runs.zigzags(
        runs[ZIGZAGS[0]].time, dict(zip(("not calibrated", "calibrated"), paths.values(), strict=True))
    )
    caption = (
        "Zigzag: (a) as the sensors show it, (b) as it is, not calibrated; (c) the distance between the two, without "
        "calibration and with it, the lag of the filters included."
    )
    return (page.Figure(figures.svg(drawn, "zigzag"), caption, "Fig. 10."),)
