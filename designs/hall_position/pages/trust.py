"""Integrity of the shipped C in the report: convergence, cold starts, motion, sensor failures."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from matplotlib.figure import Figure

from designs.hall_position import config
from designs.hall_position.trust import endurance, failures, starts
from designs.hall_position.trust.estimator_ensemble import EstimatorConfig
from models import hall_two_waves
from models.hall_motions import Pose
from synth.report import charts, maps, page
from synth.report.captions import Content, Rows
from synth.report.charts import Chart, Line
from synth.report.figures import COLOURS
from synth.report.maps import Map
from synth.simulate.ensemble import Scores

NAMES = {config.NAME: "two sensors", config.THREE: "three sensors"}
POINTS, BODIES, SAMPLES = 24, 4000, 60  # points along a pitch of the capture radius, random starts, samples of each
YAW = np.radians(2)  # of bodies in these, to either side
YAWS = np.array([-YAW, 0.0, YAW])  # of cold starts
STARTS, WAIT, DRIFT = 14, 400, 0.02  # points along a pitch of cold starts, samples, m/s of the moving ones
MOVING, LONG = 400, 250  # bodies in random motion, and their samples
MAPPED, FAILING = 32, 150  # places along a pitch of maps of failures, bodies of each case
CASES = {"at rest": 0.0, "moving": 0.1}  # share of the limits of speed and acceleration
SHOWN = "one axis"  # failure of the maps
SCALE = (1.0, 1e3)  # um, of the maps
SHARES = ("residual_exceeded", "flagged", "isolated", "valid")

EstimatorConfigs = Mapping[str, EstimatorConfig]


def estimators() -> dict[str, EstimatorConfig]:
    """Return the shipped estimators, by name."""
    return {name: EstimatorConfig(config.array(name)) for name in NAMES}


def blocks(of: EstimatorConfigs) -> dict[str, Content]:
    """Return basins, cold starts, motions and failures."""
    return {
        "trust.window_deg": float(np.degrees(config.TUNING.yaw_window)),
        "trust.starts": STARTS,
        "trust.drift": 1e3 * DRIFT,
        "trust.wait_s": WAIT * config.TIME.period_s,
        "trust.margin": 1 - endurance.MARGIN,
        "trust.far": endurance.PITCHES,
        "trust.motion": [_motion(name, estimator) for name, estimator in of.items()],
        "failures.soon": failures.MAX_DELAY,
        "failures.table": failure_rows(of),
        **basins(of),
        **cold_starts(of),
        **{f"failures.{name}": _undetected_error_map(estimator) for name, estimator in of.items()},
    }


def basins(of: EstimatorConfigs) -> dict[str, Content]:
    """Return capture radius and basins of the compiled C."""
    radius = [Map(NAMES[n], 1e3 * starts.capture_radius(estimator, POINTS)) for n, estimator in of.items()]
    pitch = 1e3 * next(iter(of.values())).array.pitch
    sides = [(0.0, pitch)] * 2
    by_name = {NAMES[name]: starts.basin(estimator, BODIES, YAW, SAMPLES) for name, estimator in of.items()}
    rows: list[tuple[page.Cell, ...]] = []
    for name, each in by_name.items():
        for after, shares in ((1, each.first), (SAMPLES, each.last)):
            rows += [
                (name, after, 1e3 * d, *(100 * row).tolist()) for d, row in zip(each.displacement, shares, strict=True)
            ]
    yaws = next(iter(by_name.values())).yaw
    columns = ("of", "samples", "off by up to, mm", *(f"turned by up to {np.degrees(t):.3g}°" for t in yaws))
    return {
        "trust.capture_radius": maps.maps(radius, sides, (0.0, pitch / 4), columns=2, log=False, label="mm"),
        "trust.basins": page.Table("Starts that converge to the true position, %", columns, tuple(rows), digits=3),
        "trust.wrong": [(name, each.samples, each.misleading) for name, each in by_name.items()],
    }


def cold_starts(of: EstimatorConfigs) -> dict[str, Content]:
    """Return the times from `init` to a valid estimate."""
    runs: dict[str, Scores] = {}
    for name, estimator in of.items():
        pose = Pose(*hall_two_waves.poses(estimator.array.pitch, STARTS, YAWS))
        for what, speed in (("at rest", 0.0), ("moving", DRIFT)):
            runs[f"{NAMES[name]}, {what}"] = starts.cold_start(estimator, pose, WAIT, speed)
    lines = []
    for k, (name, each) in enumerate(runs.items()):
        style = {"drawstyle": "steps-post", "color": COLOURS[k // 2], "ls": ("-", "--")[k % 2]}
        by = 100 * np.logical_or.accumulate(each.valid).mean(axis=1)
        lines.append(Line(_ms(np.arange(1, WAIT + 1)), by, name, style))
    options = {"ylim": (0.0, 103.0)}
    return {
        "trust.waits": charts.draw([Chart(lines, "time since init, ms", "valid, %", log="x", options=options)], 2.7),
        "trust.cold_starts": [_cold_start_row(name, each) for name, each in runs.items()],
    }


def _ms(samples: np.ndarray) -> np.ndarray:
    return 1e3 * config.TIME.period_s * samples


def _cold_start_row(name: str, each: Scores) -> tuple[page.Cell, ...]:
    took = each.first_valid
    ms = _ms(took[took > 0])
    half, most = (float(np.median(ms)), float(ms.max())) if ms.size else (np.inf, np.inf)
    located, valid = (100 * float(bodies.mean()) for bodies in (each.is_correct[-1], took > 0))
    return name, located, valid, half, most, int(each.is_wrong.sum())


def _motion(name: str, estimator: EstimatorConfig) -> tuple[page.Cell, ...]:
    """Return the limits of motion, and the result of random motions up to them."""
    run = endurance.run(estimator, MOVING, LONG, endurance.limits(estimator))
    shares = 100 * run.valid, 100 * run.lost, run.misleading, 1e6 * run.max_valid_error
    return NAMES[name], run.limits.speed, run.limits.acceleration, run.samples, *shares


def failure_rows(of: EstimatorConfigs) -> Rows:
    """Return the shares and errors after a sensor failure, at rest and in motion."""
    return [
        (NAMES[name], failure, case, *_worst(estimator, failure, part))
        for name, estimator in of.items()
        for failure in failures.FAILURES
        for case, part in CASES.items()
    ]


def _worst(estimator: EstimatorConfig, failure: str, part: float) -> tuple[page.Cell, ...]:
    most = endurance.limits(estimator)
    within = replace(most, speed=part * most.speed, acceleration=part * most.acceleration) if part else None
    sensors = range(1, len(estimator.array.positions) + 1)
    outcomes = [failures.run_failure(estimator, failure, sensor, FAILING, within, sensor) for sensor in sensors]
    means = (100 * float(np.mean([getattr(o, share) for o in outcomes])) for share in SHARES)
    return *means, max(o.delay for o in outcomes), 100 * max(o.misleading for o in outcomes)


def _undetected_error_map(estimator: EstimatorConfig) -> Figure:
    """Return maps of the error, at rest and yaw 0, where the failure of a sensor is not flagged."""
    shown = []
    for sensor in range(1, len(estimator.array.positions) + 1):
        off = failures.undetected_error(estimator, SHOWN, sensor, MAPPED)
        share = 100 * float(np.isfinite(off).mean())
        shown.append(Map(f"sensor {'ABC'[sensor - 1]}: {share:.3g} % not flagged", 1e6 * off))
    return maps.maps(shown, [(0.0, 1e3 * estimator.array.pitch)] * 2, SCALE, columns=len(shown), label="µm")
