"""Verdicts of a build: the checks that the toolkit makes of every stage, from its declaration and its results.

    margins   least margins of the loops and least disk margin, over operating points and corners of the tolerances
    study     machines without a result, and the share of the machines that keep every limit
    audit     published figures that differ without a reason
    faults    the faults with the worst impacts
    cost      instructions and bytes of a step
    runs      experiments without a sample

No task that a design replaces can lose one of them. What has no declared limit is recorded as "no limit"; what is
declared, but has not been measured, is NaN and fails.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from fnmatch import fnmatchcase
from functools import lru_cache, partial
from math import inf, isfinite, nan

import numpy as np

from synth.analyse.loops import disk, robustness, stability_margins
from synth.analyse.loops.robustness import Survey
from synth.check import NO_LIMIT, Check
from synth.declare.stage import DISK, MARGINS, Stage
from synth.errors import DesignError
from synth.report import first_screen
from synth.report.audit import Row, Verdict
from synth.signals import per_second
from synth.simulate import experiments
from synth.simulate.experiments import Experiment
from synth.simulate.faults import fault_table
from synth.simulate.faults.fault_table import Campaign
from synth.simulate.integration import LARGEST_ERROR, TIGHT
from synth.simulate.study import StudyTable, estimate_yield
from synth.verify import standard
from synth.verify.cost import SYNTH, Cost
from synth.verify.suite import Evidence

YIELD = "yield of the study"
INTEGRATION = "error of the integration in the study"
WITHOUT_RESULT = "runs of the study without a result"
UNEXPLAINED = "published figures that differ without a reason"
INSTRUCTIONS = "most instructions of a step"
CODE, MEMORY = "bytes of code and constants", "bytes of memory in a step"
SHOWN = 3  # places that the text of a check names, and faults that are listed with their impact


def survey(stage: Stage) -> Survey | None:
    """Return the loops of a stage with all margins, at its places or operating points, at the corners of the
    tolerances and in the cases; None for a stage without loops.
    """
    if not stage.interface.actuators or not (stage.operating_points or stage.loops):
        return None
    if stage.loops:
        return _own_loops(stage.loops(stage))
    return robustness.survey(*_at_rest(stage))


def closed_loops(stage: Stage) -> list[robustness.ClosedLoop]:
    """Return the closed loops of a stage at its places, or points, corners and cases; much sooner than `survey`."""
    if not stage.interface.actuators or not (stage.operating_points or stage.loops):
        return []
    if stage.loops:
        return robustness.closed_loops_at(stage.loops(stage))
    return robustness.closed_loops(*_at_rest(stage))


@lru_cache(maxsize=1)  # for `closed_loops`, then `survey`
def _at_rest(stage: Stage) -> tuple[robustness.Loops, list[robustness.AtRest]]:
    """Return the loops over the tolerances and cases of a stage, and their equilibria."""
    loops = standard.over_tolerances(stage)
    return loops, robustness.equilibria(loops)


def stability(closed: Sequence[robustness.ClosedLoop]) -> str:
    """Return in one sentence whether closed loops are stable, and where not."""
    lost = [c for c in closed if not c.is_stable]
    if not closed:
        return "no loop: no actuator or no operating point is declared"
    if not lost:
        return f"stable in {len(closed)} case{'s' if len(closed) > 1 else ''}"
    first, others = lost[0], f" and in {len(lost) - 1} more of {len(closed)} cases" if len(lost) > 1 else ""
    why = first.reason or f"a pole z of magnitude {np.abs(first.poles).max():.6g}"
    return f"UNSTABLE at {first.place}{others}: {why}"


def _own_loops(places: Sequence[robustness.LoopsAt]) -> Survey:
    opened = [(at.place, signal, at.open([signal])) for at in places for signal in at.signals]
    loops = [robustness.OpenLoop(p, robustness.NOMINAL, s, L, stability_margins.of_loop(L)) for p, s, L in opened]
    unstable = {loop.point for loop in loops if not loop.margins.stable}
    stable = [at for at in places if at.place not in unstable]
    return Survey(loops, (), {at.place: {robustness.AT_ONCE: disk.of_loop(at.open(at.at_once))} for at in stable})


def margins(stage: Stage, loops: Survey | None) -> list[Check]:
    """Return the least of every margin over the loops of a stage, each with its limit where one is required."""
    if loops is None:
        declared = "not computed" if stage.operating_points or stage.loops else "no operating point is declared"
        reason = declared if stage.interface.actuators else "no loop: no actuator is declared"
        required = {n.replace("_", " "): least for n, least in stage.require.items()} or {"margins": -inf}
        return [Check(name, nan, least, "1", reason, at_least=True) for name, least in required.items()]
    require = {name: stage.require.get(name, -inf) for name in robustness.REQUIREMENTS}
    about = "; ".join(loops.lost[:SHOWN]) or f"{len(loops.loops)} loops"
    return [
        Check(standard.LOST, float(len(loops.lost)), 0.0, "1", about),
        *robustness.checks(loops.loops, require, loops.unsolved),
        _disk_margin(loops, stage.require.get(DISK, -inf)),
    ]


def least_margins(stage: Stage, loops: Survey | None) -> dict[str, float]:
    """Return the least of each of MARGINS as `margins` does; none for a stage without loops."""
    return dict(zip(MARGINS, (c.value for c in margins(stage, loops)[1:]), strict=True)) if loops else {}


def _disk_margin(loops: Survey, least: float) -> Check:
    """Return the least certified lower bound of the disk margin, with all actuators and sensors varied at once."""
    bounds = {place: disks[robustness.AT_ONCE].lower for place, disks in loops.disks.items()} if not loops.lost else {}
    worst = min(bounds, key=lambda place: bounds[place], default="")
    count = len({(loop.point, loop.case.text) for loop in loops.loops})
    about = f"the least of {count}, {worst}, all actuators and sensors at once" if bounds else "a loop is lost"
    return Check(DISK.replace("_", " "), bounds.get(worst, 0.0), least, "1", about, at_least=True)


def with_limits(stage: Stage, table: StudyTable) -> StudyTable:
    """Return a study with the limits that the stage declares for its machines in place of those of the nominal plant.

    Raises DesignError for a pattern that matches no check of the experiments that it names, where they were run.
    """
    limits, ran = dict(table.limits), {name.partition(": ")[0] for name in table.limits}
    for pattern, limit in stage.study.limits.items():
        matching = [name for name in table.limits if fnmatchcase(name, pattern)]
        if not matching and any(fnmatchcase(name, pattern.partition(": ")[0]) for name in ran):
            raise DesignError(f"a limit of the study is for '{pattern}', but its checks are {', '.join(table.limits)}")
        limits |= dict.fromkeys(matching, limit)
    return replace(table, limits=limits)


def study(stage: Stage, table: StudyTable | None) -> list[Check]:
    """Return the checks of a study, with the limits of `with_limits`, or of a stage without one."""
    least = stage.study.least_yield
    if table is None:
        return [Check(YIELD, nan, least, "1", "no study was run: no experiment runs on other machines", at_least=True)]
    failed = [f"{experiment} on machine {row}: {reason}" for row, experiment, reason in _first_of_each(table)]
    share, n, error = estimate_yield(table), len(table.rows), table.integration.error
    steps = f"order {table.integration.order}, steps a sample: {table.integration.substeps}; in the first experiment"
    if error > LARGEST_ERROR:
        steps += (
            f" {TIGHT} steps show it: leave a pole out of the plant that is faster than a sample, make friction or a "
            "stop in its equations smooth, or give first an experiment whose loop settles, which magnifies no error"
        )
    about = f"{int(table.passed.sum())} of {n} machines keep every limit; {share.low:.2%} to {share.high:.2%}"
    return [
        Check(INTEGRATION, error, LARGEST_ERROR if isfinite(error) else NO_LIMIT, "of a state's range", steps),
        Check(WITHOUT_RESULT, float(len(table.errors)), 0.0, "1", "; ".join(failed[:SHOWN])),
        Check(YIELD, share.share, least, "1", about, at_least=True),
    ]


def _first_of_each(table: StudyTable) -> list[tuple[int, str, str]]:
    """Return the first error of each experiment and reason."""
    return list(
        {(experiment, reason): (row, experiment, reason) for row, experiment, reason in table.errors[::-1]}.values()
    )[::-1]


def audit(rows: Sequence[Row]) -> list[Check]:
    """Return the check of the audited rows, none for a design without a publication."""
    unexplained = [row.id for row in rows if row.verdict is not Verdict.REPRODUCES and not row.why.strip()]
    return [Check(UNEXPLAINED, float(len(unexplained)), 0.0, "1", ", ".join(unexplained))] if rows else []


def worst_faults(stage: Stage, campaign: Campaign | None) -> list[Check]:
    """Return the checks of the faults with the worst impacts on a stop, one of each kind, each with its least limit."""
    if campaign is None or not campaign.units:
        return []
    of_kind: dict[tuple[str, str], fault_table.Row] = {}
    for row in sorted(campaign.rows, key=partial(fault_table.severity, campaign), reverse=True):
        of_kind.setdefault((row.group, row.kind), row)
    return [_impact(stage, campaign, row) for row in [*of_kind.values()][:SHOWN]]


def _impact(stage: Stage, campaign: Campaign, row: fault_table.Row) -> Check:
    stop = fault_table.fastest_stop(campaign, row)
    limits = [l for l in stage.faults.limits if l.measure in ("impact", f"impact_{stop}")]
    most = min((limit.most for limit in limits if fault_table.matching(limit, [row])), default=NO_LIMIT)
    energy = f", {row.energies[stop]:.2g} J" if stop in row.energies else ""
    about = f"{row.condition}, {row.duration}{energy}"
    name = f"impact of {stop}: {row.target} {row.kind}"
    return Check(name, row.impacts[stop], most, per_second(campaign.units[stop]), about)


def cost(stage: Stage, measured: Cost | None) -> list[Check]:
    """Return the checks of the measured instructions and bytes, which need the emulator and a cross compiler."""
    if measured is None:
        return [Check(INSTRUCTIONS, nan, NO_LIMIT, "1", "not measured: no emulator or no cross compiler")]
    build = max(measured.most, key=lambda name: measured.most[name])
    steps = Check(INSTRUCTIONS, float(measured.most[build]), stage.most_instructions, "1", f"{measured.core}, {build}")
    memory = [(c.build, c.memory) for c in measured.compared if c.generator == SYNTH]
    code, working = ({b: m.code + m.constants for b, m in memory}, {b: m.working for b, m in memory})
    return [steps, *(_most_bytes(measured.core, *of) for of in ((CODE, code), (MEMORY, working)) if memory)]


def _most_bytes(core: str, name: str, by_build: Mapping[str, int]) -> Check:
    build = max(by_build, key=lambda b: by_build[b])
    return Check(name, float(by_build[build]), NO_LIMIT, "1", f"{core}, {build}")


def empty_runs(experiments: Sequence[Experiment]) -> list[Check]:
    """Return a failed check for each experiment whose recorded run is empty."""
    empty = [e.name for e in experiments if not len(e.trajectory.time)]
    return [Check(f"samples of {name}", 0.0, 1.0, "1", "the run is empty", at_least=True) for name in empty]


def of_build(
    stage: Stage,
    loops: Survey | None,
    table: StudyTable | None,
    campaign: Campaign | None,
    rows: Sequence[Row],
    measured: Cost | None,
) -> dict[str, Sequence[Check]]:
    """Return all checks of the results of a build by the title of the section that shows them."""
    return {
        first_screen.LOOPS: margins(stage, loops),
        first_screen.STUDY: study(stage, table),
        first_screen.FAULTS: worst_faults(stage, campaign),
        first_screen.COST: cost(stage, measured),
        first_screen.AUDIT: audit(rows),
    }


def requirements(lost: Sequence[Check], evidence: Evidence, runs: Sequence[Experiment]) -> tuple[first_screen.Row, ...]:
    """Return the rows of the first screen: errors, verdicts of the toolkit, states, experiments, faults, witnesses."""
    of_runs = [replace(c, about=": ".join(filter(None, (e.title, c.about)))) for e in runs for c in e.checks]
    return first_screen.rows(
        [
            ("", lost),
            *evidence.verdicts.items(),
            (first_screen.EXPERIMENTS, [c for c in of_runs if c.name == experiments.NAME]),
            (first_screen.EXPERIMENTS, [c for c in of_runs if c.name != experiments.NAME]),
            (first_screen.FAULTS, evidence.faults.checks if evidence.faults else ()),
            (first_screen.VERIFICATION, evidence.checks),
        ]
    )
