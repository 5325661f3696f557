"""`synth study`: the machines of a study, their table at the terminal and in files, and the search for the worst."""

import sys
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from math import inf
from pathlib import Path

from synth.app import study_jobs, tables, verdicts, workspace
from synth.app.study_jobs import Plan
from synth.app.tables import run_jobs
from synth.app.tasks import attempt
from synth.base import contents, store
from synth.base.jobs import Job
from synth.check import Check
from synth.declare.stage import Stage
from synth.errors import DesignError
from synth.report import sections as report
from synth.simulate import sampling, worst_case
from synth.simulate import study as studies
from synth.simulate.study import StudyTable
from synth.simulate.worst_case import WorstCase


@dataclass(frozen=True)
class StudyFiles:
    """Where the table of a study is written: CSV, Parquet, and a page."""

    csv: Path | None = None
    parquet: Path | None = None
    report: Path | None = None


@dataclass(frozen=True)
class StudyChoice:
    """The options of `synth study`."""

    plants: int
    experiments: tuple[str, ...]
    seed: int
    method: str
    row: int | None
    files: StudyFiles
    search: str | None
    scheduler: str | None


def study(name: str, as_json: bool, fresh: bool, chosen: StudyChoice) -> int:
    """Run the experiments of a design on many machines, and print distributions, yield and drivers."""
    (stage,) = workspace.designs(Path.cwd(), [name])
    if chosen.files.parquet is not None:
        studies.require_parquet()
    for path in (chosen.files.csv, chosen.files.parquet, chosen.files.report):
        if path is not None and (path.is_dir() or not path.parent.is_dir()):
            raise DesignError(f"the file {path} cannot be written: give a name in a folder that exists")
    drawn = sampling.Sampling(chosen.plants, chosen.seed, sampling.Method(chosen.method))
    patterns = chosen.experiments or study_jobs.stage_of(stage).study.experiments
    plan = study_jobs.Plan(drawn, patterns)
    outcomes = run_jobs(_jobs(stage, plan, chosen), as_json, fresh)
    if any(outcome.error for outcome in outcomes.values()):
        return 2
    table = outcomes[name].value if name in outcomes else study_jobs.result(stage, plan, outcomes)
    worst = None
    if chosen.search is not None:
        climb = partial(study_jobs.search, stage, plan, table, chosen.search)
        outcome = run_jobs([Job(name, name, climb)], as_json, fresh)[name]
        if outcome.error:
            return 2
        worst = outcome.value
    stage = study_jobs.stage_of(stage)
    table, failed = attempt(partial(verdicts.with_limits, stage, table), "limits of the study", table)
    checks = [*failed, *verdicts.study(stage, table)]
    _write(name, table, worst, chosen.files)
    _show(name, table, worst, as_json, chosen.row is not None, checks)
    declared = stage.study.least_yield > -inf and chosen.row is None
    return int(not all(c.passed for c in checks) or not (declared or table.passed.all()))


def _jobs(stage: Stage, plan: Plan, chosen: StudyChoice) -> list[Job]:
    jobs = study_jobs.jobs(stage, plan)
    if chosen.row is not None:
        return [Job(stage.name, stage.name, partial(study_jobs.row, stage, plan, chosen.row))]
    if chosen.scheduler is not None:
        return [Job(stage.name, stage.name, partial(study_jobs.on_cluster, stage, plan, chosen.scheduler))]
    return jobs


def _write(name: str, table: StudyTable, worst: WorstCase | None, files: StudyFiles) -> None:
    if files.csv is not None:
        store.replace_text(files.csv, studies.csv_text(table))
    if files.parquet is not None:
        studies.write_parquet(table, files.parquet)
    if files.report is not None:
        store.replace_text(files.report, report.page_text(name, table, worst))


def _show(
    name: str, table: StudyTable, worst: WorstCase | None, as_json: bool, alone: bool, checks: Sequence[Check]
) -> None:
    if as_json:
        verdict = {"checks": [c.document() for c in checks]}
        searched = {"search": vars(worst)} if worst else {}
        sys.stdout.write(contents.dumps(studies.document(table) | verdict | searched) + "\n")
        return
    (tables.print_machine if alone else tables.print_study)(name, table)
    tables.print_checks(f"{name}: study", checks)
    if worst:
        sys.stdout.write("\n".join(worst_case.notes(worst)) + "\n")
