"""What is measured of a stage before its loop is closed: the field's model, and the map of the estimate's errors.

Both are measured of the truth field, at no yaw and so slowly that the filters do not lag: scans of the voltages over a
pitch give (2) by batch least squares, the mean over all channels; the laser gives where the platen was when the
estimator said where.

The noise of the array is the model's misfit: by it estimates settle, and their deviations are what they err by.
"""

from dataclasses import replace
from functools import cache

import numpy as np

from designs.hall_position.glsdc import estimator
from designs.hall_position.loop import closed_loop, error_map
from designs.hall_position.loop.closed_loop import PITCH, Source
from designs.hall_position.loop.error_map import Samples
from models import hall_bench
from models.hall_array import Pair
from models.hall_bench import Bench
from models.hall_two_waves import PlanarArray as Array
from synth.block import unranged
from synth.blocks import lookup_table
from synth.emit.c import digits
from synth.execute import build, host
from synth.statespace import Array as Numbers
from synth.statespace import readonly
from synth.timing import Discrete

TIME = Discrete(1 / 800)
DIGITS = 5  # of the field
MAPPED, CELL = 0.027, 1e-3  # m: to where, and by what spacing, the error is tabulated
BEYOND, LINE = 2.2e-3, 1e-3  # m: how far the samples go on, and how far their lines are apart
ASIDE, WAVER = 2e-4, 7.3e-3  # m: by how much lines waver, and over which way
STEP, READ = 5e-5, 8  # m between samples, of which so many are taken together


@cache
def calibrated(places: tuple[Pair, ...] = closed_loop.PLACES) -> Source:
    """Return the source of a stage, with its field measured and its errors mapped; raise ModelError as `Bench`."""
    bench = Bench(places)
    plain = Source(array(bench))
    return replace(plain, map=error_map.fit(samples(bench, plain), lookup_table.square(MAPPED, CELL)))


def array(bench: Bench) -> Array:
    """Return the array that the estimator is made for, of its channels' models."""
    scans = hall_bench.fits(bench, PITCH, TIME)
    c, alpha, beta = (
        digits.cut(float(np.mean([f.estimate[name] for f in scans])), DIGITS) for name in ("c", "alpha", "beta")
    )
    misfit = float(np.sqrt(np.mean([np.mean(f.residual**2) for f in scans])))
    return Array(bench.places, c, alpha, beta, PITCH, digits.cut(misfit, 2))


def samples(bench: Bench, source: Source, reach: float = MAPPED + BEYOND, line: float = LINE, seed: int = 2) -> Samples:
    """Return estimates beside the laser's places, means over READ samples on the way along lines `line` m apart.

    The platen comes from the origin, so that pitches are counted from there. Lines waver, as no loop follows them.

    Raises ModelError as `hall_bench.settled`.
    """
    way = _way(reach, line)
    poses = np.column_stack([way, np.zeros(len(way))])
    found = compiled(source).replay(hall_bench.read(bench, poses, TIME, seed)).outputs
    columns = np.stack([np.asarray(found[n], np.float64) for n in error_map.COORDINATES], axis=1)
    valid = np.asarray(found["valid"]).reshape(-1, READ).all(axis=1)
    estimated, true = (each.reshape(-1, READ, 3).mean(axis=1) for each in (columns, poses))
    return Samples(readonly(estimated[valid]), readonly(true[valid]))


def _way(reach: float, line: float) -> Numbers:
    """Return places (N, 2) in m, STEP apart: from the origin to a corner, then line by line to and fro."""
    across = np.arange(-reach, reach + line / 2, line)
    ends = np.array([(side * (-1) ** k * reach, y) for k, y in enumerate(across) for side in (-1, 1)])
    corners = np.vstack([np.zeros(2), ends])
    lengths = np.concatenate([[0], np.cumsum(np.abs(np.diff(corners, axis=0)).sum(axis=1))])
    at = np.arange(round(lengths[-1] / STEP) // READ * READ) * STEP
    X, Y = (np.interp(at, lengths, corners[:, k]) for k in (0, 1))
    return np.column_stack([X, Y + ASIDE * np.sin(2 * np.pi * at / WAVER)])


def compiled(source: Source) -> host.Controller:
    """Return the estimator of a source behind its guard, in single precision, with functions of libm."""
    return build.compiled(unranged(estimator.guarded(source.array, TIME, source.tuning)), np.float32, libm=True)
