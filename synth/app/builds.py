"""Build of a stage: its tasks side by side, the evidence of all of them, and the report.

    emit ----+--> verify, margins, simulate, study, faults, audit, cost --> evidence, report

A task that raises an error is a failed check in the evidence, and the others go on. Whatever the report shows is
checked here by `verdicts`, from the declaration: no task that a design replaces can lose a check. The key of the report
is made of the keys of its inputs: an edit of the page rebuilds the page alone, an edit of the control law every result
that depends on the law.
"""

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

from synth import __version__
from synth.app import fault_jobs, tasks, verdicts
from synth.app.tasks import Task, attempt
from synth.base import cache, contents, slices, store
from synth.base.jobs import Job
from synth.base.progress import Progress, silent
from synth.check import Check, Incomplete
from synth.declare.stage import Stage
from synth.emit import write
from synth.errors import ContentError
from synth.report import first_screen
from synth.report.first_screen import Row
from synth.verify.suite import Evidence

# Folders of a workspace that no build reads: what it writes, and tests and documents.
NOT_READ = frozenset({"generated_c", "reports", "build", "dist", "tests", "docs"})


@dataclass(frozen=True)
class Built:
    """The results of a build: the report, the evidence as a document, and the rows of the first screen."""

    page: str
    evidence: Any
    rows: tuple[Row, ...]

    @property
    def checks(self) -> tuple[Check, ...]:
        """All checks of the build."""
        return tuple(check for row in self.rows for check in row.checks)


@dataclass(frozen=True)
class Complete:
    """A build in which no part raised an error: the texts of generated_c by folder, and the result."""

    folders: Mapping[str, Mapping[str, str]]
    built: Built


def source_key(root: Path, name: str) -> str:
    """Return the key of a complete build of a stage: its name, all sources of toolkit and workspace, the compilers.

    No design is imported for it. It changes with any source, also of another design; the parts have keys of their own.
    """
    tops = [slices.TOOLKIT, *(p for p in sorted(root.iterdir()) if p.name not in NOT_READ and p.name[0] != ".")]
    tops = [top for top in tops if top != store.folder()]
    files = [file for top in tops for file in ([top] if top.is_file() else sorted(top.rglob("*")))]
    read = [f for f in files if f.is_file() and "__pycache__" not in f.parts]
    texts = [(str(f.relative_to(root if root in f.parents else slices.TOOLKIT)), f.read_bytes()) for f in read]
    return contents.digest(cache.environment(), tasks.compilers(), name, texts)


def verify(stage: Stage, whole: bool, say: Progress) -> Evidence:
    """Return the evidence of a design's verification with the margins of its loops.

    Raises Incomplete with the evidence of one where the other raises an error.
    """
    nothing = Evidence(stage.name, (), ())
    evidence, failed = attempt(partial(tasks.verification(stage, whole).result, say), "verification", nothing)
    loops, lost = attempt(partial(tasks.loops(stage).result, say), "margins", None)
    margins = verdicts.margins(stage, loops) if not lost else []
    evidence = replace(evidence, checks=(*failed, *lost, *margins, *evidence.checks), loops=loops)
    if failed or lost:
        raise Incomplete(evidence, (*failed, *lost))
    return evidence


def build(stage: Stage) -> Task[Built]:
    """Return the task of the report, from the results of all other tasks.

    It raises Incomplete with what it built where some of them raise errors.
    """
    emit, witnesses, margins = (
        tasks.emission(stage, stage.scalar),
        tasks.verification(stage, False),
        tasks.loops(stage),
    )
    simulate, study, campaign = tasks.experiments(stage), tasks.brief_study(stage), tasks.faults(stage)
    audit, cost, on_bench = tasks.audit(stage), tasks.brief_cost(stage), tasks.on_bench(stage)

    def compute(say: Progress) -> Built:
        failed: list[Check] = []

        def result(part: str, run: Callable[[Progress], Any], otherwise: Any = None) -> Any:
            value, errors = attempt(partial(run, silent), part, otherwise)
            failed.extend(errors)
            return value

        files = emit.result(silent)
        evidence = result("verification", witnesses.result, Evidence(stage.name, (), ()))
        loops = result("margins", margins.result)
        runs = result("experiments", simulate.result, [])
        faults, rows = result("faults", campaign.result), result("audit", audit.result, [])
        table, measured = result("study", study.result), result("cost", cost.result)
        if table is not None:
            table = result("limits of the study", lambda _: verdicts.with_limits(stage, table), table)
        bench = result("margins on the bench", on_bench.result)
        made = verdicts.of_build(stage, loops, table, faults, rows, measured)
        evidence = replace(evidence, loops=loops, faults=faults, study=table, bench=bench, verdicts=made)
        say("report")
        draw = partial(_draw, stage, files, evidence, runs, rows, measured)
        page, lost = attempt(draw, "report", "")
        failed += lost
        rows_shown = verdicts.requirements(failed, evidence, runs)
        checks = tuple(check for row in rows_shown for check in row.checks)
        page = first_screen.put(page or _page_of_checks(stage.name, checks), rows_shown, version(stage))
        built = Built(page, replace(evidence, checks=checks).document(), rows_shown)
        if failed:
            raise Incomplete(built, failed)  # which is not cached
        return built

    try:
        inputs: list[Task[Any]] = [emit, witnesses, margins, simulate, study, campaign, audit, cost, on_bench]
        keys = [task.key() for task in inputs]
    except ContentError:  # the report has no key where one of its inputs has none
        return Task("report", compute, (_draw, object()))
    limits = (stage.study, stage.require, stage.faults)
    made_by = (stage.contents or tasks.nothing, verdicts.of_build, verdicts.requirements, first_screen.put, __version__)
    return Task("report", compute, (_draw, *made_by, limits, *keys))


