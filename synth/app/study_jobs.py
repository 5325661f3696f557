"""Jobs of a study: chunks of rows, in processes on this machine or by the workers of a dask cluster.

A chunk is a function of the stage, the sampling and its first row. It is stored under the content of all that it
follows from, in one step: a study that was stopped goes on where it was, and a chunk that a lost worker computed in
part is computed again. Chunks are put together in the order of their rows. A process runs several chunks, one after
another, since it prepares the loops of all experiments once.
"""

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache, partial
from pathlib import Path
from typing import Any

from synth.app import study_runs, tasks, workspace
from synth.base import cache, store
from synth.base.jobs import Job, Outcome, cores
from synth.base.progress import Counted, Progress
from synth.declare.stage import Stage
from synth.errors import ContentError, DesignError
from synth.simulate import study, worst_case
from synth.simulate.sampling import Sampling
from synth.simulate.study import StudyTable
from synth.simulate.worst_case import WorstCase

CHUNK = 96  # rows
PER_CORE = 2  # processes, one after another: each prepares the loops, some 4 s for a large stage


@dataclass(frozen=True)
class Plan:
    """A study: the sampling, and patterns of the experiments' names, all of them without patterns."""

    sampling: Sampling
    experiments: tuple[str, ...] = ()

    @property
    def chunks(self) -> list[range]:
        """The rows of each chunk."""
        rows = range(self.sampling.rows)
        return [rows[first : first + CHUNK] for first in rows[::CHUNK]]

    @property
    def batches(self) -> list[list[range]]:
        """The chunks of each process on this machine."""
        n, k = len(self.chunks), min(len(self.chunks), PER_CORE * cores())
        return [self.chunks[n * i // k : n * (i + 1) // k] for i in range(k)]


def stage_of(stage: Stage) -> Stage:
    """Return a stage with experiments; raise DesignError for one without."""
    if not stage.all_experiments:
        raise DesignError(f"design '{stage.name}' declares no experiments: a study runs those of a stage")
    return stage


def jobs(stage: Stage, plan: Plan) -> list[Job]:
    """Return the jobs of a study; the first compiles, the others need it.

    Raises DesignError as `stage_of` and for experiments that the stage does not have.
    """
    stage, first = stage_of(stage), f"{stage.name} compile"
    study.select(stage.all_experiments, plan.experiments)
    compile = Job(first, stage.name, partial(_compile, stage, plan))
    batches = [Job(_name(stage, b), stage.name, partial(_batch, stage, plan, b), (first,)) for b in plan.batches]
    return [compile, *batches]


def result(stage: Stage, plan: Plan, outcomes: Mapping[str, Outcome]) -> StudyTable:
    """Return the whole table from the outcomes of all jobs of a stage, none of which failed."""
    return study.join([outcomes[_name(stage, batch)].value for batch in plan.batches])


def _batch(stage: Stage, plan: Plan, chunks: Sequence[range], progress: Progress) -> StudyTable:
    done: list[StudyTable] = []
    for rows in chunks:
        progress(Counted(f"row {rows[0]} of {chunks[0][0]} to {chunks[-1][-1]}", len(done), len(chunks)))
        done.append(chunk(stage, plan, rows))
    return study.join(done)


def chunk(stage: Stage, plan: Plan, rows: Sequence[int]) -> StudyTable:
    """Return the rows of a chunk, stored or computed."""
    compute = partial(_rows, stage_of(stage), plan, rows)
    try:
        return store.fetch(chunk_key(stage, plan, rows), compute)
    except ContentError:
        return compute()


def chunk_key(stage: Stage, plan: Plan, rows: Sequence[int]) -> str:
    """Return the key of a chunk; raise ContentError where the source of a function cannot be read."""
    return cache.key(_rows, tasks.compilers(), stage, plan, tuple(rows), data=True)


def row(stage: Stage, plan: Plan, number: int, progress: Progress) -> StudyTable:
    """Return one row of a study, computed again; raise DesignError for a row that it does not have."""
    if not 0 <= number < plan.sampling.rows:
        raise DesignError(f"row {number} of a study of {plan.sampling.rows} rows: give 0 to {plan.sampling.rows - 1}")
    progress(f"row {number}")
    return _rows(stage_of(stage), plan, [number])


def search(stage: Stage, plan: Plan, table: StudyTable, check: str, progress: Progress) -> WorstCase:
    """Return the worst machine for a check that a search from the worst row of the table reaches."""
    progress(f"search for the worst {check}")
    stage_of(stage)
    return worst_case.search(study_runs.rig(stage), stage.all_experiments, plan.sampling.seed, table, check)


def on_cluster(stage: Stage, plan: Plan, address: str, progress: Progress) -> StudyTable:
    """Return the whole table, computed by the workers of the dask scheduler at `address`.

    The workers need this workspace at the same path, and this environment. A lost worker's chunks go to others.

    Raises DesignError where dask is not installed or nothing answers at the address.
    """
    dask = _import_dask()
    done: dict[int, StudyTable] = {}
    with _connect(dask, address) as client:
        call = partial(_remote, str(Path.cwd()), stage.name, plan)
        futures = {client.submit(call, tuple(rows), pure=False): k for k, rows in enumerate(plan.chunks)}
        for future, table in dask.as_completed(futures, with_results=True):
            done[futures[future]] = table
            progress(Counted(f"{len(done)} of {len(futures)} chunks", len(done), len(futures)))
    return study.join([done[k] for k in range(len(plan.chunks))])


def _import_dask() -> Any:
    try:
        import distributed
    except ImportError as error:
        raise DesignError(
            "a study on a cluster needs dask: run `pip install 'synth-stage[cluster]'`, or leave --scheduler out"
        ) from error
    return distributed


def _connect(distributed: Any, address: str) -> Any:
    try:
        return distributed.Client(address, timeout="10s")
    except (OSError, ValueError) as error:
        raise DesignError(
            f"no dask scheduler answers at '{address}': start one with `dask scheduler` and give the address it prints"
        ) from error


def _remote(root: str, name: str, plan: Plan, rows: Sequence[int]) -> StudyTable:
    """Return a chunk, in a worker: it loads the design from the workspace."""
    os.chdir(root)
    return chunk(_design(root, name), plan, rows)


@lru_cache(maxsize=1)  # its loops are prepared once in a worker
def _design(root: str, name: str) -> Stage:
    (stage,) = workspace.designs(Path(root), [name])
    return stage


def _name(stage: Stage, batch: Sequence[range]) -> str:
    return f"{stage.name} rows {batch[0][0]} to {batch[-1][-1]}"


def _compile(stage: Stage, plan: Plan, progress: Progress) -> None:
    progress("compile")
    rig = study_runs.rig(stage)
    experiments = study.select(stage.all_experiments, plan.experiments)
    study.run(rig, experiments[:1], plan.sampling, [0], study_runs.integration_of(stage, plan.experiments))


def _rows(stage: Stage, plan: Plan, rows: Sequence[int]) -> StudyTable:
    return study_runs.run(stage, plan.sampling, plan.experiments, rows)
