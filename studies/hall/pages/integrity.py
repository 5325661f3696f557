"""Integrity of three and four sensors in the report: calibration, faults over fields, Stanford diagram."""

from collections.abc import Callable
from dataclasses import replace
from string import ascii_uppercase

import numpy as np
from matplotlib.figure import Figure

from designs.hall_position.protected import config
from designs.hall_position.protected.parameters import Tuning
from studies.hall.calibrated import estimator, stages, survey
from studies.hall.calibrated.survey import Case
from studies.hall.protected import faults, trust
from studies.hall.protected.trust import Samples
from synth import show
from synth.base.progress import Progress
from synth.report import maps
from synth.report.maps import Chart, Line
from synth.report.prose import Content, Rows

SHOWN = 6000  # samples in the diagram
THREE = "three sensors"
Runner = Callable[[str, float], Samples]


def blocks() -> dict[str, Content]:
    """Return the numbers of the survey, and the Stanford diagram; the tables are those of `tables`."""
    samples = faulty_samples(survey.UNITS["as built"])
    return {
        "integrity.reference": 1e6 * survey.units.REFERENCES["X"],
        "integrity.points": len(stages.units.scan(stages.units.draw("fabricated", 0))),
        "integrity.drift": 100 * estimator.GAIN_DRIFT,
        "integrity.limit": 1e3 * trust.WRONG,
        "integrity.bodies": survey.BODIES,
        "integrity.limit_yaw": 1e3 * trust.WRONG_YAW,
        "integrity.stanford": stanford(samples),
    }


def tables(progress: Progress) -> dict[str, Content]:
    """Return the stages of the calibration, the survey, and the counts of the Stanford diagram by sensors in use."""
    progress("integrity of calibrated units")
    return {
        "integrity.stages": stage_rows(),
        "integrity.faults": fault_rows(),
        "integrity.subsets": subset_rows(survey.UNITS["as built"]),
    }


def stage_rows() -> Rows:
    """Return the residuals and the errors left after each stage."""
    rows: list[tuple[show.Cell, ...]] = []
    for name, case in survey.UNITS.items():
        for stage in stages.STAGES:
            of = stages.of_unit(case.field, case.seed, stage)
            error = of.model_error(estimator.UNIFORM * estimator.GAIN_DRIFT)
            sizes = 1e3 * of.residual, 1e3 * error, 1e6 * of.position_error, 1e6 * of.yaw_error
            rows.append((name, stage, *sizes))
    return rows


def fault_rows() -> Rows:
    """Return what is valid and wrong after each fault, at rest and in motion, the larger of both."""
    rows: list[tuple[show.Cell, ...]] = []
    for name, calibration, R, runner in _runners():
        by_fault = {f: [runner(f, speed).outcome() for speed in survey.SPEEDS] for f in faults.FAULTS}
        none = by_fault.pop("none")
        at_rest = runner("none", 0.0)
        level = 1e3 * float(np.median(at_rest.levels[at_rest.valid][:, :2]))
        worst = max(by_fault, key=lambda f: max(o.wrong for o in by_fault[f]))
        ratios = "-".join(f"{v:.2f}" for v in sorted(o.ratio for o in none))
        wrong = 100 * max(o.wrong for o in by_fault[worst])
        rows.append(
            (name, calibration, 1e3 * R, 100 * min(o.valid for o in none), level, ratios, worst if wrong else "", wrong)
        )
    return rows


def _runners() -> list[tuple[str, str, float, Runner]]:
    """Return field, calibration, R in V and how to run a fault, of each row."""
    runners: list[tuple[str, str, float, Runner]] = []
    for name, case in survey.UNITS.items():
        runners.append((name, "none", config.USUAL.model_error, _runner_without(case.field)))
        runners += [_runner_with(name, stage, replace(case, stage=stage)) for stage in stages.STAGES[2:]]
    for tuning, promise in ((config.USUAL, "none"), (config.CALIBRATED_THREE, "none, as if it were")):
        runner = _runner_without("built", tuning, config.THREE)
        runners.append((f"as built, {THREE}", promise, tuning.model_error, runner))
    return runners + [
        _runner_with(f"{name}, {THREE}", stages.STAGES[-1], replace(case, name=config.THREE))
        for name, case in survey.UNITS.items()
    ]


def _runner_without(field: str, tuning: Tuning = config.USUAL, name: str = config.NAME) -> Runner:
    return lambda fault, speed: trust.run(tuning, field, fault, survey.BODIES, speed, name=name)


def _runner_with(name: str, label: str, case: Case) -> tuple[str, str, float, Runner]:
    tuning = survey.tuning(case)
    return name, label, tuning.model_error, lambda fault, speed: survey.run(case, fault, survey.BODIES, speed)


def faulty_samples(case: Case) -> Samples:
    """Return the samples of every fault, at rest and in motion."""
    return survey.join(
        [survey.run(case, fault, survey.BODIES, speed) for fault in faults.FAULTS for speed in survey.SPEEDS]
    )


def stanford(of: Samples) -> Figure:
    """Return the diagrams of X and of the yaw: error over protection level of valid samples, with the alert limits."""
    pick, drawn = np.random.default_rng(0), []
    for axis, name, limit, unit, scale in (
        (0, "X", trust.WRONG, "mm", 1e3),
        (2, "yaw", trust.WRONG_YAW, "mrad", 1e3),
    ):
        error, level = (scale * v[of.valid][:, axis] for v in (np.abs(of.errors), of.levels))
        some = pick.permutation(len(error))[:SHOWN]
        ends, alert = np.array([1e-4, 10.0]) * scale * limit, scale * limit
        misleading = error > level
        lines = [
            Line(error[some], level[some], "valid", {"ls": "", "marker": ".", "ms": 1.5, "alpha": 0.5}),
            Line(error[misleading], level[misleading], "misleading", {"ls": "", "marker": "x", "ms": 4}),
            Line(ends, ends, "", {"color": "#666666", "ls": "-"}),
            Line([alert, alert], ends, "", {"color": "#666666", "ls": "--"}),
        ]
        options = {"xlim": tuple(ends), "ylim": (alert / 100, alert * 3)}
        labels = f"error of {name}, {unit}", f"protection level, {unit}"
        drawn.append(Chart(lines, *labels, levels=(alert,), log="xy", legend="upper left", options=options))
    return maps.draw(drawn, 3.2)


def subset_rows(case: Case) -> Rows:
    """Return the counts of the Stanford diagram of X for every subset of sensors in use, without a further fault."""
    rows: list[tuple[show.Cell, ...]] = []
    tuning = survey.tuning(case)
    for refused in survey.subsets():
        used = "".join(ascii_uppercase[k] for k in range(4) if k not in refused) or "none"
        each = survey.diagram(
            survey.run(case, "none", survey.BODIES, trust.SPEED, refused=refused), tuning.position_limit
        )
        rows.append((used, each.samples, each.nominal, each.misleading, each.hazardous, each.unavailable))
    return rows
