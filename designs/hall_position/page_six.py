"""The report's part on redundant sensors and six degrees of freedom, which the paper leaves as future work."""

from dataclasses import replace

import numpy as np

from designs.hall_position import drawings
from designs.hall_position.accuracy import layouts, maps
from designs.hall_position.accuracy.layouts import LAYOUTS, PUBLISHED
from designs.hall_position.drawings import Map
from designs.hall_position.glsdc.six_parameters import Array, Tuning
from designs.hall_position.paper import errors
from designs.hall_position.paper.stage import Stage
from models import hall_array
from synth.report import figures, page

POINTS = 48  # of maps, along a pitch
ENOUGH = 4  # sensors
LAW = (
    ("Fig. 6(b)", "B = -∇Φ,  Φ = Σ_{n = 1, 5} (a_n / (n ω)) e^{-n ω (Z - h)} (cos(n ω X) + cos(n ω Y))"),
    ("", "d(e·B) = p·dP + (e × B + o × p)·w,  p = ∇B e,  o = R r,  w: small turn"),
    ("", "three sensors: det H(X, Y) takes both signs, so that it vanishes on lines between"),
)


def section(stage: Stage) -> page.Section:
    """Return the accuracy in six degrees of freedom, with all sensors and after the loss of one."""
    text = page.Text(
        "With the decay by the gap in the model the same algorithm tells Z by the strength of the field and the tilts "
        "by how it differs from sensor to sensor. Three sensors have six voltages for six unknowns, and lose rank on "
        "lines in every layout that was looked at; four of two axes tell the pose everywhere in the pitch, five after "
        "the loss of any one. Layouts are searched for yaws of ±5°; deviations are those of 1 mV."
    )
    arrays = {n: placed(stage, n) for n in layouts.SPATIAL}
    sections = tuple(_layout(of, n) for n, of in arrays.items())
    shown = {f"{n} sensors": places for n, places in layouts.SPATIAL.items()}
    places = page.Figure(figures.svg(drawings.layouts(shown), "six-layouts"), "Places in the body, pitches.")
    blocks = (text, page.Equations(LAW), places, _signs(stage), _tuning())
    return page.Section("Six degrees of freedom", blocks, sections)


def placed(stage: Stage, sensors: int) -> Array:
    """Return a layout that was searched, in the field of model (2)."""
    places = tuple((x * stage.pitch, y * stage.pitch, 0.0) for x, y in layouts.SPATIAL[sensors])
    of = stage.pair
    return Array(places, of.alpha, of.beta, stage.height, stage.pitch, of.deviation)


def _tuning() -> page.Table:
    usual = Tuning()
    rows = tuple((name, float(getattr(usual, name))) for name in vars(usual))
    return page.Table("Tuning in six degrees of freedom", ("name", "value"), rows)


def _signs(stage: Stage) -> page.Table:
    rows: list[tuple[page.Cell, ...]] = []
    for name, places in {
        "third sensor added": PUBLISHED,
        "searched, ±5°": LAYOUTS[5],
        "searched, ±15°": LAYOUTS[15],
    }.items():
        found = layouts.signs(layouts.placed(placed(stage, min(layouts.SPATIAL)), places))
        rows.append((name, found.least, found.largest, "on lines" if found.least < 0 < found.largest else "not seen"))
    columns = ("three sensors", "least det H", "largest det H", "rank is lost")
    return page.Table("Determinants over the pitch of three sensors, over their mean size", columns, tuple(rows))


def _layout(of: Array, sensors: int) -> page.Section:
    level = maps.CONDITIONS["level at the height"]
    found = 1e6 * maps.spatial(of, maps.cell(of, level, POINTS)).deviations.reshape(POINTS, POINTS, 6)
    X, Y, Z, roll, pitch, yaw = np.moveaxis(found, -1, 0)
    shown = [Map("X or Y, µm", np.maximum(X, Y)), Map("Z, µm", Z)]
    turns = [Map("roll or pitch, µrad", np.maximum(roll, pitch)), Map("yaw, µrad", yaw)]
    drawn = tuple(
        page.Figure(
            figures.svg(drawings.maps(each, of.pitch, low, high, columns=2, label=unit), f"six-{sensors}-{name}"),
            f"Standard deviations for 1 mV, level at {1e3 * of.height:g} mm.",
        )
        for name, each, low, high, unit in (("places", shown, 1.0, 10.0, "µm"), ("turns", turns, 50.0, 500.0, "µrad"))
    )
    tables = [_table(maps.conditions(of, POINTS), "under conditions")]
    if sensors > ENOUGH:
        tables.append(_table(maps.losses(of, points=POINTS), "after the loss of a sensor, level"))
    return page.Section(f"{sensors} sensors", (*drawn, *tables, _misfit(of)))


def _table(found: maps.Map, what: str) -> page.Table:
    rows = []
    for name, worst, condition in zip(found.names, found.worst, found.condition, strict=True):
        rows.append((name.replace("-", "−").replace(" deg", "°"), *(1e6 * worst).tolist(), float(condition)))
    columns = ("", "X, µm", "Y, µm", "Z, µm", "roll, µrad", "pitch, µrad", "yaw, µrad", "condition")
    return page.Table(f"Largest standard deviations over the pitch {what}", columns, tuple(rows))


def _misfit(of: Array) -> page.Table:
    """Return the errors by waves that the model has not, to first order."""
    sensors = replace(hall_array.sensors([(x, y) for x, y, _ in of.positions]), volume=(0.0, 0.0, 0.0))
    at = maps.cell(of, maps.CONDITIONS["level at the height"], POINTS)
    found = 1e6 * maps.misfit(of, sensors, Stage().waves(errors.WAVES), at)
    sizes = {"rms": np.sqrt(np.mean(found**2, axis=0)), "largest": np.abs(found).max(axis=0)}
    rows = tuple((name, *values.tolist()) for name, values in sizes.items())
    columns = ("", "X, µm", "Y, µm", "Z, µm", "roll, µrad", "pitch, µrad", "yaw, µrad")
    return page.Table("Errors by what model (2) does not know of the field, to first order, level", columns, rows)
