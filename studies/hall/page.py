"""Page of the studies: report.md and report.toml with the computed blocks."""

import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path

from models.hall_stage import Stage
from studies.hall import costs
from studies.hall.costs import Row
from studies.hall.loop import calibration
from studies.hall.pages import accuracy, experiments, integrity, loops, six, trust
from synth.check import Check
from synth.report import page, prose
from synth.report.prose import Content
from synth.simulate.experiments import Experiment

TITLE = "hall_position: studies"
ABOUT = (
    "What the estimators do beyond the paper and beyond their verification: accuracy, convergence, failures of "
    "sensors, calibration, loops closed by the estimate, and six degrees of freedom."
)
CHECKS = "Limits of the studies"


def report(
    checks: Mapping[str, Sequence[Check]],
    runs: Sequence[Experiment],
    surveyed: Mapping[str, Content],
    measured: Sequence[Row],
) -> str:
    """Return the page as one HTML document, from the checks by study, all experiments, and the computed tables."""
    folder = Path(__file__).parent
    data = tomllib.loads((folder / "report.toml").read_text(encoding="utf-8"))
    stage = Stage()
    contents: dict[str, Content] = {
        **accuracy.blocks(stage),
        **trust.blocks(trust.estimators()),
        **integrity.blocks(),
        **surveyed,
        **experiments.blocks(calibration.calibrated_source().map if runs else None, runs),
        **six.blocks(stage),
    }
    equations = {f"equations.{e['name']}": page.Equations(tuple(map(tuple, e["rows"]))) for e in data["equations"]}
    values = {**equations, **prose.with_captions(contents, data["blocks"])}
    parts = [
        experiments.section(runs, data["published"]),
        *((loops.section(),) if runs else ()),
        six.section(stage),
        costs.section(measured),
        page.Section(CHECKS, tuple(page.Checks(study, tuple(each)) for study, each in checks.items())),
    ]
    words = prose.parse((folder / "report.md").read_text(encoding="utf-8"), values)
    return page.render(page.Report(TITLE, ABOUT, tuple(prose.merge(parts, words.parts))))