def _draw(stage: Stage, files: Any, evidence: Evidence, runs: Any, rows: Any, cost: Any) -> str:
    from synth.report import template  # matplotlib takes longer to import than all else together

    return template.report(stage, template.Results(files, evidence, runs, rows, cost))


def _page_of_checks(name: str, checks: Sequence[Check]) -> str:
    from synth.report import template  # matplotlib takes longer to import than all else together

    return template.of_checks(name, checks)


def version(stage: Stage) -> str:
    """Return the versions of the toolkit and of the sources of a stage: a digest of what its results follow from."""
    try:
        sources = contents.digest(stage)[:12]
    except ContentError:
        sources = "without a digest, since they cannot be read"
    return f"synth {__version__}, sources {sources}"


def save(folders: Mapping[str, Mapping[str, str]], root: Path) -> None:
    """Write the files of each folder of generated_c."""
    for folder, texts in folders.items():
        write.save(texts, root / "generated_c" / folder)


def build_jobs(designs: Sequence[Stage], root: Path, keys: Mapping[str, str]) -> list[Job]:
    """Return the jobs that build designs; the last of each has the design's name and returns a Built.

    The C is written to `root`/generated_c as soon as it is emitted. A complete build is stored under the key of the
    design in `keys`, from `source_key`.
    """
    return [job for stage in designs for job in _build_jobs(stage, root, keys[stage.name])]


def _build_jobs(stage: Stage, root: Path, key: str) -> list[Job]:
    name = stage.name

    def emit(say: Progress) -> Mapping[str, Mapping[str, str]]:
        folders = {folder: code.files for folder, code in tasks.emission(stage, stage.scalar).result(say).items()}
        save(folders, root)
        return folders

    def finish(say: Progress) -> Built:
        try:
            return store.fetch(key, lambda: Complete(emit(silent), build(stage).result(say))).built
        except Incomplete as incomplete:
            built: Built = incomplete.value
            return built

    first = f"{name} emit"
    each: tuple[tuple[str, Task[Any], tuple[str, ...]], ...] = (
        ("simulate experiments", tasks.experiments(stage), (first,)),
        ("study", tasks.brief_study(stage), (first, f"{name} simulate experiments")),
        ("verify", tasks.verification(stage, False), (first,)),
        ("margins", tasks.loops(stage), (first,)),
        ("cost", tasks.brief_cost(stage), (first,)),
        ("margins on the bench", tasks.on_bench(stage), (first,)),
        ("audit", tasks.audit(stage), (first,)),
    )
    for _, task, _ in each:
        with suppress(ContentError):
            task.key()  # in this process: what the keys of all are made of is read once, and the others begin with it
    jobs = [Job(f"{name} {what}", name, task.result, after) for what, task, after in each]
    if fault_jobs.closes_loop(stage):
        jobs += fault_jobs.jobs(stage, fault_jobs.basic(stage), (first,))
    jobs = [replace(job, run=_in_the_cache(job.run)) for job in jobs]
    return [Job(first, name, emit), *jobs, Job(name, name, finish, tuple(job.name for job in jobs))]


def _in_the_cache(run: Callable[[Progress], Any]) -> Callable[[Progress], None]:
    """Return a function that leaves a result in the cache, where the last job finds it.

    An error is not cached: the last job computes that part again and makes it a failed check.
    """

    def compute(say: Progress) -> None:
        with suppress(Exception):
            run(say)

    return compute
