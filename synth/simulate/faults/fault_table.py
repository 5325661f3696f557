"""Table of a fault campaign as text: rows, magnitudes, and notes on false alarms and the negative control.

Rows, limits and negative control of a fault campaign, from its runs.

A row has the worst values of one fault in one condition over all plants and onsets. Times to notice and to latch are
the longest of the runs in which the fault has an effect. A run harms the machine where a position runs into a stop that
it does not reach without the fault. The negative control repeats the runs of the nominal plant that latch, with a
controller that never latches: where none of them harms the machine, or they keep every limit that applies to them, the
campaign cannot tell a good detector from a missing one.
"""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from fnmatch import fnmatchcase
from functools import partial
from typing import Any

from synth.check import Check
from synth.declare.fault_campaign import FaultLimit
from synth.errors import SignalError
from synth.signals import per_second
from synth.simulate.faults import injections
from synth.simulate.faults.campaign import FaultRun, HealthyRun, Sweep, Values, condition_names
from synth.simulate.rig import Rig

UNLIMITED = tuple(FaultLimit(name, math.inf) for name in ("false_alarms", "healthy_impact", "impact"))
CONTROL = "runs that latch and do no harm without the latch"
CONTROL_LIMITS = "limits that hold without the latch, too"
Healthy = Sequence[HealthyRun]


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
    energies: Values
    speeds: Values
    final_speeds: Values

    @property
    def impact(self) -> float:
        """The largest speed of an impact on a stop."""
        return max(self.impacts.values(), default=0.0)

    @property
    def energy(self) -> float:
        """The largest energy of an impact in J, of the positions with a declared inertia."""
        return max(self.energies.values(), default=0.0)

    @property
    def fault(self) -> tuple[str, ...]:
        """Class, target, kind, duration and condition."""
        return self.group, self.target, self.kind, self.duration, self.condition


@dataclass(frozen=True)
class Campaign:
    """The result: rows, healthy runs, numbers of runs of the negative control, checks, and units of positions.

    The stage has `derived` faults, of which a build runs the basic ones: no check has the limits of the others. Of
    `control_runs`, `control_harmed` harm the machine when the controller never latches, `control_latched` when it
    does. `sweeps` are empty where none was run. `spans` and `rate_spans` are the widths of the ranges of positions and
    velocities, by position; excursions and impacts of different units are compared as fractions of them. `regulated`
    are the positions with a set-point, or all where none has one.
    """

    design: str
    plants: int
    derived: int
    rows: tuple[Row, ...]
    healthy: tuple[HealthyRun, ...]
    sweeps: tuple[Sweep, ...]
    control_runs: int
    control_harmed: int
    control_latched: int
    checks: tuple[Check, ...]
    units: Mapping[str, str]
    spans: Values
    rate_spans: Values
    regulated: tuple[str, ...]

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
        checks = [c.document() for c in self.checks]
        return asdict(self) | {"can_tell": self.can_tell, "checks": checks}


def rows(runs: Iterable[FaultRun]) -> tuple[Row, ...]:
    """Return the rows in the order of the first run of each."""
    groups: dict[tuple[Any, str], list[FaultRun]] = {}
    for run in runs:
        groups.setdefault((run.injection, run.condition), []).append(run)
    return tuple(_row(each) for each in groups.values())


def _row(runs: Sequence[FaultRun]) -> Row:
    effective = [r for r in runs if r.effect]
    fault = runs[0].injection
    return Row(
        *(fault.group, fault.target, fault.kind, fault.duration),
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
        energies=_worst([r.energies for r in runs]),
        speeds=_worst([r.speeds for r in runs]),
        final_speeds=_worst([r.final_speeds for r in runs]),
    )


def _worst(values: Sequence[Values]) -> dict[str, float]:
    return {q: max(v[q] for v in values) for q in values[0]}


def campaign(
    rig: Rig,
    plants: int,
    healthy: Healthy,
    runs: Sequence[FaultRun],
    control: Sequence[FaultRun],
    sweeps: Sequence[Sweep] = (),
) -> Campaign:
    """Return the result of all runs, and of the `control` runs of faults that latch on the nominal plant.

    A limit that matches none of the runs, but another fault of the stage, makes no check.

    `rig` is from `campaign.with_stops`. Raises SignalError for a limit without a fault, or with an unknown measure.
    """
    states, rates = {s.name: s for s in rig.plant.states}, rig.stage.velocities
    pairs = control_pairs(runs, control)
    harmed = [(without.harms, latched.harms) for without, latched in pairs]
    units, table = {q: states[q].unit for q in rates}, rows(runs)
    derived = injections.derive(rig.stage)
    others = [(i.target, i.kind, on, i.duration) for i in derived for on in condition_names(rig.stage)]
    limits = [l for l in rig.stage.faults.limits if matching(l, table) or not any(_matches(l, o) for o in others)]
    return Campaign(
        rig.stage.name, plants, len(derived), table, tuple(healthy), tuple(sweeps),
        len(pairs), sum(w for w, _ in harmed), sum(h for _, h in harmed),
        tuple(_checks(limits, table, healthy, pairs, units)), units,
        {q: states[q].high - states[q].low for q in rates},
        {q: states[v].high - states[v].low for q, v in rates.items()},
        tuple(q for q in rates if q in rig.positions.values()) or tuple(rates),
    )  # fmt: skip


