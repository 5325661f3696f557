"""Verdicts of a build: the checks that the toolkit makes of every design, from its declaration and its results.

    margins   least margins of the loops and least disk margin, over operating points and corners of the tolerances
    study     machines without a result, and the share of the machines that keep every limit
    audit     published figures that differ without a reason
    cost      instructions of a step
    runs      experiments without a sample

No task that a design replaces can lose one of them. What has no declared limit is recorded as "no limit"; what is
declared, but has not been measured, is NaN and fails.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from fnmatch import fnmatchcase
from functools import partial
from itertools import product
from math import inf, isfinite, nan

from synth.analyse import disk, equilibrium, robustness, stability_margins
from synth.check import NO_LIMIT, Check
from synth.declaration import Stage
from synth.errors import DesignError
from synth.report.audit import Row, Verdict
from synth.simulate.experiment import Experiment
from synth.simulate.integration import LARGEST_ERROR
from synth.simulate.study import StudyTable, estimate_yield
from synth.statespace import StateSpace
from synth.verify import standard
from synth.verify.cost import Cost

YIELD = "yield of the study"
INTEGRATION = "error of the integration in the study"
WITHOUT_RESULT = "runs of the study without a result"
UNEXPLAINED = "published figures that differ without a reason"
INSTRUCTIONS = "most instructions of a step"
SHOWN = 3  # places that the text of a check names


def margins(stage: Stage) -> list[Check]:
    """Return the least of every margin over the loops of a stage, each with its limit where one is required."""
    if not stage.interface.actuators or not (stage.operating_points or stage.loops):
        reason = "no operating point is declared" if stage.interface.actuators else "no loop: no actuator is declared"
        required = {n.replace("_", " "): least for n, least in stage.require.items()} or {"margins": -inf}
        return [Check(name, nan, least, "1", reason, at_least=True) for name, least in required.items()]
    survey, at_once = _own_loops(stage.loops(stage)) if stage.loops else _loops_at_rest(stage)
    unstable = [loop.label for loop in survey.loops if not loop.margins.stable]
    lost = [*(f"{u.label}: {u.reason}" for u in survey.unsolved), *unstable]
    require = {name: stage.require.get(name, -inf) for name in robustness.REQUIREMENTS}
    return [
        Check(standard.LOST, float(len(lost)), 0.0, "1", "; ".join(lost[:SHOWN]) or f"{len(survey.loops)} loops"),
        *robustness.checks(survey.loops, require, survey.unsolved),
        _disk_margin(at_once if not lost else {}, stage.require.get(standard.DISK, -inf)),
    ]


Opened = Mapping[str, Callable[[], StateSpace]]  # by place: the loop opened at all actuators and sensors at once


def _own_loops(places: Sequence[standard.LoopsAt]) -> tuple[robustness.Survey, Opened]:
    opened = [(at.place, signal, at.open([signal])) for at in places for signal in at.signals]
    loops = [robustness.OpenLoop(p, robustness.NOMINAL, s, L, stability_margins.of_loop(L)) for p, s, L in opened]
    return robustness.Survey(loops, ()), {at.place: partial(at.open, at.at_once) for at in places}


def _loops_at_rest(stage: Stage) -> tuple[robustness.Survey, Opened]:
    """Return the loops at the operating points, for the nominal plant and the corners of the tolerances."""
    loops = standard.over_tolerances(stage)
    signals = [*loops.actuators, *loops.sensors]

    def open_all(point: str, case: robustness.Case) -> StateSpace:
        return equilibrium.open_loop(robustness.equilibrium_at(loops, point, case), signals)

    cases = product(loops.points, loops.cases)
    at_once = {f"{point}{robustness.case_text(case)}": partial(open_all, point, case) for point, case in cases}
    return robustness.survey(loops), at_once


def _disk_margin(at_once: Opened, least: float) -> Check:
    """Return the least certified lower bound of the disk margin, with all actuators and sensors varied at once."""
    bounds = {place: disk.of_loop(open_all()).lower for place, open_all in at_once.items()}
    worst = min(bounds, key=lambda place: bounds[place], default="")
    about = f"the least of {len(bounds)}, {worst}, all actuators and sensors at once" if bounds else "a loop is lost"
    return Check(standard.DISK.replace("_", " "), bounds.get(worst, 0.0), least, "1", about, at_least=True)


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
    steps = f"{table.integration.substeps} steps of order {table.integration.order} a sample, in the first experiment"
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


def cost(stage: Stage, measured: Cost | None) -> list[Check]:
    """Return the check of the measured instructions, which needs the emulator and a cross compiler."""
    if measured is None:
        return [Check(INSTRUCTIONS, nan, NO_LIMIT, "1", "not measured: no emulator or no cross compiler")]
    build = max(measured.most, key=lambda name: measured.most[name])
    return [Check(INSTRUCTIONS, float(measured.most[build]), stage.most_instructions, "1", f"{measured.core}, {build}")]


def empty_runs(experiments: Sequence[Experiment]) -> list[Check]:
    """Return a failed check for each experiment whose recorded run is empty."""
    empty = [e.name for e in experiments if not len(e.trajectory.time)]
    return [Check(f"samples of {name}", 0.0, 1.0, "1", "the run is empty", at_least=True) for name in empty]
