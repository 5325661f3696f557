"""What is measured of a stage before its loop is closed: the field's model, and the map of the estimate's errors.

Both are measured of the truth field, at no yaw and so slowly that the filters do not lag: scans of the voltages over a
pitch give (2) by batch least squares, the mean over all channels; the laser gives where the platen was when the
estimator said where. The map holds at the yaw at which it was made: one of X and Y alone would leave the yaw to be
wrong by as much as before, and with it the places of the sensors. So the yaw is mapped, too (Figs. 10 and 11).

The noise of the array is the model's misfit: by it estimates settle, and their deviations are what they err by.
"""

from dataclasses import replace
from functools import cache

import numpy as np

from designs.hall_position.config import TIME
from designs.hall_position.glsdc import estimator
from designs.hall_position.loop import closed_loop
from designs.hall_position.loop.closed_loop import PITCH, Source
from models import hall_bench
from models.hall_array import Pair
from models.hall_bench import Bench
from models.hall_two_waves import PlanarArray as Array
from synth.block import unranged
from synth.blocks import error_map, lookup_table
from synth.emit.c import digits
from synth.execute import build
from synth.statespace import Array as Numbers
from synth.statespace import readonly

DIGITS = 5  # of the field
MAPPED, CELL = 0.027, 1e-3  # m: to where, and by what spacing, the error is tabulated
UNITS = (1e-8, 1e-8, 1e-6)  # m, m, rad: a hundredth of the noise
MARGIN, LINE = 2.2e-3, 1e-3  # m: how far the samples go on, and how far their lines are apart
TOGETHER = 8  # samples that are taken together


@cache
def calibrated_source(places: tuple[Pair, ...] = closed_loop.PLACES) -> Source:
    """Return the source of a stage, with its field measured and its errors mapped; raise ModelError as `Bench`."""
    bench = Bench(places)
    plain = Source(array(bench))
    return replace(plain, map=error_map.fit(*samples(bench, plain), lookup_table.square(MAPPED, CELL), UNITS))


def array(bench: Bench) -> Array:
    """Return the array that the estimator is made for, of its channels' models."""
    scans = hall_bench.fits(bench, PITCH, TIME)
    c, alpha, beta = (
        digits.cut(float(np.mean([f.estimate[name] for f in scans])), DIGITS) for name in ("c", "alpha", "beta")
    )
    misfit = float(np.sqrt(np.mean([np.mean(f.residual**2) for f in scans])))
    return Array(bench.places, c, alpha, beta, PITCH, digits.cut(misfit, 2))


def samples(
    bench: Bench, source: Source, reach: float = MAPPED + MARGIN, line: float = LINE, seed: int = 2
) -> tuple[Numbers, Numbers]:
    """Return estimates (N, 3) beside the laser's places, means over READ samples on the way along lines `line` m apart.

    Pitches are counted from the origin, where the platen comes from. Raises ModelError as `hall_bench.settled`.
    """
    poses = hall_bench.scan(reach, line, TOGETHER)
    block = unranged(estimator.guarded_estimator(source.array, TIME, closed_loop.TUNING))
    controller = build.compiled(block, np.float32, libm=True)
    read = controller.replay(hall_bench.sampled_voltages(bench, poses, TIME, seed)).outputs
    columns = np.stack([np.asarray(read[n], np.float64) for n in ("X", "Y", "yaw")], axis=1)
    valid = np.asarray(read["valid"]).reshape(-1, TOGETHER).all(axis=1)
    estimated, true = (readonly(each.reshape(-1, TOGETHER, 3).mean(axis=1)[valid]) for each in (columns, poses))
    return estimated, true
