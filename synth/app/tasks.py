"""The tasks of a stage, cached by content (as `make`, `ninja`); `builds` puts them together.

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

from synth.analyse.loops.robustness import ClosedLoop, Survey
from synth.app import bench, fault_jobs, standard_tasks, study_runs, verdicts
from synth.base import cache, progress, slices, store
from synth.base.progress import Progress, silent
from synth.check import Check, Incomplete, of_error
from synth.declare.fault_campaign import FaultCampaign, StudyLimits
from synth.declare.stage import Stage
from synth.declare.tuning import BenchMargins
from synth.emit.c import manifest
from synth.emit.write import EmittedCode
from synth.errors import ContentError
from synth.execute import compile as host_compiler
from synth.execute import cross, host
from synth.report.audit import Row
from synth.simulate.experiments import Experiment
from synth.simulate.faults.fault_table import Campaign
from synth.simulate.study import StudyTable
from synth.stage import tunable
from synth.verify import standard
from synth.verify.cost import Cost
from synth.verify.suite import Evidence

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


def emission(stage: Stage, scalar: type[np.floating]) -> Task[dict[str, EmittedCode]]:
    """Return the task of emitting the files of generated_c/<name>/, by folder."""

    def compute(say: Progress) -> dict[str, EmittedCode]:
        say("gains and C")
        return standard_tasks.emit(stage, scalar)

    return Task("gains and C", compute, (standard_tasks.emit, stage, scalar))


def verification(stage: Stage, whole: bool) -> Task[Evidence]:
    """Return the task of comparing the witnesses, over the `whole` replay or a short one."""
    verify = stage.verify or standard.verify
    return Task("verification", lambda say: verify(stage, say, whole), (verify, stage.stimuli or nothing, stage, whole))


def stability(stage: Stage) -> Task[list[ClosedLoop]]:
    """Return the task of the closed loops, which is done much sooner than that of the margins."""
    used = (verdicts.closed_loops, _closed_loop(stage, StudyLimits()))
    return Task("stability", lambda say: verdicts.closed_loops(stage), used)


def loops(stage: Stage) -> Task[Survey | None]:
    """Return the task of the loops with their margins, for which no other task can stand in."""
    return Task("margins", lambda say: verdicts.survey(stage), (verdicts.survey, _closed_loop(stage, StudyLimits())))


def _closed_loop(stage: Stage, study: StudyLimits) -> Stage:
    """Return a stage without the limits and texts on which no measured value depends."""
    return replace(stage, study=study, require={}, faults=FaultCampaign(), about="", header_notes=())


def experiments(stage: Stage) -> Task[list[Experiment]]:
    """Return the task of running the experiments, with the headroom of the states of a loop.

    It raises Incomplete with the others where some raise errors or have no sample.
    """

    def compute(say: Progress) -> list[Experiment]:
        runs, failed = attempt(lambda: standard_tasks.simulate(stage, say), "experiments", list[Experiment]())
        failed += verdicts.empty_runs(runs)
        runs = [standard_tasks.with_headroom(stage, e) for e in runs if len(e.trajectory.time)]
        if failed:
            raise Incomplete(runs, failed)
        return runs

    used = (standard_tasks.simulate, verdicts.empty_runs, standard_tasks.with_headroom, stage)
    return Task("experiments", compute, used)


def attempt(compute: Callable[[], T], part: str, otherwise: T) -> tuple[T, list[Check]]:
    """Return the result of a computation, and a failed check for each part that raised an error."""
    try:
        return compute(), []
    except Incomplete as incomplete:
        return incomplete.value, [*incomplete.checks]
    except Exception as error:
        return otherwise, [of_error(part, error)]


def faults(stage: Stage) -> Task[Campaign | None]:
    """Return the task of the basic faults on the nominal plant; its result is None for a design without a loop."""
    if not fault_jobs.closes_loop(stage):
        return Task("faults", nothing, (nothing,))
    return Task("faults", lambda say: _campaign(stage), (_campaign, stage))


def _campaign(stage: Stage) -> Campaign:
    return fault_jobs.result(stage, fault_jobs.basic(stage))


def brief_study(stage: Stage) -> Task[StudyTable | None]:
    """Return the task of a study on a few machines; its result is None for a design without experiments in lanes."""
    if not stage.all_experiments or not fault_jobs.closes_loop(stage):
        return Task("study", nothing, (nothing,))
    loop = _closed_loop(stage, StudyLimits(experiments=stage.study.experiments))
    return Task("study", lambda say: study_runs.brief(stage, say), (study_runs.brief, loop))


def on_bench(stage: Stage) -> Task[BenchMargins | None]:
    """Return the task of the margins over the bench of a stage; its result is None for a stage without one."""
    if stage.tuning is None or stage.tuning.bench is None:
        return Task("margins on the bench", nothing, (nothing,))
    loop = replace(_closed_loop(stage, StudyLimits()), require=stage.require)
    return Task("margins on the bench", partial(bench.over, loop), (bench.over, loop))


def audit(stage: Stage) -> Task[list[Row]]:
    """Return the task of recomputing the published values; it raises Incomplete with the rows before an error."""

    def compute(say: Progress) -> list[Row]:
        rows: list[Row] = []
        try:
            for row in stage.audit(stage) if stage.audit else ():
                say(f"audit {row.id}")
                rows.append(row)
        except Exception as error:
            error.add_note(f"after row {rows[-1].id}" if rows else "in the first row")
            raise Incomplete(rows, [of_error("audit", error)]) from error
        return rows

    return Task("audit", compute, (stage.audit or nothing, stage))


def brief_cost(stage: Stage) -> Task[Cost | None]:
    """Return the task of measuring the cost in a few seconds; its result is None for a design in double."""
    if stage.scalar is not np.float32:
        return Task("cost", nothing, (nothing,))
    from synth.verify import meter

    def compute(say: Progress) -> Cost:
        files = emission(stage, stage.scalar).result(silent)[stage.name]
        say("cost")
        inputs = standard_tasks.replay_inputs(stage, host.load(files.files, files.manifest))
        return _with_law_alone(stage, meter.brief(files, tunable.with_bench(stage), inputs), inputs)

    return Task("cost", compute, (meter.brief, *_of_cost(stage)))


def _with_law_alone(stage: Stage, cost: Cost, inputs: Mapping[str, Any]) -> Cost:
    """Return the cost with that of the law without its fault handling, where the stage names it."""
    from synth.verify import meter

    law = standard_tasks.law_alone(stage)
    return meter.with_law_alone(cost, law, inputs) if law else cost


def _of_cost(stage: Stage) -> tuple[Any, ...]:
    """Return what each cost of the controller depends on."""
    from synth.verify import meter

    tasks = standard_tasks.replay_inputs, standard_tasks.cost_sequences, standard_tasks.law_alone
    return (*tasks, meter.with_law_alone, stage.stimuli or nothing, stage)


def whole_cost(stage: Stage) -> Task[Cost]:
    """Return the task of measuring the cost over the most expensive steps and all decisions; it needs the emulator."""
    from synth.verify import meter

    def compute(say: Progress) -> Cost:
        files = emission(stage, np.float32).result(say)[stage.name]
        controller = host.load(files.files, files.manifest)
        sequences = standard_tasks.cost_sequences(stage, controller, say)
        cost = meter.measure(files, tunable.with_bench(stage), sequences, say)
        return _with_law_alone(stage, cost, standard_tasks.replay_inputs(stage, controller))

    return Task("cost", compute, (meter.measure, *_of_cost(stage)))


def companion_costs(stage: Stage) -> Task[list[Cost]]:
    """Return the task of measuring the cost of the Blocks beside the controller, over their test vectors."""
    from synth.verify import meter

    companions = stage.companions

    def compute(say: Progress) -> list[Cost]:
        emitted = emission(stage, np.float32).result(say)
        codes = [emitted[c.name] for c in companions]
        recorded = [manifest.inputs(code.files["vectors.json"]) for code in codes]
        said = progress.each(companions, say, lambda c: f"cost of {c.name}")
        return [meter.of_companion(code, c, u) for code, c, u in zip(codes, said, recorded, strict=True)]

    used = (meter.of_companion, standard_tasks.emit, stage)
    return Task("cost of companions", compute, used)


@once
def compilers() -> Sequence[tuple[str, ...]]:
    """Return command, identity and machine flags of each compiler of a design's C."""
    available = [host_compiler.find_compiler()]
    available += [cross.find_compiler("cortex-m4f", name) for name in cross.available()]
    return [(*c.command, c.identity, *c.machine_flags) for c in available]


def nothing(say: Progress) -> None:
    """Stand for what a stage does not have: measure nothing, add nothing."""
