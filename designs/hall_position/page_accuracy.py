"""The report's parts on what the voltages tell: accuracy over pitch and yaw, lost rank, layouts compared, errors."""

from collections.abc import Mapping
from math import radians

import numpy as np

from designs.hall_position import drawings
from designs.hall_position.accuracy import fisher, singular_points
from designs.hall_position.accuracy.layouts import LAYOUTS, PUBLISHED
from designs.hall_position.drawings import Map
from designs.hall_position.glsdc import parameters
from designs.hall_position.paper import errors, rank
from designs.hall_position.paper.stage import TOLERANCE, UM, Array, Stage, grid, worst
from synth.report import figures, page

POINTS = 96  # of a map, along a pitch
COARSE, TURNS = 48, 121  # of the curve over yaw: places along a pitch, yaws
YAW = radians(5)  # of the second maps
WIDEST = radians(30)  # of that curve, to either side
SINGULAR = (0.0, 1.0, 2.0, 5.0, 10.0)  # degrees
REQUIRED = 5.3e-6  # m, of the third sensor at yaw 0

DEVIATIONS = (
    ("", "cov(X, Y, θ) ≥ s^2 (H' H)^{-1},  H = ∂(voltages) / ∂(X, Y, θ),  s = 1 mV"),
    ("", "X:  [g, 0, h],  g = B'(p),  h = B(q) - g o_Y;   Y:  [0, k, m],  k = B'(q),  m = k o_X - B(p)"),
    ("", "N_θ = Σ_{axes} [Σ_{pairs} (g_i h_j - g_j h_i)^2] / Σ g^2,  var θ = s^2 / N_θ"),
    ("", "var X = (s / ω)^2 (1 / Σ g^2 + (Σ g h / Σ g^2)^2 / N_θ)"),
)


def named(stage: Stage) -> dict[str, parameters.Array]:
    """Return the layouts that are compared, by name."""
    found = {f"searched, ±{turn}°": stage.array(places) for turn, places in LAYOUTS.items()}
    return {"two sensors": stage.pair, "third sensor added": stage.array(PUBLISHED)} | found


def accuracy(stage: Stage) -> page.Section:
    """Return how accurate each layout is over the pitch and the yaw."""
    text = page.Text(
        "Cramér-Rao deviations for 1 mV of noise. p and q are the phases of a sensor along X and Y, o its place from "
        "the body's origin times ω, turned by the yaw. Two sensors lose rank at isolated points, circles in the map: "
        "all of them are found, and each is proved to be one. Near them no estimator tells X, Y and yaw from the "
        "voltages; the one that ships leans on the last motion there and says so. With a third sensor the worst place "
        "has a bound, which is proved for every place and yaw, not only on a grid. A search over the places of three "
        "sensors finds layouts that are better than the one added to (3), over a whole range of yaws: that one all "
        "but loses rank at 9.4°."
    )
    layouts = named(stage)
    blocks: tuple[page.Block, ...] = (text, page.Equations(DEVIATIONS), _places(layouts), _maps(stage, layouts))
    return page.Section("Accuracy over pitch and yaw", (*blocks, _turned(layouts), _worst(stage), _singular(stage)))


def _places(layouts: Mapping[str, parameters.Array]) -> page.Figure:
    shown = {n: [(x / of.pitch, y / of.pitch) for x, y in of.positions] for n, of in layouts.items()}
    caption = "Sensors in the body, in pitches, beside the square of one pitch about the body's origin."
    return page.Figure(figures.svg(drawings.layouts(shown), "layouts"), caption)


def _maps(stage: Stage, layouts: Mapping[str, parameters.Array]) -> page.Figure:
    shown = []
    for yaw in (0.0, YAW):
        for name in list(layouts)[:3]:
            marks = singular_points.of_pair(stage.pair, yaw).at if name == "two sensors" else None
            shown.append(Map(f"{name}, yaw {np.degrees(yaw):g}°", _larger(layouts[name], yaw) / UM, marks))
    drawn = drawings.maps(shown, stage.pitch, 2.0, 20.0, label="µm")
    caption = "Standard deviation of X or Y, whichever is larger, for 1 mV. Circles: singular points."
    return page.Figure(figures.svg(drawn, "accuracy"), caption)