def control_pairs(runs: Sequence[FaultRun], control: Sequence[FaultRun]) -> list[tuple[FaultRun, FaultRun]]:
    """Return each control run with the run of the nominal plant that latches under the same fault."""
    latched = {_case(run): run for run in runs if run.plant == 0 and math.isfinite(run.latch_s)}
    return [(run, latched[_case(run)]) for run in control if _case(run) in latched]


def _case(run: FaultRun) -> tuple[Any, ...]:
    return run.injection, run.condition, run.onset_s


def _checks(
    limits: Sequence[FaultLimit], table: Sequence[Row], healthy: Healthy,
    pairs: Sequence[tuple[FaultRun, FaultRun]], units: Mapping[str, str],
) -> list[Check]:  # fmt: skip
    """Return the checks of the limits, and those of the negative control: without the latch one must fail.

    A stage without limits has the worst values, without a limit.
    """
    if not limits:
        return [_check(limit, table, healthy, units) for limit in UNLIMITED[: 3 if table else 2]]
    checks = [_check(limit, table, healthy, units) for limit in limits]
    harmless = sum(not without.harms for without, _ in pairs)
    about = "the negative control"
    if harmless == len(pairs):
        about += (
            f": none of {len(pairs)} runs that latch hits a stop without the latch; declare the `stops` that it "
            "guards, or larger or longer faults in `FaultCampaign`"
        )
    checks.append(Check(CONTROL, float(harmless), len(pairs) - 1.0, "1", about))
    without_latch = rows([without for without, _ in pairs])
    controlled = [l for l in limits if l.measure != FALSE_ALARMS and matching(l, without_latch)]
    if controlled:
        without = [_check(limit, without_latch, (), units) for limit in controlled]
        passed = sum(c.passed for c in without)
        about = "the negative control"
        if passed == len(controlled):
            k = max(range(passed), key=lambda k: without[k].value / (without[k].limit or 1.0))
            worst, latched = without[k], _check(controlled[k], table, (), units)
            about += (
                f": no limit needs the latch; '{worst.name}' allows {worst.limit:g} {worst.unit}, and reaches "
                f"{worst.value:.4g} without the latch and {latched.value:.4g} with it: give a limit between these, or "
                "faults that a latch is for"
            )
        checks.append(Check(CONTROL_LIMITS, float(passed), len(controlled) - 1.0, "1", about))
    return checks


_MEASURES: Mapping[str, tuple[Callable[[Row], float], str]] = {
    "notice_s": (lambda row: row.notice_s, "s"),
    "latch_s": (lambda row: row.latch_s, "s"),
    "wrong_names": (lambda row: float(row.wrong_names), "1"),
    "impact": (lambda row: row.impact, ""),
    "energy": (lambda row: row.energy, "J"),
}
FALSE_ALARMS, HEALTHY_IMPACT = "false_alarms", "healthy_impact"


def _check(limit: FaultLimit, table: Sequence[Row], healthy: Healthy, units: Mapping[str, str]) -> Check:
    patterns = _patterns(limit)
    name = f"{limit.measure}: {', '.join(p for p in patterns if p != '*') or 'every fault'}"
    if limit.measure == FALSE_ALARMS:
        alarms = sum(h.alarms for h in healthy if fnmatchcase(h.condition, limit.condition))
        return Check(name, float(alarms), limit.most, "1", "samples with a fault bit in healthy runs")
    if limit.measure == HEALTHY_IMPACT:
        impacts = [v for h in healthy if fnmatchcase(h.condition, limit.condition) for v in h.impacts.values()]
        return Check(name, max(impacts, default=0.0), limit.most, _speed_units(units), "impacts in healthy runs")
    measure, unit = _measure(limit.measure, units)
    affected = matching(limit, table)
    if not affected:
        raise SignalError(f"limit '{name}' matches no fault of the campaign: correct its patterns, or leave it out")
    if all(row.runs == row.without_effect for row in affected):
        return Check(name, math.nan, limit.most, unit, "no matching fault has an effect: nothing was tested")
    worst = max(affected, key=measure)
    return Check(name, measure(worst), limit.most, unit, ", ".join(_columns(worst)))


