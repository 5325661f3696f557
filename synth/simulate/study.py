"""Monte Carlo study of a stage: its experiments on many machines within their tolerances, against the requirements.

    yield = share of the machines that keep every limit       Clopper and Pearson's interval
    driver of a figure = quantity z, or its size |z|, with the largest |rank correlation| (Spearman)

A table has one row for each machine, which its number and the seed determine. The largest value of a sample is a lower
bound of the worst case.

The table of a study as CSV, as Parquet and as a document for JSON.
"""

import csv
import io
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from fnmatch import fnmatchcase
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from synth.base import store
from synth.check import Check, describe
from synth.errors import DesignError
from synth.simulate import experiments as runs
from synth.simulate import sampling
from synth.simulate.integration import Integration
from synth.simulate.lanes import lockstep
from synth.simulate.lanes.lane_blocks import Name
from synth.simulate.lanes.lanes import LANES
from synth.simulate.rig import Rig, Simulate
from synth.simulate.sampling import Sampling

Array = NDArray[np.float64]

CONFIDENCE = 0.95


@dataclass(frozen=True)
class StudyTable:
    """Rows of a study: their numbers (rows,), and columns (rows,) by name.

    `z` has the deviations of the quantities, in tolerances. `figures` and `checks` are called "experiment: name", with
    the `limits` of the checks and the unit of each in `units`. `errors` tells why a row has no value of an experiment,
    as (row, experiment, reason); its values are NaN.
    """

    rows: NDArray[np.int64]
    z: Mapping[str, Array]
    figures: Mapping[str, Array]
    checks: Mapping[str, Array]
    limits: Mapping[str, float]
    units: Mapping[str, str]
    integration: Integration
    errors: tuple[tuple[int, str, str], ...] = ()

    @property
    def passed(self) -> NDArray[np.bool_]:
        """Whether each row keeps every limit (rows,)."""
        kept = [self.checks[name] <= limit for name, limit in self.limits.items()]
        failed = np.isin(self.rows, [row for row, _, _ in self.errors])
        return np.asarray(np.logical_and.reduce([~failed, *kept]))


@dataclass(frozen=True)
class Summary:
    """The distribution of one figure or check over the rows of a study.

    `median` and `percentile_95` are the least values that at least 50 and 95 % of the rows do not exceed.
    `worst` is the largest value, of row `worst_row`; for a figure without a limit `limit` is NaN and `passed` 1.
    `driver` is the quantity, or its size as "|name|", with the largest rank correlation, `correlation`.
    """

    name: str
    unit: str
    nominal: float
    median: float
    percentile_95: float
    worst: float
    worst_row: int
    limit: float
    passed: float
    driver: str
    correlation: float


def select(experiments: Sequence[Any], patterns: Sequence[str]) -> list[Any]:
    """Return the experiments whose names match one of the patterns (`fnmatch`), all without patterns.

    Raises DesignError for a pattern that matches none.
    """
    for pattern in patterns:
        if not any(fnmatchcase(e.name, pattern) for e in experiments):
            names = ", ".join(e.name for e in experiments) or "none"
            raise DesignError(f"no experiment is called '{pattern}': choose from {names}")
    return [e for e in experiments if not patterns or any(fnmatchcase(e.name, p) for p in patterns)]


def run(
    rig: Rig, experiments: Sequence[Any], drawn: Sampling, rows: Sequence[int], integration: Integration
) -> StudyTable:
    """Run the experiments on the machines of the rows, side by side."""
    z = sampling.draw(drawn, len(sampling.quantities(rig)), rows)
    return run_machines(rig, experiments, z, drawn.seed, rows, integration)


def run_machines(
    rig: Rig, experiments: Sequence[Any], z: Array, seed: int, rows: Sequence[int], integration: Integration
) -> StudyTable:
    """Run the experiments on machines with the deviations z (rows, quantities) and the sensor noise of their rows."""
    names, tables = sampling.quantities(rig), []
    reads: dict[str, list[set[Name]]] = {e.name: [] for e in experiments}
    for first in range(0, len(rows), LANES):
        batch = slice(first, first + LANES)
        machines = [
            sampling.machine(rig, dict(zip(names, values, strict=True)), seed, row)
            for row, values in zip(rows[batch], z[batch], strict=True)
        ]
        nominals = (rig.plant, rig.stage.plant)
        results = {e.name: lockstep.run(_runs(e, machines), nominals, integration, reads[e.name]) for e in experiments}
        tables.append(_table(rows[batch], names, z[batch], results, integration))
    return join(tables)


