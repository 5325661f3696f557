"""Closed loop in the report: calibration, every experiment beside the paper's figures, position sources."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from synth import show
from synth.blocks.laws.error_map import ErrorMap
from synth.report import figures, maps, page, standard
from synth.report.maps import Chart, Line, Map
from synth.report.notation import readable
from synth.report.prose import Content, Rows
from synth.report.sections import Shown
from synth.simulate.experiments import Experiment
from synth.statespace import Array

ESTIMATED = ", estimated"
UNITS = {axis + kind: unit for axis, unit in (("x", "m"), ("y", "m"), ("phi", "rad")) for kind in ("", ESTIMATED)}
SMALL = 5e-4  # m, rad: below it a signal is shown in um or urad
STEPS, ZIGZAGS, SOURCES = ("step_plain", "step_calibrated"), ("zigzag_plain", "zigzag_calibrated"), "sources"
ABSENT = page.Text("Not run.")


def blocks(error_map: ErrorMap | None, runs: Sequence[Experiment]) -> dict[str, Content]:
    """Return the map of a source's errors, its effect, and Figs. 10 and 11; ABSENT for runs that are missing."""
    by_name = {e.name: e for e in runs}
    return {
        **({"calibration.map": ABSENT, "calibration.shares": ABSENT} if error_map is None else _calibration(error_map)),
        "calibration.compared": _before_and_after(by_name) or ABSENT,
        "experiments.steps": _steps(by_name) if by_name.keys() >= set(STEPS) else ABSENT,
        "experiments.zigzags": _zigzags(by_name) if by_name.keys() >= set(ZIGZAGS) else ABSENT,
    }


def section(runs: Sequence[Experiment], published: Mapping[str, str]) -> page.Section:
    """Return every experiment, with the text of `beside` on the paper's figure, by name."""
    tables = {e.name: (comparison_table(e.figures),) for e in runs if e.name == SOURCES}
    return standard.experiments(
        [with_readable_names(e) for e in runs], Shown(UNITS, published=published, blocks=tables, fine=SMALL)
    )


def with_readable_names(e: Experiment) -> Experiment:
    """Return an experiment with readable names of signals, title and text."""
    labels = {name: name.replace("_raw", ESTIMATED) for name in e.shown}
    states = {label: np.asarray(e.trajectory[name], np.float64) for name, label in labels.items()}
    changed: dict[str, Any] = {
        "title": readable(e.title).replace("+-", "±"),
        "about": readable(e.about).replace("+-", "±"),
        "trajectory": replace(e.trajectory, states=states),
        "shown": tuple(states),
        "references": {labels[name]: values for name, values in e.references.items() if name in labels},
        "figures": {} if e.name == SOURCES else {_unit(n): v for n, v in e.figures.items()},
    }
    return replace(e, **changed)


def comparison_table(measured: Mapping[str, float]) -> show.Table:
    """Return figures 'source: quantity' as a table with a row for each quantity and a column for each source."""
    by_quantity: dict[str, dict[str, float]] = {}
    for key, value in measured.items():
        source, what = key.split(": ", 1)
        by_quantity.setdefault(what, {})[source] = value
    names = tuple(dict.fromkeys(key.split(": ", 1)[0] for key in measured))
    rows: list[tuple[show.Cell, ...]] = [
        (_unit(w), *(row.get(n, np.nan) for n in names)) for w, row in by_quantity.items()
    ]
    return show.Table("The position sources of planar_6dof_lqg compared", ("figure", *names), tuple(rows))


def _unit(what: str) -> str:
    return readable(re.sub(r"\bphi\b", "φ", what))


def _calibration(error_map: ErrorMap) -> dict[str, Content]:
    """Return the map of a source's errors, and how large it is, rms and at most."""
    named = zip(("X", "Y", "yaw"), ("mm", "mm", "mrad"), error_map.added, strict=True)
    shown = [Map(f"added to {name}, {unit}", 1e3 * values) for name, unit, values in named]
    shares = [
        (name, 1e6 * float(np.sqrt(np.mean(values**2))), 1e6 * float(np.abs(values).max()), unit)
        for name, unit, values in zip(("X", "Y", "yaw"), ("µm", "µm", "µrad"), error_map.added, strict=True)
    ]
    return {
        "calibration.size": f"{error_map.grid.size[0]} × {error_map.grid.size[1]}",
        "calibration.spacing": 1e3 * error_map.grid.spacing,
        "calibration.map": maps.signed_maps(
            shown, [(1e3 * float(a[0]), 1e3 * float(a[-1])) for a in error_map.grid.axes]
        ),
        "calibration.shares": shares,
    }


def _before_and_after(by_name: Mapping[str, Experiment]) -> Rows:
    """Return the figures common to the runs without and with calibration, one row each."""
    pairs = [(by_name[a], by_name[b]) for a, b in (STEPS, ZIGZAGS) if a in by_name and b in by_name]
    return [
        (before.name.split("_")[0], _unit(name), value, after.figures[name])
        for before, after in pairs
        for name, value in before.figures.items()
        if name in after.figures and not name.startswith("Fig.")
    ]


def _steps(by_name: Mapping[str, Experiment]) -> Figure:
    """Return Fig. 11: x over time, whole and close to the end."""
    plain, calibrated = (by_name[name].trajectory for name in STEPS)
    shown = {
        "(a) true, not calibrated": plain["x"],
        "(c) estimate, calibrated": calibrated["x_raw"],
        "(b) true, calibrated": calibrated["x"],
    }
    lines = [_decimated_line(plain.time, 1e3 * x, n) for n, x in shown.items()]
    size = 1e3 * float(by_name[STEPS[0]].references["x"].max())
    ends = [size, *(1e3 * v for x in shown.values() for v in (x[-200:].min(), x[-200:].max()))]
    low, high = min(ends), max(ends)
    close = {"ylim": (low - 0.3 * (high - low), high + 0.3 * (high - low))}
    left = Chart(lines, "time, s", "x, mm", levels=[size], legend="figure")
    return maps.draw([left, replace(left, ylabel="", options=close)], 2.9)


def _zigzags(by_name: Mapping[str, Experiment]) -> Figure:
    """Return Fig. 10: estimated and true path without calibration, and the distance of the two in both runs."""
    runs = dict(zip(("not calibrated", "calibrated"), (by_name[n].trajectory for n in ZIGZAGS), strict=True))
    first, parts = runs["not calibrated"], []
    for title, x, y in (("(a) as shown", "x_raw", "y_raw"), ("(b) true", "x", "y")):
        path = Line(1e3 * first[x][::4], 1e3 * first[y][::4])
        parts.append(Chart([path], "X, mm", "Y, mm", title, legend="", options={"aspect": "equal", "xmargin": 0.05}))
    lines = [
        _decimated_line(run.time, 1e3 * np.hypot(run["x"] - run["x_raw"], run["y"] - run["y_raw"]), name)
        for name, run in runs.items()
    ]
    parts.append(Chart(lines, "time, s", "distance of the two, mm", "(c)", options={"ylim": (0.0, None)}))
    return maps.draw(parts, 3.2, (1, 1, 1.5))


def _decimated_line(time: Array, values: Array, label: str) -> Line:
    keep = figures.decimate(values)
    return Line(time[keep], values[keep], label)
