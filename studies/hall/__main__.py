"""Run the studies: `python -m studies.hall`, minutes of processor time. Exit status 1 if a check fails.

Writes results.json beside this file, which the report of hall_position quotes with its date and revision, and
reports/hall_studies.html. Results are cached; with SYNTH_FRESH all are computed again.
"""

import argparse
import subprocess
import sys
from datetime import UTC, datetime
from pathlib import Path

from designs.hall_position import config
from studies.hall import costs, page, results
from studies.hall.calibrated import survey
from studies.hall.loop import experiments, four_experiments
from studies.hall.pages import integrity
from studies.hall.trust import endurance
from studies.hall.trust.estimator_ensemble import EstimatorConfig
from synth.base import contents, progress

RESULTS, PAGE = Path(__file__).with_name("results.json"), Path("reports", "hall_studies.html")
BODIES, SAMPLES = 2000, 5000  # in random motion: ten million samples


def revision() -> str:
    """Return the revision of the working tree, marked if it has other changes."""
    command = ["git", "describe", "--always", "--dirty"]
    return subprocess.run(command, cwd=RESULTS.parent, capture_output=True, text=True, check=True).stdout.strip()


def run(date: str, revision: str) -> bool:
    """Run all studies and write their results and their page; return whether every check passes."""
    with progress.bar("studies of hall_position") as report:
        report("random motion")
        checks = {
            "random motion": endurance.checks(config.NAME, EstimatorConfig(config.array()), BODIES, SAMPLES),
            "calibrated units": survey.checks(report),
        }
        runs = [*experiments.run(report), *experiments.compare_sources(report), *four_experiments.run(report)]
        surveyed, measured = integrity.tables(report), costs.measure(report)
        report("page")
        html = page.report(checks, runs, surveyed, measured)
    RESULTS.write_text(
        contents.dumps(results.document(date, revision, checks, runs, measured)) + "\n", encoding="utf-8"
    )
    PAGE.parent.mkdir(exist_ok=True)
    PAGE.write_text(html, encoding="utf-8")
    every = [c for each in checks.values() for c in each] + [c for run in runs for c in run.checks]
    progress.write(f"FAILED: {c.name} is {c.value:.4g} {c.unit}, limit {c.limit:g}" for c in every if not c.passed)
    return all(c.passed for c in every)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(prog="python -m studies.hall", description=__doc__)
    parser.add_argument("--date", default=datetime.now(UTC).date().isoformat(), help="of the results; today")
    parser.add_argument("--revision", default=None, help="of the results; that of git")
    given = parser.parse_args()
    sys.exit(not run(given.date, given.revision or revision()))
