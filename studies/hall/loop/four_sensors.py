"""Position source of four sensors with protection levels: `hall_position_four` as it ships, or with a calibration.

The stage is a unit of `calibrated.unit`, whose matrix and sensors have tolerances that the shipped estimator does not
know; the field's amplitude is lower by that of `protected.trust`. A calibration (`calibrated.stages`) knows the unit.

A loop needs an estimate at every place that it crosses. Within the yaws of the stage the protection levels of the
calibrated unit are at most 0.61 mm and 25 mrad, which POSITION_LIMIT and YAW_LIMIT allow. While a sensor is
excluded the limits are those of the calibration, about 0.5 mm and 21 mrad: docs/decisions/hall_position_loop.md.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache

from designs.hall_position.protected import config, estimator
from designs.hall_position.protected.parameters import Tuning
from studies.hall.calibrated import estimator as calibrated
from studies.hall.calibrated import stages
from studies.hall.calibrated import unit as units
from studies.hall.calibrated.stages import UnitCalibration
from studies.hall.calibrated.unit import Unit
from studies.hall.loop import stage_loop
from studies.hall.loop.stage_loop import Loop
from studies.hall.protected import trust
from synth.block import Block
from synth.timing import Discrete

FIELD, SEED = "built", 13  # a unit on which nothing of the calibrated estimator was chosen
GAIN_RATIO = 1 - trust.AMPLITUDE
AXES = ("X", "Y", "yaw")
POSITION_LIMIT, YAW_LIMIT = 6.5e-4, 0.027  # m, rad, of the protection levels while no sensor is excluded
SHOWN = ("excluded", *(f"{prefix}_{axis}" for prefix in ("deviation", "protection") for axis in AXES))


@dataclass(frozen=True, eq=False)
class FourSensors:
    """The estimate of four sensors, as shipped or calibrated."""

    calibration: UnitCalibration | None = None
    sensors: int = len(config.PLACES[config.NAME])
    suffix: str = ""
    held: bool = True
    shown: tuple[str, ...] = SHOWN

    def blocks(self, time: Discrete) -> list[Block]:
        """Return screening, corrections of a calibration, the estimator, its position in m, and the limits."""
        lost = {"lost": "lock_lost"}
        if self.calibration is None:
            return [block.renamed(lost) for block in estimator.blocks(config.array(), time, config.USUAL)]
        return [block.renamed(lost) for block in calibrated.blocks(self.calibration, loop_tuning(self.calibration))]


def loop_tuning(of: UnitCalibration) -> Tuning:
    """Return the tuning of a calibration with the limits of the loop, and its own while a sensor is excluded."""
    tuned = calibrated.tuning(of)
    share = tuned.position_limit / POSITION_LIMIT
    return replace(tuned, position_limit=POSITION_LIMIT, yaw_limit=YAW_LIMIT, excluded_limits=share)


@cache
def unit() -> Unit:
    """Return the unit whose loop is closed."""
    return units.draw(FIELD, SEED)


@cache
def loops() -> Mapping[str, Loop]:
    """Return the loops with the shipped estimator, which knows nothing of the unit, and with the unit's calibration.

    C that ships has polynomials; that of a unit calls sinf and cosf of the C library, whose emission is faster.
    """
    by_name = {"plain": FourSensors(), "calibrated": FourSensors(stages.of_unit(FIELD, SEED))}
    return {n: stage_loop.of_source(s, unit().bench, GAIN_RATIO, n != "plain") for n, s in by_name.items()}
