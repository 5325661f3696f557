"""The report's parts on experiments: each run with its figures and checks, and the voltages that all of them need."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from designs.planar_6dof import drawings
from designs.planar_6dof.page_stage import REST, seen
from models import halbach, planar_stage, planar_voltages
from synth.errors import SignalError
from synth.plant import Plant
from synth.report import figures, page, sections, standard
from synth.report.notation import readable
from synth.signals import names
from synth.simulate.experiment import Experiment
from synth.simulate.scenario import Trajectory
from synth.synthesise import safety
from synth.timing import Discrete

Beside = Mapping[str, Sequence[tuple[str, str]]]  # by experiment: rows of the audit, and the paper's figures

UNITS = {s.name: s.unit for s in (*planar_stage.STATES, *planar_stage.INPUTS, *planar_stage.OUTPUTS)}
SMALL, PREFIXED = 5e-4, {"m": "µm", "rad": "µrad"}  # m, rad: below it a signal is shown with the prefix
AROUND = (0.1, 0.05)  # s before a latch and after it that are drawn: the platen then goes on without current
SPECTRUM, SETTLED = "step_x", 1.0  # the run of Fig. 10(a), s of it that are left out
CIRCLE, FINITE = "circle", "_finite"
CHANNELS = planar_stage.HALL


@dataclass(frozen=True, eq=False)
class Told:
    """What the paper says beside the runs: rows by experiment, their texts by id, and whether it draws a spectrum.

    `filtered` tells whether the law reads filtered positions.
    """

    beside: Beside
    printed: Mapping[str, str]
    spectrum: bool
    filtered: bool


def experiments(found: Sequence[Experiment], told: Told, time: Discrete) -> page.Section:
    """Return every experiment."""
    drawn = {e.name: (_path(e),) for e in found if _base(e) == CIRCLE}
    rest = [e.trajectory for e in found if e.name == REST]
    if told.spectrum:
        drawn |= {e.name: (_spectrum(e.trajectory, rest, time, told.filtered),) for e in found if e.name == SPECTRUM}
    return page.Section(standard.EXPERIMENTS, (), tuple(_one(e, told, drawn.get(e.name, ())) for e in found))


def _one(e: Experiment, told: Told, more: tuple[page.Figure, ...]) -> page.Section:
    shown, units = scaled(e)
    rows, window = by_channel(e.figures), around_latch(e.trajectory)
    about = readable(e.about) + ("; drawn around the latch" if window else "")
    shown = replace(shown, title=_greek(readable(e.title)), about=about, figures={} if rows else _with_units(e.figures))
    beside = [f"{figure}: {told.printed[row]}" for row, figure in told.beside.get(_base(e), ()) if row in told.printed]
    found = sections.experiment(shown, units, window=window, beside=readable(". ".join(beside)))
    first, *others = found.blocks
    return replace(found, blocks=(first, *more, *((rows,) if rows else ()), *others))


def _base(e: Experiment) -> str:
    """Return the name of the run on the closed force law that one over a finite matrix repeats, or its own."""
    return e.name.removesuffix(FINITE)


def _greek(title: str) -> str:
    first, space, rest = title.partition(" ")
    return f"{figures.SYMBOLS.get(first, first)}{space}{rest}"


def scaled(e: Experiment) -> tuple[Experiment, dict[str, str]]:
    """Return an experiment whose small signals are in um and urad, and the units of what it shows.

    Raises SignalError when it shows a signal that the stage does not have.
    """
    units, states, references = {}, dict(e.trajectory.states), dict(e.references)
    for name in e.shown:
        if name not in UNITS:
            raise SignalError(
                f"experiment '{e.name}' shows '{name}', which is no signal of the stage: show one that is"
            )
        values, units[name] = np.asarray(e.trajectory[name], dtype=np.float64), UNITS[name]
        if UNITS[name] in PREFIXED and float(np.nanmax(np.abs(values))) < SMALL:
            units[name], states[name] = PREFIXED[UNITS[name]], 1e6 * values
            references |= {name: 1e6 * e.references[name]} if name in references else {}
    return replace(e, trajectory=replace(e.trajectory, states=states), references=references), units


def around_latch(run: Trajectory) -> tuple[float, float] | None:
    """Return the times in s between which a run that latches is drawn, None for one that does not."""
    latched = np.flatnonzero(np.asarray(run.faults) >> safety.LATCH_BIT & 1)
    if not latched.size:
        return None
    at, before, after = float(run.time[latched[0]]), *AROUND
    return max(at - before, float(run.time[0])), min(at + after, float(run.time[-1]))


def by_channel(figures: Mapping[str, float]) -> page.Table | None:
    """Return figures that are measured for each Hall channel as one table, a row a channel; None for others."""
    found: dict[str, dict[str, float]] = {}
    for name, value in figures.items():
        channel = next((c for c in CHANNELS if c in name), None)
        if channel is None:
            return None
        what = name.replace(f", {channel}", "").replace(channel, "it")
        found.setdefault(channel, {})[what] = value
    if not found:
        return None
    columns = tuple(next(iter(found.values())))
    rows: list[tuple[page.Cell, ...]] = []
    for channel, row in found.items():
        rows.append((channel, *(row.get(c, np.nan) for c in columns)))
    return page.Table("Measured, by channel", ("channel", *map(readable, columns)), tuple(rows))


def _with_units(figures: Mapping[str, float]) -> dict[str, float]:
    """Return figures whose names all end with a unit: one that ends with a signal's name gets 1."""
    return {f"{n}, 1" if n.rsplit(", ", 1)[-1] in UNITS else n: value for n, value in figures.items()}


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
    rows: list[tuple[page.Cell, ...]] = []
    for e in (e for e in found if _ideal(plant, e.trajectory)):
        rows.append((_greek(readable(e.title)), *_needs(plant, e.trajectory)))
    return page.Section("Voltages", (page.Table("Voltages of the phases", columns, tuple(rows), digits=3),))


def _ideal(plant: Plant, run: Trajectory) -> bool:
    """Tell whether a run's currents are what was commanded, on a stage with these states."""
    return set(names(plant.states)) == set(run.states) and set(names(plant.inputs)) <= set(run.applied)


def _needs(plant: Plant, run: Trajectory) -> tuple[float, ...]:
    u, induced = np.abs(planar_voltages.needed(plant, run)), float(np.abs(planar_voltages.induced(plant, run)).max())
    above, largest = 100 * float(np.mean(u.max(axis=0) > planar_voltages.STATED)), float(u.max())
    return planar_voltages.largest_current(run), induced, largest, planar_voltages.STATED - largest, above
