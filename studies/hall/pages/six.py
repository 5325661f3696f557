"""Redundant sensors and six degrees of freedom in the report; the paper leaves both as future work."""

from collections.abc import Mapping

import numpy as np

from designs.hall_position.paper import errors, layouts
from designs.hall_position.paper.layouts import LAYOUTS
from models import hall_array, hall_two_waves
from models.hall_stage import PUBLISHED, Stage
from models.hall_two_waves import SpatialArray
from studies.hall import layout_accuracy
from studies.hall.pages import drawings
from studies.hall.protected import spatial
from synth import show
from synth.analyse.observability.information import Accuracy
from synth.report import figures, maps, page
from synth.report.maps import Map
from synth.report.prose import Content

POINTS = 48  # of maps, along a pitch
MIN_SENSORS = 4  # sensors
LEVEL = layout_accuracy.CONDITIONS[layout_accuracy.LEVEL]
COLUMNS = ("", "X, µm", "Y, µm", "Z, µm", "roll, µrad", "pitch, µrad", "yaw, µrad")


def blocks(stage: Stage) -> dict[str, Content]:
    """Return the layouts, the determinants of three sensors, and the tuning."""
    three = {"third sensor added": PUBLISHED} | {f"searched, ±{turn}°": LAYOUTS[turn] for turn in LAYOUTS}
    return {
        "six.places": drawings.layouts({f"{n} sensors": places for n, places in layouts.SPATIAL.items()}),
        "six.determinants": [_signs(stage, name, places) for name, places in three.items()],
        "six.tuning": [(name, float(value)) for name, value in vars(spatial.Tuning()).items()],
    }


def section(stage: Stage) -> page.Section:
    """Return the accuracy in six degrees of freedom by layout, with all sensors and after the loss of one."""
    parts = tuple(_layout(optimised_layout(stage, n), n) for n in layouts.SPATIAL)
    return page.Section("Six degrees of freedom", (), parts)


def optimised_layout(stage: Stage, sensors: int) -> SpatialArray:
    """Return the optimised layout of some sensors, in the field of model (2)."""
    pair, any_place = stage.pair, tuple((x, 0.0, 0.0) for x in (0.0, 1.0, 2.0))
    array = SpatialArray(any_place, pair.alpha, pair.beta, stage.height, stage.pitch, pair.deviation)
    return hall_two_waves.with_positions(array, layouts.SPATIAL[sensors])


def _signs(stage: Stage, name: str, places: layouts.Places) -> tuple[str | float, ...]:
    least, largest = layout_accuracy.signs(hall_two_waves.with_positions(optimised_layout(stage, MIN_SENSORS), places))
    return name, least, largest, "on lines" if least < 0 < largest else "not seen"


def _layout(array: SpatialArray, sensors: int) -> page.Section:
    deviations = 1e6 * layout_accuracy.spatial(array, layout_accuracy.cell(array, LEVEL, POINTS)).deviations
    X, Y, Z, roll, pitch, yaw = np.moveaxis(deviations.reshape(POINTS, POINTS, 6), -1, 0)
    pairs = {
        "places": ([Map("X or Y, µm", np.maximum(X, Y)), Map("Z, µm", Z)], (1.0, 10.0), "µm"),
        "turns": ([Map("roll or pitch, µrad", np.maximum(roll, pitch)), Map("yaw, µrad", yaw)], (50.0, 500.0), "µrad"),
    }
    sides, caption = (
        [(0.0, 1e3 * array.pitch)] * 2,
        f"Standard deviations for 1 mV, level at {1e3 * array.height:g} mm.",
    )
    drawings = [
        page.Figure(figures.svg(maps.maps(shown, sides, scale, 2, label=unit), f"six-{sensors}-{name}"), caption)
        for name, (shown, scale, unit) in pairs.items()
    ]
    tables = [_table(layout_accuracy.conditions(array, POINTS), "under conditions")]
    if sensors > MIN_SENSORS:
        tables.append(_table(layout_accuracy.losses(array, POINTS), "after the loss of a sensor, level"))
    return page.Section(f"{sensors} sensors", (*drawings, *tables, _misfit(array)))


def _table(accuracies: Mapping[str, Accuracy], what: str) -> show.Table:
    rows = tuple(
        (name.replace("-", "−").replace(" deg", "°"), *(1e6 * each.deviations.max(axis=0)), each.condition.max())
        for name, each in accuracies.items()
    )
    return show.Table(f"Largest standard deviations over the pitch {what}", (*COLUMNS, "condition"), rows)


def _misfit(array: SpatialArray) -> show.Table:
    """Return the errors due to waves outside the model, to first order."""
    sensors = hall_array.point_sensors([(x, y) for x, y, _ in array.positions])
    off = 1e6 * layout_accuracy.misfit(
        array, sensors, Stage().waves(errors.WAVES), layout_accuracy.cell(array, LEVEL, POINTS)
    )
    rows = ("rms", *np.sqrt(np.mean(off**2, axis=0)).tolist()), ("largest", *np.abs(off).max(axis=0).tolist())
    return show.Table("Errors by what model (2) does not know of the field, to first order, level", COLUMNS, rows)
