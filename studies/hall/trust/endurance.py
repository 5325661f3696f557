"""Endurance in random motion: derived limits of speed and acceleration, and simulations up to them.

The estimator predicts a motion m for the next sample, in rad of phase of the sensors' centre. With the estimated motion
d it corrects m <- m + velocity_gain e by the innovation e = d - m. With the speed v, the acceleration a, the sample
period T, the wave number w, and the amplitude alpha and the noise deviation of the voltages:

    speed           |m| <= max_phase_step / 2 along each axis:    w v T <= max_phase_step / 2
    acceleration    e <- (1 - velocity_gain) e + w a T^2, hence |e| <= w |a| T^2 / velocity_gain; the innovation gate
                    requires alpha sqrt(damping) |e| <= innovation_gate_sigma deviation

At 800 Hz with the shipped tuning, the speed limit is 3.23 m/s along each axis. The acceleration limit in the plane is
77.9 m/s^2. RESERVED_FRACTION of it is left to the noise and to the yaw, which moves the sensors by their rms arm, and
39.0 m/s^2 remain.
"""

from dataclasses import dataclass, replace
from math import sqrt

import numpy as np

from designs.hall_position.glsdc import tracking
from models import hall_motions as motions
from models.hall_motions import Limits
from studies.hall.trust import estimator_ensemble
from studies.hall.trust.estimator_ensemble import EstimatorConfig
from synth.check import Check

RESERVED_FRACTION = 0.5  # fraction of the acceleration limit that is reserved for noise and yaw
COUNTED_PITCHES = 1000  # that the estimator counts here; motions at the limits leave the range of the shipped one
MAX_ERROR = 1e-4  # m: ten standard deviations where the valid position is least accurate
MIN_LIMIT_FRACTION = 1e-3  # least fraction of the limits, so that slow motions are included
YAW_SHARE = 0.95  # of the valid yaw limit


@dataclass(frozen=True)
class Endurance:
    """Result of a simulation: `valid_share` of the samples, `lock_lost_share` of the bodies at the end.

    `misleading` is the number of samples that are valid at a wrong position, `max_valid_error` the largest position
    error of the valid samples in m, and `max_error` that of all samples.
    """

    limits: Limits
    samples: int
    valid_share: float
    lock_lost_share: float
    misleading: int
    max_valid_error: float
    max_error: float


def checks(name: str, config: EstimatorConfig, bodies: int, samples: int) -> list[Check]:
    """Check that within the limits no body loses position lock, or reports a wrong position as valid."""
    endurance = run(config, bodies, samples, limits(config))
    conditions = (
        f"{endurance.limits.speed:.3g} m/s, {endurance.limits.acceleration:.3g} m/s^2, {endurance.samples} samples"
    )
    about = f"{conditions}, {100 * endurance.valid_share:.3g} % valid"
    what = f"{name}, random motion"
    return [
        Check(f"{what}: share of bodies that lose position lock", endurance.lock_lost_share, 0, "1", about),
        Check(f"{what}: samples valid at a wrong position", endurance.misleading, 0, "1", about),
        Check(f"{what}: largest error of a valid position", endurance.max_valid_error, MAX_ERROR, "m", about),
    ]


def limits(config: EstimatorConfig) -> Limits:
    """Return the limits of speed and acceleration of the sensors' centre, with RESERVED_FRACTION."""
    tuning, array, T = config.tuning, config.array, estimator_ensemble.TIME.period_s
    max_innovation = tuning.innovation_gate_sigma * array.deviation / (array.alpha * sqrt(tuning.damping))
    speed = tuning.max_phase_step / 2 / (array.wave_number * T)
    acceleration = (1 - RESERVED_FRACTION) * tuning.velocity_gain * max_innovation / (array.wave_number * T**2)
    return Limits(speed, acceleration, YAW_SHARE * tracking.valid_yaw_limit(tuning))


def run(config: EstimatorConfig, bodies: int, samples: int, within: Limits, seed: int = 0) -> Endurance:
    """Simulate an ensemble of bodies on random motions within limits, with an estimator that counts COUNTED_PITCHES.

    Half of the bodies reach the limits, the others a random fraction of them, at least MIN_LIMIT_FRACTION.

    Raises ModelError for fewer than one sample, and as `random_course`.
    """
    config = replace(config, tuning=replace(config.tuning, pitches=COUNTED_PITCHES))
    rng = np.random.default_rng(seed)
    course = motions.random_course(config.array, estimator_ensemble.TIME, bodies, within, rng, MIN_LIMIT_FRACTION)
    state = estimator_ensemble.states_on_course(config, course)
    valid = misleading = 0
    max_valid_error = max_error = 0.0
    for batch, scores in estimator_ensemble.track(config, state, course, samples, rng):
        state = batch.states
        valid, misleading = valid + int(scores.valid.sum()), misleading + int(scores.is_wrong.sum())
        max_valid_error = max(max_valid_error, float(scores.error[scores.valid].max(initial=0)))
        max_error = max(max_error, float(scores.error.max()))
    lock_lost_share = float((state["estimator_lock_lost"] > 0).mean())
    total = bodies * samples
    return Endurance(within, total, valid / total, lock_lost_share, misleading, max_valid_error, max_error)
