"""Position source of four sensors with protection levels: `hall_position_four` as it ships, or with a calibration.

The stage is a unit of `calibrated.unit`, whose matrix and sensors have tolerances that the shipped estimator does not
know; the field's amplitude is lower by that of `four.trust`. A calibration (`calibrated.stages`) knows the unit.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache

from designs.hall_position.calibrated import estimator as calibrated
from designs.hall_position.calibrated import stages
from designs.hall_position.calibrated import unit as units
from designs.hall_position.calibrated.stages import UnitCalibration
from designs.hall_position.calibrated.unit import Unit
from designs.hall_position.four import config, estimator, trust
from designs.hall_position.loop import stage_loop
from designs.hall_position.loop.stage_loop import Loop
from synth.block import Block
from synth.timing import Discrete

FIELD, SEED = "built", 13
GAIN_RATIO = 1 - trust.AMPLITUDE
AXES = ("X", "Y", "yaw")


@dataclass(frozen=True, eq=False)
class FourSensors:
    """The estimate of four sensors, as shipped or calibrated."""

    calibration: UnitCalibration | None = None
    sensors: int = len(config.PLACES)
    suffix: str = ""
    held: bool = True
    shown: tuple[str, ...] = ("excluded", *(f"{prefix}_{axis}" for prefix in ("deviation", "protection") for axis in AXES))

    def blocks(self, time: Discrete) -> list[Block]:
        """Return screening, corrections of a calibration, the estimator, and its position in m."""
        of = self.calibration
        located = calibrated.blocks(of, calibrated.tuning(of)) if of else estimator.blocks(config.array(), time, config.USUAL)
        return [block.renamed({"lost": "lock_lost"}) for block in located]


@cache
def unit() -> Unit:
    """Return the unit whose loop is closed."""
    return units.draw(FIELD, SEED)


@cache
def loops() -> Mapping[str, Loop]:
    """Return the loops with the shipped estimator, which knows nothing of the unit, and with the unit's calibration."""
    by_name = {"plain": FourSensors(), "calibrated": FourSensors(stages.of_unit(FIELD, SEED))}
    return {n: stage_loop.of_source(source, unit().bench, GAIN_RATIO) for n, source in by_name.items()}
