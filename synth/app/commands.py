"""The commands of the command line, for the designs of the workspace in the current folder, in parallel.

Each prints tables, or with `as_json` one JSON document, and returns the exit status: 0 passed, 1 a check failed, 2 a
design has no result. A terminal shows progress as bars; elsewhere it is written as lines, to stderr with `as_json`.

Project template (`synth new`): a one-axis levitator with law, reference and experiments, as a start for a stage.

Outside a workspace it makes one, with README, .gitignore, settings of pytest and continuous integration. In the root
of a workspace it adds the stage to those present.
"""

import keyword
import sys
from collections.abc import Callable, Mapping, Sequence
from contextlib import nullcontext
from dataclasses import asdict, dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import jinja2
import numpy as np

from synth import show, signals
from synth.analyse.loops.robustness import ClosedLoop, Survey
from synth.app import builds, fault_jobs, standard_tasks, tables, tasks, verdicts, workspace
from synth.app.tables import Failed, finish, run_jobs, successful, writer
from synth.app.tasks import attempt
from synth.base import contents, progress, store
from synth.base.jobs import Job
from synth.base.progress import Progress, silent
from synth.check import Check
from synth.declare.stage import Stage
from synth.emit import write
from synth.emit.c import manifest
from synth.emit.proof import word_length
from synth.errors import DesignError
from synth.report import first_screen
from synth.report.audit import Row
from synth.simulate.experiments import Experiment
from synth.simulate.faults.fault_table import Campaign
from synth.verify import standard
from synth.verify.cost import Cost
from synth.verify.proofs import prove as proofs
from synth.verify.suite import Evidence

STAGE = {
    "model.py.j2": "models/{name}.py",
    "control.py.j2": "designs/{name}/control.py",
    "reference.py.j2": "designs/{name}/reference.py",
    "design.py.j2": "designs/{name}/design.py",
    "test_design.py.j2": "tests/test_{name}.py",
}
WORKSPACE = {
    "README.md.j2": "README.md",
    "gitignore.j2": ".gitignore",
    "pytest.ini.j2": "pytest.ini",
    "ci.yml.j2": ".github/workflows/ci.yml",
}
RESERVED = ("designs", "models", "synth", "test", "tests")  # a model of that name would hide the module


def create(root: Path, name: str) -> tuple[Path, tuple[Path, ...]]:
    """Write the files of a new stage; return the root of its workspace and the files, relative to it.

    Raises SignalError for a name that C does not allow, and DesignError for one that Python does not allow or where a
    file exists already; then nothing is written.
    """
    _check_name(name)
    in_workspace = (root / "designs").is_dir()
    folder, sources = (root, STAGE) if in_workspace else (root / name, WORKSPACE | STAGE)
    files = _render(sources, name)
    if present := [path for path in files if (folder / path).exists()]:
        raise DesignError(f"{folder / present[0]} exists already, and nothing was written: choose another name")
    try:
        for path, text in files.items():
            (folder / path).parent.mkdir(parents=True, exist_ok=True)
            store.replace_text(folder / path, text)
    except BaseException:
        for path in files:
            (folder / path).unlink(missing_ok=True)
        raise
    return folder, tuple(files)


def _check_name(name: str) -> None:
    signals.identifier("stage", name)
    if name != name.lower() or keyword.iskeyword(name) or name in RESERVED:
        raise DesignError(
            f"stage '{name}' cannot be the name of a module: use small letters, and none of Python's words or of "
            f"{', '.join(RESERVED)}, such as my_stage"
        )


def _render(sources: Mapping[str, str], name: str) -> dict[Path, str]:
    loader = jinja2.PackageLoader("synth.app", "new_stage")
    environment = jinja2.Environment(loader=loader, undefined=jinja2.StrictUndefined, keep_trailing_newline=True)
    return {Path(path.format(name=name)): environment.get_template(t).render(name=name) for t, path in sources.items()}


