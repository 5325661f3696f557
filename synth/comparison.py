"""Jobs of a comparison: the studies of two designs on the same machines, their least margins, and their costs."""

from collections.abc import Mapping

from synth import study_jobs, study_runs, tasks
from synth.analyse import robustness
from synth.declaration import Stage
from synth.errors import DesignError
from synth.jobs import Job, Outcome
from synth.progress import Progress
from synth.report.comparison import Side
from synth.simulate import sampling, study
from synth.simulate.sampling import Sampling
from synth.study_jobs import Plan
from synth.tasks import Task
from synth.verify import standard
from synth.workspace import Design

MARGINS = (*robustness.REQUIREMENTS, standard.DISK)


def plan_of(designs: tuple[Design, Design], drawn: Sampling, patterns: tuple[str, ...]) -> Plan:
    """Return the study of the experiments that both designs have and whose names match, all without patterns.

    Raises DesignError for a design and itself, for designs whose machines are drawn from different quantities or that
    have no experiment in common, and as `study.select`.
    """
    if designs[0].name == designs[1].name:
        raise DesignError(f"'{designs[0].name}' is to be compared with itself: name another design")
    stages = [study_jobs.stage_of(design) for design in designs]
    first, second = (set(sampling.quantities(study_runs.rig(stage))) for stage in stages)
    if different := sorted(first ^ second):
        raise DesignError(
            f"'{designs[0].name}' and '{designs[1].name}' are not drawn from the same quantities: only one of them has "
            f"a tolerance of {', '.join(different)}; compare designs of one plant with the same sensors"
        )
    chosen, others = ([e.name for e in study.select(stage.experiments, patterns)] for stage in stages)
    if not (common := tuple(name for name in chosen if name in others)):
        raise DesignError(
            f"'{designs[0].name}' has {', '.join(chosen)}, '{designs[1].name}' has {', '.join(others)}: no experiment "
            f"of the same name; give experiments that are to be compared the same name"
        )
    return Plan(drawn, common)


def jobs(designs: tuple[Design, Design], plan: Plan) -> list[Job]:
    """Return the jobs of a comparison, the results of which `sides` puts together."""
    return [job for design in designs for job in _jobs(design, plan)]


def _jobs(design: Design, plan: Plan) -> list[Job]:
    name, cost = design.name, tasks.brief_cost(design)
    margins = Job(_margins(design), name, _least_margins(study_jobs.stage_of(design)).result)
    return [*study_jobs.jobs(design, plan), margins, Job(_cost(design), name, cost.result)]


def sides(designs: tuple[Design, Design], plan: Plan, outcomes: Mapping[str, Outcome]) -> tuple[Side, Side]:
    """Return both designs with their results from the outcomes of all jobs, none of which failed."""
    first, second = (_side(design, plan, outcomes) for design in designs)
    return first, second


def _side(design: Design, plan: Plan, outcomes: Mapping[str, Outcome]) -> Side:
    table, values = (
        study_jobs.result(design, plan, outcomes),
        [outcomes[n].value for n in (_margins(design), _cost(design))],
    )
    return Side(design.name, table, *values)


def _least_margins(stage: Stage) -> Task[dict[str, float]]:
    def compute(say: Progress) -> dict[str, float]:
        say("margins")
        return standard.least_margins(stage, robustness.survey(standard.over_tolerances(stage)), MARGINS)

    return Task("margins", compute, (standard.least_margins, robustness.survey, stage))


def _margins(design: Design) -> str:
    return f"{design.name} margins"


def _cost(design: Design) -> str:
    return f"{design.name} cost"
