"""The command line: `synth build | verify | simulate | audit | cost | prove | emit`, in the root of a workspace.

With --json stdout is one document and progress goes to stderr. Exit status: 0 well, 1 a check failed, 2 wrong usage.
"""

import importlib.util
import json
import math
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from synth import workspace
from synth.check import Check
from synth.emit import write
from synth.errors import CompileError, SynthError
from synth.simulate.experiment import Experiment
from synth.verify import cost as costs
from synth.verify import prove as proofs

app = typer.Typer(
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    help="Physics to verified C for precision stages. Call it in the root of a workspace.",
)
Names = Annotated[list[str] | None, typer.Argument(metavar="[NAME]...", help="designs; all when left out")]
AsJson = Annotated[bool, typer.Option("--json", help="print one JSON document, progress on stderr")]
SCALARS: dict[str, type[np.floating]] = {"float32": np.float32, "float64": np.float64}
CORES: dict[str, type[np.floating]] = {"cortex-m4f": np.float32, "cortex-m7": np.float64}
EMULATOR = ("unicorn", "elftools", "capstone")  # packages of the extra `target`


@app.callback()
def _commands() -> None:
    """Physics to verified C for precision stages."""


def main() -> None:
    """Run the command line; an error of this package or of a file is told in one line and exits with 2."""
    try:
        app()
    except (SynthError, OSError) as error:
        Console(stderr=True).print(f"[bold red]error:[/] {escape(str(error))}", highlight=False, soft_wrap=True)
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
        emitted = workspace.emitted(design, design.scalar)
        for folder, files in emitted.items():
            write.save(files.files, root / "generated_c" / folder)
        evidence = design.verify(say, False)
        experiments = design.simulate(say)
        say("audit")
        rows = list(design.audit())
        say("cost")
        cost = _brief_cost(design, emitted[design.name])
        say("report")
        reports = root / "reports"
        page = design.report(emitted, evidence, experiments, rows, cost)
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
def verify(
    names: Names = None,
    json_wanted: AsJson = False,
    core: Annotated[
        str | None, typer.Option("--target", help="replay on cortex-m4f (float32) or cortex-m7 (float64) instead")
    ] = None,
) -> None:
    """Compare the emitted C with the reference, CasADi and CasADi's own C, with a replay of 60 s.

    With --target, compare the machine code of a Cortex-M core, in an emulator, with this machine's, bit by bit.
    """
    if core is not None and core not in CORES:
        raise typer.BadParameter(f"'{core}' is none of {', '.join(CORES)}", param_hint="--target")
    documents, failed = [], False
    for design in workspace.designs(Path.cwd(), names or ()):
        say = _progress(json_wanted, design.name)
        if core is None:
            evidence = design.verify(say, True)
            document, checks, figures = evidence.document(), evidence.checks, None
        else:
            document, checks, figures = _on_target(design, core, say)
        documents.append(document)
        failed |= not all(c.passed for c in checks)
        if not json_wanted:
            _print_checks(design.name, checks, figures)
    _finish(json_wanted, documents, failed)


def _on_target(
    design: workspace.Design, core: str, say: workspace.Told
) -> tuple[Mapping[str, Any], Sequence[Check], Mapping[str, float]]:
    """Replay on the host and on a core: the document, the checks, and the drift with contraction as figures."""
    _require_emulator()
    from synth.execute import cross, host
    from synth.verify import on_target

    say("C")
    emitted = workspace.emitted(design, CORES[core])[design.name]
    inputs = design.bench.replay(host.load(emitted.files, emitted.manifest))
    checks = on_target.verify(emitted, inputs, core, say)
    document: dict[str, Any] = {"design": design.name, "target": core, "checks": _checks(checks), "drift": None}
    if "gcc" not in cross.available():
        say("drift with contraction: arm-none-eabi-gcc is not installed, not measured")
        return document, checks, {}
    drift = on_target.drift(emitted, inputs, core, design.bench.floor)
    floor = design.bench.floor
    least = f"{floor:g}" if isinstance(floor, float) else "floor"
    what = f"drift with contraction over {drift.steps} steps, worst in {drift.output}, of max({least}, |i|)"
    return document | {"drift": asdict(drift)}, checks, {what: drift.worst, "fault words unlike then": drift.faults}


