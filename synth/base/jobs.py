"""Parallel jobs: a directed acyclic graph of tasks, each in a process of its own, as many at a time as there are cores.

A process that raises an error, or dies, fails its own job. Jobs that depend on a failed job do not run; all others
finish. Processes are forked: each begins with the imported and parsed modules of this one, and returns data. When this
process is interrupted it stops the others, which remove their temporary files, before the interrupt goes on.
"""

import multiprocessing
import os
import signal
import traceback
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from time import monotonic
from typing import Any, NoReturn

from synth.base.progress import Display, Progress
from synth.errors import SynthError

STOP_S = 5.0  # for a stopped process to remove its temporary files, after which it is killed


@dataclass(frozen=True, eq=False)
class Job:
    """A function to run, with a unique name, once the jobs named in `after` have succeeded.

    `about` goes before each line of its progress. Of the jobs that can run, the first in the list begins first.
    """

    name: str
    about: str
    run: Callable[[Progress], Any]
    after: tuple[str, ...] = ()


@dataclass(frozen=True)
class Outcome:
    """The value that a job returned, or why it failed; `is_crash` marks an error that is not a SynthError."""

    value: Any = None
    error: str = ""
    is_crash: bool = False


@dataclass(frozen=True, eq=False)
class _Running:
    job: Job
    process: Any
    end: Connection


def cores() -> int:
    """Return how many processors this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def run(jobs: Sequence[Job], display: Display, processes: int | None = None) -> Mapping[str, Outcome]:
    """Run jobs, `processes` at a time (by default as many as there are cores); return the outcome of each, by name.

    The `display` is called in this process. Each name in `after` is that of a job.
    """
    outcomes: dict[str, Outcome] = {}
    running: list[_Running] = []
    waiting = list(jobs)
    try:
        while waiting or running:
            while len(running) < (processes or cores()) and (job := _ready(waiting, outcomes)):
                waiting.remove(job)
                running.append(_start(job))
                display.begin(job.name, job.about)
            ready = wait([r.end for r in running], display.tick_s)
            for each in [r for r in running if r.end in ready]:
                if (outcome := _receive(each, display)) is not None:
                    outcomes[each.job.name] = outcome
                    running.remove(each)
                    display.end(each.job.name)
            waiting = _skip_dependents(waiting, outcomes, display)
            display.tick()
    finally:
        _stop(running)
    return {job.name: outcomes[job.name] for job in jobs}


def _stop(running: Sequence[_Running]) -> None:
    """Stop processes; kill those that do not end in time, since a long computation outside Python cannot hear."""
    for each in running:
        each.process.terminate()
    deadline = monotonic() + STOP_S
    for each in running:
        each.process.join(max(0.0, deadline - monotonic()))
        each.process.kill()
        each.process.join()


def _skip_dependents(waiting: Sequence[Job], outcomes: dict[str, Outcome], display: Display) -> list[Job]:
    """Return the jobs that can still run; a job that depends on a failed one fails too."""
    left = list(waiting)
    for job in waiting:
        failed = [name for name in job.after if name in outcomes and outcomes[name].error]
        if failed:
            outcomes[job.name] = Outcome(error=f"not run: {failed[0]} failed")
            left.remove(job)
            display.end(job.name)
    return left if len(left) == len(waiting) else _skip_dependents(left, outcomes, display)


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
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, _end_process)
    try:
        outcome = Outcome(job.run(lambda line: end.send(line)))
        end.send(outcome)
    except (SynthError, OSError) as error:
        end.send(Outcome(error=str(error)))
    except _Stopped:
        raise
    except BaseException:
        end.send(Outcome(error=traceback.format_exc(), is_crash=True))


class _Stopped(SystemExit):
    """The end of a process that was asked to stop: its `finally` clauses run, and it says nothing."""


def _end_process(number: int, _: object) -> NoReturn:
    raise _Stopped(128 + number)


def _receive(running: _Running, display: Display) -> Outcome | None:
    """Show a line of progress and return None, or return the outcome of the job."""
    try:
        message = running.end.recv()
    except (EOFError, OSError):
        running.process.join()
        return Outcome(error=f"its process ended with status {running.process.exitcode}", is_crash=True)
    if isinstance(message, str):
        display.report(running.job.name, running.job.about, message)
        return None
    running.process.join()
    return message if isinstance(message, Outcome) else Outcome(message)
