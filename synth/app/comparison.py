"""Jobs of a comparison: the studies of two designs on the same machines, their least margins, and their costs.

`synth compare`: two designs of one stage side by side, at the terminal and as a page.
"""

import sys
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from itertools import zip_longest
from pathlib import Path
from typing import Any

from synth.app import study_jobs, study_runs, tables, tasks, verdicts, workspace
from synth.app.study_jobs import Plan
from synth.app.tables import run_jobs
from synth.app.tasks import Task
from synth.base import contents, store
from synth.base.jobs import Job, Outcome
from synth.base.progress import Progress
from synth.declare.stage import Stage
from synth.errors import DesignError
from synth.report import comparison as report
from synth.report.comparison import Side
from synth.simulate import study
from synth.simulate.sampling import Sampling


def plan_of(designs: tuple[Stage, Stage], drawn: Sampling, patterns: tuple[str, ...]) -> Plan:
    """Return the study of the experiments that both designs have and whose names match, all without patterns.

    Raises DesignError for a design and itself, for designs of different plants or sensors, for designs without an
    experiment in common, and as `study.select`.
    """
    first, second = designs
    if first.name == second.name:
        raise DesignError(f"'{first.name}' is to be compared with itself: name another design")
    stages = study_jobs.stage_of(first), study_jobs.stage_of(second)
    machines = [_machine(stage) for stage in stages]
    if machines[0] != machines[1]:
        raise DesignError(
            f"'{first.name}' and '{second.name}' do not run on the same machines: {_difference(*machines)}; compare "
            f"designs of one plant with the same sensors"
        )
    chosen, others = ([e.name for e in study.select(stage.all_experiments, patterns)] for stage in stages)
    if not (common := tuple(name for name in chosen if name in others)):
        raise DesignError(
            f"'{first.name}' has {', '.join(chosen)}, '{second.name}' has {', '.join(others)}: no experiment of the "
            f"same name; give experiments that are to be compared the same name"
        )
    return Plan(drawn, common)


def _machine(stage: Stage) -> list[tuple[str, float, float | tuple[float, float]]]:
    """Return all from which machines are drawn, in order: name, nominal value, and tolerance or largest error."""
    rig = study_runs.rig(stage)
    sensors = rig.stage.interface.sensors
    return [
        *((p.name, p.value, p.tolerance) for p in rig.plant.parameters),
        *((f"sensor {s.name}", s.resolution, s.offset) for s in sensors),
        *((f"gain of sensor {s.name}", 1.0, s.gain_error) for s in sensors),
    ]


def _difference(*machines: list[tuple[str, float, float | tuple[float, float]]]) -> str:
    """Return the first quantity in which two machines differ, as a sentence."""
    first, second = next((a, b) for a, b in zip_longest(*machines) if a != b)
    return f"one has {_text(first)} where the other has {_text(second)}"


def _text(quantity: tuple[str, float, float | tuple[float, float]] | None) -> str:
    return "{} = {:g} (+- {:g})".format(*quantity) if quantity else "nothing more"


def jobs(designs: tuple[Stage, Stage], plan: Plan) -> list[Job]:
    """Return the jobs of a comparison, the results of which `sides` puts together."""
    return [job for stage in designs for job in _jobs(stage, plan)]


def _jobs(stage: Stage, plan: Plan) -> list[Job]:
    name, cost = stage.name, tasks.brief_cost(stage)
    margins = Job(_margins(stage), name, _least_margins(study_jobs.stage_of(stage)).result)
    return [*study_jobs.jobs(stage, plan), margins, Job(_cost(stage), name, cost.result)]


def sides_of(designs: tuple[Stage, Stage], plan: Plan, outcomes: Mapping[str, Outcome]) -> tuple[Side, Side]:
    """Return both designs with their results from the outcomes of all jobs, none of which failed."""
    first, second = (_side(stage, plan, outcomes) for stage in designs)
    return first, second


def _side(stage: Stage, plan: Plan, outcomes: Mapping[str, Outcome]) -> Side:
    table = study_jobs.result(stage, plan, outcomes)
    return Side(stage.name, table, outcomes[_margins(stage)].value, outcomes[_cost(stage)].value)


def _least_margins(stage: Stage) -> Task[dict[str, float]]:
    """Return the task of the least margins, which a stage without operating points does not have."""

    def compute(say: Progress) -> dict[str, float]:
        say("margins")
        return verdicts.least_margins(stage, verdicts.survey(stage))

    return Task("margins", compute, (verdicts.least_margins, verdicts.survey, stage))


def _margins(stage: Stage) -> str:
    return f"{stage.name} margins"


def _cost(stage: Stage) -> str:
    return f"{stage.name} cost"


@dataclass(frozen=True)
class CompareChoice:
    """The options of `synth compare`."""

    sampling: Sampling
    experiments: tuple[str, ...]
    report: Path | None


def compare(names: tuple[str, str], as_json: bool, fresh: bool, chosen: CompareChoice) -> int:
    """Run two designs on the same machines and print their experiments, margins and instructions side by side."""
    first, second = (workspace.designs(Path.cwd(), [name])[0] for name in names)
    designs = first, second
    plan = plan_of(designs, chosen.sampling, chosen.experiments)
    outcomes = run_jobs(jobs(designs, plan), as_json, fresh)
    if any(outcome.error for outcome in outcomes.values()):
        return 2
    sides = sides_of(designs, plan, outcomes)
    if chosen.report is not None:
        store.replace_text(chosen.report, report.page_text(sides))
    if as_json:
        sys.stdout.write(contents.dumps([document(side) for side in sides]) + "\n")
    else:
        tables.print_comparison(sides)
    return 0


def document(side: Side) -> dict[str, Any]:
    """Return one of the designs for JSON."""
    return {
        "design": side.name,
        "rows": len(side.study.rows),
        "yield": vars(study.estimate_yield(side.study)),
        "summaries": [asdict(summary) for summary in study.summarise(side.study)],
        "margins": side.margins,
        "cost": side.cost.document() if side.cost else None,
    }
