"""Calibration of a stage before its loop is closed: identification of the field's model, and the map of errors.

Both are measured in the true field, at yaw 0 and so slowly that the filters' lag is negligible. Scans of the voltages
over a pitch give model (2) by batch least squares, averaged over all channels. The laser gives the true position for
each estimate. A map of X and Y alone would leave the error of the yaw, and with it that of the sensors' positions: so
the yaw is mapped, too (Figs. 10 and 11). The map is valid at the yaw of its calibration.

The noise of the array is set to the model's misfit, which makes the estimator's deviations match its actual errors.
"""

from dataclasses import replace
from functools import cache

import numpy as np

from designs.hall_position.config import TIME
from designs.hall_position.glsdc import estimator
from models.hall_array import Pair
from models.hall_two_waves import PlanarArray as Array
from studies.hall import hall_bench
from studies.hall.hall_bench import Bench
from studies.hall.loop import closed_loop
from studies.hall.loop.closed_loop import PITCH, Source
from synth.base.cache import cached
from synth.block import unranged
from synth.blocks.laws import error_map, lookup_table
from synth.execute import host
from synth.statespace import Array as Numbers
from synth.statespace import readonly
from synth.synthesise import digits

DIGITS = 5  # of the field
TABLE_HALF_SIDE, TABLE_SPACING = 0.027, 1e-3  # m
UNITS = (1e-8, 1e-8, 1e-6)  # m, m, rad: resolution of the table, a hundredth of the noise
SAMPLE_MARGIN, LINE_SPACING = 2.2e-3, 1e-3  # m: range of the samples beyond the table, and distance of their lines
AVERAGED_SAMPLES = 8


@cache
@cached
def calibrated_source(places: tuple[Pair, ...] = closed_loop.PLACES) -> Source:
    """Return the position source of a stage, with identified field and mapped errors; raise ModelError as `Bench`."""
    bench = Bench(places)
    plain = Source(array(bench))
    return replace(
        plain, map=error_map.fit(*samples(bench, plain), lookup_table.square(TABLE_HALF_SIDE, TABLE_SPACING), UNITS)
    )


def array(bench: Bench) -> Array:
    """Return the array for the estimator: mean model of the channels, with the misfit as noise."""
    scans = hall_bench.fits(bench, PITCH, TIME)
    c, alpha, beta = (
        digits.significant(float(np.mean([f.estimate[name] for f in scans])), DIGITS) for name in ("c", "alpha", "beta")
    )
    misfit = float(np.sqrt(np.mean([np.mean(f.residual**2) for f in scans])))
    return Array(bench.places, c, alpha, beta, PITCH, digits.significant(misfit, 2))


def samples(
    bench: Bench,
    source: Source,
    reach: float = TABLE_HALF_SIDE + SAMPLE_MARGIN,
    line: float = LINE_SPACING,
    seed: int = 2,
) -> tuple[Numbers, Numbers]:
    """Return estimates (N, 3) and laser positions, means over AVERAGED_SAMPLES samples along lines `line` m apart.

    Pitches are counted from the origin, where the platen starts. Raises ModelError as `hall_bench.static_voltages`.
    """
    poses = hall_bench.scan(reach, line, AVERAGED_SAMPLES)
    block = unranged(estimator.guarded_estimator(source.array, TIME, closed_loop.TUNING))
    controller = host.compile_block(block, np.float32, libm=True)
    outputs = controller.replay(hall_bench.sampled_voltages(bench, poses, TIME, seed)).outputs
    columns = np.stack([np.asarray(outputs[n], np.float64) for n in ("X", "Y", "yaw")], axis=1)
    valid = np.asarray(outputs["valid"]).reshape(-1, AVERAGED_SAMPLES).all(axis=1)
    estimated, true = (readonly(each.reshape(-1, AVERAGED_SAMPLES, 3).mean(axis=1)[valid]) for each in (columns, poses))
    return estimated, true
