"""Audit of the field: ideal and fabricated harmonics, the root of two, spacing (3), what model (2) leaves of a scan.

Amplitudes A_n are those of sin(n w X) in B_X above the infinite matrix, in T; scans are above six pitches of blocks.
"""

from dataclasses import replace
from functools import lru_cache
from math import sqrt

import numpy as np

from designs.hall_position import scan
from designs.hall_position.audit_stage import FIELD, KEPT, MV, PER_PITCH, Array, Stage
from models import concentrated_field, hall_array, hall_figures
from synth.report.audit import Published, Row, judge, row
from synth.synthesise.identify.logs import Log

ODD = (1, 3, 5, 7, 9, 11, 13)
NONE, DIGITS = 1e-6, 12  # T: no wave; what is shown, so that rounding is not
SPACINGS = 3  # n = 1 .. of (3)
SENSITIVE = 0.5  # of the greatest slope: a sensor is in its sensitive region
PLACES = 480  # over a pitch


def weak_blocks(stage: Stage, printed: Published) -> Row:
    """K-1: recompute the remanence of an ideal array's weak blocks."""
    ideal = stage.strong / sqrt(2)
    figures = [("ideal weak remanence", ideal, "T"), ("fabricated over ideal", stage.weak / ideal, "1")]
    why = "Rule: within one unit of the last printed digit. A weak block is a sum of two parts of half a strong one's."
    return row(printed, figures, judge(printed["weak"].agrees(ideal)), why, FIELD)


def ideal_harmonics(stage: Stage, printed: Published) -> Row:
    """K-2: recompute which odd harmonics an ideal matrix has."""
    figures: list[tuple[str, float, str]] = []
    made: list[float] = []
    missing: list[float] = []
    for z in (0.0, stage.height):
        for n, size in zip(ODD, np.abs(stage.amplitudes(ODD, z, ideal=True)).tolist(), strict=True):
            figures.append((f"|A_{n}| at {_mm(z)}", round(size, DIGITS), "T"))
            (made if (n - 1) % printed["between"].value == 0 else missing).append(size)
    why = (
        "Rule: odd harmonics 1, 5, 9, 13 above 1e-6 T at 0 and 3 mm, 3, 7, 11 below. Blocks in steps of a quarter turn "
        "make n = 1 + 4 k only, whatever their remanence."
    )
    agree = min(made) > NONE and max(missing) < NONE
    return row(printed, figures, judge(agree), why, ("strong",))


def fabricated_harmonics(stage: Stage, printed: Published) -> Row:
    """K-3: recompute which harmonics are the largest above the blocks that were made."""
    figures, agree = [], True
    wanted = [int(printed[name].value) for name in ("first", "second")]
    for z in (0.0, stage.height):
        sizes = dict(zip(ODD, stage.amplitudes(ODD, z).tolist(), strict=True))
        figures += [(f"A_{n} at {_mm(z)}", sizes[n], "T") for n in ODD[:5]]
        figures += [(f"wave (2, 1) at {_mm(z)}", stage.cross(z), "T")]
        agree &= sorted(ODD, key=lambda n: -abs(sizes[n]))[:2] == wanted
    why = (
        "Rule: of n = 1, 3 .. 13 these two are the largest at 0 and 3 mm, in this order. beta is negative where alpha "
        "is positive. At 3 mm the wave (2, 1), which depends on X and Y and which (2) lacks, is larger than the 9th."
    )
    return row(printed, figures, judge(agree), why, FIELD)


def fit_error(stage: Stage, printed: Published) -> Row:
    """K-4: fit model (2) to a scan of a pitch above blocks and recompute what it leaves."""
    found = fitted(stage)
    left = float(np.abs(found.residual).max())
    figures = [
        ("greatest residual", left / MV, "mV"),
        ("residual, rms", float(np.sqrt(np.mean(found.residual**2))) / MV, "mV"),
        *((name, value / stage.chain.gain, "T") for name, value in found.estimate.by_name.items()),
        ("greatest residual, infinite matrix", float(np.abs(above_infinite(stage).residual).max()) / MV, "mV"),
    ]
    why = (
        f"Rule: below the printed bound, by less than a factor of two. Scan of {PER_PITCH} x {PER_PITCH} places, no "
        "noise, in the pitch ahead of the middle of six, 3 mm above the blocks, no magnet wrong; other pitches and "
        f"other grids have 117 to 130 mV. The gain is {stage.chain.gain:g} V/T: the sensitivity is not printed, and "
        "0.4 V/T times 21 makes 1 mV 2.6 um. Most of the residual are waves that (2) has not, (2, +-1) first."
    )
    limit = printed["error"].value * MV
    return row(printed, figures, judge(limit / 2 < left < limit), why, (*FIELD, "sensitivity"))


