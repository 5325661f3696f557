"""What the voltages tell, in the report: accuracy over pitch and yaw, lost rank, layouts compared, errors, basins."""

from collections.abc import Mapping
from math import radians

import numpy as np

from designs.hall_position.accuracy import fisher, singular_points
from designs.hall_position.accuracy.layouts import LAYOUTS, PUBLISHED
from designs.hall_position.glsdc import parameters
from designs.hall_position.pages import curves, drawings
from designs.hall_position.paper import errors, estimate, rank
from designs.hall_position.paper.stage import TOLERANCE, UM, Array, Stage, grid, worst
from synth.report import maps, page
from synth.report.maps import Map, figure
from synth.report.prose import Value

POINTS = 96  # of a map, along a pitch
COARSE, TURNS = 48, 121  # of the curve over yaw: places along a pitch, yaws
YAW = radians(5)  # of the second maps
WIDEST = radians(30)  # of that curve, to either side
SINGULAR = (0.0, 1.0, 2.0, 5.0, 10.0)  # degrees
REQUIRED = 5.3e-6  # m, of the third sensor at yaw 0
SIDE, PLACES = 25, 16  # starts along a side, from so many places of the pitch each
WIDE = 0.5  # pitches: the starts' square
CORRECTIONS, SCALE = 60, 0.5
FOUND = 1e-6  # m
NEAR = (0.0625, 0.125, 0.25)  # pitches, of starts that are counted


def blocks(stage: Stage) -> dict[str, Value]:
    """Return how accurate each layout is over the pitch and the yaw, and by how much the field's model errs."""
    layouts = named(stage)
    return {
        "accuracy.places": _places(layouts),
        "accuracy.maps": _maps(stage, layouts),
        "accuracy.over_yaw": _turned(layouts),
        "accuracy.worst": _worst(stage),
        "accuracy.singular": _singular(stage),
        **_errors(stage),
        **_basins(stage),
    }


def named(stage: Stage) -> dict[str, parameters.Array]:
    """Return the layouts that are compared, by name."""
    searched = {f"searched, ±{turn}°": stage.array(places) for turn, places in LAYOUTS.items()}
    return {"two sensors": stage.pair, "third sensor added": stage.array(PUBLISHED)} | searched


def _places(layouts: Mapping[str, parameters.Array]) -> page.Figure:
    shown = {n: [(x / of.pitch, y / of.pitch) for x, y in of.positions] for n, of in layouts.items()}
    caption = "Sensors in the body, in pitches, beside the square of one pitch about the body's origin."
    return figure("layouts", drawings.layouts(shown), caption)


def _maps(stage: Stage, layouts: Mapping[str, parameters.Array]) -> page.Figure:
    shown = []
    for yaw in (0.0, YAW):
        for name in list(layouts)[:3]:
            marks = singular_points.of_pair(stage.pair, yaw).at if name == "two sensors" else None
            shown.append(Map(f"{name}, yaw {np.degrees(yaw):g}°", _larger(layouts[name], yaw) / UM, marks))
    caption = "Standard deviation of X or Y, whichever is larger, for 1 mV. Circles: singular points."
    return figure("accuracy", maps.maps(shown, stage.pitch, 2.0, 20.0, label="µm"), caption)


def _larger(of: parameters.Array, yaw: float) -> Array:
    """Return the larger of the deviations of X and Y (POINTS, POINTS) over the pitch at a yaw, m."""
    q = grid(of, POINTS)
    q[2] = yaw
    return np.asarray(fisher.deviations(of, q)[:2].max(axis=0).reshape(POINTS, POINTS))


def _turned(layouts: Mapping[str, parameters.Array]) -> page.Figure:
    lines, yaws = {}, np.linspace(-WIDEST, WIDEST, TURNS)
    for name, of in list(layouts.items())[1:]:
        q = np.tile(grid(of, COARSE), TURNS)
        q[2] = np.repeat(yaws, COARSE**2)
        lines[name] = (yaws, fisher.deviations(of, q)[:2].max(axis=0).reshape(TURNS, -1).max(axis=1))
    caption = (
        f"Largest deviation over the pitch by the yaw, on {COARSE} × {COARSE} places, which show less than the worst. "
        f"Dotted: the {REQUIRED / UM:g} µm that are required of the third sensor at yaw 0."
    )
    return figure("over-yaw", drawings.over_yaw(lines, REQUIRED), caption)


