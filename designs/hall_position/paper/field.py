"""Magnetic field for the audit's formulas: harmonics, the slopes of a pair of sensors, and fits of the field model (2).

A_n is the amplitude of sin(n w X) in B_X above the infinite matrix, in T, with w = 2 pi / pitch. Model (2)
is that of Kawato and Kim with two waves along each axis, n = 1 and 5; the spacing of two sensors is their (3).
"""

from collections.abc import Mapping
from dataclasses import replace
from functools import lru_cache

import numpy as np

from designs.hall_position.paper import field_figures, scan_fit
from models import concentrated_field, hall_array
from models.concentrated_field import STRONG
from models.hall_array import Array
from models.hall_stage import PER_PITCH, Stage
from synth.synthesise.identify.logs import Log

CACHED_RESULTS = 8  # most cached results of each function
ODD = (1, 3, 5, 7, 9, 11, 13)
NEGLIGIBLE_AMPLITUDE = 1e-6  # T: a harmonic with a smaller amplitude counts as absent
PLACES = 480  # positions over a pitch


def harmonics(stage: Stage, z: float, ideal: bool = False) -> dict[int, float]:
    """Return {n: A_n} for n in ODD, at z in m above the fabricated blocks, or above ideal ones."""
    return dict(zip(ODD, stage.amplitudes(ODD, z, ideal).tolist(), strict=True))


def has_every_nth(step: float, *at_heights: Mapping[int, float]) -> bool:
    """Return whether exactly the harmonics n = 1 + k step, k = 0, 1, .., of ODD are present at each height."""
    return all(
        (abs(a) > NEGLIGIBLE_AMPLITUDE) == ((n - 1) % step == 0)
        for amplitudes in at_heights
        for n, a in amplitudes.items()
    )


def largest_two(sizes: Mapping[int, float]) -> list[int]:
    """Return the numbers of the two largest harmonics."""
    return sorted(sizes, key=lambda n: -abs(sizes[n]))[:2]


def halbach_gain() -> float:
    """Return the ratio of the fundamentals of a Halbach array and of alternating blocks, at the sensors' height."""
    m, p = STRONG / 2, concentrated_field.values()
    arrays = concentrated_field.halbach_array(m), concentrated_field.array([0.0, 0.0], [m, -m])
    waves = (concentrated_field.waves(each, [(1, 0)], p)[0] for each in arrays)
    halbach, alternating = (float(concentrated_field.amplitude(wave, hall_array.HEIGHT)) for wave in waves)
    return halbach / alternating


def line_slopes(stage: Stage) -> Array:
    """Return the slope dV/dX of a sensor at PLACES + 1 positions over a pitch, V/m."""
    waves = stage.waves([(n, 0) for n in ODD])
    return field_figures.line(waves, 0.0, PLACES + 1, stage.height).slopes[0]


def least_slope_of_pair(slopes: Array, spacing: float) -> float:
    """Return min over X of max(|slope of sensor 1|, |slope of sensor 2|), for sensors at a spacing in pitches."""
    magnitude = np.abs(slopes[:-1])
    return float(np.maximum(magnitude, np.roll(magnitude, -round(spacing * PLACES))).min())


def relative_to_best_spacing(slopes: Array, spacing: float) -> float:
    """Return `least_slope_of_pair` at a spacing in pitches, relative to that at the best spacing within a pitch."""
    best = max(least_slope_of_pair(slopes, k / PLACES) for k in range(PLACES))
    return least_slope_of_pair(slopes, spacing) / best


@lru_cache(CACHED_RESULTS)
def fit_above_blocks(stage: Stage) -> scan_fit.Fit:
    """Return the fit of model (2) to a scan over a pitch above six pitches of blocks."""
    truth = stage.truth
    i, j = (v.ravel() for v in np.indices((truth.count, truth.count)))
    X, Y = (np.asarray(truth.spacing * k, dtype=np.float64) for k in (i, j))
    log = Log({"X": X, "Y": Y, "V_ax": truth.at(i, j)[0]})
    return scan_fit.fit(log, "V_ax", stage.pitch)


def fit_above_infinite_matrix(stage: Stage, points: int = PER_PITCH, highest: int = 9) -> scan_fit.Fit:
    """Return the fit of model (2) over a pitch of the infinite matrix, with orders up to `highest` on each axis."""
    noiseless = hall_array.point_sensors([(0.0, 0.0)], replace(stage.chain, noise=0.0))
    waves = stage.waves(concentrated_field.orders_up_to(highest))
    positions = scan_fit.places(stage.pitch, points, (stage.height,))
    return scan_fit.fit(scan_fit.simulate_scan(noiseless, waves, positions, 0), "V_ax", stage.pitch)
