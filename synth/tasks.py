"""Incremental build: the tasks of a design, cached by content and run in parallel (as `make`, `ninja`).

    emit ----+--> verify, simulate, study, faults, audit, cost --> report

The result of a task has a key: the slice of its function with data files, the arguments and the compilers, and for
the report the keys of its inputs. An edit of the page rebuilds the page alone; an edit of the control law rebuilds
every result that depends on the law.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache as once
from importlib.util import find_spec
from pathlib import Path
from typing import Any, Generic, TypeVar

import numpy as np

from synth import cache, fault_jobs, progress, slices, store, study_runs, workspace
from synth.check import Check
from synth.emit import write
from synth.emit.c import vectors
from synth.emit.write import EmittedCode
from synth.errors import ContentError
from synth.execute import compile as host_compiler
from synth.execute import cross, host
from synth.jobs import Job
from synth.progress import Progress
from synth.report.audit import Row
from synth.simulate.experiment import Experiment
from synth.simulate.fault_rows import Campaign
from synth.simulate.study import StudyTable
from synth.verify.cost import Cost
from synth.verify.evidence import Evidence
from synth.workspace import Design

T = TypeVar("T")

EMULATOR = ("unicorn", "elftools", "capstone")  # packages of the extra `target`
LIBRARY = "cross compiler"


@dataclass(frozen=True, eq=False)
class Task(Generic[T]):
    """A computation for a design; its result is a function of `depends`, functions and values."""

    what: str
    compute: Callable[[Progress], T]
    depends: tuple[Any, ...]

    def key(self) -> str:
        """Return the key of the result; raise ContentError where the source of a function cannot be read."""
        first, *others = self.depends
        data = [slices.digest(d, True) for d in others if callable(d) and not isinstance(d, type)]
        return cache.key(first, compilers(), data, *others, data=True)

    def result(self, say: Progress) -> T:
        """Return the cached result, or compute it; a function without readable source is called each time."""
        try:
            key = self.key()
        except ContentError:
            return self.compute(say)
        if store.holds(key):
            say(f"{self.what}: unchanged")
        return store.fetch(key, lambda: self.compute(say))


@dataclass(frozen=True)
class Built:
    """The results of a build: the report, the evidence with the checks of the experiments as a document, all checks."""

    page: str
    evidence: Any
    checks: tuple[Check, ...]


def emission(design: Design, scalar: type[np.floating]) -> Task[dict[str, EmittedCode]]:
    """Return the task of emitting the files of generated_c/<name>/, by folder."""

    def compute(say: Progress) -> dict[str, EmittedCode]:
        say("gains and C")
        return dict(workspace.emitted_files(design, scalar))

    return Task("gains and C", compute, (design.emit, scalar))


def verification(design: Design, whole: bool) -> Task[Evidence]:
    """Return the task of comparing the witnesses, over the `whole` replay or a short one."""
    return Task("verification", lambda say: design.verify(say, whole), (design.verify, whole))


def simulations(design: Design) -> dict[str, Task[list[Experiment]]]:
    """Return the tasks of running the parts of the experiments, by name."""

    def task(part: str, run: Callable[[Progress], Sequence[Experiment]]) -> Task[list[Experiment]]:
        return Task(part, lambda say: list(run(say)), (run,))

    return {part: task(part, run) for part, run in design.simulate.items()}


def experiments(design: Design, say: Progress) -> list[Experiment]:
    """Return the experiments of all parts, in their order."""
    return [e for task in simulations(design).values() for e in task.result(say)]


def faults(design: Design) -> Task[Campaign | None]:
    """Return the task of the fault campaign on the nominal plant; its result is None for a design without a loop."""
    if not fault_jobs.closes_loop(design):
        return Task("faults", _nothing, (_nothing,))
    return Task("faults", lambda say: _campaign(design), (_campaign, design.stage))


def _campaign(design: Design) -> Campaign:
    return fault_jobs.result(design, fault_jobs.parts(design, 1))


def brief_study(design: Design) -> Task[StudyTable | None]:
    """Return the task of a study on a few machines; its result is None for a design without experiments in lanes."""
    stage = design.stage
    if stage is None or not stage.experiments or not fault_jobs.closes_loop(design):
        return Task("study", _nothing, (_nothing,))
    return Task("study", lambda say: study_runs.brief(stage, say), (study_runs.brief, stage))


def audit(design: Design) -> Task[list[Row]]:
    """Return the task of recomputing the published values."""

    def compute(say: Progress) -> list[Row]:
        rows = []
        for row in design.audit():
            say(f"audit {row.id}")
            rows.append(row)
        return rows

    return Task("audit", compute, (design.audit,))


def brief_cost(design: Design) -> Task[Cost | None]:
    """Return the task of measuring the cost in a few seconds; its result is None without emulator or cross compiler."""
    if design.scalar is not np.float32 or missing() or not cross.available():
        return Task("cost", _nothing, (_nothing,))
    from synth.verify import meter

    def compute(say: Progress) -> Cost:
        files = emission(design, design.scalar).result(_silent)[design.name]
        say("cost")
        inputs = design.cost_stimuli.replay(host.load(files.files, files.manifest))
        return _with_law_alone(design, meter.brief(files, design.cost_stimuli.block(), inputs), inputs)

    used = (meter.brief, design.emit, design.cost_stimuli.block, design.cost_stimuli.replay)
    return Task("cost", compute, (*used, meter.with_law_alone, design.cost_stimuli.law_alone))


def _with_law_alone(design: Design, cost: Cost, inputs: Mapping[str, Any]) -> Cost:
    """Return the cost with that of the law without its fault handling, where the design names it."""
    from synth.verify import meter

    law = design.cost_stimuli.law_alone
    return meter.with_law_alone(cost, law(), inputs) if law else cost


def whole_cost(design: Design) -> Task[Cost]:
    """Return the task of measuring the cost over the most expensive steps and all decisions; it needs the emulator."""
    from synth.verify import meter

    def compute(say: Progress) -> Cost:
        files = emission(design, np.float32).result(say)[design.name]
        controller = host.load(files.files, files.manifest)
        sequences = design.cost_stimuli.sequences(controller, say)
        cost = meter.measure(files, design.cost_stimuli.block(), sequences, say)
        return _with_law_alone(design, cost, design.cost_stimuli.replay(controller))

    used = (meter.measure, design.emit, design.cost_stimuli.block, design.cost_stimuli.sequences)
    return Task("cost", compute, (*used, meter.with_law_alone, design.cost_stimuli.law_alone))


def companion_costs(design: Design) -> Task[list[Cost]]:
    """Return the task of measuring the cost of the Blocks beside the controller, over their test vectors."""
    from synth.verify import meter

    companions = design.stage.companions if design.stage else ()

    def compute(say: Progress) -> list[Cost]:
        emitted = emission(design, np.float32).result(say)
        codes = [emitted[c.block.name] for c in companions]
        recorded = [vectors.inputs(code.files["vectors.json"]) for code in codes]
        said = progress.each(companions, say, lambda c: f"cost of {c.block.name}")
        return [meter.brief(code, c.block, u, c.sequences) for code, c, u in zip(codes, said, recorded, strict=True)]

    used = (meter.brief, design.emit, *(c.sequences for c in companions))
    return Task("cost of companions", compute, used)


def report_parts(design: Design) -> dict[str, Task[Any]]:
    """Return the tasks of what the report alone shows and takes long, by name."""
    return {name: Task(name, compute, (compute,)) for name, compute in design.report_parts.items()}


def build(design: Design) -> Task[Built]:
    """Return the task of the report, from the results of all other tasks."""
    emit, verify, simulate = emission(design, design.scalar), verification(design, False), simulations(design)
    study, campaign, rows, cost = brief_study(design), faults(design), audit(design), brief_cost(design)
    further = report_parts(design)

    def compute(say: Progress) -> Built:
        evidence = replace(verify.result(_silent), faults=campaign.result(_silent), study=study.result(_silent))
        runs = experiments(design, _silent)
        shown = emit.result(_silent), evidence, runs, rows.result(_silent), cost.result(_silent)
        parts = {"parts": {name: task.result(_silent) for name, task in further.items()}} if further else {}
        say("report")
        checks = (*evidence.checks, *(_with_title(c, e.title) for e in runs for c in e.checks))
        checks += evidence.faults.checks if evidence.faults else ()
        return Built(design.report(*shown, **parts), replace(evidence, checks=checks).document(), checks)

    try:
        inputs: list[Task[Any]] = [emit, verify, *simulate.values(), study, campaign, rows, cost, *further.values()]
        keys = [task.key() for task in inputs]
    except ContentError:  # the report has no key where one of its inputs has none
        return Task("report", compute, (design.report, object()))
    return Task("report", compute, (design.report, *keys))


def _with_title(check: Check, title: str) -> Check:
    """Return a check of an experiment with the experiment's title in front of its description."""
    return replace(check, about=": ".join(filter(None, (title, check.about))))


