"""Jobs side by side: a graph of tasks on all cores, each in a process of its own.

A process that raises, or dies, fails its own job; those that come after it are not run, all others finish. Processes
are forked, so that each begins with what this one has imported and parsed; what it returns must be data.
"""

import multiprocessing
import os
import traceback
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from typing import Any

from synth.errors import SynthError

Progress = Callable[[str], None]


@dataclass(frozen=True, eq=False)
class Job:
    """What is run, under a name of its own, once the jobs `after` which it comes have succeeded.

    `about` goes before each line of its progress. Of the jobs that may run, the first in the list is begun first.
    """

    name: str
    about: str
    run: Callable[[Progress], Any]
    after: tuple[str, ...] = ()


@dataclass(frozen=True)
class Outcome:
    """What a job returned, or why it failed: `expected` tells an error on purpose from a crash."""

    value: Any = None
    error: str = ""
    expected: bool = True


@dataclass(frozen=True, eq=False)
class _Running:
    job: Job
    process: Any
    end: Connection


def cores() -> int:
    """Return how many processors this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def run(jobs: Sequence[Job], say: Callable[[str, str], None], processes: int | None = None) -> Mapping[str, Outcome]:
    """Run jobs, `processes` at a time (as many as there are cores); return what became of each, by name.

    `say(about, line)` is called for each line of progress, in this process. Each name in `after` is that of a job.
    """
    outcomes: dict[str, Outcome] = {}
    running: list[_Running] = []
    waiting = list(jobs)
    try:
        while waiting or running:
            while len(running) < (processes or cores()) and (job := _ready(waiting, outcomes)):
                waiting.remove(job)
                running.append(_start(job))
            for each in [r for end in wait([r.end for r in running]) for r in running if r.end is end]:
                if (outcome := _heard(each, say)) is not None:
                    outcomes[each.job.name] = outcome
                    running.remove(each)
            waiting = _skip_failed(waiting, outcomes)
    finally:
        for each in running:
            each.process.terminate()
    return {job.name: outcomes[job.name] for job in jobs}


def _skip_failed(waiting: Sequence[Job], outcomes: dict[str, Outcome]) -> list[Job]:
    """Return the jobs that may still run; those after a failed one have failed too."""
    left = list(waiting)
    for job in waiting:
        failed = [name for name in job.after if name in outcomes and outcomes[name].error]
        if failed:
            outcomes[job.name] = Outcome(error=f"not run: {failed[0]} failed")
            left.remove(job)
    return left if len(left) == len(waiting) else _skip_failed(left, outcomes)


def _ready(waiting: Sequence[Job], outcomes: Mapping[str, Outcome]) -> Job | None:
    return next((job for job in waiting if all(name in outcomes for name in job.after)), None)


def _start(job: Job) -> _Running:
    context = multiprocessing.get_context("fork")
    end, far = context.Pipe()
    process = context.Process(target=_work, args=(job, far), daemon=True)
    process.start()
    far.close()
    return _Running(job, process, end)


def _work(job: Job, end: Connection) -> None:
    """Run a job in its process; send its progress and then its outcome."""
    try:
        outcome = Outcome(job.run(lambda line: end.send(line)))
        end.send(outcome)
    except (SynthError, OSError) as error:
        end.send(Outcome(error=str(error)))
    except BaseException:
        end.send(Outcome(error=traceback.format_exc(), expected=False))


def _heard(running: _Running, say: Callable[[str, str], None]) -> Outcome | None:
    """Pass on a line of progress and return None, or return how the job ended."""
    try:
        message = running.end.recv()
    except (EOFError, OSError):
        running.process.join()
        return Outcome(error=f"its process ended with status {running.process.exitcode}", expected=False)
    if isinstance(message, str):
        say(running.job.about, message)
        return None
    running.process.join()
    return message if isinstance(message, Outcome) else Outcome(message)