@dataclass(frozen=True)
class _Measured:
    """What a study keeps of an experiment: no trajectory, whose memory many machines would need at once."""

    figures: Mapping[str, float]
    checks: tuple[Check, ...]


def _runs(experiment: Any, machines: Sequence[Rig]) -> list[Callable[[Simulate], _Measured]]:
    return [partial(_run, experiment, machine) for machine in machines]


def _run(experiment: Any, machine: Rig, simulate: Simulate) -> _Measured:
    finished = runs.result(experiment, replace(machine, simulate=simulate))
    return _Measured(finished.figures, finished.checks)


def _table(
    rows: Sequence[int],
    names: Sequence[str],
    z: Array,
    results: Mapping[str, Sequence[lockstep.Result[_Measured]]],
    integration: Integration,
) -> StudyTable:
    n = len(rows)
    figures, checks = dict[str, Array](), dict[str, Array]()
    limits, units = dict[str, float](), dict[str, str]()
    errors: list[tuple[int, str, str]] = []
    for experiment, each in results.items():
        for k, result in enumerate(each):
            if result.value is None:
                errors.append((rows[k], experiment, describe(result.error or DesignError("no result"))))
                continue
            for name, value in result.value.figures.items():
                figures.setdefault(f"{experiment}: {name}", np.full(n, np.nan))[k] = value
            for check in result.value.checks:
                name = f"{experiment}: {check.name}"
                checks.setdefault(name, np.full(n, np.nan))[k] = check.value
                limits[name], units[name] = check.limit, check.unit
    columns = dict(zip(names, z.T.copy(), strict=True))
    return StudyTable(np.array(rows, np.int64), columns, figures, checks, limits, units, integration, tuple(errors))


def join(tables: Sequence[StudyTable]) -> StudyTable:
    """Return the rows of all tables in one, in order."""
    rows = np.concatenate([t.rows for t in tables])

    def columns(groups: Sequence[Mapping[str, Array]]) -> dict[str, Array]:
        names = dict.fromkeys(name for group in groups for name in group)
        absent = [np.full(len(t.rows), np.nan) for t in tables]
        return {n: np.concatenate([g.get(n, a) for g, a in zip(groups, absent, strict=True)]) for n in names}

    return StudyTable(
        rows,
        columns([t.z for t in tables]),
        columns([t.figures for t in tables]),
        columns([t.checks for t in tables]),
        {name: limit for t in tables for name, limit in t.limits.items()},
        {name: unit for t in tables for name, unit in t.units.items()},
        tables[0].integration,
        tuple(error for t in tables for error in t.errors),
    )


def summarise(table: StudyTable) -> list[Summary]:
    """Return the distribution of every check, then of every figure."""
    ranks, columns = _ranks(table), [*table.checks.items(), *table.figures.items()]
    return [_summary(table, name, values, _driver(ranks, values)) for name, values in columns]


def _summary(table: StudyTable, name: str, values: Array, driver: tuple[str, float]) -> Summary:
    limit = table.limits.get(name, np.nan)
    known = values[~np.isnan(values)]
    worst = int(np.nanargmax(values)) if len(known) else 0
    passed = float(np.mean(values <= limit)) if name in table.limits else 1.0
    middle, high = np.percentile(known, [50, 95], method="inverted_cdf") if len(known) else (np.nan, np.nan)
    return Summary(
        name,
        table.units.get(name, ""),
        float(values[0]),
        float(middle),
        float(high),
        float(values[worst]),
        int(table.rows[worst]),
        float(limit),
        passed,
        *driver,
    )


def _ranks(table: StudyTable) -> dict[str, Array]:
    """Return the ranks of z and, for what a deviation to either side changes alike, of |z|, called "|name|"."""
    from scipy import stats  # slow to import (1 s) and seldom needed

    plain = {name: z for name, z in table.z.items() if np.ptp(z) > 0}
    sizes = {f"|{name}|": size for name, z in plain.items() if len(np.unique(size := np.abs(z))) > 2}
    return {name: stats.rankdata(values) for name, values in {**plain, **sizes}.items()}


