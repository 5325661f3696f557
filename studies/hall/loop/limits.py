"""The ensemble behind the loop's limits of the protection levels: `python -m studies.hall.loop.limits`.

The unit and its calibration are those of `four_sensors`; bodies are anywhere in the travel, at yaws of the stage.

    calibrated  the limits of the calibration           wide  POSITION_LIMIT and YAW_LIMIT, whatever is excluded
    loop        the wide ones, and the calibrated ones while a sensor is excluded, as in the loop

An argument is the number of bodies of each case, 6,000 without it.
"""

import sys
from collections.abc import Iterator
from dataclasses import replace
from functools import cache

import numpy as np

from studies.hall.calibrated import estimator as calibrated
from studies.hall.calibrated import stages, survey
from studies.hall.calibrated.survey import Case
from studies.hall.loop import four_sensors
from studies.hall.protected import trust
from studies.hall.protected.trust import Samples
from synth.base import progress
from synth.block import Block
from synth.execute import host

BODIES, YAW, SEED = 6000, 0.02, 0  # and rad, of the stage
UNIT = Case(four_sensors.FIELD, four_sensors.SEED)
WORST = "drift"  # of the failures
QUANTILE = 0.999


def block(limits: str) -> Block:
    """Return the guarded estimator of the unit with limits by their name."""
    of = stages.of_unit(UNIT.field, UNIT.seed)
    tuned = calibrated.tuning(of)
    if limits == "calibrated":
        return calibrated.block(of, tuned)
    loop = four_sensors.loop_tuning(of)
    return calibrated.block(of, loop if limits == "loop" else replace(loop, excluded_limits=1.0))


@cache
def controller(limits: str) -> host.Controller:
    """Return the compiled estimator, in single precision."""
    return host.compile_block(block(limits), np.float32, libm=True)


def samples(limits: str, fault: str, bodies: int, speed: float = 0.0) -> Samples:
    """Return the samples after a failure; raise ModelError for an unknown one."""
    rng = np.random.default_rng(SEED)
    tuned = calibrated.tuning(stages.of_unit(UNIT.field, UNIT.seed))
    world = survey.world(UNIT, bodies, rng)
    return trust.simulate(controller(limits), tuned, world, fault, bodies, speed, rng, YAW)


def lines(bodies: int) -> Iterator[str]:
    """Yield the levels over the places, and how often an estimate is valid, and valid and wrong."""
    none = samples("loop", "none", bodies)
    for axis, name, size, unit in ((0, "X", 1e3, "mm"), (1, "Y", 1e3, "mm"), (2, "yaw", 1e3, "mrad")):
        level = size * none.levels[..., axis]
        high = np.quantile(level, QUANTILE)
        yield f"level of {name}, {unit}: {QUANTILE:.1%} quantile {high:.3g}, most {level.max():.3g}"
    yield f"limits, motion: valid without a failure, %; valid and wrong after '{WORST}', % of samples"
    for limits in ("calibrated", "wide", "loop"):
        for speed in (0.0, trust.SPEED):
            valid = samples(limits, "none", bodies, speed).outcome().valid
            wrong = samples(limits, WORST, bodies, speed).outcome().wrong
            yield f"{limits:10s} {speed:4.1f} m/s {100 * valid:7.2f} {100 * wrong:7.3f}"


if __name__ == "__main__":
    progress.write(lines(int(sys.argv[1]) if len(sys.argv) > 1 else BODIES))