def _patterns(limit: FaultLimit) -> tuple[str, str, str, str]:
    return limit.target, limit.kind, limit.condition, limit.duration


def matching(limit: FaultLimit, table: Sequence[Row]) -> list[Row]:
    """Return the rows whose target, kind, condition and duration have the patterns of a limit."""
    return [row for row in table if _matches(limit, _columns(row))]


def _matches(limit: FaultLimit, columns: tuple[str, str, str, str]) -> bool:
    """Return whether target, kind, condition and duration have the patterns of a limit."""
    return all(map(fnmatchcase, columns, _patterns(limit)))


def _columns(row: Row) -> tuple[str, str, str, str]:
    return row.target, row.kind, row.condition, row.duration


def _measure(name: str, units: Mapping[str, str]) -> tuple[Callable[[Row], float], str]:
    """Return a measure of a row and its unit."""
    if name in _MEASURES:
        measure, unit = _MEASURES[name]
        return measure, unit or _speed_units(units)
    per_position = {
        **{f"excursion_{q}": (partial(_of, "excursion", q), unit) for q, unit in units.items()},
        **{f"impact_{q}": (partial(_of, "impacts", q), per_second(unit)) for q, unit in units.items()},
        **{f"speed_{q}": (partial(_of, "speeds", q), per_second(unit)) for q, unit in units.items()},
        **{f"final_speed_{q}": (partial(_of, "final_speeds", q), per_second(unit)) for q, unit in units.items()},
    }
    if name in per_position:
        return per_position[name]
    known = [*_MEASURES, FALSE_ALARMS, HEALTHY_IMPACT, *per_position]
    raise SignalError(f"a fault limit has the measure '{name}': use one of {', '.join(known)}")


def _speed_units(units: Mapping[str, str]) -> str:
    return "/".join(sorted({per_second(u) for u in units.values()}))


def _of(field: str, position: str, row: Row) -> float:
    return float(getattr(row, field)[position])


COLUMNS = (
    *("fault", "duration", "condition", "excursion", "impact", "noticed", "latched", "tolerated", "named"),
    "no effect",
)
TOLERATED = COLUMNS.index("tolerated")
MAGNITUDE_COLUMNS = ("fault", "duration", "condition", "noticed from", "harmful from")


def worst_targets(result: Campaign) -> tuple[Row, ...]:
    """Return of each kind, condition and duration the row with the fastest impact, then the largest excursion."""
    groups: dict[tuple[str, ...], list[Row]] = {}
    for row in result.rows:
        groups.setdefault((row.group, row.kind, row.condition, row.duration), []).append(row)
    return tuple(max(each, key=partial(severity, result)) for each in groups.values())


def severity(result: Campaign, row: Row) -> tuple[float, float]:
    """Return the fastest impact and the largest excursion of a row, as fractions of the ranges."""
    return _largest(row.impacts, result.rate_spans)[1], _largest(_controlled_excursions(result, row), result.spans)[1]


def fastest_stop(result: Campaign, row: Row) -> str:
    """Return the position with the fastest impact on a stop, as a fraction of the range of its rate."""
    return _largest(row.impacts, result.rate_spans)[0]


def _controlled_excursions(result: Campaign, row: Row) -> dict[str, float]:
    """Return the excursions of the positions with a set-point: a mode of the base may have a far smaller range."""
    return {q: value for q, value in row.excursion.items() if q in result.regulated}


def _largest(values: Values, spans: Values) -> tuple[str, float]:
    """Return the position with the largest value relative to its span, and that ratio."""
    ratios = {q: value / spans[q] for q, value in values.items()}
    return max(ratios.items(), key=lambda pair: pair[1]) if ratios else ("", 0.0)


def table(result: Campaign, rows: Iterable[Row]) -> tuple[tuple[str, ...], tuple[tuple[str, ...], ...]]:
    """Return the columns and the cells of rows; without sweeps there is no column of tolerated times."""
    whole = (COLUMNS, *(cells(result, row) for row in rows))
    if not result.sweeps:
        whole = tuple((*line[:TOLERATED], *line[TOLERATED + 1 :]) for line in whole)
    return whole[0], whole[1:]


