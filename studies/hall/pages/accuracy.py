"""Accuracy in the report: deviations over pitch and yaw, singular points, model errors, regions of convergence."""

from collections.abc import Mapping
from math import radians

import numpy as np
from matplotlib.figure import Figure

from designs.hall_position.paper import correction, errors, fisher, rank, singular_points
from designs.hall_position.paper.layouts import LAYOUTS
from models.hall_array import Array
from models.hall_stage import PUBLISHED, Stage, grid
from models.hall_two_waves import PlanarArray
from studies.hall.pages import drawings
from synth.report import maps
from synth.report.maps import LEVEL, Chart, Line, Map
from synth.report.prose import Content, Rows

UM = 1e-6
POINTS = 96  # points of a map along each side of the pitch
CURVE_POINTS, CURVE_YAWS = 48, 121  # for the curve over yaw: positions along each side of the pitch, and number of yaws
YAW = radians(5)  # of the second row of maps
MAX_YAW = radians(30)  # largest yaw of that curve, to either side
SINGULAR_YAWS = (0.0, 1.0, 2.0, 5.0, 10.0)  # degrees: yaws at which the singular points of two sensors are listed
REQUIRED = 5.3e-6  # m, largest deviation allowed with the third sensor at yaw 0
BASIN_STARTS, BASIN_POSES = 25, 16  # starts along each side of a square, and random true positions for each start
BASIN_HALF_SIDE = 0.5  # pitches, half the side of the square of starts
CORRECTIONS, SCALE = 60, 0.5  # GLSDC steps from each start, and their largest scale
CONVERGENCE_ERROR = 1e-6  # m, largest final error of a start that counts as converged
OFFSET_LABELS = ("off along X, pitches", "off along Y, pitches")  # labels of the axes: offset of the start
TABLE_HALF_SIDES = (0.0625, 0.125, 0.25)  # pitches: half sides of the squares over which the table averages


def blocks(stage: Stage) -> dict[str, Content]:
    """Return the blocks of the section: accuracy of each layout, errors of the field model, regions of convergence."""
    layouts = layouts_by_name(stage)
    positions = {
        n: [(x / layout.pitch, y / layout.pitch) for x, y in layout.positions] for n, layout in layouts.items()
    }
    return {
        "accuracy.places": drawings.layouts(positions),
        "accuracy.maps": _maps(stage, layouts),
        "accuracy.coarse": CURVE_POINTS,
        "accuracy.required": REQUIRED / UM,
        "accuracy.over_yaw": _over_yaw(layouts),
        "accuracy.worst": _worst(stage),
        "accuracy.singular": [_singular(stage, yaw) for yaw in SINGULAR_YAWS],
        **_errors(stage),
        **_basins(stage),
    }


def layouts_by_name(stage: Stage) -> dict[str, PlanarArray]:
    """Return the compared layouts, by name."""
    searched = {f"searched, ±{yaw}°": stage.array(positions) for yaw, positions in LAYOUTS.items()}
    return {"two sensors": stage.pair, "third sensor added": stage.array(PUBLISHED)} | searched


def _pitch_extent(stage: Stage) -> list[tuple[float, float]]:
    """Return the ranges of X and Y of a map over a pitch, mm."""
    return [(0.0, 1e3 * stage.pitch)] * 2


def _maps(stage: Stage, layouts: Mapping[str, PlanarArray]) -> Figure:
    shown = []
    for yaw in (0.0, YAW):
        for name in list(layouts)[:3]:
            marks = 1e3 * singular_points.of_pair(stage.pair, yaw) if name == "two sensors" else None
            shown.append(Map(f"{name}, yaw {np.degrees(yaw):g}°", _larger_deviation(layouts[name], yaw) / UM, marks))
    return maps.maps(shown, _pitch_extent(stage), (2.0, 20.0), label="µm")


def _larger_deviation(array: PlanarArray, yaw: float) -> Array:
    """Return the larger of the deviations of X and Y (POINTS, POINTS) over the pitch at a yaw, m."""
    q = grid(array, POINTS)
    q[2] = yaw
    return np.asarray(fisher.deviations(array, q)[:2].max(axis=0).reshape(POINTS, POINTS))


def _over_yaw(layouts: Mapping[str, PlanarArray]) -> Figure:
    lines, yaws = [], np.linspace(-MAX_YAW, MAX_YAW, CURVE_YAWS)
    for name, layout in list(layouts.items())[1:]:
        q = np.tile(grid(layout, CURVE_POINTS), CURVE_YAWS)
        q[2] = np.repeat(yaws, CURVE_POINTS**2)
        largest = fisher.deviations(layout, q)[:2].max(axis=0).reshape(CURVE_YAWS, -1).max(axis=1)
        lines.append(Line(np.degrees(yaws), largest / UM, name, {"lw": 1.2}))
    lines.append(Line(np.degrees(yaws), np.full(CURVE_YAWS, REQUIRED / UM), style={**LEVEL, "ls": ":"}))
    return maps.draw([Chart(lines, "yaw, °", "largest of X and Y over the pitch, µm", log="y")], 3.0)


