"""What the commands of the command line do, for the designs of the workspace in the current folder, side by side.

Each prints tables, or with `as_json` one JSON document with progress on stderr, and returns the exit status: 0 well,
1 a check failed, 2 a design came to no result.
"""

import json
import math
import sys
from collections.abc import Callable, Mapping, Sequence
from contextlib import nullcontext
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console
from rich.markup import escape

from synth import store, tables, tasks, workspace
from synth.check import Check
from synth.emit import write
from synth.errors import CompileError
from synth.jobs import Job, run
from synth.new import create
from synth.simulate.experiment import Experiment
from synth.verify import prove as proofs

SCALARS: dict[str, type[np.floating]] = {"float32": np.float32, "float64": np.float64}
CORES: dict[str, type[np.floating]] = {"cortex-m4f": np.float32, "cortex-m7": np.float64}
Names = Sequence[str]


def _say(as_json: bool) -> Callable[[str, str], None]:
    console = Console(stderr=as_json)
    return lambda name, what: console.print(f"{name}: {what}", highlight=False, markup=False)


def _run(jobs: Sequence[Job], designs: Sequence[workspace.Design], as_json: bool, fresh: bool) -> dict[str, Any]:
    """Run jobs side by side; return what those called like a design returned, or their error as a document."""
    with store.fresh_run() if fresh else nullcontext():
        outcomes = run(jobs, _say(as_json))
    console = Console(stderr=True)
    for name, outcome in outcomes.items():
        if outcome.error:
            console.print(f"[bold red]error:[/] {escape(f'{name}: {outcome.error}')}", highlight=False, soft_wrap=True)
    store.trim()
    return {d.name: Failed(d.name, o.error) if (o := outcomes[d.name]).error else o.value for d in designs}


def _each(
    names: Names, as_json: bool, fresh: bool, work: Callable[[workspace.Design, workspace.Told], Any]
) -> dict[str, Any]:
    """Do one thing with each design, side by side; return what came of it by name."""
    designs = workspace.designs(Path.cwd(), names)
    jobs = [Job(d.name, d.name, lambda say, d=d: work(d, say)) for d in designs]  # type: ignore[misc]
    return _run(jobs, designs, as_json, fresh)


def build(names: Names, as_json: bool, fresh: bool) -> int:
    """Regenerate gains and C, verify, simulate, audit, and write the report of each design."""
    root, told = Path.cwd(), []
    designs = workspace.designs(root, names)
    results = _run(tasks.build_jobs(designs, root), designs, as_json, fresh)
    for name, built in results.items():
        if isinstance(built, Failed):
            continue
        reports = {f"{name}.html": built.page, f"{name}.evidence.json": _json(built.evidence) + "\n"}
        write.save(reports, root / "reports")
        bad = [c for c in built.checks if not c.passed]
        _say(as_json)(name, f"{len(built.checks)} checks, {len(bad)} failed; report in reports/{name}.html")
        told.append({"design": name, "checks": len(built.checks), "failed": [asdict(c) for c in bad]})
    return _finish(as_json, told, results, any(document["failed"] for document in told))


def verify(names: Names, as_json: bool, fresh: bool, core: str | None) -> int:
    """Compare the witnesses on this machine, or the machine code of a `core` with this machine's."""
    if core is not None:
        _require_emulator()
    results = _each(names, as_json, fresh, partial(_on_target, core) if core else _on_host)
    documents = [r.document for r in _good(results)]
    for name, verified in results.items():
        if not as_json and isinstance(verified, Verified):
            tables.print_checks(name, verified.checks, verified.figures)
    return _finish(as_json, documents, results, not all(c.passed for r in _good(results) for c in r.checks))


@dataclass(frozen=True)
class Failed:
    """The name of a design that came to no result, and why."""

    design: str
    error: str


@dataclass(frozen=True)
class Verified:
    """A verification: the document, the checks, and figures beside them."""

    document: Mapping[str, Any]
    checks: Sequence[Check]
    figures: Mapping[str, float]


def _good(results: Mapping[str, Any]) -> list[Any]:
    return [result for result in results.values() if not isinstance(result, Failed)]


def _on_host(design: workspace.Design, say: workspace.Told) -> Verified:
    evidence = tasks.verification(design, True).result(say)
    return Verified(evidence.document(), evidence.checks, {})


def _on_target(core: str, design: workspace.Design, say: workspace.Told) -> Verified:
    """Replay on the host and on a core: the document, the checks, and the drift with contraction as figures."""
    from synth.execute import cross, host
    from synth.verify import on_target

    emitted = tasks.emission(design, CORES[core]).result(say)[design.name]
    inputs = design.bench.replay(host.load(emitted.files, emitted.manifest))
    checks = on_target.verify(emitted, inputs, core, say)
    document: dict[str, Any] = {"design": design.name, "target": core, "checks": _checks(checks), "drift": None}
    if "gcc" not in cross.available():
        say("drift with contraction: arm-none-eabi-gcc is not installed, not measured")
        return Verified(document, checks, {})
    drift = on_target.drift(emitted, inputs, core, design.bench.floor)
    floor = design.bench.floor
    least = f"{floor:g}" if isinstance(floor, float) else "floor"
    what = f"drift with contraction over {drift.steps} steps, worst in {drift.output}, of max({least}, |i|)"
    figures = {what: drift.worst, "fault words unlike then": float(drift.faults)}
    return Verified(document | {"drift": asdict(drift)}, checks, figures)


