"""Progress of long work as bars at a terminal (`rich.progress`, as `tqdm`), elsewhere as lines.

A long function calls `progress` with a line for each part of its work, and may add how much is done:

    progress("witnesses")                  the part that begins now
    progress(Counted("step_z", 3, 12))     the same, when 3 of 12 parts are done

`bar` makes such a callable for a prompt, a script or a notebook:

    with progress.bar("experiments") as report:
        runs = tasks.experiments(DESIGN, report)
"""

import os
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any, Protocol, TypeVar

Progress = Callable[[str], None]
T = TypeVar("T")

TICK_S = 0.2  # between two looks at the clock while nothing is reported
BAR = 12  # characters: what is done needs the rest of 80 columns


class Counted(str):
    """A line of progress that says how many parts, of how many in all, are done."""

    done: int
    total: int

    def __new__(cls, line: str, done: int = 0, total: int = 0) -> "Counted":
        """Return the line with its counts."""
        counted = super().__new__(cls, line)
        counted.done, counted.total = done, total
        return counted


def each(items: Sequence[T], progress: Progress, line: Callable[[T], str]) -> Iterator[T]:
    """Yield the items, each reported by its `line` and its place before the work on it begins."""
    for k, item in enumerate(items):
        progress(Counted(line(item), k, len(items)))
        yield item


def numbered(progress: Progress, total: int) -> Progress:
    """Return a callable that counts the lines reported to it, one for each of `total` parts."""
    lines: list[str] = []

    def report(line: str) -> None:
        progress(Counted(line, min(len(lines), total), total))
        lines.append(line)

    return report


def write(lines: Iterable[str]) -> None:
    """Write lines to the standard output, each as soon as it is computed."""
    for line in lines:
        sys.stdout.write(f"{line}\n")
        sys.stdout.flush()


def silent(line: str) -> None:
    """Report nothing."""


class Display(Protocol):
    """Where the progress of several jobs is shown; `tick_s` is the time between calls of `tick`, None for none."""

    tick_s: float | None

    def begin(self, job: str, about: str) -> None:
        """Show that a job begins, which is `about` a design."""
        ...

    def report(self, job: str, about: str, line: str) -> None:
        """Show a line of a job."""
        ...

    def end(self, job: str) -> None:
        """Show that a job has ended."""
        ...

    def tick(self) -> None:
        """Show how long the jobs have been running."""
        ...


class Lines:
    """Progress as whole lines, each passed to `write(about, line)`."""

    tick_s: float | None = None

    def __init__(self, write: Callable[[str, str], None]) -> None:
        self._write = write

    def begin(self, job: str, about: str) -> None:
        """Show nothing."""

    def report(self, job: str, about: str, line: str) -> None:
        """Write a line."""
        self._write(about, line)

    def end(self, job: str) -> None:
        """Show nothing."""

    def tick(self) -> None:
        """Show nothing."""


class Bars:
    """A bar for all of `total` jobs and one for each that runs, with the time since it began, on stderr.

    No thread refreshes them, since a process that is forked while a thread holds a lock may wait for it permanently.
    """

    tick_s: float | None = TICK_S

    def __init__(self, total: int) -> None:
        from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn
        from rich.table import Column

        self._bars = Progress(
            TextColumn("{task.description}", markup=False, table_column=Column(ratio=1, no_wrap=True)),
            BarColumn(BAR),
            TextColumn("{task.fields[count]}", table_column=Column(no_wrap=True)),
            TimeElapsedColumn(),
            console=_console(),
            auto_refresh=False,
            transient=True,
            expand=True,
            redirect_stdout=False,
            redirect_stderr=False,
        )
        self._total, self._ended, self._rows = total, 0, dict[str, Any]()
        self._whole = self._bars.add_task("all", total=total, count=f"0/{total}") if total > 1 else None

    def __enter__(self) -> "Bars":
        """Show the bars."""
        self._bars.start()
        return self

    def __exit__(self, *_: object) -> None:
        """Take the bars off the terminal."""
        self._bars.stop()

    def begin(self, job: str, about: str) -> None:
        """Add a bar."""
        self._rows[job] = self._bars.add_task(job, total=None, count="")
        self._bars.refresh()

    def report(self, job: str, about: str, line: str) -> None:
        """Show the line beside the job's bar."""
        done, total = (line.done, line.total) if isinstance(line, Counted) else (0, None)
        count = "" if total is None else f"{done}/{total}"
        self._bars.update(self._rows[job], description=f"{job}: {line}", completed=done, total=total, count=count)
        self._bars.refresh()

    def end(self, job: str) -> None:
        """Remove the job's bar, and count it."""
        if job in self._rows:
            self._bars.remove_task(self._rows.pop(job))
        self._ended += 1
        if self._whole is not None:
            self._bars.update(self._whole, completed=self._ended, count=f"{self._ended}/{self._total}")
        self._bars.refresh()

    def tick(self) -> None:
        """Show the time."""
        self._bars.refresh()


@contextmanager
def display(total: int, write: Callable[[str, str], None]) -> Iterator[Display]:
    """Show the progress of `total` jobs as bars where stderr is a terminal, else as lines passed to `write`."""
    if not is_terminal():
        yield Lines(write)
        return
    with Bars(total) as bars:
        yield bars


@contextmanager
def bar(work: str) -> Iterator[Progress]:
    """Show the progress of one piece of work at a terminal or in a notebook; nothing where stderr is a file."""
    if not (is_terminal() or _console().is_jupyter):
        yield silent
        return
    with Bars(1) as bars:
        bars.begin(work, "")
        yield lambda line: bars.report(work, "", line)


def is_terminal() -> bool:
    """Return whether stderr is a terminal that can redraw a line."""
    return sys.stderr.isatty() and os.environ.get("TERM") not in ("dumb", "unknown")


def _console() -> Any:
    from rich.console import Console

    return Console(stderr=True)
