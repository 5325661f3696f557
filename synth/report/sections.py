"""Report tables and sections from results of the toolkit: parameters, margins, experiments, agreements, cost, files.

Section on the fault campaign of a stage: worst rows, magnitudes, notes, limits, and every row collapsed.

Section on a study of tolerances: distribution, worst case, yield and driver of every figure.

Tables of gains.json: control laws with the same entries share a table, one column per law.

{"y": {"K": [1, 2], "certificate": {"residual": 1e-9}}, "x": {...}}   ->   entry                    y      x
                                                                           K                        1, 2   ...
                                                                           certificate:
                                                                               residual                 1e-9   ...

Presentation of experiments: units, prefixes, plotted time window, and tables of measured values by channel.
"""

import hashlib
import math
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from synth import show
from synth.analyse.loops.disk import DiskMargin
from synth.analyse.loops.robustness import ClosedLoop, OpenLoop
from synth.analyse.loops.stability_margins import Margins
from synth.fault import LATCH_BIT
from synth.plant import Plant
from synth.report import bode, figures, first_screen, page
from synth.report.audit import Row
from synth.report.equations.mathml import symbol
from synth.report.notation import number, readable
from synth.report.page import Checks, Figure, Section, Text
from synth.show import Cell, Table
from synth.simulate import study, worst_case
from synth.simulate.experiments import Experiment
from synth.simulate.faults import fault_table
from synth.simulate.faults.fault_table import Campaign
from synth.simulate.study import StudyTable, Summary
from synth.simulate.worst_case import WorstCase
from synth.verify.agree import Agreement
from synth.verify.cost import NOTE, Cost, tables

UNSTABLE = "unstable"  # instead of a margin
RANGES = ("crossover, Hz", "phase margin, °", "gain margin, ×", "Ms")
AGREEMENT = {
    "compared": "what",
    "steps": "samples",
    "of": "first",
    "with": "second",
    "worst difference": "worst",
    "in": "signal",
    "at step": "sample",
    "ulp": "ulps",
    "differing fault words": "faults_differ",
    "worst state, of range": "state_worst",
    "state": "state",
}


def parameters(plant: Plant) -> Table:
    """Return the parameters of a plant: value, unit, tolerance, source."""
    rows = tuple(
        (symbol(p.name), p.name, p.value, readable(p.unit), p.tolerance_text, p.source) for p in plant.parameters
    )
    return Table("Parameters", ("symbol", "name", "value", "unit", "tolerance", "source"), rows, digits=6)


def experiment(
    run: Experiment,
    units: Mapping[str, str],
    levels: Mapping[str, float] | None = None,
    window: figures.Window | None = None,
    published: str = "",
) -> Section:
    """Return one run: its plot, its measured values and its checks; the arguments are those of figures.response.

    `published` describes the corresponding figure of the paper.

    Raises SignalError when a unit is missing.
    """
    plot = figures.svg(figures.response(run, units, levels, window), _id(run.name))
    caption = f"{run.title}: {run.about}."
    if run.references and window:
        caption += f" On the left {window[0]:g} to {window[1]:g} s."
    measured = (Table("Measured, no limit", ("figure", "value", "unit"), _measured_rows(run)),) if run.figures else ()
    checks = (Checks("Checks", run.checks),) if run.checks else ()
    return Section(run.title, (Figure(plot, caption, published), *measured, *checks))


def loop(title: str, name: str, curves: Sequence[bode.LoopCurve]) -> Section:
    """Return one loop under several conditions: its Bode plot and a table of its worst margins.

    At most bode.MAX_LOOPS curves are drawn: those that are unstable, and those with the smallest modulus margins.

    Raises SignalError when there is no curve.
    """
    worst = sorted(curves, key=lambda c: (c.margins.stable, c.margins.modulus_margin))[: bode.MAX_LOOPS]
    plot = figures.svg(bode.bode_plot([c for c in curves if c in worst]), _id(name))
    which = (
        f" The {bode.MAX_LOOPS} loops with the least modulus margins are shown." if len(curves) > bode.MAX_LOOPS else ""
    )
    caption = f"{title}: open loop and sensitivity. Dots mark |L| = 1, diamonds negative real L, squares Ms.{which}"
    return Section(title, (Figure(plot, caption), margins_table(title, curves)))