SCALARS: dict[str, type[np.floating]] = {"float32": np.float32, "float64": np.float64}
CORES: dict[str, type[np.floating]] = {"cortex-m4f": np.float32, "cortex-m7": np.float64}
SAFE_OUTPUT = "safe_output.json"  # in the folder of a design
PROOFS = 5  # lines that `prove` reports for each folder of C
Names = Sequence[str]


def _run(jobs: Sequence[Job], designs: Sequence[Stage], as_json: bool, fresh: bool) -> dict[str, Any]:
    """Run jobs in parallel; return for each design the value of the job of its name, or a Failed."""
    outcomes = run_jobs(jobs, as_json, fresh)
    return {d.name: Failed(d.name, o.error) if (o := outcomes[d.name]).error else o.value for d in designs}


def _for_each_design(
    names: Names, as_json: bool, fresh: bool, work: Callable[[Stage, Progress], Any]
) -> dict[str, Any]:
    """Do the same work on each stage, in parallel; return the results by name."""
    designs = workspace.designs(Path.cwd(), names)
    jobs = [Job(d.name, d.name, partial(work, d)) for d in designs]
    return _run(jobs, designs, as_json, fresh)


def build(names: Names, as_json: bool, fresh: bool) -> int:
    """Regenerate gains and C, verify, simulate, audit, and write the report of each stage."""
    root, documents, screens = Path.cwd(), [], dict[str, Sequence[first_screen.Row]]()
    results = dict[str, Any]()
    # Stored results count as missing also for the choice of the jobs.
    with store.fresh_run() if fresh else nullcontext():
        keys = {name: builds.source_key(root, name) for name in workspace.design_names(root, names)}
        for name, key in keys.items():
            complete: builds.Complete | None = store.find(key)
            if complete is not None:
                builds.save(complete.folders, root)
                results[name] = complete.built
        if changed := [name for name in keys if name not in results]:
            designs = workspace.designs(root, changed)
            results |= _run(builds.build_jobs(designs, root, keys), designs, as_json, fresh)
    for name, built in ((name, results[name]) for name in keys):
        if isinstance(built, Failed):
            continue
        reports = {f"{name}.html": built.page, f"{name}.evidence.json": contents.dumps(built.evidence) + "\n"}
        write.save(reports, root / "reports")
        failed = [c.document() for c in built.checks if not c.passed]
        documents.append({"design": name, "checks": len(built.checks), "failed": failed})
        screens[name] = built.rows
    if not as_json:
        tables.print_first_screen(screens)
    for name, rows in screens.items():
        writer(as_json)(name, f"{first_screen.headline(rows)}; report in reports/{name}.html")
    return finish(as_json, documents, results, any(document["failed"] for document in documents))


def verify(names: Names, as_json: bool, fresh: bool, core: str | None) -> int:
    """Compare the witnesses on this machine, or the machine code of a `core` with that of this machine."""
    results = _for_each_design(names, as_json, fresh, partial(_on_target, core) if core else _on_host)
    documents = [r.document for r in successful(results)]
    for name, verified in results.items():
        if not as_json and isinstance(verified, Verified):
            tables.print_checks(name, verified.checks, verified.figures, verified.notes)
            for shown in verified.disagreements:
                tables.print_sheet(shown.sheet())
    return finish(as_json, documents, results, not all(c.passed for r in successful(results) for c in r.checks))


@dataclass(frozen=True)
class Verified:
    """A verification: the document, the checks, measured values without a limit, notes and disagreements below them."""

    document: Mapping[str, Any]
    checks: Sequence[Check]
    figures: Mapping[str, float]
    notes: Sequence[str] = ()
    disagreements: Sequence[show.Shown] = ()


def _on_host(stage: Stage, report: Progress) -> Verified:
    evidence, _ = attempt(partial(builds.verify, stage, True, report), "verification", Evidence(stage.name, (), ()))
    return Verified(evidence.document(), evidence.checks, {}, (), evidence.disagreements)


