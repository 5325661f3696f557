"""Audit of resolution and accuracy: deviations by the noise, and errors by what the model does not know of the field.

Deviations are Cramer-Rao bounds by model (2), with alpha and beta above the infinite matrix unless a figure says
otherwise, for white noise of the chain's deviation in each voltage.
"""

from dataclasses import replace
from math import radians

import numpy as np

from designs.hall_position.paper import errors
from designs.hall_position.paper.stage import (
    FIELD,
    MM,
    NOISE,
    POINTS,
    TOLERANCE,
    UM,
    Array,
    Stage,
    grid,
    known_yaw,
    worst,
)
from models import hall_fisher
from synth.report.audit import Outcome, Published, recomputes

WEAKER = 0.1  # V/T, the other sensitivity that fits such a sensor
YAWS = {"yaw known": True, "yaw free": False}
CALIBRATED = 2  # places of the scan from one of the table to the next
MOST = 0.99  # part of the poses that counts as all but the singular points


@recomputes("K-5", *NOISE)
def resolution(stage: Stage, printed: Published) -> Outcome:
    """Recompute the deviations of two sensors over the pitch, the yaw known and the yaw estimated."""
    known, free = known_yaw(stage.pair), hall_fisher.deviations(stage.pair, grid(stage.pair, POINTS))
    worse, limit = free[:2].max(axis=0), printed["resolution"].value * UM
    weaker = replace(stage, chain=replace(stage.chain, sensitivity=WEAKER))
    figures = [
        ("X or Y per mV at the steepest place, one sensor", stage.chain.noise / _steepest(stage) / UM, "um"),
        ("yaw known, least", known.min() / UM, "um"),
        ("yaw known, largest", known.max() / UM, "um"),
        ("yaw free, median", float(np.median(worse)) / UM, "um"),
        ("yaw free, part of the pitch above the print", 100 * float(np.mean(worse > limit)), "%"),
        ("at 0.1 V/T, one sensor at the steepest place", stage.chain.noise / _steepest(weaker) / UM, "um"),
    ]
    return Outcome(figures, float(known.max()) < limit)


@recomputes("K-6", *FIELD)
def accuracy(stage: Stage, printed: Published) -> Outcome:
    """Recompute the errors of GLSDC above blocks, of whose field it knows model (2)."""
    free, known = (np.hypot(*errors.errors(stage, yaw_known)) for yaw_known in (False, True))
    limit = printed["accuracy"].value * MM
    figures = [
        ("yaw free, rms", float(np.sqrt(np.mean(free**2))) / MM, "mm"),
        ("yaw free, 99 % of the places", float(np.percentile(free, 99)) / MM, "mm"),
        ("yaw free, largest", float(free.max()) / MM, "mm"),
        ("yaw known, rms", float(np.sqrt(np.mean(known**2))) / MM, "mm"),
        ("yaw known, largest", float(known.max()) / MM, "mm"),
    ]
    largest = float(free.max())
    agree = np.percentile(free, 99) < limit and limit / 2 < largest < 2 * limit and known.max() < limit
    return Outcome(figures, bool(agree))


@recomputes("K-9", *FIELD)
def moved(stage: Stage, printed: Published) -> Outcome:
    """Recompute how far a body moves whose estimate moves by the printed step, with and without calibration."""
    step, off = printed["step"].value * MM, {n: _along(stage, known) for n, known in YAWS.items()}
    off["yaw known, calibrated"] = errors.calibrated(off["yaw known"], CALIBRATED)
    spacing = stage.truth.spacing
    found = {name: errors.motions(each, spacing, step) / MM for name, each in off.items()}
    figures = [(f"true motion, {n}, least", float(v.min()), "mm") for n, v in found.items()]
    figures += [(f"true motion, {n}, largest", float(v.max()), "mm") for n, v in found.items()]
    told = printed["uncalibrated"]
    between = (found[n].min() < told.value < found[n].max() + told.last_digit for n in YAWS)
    exact = np.abs(found["yaw known, calibrated"] - step / MM).max() < told.last_digit
    return Outcome(figures, all(between) and bool(exact))


def _along(stage: Stage, yaw_known: bool) -> Array:
    """Return the errors of X (n, n) in m over a pitch."""
    return errors.errors(stage, yaw_known)[0].reshape(stage.truth.count, -1)


@recomputes("K-11", *NOISE)
def yaw(stage: Stage, printed: Published) -> Outcome:
    """Recompute the deviation of the yaw over the pitch."""
    free = hall_fisher.deviations(stage.pair, grid(stage.pair, POINTS))[2]
    limit = radians(printed["resolution"].value)
    three = worst(stage.three, 0.0, 0.0, TOLERANCE).met[2]
    figures = [
        ("two sensors, median", np.degrees(float(np.median(free))), "degree"),
        ("two sensors, part of the pitch above the print", 100 * float(np.mean(free > limit)), "%"),
        ("three sensors, largest", np.degrees(float(three)), "degree"),
    ]
    return Outcome(figures, bool(np.mean(free > limit) < 1 - MOST and three < limit))


def _steepest(stage: Stage) -> float:
    """Return the slope of the fundamental's steepest place, V/m."""
    return stage.pair.alpha * stage.pair.wave_number
