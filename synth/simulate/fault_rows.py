"""Table, limits and negative control of a fault campaign, from its runs.

A row has the worst values of one fault in one condition over all plants and onsets. Times to notice and to latch are
the longest of the runs in which the fault has an effect. A run harms the machine where a position runs into a stop that
it does not reach without the fault. The negative control repeats the runs of the nominal plant that latch, with a
controller that never latches: where none of them harms the machine, the campaign cannot tell a good detector from a
missing one.
"""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from fnmatch import fnmatchcase
from functools import partial
from typing import Any

from synth.campaign import FaultLimit
from synth.check import Check
from synth.errors import SignalError
from synth.signals import per_second
from synth.simulate.campaign import FaultRun, HealthyRun, Values
from synth.simulate.rig import Rig

CONTROL = "runs that latch and do no harm without the latch"


@dataclass(frozen=True)
class Row:
    """One fault in one condition: numbers of runs, and the worst values over plants and onsets."""

    group: str
    target: str
    kind: str
    duration: str
    condition: str
    runs: int
    without_effect: int
    noticed: int
    latched: int
    named: int
    wrong_names: int
    harmed: int
    harmed_unnoticed: int
    notice_s: float
    latch_s: float
    excursion: Values
    impacts: Values

    @property
    def impact(self) -> float:
        """The largest speed of an impact on a stop."""
        return max(self.impacts.values(), default=0.0)


@dataclass(frozen=True)
class Campaign:
    """The result: rows, healthy runs, numbers of runs of the negative control, checks, and units of positions.

    Of `control_runs`, `control_harmed` harm the machine when the controller never latches, `control_latched` when it
    does. `spans` and `rate_spans` are the widths of the ranges of positions and velocities, by position; excursions
    and impacts of different units are compared as fractions of them.
    """

    design: str
    plants: int
    rows: tuple[Row, ...]
    healthy: tuple[HealthyRun, ...]
    control_runs: int
    control_harmed: int
    control_latched: int
    checks: tuple[Check, ...]
    units: Mapping[str, str]
    spans: Values
    rate_spans: Values

    @property
    def can_tell(self) -> bool:
        """Whether a fault harms the machine when its controller never latches."""
        return self.control_harmed > 0

    @property
    def alarms(self) -> int:
        """The samples with a fault bit in healthy runs."""
        return sum(h.alarms for h in self.healthy)

    def document(self) -> dict[str, Any]:
        """Return the result as data; a time that is not finite means never."""
        checks = [asdict(c) | {"passed": c.passed} for c in self.checks]
        return asdict(self) | {"can_tell": self.can_tell, "checks": checks}


def rows(runs: Iterable[FaultRun]) -> tuple[Row, ...]:
    """Return the rows in the order of the first run of each."""
    groups: dict[tuple[Any, str], list[FaultRun]] = {}
    for run in runs:
        groups.setdefault((run.injection, run.condition), []).append(run)
    return tuple(_row(each) for each in groups.values())


def _row(runs: Sequence[FaultRun]) -> Row:
    effective = [r for r in runs if r.effect]
    return Row(
        **asdict(runs[0].injection),
        condition=runs[0].condition,
        runs=len(runs),
        without_effect=len(runs) - len(effective),
        noticed=sum(math.isfinite(r.notice_s) for r in runs),
        latched=sum(math.isfinite(r.latch_s) for r in runs),
        named=sum(r.named for r in runs),
        wrong_names=len({name for r in runs for name in r.wrong_names}),
        harmed=sum(r.harms for r in runs),
        harmed_unnoticed=sum(r.harms and math.isinf(r.notice_s) for r in runs),
        notice_s=max((r.notice_s for r in effective), default=0.0),
        latch_s=max((r.latch_s for r in effective), default=0.0),
        excursion=_worst([r.excursion for r in runs]),
        impacts=_worst([r.impacts for r in runs]),
    )


def _worst(values: Sequence[Values]) -> dict[str, float]:
    return {q: max(v[q] for v in values) for q in values[0]}


def campaign(
    rig: Rig, plants: int, runs: Sequence[tuple[HealthyRun, Sequence[FaultRun]]], control: Sequence[FaultRun]
) -> Campaign:
    """Return the result of the runs of each plant and condition; `rig` is from `campaign.with_stops`.

    Raises SignalError for a limit without a fault, or with an unknown measure.
    """
    healthy, every = tuple(h for h, _ in runs), [run for _, faulty in runs for run in faulty]
    nominal = [run for run in every if run.plant == 0]
    pairs = [(c.harms, n.harms) for c, n in zip(control, nominal, strict=True) if math.isfinite(n.latch_s)]
    harmed, harmed_latched = (sum(flags) for flags in zip(*pairs, strict=True)) if pairs else (0, 0)
    states, rates, limits = {s.name: s for s in rig.plant.states}, rig.stage.velocities, rig.stage.faults.limits
    units, table = {q: states[q].unit for q in rates}, rows(every)
    checks = [_check(limit, table, healthy, units) for limit in limits]
    if limits:
        checks.append(Check(CONTROL, float(len(pairs) - harmed), len(pairs) - 1.0, "1", "the negative control"))
    return Campaign(
        rig.stage.name, plants, table, healthy, len(pairs), harmed, harmed_latched, tuple(checks), units,
        {q: states[q].high - states[q].low for q in rates},
        {q: states[v].high - states[v].low for q, v in rates.items()},
    )  # fmt: skip