@app.command()
def cost(names: Names = None, json_wanted: AsJson = False) -> None:
    """Count what a step costs on a Cortex-M4F, beside CasADi's own C: instructions, bytes, decisions. No verdicts."""
    _require_emulator()
    from synth.execute import host
    from synth.verify import meter

    documents = []
    for design in workspace.designs(Path.cwd(), names or ()):
        say = _progress(json_wanted, design.name)
        say("C")
        emitted = workspace.emitted(design, np.float32)[design.name]
        sequences = design.bench.sequences(host.load(emitted.files, emitted.manifest), say)
        found = meter.measure(emitted, design.bench.block(), sequences, say)
        documents.append(found.document())
        if not json_wanted:
            _print_cost(found)
    _finish(json_wanted, documents, False)


def _brief_cost(design: workspace.Design, emitted: write.Emitted) -> costs.Cost | None:
    """Measure the cost in a few seconds, or not at all where emulator or cross compiler are missing."""
    if _missing():
        return None
    from synth.execute import cross, host
    from synth.verify import meter

    if not cross.available() or emitted.manifest["scalar"] != "float32":
        return None
    controller = host.load(emitted.files, emitted.manifest)
    return meter.brief(emitted, design.bench.block(), design.bench.replay(controller))


@app.command()
def prove(
    names: Names = None,
    json_wanted: AsJson = False,
    whole: Annotated[bool, typer.Option("--whole", help="as deep as the proofs go; a subset when left out")] = False,
) -> None:
    """Prove the emitted C: Eva, inputs that are not finite, fuzzing under sanitizers, cppcheck's misra addon."""
    documents, failed = [], False
    for design in workspace.designs(Path.cwd(), names or ()):
        _progress(json_wanted, design.name)("C")
        for folder, emitted in workspace.emitted(design, design.scalar).items():
            checks = proofs.prove(emitted.files, emitted.manifest, whole, _progress(json_wanted, folder))
            documents.append({"design": folder, "whole": whole, "checks": _checks(checks)})
            failed |= not all(c.passed for c in checks)
            if not json_wanted:
                _print_checks(folder, checks)
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
    (design,) = workspace.designs(Path.cwd(), [name])
    for folder, files in workspace.emitted(design, SCALARS[scalar]).items():
        write.save(files.files, out / folder)


def _experiment(e: Experiment) -> Mapping[str, Any]:
    return {"name": e.name, "title": e.title, "figures": dict(e.figures), "checks": _checks(e.checks)}


def _checks(checks: Sequence[Check]) -> list[Mapping[str, Any]]:
    return [asdict(c) | {"passed": c.passed} for c in checks]


def _missing() -> list[str]:
    return [name for name in EMULATOR if importlib.util.find_spec(name) is None]


def _require_emulator() -> None:
    if missing := _missing():
        raise CompileError(
            f"emulator: found no {', '.join(missing)}, need the extra target: run `pip install 'synth-stage[target]'`"
        )


def _print_checks(title: str, checks: Sequence[Check], figures: Mapping[str, float] | None = None) -> None:
    table = Table("what", "found", "limit", "unit", "", title=title, title_justify="left")
    for c in checks:
        table.add_row(c.name, f"{c.found:.6g}", f"{c.limit:.6g}", c.unit, "ok" if c.passed else "[bold red]FAILED[/]")
    for name, value in (figures or {}).items():
        table.add_row(name, f"{value:.6g}", "", "", "")
    console = Console()
    console.print(table)
    for c in (c for c in checks if c.about and not c.passed):
        console.print(f"{c.name}: {c.about}", highlight=False, markup=False)


def _print_cost(found: costs.Cost) -> None:
    console = Console(width=None if sys.stdout.isatty() else 160)
    for t in costs.tables(found):
        table = Table(*t.columns, title=f"{found.design}: {t.caption}", title_justify="left")
        for row in t.rows:
            table.add_row(*map(escape, row))
        console.print(table)
    console.print("\n".join([costs.NOTE, *found.absent]), highlight=False)


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