def cells(result: Campaign, row: Row) -> tuple[str, ...]:
    """Return the cells of a row under COLUMNS.

    Times are the slowest, in ms; counts are of the runs, without those without effect. `tolerated` is the time that the
    machine tolerates without the latch, where it was measured; too late says that the latch takes longer.
    """
    q = _largest(_controlled_excursions(result, row), result.spans)[0]
    effective = row.runs - row.without_effect
    return (
        f"{row.target} {row.kind}",
        row.duration,
        row.condition,
        f"{row.excursion[q]:.3g} {result.units[q]} {q}" if q else "",
        _impact(result, row),
        _count(row.noticed, effective, row.notice_s),
        _count(row.latched, effective, row.latch_s),
        _tolerated_time(result, row),
        f"{row.named}/{effective}" + (f", {row.wrong_names} wrong" if row.wrong_names else ""),
        f"{row.without_effect}/{row.runs}" if row.without_effect else "",
    )


def _impact(result: Campaign, row: Row) -> str:
    """Return speed, position and energy of the fastest impact."""
    if not row.impact:
        return ""
    stop = fastest_stop(result, row)
    energy = f", {row.energies[stop]:.2g} J" if stop in row.energies else ""
    return f"{row.impacts[stop]:.3g} {per_second(result.units[stop])} {stop}{energy}"


def _tolerated_time(result: Campaign, row: Row) -> str:
    times = [s.tolerated_s for s in result.sweeps if sweep_fault(s) == row.fault and s.tolerated_s is not None]
    if not times:
        return ""
    if math.isinf(times[0]):
        return "unlimited"
    late = row.latch_s > times[0]
    return f"{1e3 * times[0]:.3g} ms" + (", too late" if late else "")


def sweep_fault(sweep: Sweep) -> tuple[str, ...]:
    """Return what `Row.fault` returns for the row of the same fault."""
    return sweep.group, sweep.target, sweep.kind, sweep.duration, sweep.condition


def magnitude_cells(result: Campaign, every: bool) -> tuple[tuple[str, ...], ...]:
    """Return the cells of sweeps under MAGNITUDE_COLUMNS, of each kind the target with the largest gap."""
    swept = [s for s in result.sweeps if s.noticed is not None]
    groups: dict[tuple[str, ...], list[Sweep]] = {}
    for s in swept:
        groups.setdefault((s.group, s.kind, s.duration, s.condition), []).append(s)
    chosen = swept if every else [max(each, key=_gap) for each in groups.values()]
    return tuple(
        (f"{s.target} {s.kind}", s.duration, s.condition, _fraction(s.noticed), _fraction(s.harmful)) for s in chosen
    )


def _gap(sweep: Sweep) -> tuple[float, float]:
    """Return the ratio of the smallest magnitude noticed to the smallest that harms, then the former."""
    noticed, harmful = sweep.noticed or 0.0, sweep.harmful or 0.0
    return (0.0 if math.isinf(harmful) else noticed / harmful), noticed


def _fraction(magnitude: float | None) -> str:
    if magnitude is None or math.isinf(magnitude):
        return "never"
    return f"{100 * magnitude:.3g} %"


def _count(times: int, runs: int, longest_s: float) -> str:
    if not times:
        return "never" if runs else ""
    return f"{1e3 * longest_s:.3g} ms" if times == runs else f"{times}/{runs}"


def notes(result: Campaign) -> tuple[str, ...]:
    """Return lines on the number of faults, false alarms, faults without effect, harm, isolation, negative control."""
    injected = len({row.fault[:-1] for row in result.rows})
    rest = f"; `synth faults {result.design}` injects all and judges their limits" if injected < result.derived else ""
    counts = ("runs", "without_effect", "harmed", "harmed_unnoticed", "noticed", "named")
    runs, idle, harmed, unnoticed, noticed, named = (sum(getattr(r, name) for r in result.rows) for name in counts)
    wrong = sum(row.wrong_names > 0 for row in result.rows)
    stops = sum(any(h.impacts.values()) for h in result.healthy)
    control = (
        f"of {result.control_runs} runs that latch, {result.control_harmed} run into a stop when the controller never "
        f"latches, {result.control_latched} with the latch"
    )
    verdict = "" if result.can_tell else ": the campaign cannot tell whether the detector protects the machine"
    return (
        f"faults: {injected} of the {result.derived} of the interface{rest}",
        f"healthy runs: {len(result.healthy)}, {result.alarms} samples with a fault bit, {stops} run into a stop",
        f"faulty runs: {runs}, {idle} without effect, {harmed} run into a stop, {unnoticed} of these without a bit",
        f"isolation: of {noticed} runs with a fault bit {named} name every faulty input; {wrong} rows name another",
        f"negative control: {control}{verdict}",
    )
