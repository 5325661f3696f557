"""`synth tune`: the proposal of a search over the free parameters of a law, at the terminal and as a page."""

import sys
from dataclasses import asdict, dataclass
from pathlib import Path
from time import monotonic
from typing import Any

from synth.app import tables, tune_jobs, tune_search, workspace
from synth.app.command_results import writer
from synth.base import contents, progress, store
from synth.declare.tuning import Plan, Tuned
from synth.report import tuning as report


@dataclass(frozen=True)
class TuneChoice:
    """The options of `synth tune`."""

    plan: Plan
    report: Path | None


def tune(name: str, as_json: bool, chosen: TuneChoice) -> int:
    """Search the free parameters of a design for values that reach its goals, and print them as a proposal."""
    (design,) = workspace.designs(Path.cwd(), [name])
    write, begun = writer(as_json), monotonic()
    with progress.display(1, lambda about, line: write(about, f"{line}, {monotonic() - begun:.0f} s")) as display:
        display.begin(name, name)
        display.report(name, name, "compile the declared law")
        search = tune_jobs.prepare(design, chosen.plan)
        tuned = tune_search.search(search, display)
    store.trim()
    if chosen.report is not None:
        store.replace_text(chosen.report, report.page_text(name, search.tuning, tuned))
    if as_json:
        sys.stdout.write(contents.dumps(document(tuned)) + "\n")
    else:
        tables.print_tuning(name, search.tuning, tuned)
    return int(not tuned.passed)


def document(tuned: Tuned) -> dict[str, Any]:
    """Return the result for JSON; `goals` have no ratios, which follow from value and limit."""
    return asdict(tuned) | {"passed": tuned.passed}
