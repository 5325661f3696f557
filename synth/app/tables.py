"""Tables at a terminal: checks, audit rows and costs.

Outcomes of the jobs of a command: run with progress, printed or as one JSON document, with an exit status.
"""

import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import nullcontext
from dataclasses import asdict, dataclass
from typing import Any

from rich.console import Console
from rich.markup import escape
from rich.table import Table

from synth import show
from synth.analyse.loops.robustness import ClosedLoop, Survey
from synth.app import verdicts
from synth.base import contents, progress, store
from synth.base.jobs import Job, Outcome, run
from synth.check import Check, limit_text
from synth.declare.tuning import Tuned, Tuning
from synth.report import comparison as comparisons
from synth.report import first_screen
from synth.report import tuning as tunings
from synth.report.audit import Row
from synth.report.comparison import Side
from synth.simulate import study as studies
from synth.simulate.faults import fault_table
from synth.simulate.faults.fault_table import Campaign
from synth.simulate.study import StudyTable
from synth.verify import cost as costs

LOOPS = 12  # rows of poles and of loops
WORST = 3  # rows of a design among several, beside those that fail


def print_checks(
    title: str, checks: Sequence[Check], figures: Mapping[str, float] | None = None, notes: Sequence[str] = ()
) -> None:
    """Print checks, then measured values without a limit, then notes and descriptions of the failed checks."""
    table = Table("what", "found", "limit", "unit", "", title=title, title_justify="left")
    for c in checks:
        table.add_row(c.name, f"{c.value:.6g}", limit_text(c), c.unit, c.verdict if c.passed else "[bold red]FAILED[/]")
    for name, value in (figures or {}).items():
        table.add_row(name, f"{value:.6g}", "", "", "no limit")
    console = Console()
    console.print(table)
    for line in (*notes, *(f"{c.name}: {c.about}" for c in checks if c.about and not c.passed)):
        console.print(line, highlight=False, markup=False)


def print_first_screen(screens: Mapping[str, Sequence[first_screen.Row]]) -> None:
    """Print the first screen of a design; of several designs the rows that fail, and those with the least margins."""
    console = Console(width=None if sys.stdout.isatty() else 100)
    for name, rows in screens.items() if len(screens) == 1 else ():
        console.print(_screen(name, rows), highlight=False)
    if len(screens) > 1:
        table = Table("design", *first_screen.COLUMNS[:-1], title="worst of each design", title_justify="left")
        for name, rows in screens.items():
            for k, row in enumerate(first_screen.worst(rows, WORST)):
                table.add_row("" if k else escape(name), *map(escape, row.cells[:-1]), style=_style(row))
        console.print(table, highlight=False)


def _screen(name: str, rows: Sequence[first_screen.Row]) -> Table:
    table = Table(title=escape(name), title_justify="left")
    for column, ratio in zip(first_screen.COLUMNS, (6, 3, 3, 2, 4), strict=True):
        table.add_column(column, ratio=ratio, overflow="fold")
    for row in rows:
        table.add_row(*map(escape, row.cells), style=_style(row))
    return table


def _style(row: first_screen.Row) -> str:
    return "" if row.worst.passed else "bold red"


def print_campaign(campaign: Campaign, every: bool = False) -> None:
    """Print the worst target of each kind of fault, or `every` one, then the checks of declared limits."""
    console = Console(width=None if sys.stdout.isatty() else 160)
    title = f"{campaign.design}: faults on the machine, worst of {campaign.plants} plants"
    rows = campaign.rows if every else fault_table.worst_targets(campaign)
    _print(console, title, *fault_table.table(campaign, rows))
    if magnitudes := fault_table.magnitude_cells(campaign, every):
        title = f"{campaign.design}: smallest magnitude, of the range, from which on every one is noticed, and harms"
        _print(console, title, fault_table.MAGNITUDE_COLUMNS, magnitudes)
    console.print("\n".join(fault_table.notes(campaign)), highlight=False, markup=False)
    if campaign.checks:
        print_checks(f"{campaign.design}: limits of faults", campaign.checks)


def _print(console: Console, title: str, columns: Sequence[str], rows: Iterable[Sequence[str]]) -> None:
    table = Table(*columns, title=title, title_justify="left")
    for row in rows:
        table.add_row(*map(escape, row))
    console.print(table)


def print_margins(design: str, closed: Sequence[ClosedLoop], loops: Survey | None, checks: Sequence[Check]) -> None:
    """Print whether the loops are stable, then the slowest poles, the loops with the least margins, and the checks."""
    from synth.report import sections  # what it needs for figures is slow to import

    console = Console(width=None if sys.stdout.isatty() else 160)
    console.print(f"{design}: {verdicts.stability(closed)}", highlight=False, markup=False)
    slowest = sorted(closed, key=lambda c: (c.is_stable, -c.slowest_s))[:LOOPS]
    worst = sorted(loops.loops if loops else (), key=lambda of: (of.margins.stable, of.margins.modulus_margin))[:LOOPS]
    poles = [sections.poles_table(slowest)] if slowest else []
    _print_tables(console, design, [*poles, *([sections.margins_table("the least", worst)] if worst else [])])
    where = [f"{c.name}: {c.about}" for c in checks if c.about and c.passed]
    print_checks(f"{design}: least margins", checks, notes=where)