def _worst(stage: Stage) -> Rows:
    proofs = {("third sensor added", 0): rank.worst(stage.array(PUBLISHED), 0.0, 0.0)}
    proofs |= {(f"searched, ±{yaw}°", yaw): rank.worst_of_optimised_layout(stage, yaw) for yaw in (5, 15)}
    rows: list[tuple[str, ...]] = [("two sensors", "any", *("none",) * 6)]
    for (name, yaw), proved in proofs.items():
        values = (f"{v / UM:.4g}" for v in (*proved.attained, *proved.bound))
        rows.append((name, f"{-yaw or 0} .. {yaw}".replace("-", "−"), *values))
    return rows


def _singular(stage: Stage, yaw: float) -> tuple[float, ...]:
    """Return the yaw in degrees, the number of singular points, and the first point (X, Y) in mm or NaN."""
    points = singular_points.of_pair(stage.pair, radians(yaw))
    first = points[0] if len(points) else np.full(2, np.nan)
    return yaw, len(points), *(1e3 * first).tolist()


def _errors(stage: Stage) -> dict[str, Content]:
    by_layout = {
        "two sensors, yaw known": errors.errors(stage, True),
        "two sensors, yaw estimated": errors.errors(stage, False),
        "three sensors, searched, yaw estimated": errors.by_waves(stage, stage.array(LAYOUTS[5])),
    }
    error_mm = {n: 1e3 * np.hypot(*components).reshape(stage.truth.count, -1) for n, components in by_layout.items()}
    shown = [Map(name, values) for name, values in error_mm.items()]
    return {
        "errors.figure": maps.maps(shown, _pitch_extent(stage), (0.02, 2.0), label="mm"),
        "errors.table": [(n, errors.rms(v), *np.percentile(v, (99, 100)).tolist()) for n, v in error_mm.items()],
    }


def _basins(stage: Stage) -> dict[str, Content]:
    """Return the regions of convergence (basins of attraction) of GLSDC, without damping or prediction."""
    shares = {
        "two sensors, yaw known": basin(stage.pair, True),
        "two sensors, yaw estimated": basin(stage.pair, False),
        "three sensors, searched": basin(stage.array(LAYOUTS[5]), False),
    }
    distance = BASIN_HALF_SIDE * np.abs(np.linspace(-1, 1, BASIN_STARTS))
    squares = [np.maximum(distance[:, None], distance) <= half_side + 1e-9 for half_side in TABLE_HALF_SIDES]
    shown = [Map(n, 100 * share) for n, share in shares.items()]
    return {
        "basin.scale": SCALE,
        "basin.places": BASIN_POSES,
        "basin.figure": maps.maps(
            shown, [(-BASIN_HALF_SIDE, BASIN_HALF_SIDE)] * 2, (0.0, 100.0), log=False, label="%", labels=OFFSET_LABELS
        ),
        "basin.table": [(n, *(100 * float(v[inside].mean()) for inside in squares)) for n, v in shares.items()],
    }


def basin(array: PlanarArray, yaw_known: bool) -> Array:
    """Return the share of the true positions for which GLSDC converges, by the start's offset in X and Y.

    The offsets form a square of BASIN_STARTS by BASIN_STARTS.
    """
    offsets = array.pitch * np.linspace(-BASIN_HALF_SIDE, BASIN_HALF_SIDE, BASIN_STARTS)
    X, Y = np.meshgrid(offsets, offsets, indexing="ij")
    positions = array.pitch * np.random.default_rng(0).uniform(0, 1, (2, BASIN_POSES))
    q = np.zeros((3, BASIN_POSES, BASIN_STARTS, BASIN_STARTS))
    q[:2] = positions[:, :, None, None]
    start = q + np.array([X, Y, np.zeros_like(X)])[:, None]
    truth, starts = q.reshape(3, -1), start.reshape(3, -1)
    end = correction.iterate(array, correction.volts(array, truth), starts, SCALE, CORRECTIONS, yaw_known)
    return np.asarray(
        (np.hypot(*(end - truth)[:2]) < CONVERGENCE_ERROR).reshape(BASIN_POSES, BASIN_STARTS, BASIN_STARTS).mean(axis=0)
    )