def halbach_gain(stage: Stage, printed: Published) -> Row:
    """K-8: recompute the fundamental of a Halbach array over that of blocks that alternate."""
    m, p = stage.strong / 2, concentrated_field.values()
    arrays = concentrated_field.halbach_array(m), concentrated_field.array([0.0, 0.0], [m, -m])
    waves = (concentrated_field.waves(each, [(1, 0)], p)[0] for each in arrays)
    halbach, alternating = (float(concentrated_field.amplitude(wave, stage.height)) for wave in waves)
    ratio = halbach / alternating
    figures = [("fundamental over that of alternating blocks", ratio, "1")]
    why = (
        "Rule: the square root of the printed number to 1e-9, for one array with four blocks to the pitch against two "
        "that are magnetised up and down, of equal remanence and height, at any distance. Against four blocks, up, "
        "none, down, none, it would be 2."
    )
    return row(printed, figures, judge(abs(ratio - sqrt(printed["factor"].value)) < 1e-9), why)


def spacing(stage: Stage, printed: Published) -> Row:
    """K-12: recompute how insensitive a pair of sensors gets at the spacings (3) and at others."""
    waves = stage.waves([(n, 0) for n in ODD])
    found = hall_figures.insensitive(waves, PLACES, stage.height)
    single = hall_figures.line(waves, 0.0, PLACES + 1, stage.height).slopes[0]
    greatest = float(np.abs(single).max())
    at = [round((printed["offset"].value + printed["every"].value * n) * PLACES) for n in range(1, SPACINGS + 1)]
    least = {f"{k / PLACES:g} pitch": better(single, k) / greatest for k in (*at, PLACES // 2)}
    figures = [(f"slope of the better sensor, least, {name} apart", v, "1") for name, v in least.items()]
    figures += [("pair at (3) over the best spacing", float(found.least[at[0]] / found.least.max()), "1")]
    why = (
        "Rule: somewhere in the pitch the better of two sensors has its least slope, relative to the greatest one in "
        "the pitch; at (3), n = 1, 2, 3, it is above a half. Half a pitch apart both have none at once. The field's "
        "harmonics move the best spacing by less than 1 % of what the pair tells; n = 0 is as good, which is not said."
    )
    agree = min(list(least.values())[:SPACINGS]) > SENSITIVE
    return row(printed, figures, judge(agree), why, FIELD)


def better(slopes: Array, shift: int) -> float:
    """Return the least over a pitch of the better of two slopes, which are `shift` places apart."""
    one = np.abs(slopes[:-1])
    return float(np.maximum(one, np.roll(one, -shift)).min())


@lru_cache(KEPT)
def fitted(stage: Stage) -> scan.Fit:
    """Return model (2) of a scan over a pitch above six pitches of blocks."""
    of = stage.truth
    i, j = (v.ravel() for v in np.indices((of.count, of.count)))
    X, Y = (np.asarray(of.spacing * k, dtype=np.float64) for k in (i, j))
    log = Log({"X": X, "Y": Y, "V_ax": of.at(i, j)[0]})
    return scan.fit(log, "V_ax", stage.pitch)


def above_infinite(stage: Stage, points: int = PER_PITCH, highest: int = 9) -> scan.Fit:
    """Return model (2) of a scan over a pitch of the infinite matrix, harmonics up to the `highest` of either axis."""
    one = hall_array.sensors([(0.0, 0.0)])
    silent = replace(one, chain=replace(stage.chain, noise=0.0), volume=(0.0, 0.0, 0.0))
    waves, at = stage.waves(concentrated_field.up_to(highest)), scan.places(stage.pitch, points, (stage.height,))
    return scan.fit(scan.scanned(silent, waves, at, 0), "V_ax", stage.pitch)


def _mm(z: float) -> str:
    return f"{1e3 * z:g} mm"