def verify_board(name: str, port: str, baud: int, as_json: bool) -> int:
    """Replay the vectors of a design on a board at the end of a serial line, bit for bit.

    Raises SynthError and SignalError as `serial_replay.replay`.
    """
    from synth.export import project, serial_replay

    (stage,) = workspace.designs(Path.cwd(), [name])
    report = partial(writer(as_json), name)
    vectors = project.replay_vectors(stage, tasks.emission(stage, stage.scalar).result(report))
    with serial_replay.connect(port, baud) as line:
        checks, note = serial_replay.replay(line, name, vectors, report)
    if not as_json:
        tables.print_checks(name, checks, {}, (note,))
    document = {"design": name, "serial": port, "checks": _checks(checks), "cycles": note}
    return finish(as_json, [document], {}, not all(c.passed for c in checks))


def _on_target(core: str, stage: Stage, report: Progress) -> Verified:
    """Replay on the host and on a core: the document, the checks, and the drift with contraction as measured values."""
    from synth.execute import cross, host
    from synth.verify import replays

    folders = dict(tasks.emission(stage, CORES[core]).result(report))
    emitted = folders.pop(stage.name)
    inputs = standard_tasks.replay_inputs(stage, host.load(emitted.files, emitted.manifest))
    checks = [*replays.verify(emitted, inputs, core, report)]
    for folder, companion in folders.items():
        recorded, count = manifest.inputs(companion.files["vectors.json"]), _in_folder(report, folder, stage.name)
        checks += [replace(c, name=f"{folder}, {c.name}") for c in replays.verify(companion, recorded, core, count)]
    document: dict[str, Any] = {"design": stage.name, "target": core, "checks": _checks(checks), "drift": None}
    if "gcc" not in cross.available():
        note = "drift with contraction: arm-none-eabi-gcc is not installed, not measured"
        report(note)
        return Verified(document, checks, {}, (note,))
    floor = standard.stimuli_of(stage).floor
    drift = replays.drift(emitted, inputs, core, floor)
    least = f"{floor:g}" if isinstance(floor, float) else "floor"
    what = f"drift with contraction over {drift.steps} steps, worst in {drift.output}, of max({least}, |i|)"
    figures = {what: drift.worst, "fault words that differ": float(drift.faults)}
    return Verified(document | {"drift": asdict(drift)}, checks, figures)


def cost(names: Names, as_json: bool, fresh: bool) -> int:
    """Measure the cost of a step on a Cortex-M4F, beside CasADi's C: instructions, bytes, decisions. No verdicts."""

    def measure(stage: Stage, report: Progress) -> list[Cost]:
        return [tasks.whole_cost(stage).result(report), *tasks.companion_costs(stage).result(report)]

    results = _for_each_design(names, as_json, fresh, measure)
    costs = [cost for each in successful(results) for cost in each]
    for measured in costs if not as_json else ():
        tables.print_cost(measured)
    return finish(as_json, [measured.document() for measured in costs], results)


def prove(names: Names, as_json: bool, fresh: bool, whole: bool) -> int:
    """Prove the emitted C, as deep as the proofs go or a subset."""

    def run_proofs(stage: Stage, report: Progress) -> dict[str, list[Check]]:
        emitted = tasks.emission(stage, stage.scalar).result(report)
        count = progress.numbered(report, PROOFS * len(emitted))
        return {
            folder: list(proofs.prove(e.files, e.manifest, whole, _in_folder(count, folder, stage.name)))
            for folder, e in emitted.items()
        }

    results = _for_each_design(names, as_json, fresh, run_proofs)
    folders = {folder: checks for each in successful(results) for folder, checks in each.items()}
    if not as_json:
        for folder, checks in folders.items():
            tables.print_checks(folder, checks)
    documents = [{"design": folder, "whole": whole, "checks": _checks(checks)} for folder, checks in folders.items()]
    return finish(as_json, documents, results, not all(c.passed for checks in folders.values() for c in checks))


