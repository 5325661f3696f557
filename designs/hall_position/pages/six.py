"""Redundant sensors and six degrees of freedom in the report, which the paper leaves as future work."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from designs.hall_position.accuracy import layouts, maps
from designs.hall_position.accuracy.layouts import LAYOUTS, PUBLISHED
from designs.hall_position.glsdc.six_parameters import Array, Tuning
from designs.hall_position.pages import drawings
from designs.hall_position.paper import errors
from designs.hall_position.paper.stage import Stage
from models import hall_array
from synth.analyse.observability.information import Accuracy
from synth.report import maps as pictures
from synth.report import page
from synth.report.maps import Map, figure
from synth.report.prose import Value

POINTS = 48  # of maps, along a pitch
ENOUGH = 4  # sensors
LEVEL = maps.CONDITIONS[maps.LEVEL]
COLUMNS = ("", "X, µm", "Y, µm", "Z, µm", "roll, µrad", "pitch, µrad", "yaw, µrad")


def blocks(stage: Stage) -> dict[str, Value]:
    """Return the layouts, why three sensors do not do, and the tuning."""
    shown = {f"{n} sensors": places for n, places in layouts.SPATIAL.items()}
    tuning = tuple((name, float(value)) for name, value in vars(Tuning()).items())
    return {
        "six.places": figure("six-layouts", drawings.layouts(shown), "Places in the body, pitches."),
        "six.determinants": _signs(stage),
        "six.tuning": page.Table("Tuning in six degrees of freedom", ("name", "value"), tuning),
    }


def section(stage: Stage) -> page.Section:
    """Return the accuracy in six degrees of freedom by layout, with all sensors and after the loss of one."""
    parts = tuple(_layout(placed(stage, n), n) for n in layouts.SPATIAL)
    return page.Section("Six degrees of freedom", (), parts)


def placed(stage: Stage, sensors: int) -> Array:
    """Return a layout that was searched, in the field of model (2)."""
    of, any_place = stage.pair, tuple((x, 0.0, 0.0) for x in (0.0, 1.0, 2.0))
    array = Array(any_place, of.alpha, of.beta, stage.height, stage.pitch, of.deviation)
    return layouts.placed(array, layouts.SPATIAL[sensors])


def _signs(stage: Stage) -> page.Table:
    rows: list[tuple[page.Cell, ...]] = []
    searched = {f"searched, ±{turn}°": places for turn, places in LAYOUTS.items()}
    for name, places in ({"third sensor added": PUBLISHED} | searched).items():
        least, largest = layouts.signs(layouts.placed(placed(stage, ENOUGH), places))
        rows.append((name, least, largest, "on lines" if least < 0 < largest else "not seen"))
    columns = ("three sensors", "least det H", "largest det H", "rank is lost")
    return page.Table("Determinants over the pitch of three sensors, over their mean size", columns, tuple(rows))


def _layout(of: Array, sensors: int) -> page.Section:
    deviations = 1e6 * maps.spatial(of, maps.cell(of, LEVEL, POINTS)).deviations.reshape(POINTS, POINTS, 6)
    X, Y, Z, roll, pitch, yaw = np.moveaxis(deviations, -1, 0)
    shown = [Map("X or Y, µm", np.maximum(X, Y)), Map("Z, µm", Z)]
    turns = [Map("roll or pitch, µrad", np.maximum(roll, pitch)), Map("yaw, µrad", yaw)]
    drawn = [
        figure(
            f"six-{sensors}-{name}",
            pictures.maps(each, of.pitch, low, high, columns=2, label=unit),
            f"Standard deviations for 1 mV, level at {1e3 * of.height:g} mm.",
        )
        for name, each, low, high, unit in (("places", shown, 1.0, 10.0, "µm"), ("turns", turns, 50.0, 500.0, "µrad"))
    ]
    tables = [_table(maps.conditions(of, POINTS), "under conditions")]
    if sensors > ENOUGH:
        tables.append(_table(maps.losses(of, points=POINTS), "after the loss of a sensor, level"))
    return page.Section(f"{sensors} sensors", (*drawn, *tables, _misfit(of)))


def _table(of: Mapping[str, Accuracy], what: str) -> page.Table:
    rows = tuple(
        (name.replace("-", "−").replace(" deg", "°"), *(1e6 * each.deviations.max(axis=0)), each.condition.max())
        for name, each in of.items()
    )
    return page.Table(f"Largest standard deviations over the pitch {what}", (*COLUMNS, "condition"), rows)


def _misfit(of: Array) -> page.Table:
    """Return the errors by waves that the model has not, to first order."""
    sensors = replace(hall_array.sensors([(x, y) for x, y, _ in of.positions]), volume=(0.0, 0.0, 0.0))
    off = 1e6 * maps.misfit(of, sensors, Stage().waves(errors.WAVES), maps.cell(of, LEVEL, POINTS))
    sizes = {"rms": np.sqrt(np.mean(off**2, axis=0)), "largest": np.abs(off).max(axis=0)}
    rows = tuple((name, *values.tolist()) for name, values in sizes.items())
    caption = "Errors by what model (2) does not know of the field, to first order, level"
    return page.Table(caption, COLUMNS, rows)
