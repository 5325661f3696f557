"""Endurance in random motion: derived limits of speed and acceleration, and simulations up to them.

The prediction is the last motion m, with m <- m + velocity_gain e and the innovation e = d - m, in rad of phase of the
sensors' centre.

    speed           |m| <= max_phase_step / 2 along each axis:    w v T <= max_phase_step / 2
    acceleration    e <- (1 - velocity_gain) e + w a T^2, hence |e| <= w |a| T^2 / velocity_gain; the innovation gate
                    requires alpha sqrt(damping) |e| <= innovation_gate_sigma deviation

For 800 Hz and the shipped tuning the speed limit is 3.23 m/s along each axis. The acceleration limit is 77.9 m/s^2 in
the plane; MARGIN of it is left to the noise and to the yaw, which moves the sensors by their rms arm: 39.0 m/s^2. At
the full acceleration, one body in fifty loses position lock with three sensors in 1500 samples.
"""

from dataclasses import dataclass, replace
from math import sqrt

import numpy as np

from designs.hall_position.glsdc import tracking
from designs.hall_position.trust import estimator_ensemble
from designs.hall_position.trust.estimator_ensemble import EstimatorConfig
from models import hall_motions as motions
from models.hall_motions import Limits
from synth.check import Check

MARGIN = 0.5  # of the acceleration
PITCHES = 1000  # motions at the limits leave the range that the shipped estimator counts
MAX_ERROR = 1e-4  # m: ten standard deviations at the worst valid position
SLOWEST = 1e-3  # share of the speed limit: slow motions are included
YAW_SHARE = 0.95  # of the valid yaws


@dataclass(frozen=True)
class Endurance:
    """Result of a simulation: share of `valid` samples, and of bodies that `lost` position lock.

    `wrong` samples were valid at another position; `worst` is the largest error of the valid ones, `off` of all, m.
    """

    limits: Limits
    samples: int
    valid: float
    lost: float
    wrong: int
    worst: float
    off: float


def checks(name: str, config: EstimatorConfig, bodies: int, samples: int) -> list[Check]:
    """Check that no body loses position lock or is valid elsewhere, within the limits."""
    outcome = run(config, bodies, samples, limits(config))
    within = f"{outcome.limits.speed:.3g} m/s, {outcome.limits.acceleration:.3g} m/s^2, {outcome.samples} samples"
    about = f"{within}, {100 * outcome.valid:.3g} % valid"
    what = f"{name}, random motion"
    return [
        Check(f"{what}: bodies lost", outcome.lost, 0, "1", about),
        Check(f"{what}: samples valid elsewhere", outcome.wrong, 0, "1", about),
        Check(f"{what}: worst valid position", outcome.worst, MAX_ERROR, "m", about),
    ]


def limits(config: EstimatorConfig) -> Limits:
    """Return the limits of speed and acceleration of the sensors' centre, with MARGIN."""
    t, a, T = config.tuning, config.array, estimator_ensemble.TIME.period_s
    e = t.innovation_gate_sigma * a.deviation / (a.alpha * sqrt(t.damping))
    speed = t.max_phase_step / 2 / (a.wave_number * T)
    acceleration = (1 - MARGIN) * t.velocity_gain * e / (a.wave_number * T**2)
    return Limits(speed, acceleration, YAW_SHARE * tracking.valid_yaw_limit(a, t))


def run(config: EstimatorConfig, bodies: int, samples: int, within: Limits, seed: int = 0) -> Endurance:
    """Simulate bodies on random motions within limits, with PITCHES counted.

    Half of the bodies reach the limits, the others a random share of them down to SLOWEST.

    Raises ModelError for no sample, and as `random_course`.
    """
    config = replace(config, tuning=replace(config.tuning, pitches=PITCHES))
    rng = np.random.default_rng(seed)
    at = motions.random_course(config.array, estimator_ensemble.TIME, bodies, within, rng, SLOWEST)
    state = estimator_ensemble.states_on_course(config, at)
    valid = wrong = 0
    worst = off = 0.0
    for batch, seen in estimator_ensemble.track(config, state, at, samples, rng):
        state = batch.states
        valid, wrong = valid + int(seen.valid.sum()), wrong + int(seen.is_wrong.sum())
        worst, off = max(worst, float(seen.error[seen.valid].max(initial=0))), max(off, float(seen.error.max()))
    lost = float((state["estimator_lock_lost"] > 0).mean())
    return Endurance(within, bodies * samples, valid / (bodies * samples), lost, wrong, worst, off)