def _in_folder(report: Progress, folder: str, design: str) -> Progress:
    """Return a report with the folder of the C in each line, except for the folder that has the design's name."""
    return report if folder == design else lambda line: report(f"{folder}: {line}")


@dataclass(frozen=True)
class Surveyed:
    """The closed loops of a design, its open loops with their margins, and the checks of these."""

    design: str
    closed: Sequence[ClosedLoop]
    loops: Survey | None
    checks: Sequence[Check]

    def document(self) -> dict[str, Any]:
        """Return the poles of each case and the least margins, for JSON."""
        cases = [
            {"at": c.place, "stable": c.is_stable, "reason": c.reason, "poles": [[z.real, z.imag] for z in c.poles]}
            for c in self.closed
        ]
        return {"design": self.design, "closed_loops": cases, "checks": _checks(self.checks)}


def margins(names: Names, as_json: bool, fresh: bool) -> int:
    """Tell of each design whether its loops are stable, then their poles and margins; no reference is needed."""

    def survey(stage: Stage, report: Progress) -> Surveyed:
        closed = tasks.stability(stage).result(silent)
        report(verdicts.stability(closed))
        loops, failed = attempt(partial(tasks.loops(stage).result, report), "margins", None)
        return Surveyed(stage.name, closed, loops, [*failed, *verdicts.margins(stage, loops)])

    results = _for_each_design(names, as_json, fresh, survey)
    for s in successful(results) if not as_json else ():
        tables.print_margins(s.design, s.closed, s.loops, s.checks)
    documents = [s.document() for s in successful(results)]
    return finish(as_json, documents, results, not all(c.passed for s in successful(results) for c in s.checks))


def simulate(names: Names, as_json: bool, fresh: bool) -> int:
    """Run each design's experiments on the full plant with the compiled C in the loop."""

    def run_experiments(stage: Stage, report: Progress) -> list[Verified]:
        closed, lost = attempt(partial(tasks.stability(stage).result, silent), "stability", list[ClosedLoop]())
        if not all(c.is_stable for c in closed):
            report(verdicts.stability(closed))
        runs, raised = attempt(partial(tasks.experiments(stage).result, report), "experiments", list[Experiment]())
        failed = [*lost, *raised]
        errors = {"name": "errors", "title": "Errors", "figures": {}, "checks": _checks(failed)}
        verified = [Verified(_experiment(e), e.checks, e.figures) for e in runs]
        return [*verified, *([Verified(errors, failed, {})] if failed else [])]

    results = _for_each_design(names, as_json, fresh, run_experiments)
    documents, every = [], [v for each in successful(results) for v in each]
    for name, each in results.items():
        if not isinstance(each, Failed):
            documents.append({"design": name, "experiments": [v.document for v in each]})
    if not as_json:
        for v in every:
            tables.print_checks(v.document["title"], v.checks, v.figures)
    return finish(as_json, documents, results, not all(c.passed for v in every for c in v.checks))


def faults(names: Names, as_json: bool, fresh: bool, plants: int, every: bool, sweep: bool = False) -> int:
    """Inject every fault of the interface of each design into its closed loop, and measure what the machine does."""
    results = _on_machine(names, as_json, fresh, partial(fault_jobs.parts, plants=plants, sweep=sweep), _campaign)
    pairs = successful(results)
    for campaign, errors in pairs if not as_json else ():
        if campaign is not None:
            tables.print_campaign(campaign, every)
        if errors:
            tables.print_checks("parts of the campaign that raised errors", errors)
    failed = any(errors or not all(check.passed for check in campaign.checks) for campaign, errors in pairs)
    documents = [(c.document() if c else {}) | ({"errors": _checks(errors)} if errors else {}) for c, errors in pairs]
    return finish(as_json, documents, results, failed)


