"""Field for the audit's formulas: ideal and fabricated harmonics, spacing (3), residual of model (2) in a scan.

Amplitudes A_n are those of sin(n w X) in B_X above the infinite matrix, in T; scans are above six pitches of blocks.
"""

from collections.abc import Mapping
from dataclasses import replace
from functools import lru_cache

import numpy as np

from models import concentrated_field, hall_array, hall_figures, hall_scan
from models.concentrated_field import STRONG
from models.hall_array import Array
from models.hall_stage import PER_PITCH, Stage
from synth.synthesise.identify.logs import Log

KEPT = 8  # cached results of each function
ODD = (1, 3, 5, 7, 9, 11, 13)
NONE = 1e-6  # T: smaller amplitudes count as none
PLACES = 480  # over a pitch


def harmonics(stage: Stage, z: float, ideal: bool = False) -> dict[int, float]:
    """Return A_n by n of ODD at z in m above the fabricated blocks, or above ideal ones."""
    return dict(zip(ODD, stage.amplitudes(ODD, z, ideal).tolist(), strict=True))


def has_every_nth(step: float, *above: Mapping[int, float]) -> bool:
    """Return whether at each height exactly the harmonics 1 + k step of the odd ones are present."""
    return all((abs(a) > NONE) == ((n - 1) % step == 0) for sizes in above for n, a in sizes.items())


def largest_two(sizes: Mapping[int, float]) -> list[int]:
    """Return the numbers of the two largest harmonics."""
    return sorted(sizes, key=lambda n: -abs(sizes[n]))[:2]


def halbach_gain() -> float:
    """Return the fundamental of a Halbach array over that of alternating blocks."""
    m, p = STRONG / 2, concentrated_field.values()
    arrays = concentrated_field.halbach_array(m), concentrated_field.array([0.0, 0.0], [m, -m])
    waves = (concentrated_field.waves(each, [(1, 0)], p)[0] for each in arrays)
    halbach, alternating = (float(concentrated_field.amplitude(wave, hall_array.HEIGHT)) for wave in waves)
    return halbach / alternating


def line_slopes(stage: Stage) -> Array:
    """Return the slopes of a sensor along X over a pitch, V/m."""
    waves = stage.waves([(n, 0) for n in ODD])
    return hall_figures.line(waves, 0.0, PLACES + 1, stage.height).slopes[0]


def better_slope(slopes: Array, spacing: float) -> float:
    """Return the least over a pitch of the larger slope of two sensors, a spacing in pitches apart."""
    size = np.abs(slopes[:-1])
    return float(np.maximum(size, np.roll(size, -round(spacing * PLACES))).min())


def relative_to_best_spacing(stage: Stage, spacing: float) -> float:
    """Return the least slope of a pair at a spacing in pitches, relative to that at the best spacing."""
    least = hall_figures.least_slopes(stage.waves([(n, 0) for n in ODD]), PLACES, stage.height).least
    return float(least[round(spacing * PLACES)] / least.max())


@lru_cache(KEPT)
def fit_above_blocks(stage: Stage) -> hall_scan.Fit:
    """Return the fit of model (2) to a scan over a pitch above six pitches of blocks."""
    of = stage.truth
    i, j = (v.ravel() for v in np.indices((of.count, of.count)))
    X, Y = (np.asarray(of.spacing * k, dtype=np.float64) for k in (i, j))
    log = Log({"X": X, "Y": Y, "V_ax": of.at(i, j)[0]})
    return hall_scan.fit(log, "V_ax", stage.pitch)


def fit_above_infinite_matrix(stage: Stage, points: int = PER_PITCH, highest: int = 9) -> hall_scan.Fit:
    """Return the fit of model (2) over a pitch of the infinite matrix, with orders up to `highest` on each axis."""
    noiseless = hall_array.point_sensors([(0.0, 0.0)], replace(stage.chain, noise=0.0))
    waves, at = (
        stage.waves(concentrated_field.orders_up_to(highest)),
        hall_scan.places(stage.pitch, points, (stage.height,)),
    )
    return hall_scan.fit(hall_scan.simulate_scan(noiseless, waves, at, 0), "V_ax", stage.pitch)
