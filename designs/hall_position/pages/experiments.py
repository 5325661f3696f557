"""The closed loop in the report: calibration, every experiment with the paper's figures beside, the sources."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from designs.hall_position.loop.error_map import ErrorMap
from designs.hall_position.pages import curves
from synth.report import maps, page, standard
from synth.report.maps import Map, figure
from synth.report.notation import readable
from synth.report.prose import Value
from synth.report.standard import Shown
from synth.simulate.experiment import Experiment
from synth.statespace import Array

UNITS = {"x": "m", "y": "m", "phi": "rad"}  # of what begins so
SMALL, PREFIXED = 5e-4, {"m": "µm", "rad": "µrad"}  # m, rad: below it a signal is shown with the prefix
STEPS, ZIGZAGS, SOURCES = ("step_plain", "step_calibrated"), ("zigzag_plain", "zigzag_calibrated"), "sources"
NAMES = (
    *("calibration.map", "calibration.shares", "calibration.compared", "experiments.steps", "experiments.zigzags"),
)
ABSENT = page.Text("Not run.")


def blocks(of: ErrorMap | None, runs: Sequence[Experiment]) -> dict[str, Value]:
    """Return the map of a source's errors, what it takes off them, and Figs. 10 and 11; ABSENT what was not run."""
    by_name = {e.name: e for e in runs}
    found: dict[str, Value] = dict.fromkeys(NAMES, ABSENT)
    if of is not None:
        found |= {"calibration.map": _map(of), "calibration.shares": _shares(of)}
    if rows := _before_and_after(by_name):
        columns = ("run", "figure", "without", "with")
        found["calibration.compared"] = page.Table("Without calibration and with it", columns, rows)
    if by_name.keys() >= set(STEPS):
        found["experiments.steps"] = _steps(by_name)
    if by_name.keys() >= set(ZIGZAGS):
        found["experiments.zigzags"] = _zigzags(by_name)
    return found


def section(runs: Sequence[Experiment], beside: Mapping[str, str]) -> page.Section:
    """Return every experiment, with what the paper's figure shows `beside` it by name."""
    shown = [scaled(e) for e in runs]
    units = {name: unit for _, each in shown for name, unit in each.items()}
    drawn = {e.name: (compared(e.figures),) for e in runs if e.name == SOURCES}
    parts = [standard.experiments([e], Shown(each, beside=beside, drawn=drawn)) for e, each in shown]
    return (
        page.Section(standard.EXPERIMENTS, (), tuple(s for part in parts for s in part.sections))
        if units
        else (page.Section(standard.EXPERIMENTS))
    )


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
    title, about = (readable(t).replace("+-", "±") for t in (e.title, e.about))
    measured = {} if e.name == SOURCES else {_unit(n): v for n, v in e.figures.items()}
    run = replace(e.trajectory, states=states)
    return (
        replace(
            e, title=title, about=about, trajectory=run, shown=tuple(units), references=references, figures=measured
        ),
        units,
    )


def compared(measured: Mapping[str, float]) -> page.Table:
    """Return figures 'source: what' as a table, a row for each of what, a column for each source."""
    by_what: dict[str, dict[str, float]] = {}
    for key, value in measured.items():
        source, what = key.split(": ", 1)
        by_what.setdefault(what, {})[source] = value
    names = tuple(dict.fromkeys(key.split(": ", 1)[0] for key in measured))
    rows: list[tuple[page.Cell, ...]] = [(_unit(w), *(row.get(n, np.nan) for n in names)) for w, row in by_what.items()]
    return page.Table("The position sources of planar_6dof_lqg compared", ("figure", *names), tuple(rows))


def _unit(what: str) -> str:
    return readable(re.sub(r"\bphi\b", "φ", what))


def _map(of: ErrorMap) -> page.Figure:
    titles = ("added to X, mm", "added to Y, mm", "added to yaw, mrad")
    shown = [Map(title, 1e3 * values) for title, values in zip(titles, of.added, strict=True)]
    drawn = maps.signed(shown, tuple((a[0], a[-1]) for a in of.grid.axes))
    caption = f"The table: {of.grid.size[0]} × {of.grid.size[1]} places, {1e3 * of.grid.spacing:g} mm apart."
    return figure("error-map", drawn, caption, "Fig. 10(c): errors of up to 1.4 mm.")


def _shares(of: ErrorMap) -> page.Table:
    rows = tuple(
        (name, 1e6 * float(np.sqrt(np.mean(values**2))), 1e6 * float(np.abs(values).max()), unit)
        for name, unit, values in zip(("X", "Y", "yaw"), ("µm", "µm", "µrad"), of.added, strict=True)
    )
    return page.Table("What the table takes off", ("of", "rms", "largest", "unit"), rows)


def _before_and_after(by_name: Mapping[str, Experiment]) -> tuple[tuple[page.Cell, ...], ...]:
    """Return the figures that runs without calibration and with it share, one row a figure."""
    pairs = [(by_name[a], by_name[b]) for a, b in (STEPS, ZIGZAGS) if a in by_name and b in by_name]
    return tuple(
        (before.name.split("_")[0], _unit(name), value, after.figures[name])
        for before, after in pairs
        for name, value in before.figures.items()
        if name in after.figures and not name.startswith("Fig.")
    )


def _steps(by_name: Mapping[str, Experiment]) -> page.Figure:
    plain, calibrated = (by_name[name].trajectory for name in STEPS)
    lines = {
        "(a) true, not calibrated": np.asarray(plain["x"]),
        "(c) estimate, calibrated": np.asarray(calibrated["x_raw"]),
        "(b) true, calibrated": np.asarray(calibrated["x"]),
    }
    drawn = curves.steps(plain.time, lines, float(by_name[STEPS[0]].references["x"].max()))
    caption = "A step of 4 mm. The paper's 4.3 mm belong to another place of another matrix; rows K-6 and K-9."
    return figure("steps", drawn, caption, "Fig. 11: 4.3 mm without calibration, 4 mm with it.")


def _zigzags(by_name: Mapping[str, Experiment]) -> page.Figure:
    runs = [by_name[n].trajectory for n in ZIGZAGS]
    paths = [[np.asarray(run[c]) for c in ("x_raw", "y_raw", "x", "y")] for run in runs]
    drawn = curves.zigzags(runs[0].time, dict(zip(("not calibrated", "calibrated"), paths, strict=True)))
    caption = (
        "Zigzag: (a) as the sensors show it, (b) as it is, not calibrated; (c) the distance between the two, without "
        "calibration and with it, the lag of the filters included."
    )
    return figure("zigzag", drawn, caption, "Fig. 10.")
