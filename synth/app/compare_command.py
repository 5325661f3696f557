"""`synth compare`: two designs of one stage side by side, at the terminal and as a page."""

import sys
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from synth.app import comparison, tables, workspace
from synth.app.command_results import run_jobs
from synth.base import contents, store
from synth.report import comparison as report
from synth.report.comparison import Side
from synth.simulate import study
from synth.simulate.sampling import Sampling


@dataclass(frozen=True)
class CompareChoice:
    """The options of `synth compare`."""

    sampling: Sampling
    experiments: tuple[str, ...]
    report: Path | None


def compare(names: tuple[str, str], as_json: bool, fresh: bool, chosen: CompareChoice) -> int:
    """Run two designs on the same machines and print their experiments, margins and instructions side by side."""
    first, second = (workspace.designs(Path.cwd(), [name])[0] for name in names)
    designs = first, second
    plan = comparison.plan_of(designs, chosen.sampling, chosen.experiments)
    outcomes = run_jobs(comparison.jobs(designs, plan), as_json, fresh)
    if any(outcome.error for outcome in outcomes.values()):
        return 2
    sides = comparison.sides(designs, plan, outcomes)
    if chosen.report is not None:
        store.replace_text(chosen.report, report.page_text(sides))
    if as_json:
        sys.stdout.write(contents.dumps([document(side) for side in sides]) + "\n")
    else:
        tables.print_comparison(sides)
    return 0


def document(side: Side) -> dict[str, Any]:
    """Return one of the designs for JSON."""
    return {
        "design": side.name,
        "rows": len(side.study.rows),
        "yield": vars(study.estimate_yield(side.study)),
        "summaries": [asdict(summary) for summary in study.summarise(side.study)],
        "margins": side.margins,
        "cost": side.cost.document() if side.cost else None,
    }