def print_study(design: str, study: StudyTable) -> None:
    """Print the distribution of every check and figure, the yield, and why machines have no result."""
    console = Console(width=None if sys.stdout.isatty() else 160)
    columns = ("what", "unit", "nominal", "median", "95 %", "worst", "row", "limit", "kept", "driver")
    table = Table(*columns, title=f"{design}: {len(study.rows)} machines", title_justify="left")
    for s in studies.summarise(study):
        has_limit = s.name in study.limits
        limit, kept = (f"{s.limit:.4g}", f"{s.passed:.2%}") if has_limit else ("no limit", "")
        driver = f"{s.driver} {s.correlation:+.2f}" if s.driver else ""
        numbers = (f"{v:.4g}" for v in (s.nominal, s.median, s.percentile_95, s.worst))
        table.add_row(escape(s.name), s.unit, *numbers, str(s.worst_row), limit, kept, driver)
    console.print(table)
    console.print("\n".join(studies.notes(study)), highlight=False, markup=False)


def print_machine(design: str, study: StudyTable) -> None:
    """Print checks and figures of the only row of a study, and what was drawn for it."""
    checks = [Check(n, float(v[0]), study.limits[n], study.units[n]) for n, v in study.checks.items()]
    figures = {name: float(value[0]) for name, value in study.figures.items()}
    drawn = ", ".join(f"{name} {z[0]:+.3f}" for name, z in study.z.items())
    errors = [f"no result of {experiment}: {reason}" for _, experiment, reason in study.errors]
    notes = [f"deviations in tolerances: {drawn}", *errors]
    print_checks(f"{design}: machine {study.rows[0]}", checks, figures, notes)


def print_tuning(design: str, tuning: Tuning, tuned: Tuned) -> None:
    """Print the proposed values beside the declared ones, goals, margins, and the certificate of the proposal."""
    console = Console(width=None if sys.stdout.isatty() else 160)
    _print_tables(console, design, tunings.tables(tuning, tuned))
    print_checks(f"{design}: certificate of the proposal", tuned.certificate.checks)
    console.print("\n".join(tunings.notes(tuned)), highlight=False, markup=False)


def print_comparison(sides: tuple[Side, Side]) -> None:
    """Print experiments, margins and instructions of two designs side by side, and their yields."""
    console = Console(width=None if sys.stdout.isatty() else 200)
    _print_tables(console, " and ".join(side.name for side in sides), comparisons.tables(sides))
    console.print("\n".join(comparisons.notes(sides)), highlight=False, markup=False)


def _print_tables(console: Console, title: str, of: Sequence[show.Table]) -> None:
    for t in of:
        rows = ([cell if isinstance(cell, str) else f"{cell:.{t.digits}g}" for cell in row] for row in t.rows)
        _print(console, f"{title}: {t.caption}", t.columns, rows)


def print_sheet(sheet: show.Sheet) -> None:
    """Print the tables of a description, then its sentences."""
    console = Console(width=None if sys.stdout.isatty() else 160)
    _print_tables(console, sheet.title, sheet.tables)
    console.print("\n".join(sheet.lines), highlight=False, markup=False)


def print_cost(cost: costs.Cost) -> None:
    """Print every table of a cost, and what was not measured."""
    console = Console(width=None if sys.stdout.isatty() else 160)
    _print_tables(console, cost.design, costs.tables(cost))
    console.print("\n".join([costs.NOTE, *cost.absent]), highlight=False)


def print_rows(rows: Sequence[Row]) -> None:
    """Print audited rows: published, recomputed, verdict, why."""
    table = Table("row", "published", "recomputed", "verdict", "why", show_lines=True)
    for row in rows:
        recomputed = "\n".join(f"{q.name}: {q.value:.6g} {q.unit}" for q in row.recomputed)
        table.add_row(row.id, row.published.text, recomputed, str(row.verdict), row.why)
    Console().print(table)


def writer(as_json: bool) -> Callable[[str, str], None]:
    """Return a function of a design's name and a line, which writes both."""
    console = Console(stderr=as_json)
    return lambda name, line: console.print(f"{name}: {line}", highlight=False, markup=False)


def run_jobs(jobs: Sequence[Job], as_json: bool, fresh: bool) -> Mapping[str, Outcome]:
    """Run jobs in parallel, and print why one failed."""
    fresh_run = store.fresh_run() if fresh else nullcontext()
    with fresh_run, progress.display(len(jobs), writer(as_json)) as display:
        outcomes = run(jobs, display)
    console = Console(stderr=True)
    for name, outcome in outcomes.items():
        if outcome.error:
            console.print(f"[bold red]error:[/] {escape(f'{name}: {outcome.error}')}", highlight=False, soft_wrap=True)
    store.trim()
    return outcomes


@dataclass(frozen=True)
class Failed:
    """The name of a design without a result, and the reason."""

    design: str
    error: str


def successful(results: Mapping[str, Any]) -> list[Any]:
    return [result for result in results.values() if not isinstance(result, Failed)]


def finish(
    as_json: bool, documents: Sequence[Mapping[str, Any]], results: Mapping[str, Any], failed: bool = False
) -> int:
    """Print the documents, errors last; return 2 where a design has no result, 1 where a check failed."""
    errors = [asdict(result) for result in results.values() if isinstance(result, Failed)]
    if as_json:
        sys.stdout.write(contents.dumps([*documents, *errors]) + "\n")
    return 2 if errors else int(failed)
