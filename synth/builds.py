"""Build of a design: its tasks side by side, the evidence of all of them, and the report.

    emit ----+--> verify, margins, simulate, study, faults, audit, cost --> evidence, report

A task that raises an error is a failed check in the evidence, and the others go on. Whatever the report shows is
checked here by `verdicts`, from the declaration: no task that a design replaces can lose a check. The key of the report
is made of the keys of its inputs: an edit of the page rebuilds the page alone, an edit of the control law every result
that depends on the law.
"""

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

from synth import __version__, contents, fault_jobs, store, tasks, verdicts
from synth.check import Check, Incomplete
from synth.emit import write
from synth.errors import ContentError
from synth.execute import cross
from synth.jobs import Job
from synth.progress import Progress, silent
from synth.report import first_screen
from synth.report.first_screen import Row
from synth.tasks import Task, attempt
from synth.verify.evidence import Evidence
from synth.workspace import Design

LIBRARY = "cross compiler"


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


def verify(design: Design, whole: bool, say: Progress) -> Evidence:
    """Return the evidence of a design's verification with the margins of its loops.

    Raises Incomplete with the evidence of one where the other raises an error.
    """
    nothing = Evidence(design.name, (), ())
    evidence, failed = attempt(partial(tasks.verification(design, whole).result, say), "verification", nothing)
    loops, lost = attempt(partial(tasks.loops(design).result, say), "margins", None)
    margins = verdicts.margins(design.stage, loops) if design.stage and not lost else []
    evidence = replace(evidence, checks=(*failed, *lost, *margins, *evidence.checks), loops=loops)
    if failed or lost:
        raise Incomplete(evidence, (*failed, *lost))
    return evidence


def build(design: Design) -> Task[Built]:
    """Return the task of the report, from the results of all other tasks.

    It raises Incomplete with what it built where some of them raise errors.
    """
    emit, witnesses, simulate = (
        tasks.emission(design, design.scalar),
        tasks.verification(design, False),
        tasks.simulations(design),
    )
    study, campaign, audit, cost = (
        tasks.brief_study(design),
        tasks.faults(design),
        tasks.audit(design),
        tasks.brief_cost(design),
    )
    margins, further, stage = tasks.loops(design), tasks.report_parts(design), design.stage

    def compute(say: Progress) -> Built:
        failed: list[Check] = []

        def result(part: str, run: Callable[[Progress], Any], otherwise: Any = None) -> Any:
            value, errors = attempt(partial(run, silent), part, otherwise)
            failed.extend(errors)
            return value

        files = emit.result(silent)
        evidence = result("verification", witnesses.result, Evidence(design.name, (), ()))
        loops = result("margins", margins.result)
        runs = result("experiments", partial(tasks.experiments, design), [])
        faults, rows = result("faults", campaign.result), result("audit", audit.result, [])
        table, measured = result("study", study.result), result("cost", cost.result)
        parts = {name: result(name, task.result) for name, task in further.items()}
        if stage is not None and table is not None:
            table = result("limits of the study", lambda _: verdicts.with_limits(stage, table), table)
        made = verdicts.of_build(stage, loops, table, faults, rows, measured)
        evidence = replace(evidence, loops=loops, faults=faults, study=table, verdicts=made)
        say("report")
        draw = partial(design.report, files, evidence, runs, rows, measured, **({"parts": parts} if parts else {}))
        page, lost = attempt(draw, "report", "")
        failed += lost
        rows_shown = verdicts.requirements(failed, evidence, runs)
        checks = tuple(check for row in rows_shown for check in row.checks)
        page = first_screen.put(page or _page_of_checks(design.name, checks), rows_shown, version(design))
        built = Built(page, replace(evidence, checks=checks).document(), rows_shown)
        if failed:
            raise Incomplete(built, failed)  # which is not cached
        return built

    try:
        inputs: list[Task[Any]] = [
            emit,
            witnesses,
            margins,
            *simulate.values(),
            study,
            campaign,
            audit,
            cost,
            *further.values(),
        ]
        keys = [task.key() for task in inputs]
    except ContentError:  # the report has no key where one of its inputs has none
        return Task("report", compute, (design.report, object()))
    limits = (stage.study, stage.require, stage.faults) if stage else None
    made_by = (verdicts.of_build, verdicts.requirements, first_screen.put, __version__)
    return Task("report", compute, (design.report, *made_by, limits, *keys))


def _page_of_checks(name: str, checks: Sequence[Check]) -> str:
    from synth.report import template  # matplotlib takes longer to import than all else together

    return template.of_checks(name, checks)


def version(design: Design) -> str:
    """Return the versions of the toolkit and of the sources of a design: a digest of what its results follow from."""
    try:
        sources = contents.digest(design)[:12]
    except ContentError:
        sources = "without a digest, since they cannot be read"
    return f"synth {__version__}, sources {sources}"


def build_jobs(designs: Sequence[Design], root: Path) -> list[Job]:
    """Return the jobs that build designs; the last of each has the design's name and returns a Built.

    The C is written to `root`/generated_c as soon as it is emitted.
    """
    library = Job(LIBRARY, LIBRARY, lambda say: cross.prepare("cortex-m4f"))
    return [library, *(job for design in designs for job in _build_jobs(design, root))]


def _build_jobs(design: Design, root: Path) -> list[Job]:
    name, whole = design.name, build(design)

    def save(say: Progress) -> None:
        for folder, files in tasks.emission(design, design.scalar).result(say).items():
            write.save(files.files, root / "generated_c" / folder)

    try:
        if store.holds(whole.key()):
            return [Job(f"{name} emit", name, save), Job(name, name, partial(_whole, whole), (f"{name} emit",))]
    except ContentError:
        pass
    first = f"{name} emit"
    parts = {f"simulate {part}": task for part, task in tasks.simulations(design).items()}
    each: tuple[tuple[str, Task[Any], tuple[str, ...]], ...] = (
        *((what, task, (first,)) for what, task in parts.items()),
        ("study", tasks.brief_study(design), (first, *(f"{name} {what}" for what in parts))),
        ("verify", tasks.verification(design, False), (first,)),
        ("margins", tasks.loops(design), (first,)),
        ("cost", tasks.brief_cost(design), (first, LIBRARY)),
        ("audit", tasks.audit(design), (first,)),
        *((f"report {part}", task, (first, f"{name} verify")) for part, task in tasks.report_parts(design).items()),
    )
    jobs = [Job(f"{name} {what}", name, task.result, after) for what, task, after in each]
    if fault_jobs.closes_loop(design):
        jobs += fault_jobs.jobs(design, fault_jobs.basic(design), (first,))
    jobs = [replace(job, run=_in_the_cache(job.run)) for job in jobs]
    return [Job(first, name, save), *jobs, Job(name, name, partial(_whole, whole), tuple(job.name for job in jobs))]


def _in_the_cache(run: Callable[[Progress], Any]) -> Callable[[Progress], None]:
    """Return a function that leaves a result in the cache, where the last job finds it.

    An error is not cached: the last job computes that part again and makes it a failed check.
    """

    def compute(say: Progress) -> None:
        with suppress(Exception):
            run(say)

    return compute


def _whole(task: Task[Built], say: Progress) -> Built:
    """Return what a build results in, with the failed checks of parts that raised errors."""
    try:
        return task.result(say)
    except Incomplete as incomplete:
        built: Built = incomplete.value
        return built
