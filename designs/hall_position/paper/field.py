"""Audit of the field: ideal and fabricated harmonics, the root of two, spacing (3), what model (2) leaves of a scan.

Amplitudes A_n are those of sin(n w X) in B_X above the infinite matrix, in T; scans are above six pitches of blocks.
"""

from dataclasses import replace
from functools import lru_cache
from math import sqrt

import numpy as np

from designs.hall_position.paper.stage import FIELD, KEPT, MV, PER_PITCH, Array, Stage
from models import concentrated_field, hall_array, hall_figures, hall_scan
from synth.report.audit import Outcome, Published, recomputes
from synth.synthesise.identify.logs import Log

ODD = (1, 3, 5, 7, 9, 11, 13)
NONE, DIGITS = 1e-6, 12  # T: no wave; what is shown, so that rounding is not
SPACINGS = 3  # n = 1 .. of (3)
SENSITIVE = 0.5  # of the greatest slope: a sensor is in its sensitive region
PLACES = 480  # over a pitch


@recomputes("K-1", *FIELD)
def weak_blocks(stage: Stage, printed: Published) -> Outcome:
    """Recompute the remanence of an ideal array's weak blocks."""
    ideal = stage.strong / sqrt(2)
    figures = [("ideal weak remanence", ideal, "T"), ("fabricated over ideal", stage.weak / ideal, "1")]
    return Outcome(figures, printed["weak"].agrees(ideal))


@recomputes("K-2", "strong")
def ideal_harmonics(stage: Stage, printed: Published) -> Outcome:
    """Recompute which odd harmonics an ideal matrix has."""
    figures: list[tuple[str, float, str]] = []
    made: list[float] = []
    missing: list[float] = []
    for z in (0.0, stage.height):
        for n, size in zip(ODD, np.abs(stage.amplitudes(ODD, z, ideal=True)).tolist(), strict=True):
            figures.append((f"|A_{n}| at {_mm(z)}", round(size, DIGITS), "T"))
            (made if (n - 1) % printed["between"].value == 0 else missing).append(size)
    agree = min(made) > NONE and max(missing) < NONE
    return Outcome(figures, agree)


@recomputes("K-3", *FIELD)
def fabricated_harmonics(stage: Stage, printed: Published) -> Outcome:
    """Recompute which harmonics are the largest above the blocks that were made."""
    figures, agree = [], True
    wanted = [int(printed[name].value) for name in ("first", "second")]
    for z in (0.0, stage.height):
        sizes = dict(zip(ODD, stage.amplitudes(ODD, z).tolist(), strict=True))
        figures += [(f"A_{n} at {_mm(z)}", sizes[n], "T") for n in ODD[:5]]
        figures += [(f"wave (2, 1) at {_mm(z)}", stage.cross(z), "T")]
        agree &= sorted(ODD, key=lambda n: -abs(sizes[n]))[:2] == wanted
    return Outcome(figures, agree)


@recomputes("K-4", *FIELD, "sensitivity")
def fit_error(stage: Stage, printed: Published) -> Outcome:
    """Fit model (2) to a scan of a pitch above blocks and recompute what it leaves."""
    found = fitted(stage)
    left = float(np.abs(found.residual).max())
    figures = [
        ("greatest residual", left / MV, "mV"),
        ("residual, rms", float(np.sqrt(np.mean(found.residual**2))) / MV, "mV"),
        *((name, value / stage.chain.gain, "T") for name, value in found.estimate.by_name.items()),
        ("greatest residual, infinite matrix", float(np.abs(above_infinite(stage).residual).max()) / MV, "mV"),
    ]
    limit = printed["error"].value * MV
    return Outcome(figures, limit / 2 < left < limit)


@recomputes("K-8")
def halbach_gain(stage: Stage, printed: Published) -> Outcome:
    """Recompute the fundamental of a Halbach array over that of blocks that alternate."""
    m, p = stage.strong / 2, concentrated_field.values()
    arrays = concentrated_field.halbach_array(m), concentrated_field.array([0.0, 0.0], [m, -m])
    waves = (concentrated_field.waves(each, [(1, 0)], p)[0] for each in arrays)
    halbach, alternating = (float(concentrated_field.amplitude(wave, stage.height)) for wave in waves)
    ratio = halbach / alternating
    figures = [("fundamental over that of alternating blocks", ratio, "1")]
    return Outcome(figures, abs(ratio - sqrt(printed["factor"].value)) < 1e-09)


@recomputes("K-12", *FIELD)
def spacing(stage: Stage, printed: Published) -> Outcome:
    """Recompute how insensitive a pair of sensors gets at the spacings (3) and at others."""
    waves = stage.waves([(n, 0) for n in ODD])
    found = hall_figures.insensitive(waves, PLACES, stage.height)
    single = hall_figures.line(waves, 0.0, PLACES + 1, stage.height).slopes[0]
    greatest = float(np.abs(single).max())
    at = [round((printed["offset"].value + printed["every"].value * n) * PLACES) for n in range(1, SPACINGS + 1)]
    least = {f"{k / PLACES:g} pitch": better(single, k) / greatest for k in (*at, PLACES // 2)}
    figures = [(f"slope of the better sensor, least, {name} apart", v, "1") for name, v in least.items()]
    figures += [("pair at (3) over the best spacing", float(found.least[at[0]] / found.least.max()), "1")]
    agree = min(list(least.values())[:SPACINGS]) > SENSITIVE
    return Outcome(figures, agree)


def better(slopes: Array, shift: int) -> float:
    """Return the least over a pitch of the better of two slopes, which are `shift` places apart."""
    one = np.abs(slopes[:-1])
    return float(np.maximum(one, np.roll(one, -shift)).min())


@lru_cache(KEPT)
def fitted(stage: Stage) -> hall_scan.Fit:
    """Return model (2) of a scan over a pitch above six pitches of blocks."""
    of = stage.truth
    i, j = (v.ravel() for v in np.indices((of.count, of.count)))
    X, Y = (np.asarray(of.spacing * k, dtype=np.float64) for k in (i, j))
    log = Log({"X": X, "Y": Y, "V_ax": of.at(i, j)[0]})
    return hall_scan.fit(log, "V_ax", stage.pitch)


def above_infinite(stage: Stage, points: int = PER_PITCH, highest: int = 9) -> hall_scan.Fit:
    """Return model (2) of a scan over a pitch of the infinite matrix, harmonics up to the `highest` of either axis."""
    one = hall_array.sensors([(0.0, 0.0)])
    silent = replace(one, chain=replace(stage.chain, noise=0.0), volume=(0.0, 0.0, 0.0))
    waves, at = stage.waves(concentrated_field.up_to(highest)), hall_scan.places(stage.pitch, points, (stage.height,))
    return hall_scan.fit(hall_scan.scanned(silent, waves, at, 0), "V_ax", stage.pitch)


def _mm(z: float) -> str:
    return f"{1e3 * z:g} mm"
