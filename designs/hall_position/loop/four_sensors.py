"""Position source of four sensors with protection levels: `hall_position_four` as it ships, or with a calibration.

The stage is a unit of `calibrated.unit`, whose matrix and sensors have tolerances that the shipped estimator does not
know; the field's amplitude is lower by that of `protected.trust`. A calibration (`calibrated.stages`) knows the unit.

A loop needs an estimate at every place that it crosses. Within the yaws of the stage the protection levels of the
calibrated unit are at most 0.61 mm and 25 mrad, which POSITION_LIMIT and YAW_LIMIT allow. While a sensor is
excluded the limits are those of the calibration, about 0.5 mm and 22 mrad: docs/decisions/hall_position_loop.md.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache

import casadi as ca

from designs.hall_position.calibrated import estimator as calibrated
from designs.hall_position.calibrated import stages
from designs.hall_position.calibrated import unit as units
from designs.hall_position.calibrated.stages import UnitCalibration
from designs.hall_position.calibrated.unit import Unit
from designs.hall_position.loop import stage_loop
from designs.hall_position.loop.stage_loop import Loop
from designs.hall_position.protected import config, estimator, trust
from synth.block import Block, Exprs, Step, build
from synth.signals import Signal
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
        tuned = calibrated.tuning(self.calibration)
        located = [
            b.renamed(lost)
            for b in calibrated.blocks(
                self.calibration, replace(tuned, position_limit=POSITION_LIMIT, yaw_limit=YAW_LIMIT)
            )
        ]
        limits = {"X": tuned.position_limit, "Y": tuned.position_limit, "yaw": tuned.yaw_limit}
        return [*located[:-1], *limit_protection(located[-1], located[-2], time, limits)]


def limit_protection(metres: Block, phases: Block, time: Discrete, limits: Mapping[str, float]) -> list[Block]:
    """Return the last Block, and one whose ``valid`` needs narrower limits of the levels while a sensor is excluded."""
    signals = {s.name: s for s in (*metres.outputs, *phases.outputs)}
    levels = {axis: signals[f"protection_{axis}"] for axis in limits}
    wide = Signal("widely_valid", "1", 0, 1, "valid within the limits while no sensor is excluded")

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        narrow = ca.SX(1)
        for axis, limit in limits.items():
            narrow = ca.logic_and(narrow, u[levels[axis].name] <= limit)
        return Step({"valid": ca.logic_and(u[wide.name], ca.logic_or(u["excluded"] <= 0, narrow))})

    inputs = [wide, signals["excluded"], *levels.values()]
    about = "narrower limits of the protection levels without a sensor"
    limiting = build("limits", time, law, inputs=inputs, outputs=[signals["valid"]], tag=about)
    return [metres.renamed({"valid": wide.name}), limiting]


@cache
def unit() -> Unit:
    """Return the unit whose loop is closed."""
    return units.draw(FIELD, SEED)


@cache
def loops() -> Mapping[str, Loop]:
    """Return the loops with the shipped estimator, which knows nothing of the unit, and with the unit's calibration."""
    by_name = {"plain": FourSensors(), "calibrated": FourSensors(stages.of_unit(FIELD, SEED))}
    return {n: stage_loop.of_source(source, unit().bench, GAIN_RATIO) for n, source in by_name.items()}
