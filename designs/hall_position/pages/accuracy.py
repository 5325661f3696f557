"""Accuracy in the report: over pitch and yaw, lost rank, comparison of layouts, model errors, basins."""

from collections.abc import Mapping
from math import radians

import numpy as np
from matplotlib.figure import Figure

from designs.hall_position.accuracy.layouts import LAYOUTS
from designs.hall_position.pages import drawings
from designs.hall_position.paper import errors, rank
from models import hall_correction, hall_fisher, hall_singular_points
from models.hall_array import Array
from models.hall_stage import PUBLISHED, Stage, grid
from models.hall_two_waves import PlanarArray
from synth.report import charts, maps
from synth.report.captions import Made, Rows
from synth.report.charts import LEVEL, Chart, Line
from synth.report.maps import Map

UM = 1e-6
POINTS = 96  # of a map, along a pitch
COARSE, TURNS = 48, 121  # of the curve over yaw: positions along a pitch, yaws
YAW = radians(5)  # of the second row of maps
WIDEST = radians(30)  # of that curve, to either side
SINGULAR = (0.0, 1.0, 2.0, 5.0, 10.0)  # degrees
REQUIRED = 5.3e-6  # m, required of the third sensor at yaw 0
SIDE, PLACES = 25, 16  # starts along a side, from so many positions of the pitch each
WIDE = 0.5  # pitches: the starts' square
CORRECTIONS, SCALE = 60, 0.5
CONVERGED = 1e-6  # m
OFF = ("off along X, pitches", "off along Y, pitches")
NEAR = (0.0625, 0.125, 0.25)  # pitches: distances of counted starts


def blocks(stage: Stage) -> dict[str, Made]:
    """Return the accuracy of each layout over the pitch and the yaw, and the errors of the field's model."""
    layouts = layouts_by_name(stage)
    places = {n: [(x / of.pitch, y / of.pitch) for x, y in of.positions] for n, of in layouts.items()}
    return {
        "accuracy.places": drawings.layouts(places),
        "accuracy.maps": _maps(stage, layouts),
        "accuracy.coarse": COARSE,
        "accuracy.required": REQUIRED / UM,
        "accuracy.over_yaw": _over_yaw(layouts),
        "accuracy.worst": _worst(stage),
        "accuracy.singular": [_singular(stage, turn) for turn in SINGULAR],
        **_errors(stage),
        **_basins(stage),
    }


def layouts_by_name(stage: Stage) -> dict[str, PlanarArray]:
    """Return the compared layouts, by name."""
    searched = {f"searched, ±{turn}°": stage.array(places) for turn, places in LAYOUTS.items()}
    return {"two sensors": stage.pair, "third sensor added": stage.array(PUBLISHED)} | searched


def _over_pitch(stage: Stage) -> list[tuple[float, float]]:
    return [(0.0, 1e3 * stage.pitch)] * 2


def _maps(stage: Stage, layouts: Mapping[str, PlanarArray]) -> Figure:
    shown = []
    for yaw in (0.0, YAW):
        for name in list(layouts)[:3]:
            marks = 1e3 * hall_singular_points.of_pair(stage.pair, yaw) if name == "two sensors" else None
            shown.append(Map(f"{name}, yaw {np.degrees(yaw):g}°", _larger(layouts[name], yaw) / UM, marks))
    return maps.maps(shown, _over_pitch(stage), (2.0, 20.0), label="µm")


def _larger(of: PlanarArray, yaw: float) -> Array:
    """Return the larger of the deviations of X and Y (POINTS, POINTS) over the pitch at a yaw, m."""
    q = grid(of, POINTS)
    q[2] = yaw
    return np.asarray(hall_fisher.deviations(of, q)[:2].max(axis=0).reshape(POINTS, POINTS))


