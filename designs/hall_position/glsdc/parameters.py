"""How the estimators of (X, Y, yaw) and of all six degrees of freedom go about their task."""

from dataclasses import dataclass
from math import inf, pi, radians

from synth import numeric
from synth.errors import ModelError
from synth.numeric import between


@dataclass(frozen=True)
class Tuning:
    """How the estimator of (X, Y, yaw) works; the damping holds to the prediction what the voltages do not tell.

    It stands for motions that deviate from their prediction by array.deviation / (alpha sqrt(damping)). Nothing is
    valid after a yaw of more than `yaw`, and with two sensors of more than half of `turn`.

    Raises ModelError for a figure that is out of its range.
    """

    iterations: int = between(1, 5, 20)  # a sample
    scale: float = between(0, 1.0, 1)  # of each correction
    damping: float = between(0, 1e-3, 1)  # of alpha^2, of phases from the prediction
    firm: float = between(0, 5.0, 100)  # times as much the yaw is damped, by what it moves the sensors
    reach: float = between(0, 1.0, 1)  # rad of phase by which a sample may move a sensor, half of it by the yaw
    follow: float = 0.5  # part of a correction by which the next motion is predicted to differ; 0: none is predicted
    settled: float = between(0, 0.1, 1)  # standard deviations: a smaller correction has converged
    leaning: float = between(0, 0.15, 3)  # parameters that the damping may decide; else `damped`
    surprise: float = between(0, 3.0, inf)  # deviations of motions: more is no motion of a body
    residual: float = between(0, 0.1, inf)  # V rms up to which residuals are those of the field's model
    pitches: int = between(1, 8, 1000)  # to either side up to which positions are counted
    certain: float = between(0, 0.004, 3)  # parameters that it may decide at a certain place of two sensors
    turn: float = between(0, radians(5), pi)  # rad from the last certain yaw: there two sensors tell places apart
    yaw: float = between(0, radians(10), pi)  # rad up to which a place is valid

    def __post_init__(self) -> None:
        numeric.check_fields(self)
        if not 0 <= numeric.number("follow", self.follow) <= 1:
            raise ModelError(f"follow is {self.follow}: it must be at least 0 and at most 1")


@dataclass(frozen=True)
class SpatialTuning:
    """How the estimator of six degrees of freedom works, in the words of `Tuning`.

    Above the fabricated matrix, other waves leave up to 0.093 V of four sensors' voltages: allow more than `residual`.

    Raises ModelError for a figure that is out of its range.
    """

    corrections: int = between(1, 4, 20)  # a sample, all by the Jacobian where it begins
    damping: float = between(0, 1e-4, 1)  # of alpha^2
    reach: float = between(0, 0.5, 1)  # rad of phase
    follow: float = between(0, 0.5, 1)  # part of a correction
    settled: float = between(0, 0.1, 1)  # standard deviations
    leaning: float = between(0, 0.15, 6)  # parameters
    surprise: float = between(0, 3.0, inf)  # deviations of motions
    residual: float = between(0, 0.02, inf)  # V rms
    gap: float = between(0, 1e-3, 0.002)  # m from the height within which Z is valid
    tilt: float = between(0, 0.02, 0.05)  # rad within which roll and pitch are valid
    pitches: int = between(1, 8, 1000)

    def __post_init__(self) -> None:
        numeric.check_fields(self)
