"""The command line: `synth build | verify | simulate | audit | emit`, in the root of a workspace.

With --json stdout is one document and progress goes to stderr. Exit status: 0 well, 1 a check failed, 2 wrong usage.
"""

import json
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer
from rich.console import Console
from rich.table import Table

from synth import workspace
from synth.check import Check
from synth.emit import write
from synth.errors import SynthError
from synth.simulate.experiment import Experiment

app = typer.Typer(
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    help="Physics to verified C for precision stages. Call it in the root of a workspace.",
)
Names = Annotated[list[str] | None, typer.Argument(metavar="[NAME]...", help="designs; all when left out")]
AsJson = Annotated[bool, typer.Option("--json", help="print one JSON document, progress on stderr")]
SCALARS: dict[str, type[np.floating]] = {"float32": np.float32, "float64": np.float64}


@app.callback()
def _commands() -> None:
    """Physics to verified C for precision stages."""


def main() -> None:
    """Run the command line; an error of this package or of a file is told in one line and exits with 2."""
    try:
        app()
    except (SynthError, OSError) as error:
        Console(stderr=True).print(f"[bold red]error:[/] {error}", highlight=False, soft_wrap=True)
        raise SystemExit(2) from error


def _progress(json_wanted: bool, name: str) -> Callable[[str], None]:
    console = Console(stderr=json_wanted)
    return lambda what: console.print(f"{name}: {what}", highlight=False, markup=False)


@app.command()
def build(names: Names = None, json_wanted: AsJson = False) -> None:
    """Regenerate gains and C, verify, simulate, audit, and write the report of each design."""
    root, failed, told = Path.cwd(), False, []
    for design in workspace.designs(root, names or ()):
        say = _progress(json_wanted, design.name)
        say("gains and C")
        emitted = design.emit(design.scalar)
        for folder, files in emitted.items():
            write.save(files.files, root / "generated_c" / folder)
        evidence = design.verify(say, False)
        experiments = design.simulate(say)
        say("audit")
        rows = list(design.audit())
        say("report")
        reports = root / "reports"
        page = design.report(emitted, evidence, experiments, rows)
        write.save({f"{design.name}.html": page}, reports)
        document = _json(evidence.document()) + "\n"
        write.save({f"{design.name}.evidence.json": document}, reports)
        checks = [*evidence.checks, *(c for e in experiments for c in e.checks)]
        bad = [c for c in checks if not c.passed]
        failed |= bool(bad)
        say(f"{len(checks)} checks, {len(bad)} failed; report in reports/{design.name}.html")
        told.append({"design": design.name, "checks": len(checks), "failed": [asdict(c) for c in bad]})
    _finish(json_wanted, told, failed)


@app.command()
def verify(names: Names = None, json_wanted: AsJson = False) -> None:
    """Compare the emitted C with the reference, CasADi and CasADi's own C, with a replay of 60 s."""
    documents, failed = [], False
    for design in workspace.designs(Path.cwd(), names or ()):
        evidence = design.verify(_progress(json_wanted, design.name), True)
        documents.append(evidence.document())
        failed |= not evidence.passed
        if not json_wanted:
            _print_checks(design.name, evidence.checks)
    _finish(json_wanted, documents, failed)


@app.command()
def simulate(names: Names = None, json_wanted: AsJson = False) -> None:
    """Run each design's experiments on the full plant with the compiled C in the loop."""
    documents, failed = [], False
    for design in workspace.designs(Path.cwd(), names or ()):
        experiments = design.simulate(_progress(json_wanted, design.name))
        documents.append({"design": design.name, "experiments": [_experiment(e) for e in experiments]})
        failed |= any(not c.passed for e in experiments for c in e.checks)
        if not json_wanted:
            for e in experiments:
                _print_checks(e.title, e.checks, e.figures)
    _finish(json_wanted, documents, failed)


@app.command()
def audit(names: Names = None, json_wanted: AsJson = False) -> None:
    """Recompute every published figure: published, recomputed, verdict, why. No verdict fails the command."""
    rows = []
    console = Console()
    for design in workspace.designs(Path.cwd(), names or ()):
        say = _progress(json_wanted, design.name)
        for row in design.audit():
            say(f"audit {row.id}")
            rows.append(row)
    if json_wanted:
        typer.echo(_json([row.document() for row in rows]))
        return
    table = Table("row", "published", "recomputed", "verdict", "why", show_lines=True)
    for row in rows:
        found = "\n".join(f"{q.name}: {q.value:.6g} {q.unit}" for q in row.recomputed)
        table.add_row(row.id, row.published.text, found, str(row.verdict), row.why)
    console.print(table)


@app.command()
def emit(
    name: Annotated[str, typer.Argument(help="the design")],
    out: Annotated[Path, typer.Option(help="folder to write to")],
    scalar: Annotated[str, typer.Option(help="float32 or float64")] = "float32",
) -> None:
    """Write a design's C, header, manifest, gains and vectors elsewhere, or in the other scalar type."""
    if scalar not in SCALARS:
        raise typer.BadParameter(f"'{scalar}' is neither float32 nor float64", param_hint="--scalar")
    for folder, files in workspace.designs(Path.cwd(), [name])[0].emit(SCALARS[scalar]).items():
        write.save(files.files, out / folder)


def _experiment(e: Experiment) -> Mapping[str, Any]:
    checks = [asdict(c) | {"passed": c.passed} for c in e.checks]
    return {"name": e.name, "title": e.title, "figures": dict(e.figures), "checks": checks}


def _print_checks(title: str, checks: Sequence[Check], figures: Mapping[str, float] | None = None) -> None:
    table = Table("what", "found", "limit", "unit", "", title=title, title_justify="left")
    for c in checks:
        table.add_row(c.name, f"{c.found:.6g}", f"{c.limit:.6g}", c.unit, "ok" if c.passed else "[bold red]FAILED[/]")
    for name, value in (figures or {}).items():
        table.add_row(name, f"{value:.6g}", "", "", "")
    Console().print(table)


def _json(document: Any) -> str:
    """Return strict JSON: null for a number that JSON does not have."""
    return json.dumps(_finite(document), indent=1, allow_nan=False)


def _finite(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {k: _finite(v) for k, v in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(v) for v in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _finish(json_wanted: bool, documents: Sequence[Mapping[str, Any]], failed: bool) -> None:
    if json_wanted:
        typer.echo(_json(documents))
    raise typer.Exit(1 if failed else 0)
