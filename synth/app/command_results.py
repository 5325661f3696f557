"""Outcomes of the jobs of a command: run with progress, printed or as one JSON document, with an exit status."""

import sys
from collections.abc import Callable, Mapping, Sequence
from contextlib import nullcontext
from dataclasses import asdict, dataclass
from typing import Any

from rich.console import Console
from rich.markup import escape

from synth.base import contents, progress, store
from synth.base.jobs import Job, Outcome, run


def writer(as_json: bool) -> Callable[[str, str], None]:
    """Return a function of a design's name and a line, which writes both."""
    console = Console(stderr=as_json)
    return lambda name, line: console.print(f"{name}: {line}", highlight=False, markup=False)


def run_jobs(jobs: Sequence[Job], as_json: bool, fresh: bool) -> Mapping[str, Outcome]:
    """Run jobs in parallel, and print why one failed."""
    fresh_run = store.fresh_run() if fresh else nullcontext()
    with fresh_run, progress.display(len(jobs), writer(as_json)) as display:
        outcomes = run(jobs, display)
    console = Console(stderr=True)
    for name, outcome in outcomes.items():
        if outcome.error:
            console.print(f"[bold red]error:[/] {escape(f'{name}: {outcome.error}')}", highlight=False, soft_wrap=True)
    store.trim()
    return outcomes


@dataclass(frozen=True)
class Failed:
    """The name of a design without a result, and the reason."""

    design: str
    error: str


def successful(results: Mapping[str, Any]) -> list[Any]:
    return [result for result in results.values() if not isinstance(result, Failed)]


def finish(
    as_json: bool, documents: Sequence[Mapping[str, Any]], results: Mapping[str, Any], failed: bool = False
) -> int:
    """Print the documents, errors last; return 2 where a design has no result, 1 where a check failed."""
    errors = [asdict(result) for result in results.values() if isinstance(result, Failed)]
    if as_json:
        sys.stdout.write(contents.dumps([*documents, *errors]) + "\n")
    return 2 if errors else int(failed)
