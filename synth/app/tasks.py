"""The tasks of a design, cached by content (as `make`, `ninja`); `builds` puts them together.

    emit ----+--> verify, margins, simulate, study, faults, audit, cost

The result of a task has a key: the slice of its function with data files, the arguments and the compilers. An error is
not cached.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache as once
from functools import partial
from typing import Any, Generic, TypeVar

import numpy as np

from synth.analyse.loops.robustness import Survey
from synth.app import fault_jobs, standard_tasks, study_runs, verdicts, workspace
from synth.app.workspace import Design
from synth.base import cache, progress, slices, store
from synth.base.progress import Progress, silent
from synth.check import Check, Incomplete, of_error
from synth.declare.fault_campaign import FaultCampaign, StudyLimits
from synth.declare.stage import Stage
from synth.emit.c import vectors
from synth.emit.write import EmittedCode
from synth.errors import ContentError
from synth.execute import compile as host_compiler
from synth.execute import cross, host
from synth.report.audit import Row
from synth.simulate.experiment import Experiment
from synth.simulate.faults.fault_rows import Campaign
from synth.simulate.study import StudyTable
from synth.verify.cost import Cost
from synth.verify.evidence import Evidence

T = TypeVar("T")


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


def emission(design: Design, scalar: type[np.floating]) -> Task[dict[str, EmittedCode]]:
    """Return the task of emitting the files of generated_c/<name>/, by folder."""

    def compute(say: Progress) -> dict[str, EmittedCode]:
        say("gains and C")
        return dict(workspace.emitted_files(design, scalar))

    return Task("gains and C", compute, (design.emit, scalar))


def verification(design: Design, whole: bool) -> Task[Evidence]:
    """Return the task of comparing the witnesses, over the `whole` replay or a short one."""
    return Task("verification", lambda say: design.verify(say, whole), (design.verify, whole))


def loops(design: Design) -> Task[Survey | None]:
    """Return the task of the loops with their margins, for which no other task can stand in."""
    stage = design.stage
    if stage is None:
        return Task("margins", _nothing, (_nothing,))
    return Task("margins", lambda say: verdicts.survey(stage), (verdicts.survey, _closed_loop(stage, StudyLimits())))


def _closed_loop(stage: Stage, study: StudyLimits) -> Stage:
    """Return a stage without the limits and texts on which no measured value depends."""
    return replace(stage, study=study, require={}, faults=FaultCampaign(), about="", header_notes=())


def simulations(design: Design) -> dict[str, Task[list[Experiment]]]:
    """Return the tasks of running the parts of the experiments, by name, with the headroom of the states of a loop."""
    stage = design.stage if fault_jobs.closes_loop(design) else None

    def task(part: str, run: Callable[[Progress], Sequence[Experiment]]) -> Task[list[Experiment]]:
        def compute(say: Progress) -> list[Experiment]:
            runs, failed = attempt(lambda: list(run(say)), part, list[Experiment]())
            failed += verdicts.empty_runs(runs)
            runs = [e for e in runs if len(e.trajectory.time)]
            if stage is not None:
                runs = [standard_tasks.with_headroom(stage, e) for e in runs]
            if failed:
                raise Incomplete(runs, failed)
            return runs

        return Task(part, compute, (run, verdicts.empty_runs, standard_tasks.with_headroom, stage))

    return {part: task(part, run) for part, run in design.simulate.items()}


def attempt(compute: Callable[[], T], part: str, otherwise: T) -> tuple[T, list[Check]]:
    """Return the result of a computation, and a failed check for each part that raised an error."""
    try:
        return compute(), []
    except Incomplete as incomplete:
        return incomplete.value, [*incomplete.checks]
    except Exception as error:
        return otherwise, [of_error(part, error)]


def experiments(design: Design, say: Progress) -> list[Experiment]:
    """Return the experiments of all parts, in their order; raise Incomplete where some raise errors."""
    runs, failed = list[Experiment](), list[Check]()
    for part, task in simulations(design).items():
        some, errors = attempt(partial(task.result, say), part, list[Experiment]())
        runs, failed = [*runs, *some], [*failed, *errors]
    if failed:
        raise Incomplete(runs, failed)
    return runs


def faults(design: Design) -> Task[Campaign | None]:
    """Return the task of the basic faults on the nominal plant; its result is None for a design without a loop."""
    if not fault_jobs.closes_loop(design):
        return Task("faults", _nothing, (_nothing,))
    return Task("faults", lambda say: _campaign(design), (_campaign, design.stage))


def _campaign(design: Design) -> Campaign:
    return fault_jobs.result(design, fault_jobs.basic(design))


def brief_study(design: Design) -> Task[StudyTable | None]:
    """Return the task of a study on a few machines; its result is None for a design without experiments in lanes."""
    stage = design.stage
    if stage is None or not stage.experiments or not fault_jobs.closes_loop(design):
        return Task("study", _nothing, (_nothing,))
    loop = _closed_loop(stage, StudyLimits(experiments=stage.study.experiments))
    return Task("study", lambda say: study_runs.brief(stage, say), (study_runs.brief, loop))


def audit(design: Design) -> Task[list[Row]]:
    """Return the task of recomputing the published values; it raises Incomplete with the rows before an error."""

    def compute(say: Progress) -> list[Row]:
        rows: list[Row] = []
        try:
            for row in design.audit():
                say(f"audit {row.id}")
                rows.append(row)
        except Exception as error:
            error.add_note(f"after row {rows[-1].id}" if rows else "in the first row")
            raise Incomplete(rows, [of_error("audit", error)]) from error
        return rows

    return Task("audit", compute, (design.audit,))


def brief_cost(design: Design) -> Task[Cost | None]:
    """Return the task of measuring the cost in a few seconds; its result is None for a design in double."""
    if design.scalar is not np.float32:
        return Task("cost", _nothing, (_nothing,))
    from synth.verify import meter

    def compute(say: Progress) -> Cost:
        files = emission(design, design.scalar).result(silent)[design.name]
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
        return [meter.of_companion(code, c, u) for code, c, u in zip(codes, said, recorded, strict=True)]

    used = (meter.of_companion, design.emit, *(c.sequences for c in companions))
    return Task("cost of companions", compute, used)


def report_parts(design: Design) -> dict[str, Task[Any]]:
    """Return the tasks of what the report alone shows and takes long, by name."""
    return {name: Task(name, compute, (compute,)) for name, compute in design.report_parts.items()}


@once
def compilers() -> Sequence[tuple[str, ...]]:
    """Return command, identity and machine flags of each compiler of a design's C."""
    available = [host_compiler.find_compiler()]
    available += [cross.find_compiler("cortex-m4f", name) for name in cross.available()]
    return [(*c.command, c.identity, *c.machine_flags) for c in available]


def _nothing(say: Progress) -> None:
    """Measure nothing."""
