"""`synth tune`: the proposal of a search over the free parameters of a law, at the terminal and as a page."""

import sys
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from time import monotonic
from typing import Any

from synth.app import bench, tables, tasks, tune_jobs, tune_search, workspace
from synth.app.tables import writer
from synth.base import contents, progress, store
from synth.declare.tuning import BenchMargins, Plan, Tuned
from synth.errors import DesignError
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


def tune_on_bench(name: str, as_json: bool, chosen: Sequence[str], write_to: Path | None) -> int:
    """Print the margins of `name=value` on the bench of a design, or over all of it, and write the constants.

    Values that miss what is required are not written.
    """
    (design,) = workspace.designs(Path.cwd(), [name])
    bench.of(design)
    if not chosen:
        write, begun = writer(as_json), monotonic()
        with progress.display(1, lambda about, line: write(about, f"{line}, {monotonic() - begun:.0f} s")) as display:
            display.begin(name, name)
            over_bench = bench.over(design, lambda line: display.report(name, name, line))
    else:
        over_bench = BenchMargins((bench.try_values(design, dict(_value(text) for text in chosen)),))
    store.trim()
    missed = chosen and over_bench.tried[0].missed
    if as_json:
        sys.stdout.write(contents.dumps(asdict(over_bench)) + "\n")
    else:
        tables.print_sheet(report.bench_sheet(design, over_bench))
    if write_to is not None and not missed:
        emitted = tasks.emission(design, design.scalar).result(progress.silent)[design.name]
        store.replace_text(write_to, bench.set_file(design, over_bench.tried[0], emitted.manifest))
    return int(bool(missed))


def _value(text: str) -> tuple[str, float]:
    """Return name and value of `name=value`; raise DesignError for another form."""
    name, _, value = text.partition("=")
    try:
        return name.strip(), float(value)
    except ValueError:
        raise DesignError(f"found '{text}', need the name of a parameter and a number, such as damping=1e3") from None


def document(tuned: Tuned) -> dict[str, Any]:
    """Return the result for JSON; `goals` have no ratios, which follow from value and limit."""
    return asdict(tuned) | {"passed": tuned.passed}