def _campaign(*arguments: Any) -> tuple[Campaign | None, list[Check]]:
    """Return the campaign of a stage, and a failed check for each part that raised an error."""
    return attempt(partial(fault_jobs.result, *arguments), "faults", None)


def measure_safe_output(names: Names, as_json: bool, fresh: bool, plants: int) -> int:
    """Measure what each machine does after the latch, and write designs/<name>/safe_output.json."""
    results = _on_machine(names, as_json, fresh, partial(fault_jobs.losses, plants=plants), fault_jobs.safe_output)
    for name, measured in results.items():
        if isinstance(measured, Failed):
            continue
        measured.write(Path.cwd() / "designs" / name / SAFE_OUTPUT)
        writer(as_json)(name, measured.text())
    return finish(as_json, [asdict(measured) for measured in successful(results)], results)


def _on_machine(
    names: Names,
    as_json: bool,
    fresh: bool,
    parts: Callable[[Stage], Sequence[fault_jobs.Part]],
    result: Callable[..., Any],
) -> dict[str, Any]:
    """Run parts of the fault campaign of each design that closes a loop; return the results by name."""
    designs = workspace.designs(Path.cwd(), names)
    closed = {d.name: (d, parts(d)) for d in designs if fault_jobs.closes_loop(d) or d.name in names}
    jobs = {name: fault_jobs.jobs(*each) for name, each in closed.items()}
    outcomes = run_jobs([job for each in jobs.values() for job in each], as_json, fresh)
    results: dict[str, Any] = {}
    for name, each in closed.items():
        error = next((e for job in jobs[name] if (e := outcomes[job.name].error)), "")
        results[name] = Failed(name, error) if error else result(*each, outcomes)
    return results


def audit(names: Names, as_json: bool, fresh: bool) -> int:
    """Recompute every published value: published, recomputed, verdict, why. Only an error fails the command."""

    def recompute(stage: Stage, report: Progress) -> tuple[list[Row], list[Check]]:
        return attempt(partial(tasks.audit(stage).result, report), "audit", [])

    results = _for_each_design(names, as_json, fresh, recompute)
    rows, failed = ([each for pair in successful(results) for each in pair[k]] for k in (0, 1))
    if not as_json:
        tables.print_rows(rows)
        if failed:
            tables.print_checks("audits that raised errors", failed)
    return finish(as_json, [*(row.document() for row in rows), *_checks(failed)], results, bool(failed))


def emit(name: str, out: Path, scalar: str, fresh: bool, by_casadi: bool = False) -> int:
    """Write a design's C, header, manifest, gains and vectors to a folder, in a scalar type.

    Print their paths, and what the scalar type does to the linear parts of the law. With `by_casadi` the .c is that of
    CasADi's own code generator.
    """
    (stage,) = workspace.designs(Path.cwd(), [name])
    say = partial(writer(False), name)
    with store.fresh_run() if fresh else nullcontext():
        emitted = tasks.emission(stage, SCALARS[scalar]).result(say)
    for folder, files in (standard_tasks.with_casadi_c(stage, emitted) if by_casadi else emitted).items():
        write.save(files.files, out / folder)
        say(f"{', '.join(files.files)} in {out / folder}")
        for line in word_length.summary(files.parts, scalar):
            say(line)
    return 0


def export(name: str, target: str, out: Path, fresh: bool) -> int:
    """Write a project that runs the emitted step of a design on a target, and print what to do next.

    Raises as `project.project`.
    """
    from synth.export import project

    project.require_target(target)
    (stage,) = workspace.designs(Path.cwd(), [name])
    say = partial(writer(False), name)
    with store.fresh_run() if fresh else nullcontext():
        emitted = tasks.emission(stage, stage.scalar).result(say)
    for kept in project.project(stage, emitted, target).save(out):
        say(f"{out / kept} is yours and stays as it is")
    say(f"a project for {target} in {out}; next: make -C {out} rehearsal")
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
    return [c.document() for c in checks]
