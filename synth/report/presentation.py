"""Presentation of experiments: units, prefixes, plotted time window, and tables of measured values by channel."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from synth import show
from synth.fault import LATCH_BIT
from synth.report import figures, page
from synth.report.audit import Row
from synth.report.notation import readable
from synth.simulate.experiments import Experiment

HEADROOM = "largest |state| / bound"  # how the figure and the check of `simulate.experiments` begin
# by experiment: rows of the audit, and figures of the source
PublishedFigures = Mapping[str, Sequence[tuple[str, str]]]
MICRO_UNITS = {unit: shown for unit, (shown, _) in figures.MICRO_UNITS.items()}


@dataclass(frozen=True)
class Shown:
    """Presentation of experiments: units of signals by name, levels in the plots of their errors, and further blocks.

    By name of the experiment, `published` describes the corresponding figure of the source, and `blocks` adds blocks.
    Runs longer than `longest` s are plotted over `window`. With `latch` = (before, after) in s, a run that latches is
    plotted around the latch. A signal in m or rad that stays below `fine` is shown in um or urad. Values that are
    measured for each of `channels`, such as "noise, V_ax", form a table with one row per channel.
    """

    units: Mapping[str, str]
    levels: Mapping[str, float] = field(default_factory=dict)
    published: Mapping[str, str] = field(default_factory=dict)
    blocks: Mapping[str, Sequence[page.Block]] = field(default_factory=dict)
    longest: float = math.inf
    window: figures.Window = (0.0, 5.0)
    latch: tuple[float, float] | None = None
    fine: float = 0.0
    channels: Sequence[str] = ()


def published_figures(figures: PublishedFigures, rows: Sequence[Row]) -> dict[str, str]:
    """Return the published text of rows of the audit by experiment; a row that is not in `rows` is left out.

    A figure without a name, "", is named by the place where its row is printed.
    """
    printed = {row.id: row.published for row in rows}
    return {
        name: ". ".join(
            f"{figure or printed[row].where}: {printed[row].text}" for row, figure in entries if row in printed
        )
        for name, entries in figures.items()
    }


def window(run: Experiment, shown: Shown) -> figures.Window | None:
    """Return the time window in s in which a run is plotted, None for the whole run."""
    time, faults = run.trajectory.time, np.asarray(run.trajectory.faults)
    latched = np.flatnonzero(faults >> LATCH_BIT & 1)
    if shown.latch and latched.size:
        at, (before, after) = float(time[latched[0]]), shown.latch
        return max(at - before, float(time[0])), min(at + after, float(time[-1]))
    return shown.window if len(time) and float(time[-1]) > shown.longest else None


def in_fine_units(run: Experiment, shown: Shown) -> tuple[Experiment, Shown]:
    """Return a run with small signals in um and urad, and its presentation."""
    units, levels = dict(shown.units), dict(shown.levels)
    states, references = dict(run.trajectory.states), dict(run.references)
    for name in run.shown:
        values = np.asarray(run.trajectory[name], dtype=np.float64)
        if units.get(name) in MICRO_UNITS and float(np.nanmax(np.abs(values), initial=0.0)) < shown.fine:
            units[name], states[name] = MICRO_UNITS[units[name]], 1e6 * values
            references |= {name: 1e6 * references[name]} if name in references else {}
            levels |= {name: 1e6 * levels[name]} if name in levels else {}
    scaled = replace(run, trajectory=replace(run.trajectory, states=states), references=references)
    return scaled, replace(shown, units=units, levels=levels)


def by_channel(measured: Mapping[str, float], channels: Sequence[str]) -> tuple[show.Table, ...]:
    """Return measured values as a table with one row per channel, nothing if any value has no channel."""
    measured = {name: value for name, value in measured.items() if not name.startswith(HEADROOM)}
    channel_of = {name: next((c for c in channels if c in name), "") for name in measured}
    if not measured or not all(channel_of.values()):
        return ()
    quantity_of = {name: readable(name.replace(f", {c}", "").replace(c, "it")) for name, c in channel_of.items()}
    columns, rows = tuple(dict.fromkeys(quantity_of.values())), dict.fromkeys(channel_of.values())
    values = {(channel_of[name], quantity_of[name]): value for name, value in measured.items()}
    cells: list[tuple[show.Cell, ...]] = [(c, *(values.get((c, n), math.nan) for n in columns)) for c in rows]
    return (show.Table("Measured by channel, no limit", ("channel", *columns), tuple(cells)),)


def with_units(measured: Mapping[str, float], units: Mapping[str, str]) -> dict[str, float]:
    """Return measured values whose names all end with a unit; a name that ends with a signal gets the unit 1."""
    return {f"{n}, 1" if n.rsplit(", ", 1)[-1] in units else n: value for n, value in measured.items()}