def margins_table(caption: str, curves: Iterable[bode.LoopCurve | OpenLoop]) -> Table:
    """Return the worst margins of each loop over all crossings, and its highest crossover frequency.

    An unstable closed loop has no margins.
    """
    columns = (
        *("loop", "closed loop", "crossover, Hz", "gain up, ×", "gain down, ×", "phase, °"),
        *("delay, ms", "modulus", "Ms", "Ms at, Hz"),
    )
    return Table(
        f"Margins, {caption}: worst over all crossings; highest crossover frequency",
        columns,
        tuple(_margins(c) for c in curves),
    )


def poles_table(closed: Iterable[ClosedLoop]) -> Table:
    """Return the slowest and the least damped pole of each closed loop."""
    rows = tuple(
        (c.place, "stable" if c.is_stable else "UNSTABLE", 1e3 * c.slowest_s, *c.least_damping) for c in closed
    )
    columns = ("at", "closed loop", "slowest time constant, ms", "least damping", "of the pole at, Hz")
    return Table("Poles of the closed loop, the slowest first", columns, rows)


def margins_ranges(margins: Sequence[Margins]) -> tuple[str, ...]:
    """Return the smallest and the largest value of each of RANGES over loops; "unstable" for margins if one is."""
    crossovers = [max(c.frequency for c in m.gain_crossings) / (2 * math.pi) for m in margins]
    others = (
        [m.phase_margin for m in margins],
        [m.gain_margin for m in margins],
        [m.peak_sensitivity for m in margins],
    )
    ranges = [f"{min(v):.3g} .. {max(v):.3g}" for v in (crossovers, *others)]
    return tuple(ranges) if all(m.stable for m in margins) else (ranges[0], *[UNSTABLE] * len(others))


def disks(by_loop: Mapping[str, Mapping[str, DiskMargin]]) -> Table:
    """Return disk margins by loop and loop-breaking point, with simultaneous variation of all channels."""
    rows = []
    for label, margins in by_loop.items():
        for cut, m in margins.items():
            gains, hertz = f"{m.gain_low:.3g} .. {m.gain_high:.3g}", m.frequency / (2 * math.pi)
            rows.append((label, cut, m.lower, m.upper, gains, m.phase, hertz, "yes" if m.certified else "NO"))
    columns = ("loop", "opened at", "α, at least", "α, at most", "all gains, ×", "all phases, ± °", "worst at, Hz")
    return Table("Disk margins of all channels at once", (*columns, "all frequencies"), tuple(rows))


def agreements(compared: Iterable[Agreement]) -> Table:
    """Return the agreement of each pair of witnesses."""
    rows = tuple(tuple(getattr(a, entry) for entry in AGREEMENT.values()) for a in compared)
    return Table("Agreement of the witnesses; differences relative to max(floor, |value|)", tuple(AGREEMENT), rows)


def audit(rows: Iterable[Row]) -> Table:
    """Return the audit: published values, recomputed values, verdict and reason."""
    columns = ("row", "where", "published", "recomputed", "verdict", "why")
    return Table(
        "Published values recomputed. R: reproduces; RC: reproduces after the stated correction; N: does not reproduce",
        columns,
        tuple((r.id, r.published.where, r.published.text, _recomputed_text(r), str(r.verdict), r.why) for r in rows),
    )


def cost(measured: Cost | None) -> Section:
    """Return the cost of the emitted step on a core, with that of other generators; None if it was not measured."""
    if measured is None:
        why = "Not measured: the step computes in double, for which a Cortex-M4F has no hardware."
        return Section(first_screen.COST, (Text(why),))
    return Section(first_screen.COST, (Text(f"{NOTE} {'; '.join(measured.absent)}."), *tables(measured)))


def files(texts: Mapping[str, str]) -> Table:
    """Return the size in bytes (UTF-8) and the SHA-256 of each file."""
    data = {name: text.encode("utf-8") for name, text in texts.items()}
    rows = tuple((name, len(b), hashlib.sha256(b).hexdigest()) for name, b in data.items())
    return Table("Files", ("file", "bytes", "SHA-256"), rows)


def _id(name: str) -> str:
    return "f-" + re.sub(r"[^A-Za-z0-9_-]", "_", name)


