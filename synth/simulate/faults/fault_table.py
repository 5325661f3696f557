"""Table of a fault campaign as text: rows, magnitudes, and notes on false alarms and the negative control."""

import math
from collections.abc import Iterable
from functools import partial

from synth.signals import per_second
from synth.simulate.faults.campaign import Values
from synth.simulate.faults.fault_rows import Campaign, Row
from synth.simulate.faults.fault_sweeps import Sweep

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