def build_jobs(designs: Sequence[Design], root: Path) -> list[Job]:
    """Return the jobs that build designs; the last of each has the design's name and returns a Built.

    The C is written to `root`/generated_c as soon as it is emitted.
    """
    emulated = not missing() and "zig" in cross.available()
    library = [Job(LIBRARY, LIBRARY, lambda say: cross.prepare("cortex-m4f"))] if emulated else []
    return [*library, *(job for design in designs for job in _build_jobs(design, root, tuple(j.name for j in library)))]


def _build_jobs(design: Design, root: Path, library: tuple[str, ...]) -> list[Job]:
    name, whole = design.name, build(design)

    def save(say: Progress) -> None:
        for folder, files in emission(design, design.scalar).result(say).items():
            write.save(files.files, root / "generated_c" / folder)

    try:
        if store.holds(whole.key()):
            return [Job(f"{name} emit", name, save), Job(name, name, whole.result, (f"{name} emit",))]
    except ContentError:
        pass
    first = f"{name} emit"
    parts = {f"simulate {part}": task for part, task in simulations(design).items()}
    tasks: tuple[tuple[str, Task[Any], tuple[str, ...]], ...] = (
        *((what, task, (first,)) for what, task in parts.items()),
        ("study", brief_study(design), (first, *(f"{name} {what}" for what in parts))),
        ("verify", verification(design, False), (first,)),
        ("cost", brief_cost(design), (first, *library)),
        ("audit", audit(design), (first,)),
        *((f"report {name}", task, (first, f"{design.name} verify")) for name, task in report_parts(design).items()),
    )
    jobs = [Job(f"{name} {what}", name, _run_only(task), after) for what, task, after in tasks]
    if fault_jobs.closes_loop(design):
        jobs += fault_jobs.jobs(design, fault_jobs.parts(design, 1), (first,))
    last = Job(name, name, whole.result, tuple(job.name for job in jobs))
    return [Job(first, name, save), *jobs, last]


def _run_only(task: Task[Any]) -> Callable[[Progress], None]:
    """Return a function that leaves the result of a task in the cache, where the next job reads it."""

    def run(say: Progress) -> None:
        task.result(say)

    return run


def missing() -> list[str]:
    """Return the packages of the emulator that are not installed."""
    return [name for name in EMULATOR if find_spec(name) is None]


@once
def compilers() -> Sequence[tuple[str, ...]]:
    """Return command, identity and machine flags of each compiler of a design's C."""
    available = [host_compiler.find_compiler()]
    available += [cross.find_compiler("cortex-m4f", name) for name in cross.available()]
    return [(*c.command, c.identity, *c.machine_flags) for c in available]


def _silent(line: str) -> None:
    """Say nothing."""


def _nothing(say: Progress) -> None:
    """Measure nothing."""