def _driver(ranks: Mapping[str, Array], values: Array) -> tuple[str, float]:
    """Return the quantity with the largest rank correlation, and that; ("", 0) where a value does not vary."""
    from scipy import stats  # slow to import (1 s) and seldom needed

    known = ~np.isnan(values)
    y = stats.rankdata(values[known])
    if len(y) < 3 or np.ptp(y) == 0:
        return "", 0.0
    x = {name: r if known.all() else stats.rankdata(r[known]) for name, r in ranks.items()}
    correlations = {name: float(np.corrcoef(r, y)[0, 1]) for name, r in x.items() if np.ptp(r) > 0}
    driver = max(correlations, key=lambda name: abs(correlations[name]), default="")
    return driver, correlations.get(driver, 0.0)


@dataclass(frozen=True)
class Yield:
    """The share of machines that keep every limit, with the ends of its confidence interval."""

    share: float
    low: float
    high: float


def estimate_yield(table: StudyTable) -> Yield:
    """Return the yield with Clopper and Pearson's interval of 95 % confidence, without row 0, which is not drawn.

    The interval is for rows that are drawn independently: corners and Latin rows are not those of the tolerances.
    """
    from scipy import stats  # slow to import (1 s) and seldom needed

    drawn = np.asarray(table.passed)[np.asarray(table.rows) != 0]
    kept, n = int(drawn.sum()), len(drawn)
    if n == 0:
        return Yield(float(np.mean(table.passed)), 0.0, 1.0)
    interval = stats.binomtest(kept, n).proportion_ci(CONFIDENCE, "exact")
    return Yield(kept / n, float(interval.low), float(interval.high))


def yield_notes(table: StudyTable) -> list[str]:
    """Return the yield as a sentence, and why machines have no result."""
    share = estimate_yield(table)
    errors = Counter((experiment, reason) for _, experiment, reason in table.errors)
    return [
        f"{int(table.passed.sum())} of {len(table.rows)} machines keep every limit: yield {share.share:.2%}, "
        f"{share.low:.2%} to {share.high:.2%} with {CONFIDENCE:.0%} confidence.",
        *(f"No result of {experiment} on {n} machines: {reason}" for (experiment, reason), n in errors.items()),
    ]


def notes(table: StudyTable) -> list[str]:
    """Return the yield, why machines have no result, how the loops were integrated, and what the values mean."""
    return [
        *yield_notes(table),
        f"{table.integration.substeps} steps of order {table.integration.order} a sample in lanes, with an error of a "
        f"state of at most {table.integration.error:.1e} of its range in the first experiment with ideal sensors.",
        "The worst value of a sample is a lower bound of the worst case. A driver is the quantity with the largest "
        "rank correlation; |h| where deviations of h to both sides act alike.",
    ]


def columns(table: StudyTable) -> dict[str, NDArray[Any]]:
    """Return the columns by name: row, deviations z in tolerances, checks and figures."""
    return {"row": table.rows, **{f"z {n}": z for n, z in table.z.items()}, **table.checks, **table.figures}


def csv_text(table: StudyTable) -> str:
    """Return the table as comma-separated values."""
    lines = io.StringIO()
    writer = csv.writer(lines, lineterminator="\n")
    writer.writerow(columns(table))
    writer.writerows(zip(*(values.tolist() for values in columns(table).values()), strict=True))
    return lines.getvalue()


def require_parquet() -> tuple[Any, Any]:
    """Return pyarrow and its module of Parquet; raise DesignError where they are not installed."""
    try:
        return import_module("pyarrow"), import_module("pyarrow.parquet")
    except ImportError as error:
        raise DesignError(
            "a table as Parquet needs pyarrow, which is not installed: run `pip install 'synth-stage[parquet]'`, "
            "or give --csv"
        ) from error


def write_parquet(table: StudyTable, path: Path) -> None:
    """Write the table as Parquet, in one step; raise DesignError without pyarrow."""
    arrow, parquet = require_parquet()
    buffer = io.BytesIO()
    parquet.write_table(arrow.table({name: np.asarray(v) for name, v in columns(table).items()}), buffer)
    store.replace_bytes(path, buffer.getvalue())


def document(table: StudyTable) -> dict[str, Any]:
    """Return the summary for JSON."""
    share = estimate_yield(table)
    return {
        "rows": len(table.rows),
        "yield": {"share": share.share, "low": share.low, "high": share.high, "confidence": CONFIDENCE},
        "integration": vars(table.integration),
        "summaries": [vars(summary) for summary in summarise(table)],
        "errors": [list(error) for error in table.errors],
    }