def _measured_rows(run: Experiment) -> tuple[tuple[Cell, ...], ...]:
    """Split 'mean |e_y|, um' into quantity and unit."""
    named = ((*(name.rsplit(", ", 1) if ", " in name else (name, "1")), value) for name, value in run.figures.items())
    return tuple((quantity, value, readable(unit)) for quantity, unit, value in named)


def _margins(curve: bode.LoopCurve | OpenLoop) -> tuple[Cell, ...]:
    m = curve.margins
    highest = max((c.frequency for c in m.gain_crossings), default=math.nan) / (2 * math.pi)
    margins = (
        *(m.gain_margin, m.gain_reduction_margin, m.phase_margin, 1e3 * m.delay_margin),
        *(m.modulus_margin, m.peak_sensitivity, m.peak_frequency / (2 * math.pi)),
    )
    if not m.stable:
        return (curve.label, "UNSTABLE", highest, *[UNSTABLE] * len(margins))
    return (curve.label, "stable", highest, *margins)


def _recomputed_text(row: Row) -> str:
    return "\n".join(f"{f.name} {number(f.value, 5)} {readable(f.unit)}".rstrip() for f in row.recomputed)


ABOUT_FAULTS = (
    "Each fault of the interface is injected into the closed loop of compiled C and full plant, at rest and in motion, "
    "and compared with the healthy run. Excursion: largest distance from the healthy run. Impact: fastest on a stop "
    "that the healthy run does not have. Noticed, latched: slowest time from the onset. Tolerated: longest duration "
    "without harm when the controller never latches. Named: runs in which the fault bits name the faulty inputs. No "
    "effect: runs that do not differ from the healthy run."
)


def fault_campaign(result: Campaign) -> Section:
    """Return the section: of each kind of fault the target that ends worst, and all of them in a collapsed table."""
    plants = "the nominal plant" if result.plants == 1 else f"{result.plants} plants"
    caption = f"Faults, worst of their targets on {plants}"
    table = show.Table(caption, *fault_table.table(result, fault_table.worst_targets(result)))
    every = show.Table("Faults of every target", *fault_table.table(result, result.rows))
    checks = (page.Checks("Limits of faults", result.checks),) if result.checks else ()
    notes = page.Text("\n\n".join(f"{note[0].upper()}{note[1:]}." for note in fault_table.notes(result)))
    folded = page.Folded("Every fault", (every,))
    return Section(first_screen.FAULTS, (page.Text(ABOUT_FAULTS), table, *_magnitudes(result), notes, *checks, folded))


def _magnitudes(result: Campaign) -> tuple[show.Table, ...]:
    rows = fault_table.magnitude_cells(result, False)
    caption = (
        "Smallest magnitude, as a fraction of the range, above which every fault is noticed, and above which every one "
        "ends in an impact"
    )
    return (show.Table(caption, fault_table.MAGNITUDE_COLUMNS, rows),) if rows else ()


ABOUT_STUDY = (
    "The experiments run on machines within the tolerances of their parameters and sensors. Nominal: the machine "
    "without deviations. 95 %: the value that 95 % of the machines do not exceed. Row: the worst machine, which "
    "`synth study --row` runs alone. Kept: share of the machines that keep the limit. Driver: the quantity with the "
    "largest rank correlation (Spearman), |h| where deviations of h to both sides act alike."
)
COLUMNS = ("what", "unit", "nominal", "median", "95 %", "worst", "row", "limit", "kept", "driver")


def study_of_tolerances(table: StudyTable, worst: WorstCase | None = None) -> Section:
    """Return the section: a table of what has limits, one of what has none, the yield, and the end of a search."""
    summaries = study.summarise(table)
    limited = tuple(_row(s) for s in summaries if s.name in table.limits)
    others = tuple(_row(s) for s in summaries if s.name not in table.limits)
    notes = page.Text("\n\n".join([*study.notes(table), *(worst_case.notes(worst) if worst else [])]))
    tables = (show.Table(f"Limits on {len(table.rows)} machines", COLUMNS, limited),) if limited else ()
    folded = (page.Folded("Values without a limit", (show.Table("Values", COLUMNS, others),)),) if others else ()
    return Section(first_screen.STUDY, (page.Text(ABOUT_STUDY), notes, *tables, *folded))


