"""Tuning of the GLSDC estimator of (X, Y, yaw)."""

from dataclasses import dataclass
from math import inf, pi, radians

from synth import numeric
from synth.errors import ModelError
from synth.numeric import between


@dataclass(frozen=True)
class Tuning:
    """Tuning of the estimator of (X, Y, yaw). The damping is the weight of the prior, which is the predicted pose.

    It corresponds to motions that deviate from their prediction by array.deviation / (alpha sqrt(damping)). No estimate
    is valid once the yaw has exceeded `yaw_limit`, or with two sensors half of `yaw_window`.

    Raises ModelError for a value out of its range.
    """

    iterations: int = between(1, 5, 20)  # corrections a sample
    scale: float = between(0, 1.0, 1)  # of each correction
    damping: float = between(0, 1e-3, 1)  # of alpha^2: weight of the prior on the phases
    yaw_damping_ratio: float = between(0, 5.0, 100)  # arm of the yaw's damping, over the sensors' rms arm
    max_phase_step: float = between(0, 1.0, 1)  # rad of phase, of a sensor in a sample; half of it by the yaw
    velocity_gain: float = 0.5  # of a correction, added to the predicted motion; 0: no motion is predicted
    convergence_sigma: float = between(0, 0.1, 1)  # standard deviations: smaller corrections have converged
    max_prior_weight: float = between(0, 0.15, 3)  # parameters that the prior decides, at most; above: `damped`
    innovation_gate_sigma: float = between(
        0, 3.0, inf
    )  # standard deviations of the innovation: above, no motion of a body
    residual_limit: float = between(0, 0.1, inf)  # V rms: above, a residual fault
    pitches: int = between(1, 8, 1000)  # counted to either side of the middle one
    ambiguity_threshold: float = between(0, 0.004, 3)  # parameters that the prior decides, at most, to resolve
    yaw_window: float = between(0, radians(5), pi)  # rad about the last good yaw: there two sensors are unambiguous
    yaw_limit: float = between(0, radians(10), pi)  # rad: above, never valid again

    def __post_init__(self) -> None:
        numeric.check_fields(self)
        if not 0 <= numeric.number("velocity_gain", self.velocity_gain) <= 1:
            raise ModelError(f"velocity_gain is {self.velocity_gain}: it must be at least 0 and at most 1")
