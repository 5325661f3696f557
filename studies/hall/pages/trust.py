"""Integrity of the shipped C in the report: convergence, cold starts, motion, sensor failures."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from matplotlib.figure import Figure

from designs.hall_position import config
from models import hall_two_waves
from models.hall_motions import Pose
from studies.hall.trust import endurance, failures, starts
from studies.hall.trust.estimator_ensemble import EstimatorConfig
from synth import show
from synth.report import maps
from synth.report.figures import COLOURS
from synth.report.maps import Chart, Line, Map
from synth.report.prose import Content, Rows
from synth.simulate.sampling import Scores

NAMES = {config.NAME: "two sensors"}
RADIUS_POINTS = 24  # along a pitch, in the map of the capture radius
BODIES, SAMPLES = 4000, 60  # in the basins: random starts, and samples of each
YAW = np.radians(2)  # largest yaw of a start, to either side
YAWS = np.array([-YAW, 0.0, YAW])  # of cold starts
STARTS, COLD_SAMPLES = 14, 400  # cold starts along a pitch, and samples of each
DRIFT = 0.02  # m/s, of the cold starts in motion
MOVING_BODIES, MOTION_SAMPLES = 400, 250  # in random motion
FAILURE_POINTS, FAILURE_BODIES = 32, 150  # along a pitch of a map of failures; in each case of the table
CASES = {"at rest": 0.0, "moving": 0.1}  # fraction of the limits of speed and acceleration
MAPPED_FAILURE = "one axis"
ERROR_RANGE = (1.0, 1e3)  # um, of the maps
SHARES = ("residual_exceeded", "flagged", "valid")

EstimatorConfigs = Mapping[str, EstimatorConfig]


def estimators() -> dict[str, EstimatorConfig]:
    """Return the estimator without protection levels, by name."""
    return {name: EstimatorConfig(config.array()) for name in NAMES}


def blocks(configs: EstimatorConfigs) -> dict[str, Content]:
    """Return basins, cold starts, motions and failures."""
    return {
        "trust.window_deg": float(np.degrees(config.TUNING.yaw_window)),
        "trust.starts": STARTS,
        "trust.drift": 1e3 * DRIFT,
        "trust.wait_s": COLD_SAMPLES * config.TIME.period_s,
        "trust.margin": 1 - endurance.RESERVED_FRACTION,
        "trust.far": endurance.COUNTED_PITCHES,
        "trust.motion": [_motion(name, estimator) for name, estimator in configs.items()],
        "failures.soon": failures.MAX_DELAY,
        "failures.table": failure_rows(configs),
        **basins(configs),
        **cold_starts(configs),
        **{f"failures.{name}": _undetected_error_map(estimator) for name, estimator in configs.items()},
    }


def basins(configs: EstimatorConfigs) -> dict[str, Content]:
    """Return capture radius and basins of the compiled C."""
    radius = [Map(NAMES[n], 1e3 * starts.capture_radius(estimator, RADIUS_POINTS)) for n, estimator in configs.items()]
    pitch = 1e3 * next(iter(configs.values())).array.pitch
    sides = [(0.0, pitch)] * 2
    by_name = {NAMES[name]: starts.basin(estimator, BODIES, YAW, SAMPLES) for name, estimator in configs.items()}
    rows: list[tuple[show.Cell, ...]] = []
    for name, each in by_name.items():
        for after, shares in ((1, each.first), (SAMPLES, each.last)):
            rows += [
                (name, after, 1e3 * d, *(100 * row).tolist()) for d, row in zip(each.displacement, shares, strict=True)
            ]
    yaws = next(iter(by_name.values())).yaw
    columns = (
        "estimator",
        "samples",
        "displaced by up to, mm",
        *(f"rotated by up to {np.degrees(t):.3g}°" for t in yaws),
    )
    return {
        "trust.capture_radius": maps.maps(radius, sides, (0.0, pitch / 4), columns=2, log=False, label="mm"),
        "trust.basins": show.Table("Starts that converge to the true position, %", columns, tuple(rows), digits=3),
        "trust.wrong": [(name, each.samples, each.misleading) for name, each in by_name.items()],
    }


def cold_starts(configs: EstimatorConfigs) -> dict[str, Content]:
    """Return the times from `init` to a valid estimate."""
    runs: dict[str, Scores] = {}
    for name, estimator in configs.items():
        pose = Pose(*hall_two_waves.poses(estimator.array.pitch, STARTS, YAWS))
        for what, speed in (("at rest", 0.0), ("moving", DRIFT)):
            runs[f"{NAMES[name]}, {what}"] = starts.cold_start(estimator, pose, COLD_SAMPLES, speed)
    lines = []
    for k, (name, each) in enumerate(runs.items()):
        style = {"drawstyle": "steps-post", "color": COLOURS[k // 2], "ls": ("-", "--")[k % 2]}
        valid_share = 100 * np.logical_or.accumulate(each.valid).mean(axis=1)
        lines.append(Line(_ms(np.arange(1, COLD_SAMPLES + 1)), valid_share, name, style))
    options = {"ylim": (0.0, 103.0)}
    return {
        "trust.waits": maps.draw([Chart(lines, "time since init, ms", "valid, %", log="x", options=options)], 2.7),
        "trust.cold_starts": [_cold_start_row(name, each) for name, each in runs.items()],
    }


def _ms(samples: np.ndarray) -> np.ndarray:
    return 1e3 * config.TIME.period_s * samples


def _cold_start_row(name: str, each: Scores) -> tuple[show.Cell, ...]:
    first_valid = each.first_valid  # samples, 0 without a valid estimate
    ms = _ms(first_valid[first_valid > 0])
    median, longest = (float(np.median(ms)), float(ms.max())) if ms.size else (np.inf, np.inf)
    located, valid = (100 * float(bodies.mean()) for bodies in (each.is_correct[-1], first_valid > 0))
    return name, located, valid, median, longest, int(each.is_wrong.sum())


def _motion(name: str, estimator: EstimatorConfig) -> tuple[show.Cell, ...]:
    """Return the limits of motion, and the result of random motions up to them."""
    run = endurance.run(estimator, MOVING_BODIES, MOTION_SAMPLES, endurance.limits(estimator))
    shares = 100 * run.valid_share, 100 * run.lock_lost_share, run.misleading, 1e6 * run.max_valid_error
    return NAMES[name], run.limits.speed, run.limits.acceleration, run.samples, *shares


def failure_rows(configs: EstimatorConfigs) -> Rows:
    """Return the shares and errors after a sensor failure, at rest and in motion."""
    return [
        (NAMES[name], failure, case, *_worst(estimator, failure, fraction))
        for name, estimator in configs.items()
        for failure in failures.FAILURES
        for case, fraction in CASES.items()
    ]


def _worst(estimator: EstimatorConfig, failure: str, fraction: float) -> tuple[show.Cell, ...]:
    limits = endurance.limits(estimator)
    reduced = replace(limits, speed=fraction * limits.speed, acceleration=fraction * limits.acceleration)
    motion = reduced if fraction else None
    sensors = range(1, len(estimator.array.positions) + 1)
    outcomes = [failures.run_failure(estimator, failure, sensor, FAILURE_BODIES, motion, sensor) for sensor in sensors]
    means = (100 * float(np.mean([getattr(o, share) for o in outcomes])) for share in SHARES)
    return *means, max(o.delay for o in outcomes), 100 * max(o.misleading for o in outcomes)


def _undetected_error_map(estimator: EstimatorConfig) -> Figure:
    """Return maps of the error, at rest and yaw 0, where the failure of a sensor is not flagged."""
    shown = []
    for sensor in range(1, len(estimator.array.positions) + 1):
        error = failures.undetected_error(estimator, MAPPED_FAILURE, sensor, FAILURE_POINTS)
        share = 100 * float(np.isfinite(error).mean())
        shown.append(Map(f"sensor {'ABC'[sensor - 1]}: {share:.3g} % not flagged", 1e6 * error))
    return maps.maps(shown, [(0.0, 1e3 * estimator.array.pitch)] * 2, ERROR_RANGE, columns=len(shown), label="µm")
