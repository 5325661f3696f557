"""The estimator of a calibrated unit: corrected voltages, and R from residuals that were held out."""

from dataclasses import replace
from functools import cache

from designs.hall_position import config as hall
from designs.hall_position.glsdc import channels
from designs.hall_position.protected import config, estimator, metres
from designs.hall_position.protected.parameters import Tuning
from models.hall_two_waves import PlanarArray
from studies.hall.calibrated import corrections, stages
from studies.hall.calibrated.stages import UnitCalibration
from studies.hall.protected import trust
from synth.block import Block

NAME = "hall_position_calibrated"
GAIN_DRIFT = 3e-3  # relative, to either side, of gains since the calibration
UNIFORM = 3**-0.5  # rms of a uniform distribution over its half width
POSE = ("X", "Y", "yaw", "amplitude", "tracking", "excluded", "valid")
ALERT = {"position_limit": trust.WRONG, "yaw_limit": trust.WRONG_YAW}  # m, rad
# Of a sample with four sensors: less than usual, since over half a millimetre hypotheses are linear to about R only.
RISKS = {config.NAME: 1e-5, config.THREE: config.CALIBRATED_THREE.risk}


def tuning(of: UnitCalibration, gain_drift: float = GAIN_DRIFT) -> Tuning:
    """Return the tuning with the model error of a calibration, and limits in proportion to it, from ALERT on."""
    error = of.model_error(UNIFORM * gain_drift)
    usual = config.TUNINGS[of.name]
    scale = error / usual.model_error
    limits = {n: max(least, scale * getattr(usual, n)) for n, least in ALERT.items()}
    return replace(usual, model_error=error, risk=RISKS[of.name], **limits)


def array(of: UnitCalibration) -> PlanarArray:
    """Return the array with the calibrated places and amplitudes."""
    places = tuple((float(x), float(y)) for x, y in of.places())
    return replace(config.array(of.name), positions=places, beta=of.fit.values["wave_5"])


def block(of: UnitCalibration, tuned: Tuning) -> Block:
    """Return the guarded estimator of a calibrated unit."""
    return estimator.with_guard(NAME, array(of), hall.TIME, blocks(of, tuned))


def blocks(of: UnitCalibration, tuned: Tuning) -> list[Block]:
    """Return the Blocks from held voltages of a calibrated unit to its position in m."""
    sensors, time = array(of), hall.TIME
    volts = channels.voltages(len(sensors.positions))
    names = {f"{s.name}_held": f"{s.name}_calibrated" for s in volts} | {"valid": "phases_valid"}
    phases = estimator.phase_estimator(sensors, time, tuned).renamed(names)
    outputs = {s.name: s for s in (*metres.metres(sensors, time, tuned.pitches, phases).outputs, *phases.outputs)}
    corrected = corrections.corrections(of, time, {n: outputs[n] for n in POSE})
    return estimator.locate(sensors, time, tuned, phases, [corrected])


@cache
def of_unit(
    field: str, seed: int, stage: str = stages.STAGES[-1], gain_drift: float = GAIN_DRIFT, name: str = config.NAME
) -> tuple[Block, Tuning]:
    """Return the estimator of a unit, calibrated up to a stage, and its tuning."""
    of = stages.of_unit(field, seed, stage, name)
    tuned = tuning(of, gain_drift)
    return block(of, tuned), tuned