def _worst(stage: Stage) -> page.Table:
    cases = [("third sensor added", PUBLISHED, 0), *((f"searched, ±{t}°", LAYOUTS[t], t) for t in (5, 15))]
    rows: list[tuple[page.Cell, ...]] = [("two sensors", "any", *("none",) * 6)]
    for name, places, turn in cases:
        of = stage.array(places)
        proved = worst(of, -radians(turn), radians(turn), rank.TOLERANCES.get(turn, TOLERANCE))
        values = (f"{v / UM:.4g}" for v in (*proved.met, *proved.bound))
        rows.append((name, f"{-turn or 0} .. {turn}".replace("-", "−"), *values))
    columns = ("layout", "yaw, °", "X, µm", "Y, µm", "yaw, µrad", "X at most", "Y at most", "yaw at most")
    return page.Table("Largest deviations that were found, and bounds that are proved", columns, tuple(rows))


def _singular(stage: Stage) -> page.Table:
    rows: list[tuple[page.Cell, ...]] = []
    for turn in SINGULAR:
        points = singular_points.of_pair(stage.pair, radians(turn)).at
        first = points[0] if len(points) else np.full(2, np.nan)
        rows.append((turn, len(points), *(1e3 * first).tolist()))
    columns = ("yaw, °", "singular points in the pitch", "first: X, mm", "Y, mm")
    return page.Table("Where two sensors lose rank", columns, tuple(rows))


def _errors(stage: Stage) -> dict[str, Value]:
    n = stage.truth.count
    known, free = (1e3 * np.hypot(*errors.errors(stage, yaw)).reshape(n, n) for yaw in (True, False))
    three = 1e3 * np.hypot(*errors.by_waves(stage, stage.array(LAYOUTS[5]))).reshape(n, n)
    shown = [
        Map("two sensors, yaw known", known),
        Map("two sensors, yaw estimated", free),
        Map("three sensors, searched, yaw estimated", three),
    ]
    rows = tuple(
        (m.title, errors.rms(np.asarray(m.values, np.float64)), *np.percentile(m.values, (99, 100)).tolist())
        for m in shown
    )
    columns = ("sensors", "rms", "99 % of the places", "largest")
    drawn = maps.maps(shown, stage.pitch, 0.02, 2.0, label="mm")
    return {
        "errors.figure": figure("model-error", drawn, "Distance of the estimate from the true place, mm."),
        "errors.table": page.Table("Errors in mm by model (2), yaw 0", columns, rows, digits=3),
    }


def _basins(stage: Stage) -> dict[str, Value]:
    """Return from which starts GLSDC finds the place, without damping or memory."""
    shares = {
        "two sensors, yaw known": basin(stage.pair, True),
        "two sensors, yaw estimated": basin(stage.pair, False),
        "three sensors, searched": basin(stage.array(LAYOUTS[5]), False),
    }
    away = WIDE * np.abs(np.linspace(-1, 1, SIDE))
    furthest = np.maximum(away[:, None], away)
    rows: tuple[tuple[page.Cell, ...], ...]
    rows = tuple((n, *(100 * float(v[furthest <= near + 1e-9].mean()) for near in NEAR)) for n, v in shares.items())
    columns = ("sensors", *(f"within 1/{1 / near:g} pitch, %" for near in NEAR))
    drawn = curves.basins([Map(name, 100 * share) for name, share in shares.items()], WIDE)
    return {
        "basin.scale": SCALE,
        "basin.figure": figure("basins", drawn, f"Share of {PLACES} places in %, by where the start is off."),
        "basin.table": page.Table("Starts that lead to the place", columns, rows, digits=3),
    }


def basin(of: parameters.Array, yaw_known: bool) -> Array:
    """Return the share of places (SIDE, SIDE) at which starts off by (X, Y) lead to the body."""
    off = of.pitch * np.linspace(-WIDE, WIDE, SIDE)
    X, Y = np.meshgrid(off, off, indexing="ij")
    places = of.pitch * np.random.default_rng(0).uniform(0, 1, (2, PLACES))
    q = np.zeros((3, PLACES, SIDE, SIDE))
    q[:2] = places[:, :, None, None]
    start = q + np.array([X, Y, np.zeros_like(X)])[:, None]
    flat, begun = q.reshape(3, -1), start.reshape(3, -1)
    end = estimate.settled(of, estimate.volts(of, flat), begun, SCALE, CORRECTIONS, yaw_known)
    return np.asarray((np.hypot(*(end - flat)[:2]) < FOUND).reshape(PLACES, SIDE, SIDE).mean(axis=0))
