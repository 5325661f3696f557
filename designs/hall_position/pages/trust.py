"""The shipped C from any start, in any motion, with sensors that fail, in the report."""

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
from synth.report.captions import Made, Rows
from synth.report.charts import Chart, Line
from synth.report.figures import COLOURS
from synth.report.maps import Map
from synth.simulate.ensemble import Scores

NAMES = {config.NAME: "two sensors", config.THREE: "three sensors"}
POINTS, BODIES, SAMPLES = 24, 4000, 60  # places along a pitch of the reach, starts drawn, samples of each
YAW = np.radians(2)  # of bodies in these, to either side
YAWS = np.array([-YAW, 0.0, YAW])  # of cold starts
STARTS, WAIT, DRIFT = 14, 400, 0.02  # places along a pitch of cold starts, samples, m/s of those that move
MOVING, LONG = 400, 250  # bodies in motion without end, and their samples
MAPPED, FAILING = 32, 150  # places along a pitch of maps of failures, bodies of each case
CASES = {"at rest": 0.0, "moving": 0.1}  # part of the speed and the acceleration that a body may have
SHOWN = "one axis"  # the failure of the maps
SCALE = (1.0, 1e3)  # um, of the maps
SHARES = ("residual_exceeded", "flagged", "isolated", "valid")

EstimatorConfigs = Mapping[str, EstimatorConfig]


def estimators() -> dict[str, EstimatorConfig]:
    """Return the estimators that ship, by name."""
    return {name: EstimatorConfig(config.array(name)) for name in NAMES}


def blocks(of: EstimatorConfigs) -> dict[str, Made]:
    """Return basins, cold starts, motions and failures."""
    return {
        "trust.window_deg": float(np.degrees(config.TUNING.yaw_window)),
        "trust.starts": STARTS,
        "trust.drift": 1e3 * DRIFT,
        "trust.wait_s": WAIT * config.TIME.period_s,
        "trust.margin": 1 - endurance.MARGIN,
        "trust.far": endurance.PITCHES,
        "trust.motion": [_motion(name, kind) for name, kind in of.items()],
        "failures.soon": failures.MAX_DELAY,
        "failures.table": failure_rows(of),
        **basins(of),
        **cold_starts(of),
        **{f"failures.{name}": _undetected_error_map(kind) for name, kind in of.items()},
    }


def basins(of: EstimatorConfigs) -> dict[str, Made]:
    """Return how far a start may be off, by the compiled C."""
    reach = [Map(NAMES[n], 1e3 * starts.capture_radius(kind, POINTS)) for n, kind in of.items()]
    pitch = 1e3 * next(iter(of.values())).array.pitch
    by_name = {NAMES[name]: starts.basin(kind, BODIES, YAW, SAMPLES) for name, kind in of.items()}
    rows: list[tuple[page.Cell, ...]] = []
    for name, each in by_name.items():
        for after, shares in ((1, each.first), (SAMPLES, each.last)):
            rows += [(name, after, 1e3 * d, *(100 * row).tolist()) for d, row in zip(each.off, shares, strict=True)]
    turned = next(iter(by_name.values())).turned
    columns = ("of", "samples", "off by up to, mm", *(f"turned by up to {np.degrees(t):.3g}°" for t in turned))
    return {
        "trust.capture_radius": maps.maps(reach, [(0.0, pitch)] * 2, (0.0, pitch / 4), columns=2, log=False, label="mm"),
        "trust.basins": page.Table("Starts that lead to the truth, %", columns, tuple(rows), digits=3),
        "trust.wrong": [(name, each.samples, each.wrong) for name, each in by_name.items()],
    }


def cold_starts(of: EstimatorConfigs) -> dict[str, Made]:
    """Return how long it takes from `init` to a valid estimate."""
    runs: dict[str, Scores] = {}
    for name, kind in of.items():
        pose = Pose(*hall_two_waves.poses(kind.array.pitch, STARTS, YAWS))
        for what, speed in (("at rest", 0.0), ("moving", DRIFT)):
            runs[f"{NAMES[name]}, {what}"] = starts.cold_start(kind, pose, WAIT, speed)
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
    located, valid = (100 * float(bodies.mean()) for bodies in (each.right[-1], took > 0))
    return name, located, valid, half, most, int(each.wrong.sum())


def _motion(name: str, kind: EstimatorConfig) -> tuple[page.Cell, ...]:
    """Return how fast a body may be, and a run of random motions at these speeds."""
    run = endurance.run(kind, MOVING, LONG, endurance.limits(kind))
    shares = 100 * run.valid, 100 * run.lost, run.wrong, 1e6 * run.worst
    return NAMES[name], run.limits.speed, run.limits.acceleration, run.samples, *shares


def failure_rows(of: EstimatorConfigs) -> Rows:
    """Return what becomes of the estimates when a sensor fails, at rest and in motion."""
    return [
        (NAMES[name], failure, case, *_worst(kind, failure, part))
        for name, kind in of.items()
        for failure in failures.FAILURES
        for case, part in CASES.items()
    ]


def _worst(kind: EstimatorConfig, failure: str, part: float) -> tuple[page.Cell, ...]:
    most = endurance.limits(kind)
    within = replace(most, speed=part * most.speed, acceleration=part * most.acceleration) if part else None
    sensors = range(1, len(kind.array.positions) + 1)
    outcomes = [failures.run_failure(kind, failure, sensor, FAILING, within, sensor) for sensor in sensors]
    means = (100 * float(np.mean([getattr(o, share) for o in outcomes])) for share in SHARES)
    return *means, max(o.delay for o in outcomes), 100 * max(o.misleading for o in outcomes)


def _undetected_error_map(kind: EstimatorConfig) -> Figure:
    """Return where at rest, yaw 0, the failure of a sensor is not flagged, and by how much the estimate errs there."""
    shown = []
    for sensor in range(1, len(kind.array.positions) + 1):
        off = failures.undetected_error(kind, SHOWN, sensor, MAPPED)
        share = 100 * float(np.isfinite(off).mean())
        shown.append(Map(f"sensor {'ABC'[sensor - 1]}: {share:.3g} % unseen", 1e6 * off))
    return maps.maps(shown, [(0.0, 1e3 * kind.array.pitch)] * 2, SCALE, columns=len(shown), label="µm")
