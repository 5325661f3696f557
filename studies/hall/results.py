"""Results of the studies as a document: the date, the revision, and for each figure its study, value and limit.

There is no verdict in it: whoever quotes a figure compares it with its limit.
"""

from collections.abc import Iterator, Mapping, Sequence
from math import isinf
from typing import Any

from studies.hall.costs import Row
from synth.check import Check
from synth.simulate.experiments import Experiment

COST = "instructions a sample, Cortex-M4F"


def document(
    date: str, revision: str, checks: Mapping[str, Sequence[Check]], runs: Sequence[Experiment], rows: Sequence[Row]
) -> dict[str, Any]:
    """Return date, revision and figures: those of the checks by study, of the experiments, and the costs."""
    figures = [_check(study, check) for study, each in checks.items() for check in each]
    for run in runs:
        figures += [_figure(run.title, name, value) for name, value in run.figures.items()]
        figures += [_check(run.title, check) for check in run.checks]
    return {"date": date, "revision": revision, "figures": [*figures, *_costs(rows)]}


def _figure(study: str, figure: str, value: float, unit: str = "") -> dict[str, Any]:
    return {"study": study, "figure": figure, "value": value, "unit": unit}


def _check(study: str, check: Check) -> dict[str, Any]:
    bound = {} if isinf(check.limit) else {"at_least" if check.at_least else "at_most": check.limit}
    return _figure(study, check.name, check.value, check.unit) | bound


def _costs(rows: Sequence[Row]) -> Iterator[dict[str, Any]]:
    for row in rows:
        what = f"{row.estimator}, {row.build}, {row.steps} steps"
        yield _figure(COST, f"{what}: emitted C", row.emitted, "1")
        yield _figure(COST, f"{what}: CasADi's C", row.casadi, "1")
