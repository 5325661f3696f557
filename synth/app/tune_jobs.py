"""Candidates of a tuning: values of the free parameters of a law, and the goals that it reaches with them.

    r = worst value of the machines / its limit       overshoot, settling, tracking, current: whatever has a limit
    r = required margin / least margin                at the operating points, corners of the tolerances and cases

A candidate reaches every goal where no r exceeds 1. Candidates run as variants of the declared controller
(`host.vary`), without a compilation: with gains at run time one costs 0.1 to 5 s, with C of its own 3 to 60 s.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from synth.analyse.loops import robustness
from synth.app import standard_tasks, study_jobs, study_runs, tasks, verdicts
from synth.base import cache, store
from synth.declare.stage import Stage
from synth.declare.tuning import Candidate, Goal, Plan, Tuning
from synth.errors import ContentError, DesignError, SynthError
from synth.execute import host
from synth.simulate import integration, study
from synth.simulate.integration import Integration
from synth.simulate.rig import Rig
from synth.simulate.sampling import Sampling
from synth.simulate.study import StudyTable
from synth.stage import tunable


@dataclass(frozen=True, eq=False)
class Search:
    """What the evaluation of every candidate needs."""

    stage: Stage
    tuning: Tuning
    plan: Plan
    rig: Rig
    integration: Integration
    key: str

    def evaluate(self, values: Mapping[str, float]) -> Candidate:
        """Return a candidate, stored or computed."""
        if not self.key:
            return evaluate(self, values)
        return store.fetch(cache.key(evaluate, self.key, dict(values)), lambda: evaluate(self, values))


def prepare(stage: Stage, plan: Plan) -> Search:
    """Return the search of a stage, with its declared controller compiled.

    Raises DesignError for a design without a tuning, and for declared values that do not give the declared law.
    """
    study_jobs.stage_of(stage)
    if stage.tuning is None:
        raise DesignError(f"design '{stage.name}' declares no tuning: give `tuning=Tuning(free=.., controller=..)`")
    tuning = replace(stage.tuning, bench=None)  # candidates have constants of their own
    stage, names = replace(stage, tuning=tuning), tuple(tuning.experiments)
    rig = standard_tasks.rig(stage, stage.scalar)
    tunable.require_declared_values(stage, tuning)
    try:
        key = cache.key(evaluate, tasks.compilers(), stage, plan, data=True)
    except ContentError:
        key = ""
    return Search(stage, tuning, plan, rig, study_runs.integration_of(stage, names), key)


def evaluate(search: Search, values: Mapping[str, float]) -> Candidate:
    """Return the goals that the law with these values reaches."""
    try:
        stage = with_values(search.stage, search.tuning, values)
        variant = host.vary(search.rig.controller, stage.controller.block)
        goals = measure_goals(search, stage, replace(search.rig, stage=stage, controller=variant))
    except SynthError as error:
        return Candidate(dict(values), (), f"{type(error).__name__}: {error}")
    return Candidate(dict(values), goals)


def with_values(stage: Stage, tuning: Tuning, values: Mapping[str, float]) -> Stage:
    """Return the stage under the law with these values of its free parameters."""
    return replace(stage, controller=tuning.controller(dict(values)))


def measure_goals(search: Search, stage: Stage, rig: Rig) -> tuple[Goal, ...]:
    """Return the goals that a stage reaches on the machines of the plan, under the controller of a rig."""
    chosen = study.select(stage.all_experiments, search.tuning.experiments)
    experiments = [e for e in chosen if integration.runs_in_lanes(search.rig, e)]  # a candidate has no C of its own
    sampling = Sampling(search.plan.plants, search.plan.seed)
    table = verdicts.with_limits(stage, study.run(rig, experiments, sampling, range(sampling.rows), search.integration))
    stage = _at_points(stage, search.tuning.points)
    return (*experiment_goals(table, search.tuning.goals), *margin_goals(stage, search.tuning))


def _at_points(stage: Stage, names: Sequence[str]) -> Stage:
    """Return the stage with these of its operating points; raise DesignError for one that it does not have."""
    if unknown := [name for name in names if name not in stage.operating_points]:
        known = ", ".join(stage.operating_points) or "none"
        raise DesignError(f"tuning: there is no operating point '{unknown[0]}': choose from {known}")
    return replace(
        stage, operating_points={name: stage.operating_points[name] for name in names or stage.operating_points}
    )


def experiment_goals(table: StudyTable, goals: Mapping[str, float]) -> tuple[Goal, ...]:
    """Return the worst value of each check with its limit, unless that is infinite, and of each figure that is a goal.

    A row without a result counts as a value that is missing.

    Raises DesignError for a goal that no experiment has.
    """
    known = {**table.figures, **table.checks}
    if unknown := [n for n in goals if n not in known and not table.errors]:
        raise DesignError(f"no value is called '{unknown[0]}': choose from {', '.join(known)}")
    limits = {**table.limits, **goals}
    failed = {experiment for _, experiment, _ in table.errors}
    return tuple(
        Goal(n, table.units.get(n, ""), _worst(known.get(n), n.split(": ")[0] in failed), limit, False)
        for n, limit in limits.items()
        if limit < np.inf
    )


def _worst(values: NDArray[np.float64] | None, failed: bool) -> float:
    return np.nan if failed or values is None else float(np.max(values))


def margin_goals(stage: Stage, tuning: Tuning) -> tuple[Goal, ...]:
    """Return the least of each required margin over all that `verdicts.survey` opens, NaN for a stage without loops."""
    required = {**stage.require, **tuning.require}
    least = verdicts.least_margins(stage, verdicts.survey(stage)) if required else {}
    units = {name: each.unit for name, each in robustness.REQUIREMENTS.items()}
    return tuple(
        Goal(name, units.get(name, "1"), least.get(name, np.nan), limit, True) for name, limit in required.items()
    )
