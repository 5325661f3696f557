"""Tuning of the estimator of four sensors."""

from dataclasses import dataclass
from math import inf, radians

from synth import numeric
from synth.numeric import between


@dataclass(frozen=True)
class Tuning:
    """Tuning; lengths in m, angles and phases in rad, and the amplitude relative to that of the model.

    With the usual values a sweep takes 24 to 96 samples. `position_limit` and `yaw_limit` are those of the protection
    levels: they are met at 99 of 100 places with the usual model error, and shrink with it.

    Raises ModelError for a value out of its range.
    """

    model_error: float = between(0, 0.055, inf)  # V rms of a voltage, left by the calibration of field and sensors
    corrections: int = between(1, 2, 20)  # a sample, all with the Jacobian at the prediction
    phase_step: float = between(0, 0.5, 1)  # largest correction in a sample
    yaw_step: float = between(0, 0.1, 1)
    velocity_gain: float = between(0, 0.5, 1)
    yaw_range: float = between(0, radians(12), 1)  # to either side
    largest_phase: float = between(0, 0.25, 3)  # standard deviations that are resolved
    largest_yaw: float = between(0, 0.1, 3)
    largest_amplitude: float = between(0, 0.2, 3)
    amplitude_range: float = between(0, 0.25, 1)  # about 1
    amplitude_prior: float = between(0, 0.06, inf)  # standard deviation
    false_alarm: float = between(0, 1e-3, 0.5)
    risk: float = between(0, 1e-3, 0.5)
    position_limit: float = between(0, 5e-3, inf)
    yaw_limit: float = between(0, 0.22, inf)
    excluded_limits: float = between(0, 1.0, 1)  # factor on both limits while a sensor is excluded
    overbound: float = between(0, 1.25, 10)  # factor on the levels while a sensor is excluded
    starts: int = between(1, 24, 1000)  # of a sweep
    dwell: int = between(1, 4, 1000)  # samples of a start
    all_sensors: bool = False  # a sweep accepts no solution with a sensor excluded
    agreement: float = between(0, 0.15, 3)  # of two solutions that count as one
    yaw_agreement: float = between(0, 0.05, 3)
    patience: int = between(1, 8, 1000)  # samples without an accepted solution until the track is lost
    repeats: int = between(1, 6, 1000)  # of a code, of a frozen converter
    pitches: int = between(1, 8, 1000)  # counted to either side

    def __post_init__(self) -> None:
        numeric.check_fields(self)