def _larger(of: parameters.Array, yaw: float) -> Array:
    """Return the larger of the deviations of X and Y (POINTS, POINTS) over the pitch at a yaw, m."""
    q = grid(of, POINTS)
    q[2] = yaw
    found: Array = fisher.deviations(of, q)[:2].max(axis=0).reshape(POINTS, POINTS)
    return found


def _turned(layouts: Mapping[str, parameters.Array]) -> page.Figure:
    curves = {}
    for name, of in list(layouts.items())[1:]:
        yaws = np.linspace(-WIDEST, WIDEST, TURNS)
        q = np.tile(grid(of, COARSE), TURNS)
        q[2] = np.repeat(yaws, COARSE**2)
        curves[name] = (yaws, fisher.deviations(of, q)[:2].max(axis=0).reshape(TURNS, -1).max(axis=1))
    caption = (
        f"Largest deviation over the pitch by the yaw, on {COARSE} × {COARSE} places, which show less than the worst. "
        f"Dotted: the {REQUIRED / UM:g} µm that are required of the third sensor at yaw 0."
    )
    return page.Figure(figures.svg(drawings.over_yaw(curves, REQUIRED), "over-yaw"), caption)


def _worst(stage: Stage) -> page.Table:
    cases = [("third sensor added", PUBLISHED, 0), *((f"searched, ±{t}°", LAYOUTS[t], t) for t in (5, 15))]
    rows: list[tuple[page.Cell, ...]] = [("two sensors", "any", *("none",) * 3, *("none",) * 3)]
    for name, places, turn in cases:
        of = stage.array(places)
        found = worst(of, -radians(turn), radians(turn), rank.TOLERANCES.get(turn, TOLERANCE))
        values = (f"{v / UM:.4g}" for v in (*found.met, *found.bound))
        rows.append((name, f"{-turn or 0} .. {turn}".replace("-", "−"), *values))
    columns = ("layout", "yaw, °", "X, µm", "Y, µm", "yaw, µrad", "X at most", "Y at most", "yaw at most")
    return page.Table("Largest deviations that were found, and bounds that are proved", columns, tuple(rows))


def _singular(stage: Stage) -> page.Table:
    rows: list[tuple[page.Cell, ...]] = []
    for turn in SINGULAR:
        found = singular_points.of_pair(stage.pair, radians(turn))
        first = found.at[0] if len(found.at) else np.full(2, np.nan)
        rows.append((turn, len(found.at), 1e3 * float(first[0]), 1e3 * float(first[1])))
    columns = ("yaw, °", "singular points in the pitch", "first: X, mm", "Y, mm")
    return page.Table("Where two sensors lose rank", columns, tuple(rows))


def model_error(stage: Stage) -> page.Section:
    """Return by how much GLSDC errs above blocks of which it knows model (2) only."""
    n = stage.truth.count
    known, free = (1e3 * np.hypot(*errors.errors(stage, yaw)).reshape(n, n) for yaw in (True, False))
    three = 1e3 * np.hypot(*errors.by_waves(stage, stage.array(LAYOUTS[5]))).reshape(n, n)
    shown = [
        Map("two sensors, yaw known", known),
        Map("two sensors, yaw estimated", free),
        Map("three sensors, searched, yaw estimated", three),
    ]
    text = page.Text(
        "What (2) does not know of the field errs the estimate: nothing here is noise, and it is the same at each "
        "visit, so that a table takes it away (see the calibration). Three sensors with the yaw estimated err as "
        "little as two whose yaw is known. Magnets are as printed; those of the experiments scatter besides."
    )
    table = page.Table(
        "Errors in mm by model (2), yaw 0",
        ("sensors", "rms", "99 % of the places", "largest"),
        tuple(
            (m.title, float(np.sqrt(np.mean(m.values**2))), float(np.percentile(m.values, 99)), float(m.values.max()))
            for m in shown
        ),
        digits=3,
    )
    drawn = drawings.maps(shown, stage.pitch, 0.02, 2.0, label="mm")
    figure = page.Figure(figures.svg(drawn, "model-error"), "Distance of the estimate from the true place, mm.")
    return page.Section("Errors by the model", (text, figure, table))
