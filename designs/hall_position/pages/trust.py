"""The shipped C from any start, in any motion, with sensors that fail, in the report."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from designs.hall_position import shipped
from designs.hall_position.pages import curves
from designs.hall_position.trust import basin, cold_start, endurance, failures
from designs.hall_position.trust.fleet import Kind
from synth.report import maps, page
from synth.report.maps import Map, figure
from synth.report.prose import Value

NAMES = {shipped.NAME: "two sensors", shipped.THREE: "three sensors"}
POINTS, BODIES, SAMPLES = 24, 4000, 60  # places along a pitch of the reach, starts drawn, samples of each
YAW = np.radians(2)  # of bodies in these, to either side
YAWS = np.array([-YAW, 0.0, YAW])  # of cold starts
STARTS, WAIT, DRIFT = 14, 400, 0.02  # places along a pitch of cold starts, samples, m/s of those that move
MOVING, LONG = 400, 250  # bodies in motion without end, and their samples
MAPPED, FAILING = 32, 150  # places along a pitch of maps of failures, bodies of each case
CASES = {"at rest": 0.0, "moving": 0.1}  # part of the speed and the acceleration that a body may have
SHOWN = "one axis"  # the failure of the maps
LARGEST = 1e3  # um, of the maps
SHARES = ("out", "flagged", "named", "valid")

Kinds = Mapping[str, Kind]


def kinds() -> dict[str, Kind]:
    """Return the estimators that ship, by name."""
    return {name: Kind(shipped.array(name), shipped.TUNING, shipped.TIME) for name in NAMES}


def blocks(of: Kinds) -> dict[str, Value]:
    """Return basins, cold starts, motions and failures."""
    return {
        "trust.window_deg": float(np.degrees(shipped.TUNING.turn)),
        "trust.starts": STARTS,
        "trust.drift": 1e3 * DRIFT,
        "trust.margin": 1 - endurance.MARGIN,
        "failures.soon": failures.SOON,
        "trust.motion": motion(of),
        "failures.table": failing(of),
        **basins(of),
        **cold_starts(of),
        **{f"failures.{name}": _unseen(name, kind) for name, kind in of.items()},
    }


def basins(of: Kinds) -> dict[str, Value]:
    """Return how far a start may be off, by the compiled C."""
    reach = [Map(NAMES[n], 1e3 * basin.over_pitch(kind, POINTS).reach) for n, kind in of.items()]
    pitch = next(iter(of.values())).array.pitch
    drawn = maps.maps(reach, pitch, 0.0, 1e3 * pitch / 4, columns=2, log=False, label="mm")
    mapped = {NAMES[name]: basin.mapped(kind, BODIES, YAW, SAMPLES) for name, kind in of.items()}
    rows: list[tuple[page.Cell, ...]] = []
    for name, each in mapped.items():
        for after, shares in ((1, each.first), (SAMPLES, each.then)):
            along = zip(each.off.tolist(), shares, strict=True)
            rows += [(name, after, 1e3 * d, *(100 * row).tolist()) for d, row in along]
    turned = next(iter(mapped.values())).turned
    columns = ("of", "samples", "off by up to, mm", *(f"turned by up to {np.degrees(t):.3g}°" for t in turned))
    wrong = tuple((name, each.samples, each.wrong) for name, each in mapped.items())
    caption = "How far all starts around a place may be off, in mm, so that one sample leads to it, yaw 0."
    return {
        "trust.reach": figure("reach", drawn, caption),
        "trust.basins": page.Table("Starts that lead to the truth, %", columns, tuple(rows), digits=3),
        "trust.wrong": page.Table(
            "Samples that were valid away from the truth", ("of", "samples", "valid and wrong"), wrong
        ),
    }


def cold_starts(of: Kinds) -> dict[str, Value]:
    """Return how long it takes from `init` to a valid estimate."""
    runs = {
        f"{NAMES[name]}, {what}": cold_start.run(kind, cold_start.grid(kind, STARTS, YAWS), WAIT, speed)
        for name, kind in of.items()
        for what, speed in (("at rest", 0.0), ("moving", DRIFT))
    }
    rows, time = [], 1e3 * shipped.TIME.period_s
    for name, each in runs.items():
        took = time * each.took[each.took > 0]
        half, most = (float(np.median(took)), float(took.max())) if took.size else (np.inf, np.inf)
        rows.append((name, 100 * float(each.found.mean()), 100 * each.valid, half, most, each.wrong))
    columns = ("bodies", "found, %", "valid, %", "half of them after, ms", "last of them after, ms", "valid and wrong")
    drawn = curves.waits({name: each.took for name, each in runs.items()}, WAIT, shipped.TIME.period_s)
    return {
        "trust.waits": figure("cold-starts", drawn, "Share of cold starts that are valid, by the time."),
        "trust.cold_starts": page.Table(f"Cold starts, {WAIT * time / 1e3:g} s", columns, tuple(rows), digits=3),
    }


def motion(of: Kinds) -> page.Table:
    """Return how fast a body may be, and a run of random motions at these speeds."""
    rows: list[tuple[page.Cell, ...]] = []
    for name, kind in of.items():
        within = endurance.limits(kind)
        run = endurance.run(kind, MOVING, LONG, within)
        shares = 100 * run.valid, 100 * run.lost, run.wrong, 1e6 * run.worst
        rows.append((NAMES[name], within.speed, within.acceleration, run.samples, *shares))
    columns = ("sensors", "speed, m/s", "acceleration, m/s²", "samples", "valid, %", "bodies lost, %")
    caption = f"Random motion up to the speed and the acceleration, {endurance.FAR} pitches counted"
    return page.Table(caption, (*columns, "valid and wrong", "worst valid, µm"), tuple(rows))


def failing(of: Kinds) -> page.Table:
    """Return what becomes of the estimates when a sensor fails, at rest and in motion."""
    rows = tuple(
        (NAMES[name], failure, case, *_worst(kind, failure, part))
        for name, kind in of.items()
        for failure in failures.FAILURES
        for case, part in CASES.items()
    )
    shown = ("out of bound, %", "flagged, %", "named, %", "valid at the end, %", "late", "away, %")
    caption = "A sensor fails: means over the sensors, of 'late' and 'away' the largest"
    return page.Table(caption, ("of", "failure", "body", *shown), rows, digits=3)


def _worst(kind: Kind, failure: str, part: float) -> tuple[page.Cell, ...]:
    most = endurance.limits(kind)
    within = replace(most, speed=part * most.speed, acceleration=part * most.acceleration) if part else None
    sensors = range(1, len(kind.array.positions) + 1)
    outcomes = [failures.tried(kind, failure, sensor, FAILING, within, sensor) for sensor in sensors]
    means = (100 * float(np.mean([getattr(o, share) for o in outcomes])) for share in SHARES)
    return *means, max(o.late for o in outcomes), 100 * max(o.away for o in outcomes)


def _unseen(name: str, kind: Kind) -> page.Figure:
    shown = []
    for sensor in range(1, len(kind.array.positions) + 1):
        unseen = failures.unseen(kind, SHOWN, sensor, MAPPED)
        share = 100 * float(np.mean(unseen.unseen))
        values = np.where(unseen.unseen, 1e6 * unseen.error, np.nan)
        shown.append(Map(f"sensor {'ABC'[sensor - 1]}: {share:.3g} % unseen", values))
    drawn = maps.maps(shown, kind.array.pitch, 1.0, LARGEST, columns=len(shown), label="µm")
    caption = (
        f"{NAMES[name]}: where at rest, yaw 0, a sensor of which one voltage is dead is not flagged within "
        f"{failures.SOON} samples, and by how much the estimate errs there; white is flagged."
    )
    return figure(f"unseen-{name}", drawn, caption)