def _over_yaw(layouts: Mapping[str, PlanarArray]) -> Figure:
    lines, yaws = [], np.linspace(-WIDEST, WIDEST, TURNS)
    for name, of in list(layouts.items())[1:]:
        q = np.tile(grid(of, COARSE), TURNS)
        q[2] = np.repeat(yaws, COARSE**2)
        largest = hall_fisher.deviations(of, q)[:2].max(axis=0).reshape(TURNS, -1).max(axis=1)
        lines.append(Line(np.degrees(yaws), largest / UM, name, {"lw": 1.2}))
    lines.append(Line(np.degrees(yaws), np.full(TURNS, REQUIRED / UM), style={**LEVEL, "ls": ":"}))
    return charts.draw([Chart(lines, "yaw, °", "largest of X and Y over the pitch, µm", log="y")], 3.0)


def _worst(stage: Stage) -> Rows:
    proofs = {("third sensor added", 0): rank.worst(stage.array(PUBLISHED), 0.0, 0.0)}
    proofs |= {(f"searched, ±{turn}°", turn): rank.worst_of_optimised_layout(stage, turn) for turn in (5, 15)}
    rows: list[tuple[str, ...]] = [("two sensors", "any", *("none",) * 6)]
    for (name, turn), proved in proofs.items():
        values = (f"{v / UM:.4g}" for v in (*proved.met, *proved.bound))
        rows.append((name, f"{-turn or 0} .. {turn}".replace("-", "−"), *values))
    return rows


def _singular(stage: Stage, turn: float) -> tuple[float, ...]:
    points = hall_singular_points.of_pair(stage.pair, radians(turn))
    first = points[0] if len(points) else np.full(2, np.nan)
    return turn, len(points), *(1e3 * first).tolist()


def _errors(stage: Stage) -> dict[str, Made]:
    by_layout = {
        "two sensors, yaw known": errors.errors(stage, True),
        "two sensors, yaw estimated": errors.errors(stage, False),
        "three sensors, searched, yaw estimated": errors.by_waves(stage, stage.array(LAYOUTS[5])),
    }
    off = {name: 1e3 * np.hypot(*each).reshape(stage.truth.count, -1) for name, each in by_layout.items()}
    shown = [Map(name, values) for name, values in off.items()]
    return {
        "errors.figure": maps.maps(shown, _over_pitch(stage), (0.02, 2.0), label="mm"),
        "errors.table": [(n, errors.rms(v), *np.percentile(v, (99, 100)).tolist()) for n, v in off.items()],
    }


def _basins(stage: Stage) -> dict[str, Made]:
    """Return the basins of GLSDC without damping or prediction."""
    shares = {
        "two sensors, yaw known": basin(stage.pair, True),
        "two sensors, yaw estimated": basin(stage.pair, False),
        "three sensors, searched": basin(stage.array(LAYOUTS[5]), False),
    }
    away = WIDE * np.abs(np.linspace(-1, 1, SIDE))
    near = [np.maximum(away[:, None], away) <= distance + 1e-9 for distance in NEAR]
    shown = [Map(n, 100 * share) for n, share in shares.items()]
    return {
        "basin.scale": SCALE,
        "basin.places": PLACES,
        "basin.figure": maps.maps(shown, [(-WIDE, WIDE)] * 2, (0.0, 100.0), log=False, label="%", labels=OFF),
        "basin.table": [(n, *(100 * float(v[inside].mean()) for inside in near)) for n, v in shares.items()],
    }


def basin(of: PlanarArray, yaw_known: bool) -> Array:
    """Return the share of positions (SIDE, SIDE) at which starts offset by (X, Y) converge."""
    off = of.pitch * np.linspace(-WIDE, WIDE, SIDE)
    X, Y = np.meshgrid(off, off, indexing="ij")
    places = of.pitch * np.random.default_rng(0).uniform(0, 1, (2, PLACES))
    q = np.zeros((3, PLACES, SIDE, SIDE))
    q[:2] = places[:, :, None, None]
    start = q + np.array([X, Y, np.zeros_like(X)])[:, None]
    flat, starts = q.reshape(3, -1), start.reshape(3, -1)
    end = hall_correction.iterate(of, hall_correction.volts(of, flat), starts, SCALE, CORRECTIONS, yaw_known)
    return np.asarray((np.hypot(*(end - flat)[:2]) < CONVERGED).reshape(PLACES, SIDE, SIDE).mean(axis=0))
