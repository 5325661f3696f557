"""Report tables and sections from results of the toolkit: parameters, margins, experiments, agreements, cost, files."""

import hashlib
import math
import re
from collections.abc import Iterable, Mapping, Sequence

from synth.analyse.loops.disk import DiskMargin
from synth.analyse.loops.robustness import ClosedLoop, OpenLoop
from synth.analyse.loops.stability_margins import Margins
from synth.plant import Plant
from synth.report import bode, figures, first_screen
from synth.report.audit import Row
from synth.report.equations.mathml import symbol
from synth.report.notation import number, readable
from synth.report.page import Checks, Figure, Section, Text
from synth.show import Cell, Table
from synth.simulate.experiments import Experiment
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