def page_text(name: str, table: StudyTable, worst: WorstCase | None = None) -> str:
    """Return a page with the section alone, as HTML."""
    return page.render(page.Report(name, f"Study of {len(table.rows)} machines", (study_of_tolerances(table, worst),)))


def _row(s: Summary) -> tuple[show.Cell, ...]:
    has_limit = s.limit == s.limit
    limit, kept = (s.limit, f"{s.passed:.2%}") if has_limit else ("", "")
    driver = f"{s.driver} {s.correlation:+.2f}" if s.driver else ""
    return s.name, s.unit, s.nominal, s.median, s.percentile_95, s.worst, str(s.worst_row), limit, kept, driver


DIGITS = 6
_COMPLEX = re.compile(r"[-+.0-9ei]*[0-9]i?")
MAX_LAWS = 5  # largest number of laws in one table
MAX_LIST_LENGTH = 2  # largest list on one line in a table of several laws


def gains_tables(document: Mapping[str, Any]) -> tuple[Table, ...]:
    """Return the tables of a document: entries of the whole design first, then the laws."""
    laws = {label: dict(_entries(law)) for label, law in _laws(document)}
    whole = {name: value for name, value in document.items() if not isinstance(value, Mapping)}
    rows = tuple((name, _cell(value)) for name, value in _entries(whole))
    first = (Table("Gains", ("entry", "value"), rows),) if rows else ()
    return (*first, *(table for group in _alike(laws) for table in _tables(group)))


def _laws(document: Mapping[str, Any]) -> Iterator[tuple[str, Mapping[str, Any]]]:
    """Yield the laws with their names; a group of laws is expanded. The plant parameters are not a law."""
    for name, law in document.items():
        if not isinstance(law, Mapping) or name == "parameters":
            continue
        if law and all(isinstance(value, Mapping) for value in law.values()):
            yield from ((inner if inner == name else f"{name}, {inner}", value) for inner, value in law.items())
        else:
            yield name, law


def _alike(laws: Mapping[str, Mapping[str, Any]]) -> Iterator[dict[str, Mapping[str, Any]]]:
    """Yield groups of up to MAX_LAWS laws with the same entries."""
    waiting = dict(laws)
    while waiting:
        entries = set(next(iter(waiting.values())))
        group = [name for name, law in waiting.items() if set(law) == entries][:MAX_LAWS]
        yield {name: waiting.pop(name) for name in group}


def _tables(laws: Mapping[str, Mapping[str, Any]]) -> Iterator[Table]:
    """Yield a table of the entries that are equal in all laws, and one of the others with a column per law."""
    first, names = next(iter(laws.values())), ", ".join(laws)
    alike = [entry for entry in first if len(laws) > 1 and all(law[entry] == first[entry] for law in laws.values())]
    if alike:
        yield Table(
            f"Gains of {names}: the same for all", ("entry", "value"), tuple((e, _cell(first[e])) for e in alike)
        )
    rows: list[tuple[Cell, ...]] = []
    for entry in (e for e in first if e not in alike):
        rows.append((entry, *(_cell(law[entry], len(laws) > 1) for law in laws.values())))
    if rows:
        yield Table(f"Gains of {names}", ("entry", *laws), tuple(rows), DIGITS)


def _entries(law: Mapping[str, Any], above: str = "") -> Iterator[tuple[str, Any]]:
    """Yield the entries with readable names; the name of a nested entry follows that of its parent."""
    for name, value in law.items():
        words = f"{above}{name.replace('_', ' ')}"
        if isinstance(value, Mapping):
            yield from _entries(value, f"{words}:\n")
        else:
            yield words, value


def _cell(value: Any, narrow: bool = False) -> str:
    """Return a value as text: a matrix by rows; in a `narrow` column a longer list has one entry per line."""
    if isinstance(value, str):
        return value.replace("-", "−") if _COMPLEX.fullmatch(value) else value
    if isinstance(value, bool) or value is None:
        return {True: "yes", False: "no", None: "none"}[value]
    if isinstance(value, Sequence):
        nested = any(isinstance(v, Sequence) and not isinstance(v, str) for v in value)
        return ("\n" if nested or (narrow and len(value) > MAX_LIST_LENGTH) else ", ").join(_cell(v) for v in value)
    return number(value, DIGITS)


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
