"""Audit of resolution and accuracy: deviations by the noise, and errors by what the model does not know of the field.

Deviations are Cramer-Rao bounds by model (2), with alpha and beta above the infinite matrix unless a figure says
otherwise, for white noise of the chain's deviation in each voltage.
"""

from dataclasses import replace
from math import radians

import numpy as np

from designs.hall_position import audit_errors, fisher
from designs.hall_position.audit_stage import (
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
from synth.report.audit import Published, Row, judge, row

WEAKER = 0.1  # V/T, the other sensitivity that fits such a sensor
YAWS = {"yaw known": True, "yaw free": False}
CALIBRATED = 2  # places of the scan from one of the table to the next
MOST = 0.99  # part of the poses that counts as all but the singular points


def resolution(stage: Stage, printed: Published) -> Row:
    """K-5: recompute the deviations of two sensors over the pitch, the yaw known and the yaw estimated."""
    known, free = known_yaw(stage.pair), fisher.deviations(stage.pair, grid(stage.pair, POINTS))
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
    why = (
        "Rule: with the yaw known, as by the lasers of section IV, X and Y are below the print everywhere in the "
        "pitch. With the yaw estimated at yaw 0 the larger of X and Y is above it near the singular points (K-13), "
        "where it has no bound. The largest with the yaw known is 3.595 um, at 1/4096 pitch; a coarser grid has 3.579. "
        "A sensitivity of 0.1 V/T instead of 0.4 would fail."
    )
    return row(printed, figures, judge(float(known.max()) < limit), why, NOISE)


def accuracy(stage: Stage, printed: Published) -> Row:
    """K-6: recompute the errors of GLSDC above blocks, of whose field it knows model (2)."""
    free, known = (np.hypot(*audit_errors.errors(stage, yaw_known)) for yaw_known in (False, True))
    limit = printed["accuracy"].value * MM
    figures = [
        ("yaw free, rms", float(np.sqrt(np.mean(free**2))) / MM, "mm"),
        ("yaw free, 99 % of the places", float(np.percentile(free, 99)) / MM, "mm"),
        ("yaw free, largest", float(free.max()) / MM, "mm"),
        ("yaw known, rms", float(np.sqrt(np.mean(known**2))) / MM, "mm"),
        ("yaw known, largest", float(known.max()) / MM, "mm"),
    ]
    why = (
        "Rule, of an order of magnitude: with the yaw estimated 99 % of the places of a pitch are off by less than the "
        "print, and the worst by it within a factor of two; with the yaw known all are off by less. Blocks as printed, "
        "neither scattered nor misplaced, six pitches, the model fitted as in K-4, every 1/40 pitch at yaw 0, from the "
        "true place, no noise. The worst places are near the singular points, (1/8, 3/8) pitch among them, and other "
        "parts of the matrix and other places have up to 2 mm there. The magnets' errors are not known."
    )
    largest = float(free.max())
    agree = np.percentile(free, 99) < limit and limit / 2 < largest < 2 * limit and known.max() < limit
    return row(printed, figures, judge(bool(agree)), why, FIELD)


def moved(stage: Stage, printed: Published) -> Row:
    """K-9: recompute how far a body moves whose estimate moves by the printed step, with and without calibration."""
    step, off = printed["step"].value * MM, {n: _along(stage, known) for n, known in YAWS.items()}
    off["yaw known, calibrated"] = audit_errors.calibrated(off["yaw known"], CALIBRATED)
    spacing = stage.truth.spacing
    found = {name: audit_errors.motions(each, spacing, step) / MM for name, each in off.items()}
    figures = [(f"true motion, {n}, least", float(v.min()), "mm") for n, v in found.items()]
    figures += [(f"true motion, {n}, largest", float(v.max()), "mm") for n, v in found.items()]
    why = (
        "Rule: the printed motion without calibration lies between the least and the largest, to one unit of its last "
        "digit, over all places of the pitch from which the estimate of X may go by the printed step, and with it all "
        "of them are the step to the same digit. Errors as in K-6. From where it went is not printed, nor whether "
        f"GLSDC estimated the yaw that the lasers closed. The table has errors every {CALIBRATED * spacing / MM:g} mm; "
        "the experiments show one in the loop."
    )
    told = printed["uncalibrated"]
    between = (found[n].min() < told.value < found[n].max() + told.last_digit for n in YAWS)
    exact = np.abs(found["yaw known, calibrated"] - step / MM).max() < told.last_digit
    return row(printed, figures, judge(all(between) and bool(exact)), why, FIELD)


def _along(stage: Stage, yaw_known: bool) -> Array:
    """Return the errors of X (n, n) in m over a pitch."""
    return audit_errors.errors(stage, yaw_known)[0].reshape(stage.truth.count, -1)


def yaw(stage: Stage, printed: Published) -> Row:
    """K-11: recompute the deviation of the yaw over the pitch."""
    free = fisher.deviations(stage.pair, grid(stage.pair, POINTS))[2]
    limit = radians(printed["resolution"].value)
    three = worst(stage.three, 0.0, 0.0, TOLERANCE).met[2]
    figures = [
        ("two sensors, median", np.degrees(float(np.median(free))), "degree"),
        ("two sensors, part of the pitch above the print", 100 * float(np.mean(free > limit)), "%"),
        ("three sensors, largest", np.degrees(float(three)), "degree"),
    ]
    why = (
        "Rule: below the print in more than 99 % of the pitch at yaw 0 with two sensors, and everywhere with the third "
        "one of K-14. At the singular points of two sensors (K-13) it has no bound. By noise alone: the model's error "
        "is K-6's."
    )
    return row(printed, figures, judge(bool(np.mean(free > limit) < 1 - MOST and three < limit)), why, NOISE)


def _steepest(stage: Stage) -> float:
    """Return the slope of the fundamental's steepest place, V/m."""
    return stage.pair.alpha * stage.pair.wave_number