def cost(names: Names, as_json: bool, fresh: bool) -> int:
    """Count what a step costs on a Cortex-M4F, beside CasADi's own C: instructions, bytes, decisions. No verdicts."""
    _require_emulator()
    results = _each(names, as_json, fresh, lambda design, say: tasks.whole_cost(design).result(say))
    for measured in _good(results):
        if not as_json:
            tables.print_cost(measured)
    return _finish(as_json, [measured.document() for measured in _good(results)], results)


def prove(names: Names, as_json: bool, fresh: bool, whole: bool) -> int:
    """Prove the emitted C, as deep as the proofs go or a subset."""

    def proved(design: workspace.Design, say: workspace.Told) -> dict[str, list[Check]]:
        emitted = tasks.emission(design, design.scalar).result(say)
        return {
            folder: list(proofs.prove(e.files, e.manifest, whole, lambda what, folder=folder: say(f"{folder}: {what}")))  # type: ignore[misc]
            for folder, e in emitted.items()
        }

    results = _each(names, as_json, fresh, proved)
    folders = {folder: checks for each in _good(results) for folder, checks in each.items()}
    if not as_json:
        for folder, checks in folders.items():
            tables.print_checks(folder, checks)
    documents = [{"design": folder, "whole": whole, "checks": _checks(checks)} for folder, checks in folders.items()]
    return _finish(as_json, documents, results, not all(c.passed for checks in folders.values() for c in checks))


def simulate(names: Names, as_json: bool, fresh: bool) -> int:
    """Run each design's experiments on the full plant with the compiled C in the loop."""

    def simulated(design: workspace.Design, say: workspace.Told) -> list[Verified]:
        experiments = tasks.simulation(design).result(say)
        return [Verified(_experiment(e), e.checks, e.figures) for e in experiments]

    results = _each(names, as_json, fresh, simulated)
    documents, every = [], [v for each in _good(results) for v in each]
    for name, each in results.items():
        if not isinstance(each, Failed):
            documents.append({"design": name, "experiments": [v.document for v in each]})
    if not as_json:
        for v in every:
            tables.print_checks(v.document["title"], v.checks, v.figures)
    return _finish(as_json, documents, results, not all(c.passed for v in every for c in v.checks))


def audit(names: Names, as_json: bool, fresh: bool) -> int:
    """Recompute every published figure: published, recomputed, verdict, why. No verdict fails the command."""
    results = _each(names, as_json, fresh, lambda design, say: tasks.audit(design).result(say))
    rows = [row for each in _good(results) for row in each]
    if not as_json:
        tables.print_rows(rows)
    return _finish(as_json, [row.document() for row in rows], results)


def emit(name: str, out: Path, scalar: str, fresh: bool) -> int:
    """Write a design's C, header, manifest, gains and vectors to a folder, in a scalar type."""
    (design,) = workspace.designs(Path.cwd(), [name])
    with store.fresh_run() if fresh else nullcontext():
        emitted = tasks.emission(design, SCALARS[scalar]).result(lambda what: None)
    for folder, files in emitted.items():
        write.save(files.files, out / folder)
    return 0


def new(name: str) -> int:
    """Write the files of a new stage below the current folder, and print what to do next."""
    folder, files = create(Path.cwd(), name)
    inside = "" if folder == Path.cwd() else f"cd {name} && "
    for path in files:
        sys.stdout.write(f"{(folder / path).relative_to(Path.cwd())}\n")
    sys.stdout.write(f"Next: {inside}synth build, then open reports/{name}.html\n")
    return 0


def _experiment(e: Experiment) -> Mapping[str, Any]:
    return {"name": e.name, "title": e.title, "figures": dict(e.figures), "checks": _checks(e.checks)}


def _checks(checks: Sequence[Check]) -> list[Mapping[str, Any]]:
    return [asdict(c) | {"passed": c.passed} for c in checks]


def _require_emulator() -> None:
    if missing := tasks.missing():
        raise CompileError(
            f"emulator: found no {', '.join(missing)}, need the extra target: run `pip install 'synth-stage[target]'`"
        )


def _json(document: Any) -> str:
    """Return strict JSON: null for a number that JSON does not have."""
    return json.dumps(_finite(document), indent=1, allow_nan=False)


def _finite(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {k: _finite(v) for k, v in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(v) for v in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _finish(
    as_json: bool, documents: Sequence[Mapping[str, Any]], results: Mapping[str, Any], failed: bool = False
) -> int:
    """Print the documents, errors last; return 2 where a design came to no result, 1 where a check failed."""
    errors = [asdict(result) for result in results.values() if isinstance(result, Failed)]
    if as_json:
        sys.stdout.write(_json([*documents, *errors]) + "\n")
    return 2 if errors else int(failed)