_MEASURES: Mapping[str, tuple[Callable[[Row], float], str]] = {
    "notice_s": (lambda row: row.notice_s, "s"),
    "latch_s": (lambda row: row.latch_s, "s"),
    "wrong_names": (lambda row: float(row.wrong_names), "1"),
    "impact": (lambda row: row.impact, ""),
}


def _check(limit: FaultLimit, table: Sequence[Row], healthy: Sequence[HealthyRun], units: Mapping[str, str]) -> Check:
    patterns = (limit.target, limit.kind, limit.condition, limit.duration)
    name = f"{limit.measure}: {', '.join(p for p in patterns if p != '*') or 'every fault'}"
    if limit.measure == "false_alarms":
        alarms = sum(h.alarms for h in healthy if fnmatchcase(h.condition, limit.condition))
        return Check(name, float(alarms), limit.most, "1", "samples with a fault bit in healthy runs")
    measure, unit = _measure(limit.measure, units)
    matching = [row for row in table if all(map(fnmatchcase, _columns(row), patterns))]
    if not matching:
        raise SignalError(f"limit '{name}' matches no fault of the campaign: correct its patterns, or leave it out")
    worst = max(matching, key=measure)
    return Check(name, measure(worst), limit.most, unit, ", ".join(_columns(worst)))


def _columns(row: Row) -> tuple[str, str, str, str]:
    return row.target, row.kind, row.condition, row.duration


def _measure(name: str, units: Mapping[str, str]) -> tuple[Callable[[Row], float], str]:
    """Return a measure of a row and its unit."""
    if name in _MEASURES:
        measure, unit = _MEASURES[name]
        return measure, unit or "/".join(sorted({per_second(u) for u in units.values()}))
    what, _, q = name.partition("_")
    if q in units and what == "impact":
        return lambda row: row.impacts[q], per_second(units[q])
    if q in units and what == "excursion":
        return lambda row: row.excursion[q], units[q]
    known = [*_MEASURES, "false_alarms", *(f"{w}_{q}" for q in units for w in ("impact", "excursion"))]
    raise SignalError(f"a fault limit has the measure '{name}': use one of {', '.join(known)}")


def worst_targets(result: Campaign) -> tuple[Row, ...]:
    """Return of each kind, condition and duration the row with the fastest impact, then the largest excursion."""
    groups: dict[tuple[str, ...], list[Row]] = {}
    for row in result.rows:
        groups.setdefault((row.group, row.kind, row.condition, row.duration), []).append(row)
    return tuple(max(each, key=partial(_severity, result)) for each in groups.values())


def _severity(result: Campaign, row: Row) -> tuple[float, float]:
    return _largest(row.impacts, result.rate_spans)[1], _largest(row.excursion, result.spans)[1]


def _largest(values: Values, spans: Values) -> tuple[str, float]:
    """Return the position with the largest value relative to its span, and that ratio."""
    ratios = {q: value / spans[q] for q, value in values.items()}
    return max(ratios.items(), key=lambda pair: pair[1]) if ratios else ("", 0.0)


def cells(result: Campaign, row: Row) -> tuple[str, ...]:
    """Return the cells of a row: times are the slowest, in ms; counts are of the runs, without those without effect."""
    q, stop = _largest(row.excursion, result.spans)[0], _largest(row.impacts, result.rate_spans)[0]
    effective = row.runs - row.without_effect
    return (
        f"{row.target} {row.kind}",
        row.duration,
        row.condition,
        f"{row.excursion[q]:.3g} {result.units[q]} {q}" if q else "",
        f"{row.impacts[stop]:.3g} {per_second(result.units[stop])} {stop}" if row.impact else "",
        _count(row.noticed, effective, row.notice_s),
        _count(row.latched, effective, row.latch_s),
        f"{row.named}/{effective}" + (f", {row.wrong_names} wrong" if row.wrong_names else ""),
        f"{row.without_effect}/{row.runs}" if row.without_effect else "",
    )


def _count(times: int, runs: int, longest_s: float) -> str:
    if not times:
        return "never" if runs else ""
    return f"{1e3 * longest_s:.3g} ms" if times == runs else f"{times}/{runs}"


def notes(result: Campaign) -> tuple[str, ...]:
    """Return lines on false alarms, faults without effect, harm, and the negative control."""
    counts = ("runs", "without_effect", "harmed", "harmed_unnoticed")
    runs, idle, harmed, unnoticed = (sum(getattr(row, name) for row in result.rows) for name in counts)
    stops = sum(any(h.impacts.values()) for h in result.healthy)
    control = (
        f"of {result.control_runs} runs that latch, {result.control_harmed} run into a stop when the controller never "
        f"latches, {result.control_latched} with the latch"
    )
    verdict = "" if result.can_tell else ": the campaign cannot tell whether the detector protects the machine"
    return (
        f"healthy runs: {len(result.healthy)}, {result.alarms} samples with a fault bit, {stops} run into a stop",
        f"faulty runs: {runs}, {idle} without effect, {harmed} run into a stop, {unnoticed} of these without a bit",
        f"negative control: {control}{verdict}",
    )
