"""The report's parts on experiments: how each run is shown, and the voltages that all of them need."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from designs.planar_6dof import drawings
from designs.planar_6dof.page_stage import REST, SYMBOLS, seen
from models import halbach, planar_stage, planar_voltages
from synth.plant import Plant
from synth.report import figures, page, standard
from synth.report.notation import readable
from synth.report.shown import Shown, window
from synth.signals import names
from synth.simulate.experiment import Experiment
from synth.simulate.scenario import Trajectory
from synth.timing import Discrete

SHOWN = Shown(
    {s.name: s.unit for s in (*planar_stage.STATES, *planar_stage.INPUTS, *planar_stage.OUTPUTS)},
    latch=(0.1, 0.05),  # the platen then goes on without current
    fine=5e-4,
    channels=planar_stage.HALL,
)
SPECTRUM, SETTLED = "step_x", 1.0  # the run of Fig. 10(a), s of it that are left out
CIRCLE, FINITE = "circle", "_finite"


def experiments(
    found: Sequence[Experiment], beside: Mapping[str, str], time: Discrete, filtered: bool, spectrum: bool
) -> page.Section:
    """Return every experiment with what the paper says beside it, that over a finite matrix as on the closed force law.

    `filtered` tells whether the law reads filtered positions, `spectrum` whether the paper draws one.
    """
    drawn = {e.name: (_path(e),) for e in found if e.name.removesuffix(FINITE) == CIRCLE}
    rest = [e.trajectory for e in found if e.name == REST]
    if spectrum:
        drawn |= {e.name: (_spectrum(e.trajectory, rest, time, filtered),) for e in found if e.name == SPECTRUM}
    told = {e.name: readable(beside.get(e.name.removesuffix(FINITE), "")) for e in found}
    return standard.experiments([_worded(e) for e in found], replace(SHOWN, beside=told, drawn=drawn))


def _worded(e: Experiment) -> Experiment:
    """Return an experiment whose title and text are written as a reader writes them."""
    about = readable(e.about) + ("; drawn around the latch" if window(e, SHOWN) else "")
    return replace(e, title=_title(e), about=about)


def _title(e: Experiment) -> str:
    first, space, rest = readable(e.title).partition(" ")
    return f"{SYMBOLS.get(first, first)}{space}{rest}"


def _path(e: Experiment) -> page.Figure:
    set_point, path = ([np.asarray(source[n]) for n in "xy"] for source in (e.references, e.trajectory))
    caption = "The path over the matrix, and how far the platen is from its set-point on the full circle."
    return page.Figure(figures.svg(drawings.circle(set_point, path), f"path-{e.name}"), caption)


def _spectrum(step: Trajectory, rest: Sequence[Trajectory], time: Discrete, filtered: bool) -> page.Figure:
    runs = dict(zip(("step of x", "at rest"), (step, *rest), strict=False))
    part = round(SETTLED / time.period_s)
    records = {label: seen(run, time, len(run.time), filtered)["x_raw"][part:] for label, run in runs.items()}
    drawn = figures.svg(drawings.spectra(records, time.period_s), "spectrum")
    caption = "Density of x as the Hall sensors show it, once the step has settled, and at rest."
    return page.Figure(drawn, caption, "Fig. 10(d): no dominant noise frequency component.")


def headroom(found: Sequence[Experiment]) -> page.Section:
    """Return what voltages the currents of each run need, beside the one that Table 1 states."""
    plant = planar_stage.plant(halbach.HARMONICS)
    left = f"headroom under {planar_voltages.STATED:g} V, V"
    columns = ("run", "largest current, A", "largest induced, V", "largest voltage, V", left, "samples above, %")
    rows: list[tuple[page.Cell, ...]] = [
        (_title(e), *_needs(plant, e.trajectory)) for e in found if _ideal(plant, e.trajectory)
    ]
    return page.Section("Voltages", (page.Table("Voltages of the phases", columns, tuple(rows), digits=3),))


def _ideal(plant: Plant, run: Trajectory) -> bool:
    """Tell whether a run's currents are what was commanded, on a stage with these states."""
    return set(names(plant.states)) == set(run.states) and set(names(plant.inputs)) <= set(run.applied)


def _needs(plant: Plant, run: Trajectory) -> tuple[float, ...]:
    u, induced = np.abs(planar_voltages.needed(plant, run)), float(np.abs(planar_voltages.induced(plant, run)).max())
    above, largest = 100 * float(np.mean(u.max(axis=0) > planar_voltages.STATED)), float(u.max())
    return planar_voltages.largest_current(run), induced, largest, planar_voltages.STATED - largest, above
